//! [`coarse`]: where a row may have edges, from sums of four pixels at every second boundary.

use core::ops::Range;

use super::noise::WINDOW;
use super::pixel_row::{grey, pairs};
use super::tuning::{MOST_QUIET, QUIET_GROUPS, QUIET_LOOKS, QUIET_TURNS};
use crate::format::Pixels;

/// Pixels of a span: two words of four. What is compared when its turn comes are four boundaries of which the first is
/// a word before it.
const SPAN: usize = 2 * WINDOW;
/// Spans that are looked at together: bits of a half.
const GROUP: usize = 16;

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

    /// In which spans there is a difference beyond the limit, the lowest bit for the first but the one with which it
    /// begins; of a group at most.
    #[inline(never)] // all of it then fits into the registers
    fn beyond_in(limit: u32, spans: &[u8]) -> u32 {
        let (before, group) = spans.split_at(SPAN.min(spans.len()));
        let mut comparison = Self::begin(limit, before);
        // The bits of each half move down within it: as many as it has.
        let group = group.chunks_exact(SPAN);
        let rest = GROUP.saturating_sub(group.len());
        let halves = group.fold(0, |halves, span| (halves >> 1) | (comparison.span(span) & Self::HIGHEST));
        ((halves | (halves >> 16)) & 0xFFFF) >> rest
    }

    /// Goes on by the two words of a span, and compares at the four boundaries from its last word but two on.
    fn span(&mut self, span: &[u8]) -> u32 {
        let (first, second) = span.split_at(WINDOW.min(span.len()));
        self.advance(pairs(first)) | self.advance(pairs(second))
    }
}

/// For how long it has been quiet in each group of a row's spans: what differs there is an edge, though it may be less
/// than what is usual in the whole row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Quiet {
    looks: [u8; QUIET_GROUPS],
    turn: u8,
}

impl Quiet {
    /// Before a frame.
    pub(super) const UNSEEN: Self = Self { looks: [0; QUIET_GROUPS], turn: 0 };

    /// The next row is one with texture.
    pub(super) const fn begin_row(&mut self) {
        self.turn = (self.turn + 1) % QUIET_TURNS;
    }

    /// In which of some spans from one of a group on there is a difference beyond the limit, if it is quiet there.
    #[inline(never)] // rows without texture do not come here
    fn beyond_in(&mut self, limit: u32, from: usize, spans: &[u8]) -> Option<u32> {
        let looks = self.looks.get_mut(from / GROUP)?;
        let is_quiet = *looks >= QUIET_LOOKS;
        if !is_quiet && self.turn > 0 {
            return None;
        }
        let beyond = Comparison::beyond_in(limit, spans);
        if beyond.count_ones() > MOST_QUIET {
            *looks = 0;
            return None;
        }
        // A few spans between flanks are no group.
        if !is_quiet && spans.len() > GROUP / 2 * SPAN {
            *looks += 1;
        }
        is_quiet.then_some(beyond)
    }
}

/// A stretch of spans.
struct Stretch {
    start: usize,
    end: usize,
    is_quiet: bool,
}

/// Hands over the stretches of pixels in which a difference of two sums of four pixels is beyond the limit, or beyond a
/// lower one where it is quiet, and whether it is: of the columns that are asked for, if any are, and without spans with
/// explained positions.
pub(super) fn coarse(
    pixels: &impl Pixels,
    limit: u32,
    mut quiet: Option<(u32, &mut Quiet)>,
    asked: Option<&[Range<u16>]>,
    explained: &[Range<u16>],
    mut stretch: impl FnMut(Range<usize>, bool),
) {
    let is_asked = |span| asked.is_none_or(|asked| asked.iter().any(|columns| spans_of(columns).contains(&span)));
    let mut buffer = [0; SPAN * (GROUP + 1)];
    let mut open: Option<Stretch> = None;
    let spans = pixels.columns() / SPAN;
    let (mut at, mut flanks) = (1, explained.iter());
    loop {
        let flank = flanks.next().map(spans_of);
        let gap_end = flank.as_ref().map_or(spans, |flank| flank.start.min(spans));
        while at < gap_end {
            let end = gap_end.min(at + GROUP);
            // With the span before it.
            let group = grey(pixels, (at - 1) * SPAN..end * SPAN, &mut buffer);
            let where_quiet = quiet.as_mut().and_then(|(limit, quiet)| quiet.beyond_in(*limit, at, group));
            let is_quiet = where_quiet.is_some();
            let mut beyond = where_quiet.unwrap_or_else(|| Comparison::beyond_in(limit, group));
            while beyond != 0 {
                if beyond & 1 != 0 && is_asked(at) {
                    add_stretch(&mut open, at, is_quiet, &mut stretch);
                }
                (beyond, at) = (beyond >> 1, at + 1);
            }
            at = end;
        }
        let Some(flank) = flank else { break };
        at = at.max(flank.end);
    }
    if !pixels.columns().is_multiple_of(SPAN) && has_edge_in_tail(pixels, limit) {
        add_stretch(&mut open, spans.max(2) - 1, false, &mut stretch);
        add_stretch(&mut open, spans.max(2), false, &mut stretch);
    }
    if let Some(last) = open {
        last.hand_over(&mut stretch);
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

impl Stretch {
    fn hand_over(&self, stretch: &mut impl FnMut(Range<usize>, bool)) {
        stretch(self.start * SPAN - WINDOW..self.end * SPAN - WINDOW, self.is_quiet);
    }
}

/// Joins a span to the stretch before it if they touch, or hands that one over and opens another.
fn add_stretch(open: &mut Option<Stretch>, span: usize, is_quiet: bool, stretch: &mut impl FnMut(Range<usize>, bool)) {
    match open {
        Some(last) if span <= last.end && last.is_quiet == is_quiet => last.end = span + 1,
        _ => {
            if let Some(last) = open.replace(Stretch { start: span, end: span + 1, is_quiet }) {
                last.hand_over(stretch);
            }
        }
    }
}
