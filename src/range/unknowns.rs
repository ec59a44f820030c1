//! [`Unknowns`]: what is sought of a line, and the one residual of a ray against it. docs/model.md, section 3.

use super::observation::{Normal, Normals};
use crate::scalar::Scalar;

/// `(a, ρ, β)`, for directions that the observations have been held against: a line without these.
#[derive(Clone, Copy)]
pub(crate) struct Unknowns<S> {
    pub(crate) bearing: S,
    pub(crate) inverse_depth: S,
    pub(crate) tilt: S,
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

    /// Whether what the ray shows of the line lies before the camera at that time: as equations alone have it, a camera
    /// might have passed the line within the frame. `per_px` is the depth there, relative to that at frame start, times
    /// what has the opposite sign of m_x.
    pub(crate) fn is_in_front(&self) -> bool {
        (self.per_px < S::ZERO) != (self.per_bearing < S::ZERO)
    }
}

impl<S: Scalar> Normals<S> {
    /// Against [`Unknowns::NOTHING`].
    pub(super) fn residual_of_nothing(&self) -> Residual<S> {
        let Self { down, lean, down_per_px, .. } = self;
        Residual {
            miss: down.z,
            per_px: down_per_px.z,
            per_bearing: down.x,
            per_inverse_depth: -down.moved,
            per_tilt: lean.z,
        }
    }
}

impl<S: Scalar> Unknowns<S> {
    /// Those of a line of which nothing is known.
    pub(super) const NOTHING: Self = Self { bearing: S::ZERO, inverse_depth: S::ZERO, tilt: S::ZERO };

    /// The same moved by small amounts of bearing, inverse depth and tilt.
    #[must_use]
    pub(super) fn moved(&self, [bearing, inverse_depth, tilt]: [S; 3]) -> Self {
        Self {
            bearing: self.bearing + bearing,
            inverse_depth: self.inverse_depth + inverse_depth,
            tilt: self.tilt + tilt,
        }
    }

    /// n · P. The terms that nearly cancel are added first: single precision then loses one rounding, not four.
    fn offset(&self, normal: &Normal<S>) -> S {
        normal.z.plus_product(normal.x, self.bearing).minus_product(self.inverse_depth, normal.moved)
    }

    /// A ray against this line: F is linear in the tilt.
    pub(crate) fn residual(&self, normals: &Normals<S>) -> Residual<S> {
        let Normals { down, lean, down_per_px, lean_per_px } = normals;
        let per_tilt = self.offset(lean);
        Residual {
            miss: self.offset(down).plus_product(self.tilt, per_tilt),
            per_px: self.offset(down_per_px).plus_product(self.tilt, self.offset(lean_per_px)),
            per_bearing: down.x.plus_product(self.tilt, lean.x),
            per_inverse_depth: -down.moved.plus_product(self.tilt, lean.moved),
            per_tilt,
        }
    }

    /// What a pixel along the row adds to `per_bearing` and `per_inverse_depth` of [`residual`](Self::residual).
    pub(super) fn change_along_row(&self, normals: &Normals<S>) -> [S; 2] {
        let Normals { down_per_px: down, lean_per_px: lean, .. } = normals;
        [down.x.plus_product(self.tilt, lean.x), -down.moved.plus_product(self.tilt, lean.moved)]
    }
}
