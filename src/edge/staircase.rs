//! [`each_step`]: the steps of a run of one sign that is more than one.
//!
//! Between two edges of one polarity that are near to each other the slope does not end, but it falls and rises again.
//! Two narrower windows slide over such a run once more, and each part from one valley to the next is a point.

use core::ops::Range;

use super::pixel_row::grey;
use super::scanned_point::ScannedPoint;
use super::step_sums::StepSums;
use super::tuning::RISE_PARTS;
use crate::format::Pixels;

/// Pixels of either window: fewer than the scanner's own four blur the steps less, one alone would be of one colour.
const WINDOW: usize = 2;

/// More pixels than the flanks of steps take that are no wider than [`STAIRCASE_Q8`](super::tuning::STAIRCASE_Q8).
const MOST_PIXELS: usize = 64;

/// One step and what may be the next one.
struct Step {
    start: usize,
    peak: i32,
    /// The lowest difference since the peak, and where it is.
    valley: i32,
    valley_at: usize,
}

impl Step {
    const fn begin(start: usize, size: i32) -> Self {
        Self { start, peak: size, valley: size, valley_at: start }
    }

    fn extend(&mut self, size: i32, at: usize) {
        self.peak = self.peak.max(size);
        if size == self.peak || size < self.valley {
            (self.valley, self.valley_at) = (size, at);
        }
    }

    /// Whether another step begins, after a valley.
    fn rises_again(&self, size: i32, least: i32) -> bool {
        let rise = least.max(self.valley / RISE_PARTS);
        self.peak - self.valley >= rise && size - self.valley >= rise
    }
}

/// Hands over the steps at some positions of the scanner, where pixels differ by `sign`, if they are more than one: the
/// slope falls between them and rises again by `least`, more than noise explains.
pub(super) fn each_step(
    pixels: &impl Pixels,
    positions: Range<usize>,
    sign: i32,
    (least, noise_q8): (i32, u32),
    mut found: impl FnMut(ScannedPoint),
) -> bool {
    let mut buffer = [0; MOST_PIXELS];
    let first = positions.start;
    let around = grey(pixels, first.saturating_sub(WINDOW)..positions.end + WINDOW - 1, &mut buffer);
    let mut hand_over = |of_step: Range<usize>| {
        let (start, length) = (of_step.start, of_step.len() as u32);
        let mut sums = StepSums::first(0);
        let sizes = sizes(around, sign).skip(start).take(of_step.len());
        (0..).zip(sizes).for_each(|(offset, size)| sums.add(size, offset));
        sums.point::<{ WINDOW as u32 }>(first + start, length, sign, noise_q8).into_iter().for_each(&mut found);
    };
    let (mut step, mut is_staircase) = (Step::begin(0, 0), false);
    for (at, size) in sizes(around, sign).enumerate() {
        if step.rises_again(size, least) {
            hand_over(step.start..step.valley_at + 1);
            step = Step::begin(step.valley_at + 1, size);
            is_staircase = true;
        }
        step.extend(size, at);
    }
    if is_staircase {
        hand_over(step.start..positions.len());
    }
    is_staircase
}

/// How much brighter the second window is than the first one, or darker, at each position.
fn sizes(pixels: &[u8], sign: i32) -> impl Iterator<Item = i32> {
    pixels.windows(2 * WINDOW).map(move |windows| {
        let (left, right) = windows.split_at(WINDOW.min(windows.len()));
        let sum = |pixels: &[u8]| pixels.iter().map(|pixel| i32::from(*pixel)).sum::<i32>();
        (sign * (sum(right) - sum(left))).max(0)
    })
}
