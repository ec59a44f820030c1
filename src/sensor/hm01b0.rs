//! HM01B0.
//!
//! Lines and frames are as their registers say; with binning each line averages two rows. 59.9 frames a second were
//! seen on hardware for 376 × 266 at 6 MHz, and users of SparkFun's board find 120 a second at most for the binned
//! mode, as the formula has it for OpenMV's 376 × 132.
//!
//! A frame that is set shorter than its rows need is longer than that: 324 rows with 265 lines, as OpenMV sets them.
//! *Open*: by how much it then is, and the frequency of the sensor's own oscillator: [`Evidence::Described`] where it
//! runs on that, for the frequency that is given.

use super::description::{Description, FrameSetting, Protocol, ReadRegister, Setting};
use super::error::SensorError;
use super::mode::{Clock, Evidence, Timing};
use super::register::{Register, registers};

registers! {
    MODEL = "MODEL_ID": 0x0000, 0x0001 => "model: 0x01b0";
    MIRROR = "IMG_ORIENTATION[0]": 0x0101 / 0x01 => "mirror left to right";
    FLIP = "IMG_ORIENTATION[1]": 0x0101 / 0x02 => "upside down";
    COMMIT = "GRP_PARAM_HOLD[0]": 0x0104 / 0x01 => "new values count from the next frame on";
    EXPOSURE = "INTEGRATION": 0x0202, 0x0203 => "exposure in lines";
    FRAME_LINES = "FRAME_LEN_LINES": 0x0340, 0x0341 => "lines of a frame";
    LINE_CLOCKS = "LINE_LEN_PCK": 0x0342, 0x0343 => "clocks of a line";
    COLUMN_STEP = "READOUT_X": 0x0383 => "1: every column, 3: every second pair";
    ROW_STEP = "READOUT_Y": 0x0387 => "1: every row, 3: every second pair";
    AUTOMATIC_EXPOSURE = "AE_CTRL[0]": 0x2100 / 0x01 => "automatic exposure";
    QVGA_WINDOW = "QVGA_WIN_EN[0]": 0x3010 / 0x01 => "244 rows instead of 324";
    CLOCK = "OSC_CLK_DIV[1:0]": 0x3060 / 0x03 => "the clock is divided by 8, 4, 2, 1";
    OSCILLATOR = "ANA_REGISTER_17[0]": 0x3067 / 0x01 => "the sensor's own oscillator instead of the board's clock";
}

pub(super) static DESCRIPTION: Description = Description {
    name: "HM01B0",
    addresses: &[0x24],
    protocol: Protocol { wide_address: true, wide_data: false, repeated_start: true, page: None },
    identity: &[(&MODEL, 0x01b0)],
    registers: REGISTERS,
    exposure: Setting { register: &EXPOSURE, shift: 0 },
    manual_exposure: (&AUTOMATIC_EXPOSURE, 0),
    exposure_margin_lines: 2,
    frame: FrameSetting::Whole(&FRAME_LINES),
    commit: Some((&COMMIT, 1)),
};

const COLUMNS: u32 = 324;
const ROWS: u32 = 324;
const QVGA_ROWS: u32 = 244;

pub(super) fn timing<R: ReadRegister>(r: &mut R, clock_hz: u32) -> Result<Timing, SensorError<R::BusError>> {
    let rows = if r.is_set(&QVGA_WINDOW)? { QVGA_ROWS } else { ROWS };
    let (columns_shift, rows_shift) = (step(r, &COLUMN_STEP)?, step(r, &ROW_STEP)?);
    let divisor = 8 >> r.read(&CLOCK)?;
    let lines = rows >> rows_shift;
    let evidence = if r.is_set(&OSCILLATOR)? { Evidence::Described } else { Evidence::Confirmed };
    Ok(Timing {
        line_clocks: r.read_above_zero(&LINE_CLOCKS)?,
        clock: Clock::external(clock_hz)?.times(1, divisor),
        frame_lines: r.read_above_zero(&FRAME_LINES)?.max(lines),
        exposure_sixteenths: 16 * r.read(&EXPOSURE)?,
        automatic_exposure: r.is_set(&AUTOMATIC_EXPOSURE)?,
        mirrored: r.is_set(&MIRROR)?,
        flipped: r.is_set(&FLIP)?,
        columns: COLUMNS >> columns_shift,
        rows: lines,
        lines,
        // The shorter window lies in the middle.
        window: [0, (ROWS - rows) / 2, COLUMNS, rows],
        evidence,
    })
}

/// How often rows or columns are halved.
fn step<R: ReadRegister>(r: &mut R, register: &'static Register) -> Result<u32, SensorError<R::BusError>> {
    match r.read(register)? {
        1 => Ok(0),
        3 => Ok(1),
        value => Err(SensorError::Register { register, value, expected: "1 or 3" }),
    }
}
