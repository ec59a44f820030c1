//! [`Line3`]: the straight line in space that is fitted, in the axes of the frame-start camera. docs/model.md, section 3.

use super::observation::Observation;
use crate::scalar::{Scalar, add, cross, dot, scale};

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
    pub(crate) fn start(gravity: [S; 3]) -> Self {
        let [gx, gy, _] = gravity;
        let length = (gx * gx + gy * gy).sqrt();
        // A camera that looks straight down has no such direction; every sample is then refused as sideways.
        let lean = if length > S::ZERO { [gy / length, -gx / length, S::ZERO] } else { [S::ONE, S::ZERO, S::ZERO] };
        Self { bearing: S::ZERO, inverse_depth: S::ZERO, tilt: S::ZERO, gravity, lean }
    }

    pub(crate) fn direction(&self) -> [S; 3] {
        add(self.gravity, scale(self.lean, self.tilt))
    }

    /// `m · P` with `P = (a, 0, 1) − ρ p`. The terms that nearly cancel are added first: single precision then loses one
    /// rounding, not four.
    pub(crate) fn offset(&self, m: [S; 3], observation: &Observation<S>) -> S {
        let [mx, _, mz] = m;
        (mx * self.bearing + mz) - self.inverse_depth * dot(m, observation.position)
    }

    /// How far along the row, in pixels, an observation lies from the line; `None` where the line runs along the row.
    pub(crate) fn residual_px(&self, observation: &Observation<S>) -> Option<S> {
        let miss = self.offset(cross(observation.direction, self.direction()), observation);
        let per_px = self.offset(cross(observation.along_row, self.direction()), observation);
        let pixels = miss / per_px;
        (per_px != S::ZERO && pixels.is_finite()).then_some(pixels)
    }

    /// How far along the line, from its point in the plane y = 0 and in units of that point's depth, the row of an
    /// observation crosses it.
    pub(crate) fn along(&self, observation: &Observation<S>) -> S {
        let ([_, dy, dz], [_, py, pz], [_, gy, gz]) = (observation.direction, observation.position, self.direction());
        let w = dy / dz;
        (w * (S::ONE - self.inverse_depth * pz) + self.inverse_depth * py) / (gy - w * gz)
    }

    /// Whether what an observation shows of the line lies before the camera at that time: as equations alone have it, a
    /// camera might have passed the line within the frame.
    pub(crate) fn is_in_front_of(&self, observation: &Observation<S>) -> bool {
        let ([_, _, pz], [_, _, gz]) = (observation.position, self.direction());
        S::ONE - self.inverse_depth * pz + self.along(observation) * gz > S::ZERO
    }

    /// Change of [`residual_px`](Self::residual_px) with the inverse depth.
    pub(crate) fn residual_per_inverse_depth(&self, observation: &Observation<S>) -> Option<S> {
        let per_px = self.offset(cross(observation.along_row, self.direction()), observation);
        let change = -dot(cross(observation.direction, self.direction()), observation.position) / per_px;
        (per_px != S::ZERO && change.is_finite()).then_some(change)
    }
}
