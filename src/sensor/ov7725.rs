//! OV7725 and OV7720.
//!
//! A line is 784 pixel periods of two clocks and a frame 510 lines, or 576 and 278 in QVGA, where the sensor skips.
//! Both agree with the frame rates that OpenMV states for its cameras (60 and 150 a second at 48 MHz).
//!
//! *Open*: Linux writes 748 for 784, against the data sheet's 30 frames a second at 24 MHz: taken for a slip. Bayer
//! formats take one clock a pixel by OpenMV alone: [`Evidence::Described`].

use super::description::{Description, FrameSetting, ReadRegister, SCCB, Setting};
use super::error::SensorError;
use super::mode::{Clock, Evidence, Timing};
use super::ov7670::pll_multiplier;
use super::register::registers;

registers! {
    PRODUCT = "PID": 0x0a => "product: 0x77";
    MAKER = "MIDH, MIDL": 0x1c, 0x1d => "maker: 0x7fa2, OmniVision";
    CLOCK = "CLKRC[6:0]": 0x11 / 0x7f => "[6] no divider, [5:0] divider n: the clock is divided by 2(n + 1)";
    PLL = "COM4[7:6]": 0x0d / 0xc0 => "PLL: none, x4, x6, x8";
    QVGA = "COM7[6]": 0x12 / 0x40 => "QVGA: every second row and column is skipped";
    FORMAT = "COM7[1:0]": 0x12 / 0x03 => "YUV 0, processed Bayer 1, RGB 2, Bayer 3";
    DUMMY_PIXELS = "EXHCH[7:4], EXHCL": 0x2a / 0xf0, 0x2b => "further pixel periods in a line";
    DUMMY_LINES = "ADVFH, ADVFL": 0x2e, 0x2d => "further lines in a frame";
    NIGHT_LINES = "DM_LNH, DM_LNL": 0x34, 0x33 => "further lines in a frame";
    FIRST_COLUMN = "HSTART, HREF[5:4]": 0x17, 0x32 / 0x30 => "start of the window in pixel periods";
    FIRST_ROW = "VSTART, HREF[6]": 0x19, 0x32 / 0x40 => "start of the window in lines";
    COLUMNS = "HSIZE, HREF[1:0]": 0x18, 0x32 / 0x03 => "columns of the window";
    ROWS = "VSIZE, HREF[2]": 0x1a, 0x32 / 0x04 => "rows of the window";
    OUTPUT_COLUMNS = "HOUTSIZE, EXHCH[1:0]": 0x29, 0x2a / 0x03 => "columns of the image";
    OUTPUT_ROWS = "VOUTSIZE, EXHCH[2]": 0x2c, 0x2a / 0x04 => "rows of the image";
    EXPOSURE = "AECH, AEC": 0x08, 0x10 => "exposure in lines";
    AUTOMATIC_EXPOSURE = "COM8[0]": 0x13 / 0x01 => "automatic exposure";
    FLIP = "COM3[7]": 0x0c / 0x80 => "upside down";
    MIRROR = "COM3[6]": 0x0c / 0x40 => "mirror left to right";
}

pub(super) static DESCRIPTION: Description = Description {
    name: "OV7725",
    addresses: &[0x21],
    protocol: SCCB,
    identity: &[(&PRODUCT, 0x77), (&MAKER, 0x7fa2)],
    registers: REGISTERS,
    exposure: Setting { register: &EXPOSURE, shift: 0 },
    manual_exposure: (&AUTOMATIC_EXPOSURE, 0),
    exposure_margin_lines: 2,
    frame: FrameSetting::Further(&DUMMY_LINES),
    commit: None,
};

/// Pixel periods of a line, lines of a frame, and pixels of the array for each that is read: in VGA and in QVGA.
const VGA: (u32, u32, u32) = (784, 510, 1);
const QVGA_SIZES: (u32, u32, u32) = (576, 278, 2);

pub(super) fn timing<R: ReadRegister>(r: &mut R, clock_hz: u32) -> Result<Timing, SensorError<R::BusError>> {
    let (line_pixels, frame_lines, skip) = if r.is_set(&QVGA)? { QVGA_SIZES } else { VGA };
    let is_bayer = r.read(&FORMAT)? & 0x01 != 0;
    let (clocks_per_pixel, evidence) = if is_bayer { (1, Evidence::Described) } else { (2, Evidence::Confirmed) };
    let divider = r.read(&CLOCK)?;
    let divisor = if divider & 0x40 != 0 { 1 } else { 2 * (divider + 1) };
    let multiplier = pll_multiplier(r.read(&PLL)?);
    let (columns, lines) = (r.read_above_zero(&COLUMNS)?, r.read_above_zero(&ROWS)?);
    Ok(Timing {
        line_clocks: (line_pixels + r.read(&DUMMY_PIXELS)?) * clocks_per_pixel,
        clock: Clock::external(clock_hz)?.times(multiplier, divisor),
        frame_lines: frame_lines + r.read(&DUMMY_LINES)? + r.read(&NIGHT_LINES)?,
        exposure_sixteenths: 16 * r.read(&EXPOSURE)?,
        automatic_exposure: r.is_set(&AUTOMATIC_EXPOSURE)?,
        mirrored: r.is_set(&MIRROR)?,
        flipped: r.is_set(&FLIP)?,
        columns: r.read_above_zero(&OUTPUT_COLUMNS)?,
        rows: r.read_above_zero(&OUTPUT_ROWS)?,
        lines,
        window: [r.read(&FIRST_COLUMN)?, r.read(&FIRST_ROW)?, columns * skip, lines * skip],
        evidence,
    })
}
