//! [`Scanner`]: one row of pixels in, its edge points out, in integers.
//!
//! A row is scanned twice. The coarse scan compares the sums of four pixels before and after every second boundary and
//! keeps the spans of eight pixels where they differ by more than noise explains. The fine scan, in those spans alone,
//! slides the difference of the two windows over the row: each run of one sign above the noise is a point of an edge,
//! and the centroid of the run is its column.

use core::ops::Range;

use super::noise::{Across, Down, WINDOW};
use super::pixel_row::grey;
use super::point::{EdgePoint, Polarity};
use super::tuning::{
    LEAST_DIFFERENCE, LEAST_NOISE_Q8, MOST_HIDDEN, NOISE_SIGMAS, PEAK_SIGMAS_Q1, TEXTURE_SIGMAS, UPRIGHT_RATIO,
};
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
/// of what is usual in these rows, or three where that is not noise but texture. Both change down the rows as much as
/// across them; where what is usual across does not, upright edges are usual, as in a fence.
///
/// *Limits*: edges within eight pixels of the border are not found, nor any in rows of fewer than 32 pixels; a fence
/// whose contrast is below 40 levels may pass for texture. *Cost*: some six instructions a pixel, and fifteen more near
/// an edge.
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

/// Pixels of a span: two words of four. What is compared when its turn comes are four boundaries of which the first is
/// a word before it.
const SPAN: usize = 2 * WINDOW;
/// Spans that are looked at together.
const GROUP: usize = 32;
/// Differences that are reckoned together.
const SLIDE: usize = 16;
/// Sum of squares of the offsets in the sliding difference, per unit of its area: its own variance as a blur, times 2.
const OWN_VARIANCE_Q1: u32 = 5;

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
        let _ = self.scan_where(pixels, None, &[], true, found);
    }

    /// Likewise, but only in the columns that are asked for, where these are given, and but for the flanks of known
    /// edges, from left to right: positions whose differences are these edges' own. What differs elsewhere in the spans
    /// with such a flank is looked at where `looks_beside` says so. Whether texture or noise everywhere hides edges
    /// that are anything but faint.
    pub(crate) fn scan_where(
        &mut self,
        pixels: impl Pixels,
        asked: Option<&[Range<u16>]>,
        flanks: &[Range<u16>],
        looks_beside: bool,
        mut found: impl FnMut(ScannedPoint),
    ) -> bool {
        self.across.learn(&pixels);
        self.down.learn(&pixels);
        let noise_q8 = self.noise_q8();
        // One sigma of a difference, which sums eight pixels.
        let of_noise_q8 = noise_q8 * 181 / 64;
        let usual_q8 = usual(self.across.difference_q8(), self.down.difference_q8()).max(of_noise_q8);
        // What is usual is texture where noise does not explain half of it.
        let of_texture_q8 = (TEXTURE_SIGMAS * usual_q8).max(2 * NOISE_SIGMAS * of_noise_q8);
        let least = ((NOISE_SIGMAS * usual_q8).min(of_texture_q8) >> 8).max(LEAST_DIFFERENCE);
        let least_peak = least.max((PEAK_SIGMAS_Q1 * of_noise_q8) >> 9);
        let mut seen = 0;
        let look = |from, to| {
            between(flanks, from..to, |positions| {
                seen = fine(&pixels, positions, seen, (least as i32, noise_q8), &mut found);
            });
        };
        if asked.is_none_or(|asked| !asked.is_empty()) {
            coarse(&pixels, least_peak, asked, if looks_beside { &[] } else { flanks }, look);
        }
        least > WINDOW as u32 * MOST_HIDDEN
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

/// Sums of the four pixels of a word two by two, one in each half.
fn pairs(word: &[u8]) -> u32 {
    const EVEN: u32 = 0x00ff_00ff;
    let Some(word) = word.first_chunk::<WINDOW>() else { return 0 };
    if cfg!(target_has_atomic = "32") {
        let word = u32::from_le_bytes(*word);
        (word & EVEN) + ((word >> 8) & EVEN)
    } else {
        // Where there is no atomic word, none is loaded from any address either.
        let [a, b, c, d] = word.each_ref().map(|pixel| u32::from(*pixel));
        (a + b) + ((c + d) << 16)
    }
}

/// Compares sums of four pixels with those of the four before them at every second boundary, word by word: two of them
/// in the halves of a number.
#[derive(Clone, Copy)]
struct Comparison {
    /// Pairs of the word whose turn is next.
    pairs: u32,
    /// Sums that begin with the word before and in its middle, and the same with what lifts a difference beyond the
    /// limit into the highest bit of its half.
    sums: u32,
    lifted: u32,
    lift: u32,
}

impl Comparison {
    const HIGHEST: u32 = 0x8000_8000;
    /// No difference of two sums is larger.
    const MOST: u32 = WINDOW as u32 * 255;

    /// Begins with the first two words of a row.
    fn begin(limit: u32, first: &[u8]) -> Self {
        let lift = (0x7fff - limit.min(Self::MOST)) * 0x0001_0001;
        let (first, second) = first.split_at(WINDOW.min(first.len()));
        let mut begun = Self { pairs: pairs(first), sums: 0, lifted: 0, lift };
        begun.advance(pairs(second));
        begun
    }

    /// Goes on by a word; a bit of [`Comparison::HIGHEST`] is set where a difference is beyond the limit. No half
    /// overflows.
    const fn advance(&mut self, next: u32) -> u32 {
        let sums = self.pairs + ((self.pairs >> 16) | (next << 16));
        let lifted = sums + self.lift;
        let beyond = lifted.wrapping_sub(self.sums) | self.lifted.wrapping_sub(sums);
        (self.pairs, self.sums, self.lifted) = (next, sums, lifted);
        beyond
    }

    /// Goes on by all spans of a group; whether there is a difference beyond the limit in any of them.
    #[inline(never)] // all of it then fits into the registers
    fn any_of(&mut self, group: &[u8]) -> bool {
        let mut comparison = *self;
        let any = group.chunks_exact(SPAN).fold(0, |any, span| any | comparison.span(span));
        *self = comparison;
        any & Self::HIGHEST != 0
    }

    /// Goes on by the two words of a span, and compares at the four boundaries from its last word but two on.
    fn span(&mut self, span: &[u8]) -> u32 {
        let (first, second) = span.split_at(WINDOW.min(span.len()));
        self.advance(pairs(first)) | self.advance(pairs(second))
    }
}

/// Hands over the stretches of pixels in which a difference of two sums of four pixels is beyond the limit: of the
/// columns that are asked for, if any are, and without spans with explained positions.
fn coarse(
    pixels: &impl Pixels,
    limit: u32,
    asked: Option<&[Range<u16>]>,
    explained: &[Range<u16>],
    mut stretch: impl FnMut(usize, usize),
) {
    let is_asked = |span| asked.is_none_or(|asked| asked.iter().any(|columns| spans_of(columns).contains(&span)));
    let mut buffer = [0; SPAN * GROUP];
    let mut open: Option<(usize, usize)> = None;
    let spans = pixels.columns() / SPAN;
    for gap in unexplained(explained, spans) {
        let before = grey(pixels, (gap.start - 1) * SPAN..gap.start * SPAN, &mut buffer);
        let mut comparison = Comparison::begin(limit, before);
        for at in gap.clone().step_by(GROUP) {
            let group = grey(pixels, at * SPAN..(at + GROUP).min(gap.end) * SPAN, &mut buffer);
            let before = comparison;
            if comparison.any_of(group) {
                comparison = before;
                for (index, span) in group.chunks_exact(SPAN).enumerate() {
                    if comparison.span(span) & Comparison::HIGHEST != 0 && is_asked(at + index) {
                        add_stretch(&mut open, at + index, &mut stretch);
                    }
                }
            }
        }
    }
    if !pixels.columns().is_multiple_of(SPAN) && has_edge_in_tail(pixels, limit) {
        add_stretch(&mut open, spans.max(2) - 1, &mut stretch);
        add_stretch(&mut open, spans.max(2), &mut stretch);
    }
    if let Some((start, end)) = open {
        stretch(start * SPAN - WINDOW, end * SPAN - WINDOW);
    }
}

/// Whether there is such a difference at the last boundaries of a row: where its pixels make no whole spans.
fn has_edge_in_tail(pixels: &impl Pixels, limit: u32) -> bool {
    let mut buffer = [0; 2 * SPAN];
    let tail = grey(pixels, pixels.columns().saturating_sub(2 * SPAN)..pixels.columns(), &mut buffer);
    let (first, last) = tail.split_at(SPAN.min(tail.len()));
    Comparison::begin(limit, first).span(last) & Comparison::HIGHEST != 0
}

/// The spans that positions lie in.
fn spans_of(positions: &Range<u16>) -> Range<usize> {
    let span_of = |position: u16| (usize::from(position) + WINDOW) / SPAN;
    span_of(positions.start)..span_of(positions.end) + 1
}

/// The spans of a row, but for the first and those with explained positions: what is between these.
fn unexplained(explained: &[Range<u16>], spans: usize) -> impl Iterator<Item = Range<usize>> {
    let flanks = explained.iter().map(spans_of).map(move |flank| (flank.start.min(spans), flank.end));
    let mut from = 1;
    let gaps = flanks.chain([(spans, spans)]).map(move |(start, end)| {
        let gap = from..start;
        from = from.max(end);
        gap
    });
    gaps.filter(|gap| !gap.is_empty())
}

/// Joins a span to the stretch before it if they touch, or hands that one over and opens another.
fn add_stretch(open: &mut Option<(usize, usize)>, span: usize, stretch: &mut impl FnMut(usize, usize)) {
    match open {
        Some((_, end)) if span <= *end => *end = span + 1,
        _ => {
            if let Some((start, end)) = open.replace((span, span + 1)) {
                stretch(start * SPAN - WINDOW, end * SPAN - WINDOW);
            }
        }
    }
}

/// Hands over the positions of a stretch, and the one before, which the coarse scan has not compared, but for those in
/// a flank.
fn between(flanks: &[Range<u16>], stretch: Range<usize>, mut look: impl FnMut(Range<usize>)) {
    let (mut start, end) = (stretch.start.saturating_sub(1), stretch.end);
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

/// Sums over a run of differences of one sign, in 32 bits up to [`Run::LONGEST`].
#[derive(Clone, Copy)]
struct Run {
    /// Zero where there is none.
    sign: i32,
    /// Position of the run's first difference.
    start: usize,
    area: u32,
    moment: u32,
    second: u32,
    length: u32,
    peak: i32,
    /// Lowest difference since the peak.
    valley: i32,
}

impl Run {
    /// Positions of the longest run that is an edge: ten times the longest blur that is told from a slope. Its sums are
    /// below 2³⁰.
    const LONGEST: u32 = 128;

    const NONE: Self = Self::begin(0, 0, 0);

    const fn begin(sign: i32, start: usize, size: i32) -> Self {
        Self { sign, start, area: size as u32, moment: 0, second: 0, length: 1, peak: size, valley: size }
    }

    const fn end(&self) -> usize {
        self.start + self.length as usize
    }

    fn extend(&mut self, size: i32) {
        if self.length < Self::LONGEST {
            let moment = size as u32 * self.length;
            self.area += size as u32;
            self.moment += moment;
            self.second += moment * self.length;
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

    fn edge(&self, noise_q8: u32) -> Option<ScannedPoint> {
        if self.length > Self::LONGEST {
            return None;
        }
        // A step of contrast A adds up to 16 A.
        let contrast = (self.area + 8) >> 4;
        let off_q16 = ratio_q16(self.moment, self.area);
        // Position k is the boundary between pixels k − 1 and k.
        let column_q16 = ((self.start as i64) << 16) + i64::from(off_q16) - (1 << 15);
        let square_q16 = (u64::from(off_q16) * u64::from(off_q16)) >> 16;
        let variance_q16 = ratio_q16(self.second, self.area).saturating_sub(square_q16 as u32);
        // Not below the blur of a pixel alone.
        let blur_q16 = variance_q16.saturating_sub(OWN_VARIANCE_Q1 << 15).max(1 << 13);
        let root_q4 = (self.length << 8).isqrt();
        let sigma_q16 = ((noise_q8 << 4).saturating_mul(root_q4)).checked_div(contrast.max(1)).unwrap_or(u32::MAX);
        Some(ScannedPoint {
            column_q16: i32::try_from(column_q16).ok()?,
            sigma_q16: sigma_q16.max(1),
            width_q8: u16::try_from(blur_q16.isqrt()).ok()?,
            contrast: i16::try_from(contrast as i32 * self.sign).ok()?,
        })
    }
}

/// A quotient in 1/65536 whose whole part and divisor have at most 16 and 20 bits: what 64-bit division would cost ten
/// times on small cores.
fn ratio_q16(numerator: u32, denominator: u32) -> u32 {
    let split = |numerator: u32| Some((numerator.checked_div(denominator)?, numerator.checked_rem(denominator)?));
    let parts = |rest: u32| split(rest << 8);
    split(numerator)
        .and_then(|(whole, rest)| {
            let (upper, rest) = parts(rest)?;
            let (lower, _) = parts(rest)?;
            Some((whole << 16) + (upper << 8) + lower)
        })
        .unwrap_or(0)
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
    let mut run = Run::NONE;
    let mut followed = end;
    let mut close = |run: &Run| {
        followed = followed.max(run.end());
        if let Some(edge) = run.edge(noise_q8).filter(|_| is_whole(run)) {
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
            let sign = if size > least { difference.signum() } else { 0 };
            if sign == 0 && run.sign == 0 {
                return;
            }
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
    let (changing, entering) = right.split_at(WINDOW.min(right.len()));
    let mut difference = sum(changing) - sum(left);
    // The window moves by one: what enters on the right, changes sides, and leaves on the left; behind the last one
    // there is none.
    let mut entering = entering.iter();
    for (index, (leaves, changes)) in pixels.iter().zip(right).enumerate().take(count) {
        take(index, difference);
        let enters = entering.next().map_or(0, |pixel| i32::from(*pixel));
        difference += enters - 2 * i32::from(*changes) + i32::from(*leaves);
    }
}
