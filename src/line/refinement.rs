//! [`Refinement`]: which scanned points of a row are refined.

use super::candidates::Candidates;
use super::tuning::refined_a_row;
use crate::edge::EdgePoint;

/// Gives lines their scanned points, refined where it is their turn.
pub(super) struct Refinement<'r> {
    /// What is to be stated of a point, and whether its pixels are looked at for that.
    refine: &'r dyn Fn(&EdgePoint, bool) -> EdgePoint,
    row: u16,
    /// Lines that have a turn in one row after the other.
    every: u16,
    left: u16,
    /// Whether the points are so few that also those of no line are refined.
    all: bool,
}

impl<'r> Refinement<'r> {
    /// Of a row that has so many points, and may show these lines.
    pub(super) fn new<const LINES: usize>(
        refine: &'r dyn Fn(&EdgePoint, bool) -> EdgePoint,
        row: u16,
        points: usize,
        candidates: &Candidates<LINES>,
    ) -> Self {
        let left = refined_a_row(LINES);
        // Fewer than 2¹⁶ lines.
        let every = (candidates.sought().count() as u16).div_ceil(left);
        let all = points <= usize::from(left);
        Self { refine, row, every, left, all }
    }

    /// The point that a line at this place takes.
    pub(super) fn for_line(&mut self, point: &EdgePoint, place: u16) -> EdgePoint {
        let is_due = self.left > 0 && (self.all || place.wrapping_add(self.row).is_multiple_of(self.every.max(1)));
        self.left -= u16::from(is_due);
        (self.refine)(point, is_due)
    }

    /// The first point of a line: where there are many of them, most are forgotten.
    pub(super) fn for_first(&mut self, point: &EdgePoint) -> EdgePoint {
        let is_due = self.all && self.left > 0;
        self.left -= u16::from(is_due);
        (self.refine)(point, is_due)
    }
}

#[cfg(test)]
mod tests {
    use core::cell::Cell;

    use super::super::tracker::Tracker;
    use super::super::tuning::refined_a_row;
    use crate::edge::{EdgePoint, Polarity};
    use crate::line::Candidates;
    use crate::setup::Limits;

    /// However many points there are, and however many lines wait for them, no more are refined in a row, and no line
    /// waits for more rows than that takes.
    #[test]
    fn a_row_refines_no_more() {
        const LINES: usize = 16;
        for points in [1, 5, 10, 11, 16, 40] {
            let mut tracker = Tracker::<LINES, 8>::new();
            let mut turns = [0; 64];
            for row in 0..40_u16 {
                let point = |k: i32| EdgePoint::new(row, k << 20, row.into()).with_polarity(Polarity::Rising);
                let points: heapless::Vec<_, 64> = (0..points).map(point).collect();
                let looks = Cell::new(0);
                let turns = Cell::from_mut(&mut turns).as_array_of_cells();
                let refine = |point: &EdgePoint, is_due: bool| {
                    looks.set(looks.get() + u16::from(is_due));
                    if let Some(turn) = turns.get((point.column_q16 >> 20) as usize) {
                        turn.set(turn.get() + u16::from(is_due));
                    }
                    *point
                };
                let mut candidates = Candidates::new();
                tracker.expect(&Limits::DEFAULT, row, &mut candidates);
                let _ = tracker.take(&Limits::DEFAULT, 1000, row, &candidates, &points, &refine);
                assert!(looks.get() <= refined_a_row(LINES), "{} points, row {row}: {}", points.len(), looks.get());
            }
            let of_lines = turns.iter().take(LINES.min(points as usize));
            assert!(of_lines.clone().all(|turns| *turns >= 19), "{points} points: {turns:?}");
        }
    }
}
