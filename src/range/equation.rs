//! [`Equation`]: one linearised observation; [`Equations`]: all those of a round.

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
    /// One sigma of y; after normalisation the smallest sigma of all relative to it: the root of a weight from 0 to 1.
    pub(crate) root_weight: S,
}

impl<S: Scalar> Equation<S> {
    pub(super) fn weight(&self) -> S {
        self.root_weight * self.root_weight
    }
}

/// A prior as one more observation, and how a unit of each shared error has moved it.
#[derive(Clone, Copy)]
pub(crate) struct PriorEquation<S> {
    pub(crate) equation: Equation<S>,
    pub(crate) errors: [S; SHARED_ERRORS],
}

/// All equations of a round.
pub(crate) struct Equations<S, const N: usize> {
    pub(crate) observed: Vec<Equation<S>, N>,
    pub(crate) prior: Vec<PriorEquation<S>, MOST_PRIORS>,
}

/// Bearing, inverse depth and tilt of earlier frames, and the blur.
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

    /// Turns sigmas into weights relative to the smallest sigma, which is returned.
    pub(super) fn normalise_weights(&mut self) -> S {
        let best = self.iter().map(|equation| equation.root_weight).filter(|sigma| *sigma > S::ZERO).reduce(S::min);
        let unit = best.unwrap_or(S::EPSILON);
        for equation in self.iter_mut().filter(|equation| equation.root_weight > S::ZERO) {
            equation.root_weight = if equation.root_weight > unit { unit / equation.root_weight } else { S::ONE };
        }
        unit
    }

    /// Whether there is a prior for the tilt; without one it is zero, not free.
    pub(super) fn has_tilt(&self) -> bool {
        self.prior.iter().any(|prior| prior.equation.w != S::ZERO)
    }
}
