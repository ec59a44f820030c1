//! [`GoodnessOfFit`]: the residuals of a line against stated noise and roughness. docs/model.md, section 3.9.

use super::tuning::{MOST_SIGMAS, NO_BEND_SIGMAS};
use crate::scalar::Scalar;

/// How well a straight line fits.
pub(crate) struct GoodnessOfFit<S> {
    /// Root mean square of the residuals in units of stated noise and roughness together.
    pub(crate) misfit: S,
    /// Largest departure from a straight line in pixels, beyond what noise explains.
    pub(crate) departure_px: S,
}

/// Two degrees of freedom are spent on bearing and inverse depth.
const SPENT: i32 = 2;

impl<S: Scalar> GoodnessOfFit<S> {
    /// Without residuals.
    pub(crate) const NONE: Self = Self { misfit: S::ZERO, departure_px: S::ZERO };

    /// From the residuals in units of their sigmas, each with one over that sigma in pixels.
    pub(crate) fn of(residuals: impl Iterator<Item = (S, S)>) -> Self {
        let most = S::from_i32(MOST_SIGMAS * MOST_SIGMAS);
        // Knots are means over curved arcs: what that costs is no sign of a bend.
        let floor_px2 = S::ratio(1, 256 * 256);
        let no_bend = S::from_i32(NO_BEND_SIGMAS);
        let (mut count, mut squares, mut departure_px) = (0, S::ZERO, S::ZERO);
        for (deviation, per_sigma) in residuals {
            let floor = S::ONE + floor_px2 * per_sigma * per_sigma;
            squares = squares + (deviation * deviation / floor).min(most);
            let beyond = deviation.abs() - no_bend;
            if beyond > S::ZERO {
                departure_px = departure_px.max(beyond / per_sigma);
            }
            count += 1;
        }
        if count <= SPENT {
            return Self::NONE;
        }
        Self { misfit: (squares / S::from_i32(count - SPENT)).sqrt(), departure_px }
    }
}

/// The mean square of `count` unit variates exceeds this as seldom as one normal variate exceeds so many sigmas (Wilson
/// and Hilferty).
pub(crate) fn chance_limit<S: Scalar>(count: S, sigmas: S) -> S {
    let part = S::ratio(2, 9) / count;
    let root = S::ONE - part + sigmas * part.sqrt();
    root * root * root
}
