//! [`fit`]: the exact estimator, from samples of one edge to its bearing and inverse depth.
//!
//! An upright edge is the line `P0 + λ g` with `P0 = Z (a, 0, 1)`. A pixel seen at time t looks along `d = R(t) r` from
//! `p(t)`, and line and ray meet where `m · (P0 − p) = 0` with `m = d × g`. With the inverse depth ρ = 1/Z this is
//! *linear* in (a, ρ) for any motion, rotation and attitude:
//!
//! ```text
//! F = m · P = 0,   P = (a, 0, 1) − ρ p;     −F/m_x = δa + q δρ + w δβ,   q = −(m · p)/m_x
//! ```
//!
//! β, the lean of the edge in the image plane, is the third unknown, with a prior. Every round linearises about the last
//! estimate, so that the sums hold small residuals (single precision suffices) and the regressor q does not share the
//! noise of the observation (no bias in forward motion). The rounds are solved by orthogonalisation: inverting the
//! 3 × 3 normal matrix, whose condition is 10⁴ to 10⁶, would return nonsense in single precision.

use heapless::Vec;

use super::equation::{Equation, Equations};
use super::estimate::Estimate;
use super::goodness_of_fit::GoodnessOfFit;
use super::least_squares::{Solution, solve};
use super::line_state::LineState;
use super::line3::Line3;
use super::observation::Observation;
use super::prior::Prior;
use super::sample::{Sample, Spread};
use super::sensitivity::Sensitivity;
use super::status::RangeStatus;
use super::wander::{Residual, Stretch, Wander};
use crate::error::FitError;
use crate::motion::Motion;
use crate::scalar::{Scalar, cross, dot, hypot};
use crate::setup::Setup;

/// Bearing, inverse depth and tilt of one edge with their covariance, from at most `N` samples.
///
/// The uncertainty of the setup is part of the covariance; of its limits, that of a bend is used, and its readout is not.
///
/// *Errors*: see [`FitError`]. A motion that says nothing is no error: sigma is then [`Scalar::UNKNOWN`].
///
/// *Cost*: a pose and a ray per sample, then rounds of about 100 operations per sample: mostly three, more where the tilt
/// is free, at most 130 where outliers must be rejected; 40 `N` numbers of stack.
///
/// *Source*: `m · (P0 − p(t)) = 0`, docs/model.md, section 3; for a level camera in translation along x this is the paper's equation (3).
///
/// ```
/// use shutter_range::{Sample, Setup, Twist, Uncertainty, fit};
/// let setup = Setup::pinhole(640, 480, 600.0_f64, 33_300_000)?.with_uncertainty(Uncertainty::NONE)?;
/// let motion = Twist::level([-2.0, 0.0, 0.0])?; // to the left, so the edge moves to the right
/// let samples = [0.0, 0.01, 0.02, 0.03]
///     .map(|time_s| Sample::point(300.0 + 600.0 * 2.0 * time_s / 4.0, 0.0, time_s, 0.1));
/// let estimate = fit::<_, _, 8>(&setup, &motion, samples)?;
/// assert!((estimate.inverse_depth_per_m - 1.0 / 4.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
pub fn fit<S: Scalar, M: Motion<S>, const N: usize>(
    setup: &Setup<S>,
    motion: &M,
    samples: impl IntoIterator<Item = Sample<S>>,
) -> Result<Estimate<S>, FitError> {
    let prior = Prior { state: None, blur: None, width_px: S::ONE };
    fit_with::<S, M, N>(setup, motion, samples, &prior).map(|fitted| fitted.estimate)
}

/// An estimate, and what the next frame needs of it.
pub(crate) struct Fitted<S, const N: usize> {
    pub(crate) estimate: Estimate<S>,
    pub(crate) state: LineState<S>,
    /// Which of the samples are inliers.
    pub(crate) inliers: Vec<bool, N>,
}

/// [`fit`] with a prior.
pub(crate) fn fit_with<S: Scalar, M: Motion<S>, const N: usize>(
    setup: &Setup<S>,
    motion: &M,
    samples: impl IntoIterator<Item = Sample<S>>,
    prior: &Prior<S>,
) -> Result<Fitted<S, N>, FitError> {
    let (observations, stretches) = observe_all::<S, M, N>(setup, motion, samples)?;
    let mut problem = Problem { setup, prior, observations, stretches };
    let free_tilt = setup.uncertainty().sigma_tilt_at(S::ZERO) > S::ZERO;
    let least = if free_tilt && prior.state.is_none() { 3 } else { 2 };
    if problem.observations.len() < least {
        return Err(FitError::TooFewSamples(problem.observations.len()));
    }
    // The problem is linear but for tilt, blur, weights and the noise in q, which the first round leaves out.
    let start = match &prior.state {
        Some(state) => state.line3,
        None => problem.round(&Line3::start(motion.gravity()), Round::First)?.line3,
    };
    let mut solved = problem.settle_best(&start)?;
    for _ in 0..MAX_REJECTIONS {
        let Some(reweighted) = problem.reweight(&solved) else { break };
        if !problem.reject_outliers(&reweighted) {
            break;
        }
        solved = problem.settle(&solved.line3)?;
    }
    let goodness_of_fit = problem.goodness_of_fit(&solved);
    if problem.count_wander(&solved) {
        solved = problem.settle(&solved.line3)?;
    }
    let Solved { line3, solution, equations } = solved;
    let sensitivity = Sensitivity::of(&problem.observations, &line3, &equations, &solution, setup);
    let state = LineState { line3, covariance: solution.covariance(), sensitivity };
    let estimate = Estimate::new(&state, setup, &goodness_of_fit);
    if !estimate.is_finite() {
        return Err(FitError::Diverged);
    }
    // The equations do not know that a camera passes no edge within a frame.
    let passes = estimate.status() == RangeStatus::Ok && !problem.is_in_front(&line3);
    let estimate = Estimate { bent: estimate.bent || passes, ..estimate };
    let mut inliers = Vec::new();
    for observation in &problem.observations {
        // There is room: as many as observations. `collect` could panic.
        let _ = inliers.push(observation.is_inlier);
    }
    Ok(Fitted { estimate, state, inliers })
}

/// Each sample as a ray, and which part of the edge it is the mean of.
type Observed<S, const N: usize> = (Vec<Observation<S>, N>, Vec<Stretch<S>, N>);

fn observe_all<S: Scalar, M: Motion<S>, const N: usize>(
    setup: &Setup<S>,
    motion: &M,
    samples: impl IntoIterator<Item = Sample<S>>,
) -> Result<Observed<S, N>, FitError> {
    let roughness_px = setup.uncertainty().edge_roughness_px;
    let (mut observations, mut stretches) = (Vec::new(), Vec::new());
    for (index, sample) in samples.into_iter().enumerate() {
        let Spread { column_px, row_px, time_s } = sample.spread;
        let numbers = [sample.column_px, sample.row_px, sample.time_s, sample.sigma_px, column_px, row_px, time_s];
        if !(numbers.into_iter().all(S::is_finite) && sample.sigma_px > S::ZERO) {
            return Err(FitError::InvalidSample(index));
        }
        let seen = Observation::new(setup.camera(), motion, &sample).ok_or(FitError::InvalidSample(index))?;
        let stretch = Stretch::of(&sample, seen.sigma_px, setup.readout());
        let observation = Observation { sigma_px: stretch.rough_sigma_px(roughness_px), ..seen };
        observations.push(observation).map_err(|_| FitError::TooManySamples)?;
        stretches.push(stretch).map_err(|_| FitError::TooManySamples)?;
    }
    Ok((observations, stretches))
}

#[derive(Clone, Copy, PartialEq)]
enum Round {
    /// Nothing is known yet: q is computed from the noisy observation itself.
    First,
    /// q is moved from the observed column to the predicted one.
    Later,
}

fn observe<S: Scalar>(observation: &Observation<S>, line3: &Line3<S>, round: Round) -> Option<Equation<S>> {
    let down = line3.direction();
    let m = cross(observation.direction, down);
    let dm = cross(observation.along_row, down);
    let [mx, _, _] = m;
    let [dmx, _, _] = dm;
    // A tenth of its value for a level camera: below it, one pixel of column weighs as ten do there.
    if !(mx.abs() > S::ratio(1, 10)) {
        return None;
    }
    let miss = line3.offset(m, observation) - line3.inverse_depth * observation.covariance;
    let per_px = line3.offset(dm, observation);
    let mut q = -(dot(m, observation.position) + observation.covariance) / mx;
    if round == Round::Later && per_px != S::ZERO {
        q = q + (dot(dm, observation.position) + q * dmx) / mx * (miss / per_px);
    }
    let w = line3.offset(cross(observation.direction, line3.lean), observation) / mx;
    Some(Equation {
        one: S::ONE,
        q,
        w,
        y: -miss / mx,
        root_weight: (per_px / mx).abs() * observation.sigma_px * observation.robust_scale,
    })
}

const MAX_REJECTIONS: usize = 4;
const REWEIGHTING_ROUNDS: usize = 16;
/// Beyond so many times the robust scale a sample may be an outlier, or is one.
const SUSPICIOUS: i32 = 3;
const OUTLIER: i32 = 4;
const MOST_ROUNDS: usize = 8;

struct Problem<'a, S, const N: usize> {
    setup: &'a Setup<S>,
    prior: &'a Prior<S>,
    observations: Vec<Observation<S>, N>,
    stretches: Vec<Stretch<S>, N>,
}

struct Solved<S, const N: usize> {
    line3: Line3<S>,
    solution: Solution<S>,
    equations: Equations<S, N>,
}

impl<S: Scalar, const N: usize> Solved<S, N> {
    /// Sum of the squares of all deviations, those from the priors included.
    fn cost(&self) -> S {
        let squares = self.equations.iter().map(|equation| self.solution.deviation(equation)).map(|off| off * off);
        squares.fold(S::ZERO, |sum, square| sum + square)
    }
}

impl<S: Scalar, const N: usize> Problem<'_, S, N> {
    fn round(&self, line3: &Line3<S>, round: Round) -> Result<Solved<S, N>, FitError> {
        let mut equations = Equations::new();
        for (index, observation) in self.observations.iter().enumerate() {
            let mut equation = observe(observation, line3, round).ok_or(FitError::Sideways(index))?;
            if !observation.is_inlier {
                equation.root_weight = S::ZERO;
            }
            // There is room: as many as observations.
            let _ = equations.observed.push(equation);
        }
        self.prior.observe(self.setup, line3, &mut equations);
        let solution = solve(&mut equations);
        Ok(Solved { line3: solution.apply(line3), solution, equations })
    }

    /// Iterates until a round changes next to nothing: mostly two. `None` where the rounds do not converge.
    fn converge(&self, line3: &Line3<S>) -> Option<Solved<S, N>> {
        let mut solved = self.round(line3, Round::Later).ok()?;
        for _ in 1..MOST_ROUNDS {
            if solved.solution.step() < S::ratio(1, 50) {
                return Some(solved);
            }
            solved = self.round(&solved.line3, Round::Later).ok()?;
        }
        None
    }

    /// The same. What does not converge is no straight edge; one round tells roughly where it is.
    fn settle(&self, line3: &Line3<S>) -> Result<Solved<S, N>, FitError> {
        self.converge(line3).map_or_else(|| self.round(line3, Round::Later), Ok)
    }

    /// In forward motion tilt and depth differ by a curve that is quadratic in the inverse depth, so that one as far behind
    /// the camera may fit as well: the one in front is meant, unless it fits worse by three sigma.
    fn settle_in_front(&self, start: &Line3<S>) -> Result<Solved<S, N>, FitError> {
        let solved = self.settle(start)?;
        let line3 = solved.line3;
        if line3.tilt == S::ZERO || !(line3.inverse_depth < S::ZERO) {
            return Ok(solved);
        }
        // An error in this trial says nothing of the solution at hand.
        let mirrored = Line3 { inverse_depth: -line3.inverse_depth, ..line3 };
        let least = solved.cost() + S::from_i32(9);
        if self.cost_in_front(&mirrored).is_some_and(|cost| cost < least) { self.settle(&mirrored) } else { Ok(solved) }
    }

    /// Cost of the solution from a line on, if that is in front of the camera and something is known of it. On its own, so
    /// that its equations leave the stack before others come.
    #[inline(never)]
    fn cost_in_front(&self, start: &Line3<S>) -> Option<S> {
        let solved = self.settle(start).ok()?;
        let [_, sigma_per_m, _] = solved.solution.covariance().sigma;
        (self.is_in_front(&solved.line3) && sigma_per_m < S::UNKNOWN).then(|| solved.cost())
    }

    /// Whether the camera has the line before it in all rows.
    fn is_in_front(&self, line3: &Line3<S>) -> bool {
        line3.inverse_depth > S::ZERO && self.observations.iter().all(|observation| line3.is_in_front_of(observation))
    }

    /// With blur and tilt there are several minima: the sign of the path during the exposure does not show in its blur. The
    /// best of those near the positions alone and near either path is meant.
    fn settle_best(&self, start: &Line3<S>) -> Result<Solved<S, N>, FitError> {
        let solved = self.settle_in_front(start)?;
        let near_either_path = self.prior.blur.as_ref().and_then(|blur| blur.candidates(start));
        let (mut least, mut best) = (solved.cost(), None);
        for (cost, line3) in near_either_path.into_iter().flatten().filter_map(|line3| self.minimum_near(&line3)) {
            if cost < least {
                (least, best) = (cost, Some(line3));
            }
        }
        best.map_or(Ok(solved), |line3| self.settle(&line3))
    }

    /// Cost and place of the solution near a line; on its own as well.
    #[inline(never)]
    fn minimum_near(&self, line3: &Line3<S>) -> Option<(S, Line3<S>)> {
        let solved = self.converge(line3)?;
        self.is_in_front(&solved.line3).then(|| (solved.cost(), solved.line3))
    }

    /// Least absolute deviations by iterative reweighting (IRLS), so that outliers do not pull the fit towards them. `None`
    /// where no sample deviates enough, or where the rounds fail.
    fn reweight(&mut self, solved: &Solved<S, N>) -> Option<Solved<S, N>> {
        let sizes = self.deviations(solved);
        let limit = robust_scale_of(&sizes) * S::from_i32(SUSPICIOUS);
        if !sizes.iter().any(|size| *size > limit) {
            return None;
        }
        let mut reweighted = None;
        for _ in 0..REWEIGHTING_ROUNDS {
            let last = reweighted.as_ref().unwrap_or(solved);
            for (observation, equation) in self.observations.iter_mut().zip(&last.equations.observed) {
                let deviation = last.solution.deviation(equation).abs() * observation.robust_scale;
                observation.robust_scale = deviation.max(S::ratio(1, 4)).min(S::from_i32(10_000)).sqrt();
            }
            let Ok(next) = self.round(&last.line3, Round::Later) else {
                self.observations.iter_mut().for_each(|observation| observation.robust_scale = S::ONE);
                return None;
            };
            reweighted = Some(next);
        }
        reweighted
    }

    /// Absolute deviations of the inliers, in units of their own noise.
    fn deviations(&self, solved: &Solved<S, N>) -> Vec<S, N> {
        let mut sizes = Vec::new();
        for (equation, observation) in
            solved.equations.observed.iter().zip(&self.observations).filter(|(_, observation)| observation.is_inlier)
        {
            // There is room: as many as observations.
            let _ = sizes.push(solved.solution.deviation(equation).abs() * observation.robust_scale);
        }
        sizes
    }

    /// Rejects the samples that deviate much more than the others, such as those of an object in between; at most a third
    /// of them: if more do not fit, this is no straight edge. Ends the reweighting.
    fn reject_outliers(&mut self, reweighted: &Solved<S, N>) -> bool {
        let sizes = self.deviations(reweighted);
        let count = sizes.len();
        // From few samples the robust scale is not well known.
        let limit = robust_scale_of(&sizes) * (S::from_i32(OUTLIER) + S::ratio(16, count.max(1) as i32));
        let outliers = sizes.iter().filter(|size| **size > limit).count();
        let leave_out = outliers > 0 && 3 * (self.observations.len() - count + outliers) <= self.observations.len();
        for (observation, equation) in self.observations.iter_mut().zip(&reweighted.equations.observed) {
            let is_outlier = reweighted.solution.deviation(equation).abs() * observation.robust_scale > limit;
            observation.is_inlier &= !(leave_out && is_outlier);
            observation.robust_scale = S::ONE;
        }
        leave_out
    }

    /// Gives the observations the sigmas that the residuals call for; the priors stay as they are. Whether any has changed.
    fn count_wander(&mut self, solved: &Solved<S, N>) -> bool {
        let mut residuals: Vec<_, N> = Vec::new();
        let equations = solved.equations.observed.iter();
        for ((equation, observation), stretch) in equations.zip(&self.observations).zip(&self.stretches) {
            if observation.is_inlier {
                let (deviation, sigma_px) = (solved.solution.deviation(equation), observation.sigma_px);
                // There is room: as many as observations.
                let _ = residuals.push(Residual { stretch: *stretch, sigma_px, deviation });
            }
        }
        let roughness_px = self.setup.uncertainty().edge_roughness_px;
        let wander = Wander::of(&residuals, roughness_px, self.prior.width_px);
        let Some(wander) = wander.filter(|wander| !wander.is_none()) else { return false };
        for (observation, stretch) in self.observations.iter_mut().zip(&self.stretches) {
            observation.sigma_px = wander.sigma_px(stretch);
        }
        true
    }

    fn goodness_of_fit(&self, solved: &Solved<S, N>) -> GoodnessOfFit<S> {
        // Knots are means over curved arcs: what that costs is no sign of a bend.
        let floor = S::ratio(1, 256);
        let kept =
            solved.equations.observed.iter().zip(&self.observations).filter(|(_, observation)| observation.is_inlier);
        GoodnessOfFit::of(kept.map(|(equation, observation)| {
            let residual_px = solved.solution.deviation(equation) * observation.sigma_px;
            (residual_px / hypot(observation.sigma_px, floor), residual_px)
        }))
    }
}

/// A robust scale of deviations: two thirds of them stay below it, as normal ones stay below one sigma. No sort is needed.
/// At least half a sigma: where all deviations are tiny, none is an outlier.
fn robust_scale_of<S: Scalar>(sizes: &[S]) -> S {
    let below = |limit: S| sizes.iter().filter(|size| **size < limit).count();
    let usual = sizes.iter().copied().filter(|size| 3 * below(*size) <= 2 * sizes.len()).reduce(S::max);
    usual.unwrap_or(S::ONE).max(S::ratio(1, 2))
}
