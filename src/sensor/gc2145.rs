//! GC2145.
//!
//! A line is half the window's columns with blanking, at a quarter of the board's clock times a multiplier; a frame
//! is the window's rows with blanking and 16 more. The formula was made for Linux's three modes, and gives the 20, 30
//! and 29 frames a second that they are meant for.
//!
//! A subsampler keeps some lines of every few, and a scaler may halve before it: then rows of the image take several
//! lines, by the lists of the lines that are kept ([`Evidence::Described`]).

use super::description::{Description, FrameSetting, Protocol, ReadRegister, SCCB, Setting};
use super::error::SensorError;
use super::galaxycore::subsampling;
use super::mode::{Clock, Evidence, Timing};
use super::register::registers;

registers! {
    PAGE = "PAGE_SELECT[2:0]": 0xfe / 0x07 => "page";
    CHIP = "CHIP_ID": 0xf0, 0xf1 => "chip: 0x2145";
    MULTIPLIER = "PLL_MODE2[5:0]": 0xf8 / 0x3f => "multiplier of a quarter of the clock, less one";
    CLOCK = "CLK_DIV_MODE[7:4]": 0xfa / 0xf0 => "divider of the clock less one";
    SCALER = "SCALER_MODE[0]": 0xfd / 0x01 => "rows and columns are halved";
    EXPOSURE = "EXPOSURE": 0x03 / 0x1f, 0x04 => "exposure in lines";
    COLUMN_BLANKING = "HB": 0x05 / 0x0f, 0x06 => "blanking of a line in clocks";
    ROW_BLANKING = "VB": 0x07 / 0x1f, 0x08 => "blanking of a frame in lines";
    FIRST_ROW = "ROW_START": 0x09 / 0x07, 0x0a => "first row of the window";
    FIRST_COLUMN = "COL_START": 0x0b / 0x07, 0x0c => "first column of the window";
    ROWS = "WIN_HEIGHT": 0x0d / 0x07, 0x0e => "rows of the window";
    COLUMNS = "WIN_WIDTH": 0x0f / 0x07, 0x10 => "columns of the window";
    SAMPLE_HOLD = "SH_DELAY": 0x11 / 0x03, 0x12 => "clocks of a line for sampling";
    MIRROR = "ANALOG_MODE1[0]": 0x17 / 0x01 => "mirror left to right";
    FLIP = "ANALOG_MODE1[1]": 0x17 / 0x02 => "upside down";
    CROP = "CROP_ENABLE[0]": 0x90 / 0x01 => "the image is cut";
    CROP_ROWS = "OUT_WIN_HEIGHT": 0x95 / 0x07, 0x96 => "rows of the cut image";
    CROP_COLUMNS = "OUT_WIN_WIDTH": 0x97 / 0x07, 0x98 => "columns of the cut image";
    SUBSAMPLE_ROWS = "SUBSAMPLE[7:4]": 0x99 / 0xf0 => "lines of which some are kept";
    SUBSAMPLE_COLUMNS = "SUBSAMPLE[3:0]": 0x99 / 0x0f => "columns of which some are kept";
    KEPT_ROWS = "SUB_ROW_N": 0x9b, 0x9c, 0x9d, 0x9e => "which lines are kept, a nibble each";
    KEPT_COLUMNS = "SUB_COL_N": 0x9f, 0xa0, 0xa1, 0xa2 => "which columns are kept, a nibble each";
    AUTOMATIC_EXPOSURE = "AEC_ENABLE[0]": 0xb6 / 0x01 => "automatic exposure";
}

pub(super) static DESCRIPTION: Description = Description {
    name: "GC2145",
    addresses: &[0x3c],
    protocol: Protocol { page: Some(&PAGE), ..SCCB },
    identity: &[(&CHIP, 0x2145)],
    registers: REGISTERS,
    exposure: Setting { register: &EXPOSURE, shift: 0 },
    manual_exposure: (&AUTOMATIC_EXPOSURE, 0),
    exposure_margin_lines: 2,
    frame: FrameSetting::Further(&ROW_BLANKING),
    commit: None,
};

/// Clocks of a line and lines of a frame beside window and blanking.
const FURTHER_CLOCKS: u32 = 4;
const FURTHER_ROWS: u32 = 16;

/// Rows and columns of the window beside the image.
const BORDER_ROWS: u32 = 16;
const BORDER_COLUMNS: u32 = 18;

pub(super) fn timing<R: ReadRegister>(r: &mut R, clock_hz: u32) -> Result<Timing, SensorError<R::BusError>> {
    let (columns, rows) = (r.read_above_zero(&COLUMNS)?, r.read_above_zero(&ROWS)?);
    let halved = if r.is_set(&SCALER)? { 2 } else { 1 };
    let (kept_rows, of_rows) = subsampling(r, &SUBSAMPLE_ROWS, &KEPT_ROWS)?;
    let (kept_columns, of_columns) = subsampling(r, &SUBSAMPLE_COLUMNS, &KEPT_COLUMNS)?;
    let grown = |size: u32, kept: u32, of: u32| (size * of * halved).checked_div(kept).unwrap_or(size);
    let shrunk = |size: u32, kept: u32, of: u32| (size * kept).checked_div(of * halved).unwrap_or(size).max(1);
    let [image_columns, image_rows] = if r.is_set(&CROP)? {
        [r.read_above_zero(&CROP_COLUMNS)?, r.read_above_zero(&CROP_ROWS)?]
    } else {
        let (columns, rows) = (columns.saturating_sub(BORDER_COLUMNS), rows.saturating_sub(BORDER_ROWS));
        [shrunk(columns, kept_columns, of_columns), shrunk(rows, kept_rows, of_rows)]
    };
    let lines = grown(image_rows, kept_rows, of_rows);
    let evidence = if lines == image_rows { Evidence::Confirmed } else { Evidence::Described };
    let divider = r.read(&CLOCK)? + 1;
    Ok(Timing {
        line_clocks: columns / 2 + r.read(&COLUMN_BLANKING)? + r.read(&SAMPLE_HOLD)? + FURTHER_CLOCKS,
        clock: Clock::external(clock_hz)?.times(r.read(&MULTIPLIER)? + 1, 4 * divider),
        frame_lines: rows + r.read(&ROW_BLANKING)? + FURTHER_ROWS,
        exposure_sixteenths: 16 * r.read(&EXPOSURE)?,
        automatic_exposure: r.is_set(&AUTOMATIC_EXPOSURE)?,
        mirrored: r.is_set(&MIRROR)?,
        flipped: r.is_set(&FLIP)?,
        columns: image_columns,
        rows: image_rows,
        lines,
        window: [r.read(&FIRST_COLUMN)?, r.read(&FIRST_ROW)?, grown(image_columns, kept_columns, of_columns), lines],
        evidence: if divider == 1 { evidence } else { Evidence::Described },
    })
}
