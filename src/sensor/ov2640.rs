//! OV2640.
//!
//! The sensor runs as UXGA, SVGA (every second row) or CIF (every fourth); a scaler behind it makes the image. Lines
//! are 1922, 1190 and 2 × 595 clocks, frames 1248, 672 and 336 lines. The clock is the board's, half as much again in
//! UXGA. That agrees with the data sheet's 15, 30 and 60 frames a second at 24 MHz and with what users of
//! esp32-camera measured in CIF.
//!
//! *Open*: CLKRC bit 7 doubles the clock by the data sheet and by esp32-camera's use of it, but two measurements with
//! 0x83 and 0x80 show no doubling: [`Evidence::Disputed`]. Further clocks in a line count one by an application note
//! and two by hearsay: [`Evidence::Described`] where there are any.

use super::description::{Description, FrameSetting, Protocol, ReadRegister, SCCB, Setting};
use super::error::SensorError;
use super::mode::{Clock, Evidence, Timing};
use super::register::registers;

registers! {
    PAGE = "RA_DLMT[0]": 0xff / 0x01 => "bank: 0 DSP, 1 sensor";
    PRODUCT = "PIDH" [1]: 0x0a => "product: 0x26";
    MAKER = "MIDH, MIDL" [1]: 0x1c, 0x1d => "maker: 0x7fa2, OmniVision";
    CLOCK = "CLKRC" [1]: 0x11 => "[7] doubler, [5:0] divider less one";
    RESOLUTION = "COM7[6:4]" [1]: 0x12 / 0x70 => "UXGA 0, CIF 2, SVGA 4";
    DUMMY_CLOCKS = "REG2A[7:4], FRARL" [1]: 0x2a / 0xf0, 0x2b => "further clocks in a line";
    DUMMY_LINES = "ADDVSH, ADDVSL" [1]: 0x2e, 0x2d => "further lines in a frame";
    FRAME_LINES = "FLH, FLL" [1]: 0x47, 0x46 => "further lines in a frame";
    EXPOSURE = "AEC[15:0]" [1]: 0x45 / 0x3f, 0x10, 0x04 / 0x03 => "exposure in lines";
    AUTOMATIC_EXPOSURE = "COM8[0]" [1]: 0x13 / 0x01 => "automatic exposure";
    MIRROR = "REG04[7]" [1]: 0x04 / 0x80 => "mirror left to right";
    FLIP = "REG04[6]" [1]: 0x04 / 0x40 => "upside down";
    BYPASS = "R_BYPASS[0]": 0x05 / 0x01 => "the image is the sensor's, not scaled";
    SENSOR_COLUMNS = "HSIZE8": 0x8c / 0x40, 0xc0, 0x8c / 0x38 => "columns that the sensor delivers";
    SENSOR_ROWS = "VSIZE8": 0xc1, 0x8c / 0x07 => "rows that the sensor delivers";
    COLUMNS = "HSIZE": 0x57 / 0x80, 0x55 / 0x08, 0x51 => "columns of the window over 4";
    ROWS = "VSIZE": 0x55 / 0x80, 0x52 => "rows of the window over 4";
    FIRST_COLUMN = "OFFSETX": 0x55 / 0x07, 0x53 => "first column of the window";
    FIRST_ROW = "OFFSETY": 0x55 / 0x70, 0x54 => "first row of the window";
    OUTPUT_COLUMNS = "OUTW": 0x5c / 0x03, 0x5a => "columns of the image over 4";
    OUTPUT_ROWS = "OUTH": 0x5c / 0x04, 0x5b => "rows of the image over 4";
}

pub(super) static DESCRIPTION: Description = Description {
    name: "OV2640",
    addresses: &[0x30],
    protocol: Protocol { page: Some(&PAGE), ..SCCB },
    identity: &[(&PRODUCT, 0x26), (&MAKER, 0x7fa2)],
    registers: REGISTERS,
    exposure: Setting { register: &EXPOSURE, shift: 0 },
    manual_exposure: (&AUTOMATIC_EXPOSURE, 0),
    exposure_margin_lines: 2,
    frame: FrameSetting::Further(&FRAME_LINES),
    commit: None,
};

/// How the sensor runs.
struct Resolution {
    line_clocks: u32,
    frame_lines: u32,
    /// The line's clock in halves of the board's.
    half_clocks: u32,
    /// Rows and columns of the array for each that is read.
    skip: u32,
}

const UXGA: Resolution = Resolution { line_clocks: 1922, frame_lines: 1248, half_clocks: 3, skip: 1 };
const SVGA: Resolution = Resolution { line_clocks: 1190, frame_lines: 672, half_clocks: 2, skip: 2 };
const CIF: Resolution = Resolution { line_clocks: 2 * 595, frame_lines: 336, half_clocks: 2, skip: 4 };

pub(super) fn timing<R: ReadRegister>(r: &mut R, clock_hz: u32) -> Result<Timing, SensorError<R::BusError>> {
    let resolution = resolution(r)?;
    let divider = r.read(&CLOCK)?;
    let doubled = divider & 0x80 != 0;
    let clock = Clock::external(clock_hz)?.times(resolution.half_clocks, 2 * ((divider & 0x3f) + 1));
    let dummy_clocks = r.read(&DUMMY_CLOCKS)?;
    let mut timing = Timing {
        line_clocks: resolution.line_clocks + dummy_clocks,
        clock: clock.times(if doubled { 2 } else { 1 }, 1),
        frame_lines: resolution.frame_lines + r.read(&DUMMY_LINES)? + r.read(&FRAME_LINES)?,
        exposure_sixteenths: 16 * r.read(&EXPOSURE)?,
        automatic_exposure: r.is_set(&AUTOMATIC_EXPOSURE)?,
        mirrored: r.is_set(&MIRROR)?,
        flipped: r.is_set(&FLIP)?,
        columns: 0,
        rows: 0,
        lines: 0,
        window: [0; 4],
        evidence: match (doubled, dummy_clocks) {
            (true, _) => Evidence::Disputed,
            (false, 0) => Evidence::Confirmed,
            (false, _) => Evidence::Described,
        },
    };
    image(r, &mut timing, resolution.skip)?;
    Ok(timing)
}

fn resolution<R: ReadRegister>(r: &mut R) -> Result<&'static Resolution, SensorError<R::BusError>> {
    match r.read(&RESOLUTION)? {
        0 => Ok(&UXGA),
        2 => Ok(&CIF),
        4 => Ok(&SVGA),
        value => Err(SensorError::Register { register: &RESOLUTION, value, expected: "0 (UXGA), 2 (CIF) or 4 (SVGA)" }),
    }
}

/// What the scaler makes of the sensor's rows.
fn image<R: ReadRegister>(r: &mut R, timing: &mut Timing, skip: u32) -> Result<(), SensorError<R::BusError>> {
    if r.is_set(&BYPASS)? {
        let (columns, rows) = (r.read_above_zero(&SENSOR_COLUMNS)?, r.read_above_zero(&SENSOR_ROWS)?);
        (timing.columns, timing.rows, timing.lines) = (columns, rows, rows);
        timing.window = [0, 0, columns * skip, rows * skip];
        return Ok(());
    }
    let (columns, rows) = (4 * r.read_above_zero(&COLUMNS)?, 4 * r.read_above_zero(&ROWS)?);
    let first = [r.read(&FIRST_COLUMN)?, r.read(&FIRST_ROW)?];
    timing.columns = 4 * r.read_above_zero(&OUTPUT_COLUMNS)?;
    timing.rows = 4 * r.read_above_zero(&OUTPUT_ROWS)?;
    timing.lines = rows;
    let [first_column, first_row] = first;
    timing.window = [first_column, first_row, columns, rows].map(|pixels| pixels * skip);
    Ok(())
}
