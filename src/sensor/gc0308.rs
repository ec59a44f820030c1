//! GC0308.
//!
//! A line is the window's columns with blanking, two clocks each; the formula is that of Linux, whose settings give
//! 28.8 frames a second of the 30 that the data sheet has at most: [`Evidence::Described`]. A long exposure lengthens
//! the frame, in a way that Linux's author could not make out.
//!
//! *Open*: esp32-camera reads the exposure's two bytes as twelve bits further up; here they are taken as Linux takes
//! them.

use super::description::{Description, FrameSetting, Protocol, ReadRegister, SCCB, Setting};
use super::error::SensorError;
use super::galaxycore::subsampling;
use super::mode::{Clock, Evidence, Timing};
use super::register::registers;

registers! {
    PAGE = "PAGE_SELECT[0]": 0xfe / 0x01 => "page";
    CHIP = "CHIP_ID": 0x00 => "chip: 0x9b";
    COLUMN_BLANKING = "HB": 0x0f / 0x0f, 0x01 => "blanking of a line in pixels";
    ROW_BLANKING = "VB": 0x0f / 0xf0, 0x02 => "blanking of a frame in lines";
    EXPOSURE = "EXP": 0x03 / 0x0f, 0x04 => "exposure in lines";
    FIRST_ROW = "ROW_START": 0x05 / 0x01, 0x06 => "first row of the window";
    FIRST_COLUMN = "COL_START": 0x07 / 0x03, 0x08 => "first column of the window";
    ROWS = "WIN_HEIGHT": 0x09 / 0x01, 0x0a => "rows of the window, 8 of them beside the image";
    COLUMNS = "WIN_WIDTH": 0x0b / 0x03, 0x0c => "columns of the window, 8 of them beside the image";
    ROWS_BEFORE = "VS_START_TIME": 0x0d => "lines before the window";
    ROWS_AFTER = "VS_END_TIME": 0x0e => "lines after the window";
    SAMPLE_HOLD = "SH_DELAY": 0x12 => "pixels of a line for sampling";
    MIRROR = "CISCTL_MODE1[0]": 0x14 / 0x01 => "mirror left to right";
    FLIP = "CISCTL_MODE1[1]": 0x14 / 0x02 => "upside down";
    AUTOMATIC_EXPOSURE = "AAAA_EN[0]": 0x22 / 0x01 => "automatic exposure";
    CLOCK = "CLK_DIV_MODE[6:4]": 0x28 / 0x70 => "divider of the clock less one";
    CROP = "CROP_WIN_MODE[7]": 0x46 / 0x80 => "the image is cut";
    CROP_ROWS = "CROP_WIN_HEIGHT": 0x49 / 0x01, 0x4a => "rows of the cut image";
    CROP_COLUMNS = "CROP_WIN_WIDTH": 0x4b / 0x03, 0x4c => "columns of the cut image";
    SUBSAMPLE_ROWS = "SUBSAMPLE[7:4]" [1]: 0x54 / 0xf0 => "lines of which some are kept";
    SUBSAMPLE_COLUMNS = "SUBSAMPLE[3:0]" [1]: 0x54 / 0x0f => "columns of which some are kept";
    KEPT_ROWS = "SUB_ROW_N" [1]: 0x56, 0x57 => "which lines are kept, a nibble each";
    KEPT_COLUMNS = "SUB_COL_N" [1]: 0x58, 0x59 => "which columns are kept, a nibble each";
}

pub(super) static DESCRIPTION: Description = Description {
    name: "GC0308",
    addresses: &[0x21],
    protocol: Protocol { page: Some(&PAGE), ..SCCB },
    identity: &[(&CHIP, 0x9b)],
    registers: REGISTERS,
    exposure: Setting { register: &EXPOSURE, shift: 0 },
    manual_exposure: (&AUTOMATIC_EXPOSURE, 0),
    exposure_margin_lines: 2,
    frame: FrameSetting::Further(&ROW_BLANKING),
    commit: None,
};

/// Pixels of a line beside window, blanking and sampling.
const FURTHER_PIXELS: u32 = 4;

/// Rows and columns of the window beside the image.
const BORDER: u32 = 8;

const CLOCKS_PER_PIXEL: u32 = 2;

pub(super) fn timing<R: ReadRegister>(r: &mut R, clock_hz: u32) -> Result<Timing, SensorError<R::BusError>> {
    let (columns, rows) = (r.read_above_zero(&COLUMNS)?, r.read_above_zero(&ROWS)?);
    let line_pixels = columns + r.read(&COLUMN_BLANKING)? + r.read(&SAMPLE_HOLD)? + FURTHER_PIXELS;
    let further_rows = r.read(&ROW_BLANKING)? + r.read(&ROWS_BEFORE)? + r.read(&ROWS_AFTER)?;
    let [image_columns, image_rows] = image(r)?;
    let (kept_rows, of_rows) = subsampling(r, &SUBSAMPLE_ROWS, &KEPT_ROWS)?;
    let (kept_columns, of_columns) = subsampling(r, &SUBSAMPLE_COLUMNS, &KEPT_COLUMNS)?;
    let shrunk = |size: u32, kept: u32, of: u32| (size.saturating_sub(BORDER) * kept).checked_div(of).unwrap_or(size);
    let image_rows = image_rows.unwrap_or(shrunk(rows, kept_rows, of_rows)).max(1);
    let image_columns = image_columns.unwrap_or(shrunk(columns, kept_columns, of_columns)).max(1);
    let grown = |size: u32, kept: u32, of: u32| (size * of).checked_div(kept).unwrap_or(size);
    let lines = grown(image_rows, kept_rows, of_rows);
    Ok(Timing {
        line_clocks: line_pixels * CLOCKS_PER_PIXEL,
        clock: Clock::external(clock_hz)?.times(1, r.read(&CLOCK)? + 1),
        frame_lines: rows + further_rows,
        exposure_sixteenths: 16 * r.read(&EXPOSURE)?,
        automatic_exposure: r.is_set(&AUTOMATIC_EXPOSURE)?,
        mirrored: r.is_set(&MIRROR)?,
        flipped: r.is_set(&FLIP)?,
        columns: image_columns,
        rows: image_rows,
        lines,
        window: [r.read(&FIRST_COLUMN)?, r.read(&FIRST_ROW)?, grown(image_columns, kept_columns, of_columns), lines],
        evidence: Evidence::Described,
    })
}

/// Columns and rows of a cut image.
fn image<R: ReadRegister>(r: &mut R) -> Result<[Option<u32>; 2], SensorError<R::BusError>> {
    Ok(if r.is_set(&CROP)? {
        [Some(r.read_above_zero(&CROP_COLUMNS)?), Some(r.read_above_zero(&CROP_ROWS)?)]
    } else {
        [None, None]
    })
}
