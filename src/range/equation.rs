//! [`Equation`]: one linearised observation; [`Equations`]: all those of a round.

use heapless::Vec;

use crate::scalar::Scalar;

/// One linearised observation `y = one δa + q δρ + w δβ`, each divided by the sigma of y.
#[derive(Clone, Copy)]
pub(crate) struct Equation<S> {
    pub(crate) one: S,
    pub(crate) q: S,
    pub(crate) w: S,
    pub(crate) y: S,
}

impl<S: Scalar> Equation<S> {
    /// One that says nothing.
    pub(super) const NOTHING: Self = Self { one: S::ZERO, q: S::ZERO, w: S::ZERO, y: S::ZERO };

    /// The same with another sigma.
    #[must_use]
    pub(super) fn scaled(self, by: S) -> Self {
        Self { one: self.one * by, q: self.q * by, w: self.w * by, y: self.y * by }
    }
}

/// All equations of a round.
pub(crate) struct Equations<S, const N: usize> {
    pub(crate) observed: Vec<Equation<S>, N>,
    pub(crate) prior: Vec<Equation<S>, MOST_PRIORS>,
    /// What solving has subtracted from q, w and y so far, for each unit of `one`.
    pub(super) centre: [S; 3],
}

/// Bearing, inverse depth and tilt of earlier frames, or an upright edge, and the blur.
pub(crate) const MOST_PRIORS: usize = 4;

impl<S: Scalar, const N: usize> Equations<S, N> {
    pub(crate) fn new() -> Self {
        Self { observed: Vec::new(), prior: Vec::new(), centre: [S::ZERO; 3] }
    }

    pub(crate) fn clear(&mut self) {
        self.observed.clear();
        self.prior.clear();
        self.centre = [S::ZERO; 3];
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Equation<S>> {
        self.observed.iter().chain(&self.prior)
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Equation<S>> {
        self.observed.iter_mut().chain(&mut self.prior)
    }

    /// Whether there is a prior for the tilt; without one it is zero, not free.
    pub(super) fn has_tilt(&self) -> bool {
        self.prior.iter().any(|equation| equation.w != S::ZERO)
    }
}
