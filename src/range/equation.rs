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
    /// Whether there is a prior for the tilt; without one it is zero, not free.
    pub(super) has_tilt: bool,
    /// What solving has subtracted from q, w and y so far, for each unit of `one`.
    pub(super) centre: [S; 3],
}

/// Bearing, inverse depth and tilt of earlier frames, or an upright edge, and the blur.
pub(crate) const MOST_PRIORS: usize = 4;

impl<S: Scalar, const N: usize> Equations<S, N> {
    pub(crate) fn new() -> Self {
        Self { observed: Vec::new(), prior: Vec::new(), has_tilt: false, centre: [S::ZERO; 3] }
    }

    pub(crate) fn clear(&mut self) {
        self.observed.clear();
        self.prior.clear();
        self.has_tilt = false;
        self.centre = [S::ZERO; 3];
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Equation<S>> {
        self.observed.iter().chain(&self.prior)
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Equation<S>> {
        self.observed.iter_mut().chain(&mut self.prior)
    }

    pub(super) fn push_prior(&mut self, equation: Equation<S>) {
        self.has_tilt |= equation.w != S::ZERO;
        // There is room: three of a state and one of the blur at most.
        let _ = self.prior.push(equation);
    }
}
