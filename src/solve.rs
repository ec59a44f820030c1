//! One round of weighted least squares, by orthogonalisation, and what it says about covariance and straightness.

use crate::common::Common;
use crate::estimate::Estimate;
use crate::scalar::hypot;
use crate::sight::{LineInSpace, Sight};
use crate::vector::{cross, dot};
use crate::{Scalar, Uncertainty};

/// One linearised observation `y = δa + q δρ + w δβ` with its weight.
#[derive(Clone, Copy)]
pub(crate) struct Row<S> {
    pub(crate) q: S,
    pub(crate) w: S,
    pub(crate) y: S,
    /// One sigma of y, later that of the best row relative to it: a weight between 0 and 1, to be squared.
    pub(crate) root_weight: S,
}

impl<S: Scalar> Row<S> {
    fn weight(&self) -> S {
        self.root_weight * self.root_weight
    }
}

/// What a round finds, in units that keep every number near one: y in sigmas of the best row, q in its own spread.
pub(crate) struct Solution<S> {
    /// One sigma of the best row.
    unit: S,
    /// Spread of q; zero where the motion says nothing.
    spread: S,
    mean_q: S,
    mean_w: S,
    weight: S,
    qq: S,
    /// ⟨q, w⟩/⟨q, q⟩
    c: S,
    /// ⟨w⊥, w⊥⟩ plus the prior; zero where tilt is not estimated.
    ww: S,
    /// In y: mean, along q and along w⊥.
    mean_y: S,
    rho: S,
    beta: S,
}

/// Weighted least squares by orthogonalisation: first q, then what w has beyond q.
pub(crate) fn solve<S: Scalar>(
    rows: &mut [Row<S>],
    edge: &LineInSpace<S>,
    uncertainty: &Uncertainty<S>,
) -> Solution<S> {
    let unit = normalise_weights(rows);
    let weight = sum(rows, |_| S::ONE);
    let mean_q = sum(rows, |row| row.q) / weight;
    let mean_w = sum(rows, |row| row.w) / weight;
    let mean_y = sum(rows, |row| row.y) / weight;
    let spread = rows.iter().fold(S::ZERO, |most, row| most.max((row.q - mean_q).abs()));
    for row in rows.iter_mut() {
        row.q = if spread > S::ZERO { (row.q - mean_q) / spread } else { S::ZERO };
        row.w = row.w - mean_w;
        row.y = row.y - mean_y;
    }
    let qq = sum(rows, |row| row.q * row.q);
    let over_qq = if qq > S::ZERO { S::ONE / qq } else { S::ZERO };
    let c = sum(rows, |row| row.q * row.w) * over_qq;
    let rho = sum(rows, |row| row.q * row.y) * over_qq;
    let mut solution =
        Solution { unit, spread, mean_q, mean_w, weight, qq, c, ww: S::ZERO, mean_y, rho, beta: S::ZERO };
    let sigma = prior_of_tilt(edge, uncertainty);
    if sigma > S::ZERO {
        let prior = unit / sigma * (unit / sigma);
        solution.ww = sum(rows, |row| solution.across(row) * solution.across(row)) + prior;
        let pull = sum(rows, |row| solution.across(row) * (row.y - rho * row.q)) - edge.tilt * prior;
        solution.beta = if solution.ww > S::ZERO { pull / solution.ww } else { S::ZERO };
    }
    solution
}

/// Turns each row's sigma into its weight relative to the best one, whose sigma is returned.
fn normalise_weights<S: Scalar>(rows: &mut [Row<S>]) -> S {
    let best = rows.iter().map(|row| row.root_weight).filter(|sigma| *sigma > S::ZERO).reduce(S::min);
    let unit = best.unwrap_or(S::EPSILON);
    for row in rows.iter_mut() {
        row.root_weight = if row.root_weight > unit { unit / row.root_weight } else { S::ONE };
    }
    unit
}

fn sum<S: Scalar>(rows: &[Row<S>], value: impl Fn(&Row<S>) -> S) -> S {
    rows.iter().fold(S::ZERO, |sum, row| sum + row.weight() * value(row))
}

/// Each edge's own lean, the camera's roll, and its pitch, which enters with the bearing.
fn prior_of_tilt<S: Scalar>(edge: &LineInSpace<S>, uncertainty: &Uncertainty<S>) -> S {
    let (lean, gravity) = (uncertainty.sigma_tilt, uncertainty.sigma_gravity);
    (lean * lean + gravity * gravity * (S::ONE + edge.bearing * edge.bearing)).sqrt()
}

impl<S: Scalar> Solution<S> {
    /// What w has beyond q: the part of tilt that does not look like depth.
    fn across(&self, row: &Row<S>) -> S {
        row.w - self.c * row.q
    }

    fn per_spread(&self) -> S {
        if self.spread > S::ZERO { S::ONE / self.spread } else { S::ZERO }
    }

    pub(crate) fn apply(&self, edge: &LineInSpace<S>) -> LineInSpace<S> {
        let delta = (self.rho - self.c * self.beta) * self.per_spread();
        LineInSpace {
            bearing: edge.bearing + self.mean_y - delta * self.mean_q - self.beta * self.mean_w,
            inverse_depth: edge.inverse_depth + delta,
            tilt: edge.tilt + self.beta,
            ..*edge
        }
    }

    fn residual(&self, row: &Row<S>) -> S {
        row.y - self.rho * row.q - self.beta * self.across(row)
    }

    /// How a small common error of `y` moves bearing and inverse depth.
    pub(crate) fn response(&self, rows: &[Row<S>], errors: impl Iterator<Item = S>) -> [S; 2] {
        let (mut mean, mut along, mut across) = (S::ZERO, S::ZERO, S::ZERO);
        for (row, error) in rows.iter().zip(errors) {
            let error = row.weight() * error;
            mean = mean + error;
            along = along + error * row.q;
            across = across + error * self.across(row);
        }
        if !(self.qq > S::ZERO && self.weight > S::ZERO) {
            return [S::ZERO; 2];
        }
        let beta = if self.ww > S::ZERO { across / self.ww } else { S::ZERO };
        let rho = (along / self.qq - self.c * beta) * self.per_spread();
        [mean / self.weight - rho * self.mean_q - beta * self.mean_w, rho]
    }

    pub(crate) fn estimate(
        &self,
        edge: &LineInSpace<S>,
        rows: &[Row<S>],
        sights: &[Sight<S>],
        common: &Common<S>,
    ) -> Estimate<S> {
        let across = cross([edge.bearing, S::ZERO, S::ONE], edge.gravity);
        let mut estimate = Estimate {
            bearing: edge.bearing,
            inverse_depth_per_m: edge.inverse_depth,
            tilt: edge.tilt,
            distance_per_depth: dot(across, across).sqrt(),
            ..Estimate::nothing()
        };
        self.fill_covariance(&mut estimate, common);
        self.judge_straightness(&mut estimate, rows, sights);
        estimate
    }

    /// Covariance of pixel noise and tilt's prior, then that of the common effects.
    fn fill_covariance(&self, estimate: &mut Estimate<S>, common: &Common<S>) {
        let beta = if self.ww > S::ZERO { S::ONE / self.ww } else { S::ZERO };
        estimate.sigma_tilt = self.unit * beta.sqrt();
        if !(self.qq > S::ZERO && self.spread > S::ZERO) {
            estimate.inverse_depth_per_m = S::ZERO;
            return;
        }
        let rho = S::ONE / self.qq + self.c * self.c * beta;
        let rho_beta = -self.c * beta;
        // Of a = mean y − q̄ ρ − w̄ β.
        let q = self.mean_q / self.spread;
        let w = self.mean_w;
        let bearing = S::ONE / self.weight + q * q * rho + w * w * beta + (q * w + q * w) * rho_beta;
        let bearing_rho = -q * rho - w * rho_beta;
        // Sigmas, not variances, leave the normalised units: fixed point has no room for their squares.
        let noise_rho = self.unit * rho.sqrt() / self.spread;
        let noise_bearing = self.unit * bearing.max(S::ZERO).sqrt();
        let noise_correlation = bearing_rho / (rho * bearing).sqrt().max(S::EPSILON);
        let sigma_rho = hypot(noise_rho, common.inverse_depth).min(S::UNKNOWN);
        let sigma_bearing = hypot(noise_bearing, common.bearing).min(S::UNKNOWN);
        let noise_part = noise_correlation * (noise_rho / sigma_rho) * (noise_bearing / sigma_bearing);
        let common_part = common.correlation * (common.inverse_depth / sigma_rho) * (common.bearing / sigma_bearing);
        let correlation = noise_part + common_part;
        estimate.correlation = if correlation.is_finite() { correlation.min(S::ONE).max(-S::ONE) } else { S::ZERO };
        estimate.sigma_inverse_depth_per_m = sigma_rho;
        estimate.sigma_bearing = sigma_bearing;
        estimate.sigma_common_per_m = common.inverse_depth;
    }

    /// Residuals against the stated noise: their size, and whether they follow each other, as those of a curve do.
    fn judge_straightness(&self, estimate: &mut Estimate<S>, rows: &[Row<S>], sights: &[Sight<S>]) {
        // Knots are means over curved arcs: what they may cost is no sign of a bend.
        let floor = S::ratio(1, 256);
        let (mut squares, mut steps, mut previous) = (S::ZERO, S::ZERO, None);
        for (row, sight) in rows.iter().zip(sights) {
            let sigma = sight.sigma_px / hypot(sight.sigma_px, floor);
            // Capped where fixed point would run out of room; a hundred sigma say no more than thirty.
            let cap = S::from_i32(1_000);
            let off = self.residual(row) / self.unit * row.root_weight * sigma;
            let off = off.min(cap).max(-cap);
            squares = squares + off * off;
            if let Some(previous) = previous {
                let step: S = off - previous;
                steps = steps + step * step;
            }
            previous = Some(off);
        }
        let unknowns = 2;
        let spare = rows.len().saturating_sub(unknowns);
        if spare == 0 {
            return;
        }
        let spare = S::from_i32(spare as i32);
        let variance = squares / spare;
        estimate.misfit = variance.sqrt();
        // Noise alone goes beyond four sigma of its own spread, sqrt(2/n), in no frame of a lifetime.
        let significant = S::ONE + S::from_i32(4) * (S::ratio(2, 1) / spare).sqrt();
        if variance > significant {
            // Durbin and Watson: 2 for noise, near 0 for a curve.
            let follows = steps < squares;
            estimate.bent = follows && variance > S::from_i32(4) || variance > S::from_i32(25);
            estimate.sigma_inverse_depth_per_m = (estimate.sigma_inverse_depth_per_m * estimate.misfit).min(S::UNKNOWN);
            estimate.sigma_bearing = (estimate.sigma_bearing * estimate.misfit).min(S::UNKNOWN);
        }
    }
}
