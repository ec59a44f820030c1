//! [`Demand`]: which points of a row may become part of a line, so that no other is looked for or refined.

use core::ops::Range;

use heapless::Vec;

use super::association::Prediction;
use crate::edge::{EdgePoint, Polarity};

/// The points of a row that a line or a free place may take.
pub(crate) struct Demand<const LINES: usize> {
    /// Where lines wait for a point, if there is no free place.
    lines: Option<Vec<Line, LINES>>,
}

struct Line {
    column_q16: i32,
    reach_q16: u32,
    polarity: Polarity,
}

/// More than a point moves when it is refined alone.
const MOST_REFINED_Q16: u32 = 1 << 16;

/// Beyond that the windows of the scanner on either side, and the neighbours of the edge there.
const BESIDE_Q16: u32 = 12 << 16;

impl<const LINES: usize> Demand<LINES> {
    /// All points.
    pub(crate) const fn new() -> Self {
        Self { lines: None }
    }

    /// Only those that these lines may take.
    pub(super) fn restrict(&mut self, lines: impl Iterator<Item = (Prediction, Polarity)>) {
        let line = |(Prediction { column_q16, gate_q16, .. }, polarity)| Line {
            column_q16,
            reach_q16: gate_q16.saturating_add(MOST_REFINED_Q16),
            polarity,
        };
        self.lines = Some(lines.map(line).take(LINES).collect());
    }

    /// Whether no place is free for another line.
    pub(crate) const fn is_of_full_table(&self) -> bool {
        self.lines.is_some()
    }

    /// Adds the columns where a point may be asked for.
    pub(crate) fn add_columns(&self, columns: &mut Vec<Range<u16>, LINES>) {
        let column = |column_q16: i32| (column_q16 >> 16).max(0) as u16;
        for line in self.lines.iter().flatten() {
            let reach_q16 = line.reach_q16.saturating_add(BESIDE_Q16);
            let from_q16 = line.column_q16.saturating_sub_unsigned(reach_q16);
            let to_q16 = line.column_q16.saturating_add_unsigned(reach_q16);
            // There is room: one for each line.
            let _ = columns.push(column(from_q16)..column(to_q16));
        }
    }

    pub(crate) fn asks_for(&self, point: &EdgePoint) -> bool {
        let may_take = |line: &Line| {
            line.polarity == point.polarity && line.column_q16.abs_diff(point.column_q16) <= line.reach_q16
        };
        self.lines.as_ref().is_none_or(|lines| lines.iter().any(may_take))
    }
}
