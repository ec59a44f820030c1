//! Frames painted by the test: dark upright bands before a bright wall, with known columns on each row.

use image::{DynamicImage, GrayImage, ImageFormat, Luma};

use crate::tool::column;

/// Bearings of the left and right edges of the bands, and their depth.
pub(crate) const BANDS: [([f64; 2], f64); 3] = [([-0.4, -0.35], 2.0), ([-0.1, -0.06], 1.2), ([0.2, 0.28], 3.0)];

/// Blurred by the pixels only: each is as bright as the part of it that the bands leave.
pub(crate) fn painted() -> GrayImage {
    painted_by(|row| row)
}

/// `rows_before` is how many rows are read before a row: it is where the camera has moved on to.
pub(crate) fn painted_by(rows_before: impl Fn(u32) -> u32) -> GrayImage {
    GrayImage::from_fn(640, 480, |x, row| {
        let covered = |([left, right], depth_m): ([f64; 2], f64)| {
            let [left, right] = [left, right].map(|bearing| column(bearing, depth_m, rows_before(row)));
            let (from, to) = (f64::from(x) - 0.5, f64::from(x) + 0.5);
            (right.min(to) - left.max(from)).max(0.0)
        };
        let cover: f64 = BANDS.into_iter().map(covered).sum();
        Luma([(200.0 - 160.0 * cover + noise(x, row)).round() as u8])
    })
}

/// Of ±3 grey levels, always the same: without any, the rounding of grey levels would be a pattern that moves with the
/// edges.
fn noise(x: u32, row: u32) -> f64 {
    let mixed = (x.wrapping_mul(0x9E37_79B1) ^ row.wrapping_mul(0x85EB_CA77)).wrapping_mul(0xC2B2_AE3D);
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x27D4_EB2F);
    f64::from(mixed >> 8) / f64::from(1 << 24) * 6.0 - 3.0
}

pub(crate) fn encoded(picture: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    picture.into().write_to(&mut file, format).expect("encoding a picture");
    file.into_inner()
}

pub(crate) fn png(picture: impl Into<DynamicImage>) -> Vec<u8> {
    encoded(picture, ImageFormat::Png)
}
