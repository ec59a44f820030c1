//! One round of weighted least squares, by orthogonalisation, over observations and priors. docs/model.md, section 3.

use super::covariance::Covariance;
use super::equation::{Equation, EquationUnits, Equations};
use crate::scalar::{Near, Scalar, over};

/// What a round finds.
#[derive(Clone, Copy)]
pub(crate) struct Solution<S> {
    /// What was subtracted from q, w and y to centre them.
    mean_q: S,
    mean_w: S,
    mean_y: S,
    /// ⟨1, 1⟩
    weight: S,
    /// ⟨q, q⟩; zero where neither the motion nor a prior says anything of the depth.
    qq: S,
    /// ⟨q, w⟩/⟨q, q⟩
    c: S,
    /// ⟨w⊥, w⊥⟩; zero where tilt is not estimated.
    ww: S,
    /// Components of y along q and along w⊥.
    rho: S,
    beta: S,
}

/// Weighted least squares by orthogonalisation: first the constant, then q, then the part of w that is orthogonal to q.
/// Leaves the equations centred and orthogonal, and of y what is not explained. They may be solved again after a change
/// of their sigmas: `before` is what solving them has told so far.
pub(crate) fn solve<S: Scalar, const N: usize>(equations: &mut Equations<S, N>, before: &Solution<S>) -> Solution<S> {
    let (weight, [mean_q, mean_w, mean_y]) = centre(equations);
    let (qq, [c, rho]) = take_q(equations);
    let (ww, beta) = if equations.has_tilt { take_w(equations) } else { (S::ZERO, S::ZERO) };
    Solution {
        mean_q: before.mean_q + mean_q,
        mean_w: before.mean_w.plus_product(before.c, mean_q) + mean_w,
        mean_y: before.mean_y.plus_product(before.rho, mean_q).plus_product(before.beta, mean_w) + mean_y,
        weight,
        qq,
        c: before.c + c,
        ww,
        rho: before.rho.plus_product(before.beta, c) + rho,
        beta: before.beta + beta,
    }
}

/// Subtracts from q, w and y their weighted means; the sum of all weights, and these.
fn centre<S: Scalar, const N: usize>(equations: &mut Equations<S, N>) -> (S, [S; 3]) {
    let (units, none) = (equations.units, S::Near::NO_SUM);
    let EquationUnits { reach, finer, .. } = units;
    let (mut weight, mut q, mut w, mut y) = (none, none, none, none);
    for equation in &equations.observed {
        let one = equation.one;
        (weight, q) = (S::Near::sum_and(weight, one, one), S::Near::sum_and(q, one, equation.q));
        (w, y) = (S::Near::sum_and(w, one, equation.w), S::Near::sum_and(y, one, equation.y));
    }
    let (mut weight, mut q) = (units.sum::<S>(weight, 0), units.sum::<S>(q, reach));
    let (mut w, mut y) = (units.sum::<S>(w, 0), units.sum::<S>(y, -finer));
    // What says nothing of the bearing has no part in it.
    for equation in equations.prior.iter().filter(|equation| equation.one != S::ZERO) {
        let one = equation.one;
        (weight, q) = (weight.plus_product(one, one), q.plus_product(one, equation.q));
        (w, y) = (w.plus_product(one, equation.w), y.plus_product(one, equation.y));
    }
    let per_weight = over(weight);
    let (q, w, y) = (q * per_weight, w * per_weight, y * per_weight);
    let (near_q, near_w, near_y) = (q.factor(reach), w.factor(0), y.factor(-finer));
    for equation in &mut equations.observed {
        let one = equation.one;
        (equation.q, equation.w) = (equation.q.minus_scaled(one, near_q), equation.w.minus_scaled(one, near_w));
        equation.y = equation.y.minus_scaled(one, near_y);
    }
    for equation in equations.prior.iter_mut().filter(|equation| equation.one != S::ZERO) {
        let one = equation.one;
        (equation.q, equation.w) = (equation.q.minus_product(one, q), equation.w.minus_product(one, w));
        equation.y = equation.y.minus_product(one, y);
    }
    (weight, [q, w, y])
}

/// Subtracts from w and y their parts along q; ⟨q, q⟩, and how much of q these are.
fn take_q<S: Scalar, const N: usize>(equations: &mut Equations<S, N>) -> (S, [S; 2]) {
    let (units, none) = (equations.units, S::Near::NO_SUM);
    let EquationUnits { reach, finer, .. } = units;
    let (mut qq, mut qw, mut qy) = (none, none, none);
    for Equation { q, w, y, .. } in &equations.observed {
        (qq, qw, qy) = (S::Near::sum_and(qq, *q, *q), S::Near::sum_and(qw, *q, *w), S::Near::sum_and(qy, *q, *y));
    }
    let mut qq = units.sum::<S>(qq, reach.saturating_add(reach));
    let (mut qw, mut qy) = (units.sum::<S>(qw, reach), units.sum::<S>(qy, reach.saturating_sub(finer)));
    for Equation { q, w, y, .. } in &equations.prior {
        (qq, qw, qy) = (qq.plus_product(*q, *q), qw.plus_product(*q, *w), qy.plus_product(*q, *y));
    }
    let per_qq = over(qq);
    let (c, rho) = (qw * per_qq, qy * per_qq);
    let per_reach = reach.saturating_neg();
    let (near_c, near_rho) = (c.factor(per_reach), rho.factor(per_reach.saturating_sub(finer)));
    for Equation { q, w, y, .. } in &mut equations.observed {
        (*w, *y) = (w.minus_scaled(*q, near_c), y.minus_scaled(*q, near_rho));
    }
    for Equation { q, w, y, .. } in &mut equations.prior {
        (*w, *y) = (w.minus_product(c, *q), y.minus_product(rho, *q));
    }
    (qq, [c, rho])
}

/// Subtracts from y its part along w; ⟨w, w⟩, and how much of w that is.
fn take_w<S: Scalar, const N: usize>(equations: &mut Equations<S, N>) -> (S, S) {
    let (units, none) = (equations.units, S::Near::NO_SUM);
    let (mut ww, mut wy) = (none, none);
    for Equation { w, y, .. } in &equations.observed {
        (ww, wy) = (S::Near::sum_and(ww, *w, *w), S::Near::sum_and(wy, *w, *y));
    }
    let (mut ww, mut wy) = (units.sum::<S>(ww, 0), units.sum::<S>(wy, -units.finer));
    for Equation { w, y, .. } in &equations.prior {
        (ww, wy) = (ww.plus_product(*w, *w), wy.plus_product(*w, *y));
    }
    let beta = wy * over(ww);
    let near_beta = beta.factor(-units.finer);
    for Equation { w, y, .. } in &mut equations.observed {
        *y = y.minus_scaled(*w, near_beta);
    }
    for Equation { w, y, .. } in &mut equations.prior {
        *y = y.minus_product(beta, *w);
    }
    (ww, beta)
}

impl<S: Scalar> Solution<S> {
    /// Of no equations.
    pub(super) const NOTHING: Self = Self {
        mean_q: S::ZERO,
        mean_w: S::ZERO,
        mean_y: S::ZERO,
        weight: S::ZERO,
        qq: S::ZERO,
        c: S::ZERO,
        ww: S::ZERO,
        rho: S::ZERO,
        beta: S::ZERO,
    };

    /// Changes of bearing, inverse depth and tilt.
    pub(crate) fn change(&self) -> [S; 3] {
        self.unknowns(self.mean_y, self.rho, self.beta)
    }

    /// (δa, δρ, δβ) from the components along the orthogonal directions.
    fn unknowns(&self, mean: S, along: S, across: S) -> [S; 3] {
        let rho = along - self.c * across;
        [mean - rho * self.mean_q - across * self.mean_w, rho, across]
    }

    /// The square of how far this round has moved the estimate, in sigmas.
    pub(crate) fn step_squared(&self) -> S {
        let along = self.mean_y * self.mean_y * self.weight + self.rho * self.rho * self.qq;
        along + self.beta * self.beta * self.ww
    }

    /// For equations of what is observed.
    pub(super) fn near(&self, units: EquationUnits) -> NearSolution<S::Near> {
        let EquationUnits { reach, .. } = units;
        NearSolution {
            mean_q: self.mean_q.factor(reach),
            mean_w: self.mean_w.factor(0),
            c: self.c.factor(reach.saturating_neg()),
        }
    }

    /// The q of an equation before it was solved.
    pub(crate) fn unsolved_q(&self, equation: &Equation<S>) -> S {
        equation.q.plus_product(equation.one, self.mean_q)
    }

    /// Zero where tilt is not estimated.
    pub(crate) fn variance_of_tilt(&self) -> S {
        over(self.ww)
    }

    /// Zero where nothing tells the inverse depth.
    pub(super) fn variance_of_inverse_depth(&self) -> S {
        over(self.qq) + self.c * self.c * over(self.ww)
    }

    /// One over that variance.
    pub(crate) fn information_of_inverse_depth(&self) -> S {
        over(self.variance_of_inverse_depth())
    }

    /// The change of bearing, inverse depth and tilt which costs least among those of a given change of the inverse
    /// depth.
    pub(crate) fn change_with(&self, inverse_depth: S) -> [S; 3] {
        let qq_c = self.qq * self.c;
        let across = -(qq_c * inverse_depth * over(self.ww + qq_c * self.c));
        self.unknowns(S::ZERO, inverse_depth + self.c * across, across)
    }

    /// How small errors of y, one for each equation, move the unknowns: adds that of an equation, in its sigma, to the
    /// sums over the equations.
    pub(super) fn respond(&self, [mean, along, across]: &mut [S; 3], equation: &Equation<S>, error: S) {
        *mean = mean.plus_product(error, equation.one);
        *along = along.plus_product(error, equation.q);
        *across = across.plus_product(error, equation.w);
    }

    /// These sums for errors that are a factor on q, as it was before it was centred, in all equations: these are
    /// orthogonal.
    pub(super) fn response_of_q(&self, factor: S) -> [S; 3] {
        [factor * self.mean_q * self.weight, factor * self.qq, S::ZERO]
    }

    /// From these sums, each, to changes of bearing, inverse depth and tilt.
    #[inline(never)] // what it needs is not on the stack while these sums are made
    pub(super) fn respond_all(&self, responses: &mut [[S; 3]]) {
        let [per_weight, per_qq, per_ww] = [self.weight, self.qq, self.ww].map(over);
        for response in responses {
            let [mean, along, across] = *response;
            *response = self.unknowns(mean * per_weight, along * per_qq, across * per_ww);
        }
    }

    /// Covariance from the noise of all equations, the priors included.
    pub(crate) fn covariance(&self) -> Covariance<S> {
        let (w, bb) = (self.mean_w, over(self.ww));
        let (q, rr) = if self.qq > S::ZERO {
            (self.mean_q, self.variance_of_inverse_depth())
        } else {
            // The motion says nothing of the depth.
            (S::ZERO, S::UNKNOWN * S::UNKNOWN)
        };
        let rb = -(self.c * bb);
        // a = mean y − q̄ ρ − w̄ β
        let aa = over(self.weight) + q * q * rr + w * w * bb + (q * w + q * w) * rb;
        Covariance { variance: [aa, rr, bb], mixed: [-(q * rr) - w * rb, -(q * rb) - w * bb, rb] }
    }
}

/// A [`Solution`] for equations of numbers near one.
pub(super) struct NearSolution<N: Near> {
    mean_q: N::Factor,
    mean_w: N::Factor,
    c: N::Factor,
}

impl<N: Near> NearSolution<N> {
    /// The q and the w of an equation before it was solved.
    pub(super) fn unsolved(&self, equation: &Equation<N>) -> [N; 2] {
        let Equation { one, q, w, .. } = *equation;
        [q.minus_scaled(-one, self.mean_q), w.minus_scaled(-one, self.mean_w).minus_scaled(-q, self.c)]
    }
}
