//! [`Line3`]: the straight line in space that is fitted, in the axes of the frame-start camera, and the one residual of a ray
//! against it. docs/model.md, section 3.

use super::observation::{Normal, Observation, RowPlane};
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

/// `F = m · P` of a ray against a line, with `P = (a, 0, 1) − ρ p`, and its derivatives.
pub(crate) struct Residual<S> {
    /// F: zero where the ray meets the line.
    pub(crate) miss: S,
    /// By a pixel along the row.
    pub(crate) per_px: S,
    /// By the bearing: m_x.
    pub(crate) per_bearing: S,
    /// By the inverse depth: −m · p.
    pub(crate) per_inverse_depth: S,
    /// By the tilt: `(d × e) · P`.
    pub(crate) per_tilt: S,
}

impl<S: Scalar> Residual<S> {
    /// How far along the row, in pixels, the ray lies from the line; `None` where the line runs along the row.
    pub(crate) fn px(&self) -> Option<S> {
        self.over_per_px(self.miss)
    }

    /// Change of [`px`](Self::px) with the inverse depth.
    pub(crate) fn px_per_inverse_depth(&self) -> Option<S> {
        self.over_per_px(self.per_inverse_depth)
    }

    fn over_per_px(&self, value: S) -> Option<S> {
        let pixels = value / self.per_px;
        (self.per_px != S::ZERO && pixels.is_finite()).then_some(pixels)
    }

    /// Whether what the ray shows of the line lies before the camera at that time: as equations alone have it, a camera might
    /// have passed the line within the frame. `per_px` is the depth there, relative to that at frame start, times what has
    /// the opposite sign of m_x.
    pub(crate) fn is_in_front(&self) -> bool {
        (self.per_px < S::ZERO) != (self.per_bearing < S::ZERO)
    }
}

impl<S: Scalar> Line3<S> {
    /// A line of which nothing is known but the direction of gravity.
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

    /// The same moved by small amounts of bearing, inverse depth and tilt.
    #[must_use]
    pub(crate) fn moved(&self, [bearing, inverse_depth, tilt]: [S; 3]) -> Self {
        Self {
            bearing: self.bearing + bearing,
            inverse_depth: self.inverse_depth + inverse_depth,
            tilt: self.tilt + tilt,
            ..*self
        }
    }

    /// n · P. The terms that nearly cancel are added first: single precision then loses one rounding, not four.
    fn offset(&self, normal: &Normal<S>) -> S {
        (normal.x * self.bearing + normal.z) - self.inverse_depth * normal.moved
    }

    /// An observation against this line: F is linear in the tilt.
    pub(crate) fn residual(&self, observation: &Observation<S>) -> Residual<S> {
        let Observation { down, lean, down_per_px, lean_per_px, .. } = observation;
        let per_tilt = self.offset(lean);
        Residual {
            miss: self.offset(down) + self.tilt * per_tilt,
            per_px: self.offset(down_per_px) + self.tilt * self.offset(lean_per_px),
            per_bearing: down.x + self.tilt * lean.x,
            per_inverse_depth: -(down.moved + self.tilt * lean.moved),
            per_tilt,
        }
    }

    /// What a pixel along the row adds to `per_bearing` and `per_inverse_depth` of [`residual`](Self::residual).
    pub(crate) fn change_along_row(&self, observation: &Observation<S>) -> [S; 2] {
        let Observation { down_per_px: down, lean_per_px: lean, .. } = observation;
        [down.x + self.tilt * lean.x, -(down.moved + self.tilt * lean.moved)]
    }

    /// How far along the line, from its point in the plane y = 0 and in units of that point's depth, the row of an
    /// observation crosses it.
    pub(crate) fn along(&self, row: &RowPlane<S>) -> S {
        let [_, gy, gz] = self.direction();
        let w = row.slope;
        (w * (S::ONE - self.inverse_depth * row.z) + self.inverse_depth * row.y) / (gy - w * gz)
    }
}
