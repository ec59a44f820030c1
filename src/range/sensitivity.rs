//! [`Sensitivity`]: derivatives of an estimate by the errors that its samples share. docs/model.md, section 6.

use super::budget::Budget;
use super::covariance::Covariance;
use super::equation::Equations;
use super::least_squares::Solution;
use super::line3::Line3;
use super::observation::Observation;
use super::shared_error::{SHARED_ERRORS, SharedError};
use crate::scalar::{Scalar, hypot, scale};
use crate::setup::Setup;

/// By how much a unit of each shared error moves bearing, inverse depth and tilt.
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
        for ((index, error), effect) in SharedError::ALL.into_iter().enumerate().zip(&mut sensitivity.0) {
            if error.sigma(setup, line3.bearing) > S::ZERO {
                let of_observations = observations.iter().map(|observation| error.error(observation, line3));
                let prior =
                    equations.prior.iter().map(|equation| equation.errors.get(index).copied().unwrap_or(S::ZERO));
                *effect = solution.response(equations, of_observations.chain(prior));
            }
        }
        sensitivity
    }

    /// Each error with what one standard deviation of it does.
    fn scaled_by_sigma(&self, setup: &Setup<S>, bearing: S) -> impl Iterator<Item = (SharedError, [S; 3])> {
        let errors = SharedError::ALL.into_iter().zip(self.0);
        errors.map(move |(error, effect)| (error, scale(effect, error.sigma(setup, bearing))))
    }

    /// The covariance from noise and priors, with the errors that all samples share.
    pub(crate) fn total(&self, own: Covariance<S>, setup: &Setup<S>, bearing: S) -> Covariance<S> {
        let shared = self.scaled_by_sigma(setup, bearing).filter(|(error, _)| !error.is_in_prior());
        shared.fold(own, |sum, (_, effect)| sum.and(effect))
    }

    /// Which part of the inverse depth's sigma comes from where.
    pub(crate) fn budget(&self, own: &Covariance<S>, setup: &Setup<S>, bearing: S) -> Budget<S> {
        let [_, independent_per_m, _] = own.sigma;
        let mut budget = Budget::of_noise(independent_per_m);
        for (error, [_, effect, _]) in self.scaled_by_sigma(setup, bearing) {
            let part = effect.abs();
            if error.is_in_prior() {
                let part = part.min(budget.noise_per_m);
                budget.noise_per_m = ((budget.noise_per_m - part) * (budget.noise_per_m + part)).sqrt();
            }
            match error {
                SharedError::Tilt => {
                    let sigma = error.sigma(setup, bearing);
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
