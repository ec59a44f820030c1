//! [`Covariance`]: the joint uncertainty of bearing, inverse depth and tilt.

use crate::scalar::{Scalar, dot, over};

/// Variances and covariances.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Covariance<S> {
    /// Of bearing, inverse depth and tilt.
    pub(crate) variance: [S; 3],
    /// Of bearing and inverse depth, bearing and tilt, inverse depth and tilt.
    pub(crate) mixed: [S; 3],
}

impl<S: Scalar> Covariance<S> {
    /// Of what is known exactly.
    pub(super) const NONE: Self = Self { variance: [S::ZERO; 3], mixed: [S::ZERO; 3] };

    /// One standard deviation of bearing, inverse depth and tilt.
    pub(crate) fn sigma(&self) -> [S; 3] {
        let most = S::UNKNOWN * S::UNKNOWN;
        // The root of the largest variance is not quite the largest sigma.
        let [a, r, b] = self.variance.map(|variance| if variance < most { variance.sqrt() } else { S::UNKNOWN });
        [a.max(S::EPSILON), r.max(S::EPSILON), b]
    }

    /// Correlation of bearing and inverse depth, -1 to 1.
    pub(crate) fn correlation(&self) -> S {
        let ([a, r, _], [ar, ..]) = (self.variance, self.mixed);
        let correlation = ar * over(a.sqrt() * r.sqrt());
        if correlation.is_finite() { correlation.min(S::ONE).max(-S::ONE) } else { S::ZERO }
    }

    /// The same with one more independent error, which moves the three by `effect`.
    #[must_use]
    pub(crate) fn and(&self, [a, r, b]: [S; 3]) -> Self {
        let ([aa, rr, bb], [ar, ab, rb]) = (self.variance, self.mixed);
        Self { variance: [aa + a * a, rr + r * r, bb + b * b], mixed: [ar + a * r, ab + a * b, rb + r * b] }
    }

    /// The covariance of `jacobian · (a, ρ, β)`.
    #[must_use]
    pub(crate) fn through(&self, [a, r, b]: [[S; 3]; 3]) -> Self {
        let ([ca, cr, cb], product) = ([a, r, b].map(|row| self.times(row)), dot::<S>);
        Self {
            variance: [product(a, ca), product(r, cr), product(b, cb)],
            mixed: [product(a, cr), product(a, cb), product(r, cb)],
        }
    }

    /// Variance of `a δa + r δρ + b δβ`.
    pub(crate) fn variance_along(&self, coefficients: [S; 3]) -> S {
        dot(coefficients, self.times(coefficients))
    }

    fn times(&self, [a, r, b]: [S; 3]) -> [S; 3] {
        let ([aa, rr, bb], [ar, ab, rb]) = (self.variance, self.mixed);
        [aa * a + ar * r + ab * b, ar * a + rr * r + rb * b, ab * a + rb * r + bb * b]
    }

    /// The same as three independent statements about (a, ρ, β), each three coefficients with a variance: a given the
    /// others, ρ given β, and β alone. The last has a variance of zero where the tilt is not estimated.
    pub(crate) fn statements(&self) -> [([S; 3], S); 3] {
        let ([aa, rr, bb], [ar, ab, rb]) = (self.variance, self.mixed);
        // What rounding leaves of a difference.
        let least = |of: S| of * S::EPSILON * S::from_i32(8);
        let r_on_b = rb * over(bb);
        let r_given_b = (rr - r_on_b * rb).max(least(rr));
        // The part of a's covariance with ρ that β does not explain.
        let a_on_r = (ar - ab * r_on_b) * over(r_given_b);
        let a_on_b = (ab - a_on_r * rb) * over(bb);
        let a_given_both = (aa - a_on_r * ar - a_on_b * ab).max(least(aa));
        [
            ([S::ONE, -a_on_r, -a_on_b], a_given_both),
            ([S::ZERO, S::ONE, -r_on_b], r_given_b),
            ([S::ZERO, S::ZERO, S::ONE], bb),
        ]
    }
}
