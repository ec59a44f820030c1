//! Hints: sentences for a person about what is probably wrong with a picture.

use image::GrayImage;
use shutter_range::{Counters, PixelReport, Suspicion};

use crate::input::grey_levels::UnusedBits;

/// From the pixels of a frame.
pub(crate) fn of_pixels(pixels: &GrayImage, unused_bits: Option<UnusedBits>) -> Vec<String> {
    let report = report(pixels);
    // Unused bits are why there are few levels.
    let is_news = |suspicion: &Suspicion| unused_bits.is_none() || !matches!(suspicion, Suspicion::FewLevels { .. });
    let suspicions = report.suspicions().filter(is_news).map(|suspicion| suspicion.to_string());
    unused_bits.map(of_unused_bits).into_iter().chain(suspicions).collect()
}

/// Rows that could not be read whole, if there are any.
pub(crate) fn of_crowded_rows(counters: &Counters, rows: u16) -> Option<String> {
    let Counters { crowded_rows, dropped_points, .. } = *counters;
    (crowded_rows > 0).then(|| {
        let why = match dropped_points {
            0 => "texture or noise everywhere hides edges in them",
            _ => "they have more edges than the tables hold",
        };
        format!("{crowded_rows} of {rows} rows could not be read whole, and edges may be missing: {why}")
    })
}

/// Whether neighbouring columns alternate, as those of a colour mosaic do.
pub(crate) fn has_alternating_columns(pixels: &GrayImage) -> bool {
    report(pixels).suspicions().any(|suspicion| suspicion == Suspicion::AlternatingColumns)
}

fn report(pixels: &GrayImage) -> PixelReport {
    let mut report = PixelReport::new();
    pixels.as_raw().chunks_exact((pixels.width() as usize).max(1)).for_each(|row| report.row(row));
    report
}

fn of_unused_bits(UnusedBits { most, bits }: UnusedBits) -> String {
    format!(
        "no grey level is above {most} of 65535: if they have {bits} bits, say bits = {bits} in [camera] of the setup"
    )
}
