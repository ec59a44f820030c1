//! [`Sensitivity`]: derivatives of an estimate by the errors that its samples share. docs/model.md, section 6.

use super::budget::Budget;
use super::covariance::Covariance;
use super::line3::Line3;
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

    /// Each error with its standard deviation for a line, and what that does.
    fn scaled_by_sigma(&self, setup: &Setup<S>, line3: &Line3<S>) -> impl Iterator<Item = (SharedError, S, [S; 3])> {
        let errors = SharedError::ALL.into_iter().zip(&self.0);
        errors.filter_map(move |(error, effect)| {
            let sigma = error.sigma(setup, line3.bearing, line3.gravity);
            (sigma > S::ZERO).then(|| (error, sigma, scale(*effect, sigma)))
        })
    }

    /// The covariance from noise and priors, with the errors that all samples share.
    #[inline(never)]
    pub(crate) fn total(&self, own: Covariance<S>, setup: &Setup<S>, line3: &Line3<S>) -> Covariance<S> {
        let shared = self.scaled_by_sigma(setup, line3).filter(|(error, ..)| !error.is_in_prior());
        shared.fold(own, |sum, (.., effect)| sum.and(effect))
    }

    /// Which part of the inverse depth's sigma comes from where.
    #[inline(never)]
    pub(crate) fn budget(&self, own: &Covariance<S>, setup: &Setup<S>, line3: &Line3<S>) -> Budget<S> {
        let [_, independent_per_m, _] = own.sigma();
        let mut budget = Budget::of_noise(independent_per_m);
        for (error, sigma, [_, effect, _]) in self.scaled_by_sigma(setup, line3) {
            let mut part = effect.abs();
            if error.is_in_prior() {
                // More than all of it is rounding.
                part = part.min(budget.noise_per_m);
                budget.noise_per_m = ((budget.noise_per_m - part) * (budget.noise_per_m + part)).sqrt();
            }
            match error {
                SharedError::Tilt => {
                    let lean = setup.uncertainty().sigma_tilt / sigma;
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
