//! OV7670 and OV7675, which identify alike.
//!
//! A line is 784 pixel periods, a frame 510 lines, in every resolution; scaling leaves out rows of what was read.
//!
//! *Open*: with CLKRC bit 7 clear and a divider above zero, two drivers divide by n + 1 (Linux for the OV7675,
//! Adafruit), the implementation guide by 2(n + 1): [`Evidence::Disputed`]. With bit 7 set it divides by n + 1 (a
//! measurement in Arduino's forum: 13.7 and 0.43 frames a second at 11 MHz with n = 0 and 31), and n = 0 without it
//! halves (an oscilloscope at Linux, 30 frames a second at 12 MHz × 4 in esp32-camera). Raw Bayer takes one clock a
//! pixel by two drivers, and half as many lines a second by the guide of its elder sister. Where scaling is not set
//! by hand, rows follow the pixel clock's divider as columns do.

use super::description::{Description, FrameSetting, ReadRegister, SCCB, Setting};
use super::error::SensorError;
use super::mode::{Clock, Evidence, Timing};
use super::register::registers;

registers! {
    PRODUCT = "PID": 0x0a => "product: 0x76";
    MAKER = "MIDH, MIDL": 0x1c, 0x1d => "maker: 0x7fa2, OmniVision";
    CLOCK = "CLKRC": 0x11 => "[7] divider without a further halving, [6] no divider, [5:0] divider less one";
    PLL = "DBLV[7:6]": 0x6b / 0xc0 => "PLL: none, x4, x6, x8";
    FORMAT = "COM7": 0x12 => "[5:3] preset: VGA 0, QCIF 1, QVGA 2, CIF 4; [2] RGB, [0] Bayer";
    DUMMY_PIXELS = "EXHCH[7:4], EXHCL": 0x2a / 0xf0, 0x2b => "pixel periods beside 784 in a line";
    DUMMY_LINES = "ADVFH, ADVFL": 0x2e, 0x2d => "lines beside 510 in a frame";
    NIGHT_LINES = "DM_LNH, DM_LNL": 0x93, 0x92 => "further lines in a frame";
    FIRST_COLUMN = "HSTART": 0x17, 0x32 / 0x07 => "start of the window in pixel periods";
    END_COLUMN = "HSTOP": 0x18, 0x32 / 0x38 => "end of the window in pixel periods; may lie in the next line";
    FIRST_ROW = "VSTART": 0x19, 0x03 / 0x03 => "start of the window in lines";
    END_ROW = "VSTOP": 0x1a, 0x03 / 0x0c => "end of the window in lines";
    SCALING = "COM3[3:2]": 0x0c / 0x0c => "[1] zoom, [0] downsampling";
    PIXEL_CLOCK_DIVIDER = "COM14[3:0]": 0x3e / 0x0f => "[3] scaling by hand, [2:0] columns are divided by 2 to this";
    DOWNSAMPLING = "SCALING_DCWCTR[5:4]": 0x72 / 0x30 => "rows are divided by 2 to this";
    ZOOM = "SCALING_YSC[6:0]": 0x71 / 0x7f => "rows are divided by this over 32";
    EXPOSURE = "AEC[15:0]": 0x07 / 0x3f, 0x10, 0x04 / 0x03 => "exposure in lines";
    AUTOMATIC_EXPOSURE = "COM8[0]": 0x13 / 0x01 => "automatic exposure";
    MIRROR = "MVFP[5]": 0x1e / 0x20 => "mirror left to right";
    FLIP = "MVFP[4]": 0x1e / 0x10 => "upside down";
}

pub(super) static DESCRIPTION: Description = Description {
    name: "OV7670",
    addresses: &[0x21],
    protocol: SCCB,
    identity: &[(&PRODUCT, 0x76), (&MAKER, 0x7fa2)],
    registers: REGISTERS,
    exposure: Setting { register: &EXPOSURE, shift: 0 },
    manual_exposure: (&AUTOMATIC_EXPOSURE, 0),
    exposure_margin_lines: 2,
    frame: FrameSetting::Further(&DUMMY_LINES),
    commit: None,
};

const LINE_PIXELS: u32 = 784;
const FRAME_LINES: u32 = 510;

/// Zoom of one.
const UNITY: u32 = 32;

pub(super) fn timing<R: ReadRegister>(r: &mut R, clock_hz: u32) -> Result<Timing, SensorError<R::BusError>> {
    let format = r.read(&FORMAT)?;
    let (clock, of_clock) = clock(r, clock_hz)?;
    let is_bayer = format & 0x01 != 0;
    let (clocks_per_pixel, of_format) = if is_bayer { (1, Evidence::Disputed) } else { (2, Evidence::Confirmed) };
    let window = window(r)?;
    let [.., window_columns, lines] = window;
    let ([columns, rows], of_size) = image(r, format, window_columns, lines)?;
    Ok(Timing {
        line_clocks: (LINE_PIXELS + r.read(&DUMMY_PIXELS)?) * clocks_per_pixel,
        clock,
        frame_lines: FRAME_LINES + r.read(&DUMMY_LINES)? + r.read(&NIGHT_LINES)?,
        exposure_sixteenths: 16 * r.read(&EXPOSURE)?,
        automatic_exposure: r.is_set(&AUTOMATIC_EXPOSURE)?,
        mirrored: r.is_set(&MIRROR)?,
        flipped: r.is_set(&FLIP)?,
        columns,
        rows,
        lines,
        window,
        evidence: of_clock.max(of_format).max(of_size),
    })
}

fn clock<R: ReadRegister>(r: &mut R, clock_hz: u32) -> Result<(Clock, Evidence), SensorError<R::BusError>> {
    let register = r.read(&CLOCK)?;
    let multiplier = pll_multiplier(r.read(&PLL)?);
    let is_set = |bit: u32| register & (1 << bit) != 0;
    let (divisor, evidence) = match register & 0x3f {
        _ if is_set(6) => (1, Evidence::Confirmed),
        n if is_set(7) => (n + 1, Evidence::Confirmed),
        0 => (2, Evidence::Confirmed),
        n => (n + 1, Evidence::Disputed),
    };
    Ok((Clock::external(clock_hz)?.times(multiplier, divisor), evidence))
}

/// The PLL of this family by its two bits.
pub(super) fn pll_multiplier(bits: u32) -> u32 {
    match bits {
        0 => 1,
        1 => 4,
        2 => 6,
        _ => 8,
    }
}

/// First column and row, columns and rows of the window.
fn window<R: ReadRegister>(r: &mut R) -> Result<[u32; 4], SensorError<R::BusError>> {
    let (first_column, end_column) = (r.read(&FIRST_COLUMN)?, r.read(&END_COLUMN)?);
    let (first_row, end_row) = (r.read(&FIRST_ROW)?, r.read(&END_ROW)?);
    // The horizontal counter turns over within the window.
    let end = if end_column > first_column { end_column } else { end_column + LINE_PIXELS };
    let Some(columns) = end.checked_sub(first_column).filter(|columns| (1..LINE_PIXELS).contains(columns)) else {
        let expected = "after HSTART, by less than a line";
        return Err(SensorError::Register { register: &END_COLUMN, value: end_column, expected });
    };
    let Some(rows) = end_row.checked_sub(first_row).filter(|rows| *rows > 0) else {
        return Err(SensorError::Register { register: &END_ROW, value: end_row, expected: "after VSTART" });
    };
    Ok([first_column, first_row, columns, rows])
}

/// Columns and rows of the image.
fn image<R: ReadRegister>(
    r: &mut R,
    format: u32,
    columns: u32,
    rows: u32,
) -> Result<([u32; 2], Evidence), SensorError<R::BusError>> {
    match (format >> 3) & 0x07 {
        0 => scaled(r, columns, rows),
        1 => Ok(([176, 144], Evidence::Confirmed)),
        2 => Ok(([320, 240], Evidence::Confirmed)),
        4 => Ok(([352, 288], Evidence::Confirmed)),
        _ => Err(SensorError::Register { register: &FORMAT, value: format, expected: "one preset" }),
    }
}

fn scaled<R: ReadRegister>(
    r: &mut R,
    columns: u32,
    rows: u32,
) -> Result<([u32; 2], Evidence), SensorError<R::BusError>> {
    let (scaling, divider) = (r.read(&SCALING)?, r.read(&PIXEL_CLOCK_DIVIDER)?);
    let (mut columns, mut rows, mut evidence) = (columns, rows, Evidence::Confirmed);
    if scaling & 0b01 != 0 {
        let by_hand = divider & 0x08 != 0;
        let of_rows = if by_hand { r.read(&DOWNSAMPLING)? } else { divider & 0x07 };
        (columns, rows) = (columns >> (divider & 0x07), rows >> of_rows);
        evidence = if by_hand { Evidence::Confirmed } else { Evidence::Described };
    }
    if scaling & 0b10 != 0 {
        // The pixel clock's divider counts the zoom of the columns.
        rows = (rows * UNITY).checked_div(r.read_above_zero(&ZOOM)?).unwrap_or(rows);
    }
    Ok(([columns.max(1), rows.max(1)], evidence))
}
