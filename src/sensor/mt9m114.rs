//! MT9M114.
//!
//! The sensor's own registers say line and frame as they are, the firmware's variables as they were asked for: the
//! former are read. The clock follows from the PLL (Linux's tree, and OpenMV's 48 and 45 MHz from 24 and 25); Linux's
//! 30 frames a second follow from it. Where the firmware was told another clock than the PLL gives, one of the two is
//! wrong: [`Evidence::Described`].

use super::description::{Description, FrameSetting, Protocol, ReadRegister, Setting};
use super::error::SensorError;
use super::mode::{Clock, Evidence, Timing};
use super::register::registers;

registers! {
    CHIP = "CHIP_VERSION": 0x0000 / 0xffff => "chip: 0x2481";
    FRAME_LINES = "FRAME_LENGTH_LINES": 0x300a / 0xffff => "lines of a frame";
    LINE_CLOCKS = "LINE_LENGTH_PCK": 0x300c / 0xffff => "clocks of a line";
    EXPOSURE = "COARSE_INTEGRATION_TIME": 0x3012 / 0xffff => "exposure in lines";
    AUTOMATIC_EXPOSURE = "AE_TRACK_ALGO[0]": 0xa804 / 0x0001 => "automatic exposure";
    FIRST_ROW = "CAM_SENSOR_CFG_Y_ADDR_START": 0xc800 / 0xffff => "first row of the window";
    FIRST_COLUMN = "CAM_SENSOR_CFG_X_ADDR_START": 0xc802 / 0xffff => "first column of the window";
    LAST_ROW = "CAM_SENSOR_CFG_Y_ADDR_END": 0xc804 / 0xffff => "last row of the window";
    STATED_CLOCK = "CAM_SENSOR_CFG_PIXCLK": 0xc808 / 0xffff, 0xc80a / 0xffff => "clock as the firmware was told, Hz";
    MIRROR = "CAM_SENSOR_CONTROL_READ_MODE[0]": 0xc834 / 0x0001 => "mirror left to right";
    FLIP = "CAM_SENSOR_CONTROL_READ_MODE[1]": 0xc834 / 0x0002 => "upside down";
    COLUMN_BINNING = "CAM_SENSOR_CONTROL_READ_MODE[5:4]": 0xc834 / 0x0030 => "0: every column, else one of two";
    ROW_BINNING = "CAM_SENSOR_CONTROL_READ_MODE[9:8]": 0xc834 / 0x0300 => "0: every row, else one of two";
    CROP_FIRST_COLUMN = "CAM_CROP_WINDOW_XOFFSET": 0xc854 / 0xffff => "columns left out before the cut image";
    CROP_FIRST_ROW = "CAM_CROP_WINDOW_YOFFSET": 0xc856 / 0xffff => "lines left out before the cut image";
    CROP_COLUMNS = "CAM_CROP_WINDOW_WIDTH": 0xc858 / 0xffff => "columns that are scaled to the image";
    CROP_ROWS = "CAM_CROP_WINDOW_HEIGHT": 0xc85a / 0xffff => "lines that are scaled to the image";
    OUTPUT_COLUMNS = "CAM_OUTPUT_WIDTH": 0xc868 / 0xffff => "columns of the image";
    OUTPUT_ROWS = "CAM_OUTPUT_HEIGHT": 0xc86a / 0xffff => "rows of the image";
    PLL_N = "CAM_SYSCTL_PLL_DIVIDER_M_N[13:8]": 0xc980 / 0x3f00 => "PLL divider N less one";
    PLL_M = "CAM_SYSCTL_PLL_DIVIDER_M_N[7:0]": 0xc980 / 0x00ff => "PLL multiplier M";
    PLL_P = "CAM_SYSCTL_PLL_DIVIDER_P[13:8]": 0xc982 / 0x3f00 => "PLL divider P less one";
}

pub(super) static DESCRIPTION: Description = Description {
    name: "MT9M114",
    addresses: &[0x48, 0x5d],
    protocol: Protocol { wide_address: true, wide_data: true, repeated_start: true, page: None },
    identity: &[(&CHIP, 0x2481)],
    registers: REGISTERS,
    exposure: Setting { register: &EXPOSURE, shift: 0 },
    manual_exposure: (&AUTOMATIC_EXPOSURE, 0),
    exposure_margin_lines: 2,
    frame: FrameSetting::Whole(&FRAME_LINES),
    commit: None,
};

/// A clock that is stated otherwise by more than 1/200 is another one.
const TOLERANCE: u64 = 200;

pub(super) fn timing<R: ReadRegister>(r: &mut R, clock_hz: u32) -> Result<Timing, SensorError<R::BusError>> {
    let divisor = (r.read(&PLL_N)? + 1) * (r.read(&PLL_P)? + 1);
    let clock = Clock::external(clock_hz)?.times(r.read_above_zero(&PLL_M)?, divisor);
    let agrees = clock.hz().abs_diff(r.read(&STATED_CLOCK)?.into()) <= clock.hz() / TOLERANCE;
    let (first_row, last_row) = (r.read(&FIRST_ROW)?, r.read(&LAST_ROW)?);
    if last_row <= first_row {
        return Err(SensorError::Register { register: &LAST_ROW, value: last_row, expected: "after the first row" });
    }
    let (column_shift, row_shift) = (r.is_set(&COLUMN_BINNING)?.into(), r.is_set(&ROW_BINNING)?.into());
    let (columns, lines) = (r.read_above_zero(&CROP_COLUMNS)?, r.read_above_zero(&CROP_ROWS)?);
    let grown = |size: u32, shift: u32| size << shift;
    Ok(Timing {
        line_clocks: r.read_above_zero(&LINE_CLOCKS)?,
        clock,
        frame_lines: r.read_above_zero(&FRAME_LINES)?,
        exposure_sixteenths: 16 * r.read(&EXPOSURE)?,
        automatic_exposure: r.is_set(&AUTOMATIC_EXPOSURE)?,
        mirrored: r.is_set(&MIRROR)?,
        flipped: r.is_set(&FLIP)?,
        columns: r.read_above_zero(&OUTPUT_COLUMNS)?,
        rows: r.read_above_zero(&OUTPUT_ROWS)?,
        lines,
        window: [
            r.read(&FIRST_COLUMN)? + grown(r.read(&CROP_FIRST_COLUMN)?, column_shift),
            first_row + grown(r.read(&CROP_FIRST_ROW)?, row_shift),
            grown(columns, column_shift),
            grown(lines, row_shift),
        ],
        evidence: if agrees { Evidence::Confirmed } else { Evidence::Described },
    })
}
