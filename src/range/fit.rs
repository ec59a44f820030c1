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
//! 3 × 3 normal matrix, whose condition is 10⁴ to 10⁶, would return nonsense in single precision.

use heapless::Vec;

use super::covariance::Covariance;
use super::estimate::Estimate;
use super::goodness_of_fit::GoodnessOfFit;
use super::line_state::LineState;
use super::line3::Line3;
use super::observation::Observer;
use super::prior::{Prior, SampleSet};
use super::problem::{Problem, Solved};
use super::sample::{Sample, Spread};
use super::settled::Settled;
use super::status::RangeStatus;
use super::unknowns::Unknowns;
use super::wander::{Residual, Wander, rough_sigma_px};
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
/// *Cost*: a pose and a ray per sample, then rounds of about 100 operations per sample: mostly three, more where the
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
    let prior = Prior::new(None, None, S::ONE, SampleSet::default());
    let mut state = LineState::NOTHING;
    fit_with::<S, M, N, _>(setup, motion, || samples.into_iter(), &prior, &mut state)?.estimate(&state, setup)
}

/// How well the samples fit the line that they have told of.
pub(crate) struct Fitted<S, const N: usize> {
    goodness_of_fit: GoodnessOfFit<S>,
    /// Whether the camera has the line before it in all rows.
    is_in_front: bool,
    /// Which of the samples are inliers.
    pub(crate) inliers: Vec<bool, N>,
}

impl<S: Scalar, const N: usize> Fitted<S, N> {
    pub(crate) fn estimate(&self, state: &LineState<S>, setup: &Setup<S>) -> Result<Estimate<S>, FitError> {
        let estimate = Estimate::new(state, setup, &self.goodness_of_fit);
        if !estimate.is_finite() {
            return Err(FitError::Diverged);
        }
        // The equations do not know that a camera passes no edge within a frame.
        let passes = estimate.status() == RangeStatus::Ok && !self.is_in_front;
        Ok(Estimate { bent: estimate.bent || passes, ..estimate })
    }
}

/// [`fit`] with a prior; `state` is what the samples have told, unless there is an error.
// Not inlined, as its parts: what each of them needs then leaves the stack before the next one comes. The largest part
// of the outcome is written where it is to be: each place that it passes through would need room for it.
#[inline(never)]
pub(crate) fn fit_with<S: Scalar, M: Motion<S>, const N: usize, I: Iterator<Item = Sample<S>>>(
    setup: &Setup<S>,
    motion: &M,
    samples: impl FnOnce() -> I,
    prior: &Prior<'_, S>,
    state: &mut LineState<S>,
) -> Result<Fitted<S, N>, FitError> {
    let start = prior.state.map_or_else(|| Line3::start(motion.gravity()), |(state, _)| state.line3);
    let mut problem = Problem::<S, N>::new(setup, prior);
    problem.observe_all(motion, &start, samples)?;
    let free_tilt = setup.uncertainty().sigma_tilt_at(S::ZERO) > S::ZERO;
    let least = if free_tilt && prior.state.is_none() { 3 } else { 2 };
    let inliers = problem.observations.iter().filter(|observation| observation.is_inlier).count();
    if inliers < least {
        return Err(FitError::TooFewSamples(inliers));
    }
    problem.solve(&start.unknowns())?;
    problem.settle_without_outliers()?;
    let half_to_twin = problem.tell_from_twin()?;
    let goodness_of_fit = problem.goodness_of_fit();
    problem.settle_with_wander()?;
    problem.conclude(motion, &start, state);
    if let Some(change) = half_to_twin {
        state.covariance = state.covariance.and(change);
    }
    Ok(Fitted { goodness_of_fit, is_in_front: problem.last.is_in_front, inliers: problem.inliers() })
}

impl<S: Scalar, const N: usize> Problem<'_, S, N> {
    #[inline(never)]
    fn observe_all<M: Motion<S>, I: Iterator<Item = Sample<S>>>(
        &mut self,
        motion: &M,
        start: &Line3<S>,
        samples: impl FnOnce() -> I,
    ) -> Result<(), FitError> {
        let Self { setup, prior, .. } = *self;
        let mut observer = Observer::new(setup.camera(), motion, [start.gravity, start.lean]);
        let roughness_px = setup.uncertainty().edge_roughness_px;
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
            seen.is_inlier = !prior.left_out.contains(index);
            self.observations.push(seen).map_err(|_| FitError::TooManySamples)?;
        }
        self.share_reach();
        Ok(())
    }

    /// Positions in the unit of the farthest.
    fn share_reach(&mut self) {
        let reach = self.observations.iter().map(|seen| seen.normals.units.reach()).max().unwrap_or(0);
        let others = self.observations.iter_mut().filter(|seen| seen.normals.units.reach() != reach);
        others.for_each(|seen| seen.normals = seen.normals.with_reach(reach));
    }

    /// The problem is linear but for tilt, blur, sigmas and the noise in q, which the first round leaves out.
    #[inline(never)]
    fn solve(&mut self, start: &Unknowns<S>) -> Result<(), FitError> {
        if self.prior.state.is_some() {
            return self.settle_in_front(start);
        }
        if self.first_without_far_samples()? {
            return self.settle_best();
        }
        let first = self.last.found;
        self.settle(&first)
    }

    /// With the sigmas that the residuals call for; the priors stay as they are.
    #[inline(never)]
    fn settle_with_wander(&mut self) -> Result<(), FitError> {
        let Some(wander) = self.wander() else { return Ok(()) };
        for (observation, equation) in self.observations.iter_mut().zip(&mut self.equations.observed) {
            let per_sigma = over(wander.sigma_px(observation));
            *equation = equation.near_scaled((per_sigma / observation.per_sigma()).factor(0));
            observation.set_per_sigma(per_sigma);
        }
        self.settle_again()
    }

    /// What the residuals show, unless that is white noise as stated.
    #[inline(never)]
    fn wander(&self) -> Option<Wander<S>> {
        if self.prior.is_drawn {
            return None;
        }
        let mut residuals: Vec<_, N> = Vec::new();
        let near = self.last.solution.near(self.equations.units);
        for (equation, observation) in self.equations.observed.iter().zip(&self.observations) {
            if observation.is_inlier {
                // There is room: as many as observations.
                let _ = residuals.push(Residual::new(observation, near.deviation(equation)));
            }
        }
        Wander::of::<N>(&residuals, self.setup, self.prior.width_px)
    }

    /// What the settled fit says, with the errors that all samples share.
    #[inline(never)]
    fn conclude<M: Motion<S>>(&self, motion: &M, axes: &Line3<S>, state: &mut LineState<S>) {
        let Solved { at, found, solution, .. } = &self.last;
        let Self { setup, prior, observations, equations, .. } = self;
        let direction = axes.with(*at).direction();
        let settled = Settled { setup, motion, prior, observations, equations, at, direction, solution };
        settled.sensitivity(&mut state.sensitivity);
        state.line3 = axes.with(*found);
        state.covariance = self.covariance();
    }

    #[inline(never)]
    fn covariance(&self) -> Covariance<S> {
        let Solved { solution, has_settled, .. } = &self.last;
        // Between several places the rounds tell nothing of the depth.
        let unsettled = [S::ZERO, if *has_settled { S::ZERO } else { S::UNKNOWN }, S::ZERO];
        solution.covariance().and(unsettled)
    }

    fn inliers(&self) -> Vec<bool, N> {
        let mut inliers = Vec::new();
        for observation in &self.observations {
            // There is room: as many as observations. `collect` could panic.
            let _ = inliers.push(observation.is_inlier);
        }
        inliers
    }

    #[inline(never)]
    fn goodness_of_fit(&self) -> GoodnessOfFit<S> {
        let near = self.last.solution.near(self.equations.units);
        let kept = self.equations.observed.iter().zip(&self.observations);
        let kept = kept.filter(|(_, observation)| observation.is_inlier);
        GoodnessOfFit::of(kept.map(|(equation, observation)| (near.deviation(equation), observation.per_sigma())))
    }
}
