//! [`Equation`]: one linearised observation; [`Equations`]: all those of a round.

use heapless::Vec;

use crate::scalar::{Near, Scalar};

/// One linearised observation `y = one δa + q δρ + w δβ`, each divided by the sigma of y; of numbers near one in
/// [`EquationUnits`].
#[derive(Clone, Copy)]
pub(crate) struct Equation<S> {
    pub(crate) one: S,
    pub(crate) q: S,
    pub(crate) w: S,
    pub(crate) y: S,
}

/// Exponents of the powers of two that the numbers of an equation are in units of.
#[derive(Clone, Copy)]
pub(crate) struct EquationUnits {
    /// Of all but y.
    pub(super) scale: i32,
    /// Of y, less that.
    pub(super) finer: i32,
    /// Of the inverse of δρ, besides.
    pub(super) reach: i32,
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

impl EquationUnits {
    /// Smaller than any others.
    pub(super) const SMALLEST: Self = Self { scale: i32::MIN, finer: 64, reach: 0 };

    /// Of y.
    fn y(&self) -> i32 {
        self.scale.saturating_sub(self.finer)
    }

    /// A sum of products, over the units of all numbers; `exponent` is what the products have besides.
    pub(super) fn sum<S: Scalar>(&self, sum: <S::Near as Near>::Sum, exponent: i32) -> S {
        S::of_sum(sum, self.scale.saturating_add(self.scale).saturating_add(exponent))
    }
}

impl<N: Near> Equation<N> {
    /// One that says nothing.
    pub(super) const NEAR_NOTHING: Self = Self { one: N::ZERO, q: N::ZERO, w: N::ZERO, y: N::ZERO };

    /// The same with another sigma.
    #[must_use]
    pub(super) fn near_scaled(&self, by: N::Factor) -> Self {
        Self { one: self.one.scaled(by), q: self.q.scaled(by), w: self.w.scaled(by), y: self.y.scaled(by) }
    }

    /// To units that are no smaller.
    fn change_units(&mut self, from: EquationUnits, to: EquationUnits) {
        let larger = to.scale.saturating_sub(from.scale);
        if larger > 0 {
            for part in [&mut self.one, &mut self.q, &mut self.w] {
                *part = part.over_power_of_two(larger);
            }
        }
        let coarser = larger.saturating_add(from.finer - to.finer);
        if coarser > 0 {
            self.y = self.y.over_power_of_two(coarser);
        }
    }

    /// Residual in units of its own noise, once the equations are solved.
    pub(super) fn deviation<S: Scalar<Near = N>>(&self, units: EquationUnits) -> S {
        S::of_near(self.y, units.y())
    }

    /// In units of one.
    pub(super) fn whole<S: Scalar<Near = N>>(&self, units: EquationUnits) -> Equation<S> {
        let [one, w] = [self.one, self.w].map(|part| S::of_near(part, units.scale));
        let (q, y) = ((self.q, units.scale.saturating_add(units.reach)), (self.y, units.y()));
        Equation { one, q: S::of_near(q.0, q.1), w, y: S::of_near(y.0, y.1) }
    }
}

/// All equations of a round.
pub(crate) struct Equations<S: Scalar, const N: usize> {
    pub(crate) observed: Vec<Equation<S::Near>, N>,
    /// Those of what is observed.
    pub(super) units: EquationUnits,
    pub(crate) prior: Vec<Equation<S>, MOST_PRIORS>,
    /// Whether there is a prior for the tilt; without one it is zero, not free.
    pub(super) has_tilt: bool,
    /// What a pixel of the lens's own blur takes from the y of the blur's equation, which is the last of the priors'; zero
    /// without one.
    pub(super) per_lens_px: S,
}

/// Bearing, inverse depth and tilt of earlier frames, or an upright edge, and the blur.
pub(crate) const MOST_PRIORS: usize = 4;

impl<S: Scalar, const N: usize> Equations<S, N> {
    pub(crate) fn new() -> Self {
        let units = EquationUnits::SMALLEST;
        Self { observed: Vec::new(), units, prior: Vec::new(), has_tilt: false, per_lens_px: S::ZERO }
    }

    pub(crate) fn clear(&mut self, reach: i32) {
        self.observed.clear();
        self.prior.clear();
        self.units = EquationUnits { reach, ..EquationUnits::SMALLEST };
        self.has_tilt = false;
        self.per_lens_px = S::ZERO;
    }

    /// One with units of its own: the largest become those of all.
    pub(super) fn push_observed(&mut self, mut equation: Equation<S::Near>, own: EquationUnits) {
        if S::Near::IS_WIDE {
            let _ = self.observed.push(equation);
            return;
        }
        let before = self.units;
        let [scale, finer] = [before.scale.max(own.scale), before.finer.min(own.finer)];
        let common = EquationUnits { scale, finer, ..before };
        if scale > before.scale || finer < before.finer {
            self.observed.iter_mut().for_each(|equation| equation.change_units(before, common));
            self.units = common;
        }
        equation.change_units(own, common);
        // There is room: as many as observations.
        let _ = self.observed.push(equation);
    }

    pub(super) fn push_prior(&mut self, equation: Equation<S>) {
        self.has_tilt |= equation.w != S::ZERO;
        // There is room: three of a state and one of the blur at most.
        let _ = self.prior.push(equation);
    }

    /// Sum of the squares of all deviations, those from the priors included.
    // Not inlined: it is asked for in many places.
    #[inline(never)]
    pub(super) fn cost(&self) -> S {
        let observed = self.observed.iter().fold(S::Near::NO_SUM, |sum, off| S::Near::sum_and(sum, off.y, off.y));
        let finer = -self.units.finer;
        let observed = self.units.sum(observed, finer.saturating_add(finer));
        self.prior.iter().fold(observed, |sum, off| sum.plus_product(off.y, off.y))
    }
}
