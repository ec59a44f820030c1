//! One round of weighted least squares, by orthogonalisation, over what the samples show and what is believed beforehand.

use super::covariance::Covariance;
use super::equation::{Row, Rows};
use super::line3::LineInSpace;
use crate::scalar::{Scalar, hypot};

/// What a round finds, in units that keep every number near one: y in sigmas of the best row, q in its own spread.
#[derive(Clone, Copy)]
pub(crate) struct Solution<S> {
    /// One sigma of the best row.
    unit: S,
    /// Spread of q; zero where neither the motion nor anything believed says something.
    spread: S,
    mean_q: S,
    mean_w: S,
    weight: S,
    qq: S,
    /// ⟨q, w⟩/⟨q, q⟩
    c: S,
    /// ⟨w⊥, w⊥⟩; zero where tilt is not estimated.
    ww: S,
    /// In y: mean, along q and along w⊥.
    mean_y: S,
    rho: S,
    beta: S,
}

fn over<S: Scalar>(value: S) -> S {
    if value > S::ZERO { S::ONE / value } else { S::ZERO }
}

/// Weighted least squares by orthogonalisation: first the constant, then q, then what w has beyond q.
pub(crate) fn solve<S: Scalar, const N: usize>(rows: &mut Rows<S, N>) -> Solution<S> {
    let unit = rows.normalise_weights();
    let weight = rows.sum(|row| row.one * row.one);
    let per_weight = over(weight);
    let mean_q = rows.sum(|row| row.one * row.q) * per_weight;
    let mean_w = rows.sum(|row| row.one * row.w) * per_weight;
    let mean_y = rows.sum(|row| row.one * row.y) * per_weight;
    let size = |row: &Row<S>| ((row.q - row.one * mean_q) * row.root_weight).abs();
    let spread = rows.iter().map(size).fold(S::ZERO, S::max);
    let per_spread = over(spread);
    for row in rows.iter_mut() {
        row.q = (row.q - row.one * mean_q) * per_spread;
        row.w = row.w - row.one * mean_w;
        row.y = row.y - row.one * mean_y;
    }
    let qq = rows.sum(|row| row.q * row.q);
    let c = rows.sum(|row| row.q * row.w) * over(qq);
    let rho = rows.sum(|row| row.q * row.y) * over(qq);
    let (ww, beta) = (S::ZERO, S::ZERO);
    let mut solution = Solution { unit, spread, mean_q, mean_w, weight, qq, c, ww, mean_y, rho, beta };
    if rows.has_tilt() {
        solution.ww = rows.sum(|row| solution.across(row) * solution.across(row));
        solution.beta = rows.sum(|row| solution.across(row) * (row.y - rho * row.q)) * over(solution.ww);
    }
    solution
}

impl<S: Scalar> Solution<S> {
    /// What w has beyond q: the part of tilt that does not look like depth.
    fn across(&self, row: &Row<S>) -> S {
        row.w - self.c * row.q
    }

    pub(crate) fn apply(&self, edge: &LineInSpace<S>) -> LineInSpace<S> {
        let [bearing, inverse_depth, tilt] = self.unknowns(self.mean_y, self.rho, self.beta);
        LineInSpace {
            bearing: edge.bearing + bearing,
            inverse_depth: edge.inverse_depth + inverse_depth,
            tilt: edge.tilt + tilt,
            ..*edge
        }
    }

    /// (δa, δρ, δβ) from what y is along the orthogonal directions.
    fn unknowns(&self, mean: S, along: S, across: S) -> [S; 3] {
        let rho = (along - self.c * across) * over(self.spread);
        [mean - rho * self.mean_q - across * self.mean_w, rho, across]
    }

    /// How far this round has moved the estimate, in sigmas.
    pub(crate) fn step(&self) -> S {
        let along = hypot(self.mean_y * self.weight.sqrt(), self.rho * self.qq.sqrt());
        hypot(along, self.beta * self.ww.sqrt()) / self.unit
    }

    /// Residual of a row in units of its own noise.
    pub(crate) fn deviation(&self, row: &Row<S>) -> S {
        (row.y - self.rho * row.q - self.beta * self.across(row)) / self.unit * row.root_weight
    }

    /// How small errors of y, one for each row, move the unknowns.
    pub(crate) fn response<const N: usize>(&self, rows: &Rows<S, N>, errors: impl Iterator<Item = S>) -> [S; 3] {
        let (mut mean, mut along, mut across) = (S::ZERO, S::ZERO, S::ZERO);
        for (row, error) in rows.iter().zip(errors) {
            let error = row.weight() * error;
            mean = mean + error * row.one;
            along = along + error * row.q;
            across = across + error * self.across(row);
        }
        self.unknowns(mean * over(self.weight), along * over(self.qq), across * over(self.ww))
    }

    /// Where the motion says nothing of the depth.
    fn covariance_of_bearing_and_tilt(&self) -> Covariance<S> {
        let (beta, w) = (over(self.ww), self.mean_w);
        let moments = [over(self.weight) + w * w * beta, S::ZERO, beta, S::ZERO, -(w * beta), S::ZERO];
        let known = Covariance::scaled([self.unit, S::ONE, self.unit], moments);
        let [bearing, _, tilt] = known.sigma;
        Covariance { sigma: [bearing, S::UNKNOWN, tilt], ..known }
    }

    /// Covariance of the noise of all rows, the believed ones included.
    pub(crate) fn covariance(&self) -> Covariance<S> {
        if !(self.qq > S::ZERO && self.spread > S::ZERO) {
            return self.covariance_of_bearing_and_tilt();
        }
        let beta = over(self.ww);
        let rho = S::ONE / self.qq + self.c * self.c * beta;
        let rho_beta = -self.c * beta;
        // Of a = mean y − q̄ ρ − w̄ β.
        let q = self.mean_q / self.spread;
        let w = self.mean_w;
        let bearing = over(self.weight) + q * q * rho + w * w * beta + (q * w + q * w) * rho_beta;
        let moments = [bearing, rho, beta, -q * rho - w * rho_beta, -q * rho_beta - w * beta, rho_beta];
        Covariance::scaled([self.unit, self.unit / self.spread, self.unit], moments)
    }
}
