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
