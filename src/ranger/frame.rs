//! [`Frame`]: what the frame under way is made of.

use crate::line::RowClock;

/// What the frame under way is made of. The tag is written out, and zero at first, as all else in an empty ranger.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub(super) enum Frame {
    /// Nothing has come yet.
    Started = 0,
    /// Edge points; the row that came last.
    OfPoints(LastRow) = 1,
    /// Rows of pixels: how many of them, and whether the last one could not be read ([`Scanner::is_blinded`](crate::Scanner)).
    OfPixels { rows_read: u16, is_blinded: bool } = 2,
    /// Given up: nothing is taken until it ends.
    Torn = 3,
}

/// The row that came last.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct LastRow {
    pub(super) row: u16,
    /// Its points have gone to the tracker.
    pub(super) complete: bool,
    /// Of the rows that have points.
    pub(super) clock: Option<RowClock>,
}
