//! HM0360.
//!
//! Lines and frames are as their registers say, the clock is the board's over a power of two: Zephyr's settings then
//! give 58.7 frames a second in VGA at 24 MHz, where it speaks of 60.
//!
//! *Open*: nobody measured it: [`Evidence::Described`]. Without WIN_MODE there are 16 more rows by the size of the
//! array, which no driver says. A context switch reads the timing from another set of registers that no source
//! describes: refused.

use super::description::{Description, FrameSetting, Protocol, ReadRegister, Setting};
use super::error::SensorError;
use super::mode::{Clock, Evidence, Timing};
use super::register::{Register, registers};

registers! {
    MODEL = "MODEL_ID": 0x0000, 0x0001 => "model: 0x0360";
    MIRROR = "IMG_ORIENTATION[0]": 0x0101 / 0x01 => "mirror left to right";
    FLIP = "IMG_ORIENTATION[1]": 0x0101 / 0x02 => "upside down";
    COMMIT = "COMMAND_UPDATE[0]": 0x0104 / 0x01 => "new values count from the next frame on";
    EXPOSURE = "INTEGRATION": 0x0202, 0x0203 => "exposure in lines";
    CLOCK = "PLL1_CONFIG[1:0]": 0x0300 / 0x03 => "the clock is divided by 2 to this";
    FRAME_LINES = "FRAME_LEN_LINES": 0x0340, 0x0341 => "lines of a frame";
    LINE_CLOCKS = "LINE_LEN_PCK": 0x0342, 0x0343 => "clocks of a line";
    COLUMN_SUBSAMPLING = "H_SUBSAMPLE": 0x0380 => "columns are divided by 2 to this";
    ROW_SUBSAMPLING = "V_SUBSAMPLE": 0x0381 => "rows are divided by 2 to this";
    AUTOMATIC_EXPOSURE = "AE_CTRL[0]": 0x2000 / 0x01 => "automatic exposure";
    CONTEXT_SWITCH = "PMU_CFG_3[0]": 0x3024 / 0x01 => "the timing stands in another set of registers";
    WINDOW = "WIN_MODE[0]": 0x3030 / 0x01 => "640 x 480 instead of the whole array";
}

pub(super) static DESCRIPTION: Description = Description {
    name: "HM0360",
    addresses: &[0x24, 0x12],
    protocol: Protocol { wide_address: true, wide_data: false, repeated_start: true, page: None },
    identity: &[(&MODEL, 0x0360)],
    registers: REGISTERS,
    exposure: Setting { register: &EXPOSURE, shift: 0 },
    manual_exposure: (&AUTOMATIC_EXPOSURE, 0),
    exposure_margin_lines: 4,
    frame: FrameSetting::Whole(&FRAME_LINES),
    commit: Some((&COMMIT, 1)),
};

/// Columns and rows with the window and without.
const VGA: [u32; 2] = [640, 480];
const ARRAY: [u32; 2] = [656, 496];

pub(super) fn timing<R: ReadRegister>(r: &mut R, clock_hz: u32) -> Result<Timing, SensorError<R::BusError>> {
    if r.is_set(&CONTEXT_SWITCH)? {
        let expected = "0: with a context switch the timing stands elsewhere";
        return Err(SensorError::Register { register: &CONTEXT_SWITCH, value: 1, expected });
    }
    let [columns, rows] = if r.is_set(&WINDOW)? { VGA } else { ARRAY };
    let [array_columns, array_rows] = ARRAY;
    let (column_shift, row_shift) = (subsampling(r, &COLUMN_SUBSAMPLING)?, subsampling(r, &ROW_SUBSAMPLING)?);
    let lines = rows >> row_shift;
    Ok(Timing {
        line_clocks: r.read_above_zero(&LINE_CLOCKS)?,
        clock: Clock::external(clock_hz)?.times(1, 1 << r.read(&CLOCK)?),
        frame_lines: r.read_above_zero(&FRAME_LINES)?.max(lines),
        exposure_sixteenths: 16 * r.read(&EXPOSURE)?,
        automatic_exposure: r.is_set(&AUTOMATIC_EXPOSURE)?,
        mirrored: r.is_set(&MIRROR)?,
        flipped: r.is_set(&FLIP)?,
        columns: columns >> column_shift,
        rows: lines,
        lines,
        window: [(array_columns - columns) / 2, (array_rows - rows) / 2, columns, rows],
        evidence: Evidence::Described,
    })
}

fn subsampling<R: ReadRegister>(r: &mut R, register: &'static Register) -> Result<u32, SensorError<R::BusError>> {
    match r.read(register)? {
        shift @ 0..=2 => Ok(shift),
        value => Err(SensorError::Register { register, value, expected: "0, 1 or 2" }),
    }
}
