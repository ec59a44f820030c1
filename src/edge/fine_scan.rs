//! [`fine`]: the points of edges in a stretch of a row, from the difference of two windows that slides over it.

use core::ops::Range;

use super::noise::WINDOW;
use super::pixel_row::{difference, grey};
use super::scanned_point::ScannedPoint;
use super::staircase::each_step;
use super::step_sums::{StepSums, Windows};
use super::tuning::{ABRUPT, STAIRCASE_Q8};
use crate::format::Pixels;

/// Differences that are reckoned together.
const SLIDE: usize = 16;
/// One sigma of what is only known to a pixel, √(1/12), in 1/65536 px.
const PIXEL_SIGMA_Q16: u32 = 18_919;

/// A run of differences of one sign.
#[derive(Clone, Copy)]
struct Run {
    /// Zero where there is none.
    sign: i32,
    /// Position of the run's first difference.
    start: usize,
    sums: StepSums,
    length: u32,
    peak: i32,
    /// Lowest difference since the peak.
    valley: i32,
}

impl Run {
    /// Positions of the longest run that is an edge: ten times the longest blur that is told from a slope.
    const LONGEST: u32 = 128;

    const NONE: Self = Self::begin(0, 0, 0);

    const fn begin(sign: i32, start: usize, size: i32) -> Self {
        Self { sign, start, sums: StepSums::first(size), length: 1, peak: size, valley: size }
    }

    const fn end(&self) -> usize {
        self.start + self.length as usize
    }

    fn extend(&mut self, size: i32) {
        if self.length < Self::LONGEST {
            self.sums.add(size, self.length);
        }
        self.length = self.length.saturating_add(1);
        if size >= self.peak {
            (self.peak, self.valley) = (size, size);
        } else {
            self.valley = self.valley.min(size);
        }
    }

    /// Whether a second peak begins, after a valley of less than half the first one's height: another edge.
    fn rises_again(&self, size: i32, least: i32) -> bool {
        self.valley * 2 < self.peak && size > self.valley + least.max(self.peak / 4)
    }

    /// Whether all of a step lies between two pixels. Light is never so sharp: each pixel has been made black or white,
    /// and where in the pixel the edge was has been lost. Where sharpening has done it, the pixels beside overshoot.
    fn is_abrupt(&self, pixels: &impl Pixels, column_q16: i32) -> bool {
        let boundary = (column_q16 >> 16) as usize + 1;
        let mut buffer = [0; 4];
        let around = grey(pixels, boundary - 2..boundary + 2, &mut buffer).first_chunk().copied();
        let [before, left, right, after] = around.unwrap_or([0; 4]);
        let [step, beside] = [left.abs_diff(right), before.abs_diff(left).saturating_add(right.abs_diff(after))];
        let (most, parts) = ABRUPT;
        // The peak compares sums of four pixels.
        let is_whole = parts * WINDOW as u32 * u32::from(step) >= most * self.peak.unsigned_abs();
        is_whole && (parts - most) * u32::from(step) >= most * u32::from(beside)
    }

    fn edge(&self, pixels: &impl Pixels, noise_q8: u32) -> Option<ScannedPoint> {
        if self.length > Self::LONGEST {
            return None;
        }
        let point =
            self.sums.point(const { &Windows::of(WINDOW as u32) }, self.start, self.length, self.sign, noise_q8)?;
        if self.is_abrupt(pixels, point.column_q16) {
            return Some(ScannedPoint { sigma_q16: point.sigma_q16.max(PIXEL_SIGMA_Q16), ..point });
        }
        Some(point)
    }
}

/// Slides the difference of two windows over some positions and hands over each run of one sign beyond the noise. A run
/// that only partly lies there is followed to both its ends, but not before `seen`, the last position of an earlier
/// look. Returns the last one of this look.
pub(super) fn fine(
    pixels: &impl Pixels,
    positions: Range<usize>,
    seen: usize,
    (least, least_rise, noise_q8): (i32, i32, u32),
    found: &mut impl FnMut(ScannedPoint),
) -> usize {
    // Position k compares the pixels before k with those from there on, four of each.
    let (Some(last), earliest) = (pixels.columns().checked_sub(WINDOW), seen.max(WINDOW)) else { return seen };
    let (end, end_of_row) = (positions.end.min(last + 1), last + 1);
    let start = positions.start.max(earliest);
    if start >= end {
        return seen;
    }
    let first = before_run(pixels, start, earliest, least);
    // What begins a row may have begun before it, and its centroid would be off.
    let is_whole = |run: &Run| run.start > first;
    let mut run = Run::NONE;
    let mut followed = end;
    let mut close = |run: &Run| {
        followed = followed.max(run.end());
        let Some(edge) = run.edge(pixels, noise_q8).filter(|_| is_whole(run)) else { return };
        // What is wider the run itself shows to be two.
        let is_staircase = STAIRCASE_Q8.contains(&edge.width_q8)
            && each_step(pixels, run.start..run.end(), run.sign, (least_rise, noise_q8), &mut *found);
        if !is_staircase {
            found(edge);
        }
    };
    let mut buffer = [0; SLIDE + 2 * WINDOW];
    let mut next = first;
    while next < end || next < end_of_row && run.sign != 0 && is_whole(&run) {
        let count = SLIDE.min(if next < end { end } else { end_of_row } - next);
        let at = next - WINDOW;
        let rest = grey(pixels, at..at + SLIDE + 2 * WINDOW, &mut buffer);
        slide(rest, count, |index, difference| {
            let (size, position) = (difference.abs(), next + index);
            if size <= least && run.sign == 0 {
                return;
            }
            let sign = if size > least { difference.signum() } else { 0 };
            if sign == run.sign && !run.rises_again(size, least) {
                run.extend(size);
                return;
            }
            if run.sign != 0 {
                close(&run);
            }
            run = if position < end { Run::begin(sign, position, size) } else { Run::NONE };
        });
        next += count;
    }
    // A run that has not ended by the end of the row reaches beyond it.
    followed - 1
}

/// The position before the run that `position` is in, or `position` itself; not before `earliest`.
fn before_run(pixels: &impl Pixels, position: usize, earliest: usize, least: i32) -> usize {
    let sign_at = |position: usize| {
        let mut buffer = [0; 2 * WINDOW];
        let difference = difference(grey(pixels, position - WINDOW..position + WINDOW, &mut buffer));
        if difference.abs() > least { difference.signum() } else { 0 }
    };
    let sign = sign_at(position);
    let mut before = position;
    while sign != 0 && before > earliest && sign_at(before) == sign {
        before -= 1;
    }
    before
}

/// Hands over the first `count` sliding differences, of which there is one at least.
#[inline(always)]
fn slide(pixels: &[u8], count: usize, mut take: impl FnMut(usize, i32)) {
    let from = |pixel: usize| pixels.get(pixel..).unwrap_or_default();
    let mut moved = pixels.iter().zip(from(WINDOW)).zip(from(2 * WINDOW));
    let (mut difference, mut index) = (difference(pixels), 0);
    loop {
        take(index, difference);
        index += 1;
        // The window moves by one: what leaves on the left, changes sides, and enters on the right.
        match moved.next() {
            Some(((leaves, changes), enters)) if index < count => {
                difference += i32::from(*enters) - 2 * i32::from(*changes) + i32::from(*leaves);
            }
            _ => return,
        }
    }
}
