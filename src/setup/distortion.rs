//! [`Distortion`]: the lens model of Brown and Conrady, and the rational one that extends it, in the order of OpenCV.

use super::lens::{Lens, Mapped, Nearness};
use crate::scalar::{Near, Scalar, Whole};

/// Radial `k1` to `k3`, in the rational model divided by `k4` to `k6`, and tangential `p1`, `p2`. All zero, the
/// default, is a lens without distortion.
///
/// A point at `(u, w)` with r² = u² + w² is recorded at `u (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶) +
/// 2 p1 u w + p2 (r² + 2u²)`, and likewise downwards with `p1` and `p2` exchanged.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Distortion<S> {
    /// Radial, second order.
    pub k1: S,
    /// Radial, fourth order.
    pub k2: S,
    /// Tangential, vertical.
    pub p1: S,
    /// Tangential, horizontal.
    pub p2: S,
    /// Radial, sixth order.
    pub k3: S,
    /// Radial divisor, second order.
    pub k4: S,
    /// Radial divisor, fourth order.
    pub k5: S,
    /// Radial divisor, sixth order.
    pub k6: S,
}

impl<S: Scalar> Distortion<S> {
    /// No distortion.
    pub const NONE: Self = Self::from_opencv([S::ZERO; 5]);

    /// From `[k1, k2, p1, p2, k3]`, OpenCV's order: ROS calls it `plumb_bob`.
    #[must_use]
    pub const fn from_opencv([k1, k2, p1, p2, k3]: [S; 5]) -> Self {
        Self::from_opencv_rational([k1, k2, p1, p2, k3, S::ZERO, S::ZERO, S::ZERO])
    }

    /// From `[k1, k2, p1, p2, k3, k4, k5, k6]`, OpenCV's order: ROS calls it `rational_polynomial`.
    #[must_use]
    pub const fn from_opencv_rational([k1, k2, p1, p2, k3, k4, k5, k6]: [S; 8]) -> Self {
        Self { k1, k2, p1, p2, k3, k4, k5, k6 }
    }

    /// `[k1, k2, p1, p2, k3, k4, k5, k6]`.
    #[must_use]
    pub const fn to_opencv(&self) -> [S; 8] {
        let Self { k1, k2, p1, p2, k3, k4, k5, k6 } = *self;
        [k1, k2, p1, p2, k3, k4, k5, k6]
    }

    pub(crate) fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// From the ideal to the recorded point.
    pub(crate) fn distort(&self, point: [S; 2]) -> Mapped<Whole<S>> {
        // What is near any number is the same: its code is there already.
        if S::Near::IS_WIDE {
            return self.near_lens().distort(point.map(|part| part.near(0))).whole();
        }
        self.lens().distort(point.map(Whole))
    }

    /// From the recorded to the ideal point, from where it is recorded. The Jacobian is that of this *inverse* mapping.
    /// `None` where the model folds over.
    #[inline(never)]
    pub(crate) fn undistort(&self, recorded: [S; 2]) -> Option<Mapped<Whole<S>>> {
        let (step_squared, residual) = (S::EPSILON * S::ratio(1, 16), S::EPSILON * S::from_i32(32));
        if S::Near::IS_WIDE {
            let nearness = Nearness { step_squared: step_squared.near(0), residual: residual.near(0), farthest: None };
            let recorded = recorded.map(|part| part.near(0));
            let ideal = self.near_lens().undistort_from(recorded, recorded, &nearness)?;
            return Some(ideal.whole());
        }
        let nearness = Nearness { step_squared: Whole(step_squared), residual: Whole(residual), farthest: None };
        let recorded = recorded.map(Whole);
        self.lens().undistort_from(recorded, recorded, &nearness)
    }

    /// For points of any size.
    pub(super) fn lens(&self) -> Lens<Whole<S>> {
        Lens::new(self.to_opencv().map(Whole))
    }

    /// For points near one.
    pub(super) fn near_lens(&self) -> Lens<S::Near> {
        Lens::new(self.to_opencv().map(|coefficient| coefficient.near(0)))
    }

    /// Whether no number of the model or of its derivatives is beyond those near one for points of at most these sizes.
    pub(super) fn is_near(&self, [u, w]: [S; 2]) -> bool {
        let Self { k1, k2, p1, p2, k3, k4, k5, k6 } = *self;
        let (one, two) = (S::ONE, S::ONE + S::ONE);
        let r2 = u * u + w * w;
        let sum = |[a, b, c]: [S; 3]| r2 * (a.abs() + r2 * (b.abs() + r2 * c.abs()));
        let rise = |[a, b, c]: [S; 3]| sum([a, two * b, c * S::from_i32(3)]);
        let (radial, divisor) = ([k1, k2, k3], [k4, k5, k6]);
        let is_near = |numbers: [S; 3]| rise(numbers) < two && numbers.into_iter().all(|number| number.abs() < two);
        // A quotient of what is far from one is not worth the trouble.
        let is_plain = divisor == [S::ZERO; 3];
        u.max(w) < S::ratio(4, 3) && is_plain && is_near(radial) && (p1.abs() + p2.abs()) * (one + r2) < S::ratio(1, 4)
    }
}

impl<S: Scalar> Default for Distortion<S> {
    fn default() -> Self {
        Self::NONE
    }
}
