//! [`Sensitivity`]: derivatives of an estimate by the errors that its samples share. docs/model.md, section 6.

use super::budget::Budget;
use super::covariance::Covariance;
use super::shared_error::{SHARED_ERRORS, SharedError};
use crate::scalar::{Scalar, hypot, scale};
use crate::setup::Setup;

/// By how much a unit of each shared error moves bearing, inverse depth and tilt.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Sensitivity<S>(pub(crate) [[S; 3]; SHARED_ERRORS]);

impl<S: Scalar> Sensitivity<S> {
    /// Of what no error moves.
    pub(super) const NONE: Self = Self([[S::ZERO; 3]; SHARED_ERRORS]);

    /// Each error with what one standard deviation of it does.
    fn scaled_by_sigma(&self, setup: &Setup<S>, bearing: S) -> impl Iterator<Item = (SharedError, [S; 3])> {
        let errors = SharedError::ALL.into_iter().zip(&self.0);
        errors.filter_map(move |(error, effect)| {
            let sigma = error.sigma(setup, bearing);
            (sigma > S::ZERO).then(|| (error, scale(*effect, sigma)))
        })
    }

    /// The covariance from noise and priors, with the errors that all samples share.
    #[inline(never)]
    pub(crate) fn total(&self, own: Covariance<S>, setup: &Setup<S>, bearing: S) -> Covariance<S> {
        let shared = self.scaled_by_sigma(setup, bearing).filter(|(error, _)| !error.is_in_prior());
        shared.fold(own, |sum, (_, effect)| sum.and(effect))
    }

    /// Which part of the inverse depth's sigma comes from where.
    #[inline(never)]
    pub(crate) fn budget(&self, own: &Covariance<S>, setup: &Setup<S>, bearing: S) -> Budget<S> {
        let [_, independent_per_m, _] = own.sigma();
        let mut budget = Budget::of_noise(independent_per_m);
        for (error, [_, effect, _]) in self.scaled_by_sigma(setup, bearing) {
            let mut part = effect.abs();
            if error.is_in_prior() {
                // More than all of it is rounding.
                part = part.min(budget.noise_per_m);
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
