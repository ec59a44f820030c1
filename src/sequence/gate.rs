//! [`Comparison`]: how a line of this frame lies relative to an edge as it is predicted. docs/model.md, section 8.6.

use super::line_observation::LineObservation;
use super::tuning::{GATE_SIGMAS, OFF_QUARTERS_PX};
use crate::range::{Covariance, Line3, Observation};
use crate::scalar::{Scalar, add, hypot, ln, scale, sub};

/// What the mean of a line's ends, their difference and its middle are off.
pub(super) struct Comparison<S> {
    /// Square of the distance in sigmas: of the difference, and of the mean given that, together.
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
        let (mean_sigma, difference_sigma) = (hypot(mean_sigma, noise * half), hypot(difference_sigma, noise));
        // A bend or a background is no noise: it adds up with the sigma, not with its square.
        let off = S::ratio(OFF_QUARTERS_PX, 4);
        let (mean_px, difference_px) = ((first_px + last_px) * half, last_px - first_px);
        let difference = difference_px / (difference_sigma + off);
        // The mean is compared given the difference: of an edge that is hardly known, how it runs tells where it lies, as
        // far as no bend hides it. What the difference explains of the mean is one sigma of it.
        let telling_sigma = hypot(difference_sigma, off);
        let explained_sigma = mixed / telling_sigma;
        let given_px = mean_px - explained_sigma * (difference_px / telling_sigma);
        let rest = (mean_sigma - explained_sigma) * (mean_sigma + explained_sigma);
        let given_sigma = rest.max(S::ZERO).sqrt() + off;
        let mean = given_px / given_sigma;
        let square = mean * mean + difference * difference;
        let cost = square + ln(given_sigma * (difference_sigma + off)) * S::from_i32(2);
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
