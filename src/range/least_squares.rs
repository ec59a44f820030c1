//! One round of weighted least squares, by orthogonalisation, over observations and priors. docs/model.md, section 3.

use super::covariance::Covariance;
use super::equation::{Equation, Equations};
use super::line3::Line3;
use crate::scalar::{Scalar, hypot};

/// What a round finds, in units that keep every number near one: y in the smallest sigma, q in its own spread.
#[derive(Clone, Copy)]
pub(crate) struct Solution<S> {
    /// The smallest sigma.
    unit: S,
    /// Spread of q; zero where neither the motion nor a prior says anything of the depth.
    spread: S,
    mean_q: S,
    mean_w: S,
    weight: S,
    qq: S,
    /// ⟨q, w⟩/⟨q, q⟩
    c: S,
    /// ⟨w⊥, w⊥⟩; zero where tilt is not estimated.
    ww: S,
    /// Components of y: mean, along q and along w⊥.
    mean_y: S,
    rho: S,
    beta: S,
}

fn over<S: Scalar>(value: S) -> S {
    if value > S::ZERO { S::ONE / value } else { S::ZERO }
}

/// Weighted least squares by orthogonalisation: first the constant, then q, then the part of w that is orthogonal to q.
pub(crate) fn solve<S: Scalar, const N: usize>(equations: &mut Equations<S, N>) -> Solution<S> {
    let unit = equations.normalise_weights();
    let weight = equations.sum(|equation| equation.one * equation.one);
    let per_weight = over(weight);
    let mean_q = equations.sum(|equation| equation.one * equation.q) * per_weight;
    let mean_w = equations.sum(|equation| equation.one * equation.w) * per_weight;
    let mean_y = equations.sum(|equation| equation.one * equation.y) * per_weight;
    let size = |equation: &Equation<S>| ((equation.q - equation.one * mean_q) * equation.root_weight).abs();
    let spread = equations.iter().map(size).fold(S::ZERO, S::max);
    let per_spread = over(spread);
    for equation in equations.iter_mut() {
        equation.q = (equation.q - equation.one * mean_q) * per_spread;
        equation.w = equation.w - equation.one * mean_w;
        equation.y = equation.y - equation.one * mean_y;
    }
    let qq = equations.sum(|equation| equation.q * equation.q);
    let c = equations.sum(|equation| equation.q * equation.w) * over(qq);
    let rho = equations.sum(|equation| equation.q * equation.y) * over(qq);
    let (ww, beta) = (S::ZERO, S::ZERO);
    let mut solution = Solution { unit, spread, mean_q, mean_w, weight, qq, c, ww, mean_y, rho, beta };
    if equations.has_tilt() {
        solution.ww = equations.sum(|equation| solution.across(equation) * solution.across(equation));
        solution.beta =
            equations.sum(|equation| solution.across(equation) * (equation.y - rho * equation.q)) * over(solution.ww);
    }
    solution
}

impl<S: Scalar> Solution<S> {
    /// The part of w that is orthogonal to q: what of the tilt does not look like depth.
    fn across(&self, equation: &Equation<S>) -> S {
        equation.w - self.c * equation.q
    }

    pub(crate) fn apply(&self, line3: &Line3<S>) -> Line3<S> {
        let [bearing, inverse_depth, tilt] = self.unknowns(self.mean_y, self.rho, self.beta);
        Line3 {
            bearing: line3.bearing + bearing,
            inverse_depth: line3.inverse_depth + inverse_depth,
            tilt: line3.tilt + tilt,
            ..*line3
        }
    }

    /// (δa, δρ, δβ) from the components along the orthogonal directions.
    fn unknowns(&self, mean: S, along: S, across: S) -> [S; 3] {
        let rho = (along - self.c * across) * over(self.spread);
        [mean - rho * self.mean_q - across * self.mean_w, rho, across]
    }

    /// How far this round has moved the estimate, in sigmas.
    pub(crate) fn step(&self) -> S {
        let along = hypot(self.mean_y * self.weight.sqrt(), self.rho * self.qq.sqrt());
        hypot(along, self.beta * self.ww.sqrt()) / self.unit
    }

    /// Residual of an equation in units of its own noise.
    pub(crate) fn deviation(&self, equation: &Equation<S>) -> S {
        (equation.y - self.rho * equation.q - self.beta * self.across(equation)) / self.unit * equation.root_weight
    }

    /// How small errors of y, one for each equation, move the unknowns.
    pub(crate) fn response<const N: usize>(
        &self,
        equations: &Equations<S, N>,
        errors: impl Iterator<Item = S>,
    ) -> [S; 3] {
        let (mut mean, mut along, mut across) = (S::ZERO, S::ZERO, S::ZERO);
        for (equation, error) in equations.iter().zip(errors) {
            let error = equation.weight() * error;
            mean = mean + error * equation.one;
            along = along + error * equation.q;
            across = across + error * self.across(equation);
        }
        self.unknowns(mean * over(self.weight), along * over(self.qq), across * over(self.ww))
    }

    /// The covariance where the motion says nothing of the depth.
    fn covariance_of_bearing_and_tilt(&self) -> Covariance<S> {
        let (beta, w) = (over(self.ww), self.mean_w);
        let moments = [over(self.weight) + w * w * beta, S::ZERO, beta, S::ZERO, -(w * beta), S::ZERO];
        let known = Covariance::scaled([self.unit, S::ONE, self.unit], moments);
        let [bearing, _, tilt] = known.sigma;
        Covariance { sigma: [bearing, S::UNKNOWN, tilt], ..known }
    }

    /// Covariance from the noise of all equations, the priors included.
    pub(crate) fn covariance(&self) -> Covariance<S> {
        if !(self.qq > S::ZERO && self.spread > S::ZERO) {
            return self.covariance_of_bearing_and_tilt();
        }
        let beta = over(self.ww);
        let rho = S::ONE / self.qq + self.c * self.c * beta;
        let rho_beta = -self.c * beta;
        // a = mean y − q̄ ρ − w̄ β
        let q = self.mean_q / self.spread;
        let w = self.mean_w;
        let bearing = over(self.weight) + q * q * rho + w * w * beta + (q * w + q * w) * rho_beta;
        let moments = [bearing, rho, beta, -q * rho - w * rho_beta, -q * rho_beta - w * beta, rho_beta];
        Covariance::scaled([self.unit, self.unit / self.spread, self.unit], moments)
    }
}
