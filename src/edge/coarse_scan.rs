//! [`coarse`]: where a row may have edges, from sums of four pixels at every second boundary.

use core::ops::Range;

use super::comparison::{Comparison, GROUP, SPAN};
use super::noise::WINDOW;
use super::pixel_row::grey;
use super::quiet::Quiet;
use crate::format::Pixels;

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
