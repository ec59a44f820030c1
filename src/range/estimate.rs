//! [`Estimate`]: bearing and inverse depth of an edge with their covariance; depth and distance are intervals.

use super::budget::Budget;
use super::goodness_of_fit::GoodnessOfFit;
use super::line_state::LineState;
use super::status::RangeStatus;
use crate::scalar::{Scalar, cross, dot};
use crate::setup::Setup;

/// Where an edge is, and how well that is known.
///
/// Inverse depth is Gaussian where depth is not: an edge at infinity is 0 ± sigma, a valid measurement.
/// All values refer to frame start: the middle of the exposure of the row read first.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate<S> {
    /// a = X/Z of the point where the edge's line crosses the camera's plane y = 0, positive to the right.
    pub bearing: S,
    /// ρ = 1/Z of that point in 1/m; zero is infinitely far.
    pub inverse_depth_per_m: S,
    /// Lean of the edge in the image plane as a slope, as far as the samples and the prior tell.
    pub tilt: S,
    /// One standard deviation of the bearing.
    pub sigma_bearing: S,
    /// One standard deviation of the inverse depth in 1/m: pixel noise, tilt, and all that the setup states; at most
    /// [`Scalar::UNKNOWN`].
    pub sigma_inverse_depth_per_m: S,
    /// One standard deviation of the tilt; zero where it is not estimated.
    pub sigma_tilt: S,
    /// Correlation of bearing and inverse depth, −1 to 1.
    pub correlation: S,
    /// Which part of `sigma_inverse_depth_per_m` comes from where: what is the edge's own, and what moves all edges of
    /// a frame together.
    pub budget: Budget<S>,
    /// Shortest distance to the edge's line, in units of its depth: |(a, 0, 1) × g|.
    pub distance_per_depth: S,
    /// Root mean square of the residuals in units of the stated noise and
    /// [roughness](crate::Uncertainty::edge_roughness_px) together: about 1 for an edge that is as rough as stated, and
    /// less for a straighter one. Where it is larger than chance allows, or neighbouring residuals are alike, the sigmas
    /// have been enlarged accordingly.
    pub misfit: S,
    /// The residuals exceed [`Limits::max_departure_q16`](crate::Limits::max_departure_q16), or the camera would pass
    /// the edge within the frame; in a [strict](crate::Range::strict) range, or they are not those of noise as stated.
    pub bent: bool,
}

/// A number of standard deviations: `range.depth(Sigmas(2.0))` gives bounds that hold in 95 % of cases.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sigmas<S>(pub S);

/// What a length is, and between which bounds it lies.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Interval<S> {
    /// The most likely length and one standard deviation in metres; `None` unless the status is `Ok`.
    pub estimate_m: Option<(S, S)>,
    /// Lower bound in metres, of an edge in front of the camera: where noise has left an inverse depth below zero, sigmas
    /// count from zero. `None` where the status says that the slope is no depth.
    pub nearest_m: Option<S>,
    /// Upper bound in metres; `None` where there is none.
    pub farthest_m: Option<S>,
}

impl<S> Interval<S> {
    /// No length at all.
    pub(super) const NONE: Self = Self { estimate_m: None, nearest_m: None, farthest_m: None };
}

impl<S: Scalar> Estimate<S> {
    /// Becomes what is known of an edge.
    // In place: a copy would need room.
    #[inline(never)]
    pub(crate) fn set(&mut self, state: &LineState<S>, setup: &Setup<S>, goodness_of_fit: &GoodnessOfFit<S>) {
        let LineState { line3, covariance, sensitivity } = state;
        let across = cross([line3.bearing, S::ZERO, S::ONE], line3.gravity);
        let total = sensitivity.total(*covariance, setup, line3);
        let [sigma_bearing, sigma_inverse_depth_per_m, sigma_tilt] = total.sigma();
        // Nothing is known of an inverse depth that the motion does not show.
        let known = sigma_inverse_depth_per_m < S::UNKNOWN;
        *self = Self {
            bearing: line3.bearing,
            inverse_depth_per_m: if known { line3.inverse_depth } else { S::ZERO },
            tilt: line3.tilt,
            sigma_bearing,
            sigma_inverse_depth_per_m,
            sigma_tilt,
            correlation: total.correlation(),
            budget: sensitivity.budget(covariance, setup, line3),
            distance_per_depth: dot(across, across).sqrt(),
            misfit: goodness_of_fit.misfit,
            bent: goodness_of_fit.departure_px > S::from_ratio(i64::from(setup.limits().max_departure_q16), 1 << 16),
        };
    }

    /// An estimate that says nothing.
    pub(crate) fn nothing() -> Self {
        Self {
            bearing: S::ZERO,
            inverse_depth_per_m: S::ZERO,
            tilt: S::ZERO,
            sigma_bearing: S::UNKNOWN,
            sigma_inverse_depth_per_m: S::UNKNOWN,
            sigma_tilt: S::ZERO,
            correlation: S::ZERO,
            budget: Budget::of_noise(S::UNKNOWN),
            distance_per_depth: S::ONE,
            misfit: S::ZERO,
            bent: false,
        }
    }

    /// What the numbers are worth by themselves: `Ok`, `Far`, `Slow`, `Inconsistent` or `Bent`.
    #[must_use]
    pub fn status(&self) -> RangeStatus {
        RangeStatus::of_numbers(self.inverse_depth_per_m, self.sigma_inverse_depth_per_m, self.bent)
    }

    /// Depth Z (the paper's "vertical distance"), and its bounds so many sigmas of inverse depth on either side.
    #[must_use]
    pub fn depth(&self, sigmas: Sigmas<S>) -> Interval<S> {
        self.interval(sigmas, S::ONE)
    }

    /// Shortest distance to the edge's line (level camera: Z/cos α, the paper's "distance"), and its bounds.
    ///
    /// The bounds leave the bearing's own sigma out: next to that of the depth it is nothing.
    #[must_use]
    pub fn distance(&self, sigmas: Sigmas<S>) -> Interval<S> {
        self.interval(sigmas, self.distance_per_depth)
    }

    /// Variances and covariance of (bearing, inverse depth): `[[aa, aρ], [aρ, ρρ]]`.
    #[must_use]
    pub fn covariance(&self) -> [[S; 2]; 2] {
        let (a, rho) = (self.sigma_bearing, self.sigma_inverse_depth_per_m);
        let mixed = self.correlation * a * rho;
        [[a * a, mixed], [mixed, rho * rho]]
    }

    /// Whether each of its numbers is one.
    #[inline(never)]
    pub(super) fn is_finite(&self) -> bool {
        let where_it_is = [self.bearing, self.inverse_depth_per_m, self.tilt, self.distance_per_depth];
        let how_well =
            [self.sigma_bearing, self.sigma_inverse_depth_per_m, self.sigma_tilt, self.correlation, self.misfit];
        let parts = self.budget.parts();
        where_it_is.iter().chain(&how_well).chain(parts.iter().map(|(_, part)| part)).all(|part| part.is_finite())
    }

    fn interval(&self, sigmas: Sigmas<S>, factor: S) -> Interval<S> {
        let inverse = (self.inverse_depth_per_m, self.sigma_inverse_depth_per_m);
        Interval::of_inverse(inverse, self.status(), sigmas, factor)
    }
}

impl<S: Scalar> Interval<S> {
    /// Of a length that is `factor` over an inverse depth with its sigma.
    pub(super) fn of_inverse((rho, sigma): (S, S), status: RangeStatus, Sigmas(sigmas): Sigmas<S>, factor: S) -> Self {
        let length = |inverse: S| {
            let length = factor / inverse;
            (inverse > S::ZERO && length.is_finite()).then_some(length)
        };
        if !status.bounds_depth() {
            return Self::NONE;
        }
        let estimate = if status == RangeStatus::Ok { length(rho) } else { None };
        Self {
            estimate_m: estimate.map(|length| (length, length * (sigma / rho))),
            // No edge is behind the camera: below zero the inverse depth is noise.
            nearest_m: length(rho.max(S::ZERO) + sigma * sigmas),
            farthest_m: length(rho - sigma * sigmas),
        }
    }
}
