//! What the programs share that are measured for their size: a QVGA camera, a moving post, and telling the stack
//! without `core::fmt`.

use crate::{Number, stack};
use semihosting::fs::File;
use semihosting::io::Read;
use semihosting::sys::arm_compat::sys_writec;
use shutter_range::{EdgePoint, ParameterError, Ranger, Scalar, Setup, Strict, Twist};

pub const COLUMNS: u16 = 320;
pub const ROWS: u16 = 240;

/// The tables: 8 lines, and 12 points on a row: that and the stack fit in 10 KiB.
pub type Tables = Ranger<8, 8, 12>;

/// The same without repair of lines.
pub type StrictTables = Ranger<8, 8, 12, Strict>;

/// QVGA at 30 frames a second.
pub fn setup() -> Result<Setup<Number>, ParameterError> {
    Setup::pinhole(COLUMNS, ROWS, Number::from_i32(300), 33_300_000)
}

/// 1.5 m/s sideways.
pub fn velocity_m_s() -> [Number; 3] {
    [Number::ratio(-3, 2), Number::ZERO, Number::ZERO]
}

pub fn motion() -> Result<Twist<Number>, ParameterError> {
    Twist::level(velocity_m_s())
}

/// One row of a picture with a bright post that leans as a moving camera sees it. A camera's rows would come by DMA.
pub fn paint(row: u16, pixels: &mut [u8; COLUMNS as usize]) {
    for (side, polarity) in [(100 << 8, 1), (130 << 8, -1)] {
        let edge_q8 = side + 15 * i32::from(row);
        for (column, pixel) in (0_i32..).zip(pixels.iter_mut()) {
            let covered = ((column << 8) - edge_q8).clamp(0, 256);
            let noise = (column * 7919 + i32::from(row) * 104_729) % 5;
            let before = if polarity > 0 { 40 + noise } else { i32::from(*pixel) };
            *pixel = (before + ((polarity * covered * 150) >> 8)) as u8;
        }
    }
    core::hint::black_box(pixels);
}

/// A point of that post's left side, as a detector of one's own would deliver it.
pub fn point(setup: &Setup<Number>, row: u16) -> EdgePoint {
    let column_q16 = core::hint::black_box((100 << 16) + 3840 * i32::from(row));
    EdgePoint::new(row, column_q16, setup.readout().row_time_ns(row))
}

/// The rows of the frame that the host has rendered, as a camera delivers them; ends where `take` says that it went wrong.
pub fn rows(mut take: impl FnMut(u16, &[u8]) -> bool) -> bool {
    let Ok(mut camera) = File::open(c"job") else { return false };
    let mut pixels = [0; COLUMNS as usize];
    (0..ROWS).all(|row| camera.read_exact(&mut pixels).is_ok() && take(row, &pixels))
}

/// Runs a program on a painted stack, and tells how much of it was used; its exit code says whether it went well.
pub fn measure(program: impl FnOnce() -> bool) -> ! {
    let above = stack::above();
    let painted = stack::Painted::below(stack::free().min(1 << 17));
    let went_well = program();
    let mut rest = (above + painted.used()) as u32;
    for scale in [100_000, 10_000, 1000, 100, 10, 1_u32] {
        // A division that could panic would bring `core::fmt` with it.
        let digit = rest.checked_div(scale).unwrap_or(0);
        sys_writec(b'0' + digit as u8);
        rest -= digit * scale;
    }
    sys_writec(b'\n');
    semihosting::process::exit(if went_well { 0 } else { 1 })
}
