//! [`GoodnessOfFit`]: the residuals of a line against the stated noise. docs/model.md, section 3.9.

use super::tuning::MOST_SIGMAS;
use crate::scalar::Scalar;

/// How well a straight line fits.
pub(crate) struct GoodnessOfFit<S> {
    /// Root mean square of the residuals in units of the stated noise.
    pub(crate) misfit: S,
    /// Largest departure from a straight line in pixels, beyond what noise explains.
    pub(crate) departure_px: S,
}

/// Two degrees of freedom are spent on bearing and inverse depth.
const SPENT: i32 = 2;

impl<S: Scalar> GoodnessOfFit<S> {
    /// Without residuals.
    pub(crate) const NONE: Self = Self { misfit: S::ZERO, departure_px: S::ZERO };

    /// From the residuals, each in units of its noise, and how far it departs in pixels beyond noise.
    pub(crate) fn of(residuals: impl Iterator<Item = (S, S)>) -> Self {
        let cap = S::from_i32(MOST_SIGMAS);
        let (mut count, mut squares, mut departure_px) = (0, S::ZERO, S::ZERO);
        for (residual, bend_px) in residuals {
            let residual = residual.min(cap).max(-cap);
            squares = squares + residual * residual;
            departure_px = departure_px.max(bend_px);
            count += 1;
        }
        if count <= SPENT {
            return Self::NONE;
        }
        Self { misfit: (squares / S::from_i32(count - SPENT)).sqrt(), departure_px }
    }
}

/// The mean square of `count` unit variates exceeds this as seldom as one normal variate exceeds so many sigmas (Wilson and
/// Hilferty).
pub(crate) fn chance_limit<S: Scalar>(count: S, sigmas: S) -> S {
    let part = S::ratio(2, 9) / count;
    let root = S::ONE - part + sigmas * part.sqrt();
    root * root * root
}
