//! A hidden line goes on where another one begins.

use super::table::Table;
use super::track::State;
use crate::setup::Limits;

/// Stitches confirmed lines that `row` has shown and that have just started to the hidden ones that they continue.
pub(super) fn stitch_all<const LINES: usize, const KNOTS: usize>(
    table: &mut Table<LINES, KNOTS>,
    limits: &Limits,
    row: u16,
) {
    if table.tracks_under_way().all(|track| track.state != State::Hidden) {
        return;
    }
    let mut index = 0;
    while let Some(place) = table.under_way().get(index).copied() {
        let older = continued_by(table, limits, row, place);
        if older.is_some_and(|older| table.append(older, place).is_some()) {
            table.leave_out(index);
        } else {
            index += 1;
        }
    }
}

/// The place of the hidden line that a young one continues.
fn continued_by<const LINES: usize, const KNOTS: usize>(
    table: &Table<LINES, KNOTS>,
    limits: &Limits,
    row: u16,
    place: u16,
) -> Option<u16> {
    let young = table.track(place).filter(|young| young.is_stitchable() && young.line.last().row == row)?;
    let mut nearest = None;
    for other in table.under_way() {
        let distance = table.track(*other).and_then(|older| older.stitch_distance(young, limits));
        let Some(found) = distance.map(|distance| (distance, *other)) else { continue };
        if nearest.is_none_or(|nearest| found < nearest) {
            nearest = Some(found);
        }
    }
    nearest.map(|(_, place)| place)
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
