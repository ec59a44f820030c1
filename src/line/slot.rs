//! [`Slot`]: a place for a line in the table.

use super::track::Track;

/// A place for a line. The tag is written out, and zero where the place is free, so that an empty table is all zero bits:
/// a `static` one then takes no flash.
#[derive(Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub(super) enum Slot<const KNOTS: usize> {
    Free = 0,
    Taken(Track<KNOTS>) = 1,
}

impl<const KNOTS: usize> Slot<KNOTS> {
    pub(super) const fn is_free(&self) -> bool {
        matches!(self, Self::Free)
    }

    pub(super) const fn track(&self) -> Option<&Track<KNOTS>> {
        match self {
            Self::Free => None,
            Self::Taken(track) => Some(track),
        }
    }

    pub(super) const fn track_mut(&mut self) -> Option<&mut Track<KNOTS>> {
        match self {
            Self::Free => None,
            Self::Taken(track) => Some(track),
        }
    }

    pub(super) fn take(&mut self) -> Option<Track<KNOTS>> {
        match core::mem::replace(self, Self::Free) {
            Self::Free => None,
            Self::Taken(track) => Some(track),
        }
    }
}
