//! What is done in some rows only.

use super::tuning::{HIDDEN_ROWS, LOOK_BESIDE_ROWS, LOOK_FOR_NEW_ROWS, LOOK_ROWS};
use crate::setup::Response;

/// Whether lines look at what is around them in a row that shows them as before.
pub(crate) const fn looks(row: u16) -> bool {
    row.is_multiple_of(LOOK_ROWS)
}

/// Whether they look for halos: where widths count most, what may have changed them is seen in every row.
pub(crate) fn looks_for_halo(row: u16, response: &Response) -> bool {
    looks(row) || response.is_linear()
}

/// Whether a row is scanned for new lines: some are, of a mosaic of each kind.
pub(crate) const fn looks_for_new(row: u16, is_mosaic: bool) -> bool {
    turn(row, is_mosaic).is_multiple_of(LOOK_FOR_NEW_ROWS as u32)
}

/// Whether such a row is looked at beside its located lines as well: some of them are, or an edge that begins there would
/// never be seen.
pub(crate) const fn looks_beside(row: u16, is_mosaic: bool) -> bool {
    const { assert!(LOOK_BESIDE_ROWS.is_multiple_of(LOOK_FOR_NEW_ROWS), "the others are not scanned") };
    turn(row, is_mosaic).is_multiple_of(LOOK_BESIDE_ROWS as u32)
}

/// Counts the rows of either kind of a mosaic.
const fn turn(row: u16, is_mosaic: bool) -> u32 {
    // As long as a register: what is a multiple is then told without a division.
    (if is_mosaic { row / 2 } else { row }) as u32
}

/// Whether it is the row in which the hidden line of a place may be found where there is no room to stitch.
pub(super) const fn has_turn(place: u16, row: u16) -> bool {
    place.wrapping_add(row).is_multiple_of(HIDDEN_ROWS)
}
