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
#[derive(Clone, Copy)]
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
    /// The prior's part of it.
    prior: S,
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
    let kept = rows.iter().filter(|row| row.root_weight > S::ZERO);
    let spread = kept.fold(S::ZERO, |most, row| most.max((row.q - mean_q).abs()));
    for row in rows.iter_mut() {
        row.q = if spread > S::ZERO { (row.q - mean_q) / spread } else { S::ZERO };
        row.w = row.w - mean_w;
        row.y = row.y - mean_y;
    }
    let qq = sum(rows, |row| row.q * row.q);
    let over_qq = if qq > S::ZERO { S::ONE / qq } else { S::ZERO };
    let c = sum(rows, |row| row.q * row.w) * over_qq;
    let rho = sum(rows, |row| row.q * row.y) * over_qq;
    let none = S::ZERO;
    let mut solution =
        Solution { unit, spread, mean_q, mean_w, weight, qq, c, ww: none, prior: none, mean_y, rho, beta: none };
    let sigma = prior_of_tilt(edge, uncertainty);
    if sigma > S::ZERO {
        solution.prior = unit / sigma * (unit / sigma);
        solution.ww = sum(rows, |row| solution.across(row) * solution.across(row)) + solution.prior;
        let pull = sum(rows, |row| solution.across(row) * (row.y - rho * row.q)) - edge.tilt * solution.prior;
        solution.beta = if solution.ww > S::ZERO { pull / solution.ww } else { S::ZERO };
    }
    solution
}

/// Turns each row's sigma into its weight relative to the best one, whose sigma is returned.
fn normalise_weights<S: Scalar>(rows: &mut [Row<S>]) -> S {
    let best = rows.iter().map(|row| row.root_weight).filter(|sigma| *sigma > S::ZERO).reduce(S::min);
    let unit = best.unwrap_or(S::EPSILON);
    for row in rows.iter_mut().filter(|row| row.root_weight > S::ZERO) {
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

    /// Residual of a row in units of its own noise.
    pub(crate) fn deviation(&self, row: &Row<S>) -> S {
        self.residual(row) / self.unit * row.root_weight
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
        let straightness = self.straightness(rows, sights);
        estimate.misfit = straightness.misfit;
        estimate.bent = straightness.bent;
        // The noise was understated where the residuals are larger than chance allows; tilt and common effects were not.
        let factor = if straightness.significant { straightness.misfit } else { S::ONE };
        self.with_noise(factor).fill_covariance(&mut estimate, common);
        estimate
    }

    /// The same with the noise of all rows larger by a factor.
    fn with_noise(&self, factor: S) -> Self {
        let prior = self.prior * factor * factor;
        Self { unit: self.unit * factor, ww: self.ww - self.prior + prior, prior, ..*self }
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
        let within = |sigma: S| sigma.min(S::UNKNOWN).max(S::EPSILON);
        let sigma_rho = within(hypot(noise_rho, common.inverse_depth));
        let sigma_bearing = within(hypot(noise_bearing, common.bearing));
        let noise_part = noise_correlation * (noise_rho / sigma_rho) * (noise_bearing / sigma_bearing);
        let common_part = common.correlation * (common.inverse_depth / sigma_rho) * (common.bearing / sigma_bearing);
        let correlation = noise_part + common_part;
        estimate.correlation = if correlation.is_finite() { correlation.min(S::ONE).max(-S::ONE) } else { S::ZERO };
        estimate.sigma_inverse_depth_per_m = sigma_rho;
        estimate.sigma_bearing = sigma_bearing;
        estimate.sigma_common_per_m = common.inverse_depth;
    }

    /// Residuals against the stated noise: their size, and whether they follow each other, as those of a curve do.
    fn straightness(&self, rows: &[Row<S>], sights: &[Sight<S>]) -> Straightness<S> {
        // Knots are means over curved arcs: what they may cost is no sign of a bend.
        let floor = S::ratio(1, 256);
        // Capped where fixed point would run out of room.
        let cap = S::from_i32(1_000);
        let (mut squares, mut steps, mut previous) = (S::ZERO, S::ZERO, None);
        for (row, sight) in rows.iter().zip(sights).filter(|(_, sight)| sight.kept) {
            let sigma = sight.sigma_px / hypot(sight.sigma_px, floor);
            let off = self.deviation(row) * sigma;
            let off = off.min(cap).max(-cap);
            squares = squares + off * off;
            if let Some(previous) = previous {
                let step: S = off - previous;
                steps = steps + step * step;
            }
            previous = Some(off);
        }
        // Bearing and inverse depth are free.
        let kept = sights.iter().filter(|sight| sight.kept).count();
        let Some(spare) = kept.checked_sub(2).filter(|spare| *spare > 0) else {
            return Straightness { misfit: S::ZERO, significant: false, bent: false };
        };
        let spare = S::from_i32(spare as i32);
        let variance = squares / spare;
        let significant = variance > chance_limit(spare);
        // Durbin and Watson: 2 for noise, near 0 for a curve.
        let follows = steps < squares;
        let bent = significant && (follows && variance > S::from_i32(4) || variance > S::from_i32(25));
        Straightness { misfit: variance.sqrt(), significant, bent }
    }
}

struct Straightness<S> {
    misfit: S,
    /// Larger than chance allows.
    significant: bool,
    bent: bool,
}

/// What the mean square of `count` unit variates exceeds once in 30000 times (Wilson and Hilferty at four sigma).
fn chance_limit<S: Scalar>(count: S) -> S {
    let part = S::ratio(2, 9) / count;
    let root = S::ONE - part + S::from_i32(4) * part.sqrt();
    root * root * root
}
