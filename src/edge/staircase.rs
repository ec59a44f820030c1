//! [`each_step`]: the steps of a run of one sign that is more than one.
//!
//! Between two edges of one polarity that are near to each other the slope does not end, but it falls and rises again.
//! Two narrower windows slide over such a run once more, and each part from one valley to the next is a point.

use core::ops::Range;

use super::pixel_row::grey;
use super::scanned_point::ScannedPoint;
use super::step_sums::{StepSums, Windows};
use super::tuning::RISE_PARTS;
use crate::format::Pixels;

/// Pixels of either window: fewer than the scanner's own four blur the steps less, one alone would be of one colour.
const WINDOW: usize = 2;

/// More pixels than the flanks of steps take that are no wider than [`STAIRCASE_Q8`](super::tuning::STAIRCASE_Q8).
const MOST_PIXELS: usize = 64;

/// Hands over the steps at some positions of the scanner, where pixels differ by `sign`, if they are more than one: the
/// slope falls between them and rises again by `least`, more than noise explains.
pub(super) fn each_step(
    pixels: &impl Pixels,
    positions: Range<usize>,
    sign: i32,
    (least, noise_q8): (i32, u32),
    mut found: impl FnMut(ScannedPoint),
) -> bool {
    let (mut buffer, mut start) = ([0; MOST_PIXELS], positions.start);
    let mut rest = grey(pixels, start.saturating_sub(WINDOW)..positions.end + WINDOW - 1, &mut buffer);
    let mut is_staircase = false;
    loop {
        let end = step_end(rest, sign, least);
        is_staircase |= end.is_some();
        if !is_staircase {
            return false;
        }
        let length = end.unwrap_or(rest.len().saturating_sub(2 * WINDOW - 1));
        let (mut sums, step) = (StepSums::first(0), differences(rest, sign).take(length));
        (0..).zip(step).for_each(|(offset, size)| sums.add(size, offset));
        let windows = const { &Windows::of(WINDOW as u32) };
        sums.point(windows, start, length as u32, sign, noise_q8).into_iter().for_each(&mut found);
        let Some(end) = end else { return true };
        (start, rest) = (start + end, rest.get(end..).unwrap_or_default());
    }
}

/// How many differences the first step takes: to the lowest one behind its peak, if the slope rises again there.
fn step_end(pixels: &[u8], sign: i32, least: i32) -> Option<usize> {
    let (mut peak, mut valley, mut end) = (0, 0, 0);
    for (at, size) in differences(pixels, sign).enumerate() {
        let rise = least.max(valley / RISE_PARTS);
        if peak - valley >= rise && size - valley >= rise {
            return Some(end);
        }
        peak = peak.max(size);
        if size == peak || size < valley {
            (valley, end) = (size, at + 1);
        }
    }
    None
}

/// How much brighter the second window is than the first one, or darker, at each position.
fn differences(pixels: &[u8], sign: i32) -> impl Iterator<Item = i32> {
    pixels.windows(2 * WINDOW).map(move |windows| {
        let [left, near_left, near_right, right] =
            windows.first_chunk().copied().unwrap_or([0; 2 * WINDOW]).map(i32::from);
        (sign * (right + near_right - near_left - left)).max(0)
    })
}
