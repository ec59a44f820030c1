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
    /// Change of the inverse depth: ρ less what of it the tilt takes.
    inverse_depth: S,
}

/// Weighted least squares by orthogonalisation: first the constant, then q, then the part of w that is orthogonal to q.
/// Leaves the equations centred; they may be solved again after a change of their sigmas.
pub(crate) fn solve<S: Scalar, const N: usize>(equations: &mut Equations<S, N>) -> Solution<S> {
    let weight = centre(equations);
    let [mean_q, mean_w, mean_y] = equations.centre;
    let EquationUnits { scale, reach, finer } = equations.units;
    let (twice, of_qy) = (scale.saturating_add(scale), reach.saturating_sub(finer));
    let ([of_qq, of_qw], none) = ([reach.saturating_add(reach), reach], S::Near::NO_SUM);
    let (mut qq, mut qw, mut qy) = (none, none, none);
    for Equation { q, w, y, .. } in &equations.observed {
        (qq, qw, qy) = (S::Near::sum_and(qq, *q, *q), S::Near::sum_and(qw, *q, *w), S::Near::sum_and(qy, *q, *y));
    }
    let whole = |sum, exponent: i32| S::of_sum(sum, twice.saturating_add(exponent));
    let (mut qq, mut qw, mut qy) = (whole(qq, of_qq), whole(qw, of_qw), whole(qy, of_qy));
    for Equation { q, w, y, .. } in &equations.prior {
        (qq, qw, qy) = (qq.plus_product(*q, *q), qw.plus_product(*q, *w), qy.plus_product(*q, *y));
    }
    let per_qq = over(qq);
    let (c, rho) = (qw * per_qq, qy * per_qq);
    let mut solution = Solution { mean_q, mean_w, mean_y, weight, qq, c, rho, inverse_depth: rho, ..Solution::NOTHING };
    if equations.has_tilt {
        let near = solution.near(equations.units);
        let (mut ww, mut wy) = (none, none);
        for equation in &equations.observed {
            let across = near.across(equation);
            let off = equation.y.minus_scaled(equation.q, near.rho);
            (ww, wy) = (S::Near::sum_and(ww, across, across), S::Near::sum_and(wy, across, off));
        }
        let (mut ww, mut wy) = (whole(ww, 0), whole(wy, -finer));
        for equation in &equations.prior {
            let across = solution.across(equation);
            let off = equation.y.minus_product(rho, equation.q);
            (ww, wy) = (ww.plus_product(across, across), wy.plus_product(across, off));
        }
        (solution.ww, solution.beta) = (ww, wy * over(ww));
        solution.inverse_depth = rho.minus_product(c, solution.beta);
    }
    solution
}

/// Subtracts from q, w and y their weighted means; the sum of all weights.
fn centre<S: Scalar, const N: usize>(equations: &mut Equations<S, N>) -> S {
    let EquationUnits { scale, reach, finer } = equations.units;
    let twice = scale.saturating_add(scale);
    let none = S::Near::NO_SUM;
    let (mut weight, mut q, mut w, mut y) = (none, none, none, none);
    for equation in &equations.observed {
        let one = equation.one;
        (weight, q) = (S::Near::sum_and(weight, one, one), S::Near::sum_and(q, one, equation.q));
        (w, y) = (S::Near::sum_and(w, one, equation.w), S::Near::sum_and(y, one, equation.y));
    }
    let whole = |sum, exponent: i32| S::of_sum(sum, twice.saturating_add(exponent));
    let (mut weight, mut q) = (whole(weight, 0), whole(q, reach));
    let (mut w, mut y) = (whole(w, 0), whole(y, -finer));
    for equation in &equations.prior {
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
    for equation in &mut equations.prior {
        let one = equation.one;
        (equation.q, equation.w) = (equation.q.minus_product(one, q), equation.w.minus_product(one, w));
        equation.y = equation.y.minus_product(one, y);
    }
    let [mean_q, mean_w, mean_y] = equations.centre;
    equations.centre = [mean_q + q, mean_w + w, mean_y + y];
    weight
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
        inverse_depth: S::ZERO,
    };

    /// The part of w that is orthogonal to q: what of the tilt does not look like depth.
    fn across(&self, equation: &Equation<S>) -> S {
        equation.w.minus_product(self.c, equation.q)
    }

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

    /// Residual of an equation in units of its own noise.
    pub(crate) fn deviation(&self, equation: &Equation<S>) -> S {
        equation.y.minus_product(self.inverse_depth, equation.q).minus_product(self.beta, equation.w)
    }

    /// Sum of the squares of all deviations, those from the priors included.
    pub(crate) fn cost<const N: usize>(&self, equations: &Equations<S, N>) -> S {
        let (near, unit) = (self.near(equations.units), equations.units.y());
        let observed = equations.observed.iter().map(|equation| near.near_deviation(equation));
        let observed = observed.fold(S::Near::NO_SUM, |sum, off| S::Near::sum_and(sum, off, off));
        let prior = equations.prior.iter().map(|equation| self.deviation(equation));
        prior.fold(S::of_sum(observed, unit.saturating_add(unit)), |sum, off| sum.plus_product(off, off))
    }

    /// For equations of what is observed.
    pub(super) fn near(&self, units: EquationUnits) -> NearSolution<S::Near> {
        let EquationUnits { reach, finer, .. } = units;
        let per_reach = reach.saturating_neg();
        let of_y = per_reach.saturating_sub(finer);
        NearSolution {
            mean_q: self.mean_q.factor(reach),
            mean_w: self.mean_w.factor(0),
            c: self.c.factor(per_reach),
            rho: self.rho.factor(of_y),
            beta: self.beta.factor(-finer),
            inverse_depth: self.inverse_depth.factor(of_y),
            unit_of_y: units.y(),
        }
    }

    /// The q and the w of an equation before it was centred.
    pub(crate) fn uncentred(&self, equation: &Equation<S>) -> [S; 2] {
        let Equation { one, q, w, .. } = *equation;
        [q.plus_product(one, self.mean_q), w.plus_product(one, self.mean_w)]
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
        *across = across.plus_product(error, self.across(equation));
    }

    /// These sums for errors that are a factor on q, as it was before it was centred, in all equations: these are
    /// orthogonal.
    pub(super) fn response_of_q(&self, factor: S) -> [S; 3] {
        [factor * self.mean_q * self.weight, factor * self.qq, S::ZERO]
    }

    /// From these sums, each, to changes of bearing, inverse depth and tilt.
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
    rho: N::Factor,
    beta: N::Factor,
    inverse_depth: N::Factor,
    unit_of_y: i32,
}

impl<N: Near> NearSolution<N> {
    fn across(&self, equation: &Equation<N>) -> N {
        equation.w.minus_scaled(equation.q, self.c)
    }

    /// As [`Solution::deviation`], in the unit of the equation's y.
    pub(super) fn near_deviation(&self, equation: &Equation<N>) -> N {
        equation.y.minus_scaled(equation.q, self.inverse_depth).minus_scaled(equation.w, self.beta)
    }

    /// As [`Solution::deviation`].
    pub(super) fn deviation<S: Scalar<Near = N>>(&self, equation: &Equation<N>) -> S {
        S::of_near(self.near_deviation(equation), self.unit_of_y)
    }

    /// As [`Solution::uncentred`].
    pub(super) fn uncentred(&self, equation: &Equation<N>) -> [N; 2] {
        let Equation { one, q, w, .. } = *equation;
        [q.minus_scaled(-one, self.mean_q), w.minus_scaled(-one, self.mean_w)]
    }
}
