//! [`Sensitivity`]: what a wrong tilt, lens, speed, rotation rate, readout time or focal length does to an estimate.

use super::budget::Budget;
use super::covariance::Covariance;
use super::equation::Equations;
use super::least_squares::Solution;
use super::line3::Line3;
use super::observation::Observation;
use super::shared_error::{SHARED_ERRORS, SharedError};
use crate::scalar::{Scalar, hypot, scale};
use crate::setup::Setup;

/// By how much a unit error of each cause moves bearing, inverse depth and tilt.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Sensitivity<S>(pub(crate) [[S; 3]; SHARED_ERRORS]);

impl<S: Scalar> Sensitivity<S> {
    pub(crate) const NONE: Self = Self([[S::ZERO; 3]; SHARED_ERRORS]);

    pub(crate) fn of<const N: usize>(
        observations: &[Observation<S>],
        line3: &Line3<S>,
        equations: &Equations<S, N>,
        solution: &Solution<S>,
        setup: &Setup<S>,
    ) -> Self {
        let mut sensitivity = Self::NONE;
        for ((index, cause), effect) in SharedError::ALL.into_iter().enumerate().zip(&mut sensitivity.0) {
            if cause.sigma(setup, line3.bearing) > S::ZERO {
                let observed = observations.iter().map(|observation| cause.error(observation, line3));
                let prior =
                    equations.prior.iter().map(|equation| equation.errors.get(index).copied().unwrap_or(S::ZERO));
                *effect = solution.response(equations, observed.chain(prior));
            }
        }
        sensitivity
    }

    /// Each cause with its effect and its standard deviation.
    fn weighed(&self, setup: &Setup<S>, bearing: S) -> impl Iterator<Item = (SharedError, [S; 3])> {
        let causes = SharedError::ALL.into_iter().zip(self.0);
        causes.map(move |(cause, effect)| (cause, scale(effect, cause.sigma(setup, bearing))))
    }

    /// The covariance of noise and beliefs, with all that moves the samples together.
    pub(crate) fn total(&self, own: Covariance<S>, setup: &Setup<S>, bearing: S) -> Covariance<S> {
        let common = self.weighed(setup, bearing).filter(|(cause, _)| !cause.is_in_prior());
        common.fold(own, |sum, (_, effect)| sum.and(effect))
    }

    /// Which part of the inverse depth's sigma comes from where.
    pub(crate) fn budget(&self, own: &Covariance<S>, setup: &Setup<S>, bearing: S) -> Budget<S> {
        let [_, own_per_m, _] = own.sigma;
        let mut budget = Budget::of_noise(own_per_m);
        for (cause, [_, effect, _]) in self.weighed(setup, bearing) {
            let part = effect.abs();
            if cause.is_in_prior() {
                let part = part.min(budget.noise_per_m);
                budget.noise_per_m = ((budget.noise_per_m - part) * (budget.noise_per_m + part)).sqrt();
            }
            match cause {
                SharedError::Tilt => {
                    let sigma = cause.sigma(setup, bearing);
                    let lean = if sigma > S::ZERO { setup.uncertainty().sigma_tilt / sigma } else { S::ZERO };
                    budget.lean_per_m = part * lean;
                    budget.gravity_per_m = part * ((S::ONE - lean) * (S::ONE + lean)).sqrt();
                }
                SharedError::Lens => budget.lens_per_m = part,
                SharedError::Speed => budget.speed_per_m = part,
                SharedError::Rate(_) => budget.rate_per_m = hypot(budget.rate_per_m, part),
                SharedError::Readout => budget.readout_per_m = part,
                SharedError::Focal => budget.focal_per_m = part,
            }
        }
        budget
    }
}
