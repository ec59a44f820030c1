//! Hints: sentences for a person about what is probably wrong with a setup or a picture, from what is found in a frame.

use image::GrayImage;
use shutter_range::{Range, RangeStatus, Setup};

use crate::input::grey_levels::UnusedBits;

/// An edge alone may be what it seems.
const FEWEST_EDGES: usize = 2;

/// From what has become of all edges of a frame together.
pub(crate) fn of_ranges(ranges: &[Range<f64>], setup: &Setup<f64>) -> Option<String> {
    let [sound, far] = [RangeStatus::Ok, RangeStatus::Far].map(|status| Share::of(ranges, status));
    let lean = if setup.motion_blur().is_some() {
        "lean by their fit or their blur: if they are upright, check exposure_s, lens_blur_px and response; with \
         sharpened or compressed frames leave exposure_s out"
    } else {
        "lean: if they are upright, check gravity, readout_s and distortion"
    };
    let suspicions = [
        // What is far has hardly any slope, whatever the motion is.
        (
            RangeStatus::Inconsistent,
            "slope against the motion: check the sign of velocity_m_s, direction, or a mirrored image",
        ),
        (RangeStatus::Leaning, lean),
        (
            RangeStatus::Slow,
            "are slow: check velocity_m_s; motion along the optical axis or along the edges shows no depth",
        ),
        (
            RangeStatus::Bent,
            "are bent: check motion and distortion, and whether the frames are as the sensor read them",
        ),
        (RangeStatus::Sideways, "run along the rows: check gravity, and whether the picture was rotated"),
    ];
    suspicions.into_iter().find_map(|(status, what)| {
        let found = Share::of(ranges, status);
        let is_most = found.points > sound.points && 3 * found.points > far.points;
        (is_most && found.edges >= FEWEST_EDGES)
            .then(|| format!("{} of {} edges {what}", found.edges, found.edges + sound.edges + far.edges))
    })
}

/// The ranges of one status. Their points tell more than their number: fragments and texture have few.
struct Share {
    edges: usize,
    points: usize,
}

impl Share {
    fn of(ranges: &[Range<f64>], status: RangeStatus) -> Self {
        let points = ranges.iter().filter(|range| range.status == status).map(|range| usize::from(range.points));
        Self { edges: points.clone().count(), points: points.sum() }
    }
}

/// From the pixels of a frame.
pub(crate) fn of_pixels(pixels: &GrayImage, unused_bits: Option<UnusedBits>) -> Vec<String> {
    let grey_levels = unused_bits.map_or_else(|| of_contrast(pixels), |unused| Some(of_unused_bits(unused)));
    grey_levels.into_iter().chain(of_columns(pixels)).collect()
}

fn of_unused_bits(UnusedBits { most, bits }: UnusedBits) -> String {
    format!(
        "no grey level is above {most} of 65535: if they have {bits} bits, say bits = {bits} in [camera] of the setup"
    )
}

/// Grey levels that use a hundredth of their range.
fn of_contrast(pixels: &GrayImage) -> Option<String> {
    const LEAST_LEVELS: usize = 4;
    let mut counts = [0_usize; 256];
    for level in pixels.as_raw() {
        counts[usize::from(*level)] += 1;
    }
    // A few hot pixels are no picture.
    let few = pixels.as_raw().len() / 1000;
    let [darkest, brightest] = [level_after(counts.iter(), few)?, 255 - level_after(counts.iter().rev(), few)?];
    let is_flat = brightest - darkest < LEAST_LEVELS;
    is_flat.then(|| {
        format!("nearly all grey levels are {darkest} to {brightest} of 255: check exposure, lens cap and pixel format")
    })
}

/// The first level up to which there are more than `few` pixels.
fn level_after<'a>(counts: impl Iterator<Item = &'a usize>, few: usize) -> Option<usize> {
    let mut sum = 0;
    counts.into_iter().position(|count| {
        sum += count;
        sum > few
    })
}

/// Columns that alternate, as those of a colour mosaic do.
fn of_columns(pixels: &GrayImage) -> Option<String> {
    (alternating_rows(pixels) > 0.5)
        .then(|| "neighbouring columns alternate: convert a Bayer mosaic or YUYV to grey first".to_string())
}

/// Share of the rows whose neighbouring columns alternate.
pub(crate) fn alternating_rows(pixels: &GrayImage) -> f64 {
    let rows = pixels.as_raw().chunks_exact((pixels.width() as usize).max(1));
    let (all, alternating) = (rows.len(), rows.filter(|row| alternates(row)).count());
    alternating as f64 / all.max(1) as f64
}

/// Whether nearly all pixels of a row differ from both of their neighbours, with signs that alternate.
fn alternates(row: &[u8]) -> bool {
    const LEAST_LEVELS: i32 = 4;
    let mut higher = [0_usize; 2];
    for (index, pixels) in row.windows(3).enumerate() {
        if let [left, middle, right] = *pixels {
            let above = 2 * i32::from(middle) - i32::from(left) - i32::from(right);
            if above.abs() >= LEAST_LEVELS {
                // The higher one of each pair of columns.
                higher[(index + usize::from(above < 0)) % 2] += 1;
            }
        }
    }
    let [even, odd] = higher;
    even.max(odd) * 10 > row.len() * 7
}
