//! [`Covariance`]: the joint uncertainty of bearing, inverse depth and tilt.

use crate::scalar::{Scalar, hypot};

/// Sigmas and correlations; fixed point has no room for variances.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Covariance<S> {
    /// One standard deviation of bearing, inverse depth and tilt.
    pub(crate) sigma: [S; 3],
    /// Correlation of bearing and inverse depth, bearing and tilt, inverse depth and tilt.
    pub(crate) correlation: [S; 3],
}

impl<S: Scalar> Covariance<S> {
    /// From variances and covariances in units of `scale²`: `[aa, ρρ, ββ, aρ, aβ, ρβ]`.
    pub(crate) fn scaled(scale: [S; 3], moments: [S; 6]) -> Self {
        let [aa, rr, bb, ar, ab, rb] = moments;
        let [root_a, root_r, root_b] = [aa, rr, bb].map(S::sqrt);
        let [a, r, b] = scale;
        Self {
            sigma: [bounded(a * root_a), bounded(r * root_r), (b * root_b).min(S::UNKNOWN)],
            correlation: [part(ar, root_a * root_r), part(ab, root_a * root_b), part(rb, root_r * root_b)],
        }
    }

    /// The same with one more independent error, which moves the three by `effect`.
    #[must_use]
    pub(crate) fn and(&self, effect: [S; 3]) -> Self {
        let ([a, r, b], [ea, er, eb]) = (self.sigma, effect);
        let [ar, ab, rb] = self.correlation;
        let [na, nr, nb] = [hypot(a, ea), hypot(r, er), hypot(b, eb)];
        let share = |old: S, new: S| if new > S::ZERO { old / new } else { S::ZERO };
        let joint = |correlation: S, (x, ex, nx): (S, S, S), (y, ey, ny): (S, S, S)| {
            clamp(correlation * share(x, nx) * share(y, ny) + share(ex, nx) * share(ey, ny))
        };
        let (of_a, of_r, of_b) = ((a, ea, na), (r, er, nr), (b, eb, nb));
        Self {
            sigma: [bounded(na), bounded(nr), nb.min(S::UNKNOWN)],
            correlation: [joint(ar, of_a, of_r), joint(ab, of_a, of_b), joint(rb, of_r, of_b)],
        }
    }

    /// The covariance of `jacobian · (a, ρ, β)`.
    #[must_use]
    pub(crate) fn through(&self, jacobian: [[S; 3]; 3]) -> Self {
        let [sa, sr, sb] = self.sigma;
        let scaled = jacobian.map(|[a, r, b]| {
            let row = [a * sa, r * sr, b * sb];
            let size = row.into_iter().fold(S::ZERO, |most, c| most.max(c.abs()));
            (size, row.map(|c| if size > S::ZERO { c / size } else { S::ZERO }))
        });
        let [(size_a, a), (size_r, r), (size_b, b)] = scaled;
        let product = |x, y| self.product(x, y);
        Self::scaled(
            [size_a, size_r, size_b],
            [product(a, a), product(r, r), product(b, b), product(a, r), product(a, b), product(r, b)],
        )
    }

    /// xᵀ C y with the matrix of correlations.
    fn product(&self, [xa, xr, xb]: [S; 3], [ya, yr, yb]: [S; 3]) -> S {
        let [ar, ab, rb] = self.correlation;
        xa * (ya + ar * yr + ab * yb) + xr * (ar * ya + yr + rb * yb) + xb * (ab * ya + rb * yr + yb)
    }

    /// The same as three independent statements about (a, ρ, β), each three coefficients with a sigma: a given the
    /// others, ρ given β, and β alone. The last has a sigma of zero where the tilt is not estimated.
    pub(crate) fn statements(&self) -> [([S; 3], S); 3] {
        let [sa, sr, sb] = self.sigma;
        let [ar, ab, rb] = self.correlation;
        let spare = |r_squared: S| (S::ONE - r_squared).max(S::EPSILON * S::from_i32(8));
        let across = spare(rb * rb);
        let on_r = (ar - ab * rb) / across;
        let on_b = (ab - ar * rb) / across;
        let per = |sigma: S, other: S| if other > S::ZERO { sigma / other } else { S::ZERO };
        [
            ([S::ONE, -(on_r * per(sa, sr)), -(on_b * per(sa, sb))], sa * spare(on_r * ar + on_b * ab).sqrt()),
            ([S::ZERO, S::ONE, -(rb * per(sr, sb))], sr * across.sqrt()),
            ([S::ZERO, S::ZERO, S::ONE], sb),
        ]
    }
}

fn bounded<S: Scalar>(sigma: S) -> S {
    sigma.min(S::UNKNOWN).max(S::EPSILON)
}

fn clamp<S: Scalar>(correlation: S) -> S {
    if correlation.is_finite() { correlation.min(S::ONE).max(-S::ONE) } else { S::ZERO }
}

fn part<S: Scalar>(moment: S, of: S) -> S {
    if of > S::ZERO { clamp(moment / of) } else { S::ZERO }
}
