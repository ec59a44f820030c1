//! [`Equation`]: one linearised observation; [`Equations`]: all of a round.

use heapless::Vec;

use super::shared_error::SHARED_ERRORS;
use crate::scalar::Scalar;

/// One linearised observation `y = one δa + q δρ + w δβ` with its weight.
#[derive(Clone, Copy)]
pub(crate) struct Equation<S> {
    /// 1 for a sample.
    pub(crate) one: S,
    pub(crate) q: S,
    pub(crate) w: S,
    pub(crate) y: S,
    /// One sigma of y, later that of the best row relative to it: a weight between 0 and 1, to be squared.
    pub(crate) root_weight: S,
}

impl<S: Scalar> Equation<S> {
    pub(super) fn weight(&self) -> S {
        self.root_weight * self.root_weight
    }
}

/// What was believed before, as one more observation, and how an error of each cause has moved it.
#[derive(Clone, Copy)]
pub(crate) struct PriorEquation<S> {
    pub(crate) equation: Equation<S>,
    pub(crate) errors: [S; SHARED_ERRORS],
}

/// All observations of a round.
pub(crate) struct Equations<S, const N: usize> {
    pub(crate) observed: Vec<Equation<S>, N>,
    pub(crate) prior: Vec<PriorEquation<S>, MOST_PRIORS>,
}

/// Bearing, inverse depth and tilt from earlier frames, and the blur.
pub(crate) const MOST_PRIORS: usize = 4;

impl<S: Scalar, const N: usize> Equations<S, N> {
    pub(crate) fn new() -> Self {
        Self { observed: Vec::new(), prior: Vec::new() }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Equation<S>> {
        self.observed.iter().chain(self.prior.iter().map(|prior| &prior.equation))
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Equation<S>> {
        self.observed.iter_mut().chain(self.prior.iter_mut().map(|prior| &mut prior.equation))
    }

    pub(super) fn sum(&self, value: impl Fn(&Equation<S>) -> S) -> S {
        self.iter().fold(S::ZERO, |sum, equation| sum + equation.weight() * value(equation))
    }

    /// Turns each row's sigma into its weight relative to the best one, whose sigma is returned.
    pub(super) fn normalise_weights(&mut self) -> S {
        let best = self.iter().map(|equation| equation.root_weight).filter(|sigma| *sigma > S::ZERO).reduce(S::min);
        let unit = best.unwrap_or(S::EPSILON);
        for equation in self.iter_mut().filter(|equation| equation.root_weight > S::ZERO) {
            equation.root_weight = if equation.root_weight > unit { unit / equation.root_weight } else { S::ONE };
        }
        unit
    }

    /// Whether anything is believed of the tilt: without that it is taken to be zero, not free.
    pub(super) fn has_tilt(&self) -> bool {
        self.prior.iter().any(|prior| prior.equation.w != S::ZERO)
    }
}
