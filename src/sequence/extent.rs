//! [`Extent`]: which part of a line in space an edge covers.

use super::propagation::{FrameTransition, Propagated};
use crate::range::{Line3, RowPlane};
use crate::scalar::Scalar;

/// The stretch from one end of an edge to the other, along its direction from the point in the plane y = 0, in units of
/// that point's depth.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Extent<S> {
    from: S,
    to: S,
}

impl<S: Scalar> Extent<S> {
    /// Between two ends as a frame shows them.
    pub(super) fn between(line3: &Line3<S>, ends: &[RowPlane<S>; 2]) -> Option<Self> {
        let [first, last] = ends;
        Self::ordered(line3.along(first), line3.along(last))
    }

    fn ordered(a: S, b: S) -> Option<Self> {
        (a.is_finite() && b.is_finite()).then(|| Self { from: a.min(b), to: a.max(b) })
    }

    /// Length of what two have in common; negative where they are apart.
    fn common(&self, other: &Self) -> S {
        self.to.min(other.to) - self.from.max(other.from)
    }

    pub(super) fn ends(&self) -> [S; 2] {
        [self.from, self.to]
    }

    pub(super) fn contains(&self, place: S) -> bool {
        place >= self.from && place <= self.to
    }

    /// Whether half of the shorter one belongs to the longer one, too: two fragments of one contour above each other
    /// are two edges.
    pub(super) fn is_same_part(&self, other: &Self) -> bool {
        let shorter = (self.to - self.from).min(other.to - other.from);
        let common = self.common(other);
        common + common >= shorter
    }

    /// The same stretch at the next frame's start.
    pub(super) fn propagated(&self, line3: &Line3<S>, transition: &FrameTransition<S>) -> Option<Self> {
        let propagated = Propagated::of(line3, transition)?;
        Self::ordered(propagated.along(self.from), propagated.along(self.to))
    }
}
