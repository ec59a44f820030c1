//! [`Explained`]: where a row's located lines are, so that nothing of them is taken for another edge.

use core::ops::Range;

use heapless::Vec;

use super::tuning::LOOK_BESIDE_ROWS;
use crate::edge::{EdgePoint, Polarity};

/// What the located lines of a row explain, from left to right.
pub(crate) struct Explained<const LINES: usize> {
    edges: Vec<Edge, LINES>,
}

/// Where the scanner's differences are those of located lines that stand alone: nothing else is expected near them.
// Not a part of `Explained`, which would then be cleared in each row.
pub(crate) type Flanks<const LINES: usize> = Vec<Range<u16>, LINES>;

/// A located line: scanned points of its polarity near there are its own.
struct Edge {
    column_q16: i32,
    reach_q16: i32,
    polarity: Polarity,
    /// The scanner has found this very point, too.
    is_seen: bool,
}

/// Upper bound of [`Edge::reach_q16`].
const MAX_REACH_Q16: i32 = 34 << 16;

/// What an edge without blur reaches.
const LEAST_REACH_Q16: i32 = 5 << 15;

/// Half of the scanner's window, which sees an edge so much before its flank.
const WINDOW_Q16: i32 = 4 << 16;

/// The scanner leaves out whole spans of eight pixels: what is that near may lie in one of them.
const SPANS_Q16: i32 = 2 << (16 + 3);

/// Whether a row is looked at beside its located lines: some of the rows are, or an edge that begins there would never
/// be seen.
pub(crate) const fn looks_beside(row: u16) -> bool {
    row.is_multiple_of(LOOK_BESIDE_ROWS)
}

impl Edge {
    /// The positions of the scanner in which its windows reach into the blur; the one on the left of a pixel has its
    /// number.
    fn flank(&self) -> Range<u16> {
        let half_q16 = self.reach_q16 - LEAST_REACH_Q16 + WINDOW_Q16;
        let position = |column_q16: i32| (column_q16 >> 16).clamp(0, i32::from(u16::MAX) - 2) as u16;
        position(self.column_q16 - half_q16)..position(self.column_q16.saturating_add(half_q16)) + 2
    }
}

impl<const LINES: usize> Explained<LINES> {
    pub(crate) const fn new() -> Self {
        Self { edges: Vec::new() }
    }

    /// Adds a located line.
    pub(super) fn add(&mut self, point: &EdgePoint) {
        let column_q16 = point.column_q16;
        // A row of a long blur may be wider than the blur itself can be.
        let reach_q16 = (LEAST_REACH_Q16 + i32::from(point.width_q8) * 640).min(MAX_REACH_Q16);
        let edge = Edge { column_q16, reach_q16, polarity: point.polarity, is_seen: false };
        // There is room: one per line at most. They come in order but for a few.
        if self.edges.last().is_none_or(|last| last.column_q16 <= column_q16) {
            let _ = self.edges.push(edge);
        } else {
            let _ = self.edges.insert(self.edges.partition_point(|other| other.column_q16 <= column_q16), edge);
        }
    }

    /// Adds the flanks of those that stand alone, where lines that have not been located are expected at these columns.
    pub(super) fn add_flanks(&self, others_q16: &[i32], flanks: &mut Flanks<LINES>) {
        for edge in &self.edges {
            let near_q16 = (2 * (edge.reach_q16 + WINDOW_Q16) + SPANS_Q16).unsigned_abs();
            if others_q16.iter().all(|other_q16| other_q16.abs_diff(edge.column_q16) > near_q16) {
                // There is room: one per line at most.
                let _ = flanks.push(edge.flank());
            }
        }
    }

    /// Removes the scanned points that are explained. Returns how many of them are no line's own point once more.
    pub(super) fn remove_from<const POINTS: usize>(&mut self, points: &mut Vec<EdgePoint, POINTS>) -> u32 {
        let (mut nearby, mut strays) = (0, 0);
        points.retain(|point| {
            let apart_q16 = |edge: &Edge| edge.column_q16.saturating_sub(point.column_q16);
            nearby += self.edges.iter().skip(nearby).take_while(|edge| apart_q16(edge) < -MAX_REACH_Q16).count();
            let explains = |edge: &&mut Edge| {
                edge.polarity == point.polarity && apart_q16(edge).unsigned_abs() <= edge.reach_q16.unsigned_abs()
            };
            let is_within = |edge: &&mut Edge| apart_q16(edge) <= MAX_REACH_Q16;
            let within = self.edges.iter_mut().skip(nearby).take_while(is_within);
            // The first is the line's own point once more; any other is stray.
            match within.filter(explains).reduce(|a, b| if a.is_seen { b } else { a }) {
                Some(edge) => {
                    strays += u32::from(edge.is_seen);
                    edge.is_seen = true;
                    false
                }
                None => true,
            }
        });
        strays
    }
}
