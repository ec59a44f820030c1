//! [`Distortion`]: the lens model of Brown and Conrady, and the rational one that extends it, in the order of OpenCV.

use crate::scalar::Scalar;

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

/// The image of a point under the lens model or its inverse, with the Jacobian of the mapping there.
#[derive(Clone, Copy)]
pub(crate) struct Mapped<S> {
    pub(crate) point: [S; 2],
    /// `[[∂u/∂u, ∂u/∂w], [∂w/∂u, ∂w/∂w]]`
    pub(crate) jacobian: [[S; 2]; 2],
}

impl<S: Scalar> Mapped<S> {
    /// Where a point so far off is mapped to, by the Jacobian here.
    pub(super) fn linear(&self, off: [S; 2]) -> [S; 2] {
        let ([u, w], [du, dw]) = (self.point, self.step(off));
        [u + du, w + dw]
    }

    /// What a point so far off is moved by.
    pub(super) fn step(&self, [u, w]: [S; 2]) -> [S; 2] {
        let [[uu, uw], [wu, ww]] = self.jacobian;
        [(uu * u).plus_product(uw, w), (wu * u).plus_product(ww, w)]
    }

    /// Scale of a small area under the mapping: zero at a fold.
    pub(crate) fn determinant(&self) -> S {
        let [[a, b], [c, d]] = self.jacobian;
        a * d - b * c
    }

    /// Inverse of the Jacobian; `None` at or beyond a fold.
    fn inverse_jacobian(&self) -> Option<[[S; 2]; 2]> {
        let [[a, b], [c, d]] = self.jacobian;
        let determinant = self.determinant();
        (determinant > S::ratio(1, 64)).then(|| {
            let per_area = S::ONE / determinant;
            [[d * per_area, -(b * per_area)], [-(c * per_area), a * per_area]]
        })
    }
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
    pub(crate) fn distort(&self, [u, w]: [S; 2]) -> Mapped<S> {
        let (uu, uw, ww) = (u * u, u * w, w * w);
        // Half the derivative of `radial` by u is u times its slope.
        let [radial, slope] = self.radial(uu + ww);
        let (p1u, p1w, p2u, p2w) = (self.p1 * u, self.p1 * w, self.p2 * u, self.p2 * w);
        let twice = |value: S| value + value;
        let along_u = radial + twice(uu * slope + p1w + twice(p2u) + p2u);
        let along_w = radial + twice(ww * slope + p2u + twice(p1w) + p1w);
        let cross = twice(uw * slope + p1u + p2w);
        Mapped { point: self.with_radial([u, w], [uu, uw, ww], radial), jacobian: [[along_u, cross], [cross, along_w]] }
    }

    /// The mean of the ideal points at both ends of a stretch about one whose inverse mapping is known, `half` to
    /// either side: one step from there for each. What the Jacobian has changed by cancels in the mean, and its square
    /// is left of each step.
    ///
    /// *Cost*: about 60 operations.
    pub(super) fn mean_of_ends(&self, ideal: &Mapped<S>, [u, w]: [S; 2], [half_u, half_w]: [S; 2]) -> [S; 2] {
        let [middle_u, middle_w] = ideal.point;
        let [before_u, before_w] = self.distort_point([middle_u - half_u, middle_w - half_w]);
        let [after_u, after_w] = self.distort_point([middle_u + half_u, middle_w + half_w]);
        ideal.linear([u - (before_u + after_u).half(), w - (before_w + after_w).half()])
    }

    /// From the ideal to the recorded point.
    fn distort_point(&self, [u, w]: [S; 2]) -> [S; 2] {
        let (uu, uw, ww) = (u * u, u * w, w * w);
        let [radial, _] = self.radial(uu + ww);
        self.with_radial([u, w], [uu, uw, ww], radial)
    }

    /// The same from the products of u and w, and the radial factor.
    #[inline]
    fn with_radial(&self, [u, w]: [S; 2], [uu, uw, ww]: [S; 3], radial: S) -> [S; 2] {
        let (r2, both) = (uu + ww, uw + uw);
        let tangential_u = (self.p1 * both).plus_product(self.p2, r2 + (uu + uu));
        let tangential_w = (self.p2 * both).plus_product(self.p1, r2 + (ww + ww));
        [tangential_u.plus_product(u, radial), tangential_w.plus_product(w, radial)]
    }

    /// The radial factor at r², and its derivative by r².
    fn radial(&self, r2: S) -> [S; 2] {
        let [numerator, rise] = cubic([self.k1, self.k2, self.k3], r2);
        let divisor = [self.k4, self.k5, self.k6];
        if divisor == [S::ZERO; 3] {
            return [numerator, rise];
        }
        let [denominator, fall] = cubic(divisor, r2);
        let radial = numerator / denominator;
        [radial, (rise - radial * fall) / denominator]
    }

    /// From the recorded to the ideal point, by Newton's method, which starts at the recorded one. The Jacobian is that
    /// of this *inverse* mapping. `None` where the model folds over.
    ///
    /// *Cost*: two to five steps of about 60 operations for real lenses.
    pub(crate) fn undistort(&self, recorded: [S; 2]) -> Option<Mapped<S>> {
        self.undistort_from(recorded, recorded, S::EPSILON * S::ratio(1, 16))
    }

    /// The same from a start near the ideal point; a step whose square is no more than `near` is the last.
    pub(super) fn undistort_from(&self, recorded: [S; 2], start: [S; 2], near: S) -> Option<Mapped<S>> {
        let mut point = start;
        let mut mapped = self.distort(point);
        let mut residual = difference(recorded, mapped.point);
        for _ in 0..MAX_STEPS {
            let jacobian = mapped.inverse_jacobian()?;
            let [[iuu, iuw], [iwu, iww]] = jacobian;
            let (mut du, mut dw) = (iuu * residual[0] + iuw * residual[1], iwu * residual[0] + iww * residual[1]);
            // The next step would be its square, or a few times that.
            let step = du.abs() + dw.abs();
            if !(step * step > near) {
                return Some(Mapped { point: [point[0] + du, point[1] + dw], jacobian });
            }
            // A step that overshoots is halved: near a fold the linear model holds for short steps only.
            for _ in 0..MAX_HALVINGS {
                let next = [point[0] + du, point[1] + dw];
                let next_mapped = self.distort(next);
                let next_residual = difference(recorded, next_mapped.point);
                if size(next_residual) < size(residual) {
                    (point, mapped, residual) = (next, next_mapped, next_residual);
                    break;
                }
                (du, dw) = (du * S::ratio(1, 2), dw * S::ratio(1, 2));
            }
        }
        // Rounding can keep the last digits from settling: a residual of that size counts as converged.
        let converged = size(residual) <= S::EPSILON * S::from_i32(32);
        mapped.inverse_jacobian().filter(|_| converged).map(|jacobian| Mapped { point, jacobian })
    }
}

/// `1 + a x + b x² + c x³` and its derivative.
fn cubic<S: Scalar>([a, b, c]: [S; 3], x: S) -> [S; 2] {
    let (xb, xxc) = (x * b, x * (x * c));
    [S::ONE.plus_product(x, a + (xb + xxc)), a + (xb + xb) + (xxc + xxc + xxc)]
}

fn difference<S: Scalar>(a: [S; 2], b: [S; 2]) -> [S; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn size<S: Scalar>([u, w]: [S; 2]) -> S {
    u.abs() + w.abs()
}

const MAX_HALVINGS: usize = 6;

/// Each step doubles the number of correct digits; a point that has not converged by then lies at or beyond a fold.
const MAX_STEPS: usize = 24;

impl<S: Scalar> Default for Distortion<S> {
    fn default() -> Self {
        Self::NONE
    }
}
