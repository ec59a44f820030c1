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
//! β, the lean of the edge in the image plane, is the third unknown, with a prior. Every round linearises about the
//! last estimate, so that the sums hold small residuals (single precision suffices) and the regressor q does not share
//! the noise of the observation (no bias in forward motion). The rounds are solved by orthogonalisation: inverting the
//! 3 × 3 normal matrix, whose condition is 10⁴ to 10⁵, would return nonsense in single precision.

use heapless::Vec;

use super::covariance::Covariance;
use super::estimate::Estimate;
use super::goodness_of_fit::GoodnessOfFit;
use super::line_state::LineState;
use super::observation::Observer;
use super::prior::{Knowledge, Nothing, Prior, SampleSet};
use super::problem::{Problem, Solved};
use super::sample::{Sample, Spread};
use super::sensitivity::Sensitivity;
use super::settled::Settled;
use super::status::RangeStatus;
use super::unknowns::Unknowns;
use super::wander::{Residual, Wander, is_white, rough_sigma_px};
use crate::error::FitError;
use crate::motion::Motion;
use crate::scalar::{Scalar, over};
use crate::setup::Setup;

/// Bearing, inverse depth and tilt of one edge with their covariance, from at most `N` samples.
///
/// The uncertainty of the setup is part of the covariance; of its limits, that of a bend is used, and its readout tells
/// by how many rows samples are apart.
///
/// *Errors*: see [`FitError`]. A motion that says nothing is no error: sigma is then [`Scalar::UNKNOWN`].
///
/// *Cost*: a pose and a ray per sample, then rounds of about 100 operations per sample: mostly two, more where the
/// tilt is free or outliers must be rejected. docs/budget.md has instructions and stack.
///
/// *Source*: `m · (P0 − p(t)) = 0`, docs/model.md, section 3; for a level camera in translation along x this is the
/// paper's equation (3).
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
    let prior = Prior::new(None, SampleSet::default());
    let mut estimate = Estimate::nothing();
    fit_with::<S, M, N, _>(setup, motion, || samples.into_iter(), &prior, &mut estimate, None)?;
    Ok(estimate)
}

/// The line that samples have told of.
pub(crate) struct Fitted<S, const N: usize> {
    pub(crate) unknowns: Unknowns<S>,
    /// Which of the samples are inliers.
    pub(crate) inliers: Vec<bool, N>,
}

/// [`fit`] with a prior; `estimate` and `kept` become what the samples have told, unless there is an error.
// Not inlined, as its parts: what each of them needs then leaves the stack before the next one comes. What is large is
// written where it is to be: each place that it passes through would need room for it. Where nobody keeps the state, it
// needs none while the rounds go on.
#[inline(never)]
pub(crate) fn fit_with<S: Scalar, M: Motion<S>, const N: usize, I: Iterator<Item = Sample<S>>>(
    setup: &Setup<S>,
    motion: &M,
    samples: impl FnOnce() -> I,
    prior: &Prior<'_, S>,
    estimate: &mut Estimate<S>,
    kept: Option<&mut LineState<S>>,
) -> Result<Fitted<S, N>, FitError> {
    let mut problem = Problem::<S, _, N>::new(setup, motion.gravity(), prior);
    problem.observe_all(motion, samples, setup.uncertainty().edge_roughness_px)?;
    problem.solve()?;
    problem.settle_without_outliers()?;
    let half_to_twin = problem.tell_from_twin()?;
    let goodness_of_fit = problem.goodness_of_fit();
    problem.settle_with_wander()?;
    problem.conclude(motion, half_to_twin, &goodness_of_fit, estimate, kept)
}

/// [`fit_with`] of samples that a straight edge explains with noise and roughness as stated. Where it does not, the
/// estimate is bent: neither outliers nor a wander are sought. Nothing is known of the edge.
#[inline(never)]
pub(crate) fn fit_strictly<S: Scalar, M: Motion<S>, const N: usize, I: Iterator<Item = Sample<S>>>(
    setup: &Setup<S>,
    motion: &M,
    samples: impl FnOnce() -> I,
    estimate: &mut Estimate<S>,
) -> Result<Fitted<S, N>, FitError> {
    let mut problem = Problem::<S, _, N>::new(setup, motion.gravity(), &Nothing);
    // How roughness is alike from sample to sample is not followed: of samples of four rows and more this is the most
    // that it can come to.
    let roughness_px = setup.uncertainty().edge_roughness_px;
    problem.observe_all(motion, samples, roughness_px + roughness_px)?;
    problem.first_round()?;
    let first = problem.last.found;
    problem.settle_in_front(&first)?;
    let half_to_twin = problem.tell_from_twin()?;
    let goodness_of_fit = problem.goodness_of_fit();
    let fitted = problem.conclude(motion, half_to_twin, &goodness_of_fit, estimate, None)?;
    estimate.bent |= !is_white(&problem.residuals());
    Ok(fitted)
}

impl<'a, S: Scalar, K: Knowledge<S>, const N: usize> Problem<'a, S, K, N> {
    #[inline(never)]
    fn observe_all<M: Motion<S>, I: Iterator<Item = Sample<S>>>(
        &mut self,
        motion: &M,
        samples: impl FnOnce() -> I,
        roughness_px: S,
    ) -> Result<(), FitError> {
        let Self { setup, prior, .. } = *self;
        let mut observer = self.observer(motion);
        for (index, sample) in samples().enumerate() {
            let Spread { column_px, row_px, time_s } = sample.spread;
            let numbers = [sample.column_px, sample.row_px, sample.time_s, sample.sigma_px, column_px, row_px, time_s];
            if !(numbers.into_iter().all(S::is_finite) && sample.sigma_px > S::ZERO) {
                return Err(FitError::InvalidSample(index));
            }
            let mut seen = observer.observe(&sample).ok_or(FitError::InvalidSample(index))?;
            if roughness_px > S::ZERO {
                seen.set_per_sigma(over(rough_sigma_px(&seen, roughness_px)));
            }
            seen.normals.is_inlier = !prior.leaves_out(index);
            self.observations.push(seen).map_err(|_| FitError::TooManySamples)?;
        }
        self.share_reach();
        let free_tilt = setup.uncertainty().allows_tilt();
        let least = if free_tilt && prior.state().is_none() { 3 } else { 2 };
        let inliers = self.observations.iter().filter(|observation| observation.normals.is_inlier).count();
        if inliers < least { Err(FitError::TooFewSamples(inliers)) } else { Ok(()) }
    }

    #[inline(never)]
    fn observer<'m, M: Motion<S>>(&self, motion: &'m M) -> Observer<'m, S, M>
    where
        'a: 'm,
    {
        let start = self.prior.axes(motion);
        Observer::new(self.setup.camera(), motion, [start.gravity, start.lean])
    }

    /// Positions in the unit of the farthest.
    fn share_reach(&mut self) {
        let reach = self.observations.iter().map(|seen| seen.normals.units.reach()).max().unwrap_or(0);
        let others = self.observations.iter_mut().filter(|seen| seen.normals.units.reach() != reach);
        others.for_each(|seen| seen.normals = seen.normals.with_reach(reach));
    }

    /// The problem is linear but for tilt, blur, sigmas and the noise in q, which the first round leaves out.
    #[inline(never)]
    fn solve(&mut self) -> Result<(), FitError> {
        if let Some((state, _)) = self.prior.state() {
            return self.settle_in_front(&state.line3.unknowns());
        }
        if self.first_without_far_samples()? {
            return self.settle_best();
        }
        // No straight edge: how it departs from one tells the sigmas that its place is sought with.
        let first = self.last.found;
        self.tell_roughly(&first)
    }

    /// With the sigmas that the residuals call for; the priors stay as they are.
    #[inline(never)]
    fn settle_with_wander(&mut self) -> Result<(), FitError> {
        if self.allow_for_wander() { self.settle_again() } else { Ok(()) }
    }

    /// Takes the samples with the sigmas that the residuals call for, unless these are white noise as stated.
    #[inline(never)]
    fn allow_for_wander(&mut self) -> bool {
        if self.prior.is_drawn() {
            return false;
        }
        let (width_px, row_spacing) = (self.prior.width_px(), self.prior.row_spacing());
        let wander = Wander::of::<N>(&self.residuals(), self.setup, width_px, row_spacing);
        if let Some(wander) = &wander {
            self.set_sigmas(wander);
        }
        wander.is_some()
    }

    #[inline(never)]
    fn set_sigmas(&mut self, wander: &Wander<S>) {
        for (observation, equation) in self.observations.iter_mut().zip(&mut self.equations.observed) {
            let per_sigma = over(wander.sigma_px(observation));
            *equation = equation.near_scaled((per_sigma / observation.per_sigma()).factor(0));
            observation.set_per_sigma(per_sigma);
        }
    }

    #[inline(never)]
    fn residuals(&self) -> Vec<Residual<'_, S>, N> {
        let mut residuals = Vec::new();
        for (equation, observation) in self.equations.observed.iter().zip(&self.observations) {
            if observation.normals.is_inlier {
                // There is room: as many as observations.
                let _ = residuals.push(Residual::new(observation, equation.deviation(self.equations.units)));
            }
        }
        residuals
    }

    /// What the settled fit says.
    #[inline(never)]
    fn conclude<M: Motion<S>>(
        &self,
        motion: &M,
        half_to_twin: Option<[S; 3]>,
        goodness_of_fit: &GoodnessOfFit<S>,
        estimate: &mut Estimate<S>,
        kept: Option<&mut LineState<S>>,
    ) -> Result<Fitted<S, N>, FitError> {
        let mut own = None;
        let state = kept.unwrap_or_else(|| own.insert(LineState::NOTHING));
        self.state(motion, half_to_twin, state);
        self.tell(state, goodness_of_fit, estimate)?;
        Ok(Fitted { unknowns: self.last.found, inliers: self.inliers() })
    }

    #[inline(never)]
    fn tell(
        &self,
        state: &LineState<S>,
        goodness_of_fit: &GoodnessOfFit<S>,
        estimate: &mut Estimate<S>,
    ) -> Result<(), FitError> {
        estimate.set(state, self.setup, goodness_of_fit);
        if !estimate.is_finite() {
            return Err(FitError::Diverged);
        }
        // The equations do not know that a camera passes no edge within a frame.
        let passes = estimate.status() == RangeStatus::Ok && !self.last.is_in_front;
        estimate.bent |= passes;
        Ok(())
    }

    /// With the errors that all samples share.
    #[inline(never)]
    fn state<M: Motion<S>>(&self, motion: &M, half_to_twin: Option<[S; 3]>, state: &mut LineState<S>) {
        self.sensitivity(motion, &mut state.sensitivity);
        state.line3 = self.prior.axes(motion).with(self.last.found);
        state.covariance = self.covariance();
        if let Some(change) = half_to_twin {
            state.covariance = state.covariance.and(change);
        }
    }

    #[inline(never)]
    fn sensitivity<M: Motion<S>>(&self, motion: &M, sensitivity: &mut Sensitivity<S>) {
        let Solved { at, solution, .. } = &self.last;
        let Self { setup, prior, observations, equations, .. } = self;
        let direction = self.direction(motion);
        Settled { setup, motion, prior: *prior, observations, equations, at, direction, solution }
            .sensitivity(sensitivity);
    }

    /// Of the line that the equations were linearised about.
    #[inline(never)]
    fn direction<M: Motion<S>>(&self, motion: &M) -> [S; 3] {
        self.prior.axes(motion).with(self.last.at).direction()
    }

    #[inline(never)]
    fn covariance(&self) -> Covariance<S> {
        let Solved { solution, has_settled, .. } = &self.last;
        // Between several places the rounds tell nothing of the depth.
        let unsettled = [S::ZERO, if *has_settled { S::ZERO } else { S::UNKNOWN }, S::ZERO];
        solution.covariance().and(unsettled)
    }

    #[inline(never)]
    fn inliers(&self) -> Vec<bool, N> {
        let mut inliers = Vec::new();
        for observation in &self.observations {
            // There is room: as many as observations. `collect` could panic.
            let _ = inliers.push(observation.normals.is_inlier);
        }
        inliers
    }

    #[inline(never)]
    fn goodness_of_fit(&self) -> GoodnessOfFit<S> {
        let kept = self.equations.observed.iter().zip(&self.observations);
        let kept = kept.filter(|(_, observation)| observation.normals.is_inlier);
        GoodnessOfFit::of(
            kept.map(|(equation, observation)| (equation.deviation(self.equations.units), observation.per_sigma())),
        )
    }
}
