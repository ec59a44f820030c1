//! [`Repair`]: whether a ranger repairs lines.

/// Whether a [`Ranger`](crate::Ranger) repairs lines: [`Repaired`], the usual one, or [`Strict`].
pub trait Repair: sealed::Sealed {
    #[doc(hidden)]
    const REPAIRS: bool;
}

/// Of a [`Ranger`](crate::Ranger), the usual: a line that turns at the end of its edge is split, one that was hidden goes
/// on in the line that continues it, and a frame in which all lines jump at one row is torn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Repaired;

/// Of a [`Ranger`](crate::Ranger) for programs that are to be small: lines are handed out as they were found.
///
/// A line that turns is one line, which [`Range::strict`](crate::Range::strict) refuses as
/// [`Bent`](crate::RangeStatus::Bent); an edge that was hidden for a while is two lines. That all lines jump at one row is
/// not noticed: where bytes or rows may be lost the driver has to tell ([`Ranger::tear`](crate::Ranger::tear)), and light
/// that is pulsed shows an edge as two. Edge points are weighed against each other in every row: they cost twice as much.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Strict;

mod sealed {
    pub trait Sealed {}
}

impl sealed::Sealed for Repaired {}

impl Repair for Repaired {
    const REPAIRS: bool = true;
}

impl sealed::Sealed for Strict {}

impl Repair for Strict {
    const REPAIRS: bool = false;
}
