//! Lines that go on as before, each alone: they need not be weighed against each other.

use super::explained::{Flanks, flank};
use super::table::Table;
use super::track::RowTime;
use crate::edge::{Neighbours, PixelRow};
use crate::format::Pixels;
use crate::setup::Limits;

/// Locates the lines that a row shows as the rows before did, from left to right, and adds their flanks. Number of
/// them; the others have to be looked at closely.
pub(super) fn locate_steady<P: Pixels, const LINES: usize, const KNOTS: usize>(
    table: &mut Table<LINES, KNOTS>,
    limits: &Limits,
    at: &RowTime,
    row: &PixelRow<'_, P>,
    flanks: &mut Flanks<LINES>,
) -> usize {
    let column_q16 = |table: &Table<LINES, KNOTS>, index: usize| {
        let place = table.under_way().get(index).copied()?;
        Some((place, table.track(place)?.next_column_q16()))
    };
    let (mut located, mut left_q16) = (0, Neighbours::NONE.left_q16);
    let mut next = column_q16(table, 0);
    for index in 1..=table.under_way().len() {
        let Some((place, own_q16)) = next else { break };
        next = column_q16(table, index);
        let right_q16 = next.map_or(Neighbours::NONE.right_q16, |(_, right_q16)| right_q16);
        let around = Neighbours { left_q16, right_q16 };
        left_q16 = left_q16.max(own_q16);
        if let Some(track) = table.track_mut(place)
            && track.locate_steady(at, row, &around, limits)
        {
            // There is room: one for each line.
            let _ = flanks.push(flank(track.line.last()));
            located += 1;
        }
    }
    located
}
