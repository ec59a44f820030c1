//! [`Scanner`]: one row of pixels in, its edge points out, in integers.
//!
//! A row is scanned twice. The coarse scan sums blocks of 16 pixels and keeps those whose sum differs from its
//! neighbour's by more than noise explains: plain sums, at the speed of memory. The fine scan, in those blocks alone,
//! slides the difference of two windows of four pixels over the row: each run of one sign above the noise is a point of
//! an edge, and the centroid of the run is its column.

use core::ops::Range;

use super::noise::{Across, Down, WINDOW};
use super::pixel_row::grey;
use super::point::{EdgePoint, Polarity};
use super::tuning::{LEAST_DIFFERENCE, LEAST_NOISE_Q8, THRESHOLD_SIGMAS, UPRIGHT_RATIO};
use crate::format::Pixels;

/// A point of an edge as a single row of pixels shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScannedPoint {
    /// Column in 1/65536 px; pixel centres are at whole numbers.
    pub column_q16: i32,
    /// One standard deviation of the column's noise in 1/65536 px.
    pub sigma_q16: u32,
    /// Width of the edge here (one sigma of its blur, the pixel's own included) in 1/256 px.
    pub width_q8: u16,
    /// Brightness on the right minus that on the left, in grey levels.
    pub contrast: i16,
}

impl ScannedPoint {
    /// Whether the edge goes from dark to bright or from bright to dark.
    #[must_use]
    pub const fn polarity(&self) -> Polarity {
        if self.contrast < 0 { Polarity::Falling } else { Polarity::Rising }
    }

    /// The point of `row`, whose exposure has its middle at `time_ns` since frame start.
    #[must_use]
    pub const fn at(&self, row: u16, time_ns: i64) -> EdgePoint {
        EdgePoint {
            time_ns,
            column_q16: self.column_q16,
            sigma_q16: self.sigma_q16,
            row,
            width_q8: self.width_q8,
            polarity: self.polarity(),
        }
    }
}

/// Finds the edge points of rows of pixels. All that it remembers is the noise and the texture of the rows so far, and
/// a few pixels of them: 64 bytes.
///
/// The threshold follows from the rows themselves, so neither exposure nor gain needs tuning: an edge is found where
/// the means of two neighbouring windows of four pixels differ by more than six grey levels and by more than four sigma
/// of what is usual in these rows, be it noise or texture. Both change down the rows as much as across them; where what
/// is usual across does not, upright edges are usual, as in a fence.
///
/// *Limits*: edges within eight pixels of the border are not found, nor any in rows of fewer than 32 pixels, nor a
/// fence over less than half of the row whose period goes into 16 pixels. *Cost*: one addition per pixel, and about ten
/// operations per pixel near an edge.
///
/// ```
/// use shutter_range::Scanner;
/// let mut row = [40_u8; 64];
/// row[32..].fill(200);
/// row[31] = 120; // half covered: the edge is in the middle of pixel 31
/// let mut scanner = Scanner::new();
/// let mut points = 0;
/// scanner.scan(&row, |point| {
///     assert_eq!((point.column_q16 + (1 << 8)) >> 9, 31 << 7);
///     points += 1;
/// });
/// assert_eq!(points, 1);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Scanner {
    across: Across,
    down: Down,
}

const BLOCK: usize = 16;
/// Blocks that are looked at together.
const GROUP: usize = 32;
/// Sum of squares of the offsets in the sliding difference, per unit of its area: its own variance as a blur, times 2.
const OWN_VARIANCE_Q1: i64 = 5;

impl Scanner {
    /// Edges at least this far apart have no pixel of their windows in common.
    pub(crate) const SEES_ALONE_Q16: u32 = (2 * WINDOW as u32) << 16;

    /// A scanner that has seen nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { across: Across::new(), down: Down::new() }
    }

    /// One sigma of a pixel's noise as the rows so far show it, in 1/256 grey level.
    #[must_use]
    pub const fn noise_q8(&self) -> u32 {
        let noise_q8 = usual(self.across.noise_q8(), self.down.noise_q8());
        if noise_q8 > LEAST_NOISE_Q8 { noise_q8 } else { LEAST_NOISE_Q8 }
    }

    /// The next row is the first of a frame. Without this the noise of its first rows is compared with the frame
    /// before.
    pub(crate) const fn begin_frame(&mut self) {
        self.down.begin_frame();
    }

    /// Scans a row, dark 0 to bright 255 if it is one of bytes, and hands its edge points to `found`, from left to
    /// right.
    pub fn scan(&mut self, pixels: impl Pixels, found: impl FnMut(ScannedPoint)) {
        self.scan_beside(pixels, &[], true, found);
    }

    /// Likewise, but for the flanks of known edges, from left to right: positions whose differences are these edges'
    /// own. What differs elsewhere in the blocks with such a flank is looked at only where that is asked for.
    pub(crate) fn scan_beside(
        &mut self,
        pixels: impl Pixels,
        flanks: &[Range<u16>],
        looks_beside: bool,
        mut found: impl FnMut(ScannedPoint),
    ) {
        self.across.learn(&pixels);
        self.down.learn(&pixels);
        let (noise_q8, least) = (self.noise_q8(), self.least_difference());
        let mut seen = 0;
        let mut look = |from, to| {
            between(flanks, from..to, |positions| {
                seen = fine(&pixels, positions, seen, (least as i32, noise_q8), &mut found);
            });
        };
        if is_upright(self.across.difference_q8(), self.down.difference_q8()) {
            // The sums of a fence whose period goes into a block do not differ.
            look(0, pixels.columns());
        } else {
            // An edge in the middle of a block moves the sums on either side by half of its contrast, or twice the
            // sliding difference.
            coarse(&pixels, 2 * least, if looks_beside { &[] } else { flanks }, look);
        }
    }

    /// Least sliding difference that counts, in grey levels.
    fn least_difference(&self) -> u32 {
        (THRESHOLD_SIGMAS * self.difference_q8().max(LEAST_DIFFERENCE << 6)) >> 8
    }

    /// One sigma of what a sliding difference usually is.
    fn difference_q8(&self) -> u32 {
        usual(self.across.difference_q8(), self.down.difference_q8()).max(self.difference_of_noise_q8())
    }

    /// One sigma of a sliding difference, which sums eight pixels.
    fn difference_of_noise_q8(&self) -> u32 {
        self.noise_q8() * 181 / 64
    }
}

/// Whether what is usual across a row is so much less down the rows that it is upright edges.
const fn is_upright(across: u32, down: u32) -> bool {
    across / UPRIGHT_RATIO > down
}

const fn usual(across: u32, down: u32) -> u32 {
    if is_upright(across, down) { down } else { across }
}

fn sum(pixels: &[u8]) -> i32 {
    pixels.iter().map(|pixel| i32::from(*pixel)).sum()
}

/// Hands over the stretches of pixels in which neighbouring blocks' sums differ by more than `limit`.
fn coarse(pixels: &impl Pixels, limit: u32, explained: &[Range<u16>], mut stretch: impl FnMut(usize, usize)) {
    let limit = u16::try_from(limit).unwrap_or(u16::MAX);
    let mut open: Option<(usize, usize)> = None;
    let mut last: Option<u16> = None;
    let (columns, mut at) = (pixels.columns(), 0);
    let mut buffer = [0; BLOCK * GROUP];
    while at * BLOCK < columns {
        let group = grey(pixels, at * BLOCK..(at + GROUP) * BLOCK, &mut buffer);
        // The sum before, then those of the group; both loops are simple enough for vector instructions.
        let mut sums = [0_u16; GROUP + 1];
        let filled = group.len() / BLOCK;
        for (sum, block) in sums.iter_mut().skip(1).zip(group.chunks_exact(BLOCK)) {
            *sum = block.iter().map(|pixel| u16::from(*pixel)).sum();
        }
        let [before, first, ..] = &mut sums;
        *before = last.unwrap_or(*first);
        last = sums.get(filled).copied();
        let steps = || sums.iter().zip(sums.iter().skip(1)).take(filled).map(|(a, b)| a.abs_diff(*b));
        let mut differing = 0_u32;
        if steps().fold(0, u16::max) > limit {
            for (index, step) in steps().enumerate() {
                differing |= u32::from(step > limit) << index;
            }
            differing &= !explained_boundaries(explained, at);
        }
        while differing != 0 {
            let block = at + differing.trailing_zeros() as usize;
            differing &= differing - 1;
            // The edge is in one of the two blocks, or its flanks reach into their neighbours.
            let (from, to) = (block.saturating_sub(1), block + 1);
            add_stretch(&mut open, (from, to), &mut stretch);
        }
        at += GROUP;
    }
    // The pixels beyond the last whole block, with as many before them as make a block.
    let mut buffer = [0; BLOCK];
    let tail = grey(pixels, columns.saturating_sub(BLOCK)..columns, &mut buffer);
    let tail_sum: u16 = tail.iter().map(|pixel| u16::from(*pixel)).sum();
    let blocks = columns / BLOCK;
    let (tail_from, to_end) = (blocks.saturating_sub(1), columns.div_ceil(BLOCK));
    if blocks < to_end && last.is_some_and(|last| tail_sum.abs_diff(last) > limit) {
        add_stretch(&mut open, (tail_from, to_end), &mut stretch);
    }
    if let Some((start, end)) = open {
        stretch(start * BLOCK, end * BLOCK);
    }
}

/// The boundaries of a group's blocks, each with the block before, whose differences lie in explained columns.
fn explained_boundaries(explained: &[Range<u16>], group: usize) -> u32 {
    let below = |block: usize| (1_u64 << block.saturating_sub(group).min(GROUP)) - 1;
    let of = |columns: &Range<u16>| {
        let (from, to) = (usize::from(columns.start) / BLOCK, usize::from(columns.end) / BLOCK + 2);
        below(to) & !below(from)
    };
    explained.iter().fold(0, |boundaries, columns| boundaries | of(columns)) as u32
}

/// Joins blocks to the stretch before them if they touch, or hands that one over and opens another.
fn add_stretch(open: &mut Option<(usize, usize)>, (from, to): (usize, usize), stretch: &mut impl FnMut(usize, usize)) {
    match open {
        Some((_, end)) if from <= *end => *end = to,
        _ => {
            if let Some((start, end)) = open.replace((from, to)) {
                stretch(start * BLOCK, end * BLOCK);
            }
        }
    }
}

/// Hands over the positions in which the windows reach into these pixels, but for those in a flank.
fn between(flanks: &[Range<u16>], pixels: Range<usize>, mut look: impl FnMut(Range<usize>)) {
    let (mut start, end) = (pixels.start.saturating_sub(WINDOW), pixels.end + WINDOW + 1);
    for flank in flanks {
        let (from, to) = (usize::from(flank.start), usize::from(flank.end));
        if from >= end {
            break;
        }
        if to > start {
            if from > start {
                look(start..from);
            }
            start = to;
        }
    }
    if start < end {
        look(start..end);
    }
}

/// Sums over a run of differences of one sign.
#[derive(Clone, Copy)]
struct Run {
    sign: i32,
    /// Position of the run's first difference.
    start: usize,
    area: i64,
    moment: i64,
    second: i64,
    length: i64,
    peak: i32,
    /// Lowest difference since the peak.
    valley: i32,
}

impl Run {
    fn begin(sign: i32, start: usize, size: i32) -> Self {
        let area = i64::from(size);
        Self { sign, start, area, moment: 0, second: 0, length: 1, peak: size, valley: size }
    }

    fn extend(&mut self, size: i32) {
        let (x, d) = (self.length, i64::from(size));
        self.area += d;
        self.moment += d * x;
        self.second += d * x * x;
        self.length += 1;
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

    fn edge(&self, noise_q8: u32) -> Option<ScannedPoint> {
        let area = self.area.max(1);
        // A step of contrast A adds up to 16 A.
        let contrast = (area + 8) >> 4;
        let off_q16 = (self.moment << 16) / area;
        // Position k is the boundary between pixels k − 1 and k.
        let column_q16 = ((self.start as i64) << 16) + off_q16 - (1 << 15);
        let variance_q16 = (self.second << 16) / area - ((off_q16 * off_q16) >> 16);
        let own_q16 = OWN_VARIANCE_Q1 << 15;
        // Not below the blur of a pixel alone.
        let blur_q16 = (variance_q16 - own_q16).max(1 << 13);
        let sigma_q16 = (u64::from(noise_q8) << 8) * (self.length as u64 * 256).isqrt() / (16 * contrast.max(1) as u64);
        Some(ScannedPoint {
            column_q16: i32::try_from(column_q16).ok()?,
            sigma_q16: u32::try_from(sigma_q16).ok()?.max(1),
            width_q8: u16::try_from((blur_q16 as u64).isqrt()).ok()?,
            contrast: i16::try_from(contrast * i64::from(self.sign)).ok()?,
        })
    }
}

/// Slides the difference of two windows over some positions and hands over each run of one sign beyond the noise. A run
/// that only partly lies there is followed to both its ends, but not before `seen`, the last position of an earlier
/// look. Returns the last one of this look.
fn fine(
    pixels: &impl Pixels,
    positions: Range<usize>,
    seen: usize,
    (least, noise_q8): (i32, u32),
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
    let mut run: Option<Run> = None;
    let mut followed = end;
    let mut close = |run: Run| {
        followed = followed.max(run.start + run.length as usize);
        if let Some(edge) = run.edge(noise_q8).filter(|_| is_whole(&run)) {
            found(edge);
        }
    };
    let mut take = |difference: i32, position: usize, run: &mut Option<Run>| {
        let size = difference.abs();
        let sign = if size > least { difference.signum() } else { 0 };
        match run {
            Some(open) if open.sign == sign && !open.rises_again(size, least) => open.extend(size),
            _ => {
                if let Some(ended) = run.take() {
                    close(ended);
                }
                *run = (sign != 0 && position < end).then(|| Run::begin(sign, position, size));
            }
        }
    };
    let mut buffer = [0; BLOCK + 2 * WINDOW];
    let mut next = first;
    while next < end || next < end_of_row && run.as_ref().is_some_and(is_whole) {
        let count = BLOCK.min(if next < end { end } else { end_of_row } - next);
        let at = next - WINDOW;
        let rest = grey(pixels, at..at + BLOCK + 2 * WINDOW, &mut buffer);
        let quiet = run.is_none() && count == BLOCK && rest.first_chunk().is_some_and(|pixels| is_quiet(pixels, least));
        if !quiet {
            slide(rest, count, |index, difference| {
                if run.is_some() || difference.abs() > least {
                    take(difference, next + index, &mut run);
                }
            });
        }
        next += count;
    }
    // A run that has not ended by the end of the row reaches beyond it.
    followed - 1
}

/// The position before the run that `position` is in, or `position` itself; not before `earliest`.
fn before_run(pixels: &impl Pixels, position: usize, earliest: usize, least: i32) -> usize {
    let sign_at = |position: usize| {
        let mut buffer = [0; 2 * WINDOW];
        let around = grey(pixels, position - WINDOW..position + WINDOW, &mut buffer);
        let (left, right) = around.split_at(WINDOW.min(around.len()));
        let difference = sum(right) - sum(left);
        if difference.abs() > least { difference.signum() } else { 0 }
    };
    let sign = sign_at(position);
    let mut before = position;
    while sign != 0 && before > earliest && sign_at(before) == sign {
        before -= 1;
    }
    before
}

/// Hands over the first `count` sliding differences.
fn slide(pixels: &[u8], count: usize, mut take: impl FnMut(usize, i32)) {
    let (left, right) = pixels.split_at(WINDOW.min(pixels.len()));
    let mut difference = sum(right.get(..WINDOW).unwrap_or_default()) - sum(left);
    take(0, difference);
    // The window moves by one: what enters on the right, changes sides, and leaves on the left.
    let moves = pixels.iter().zip(right).zip(right.iter().skip(WINDOW));
    for (index, ((leaves, changes), enters)) in moves.enumerate().take(count.saturating_sub(1)) {
        difference += i32::from(*enters) - 2 * i32::from(*changes) + i32::from(*leaves);
        take(index + 1, difference);
    }
}

/// Whether none of a block's sliding differences counts; simple enough for vector instructions.
fn is_quiet(pixels: &[u8; BLOCK + 2 * WINDOW - 1], least: i32) -> bool {
    let from = |index| pixels.iter().skip(index).map(|pixel| i16::from(*pixel));
    let mut sums = [0_i16; BLOCK + WINDOW];
    for ((((sum, a), b), c), d) in sums.iter_mut().zip(from(0)).zip(from(1)).zip(from(2)).zip(from(3)) {
        *sum = a + b + c + d;
    }
    let differences = sums.iter().zip(sums.iter().skip(WINDOW)).map(|(left, right)| (right - left).abs());
    i32::from(differences.fold(0, i16::max)) <= least
}
