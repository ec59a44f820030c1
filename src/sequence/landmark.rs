//! [`Landmark`]: an edge that earlier frames have shown, and where the next one should have it.

use super::propagation::FrameTransition;
use crate::edge::Polarity;
use crate::line::Line;
use crate::motion::Motion;
use crate::range::{Covariance, LineState, Observation, Range, RangeStatus, Sample};
use crate::scalar::{Scalar, cross, dot, hypot};
use crate::setup::Setup;

#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Landmark<S> {
    pub(crate) id: u32,
    pub(crate) polarity: Polarity,
    /// Frames that the estimate rests on.
    pub(crate) frames: u32,
    /// Frames in a row that have not shown it.
    pub(crate) missed: u16,
    /// Frames that must still agree before it passes for static again: it has been where a static edge could not be.
    pub(crate) hold_off: u16,
    /// The line of this frame that lies best so far.
    pub(crate) claim: Option<Claim<S>>,
    pub(crate) state: LineState<S>,
}

/// A line, by its place in the table that it comes from, and how far it lies from the prediction, in pixels.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Claim<S> {
    pub(crate) place: usize,
    pub(crate) distance: S,
    /// It lies where a static edge cannot be.
    pub(crate) has_moved: bool,
}

/// What a line of this frame shows at its ends and in its middle.
pub(crate) struct LineObservation<S> {
    pub(crate) polarity: Polarity,
    ends: [Observation<S>; 2],
    middle: Observation<S>,
}

/// Beyond four sigma of the prediction: rows have noise, and edges of one object bend a little.
const GATE_PX: i32 = 3;
/// What a line's column may be off by itself, in 1/10 px.
const COLUMN_DECIPIXELS: i32 = 1;
/// Sigmas beyond which a line is not where a static edge would be.
const MOST_SIGMAS: i32 = 5;
/// Frames in a row that must agree with a static edge before one that has moved passes for static again.
const HOLD_OFF_FRAMES: u16 = 30;
/// Within this distance two edges draw each other aside.
const BESIDE_PX: i32 = 8;

impl<S: Scalar> LineObservation<S> {
    /// `None` for a line that the lens or the number of edges makes useless.
    pub(crate) fn new<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
    ) -> Option<Self> {
        let observation = |sample: Sample<S>| Observation::new(setup.camera(), motion, &sample);
        let samples = || line.samples::<S>();
        Some(Self {
            polarity: line.first().polarity,
            ends: [observation(samples().next()?)?, observation(samples().last()?)?],
            middle: observation(samples().nth(samples().count() / 2)?)?,
        })
    }
}

impl<S: Scalar> Landmark<S> {
    /// A line's claim to be this edge; `None` where it cannot be.
    pub(crate) fn claim_of(
        &self,
        setup: &Setup<S>,
        place: usize,
        observation: &LineObservation<S>,
    ) -> Option<Claim<S>> {
        if self.polarity != observation.polarity {
            return None;
        }
        let state = &self.state;
        let total = state.sensitivity.total(state.covariance, setup, state.line3.bearing);
        let distance_of = |observation: &Observation<S>| {
            let (miss, sigma) = self.miss(&total, observation)?;
            let gate = S::from_i32(GATE_PX) + sigma * S::from_i32(4);
            // Of two that fit, the one that was surer of it.
            (miss.abs() <= gate).then(|| hypot(sigma, miss))
        };
        let [first, last] = &observation.ends;
        let distance = hypot(distance_of(first)?, distance_of(last)?);
        let (miss, sigma) = self.miss(&total, &observation.middle)?;
        let most = hypot(sigma, S::ratio(COLUMN_DECIPIXELS, 10)) * S::from_i32(MOST_SIGMAS);
        Some(Claim { place, distance, has_moved: miss.abs() > most })
    }

    /// What a line that is this edge tells, with what earlier frames have told; from then on that is known, too.
    ///
    /// Where the history bends a line that is straight by itself, the edge has moved: it is then begun anew.
    pub(crate) fn update<M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
    ) -> Range<S> {
        let alone = || Range::continued(setup, motion, line, None);
        let mut has_moved = self.claim.is_some_and(|claim| claim.has_moved);
        let (mut range, mut state) =
            if has_moved { alone() } else { Range::continued(setup, motion, line, Some(self.state)) };
        if matches!(range.status, RangeStatus::Bent | RangeStatus::Cluttered) && !has_moved {
            let (of_alone, state_alone) = alone();
            if is_informative(of_alone.status) {
                (has_moved, range, state) = (true, of_alone, state_alone);
            }
        }
        match state.filter(|_| is_informative(range.status)) {
            Some(state) => {
                self.state = state;
                self.frames = if has_moved { 1 } else { self.frames.saturating_add(1) };
                self.hold_off = if has_moved { HOLD_OFF_FRAMES } else { self.hold_off.saturating_sub(1) };
            }
            // Hidden, as far as the estimate is concerned.
            None => self.claim = None,
        }
        range
    }

    /// A range of this edge under its name; no distance until it passes for static again.
    pub(crate) fn name(&self, range: Range<S>) -> Range<S> {
        range.named(self.id, self.frames, self.hold_off > 0)
    }

    /// Whether a line lies so near to where this edge should be that the two draw each other aside.
    pub(crate) fn is_beside(&self, observation: &LineObservation<S>) -> bool {
        let near = S::from_i32(BESIDE_PX);
        let mut observations = observation.ends.iter().chain([&observation.middle]);
        observations.any(|observation| self.state.line3.residual_px(observation).is_some_and(|miss| miss.abs() < near))
    }

    /// How far along the row a sight lies from the prediction, and one sigma of that, in pixels.
    fn miss(&self, total: &Covariance<S>, observation: &Observation<S>) -> Option<(S, S)> {
        let line3 = &self.state.line3;
        let miss = line3.residual_px(observation)?;
        let m = cross(observation.direction, line3.direction());
        let per_px = line3.offset(cross(observation.along_row, line3.direction()), observation);
        let [mx, _, _] = m;
        let across = line3.offset(cross(observation.direction, line3.lean), observation);
        let sensitivity = [mx, -dot(m, observation.position), across].map(|part| part / per_px);
        let none = [S::ZERO; 3];
        let [sigma, _, _] = total.through([sensitivity, none, none]).sigma;
        let sigma = hypot(sigma, observation.sigma_px);
        (miss.is_finite() && sigma.is_finite()).then_some((miss, sigma))
    }

    /// The same in the next frame; `None` where it is out of sight for good.
    pub(crate) fn propagated(self, setup: &Setup<S>, transition: &FrameTransition<S>) -> Option<Self> {
        Some(Self { state: self.state.propagated(setup, transition)?, claim: None, ..self })
    }
}

/// Whether a line with this status tells where the edge is.
pub(crate) fn is_informative(status: RangeStatus) -> bool {
    matches!(status, RangeStatus::Ok | RangeStatus::Far | RangeStatus::Slow)
}
