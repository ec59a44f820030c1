//! [`Comparison`]: how a line of this frame lies relative to an edge as it is predicted. docs/model.md, section 8.6.

use super::line_observation::LineObservation;
use super::tuning::{GATE_SIGMAS, OFF_QUARTERS_PX};
use crate::range::{Covariance, Line3, Observation};
use crate::scalar::{Scalar, add, hypot, ln, scale, sub};

/// What the mean of the ends, their difference and the middle of a line are off, in pixels.
pub(super) struct Comparison<S> {
    /// Square of the distance in sigmas, of mean and difference together.
    pub(super) square: S,
    /// Minus twice the logarithm of the likelihood, but for a constant: the smaller, the better a line fits. Of two
    /// edges that a line fits, the surer one has it.
    pub(super) cost: S,
    /// Whether the line runs as the edge would, wherever it lies.
    pub(super) is_parallel: bool,
    pub(super) middle_px: S,
    /// One sigma of what is predicted for the middle.
    pub(super) sigma_middle_px: S,
}

impl<S: Scalar> Comparison<S> {
    /// `None` where the line has no place relative to the edge.
    pub(super) fn of(line3: &Line3<S>, total: &Covariance<S>, line: &LineObservation<S>) -> Option<Self> {
        let [first, last] = &line.ends;
        let ((first_px, of_first), (last_px, of_last)) = (deviation(line3, first)?, deviation(line3, last)?);
        let (middle_px, of_middle) = deviation(line3, &line.middle)?;
        let half = S::ratio(1, 2);
        let predicted = total.through([scale(add(of_first, of_last), half), sub(of_last, of_first), of_middle]);
        let [mean_sigma, difference_sigma, sigma_middle_px] =
            predicted.variance.map(|variance| variance.max(S::ZERO).sqrt());
        let [mixed, _, _] = predicted.mixed;
        let noise = hypot(first.sigma_px(), last.sigma_px());
        // A bend or a background is no noise: it adds up with the sigma, not with its square.
        let off = S::ratio(OFF_QUARTERS_PX, 4);
        let (mean_all, difference_all) = (hypot(mean_sigma, noise * half) + off, hypot(difference_sigma, noise) + off);
        let mean = (first_px + last_px) * half / mean_all;
        let difference = (last_px - first_px) / difference_all;
        let r = mixed / mean_all / difference_all;
        let spare = ((S::ONE - r) * (S::ONE + r)).max(S::EPSILON * S::from_i32(8));
        let square = (mean * mean + difference * difference - (r + r) * mean * difference) / spare;
        let area = mean_all * difference_all * spare.sqrt();
        let cost = square + ln(area) * S::from_i32(2);
        let is_parallel = difference.abs() <= S::from_i32(GATE_SIGMAS);
        let finite = [cost, middle_px, sigma_middle_px].into_iter().all(S::is_finite);
        finite.then_some(Self { square, cost, is_parallel, middle_px, sigma_middle_px })
    }
}

/// How far along the row an observation lies from the prediction in pixels, and its change with bearing, inverse depth
/// and tilt.
pub(super) fn deviation<S: Scalar>(line3: &Line3<S>, observation: &Observation<S>) -> Option<(S, [S; 3])> {
    let residual = line3.residual(observation);
    Some((residual.px()?, residual.px_per_unknown()))
}

/// One sigma of a predicted column, in pixels.
pub(super) fn sigma_px<S: Scalar>(line3: &Line3<S>, total: &Covariance<S>, observation: &Observation<S>) -> Option<S> {
    let (_, sensitivity) = deviation(line3, observation)?;
    let sigma = total.variance_along(sensitivity).max(S::ZERO).sqrt();
    sigma.is_finite().then_some(sigma)
}
