//! [`GoodnessOfFit`]: the residuals of a line against the stated noise.

use crate::scalar::Scalar;

pub(crate) struct GoodnessOfFit<S> {
    /// Root mean square of the residuals in units of the stated noise.
    pub(crate) misfit: S,
    /// Larger than chance allows.
    pub(crate) significant: bool,
    pub(crate) bent: bool,
}

impl<S: Scalar> GoodnessOfFit<S> {
    /// Without residuals.
    pub(crate) const NONE: Self = Self { misfit: S::ZERO, significant: false, bent: false };

    /// From the residuals in the order of readout, in units of their noise: how large they are, and whether neighbours are
    /// alike, as those of a curve are.
    pub(crate) fn of(residuals: impl Iterator<Item = S>) -> Self {
        // Capped, for fixed point has no room for larger squares.
        let cap = S::from_i32(1_000);
        let (mut squares, mut steps, mut previous, mut count) = (S::ZERO, S::ZERO, None, 0);
        for off in residuals {
            let off = off.min(cap).max(-cap);
            squares = squares + off * off;
            if let Some(previous) = previous {
                let step: S = off - previous;
                steps = steps + step * step;
            }
            previous = Some(off);
            count += 1;
        }
        // Two degrees of freedom are spent on bearing and inverse depth.
        let spare = S::from_i32(count - 2);
        if count <= 2 {
            return Self::NONE;
        }
        let variance = squares / spare;
        let significant = variance > chance_limit(spare);
        // The Durbin-Watson statistic is 2 for white noise and near 0 for a curve.
        let follows = steps < squares;
        let bent = significant && (follows && variance > S::from_i32(4) || variance > S::from_i32(25));
        Self { misfit: variance.sqrt(), significant, bent }
    }
}

/// The mean square of `count` unit variates exceeds this once in 30000 times (Wilson and Hilferty, at four sigma).
fn chance_limit<S: Scalar>(count: S) -> S {
    let part = S::ratio(2, 9) / count;
    let root = S::ONE - part + S::from_i32(4) * part.sqrt();
    root * root * root
}
