//! Whether a young line is the same edge as a hidden one, which then goes on as it does.

use super::track::{State, Track};
use super::tuning::{
    LEAST_STITCH_POINTS, LEAST_TURN_ROWS, MOST_FLIP_ROWS, MOST_STITCH_OFF_Q16, MOST_STITCH_POINTS, NO_TURN_Q16,
};
use crate::edge::root;
use crate::setup::Limits;

impl<const KNOTS: usize> Track<KNOTS> {
    /// Whether the line is so short that it may continue a hidden one, and long enough for its slope to be known.
    pub(super) fn is_stitchable(&self) -> bool {
        self.state == State::Confirmed && (LEAST_STITCH_POINTS..=MOST_STITCH_POINTS).contains(&self.line.points())
    }

    /// How far off this hidden line a young one goes on, if it may be the same edge: soon, where it is expected, and as
    /// steep as far as its edges tell, if they are as noisy as this line's; with another polarity only at once, as that of a
    /// painted pole changes.
    pub(super) fn stitch_distance(&self, young: &Self, limits: &Limits) -> Option<u32> {
        let (mine, theirs) = (&self.line, &young.line);
        if self.state != State::Hidden {
            return None;
        }
        let prediction = self.predict(theirs.last().row, limits);
        let off_q16 = young.filter.column_q16.abs_diff(prediction.column_q16);
        let turn_q16 = self.filter.slope_q16.abs_diff(young.filter.slope_q16);
        // Four sigma of the slope of n edges, each √(12/n³) of an edge's; beside texture the young line's may be
        // noisier.
        let points = u32::from(theirs.points().clamp(1, MOST_STITCH_POINTS));
        let theirs_q16 = if self.line.is_beside_texture { young.filter.scatter_q16 } else { 0 };
        let scatter_q16 = u32::from(self.filter.scatter_q16.max(theirs_q16));
        let of_scatter_q16 = (18 * scatter_q16).checked_div(root(points * points * points));
        let most_turn_q16 = NO_TURN_Q16 + of_scatter_q16.unwrap_or(0);
        let hidden_rows = theirs.first().row.abs_diff(mine.last().row);
        let parted_q16 = turn_q16.saturating_mul(hidden_rows.max(LEAST_TURN_ROWS).into());
        let is_in_line = off_q16 <= prediction.gate_q16.min(MOST_STITCH_OFF_Q16)
            && turn_q16 <= most_turn_q16
            && parted_q16 <= MOST_STITCH_OFF_Q16;
        let goes_on = if self.has_polarity_of(young) {
            hidden_rows <= mine.points() && mine.prominence.is_like(&theirs.prominence)
        } else {
            hidden_rows <= MOST_FLIP_ROWS && !mine.is_beside_texture && !theirs.is_beside_texture
        };
        (is_in_line && goes_on).then_some(off_q16)
    }

    /// Whether a line that follows it is dark and bright on the same sides.
    fn has_polarity_of(&self, later: &Self) -> bool {
        self.line.last().polarity == later.line.first().polarity
    }

    /// Goes on as a young line does.
    pub(super) fn append_stitched(&mut self, young: &Self) -> bool {
        let mut later = young.line.clone();
        if self.line.is_beside_texture {
            later.raise_sigmas(self.stated_sigma_q16(young.scatter_sigma_q16()));
        }
        let is_as_before = self.has_polarity_of(young);
        if self.line.append(&later).is_err() {
            return false;
        }
        if !is_as_before {
            self.model.clone_from(&young.model);
        }
        self.filter.column_q16 = young.filter.column_q16;
        self.missed_rows = 0;
        self.state = State::Confirmed;
        true
    }
}

#[cfg(test)]
mod tests {
    use core::ops::Range;

    use super::super::track::{State, Track};
    use crate::edge::EdgePoint;
    use crate::setup::Limits;

    /// A noisy line: every other point lies 0.6 px off on either side.
    fn track(rows: Range<u16>, column_px: impl Fn(f32) -> f32) -> Track<16> {
        let point = |row: u16| {
            let noise_px = if row.is_multiple_of(2) { 0.6 } else { -0.6 };
            let column_q16 = ((column_px(row.into()) + noise_px) * 65536.0) as i32;
            EdgePoint { sigma_q16: 39_000, ..EdgePoint::new(row, column_q16, i64::from(row) * 70_000) }
        };
        let mut track = Track::new(point(rows.start), &Limits::DEFAULT);
        for row in rows.skip(1) {
            assert!(track.take(point(row), &Limits::DEFAULT));
        }
        track
    }

    /// Whether a line of 60 rows at column 100, hidden since, goes on in such rows.
    fn goes_on(rows: Range<u16>, column_px: impl Fn(f32) -> f32) -> bool {
        let mut older = track(0..60, |_| 100.0);
        older.state = State::Hidden;
        older.stitch_distance(&track(rows, column_px), &Limits::DEFAULT).is_some()
    }

    #[test]
    fn what_is_beside_or_turned_is_another_edge() {
        for side in [-1.0, 1.0] {
            assert!(goes_on(80..100, |_| 100.0 + side * 0.8));
            assert!(!goes_on(80..100, |_| 100.0 + side * 3.0));
            assert!(goes_on(65..73, |row| 100.0 + side * 0.06 * (row - 65.0)));
            assert!(!goes_on(65..73, |row| 100.0 + side * 0.21 * (row - 65.0)));
            assert!(goes_on(100..130, |row| 100.0 + side * 0.02 * (row - 115.0)));
            assert!(!goes_on(100..130, |row| 100.0 + side * 0.07 * (row - 115.0)));
        }
    }

    /// Somewhere below there is always an edge.
    #[test]
    fn what_was_hidden_for_longer_than_it_was_seen_does_not_go_on() {
        assert!(goes_on(110..130, |_| 100.0) && !goes_on(130..150, |_| 100.0));
    }
}
