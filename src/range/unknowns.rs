//! [`Unknowns`]: what is sought of a line, and the one residual of a ray against it. docs/model.md, section 3.

use super::observation::{Normal, Normals, Units};
use super::tuning::LEAST_CROSSING;
use crate::scalar::{Arithmetic, Near, Scalar};

/// `(a, ρ, β)`, for directions that the observations have been held against: a line without these.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Unknowns<S> {
    pub(crate) bearing: S,
    pub(crate) inverse_depth: S,
    pub(crate) tilt: S,
}

/// `F = m · P` of a ray against a line, with `P = (a, 0, 1) − ρ p`, and its derivatives, all times a power of two.
pub(crate) struct Residual<S: Scalar> {
    /// F: zero where the ray meets the line.
    pub(super) miss: S::Near,
    /// By a pixel along the row.
    pub(super) per_px: S::Near,
    /// By the bearing: m_x.
    pub(super) per_bearing: S::Near,
    /// By the inverse depth: −m · p.
    pub(super) per_inverse_depth: S::Near,
    /// By the tilt: `(d × e) · P`.
    pub(super) per_tilt: S::Near,
    /// What a pixel along the row adds to `per_bearing` and `per_inverse_depth`.
    pub(super) change_along_row: [S::Near; 2],
    /// Of a pixel along the row and of the position.
    pub(super) units: Units,
    /// The exponent of that power of two.
    exponent: i32,
}

impl<S: Scalar> Residual<S> {
    /// How far along the row, in pixels, the ray lies from the line; `None` where the line runs along the row.
    pub(crate) fn px(&self) -> Option<S> {
        self.over_per_px(S::of_near(self.miss, 0))
    }

    /// Change of [`px`](Self::px) with the inverse depth.
    pub(crate) fn px_per_inverse_depth(&self) -> Option<S> {
        self.over_per_px(S::of_near(self.per_inverse_depth, self.units.reach()))
    }

    /// Changes of [`px`](Self::px) with bearing, inverse depth and tilt.
    pub(crate) fn px_per_unknown(&self) -> [S; 3] {
        let per_px = self.per_px();
        let parts = [(self.per_bearing, 0), (self.per_inverse_depth, self.units.reach()), (self.per_tilt, 0)];
        parts.map(|(part, exponent)| S::of_near(part, exponent) / per_px)
    }

    /// In the same units as [`miss`](Self::miss).
    pub(super) fn per_px(&self) -> S {
        S::of_near(self.per_px, self.units.per_px())
    }

    /// As it is.
    pub(super) fn whole_per_px(&self) -> S {
        S::of_near(self.per_px, self.units.per_px() + self.exponent)
    }

    fn over_per_px(&self, value: S) -> Option<S> {
        let pixels = value / self.per_px();
        (self.per_px != S::Near::ZERO && pixels.is_finite()).then_some(pixels)
    }

    /// Whether the row runs along upright edges.
    pub(super) fn runs_along(&self) -> bool {
        let least = S::ratio(LEAST_CROSSING.0, LEAST_CROSSING.1).near(self.exponent);
        !(self.per_bearing > least || -self.per_bearing > least)
    }

    /// Whether what the ray shows of the line lies before the camera at that time: as equations alone have it, a camera
    /// might have passed the line within the frame. `per_px` is the depth there, relative to that at frame start, times
    /// what has the opposite sign of m_x.
    pub(crate) fn is_in_front(&self) -> bool {
        (self.per_px < S::Near::ZERO) != (self.per_bearing < S::Near::ZERO)
    }
}

/// [`Unknowns`] near one, for normals of one unit of the position: `P = (a, 0, 1) − ρ p` times a power of two, and the
/// tilt over another.
#[derive(Clone, Copy)]
pub(super) struct NearUnknowns<N> {
    bearing: N,
    inverse_depth: N,
    tilt: N,
    /// Of P over what it stands for.
    place: i32,
    /// Of the tilt over what it stands for.
    turn: i32,
}

impl<N: Near> NearUnknowns<N> {
    /// n · P. The terms that nearly cancel are added first: single precision then loses one rounding, not four.
    fn offset(&self, normal: &Normal<N>) -> N {
        let ahead = normal.z.over_power_of_two(self.place);
        ahead.plus_product(normal.x, self.bearing).minus_product(self.inverse_depth, normal.moved)
    }

    /// n + β of the lean's.
    fn leaning(&self, down: N, lean: N) -> N {
        down.over_power_of_two(self.turn).plus_product(self.tilt, lean)
    }

    /// A ray against this line: F is linear in the tilt.
    pub(super) fn residual<S: Scalar<Near = N>>(&self, normals: &Normals<S>) -> Residual<S> {
        let Normals { down, lean, down_per_px, lean_per_px, units, .. } = normals;
        let per_tilt = self.offset(lean);
        let along_row = Normal {
            x: self.leaning(down_per_px.x, lean_per_px.x),
            z: self.leaning(down_per_px.z, lean_per_px.z),
            moved: self.leaning(down_per_px.moved, lean_per_px.moved),
        };
        Residual {
            miss: self.leaning(self.offset(down), per_tilt),
            per_px: self.offset(&along_row),
            per_bearing: self.leaning(down.x, lean.x).over_power_of_two(self.place),
            per_inverse_depth: -self.leaning(down.moved, lean.moved).over_power_of_two(self.place),
            per_tilt: per_tilt.over_power_of_two(self.turn),
            change_along_row: [along_row.x, -along_row.moved].map(|part| part.over_power_of_two(self.place)),
            units: *units,
            exponent: units.ray() + self.place + self.turn,
        }
    }
}

impl<S: Scalar> Normals<S> {
    /// Against [`Unknowns::NOTHING`], as if it were so at every column.
    pub(super) fn residual_of_nothing(&self) -> Residual<S> {
        let Self { down, lean, down_per_px, units, .. } = self;
        Residual {
            miss: down.z,
            per_px: down_per_px.z,
            per_bearing: down.x,
            per_inverse_depth: -down.moved,
            per_tilt: lean.z,
            change_along_row: [S::Near::ZERO; 2],
            units: *units,
            exponent: units.ray(),
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

    /// For normals whose position has this unit.
    pub(super) fn near(&self, reach: i32) -> NearUnknowns<S::Near> {
        let place = self.bearing.size().max(self.inverse_depth.size().saturating_add(reach)).max(0);
        let turn = (self.tilt.size() + 1).max(0);
        NearUnknowns {
            bearing: self.bearing.near(place),
            inverse_depth: self.inverse_depth.near(place.saturating_sub(reach)),
            tilt: self.tilt.near(turn),
            place,
            turn,
        }
    }

    /// A ray against this line.
    pub(crate) fn residual(&self, normals: &Normals<S>) -> Residual<S> {
        self.near(normals.units.reach()).residual(normals)
    }
}
