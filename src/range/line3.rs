//! [`Line3`]: the straight line in space that is fitted, in the axes of the frame-start camera. docs/model.md, section
//! 3.

use super::observation::{Observation, RowPlane};
use super::unknowns::{Residual, Unknowns};
use crate::scalar::{Scalar, add, scale};

/// The unknowns `(a, ρ, β)` and the directions that they refer to.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Line3<S> {
    pub(crate) bearing: S,
    pub(crate) inverse_depth: S,
    pub(crate) tilt: S,
    pub(crate) gravity: [S; 3],
    /// Unit vector e in the image plane, perpendicular to gravity: a leaning edge points along `g + β e`.
    pub(crate) lean: [S; 3],
}

impl<S: Scalar> Line3<S> {
    /// Without even a direction.
    pub(super) const NOTHING: Self = {
        let (Unknowns { bearing, inverse_depth, tilt }, none) = (Unknowns::NOTHING, [S::ZERO; 3]);
        Self { bearing, inverse_depth, tilt, gravity: none, lean: none }
    };

    /// A line of which nothing is known but the direction of gravity.
    pub(crate) fn start(gravity: [S; 3]) -> Self {
        let [gx, gy, _] = gravity;
        let length = (gx * gx + gy * gy).sqrt();
        // A camera that looks straight down has no such direction; every sample is then refused as sideways.
        let lean = if length > S::ZERO { [gy / length, -gx / length, S::ZERO] } else { [S::ONE, S::ZERO, S::ZERO] };
        let Unknowns { bearing, inverse_depth, tilt } = Unknowns::NOTHING;
        Self { bearing, inverse_depth, tilt, gravity, lean }
    }

    pub(crate) fn direction(&self) -> [S; 3] {
        add(self.gravity, scale(self.lean, self.tilt))
    }

    pub(crate) fn unknowns(&self) -> Unknowns<S> {
        Unknowns { bearing: self.bearing, inverse_depth: self.inverse_depth, tilt: self.tilt }
    }

    /// The line of other unknowns that refer to the same directions.
    #[must_use]
    pub(super) fn with(&self, Unknowns { bearing, inverse_depth, tilt }: Unknowns<S>) -> Self {
        Self { bearing, inverse_depth, tilt, ..*self }
    }

    /// An observation against this line.
    pub(crate) fn residual(&self, observation: &Observation<S>) -> Residual<S> {
        self.unknowns().residual(&observation.normals)
    }

    /// How far along the line, from its point in the plane y = 0 and in units of that point's depth, the row of an
    /// observation crosses it.
    pub(crate) fn along(&self, row: &RowPlane<S>) -> S {
        let [_, gy, gz] = self.direction();
        let w = row.slope;
        (w * (S::ONE - self.inverse_depth * row.z) + self.inverse_depth * row.y) / (gy - w * gz)
    }
}
