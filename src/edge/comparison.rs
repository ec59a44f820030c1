//! [`Comparison`]: where sums of four pixels differ from those of the four before them.

use super::noise::WINDOW;
use super::pixel_row::pairs;

/// Pixels of a span: two words of four. What is compared when its turn comes are four boundaries of which the first is
/// a word before it.
pub(super) const SPAN: usize = 2 * WINDOW;
/// Spans that are looked at together: bits of a half.
pub(super) const GROUP: usize = 16;

/// Compares sums of four pixels with those of the four before them at every second boundary, word by word: two of them
/// in the halves of a number.
#[derive(Clone, Copy)]
pub(super) struct Comparison {
    /// Pairs of the word whose turn is next.
    pairs: u32,
    /// Sums that begin with the word before and in its middle, and the same with what lifts a difference beyond the
    /// limit into the highest bit of its half.
    sums: u32,
    lifted: u32,
    lift: u32,
}

impl Comparison {
    pub(super) const HIGHEST: u32 = 0x8000_8000;
    /// No difference of two sums is larger.
    const MOST: u32 = WINDOW as u32 * 255;

    /// Begins with the first two words of a row.
    pub(super) fn begin(limit: u32, first: &[u8]) -> Self {
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
    pub(super) fn beyond_in(limit: u32, spans: &[u8]) -> u32 {
        let (before, group) = spans.split_at(SPAN.min(spans.len()));
        let mut comparison = Self::begin(limit, before);
        // The bits of each half move down within it: as many as it has.
        let group = group.chunks_exact(SPAN);
        let rest = GROUP.saturating_sub(group.len());
        let halves = group.fold(0, |halves, span| (halves >> 1) | (comparison.span(span) & Self::HIGHEST));
        ((halves | (halves >> 16)) & 0xFFFF) >> rest
    }

    /// Goes on by the two words of a span, and compares at the four boundaries from its last word but two on.
    pub(super) fn span(&mut self, span: &[u8]) -> u32 {
        let (first, second) = span.split_at(WINDOW.min(span.len()));
        self.advance(pairs(first)) | self.advance(pairs(second))
    }
}
