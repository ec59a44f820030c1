//! [`Landmark`]: an edge of earlier frames, and where this frame should show it.

use super::extent::Extent;
use super::propagation::FrameTransition;
use crate::edge::Polarity;
use crate::line::Line;
use crate::motion::Motion;
use crate::range::{Covariance, Line3, LineState, Observation, Observer, Range, RangeStatus, RowPlane};
use crate::scalar::{Scalar, hypot};
use crate::setup::Setup;

#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Landmark<S> {
    pub(crate) id: u32,
    pub(crate) polarity: Polarity,
    /// Frames that the estimate rests on.
    pub(crate) frames: u32,
    /// Frames in a row that have not updated it.
    pub(crate) missed: u16,
    /// Frames that must still agree before it counts as static again, after it was where a static edge cannot be.
    pub(crate) hold_off: u16,
    /// No single frame has shown it well enough to be told.
    pub(crate) is_weak: bool,
    /// The best line of this frame so far.
    pub(crate) matched: Option<Match<S>>,
    pub(crate) state: LineState<S>,
    /// Which part of the line the edge was last seen on.
    pub(crate) extent: Extent<S>,
}

/// A line of this frame, by its place in the table that it comes from, and its distance from the prediction in pixels.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Match<S> {
    pub(crate) place: u32,
    pub(crate) distance: S,
    /// It lies where a static edge cannot be.
    pub(crate) has_moved: bool,
}

/// A line of this frame at its ends and in its middle.
pub(crate) struct LineObservation<S> {
    pub(crate) polarity: Polarity,
    /// The rows of its ends.
    pub(crate) rows: [RowPlane<S>; 2],
    ends: [Observation<S>; 2],
    middle: Observation<S>,
}

/// Width of the gate beyond four sigma of the prediction, in pixels: rows have noise, and real edges bend a little.
const GATE_PX: i32 = 3;
/// Error of a line's own column, in tenths of a pixel.
const COLUMN_DECIPIXELS: i32 = 1;
/// A line more sigmas off than this is not where a static edge can be.
const STATIC_SIGMAS: i32 = 5;
/// Frames in a row that must agree with a static edge before one that has moved counts as static again.
const HOLD_OFF_FRAMES: u16 = 30;
/// Two edges nearer than this shift each other's columns.
const NEAR_PX: i32 = 8;
/// Frames that must agree on an edge that no single one shows well.
const TELLING_FRAMES: u32 = 3;

impl<S: Scalar> LineObservation<S> {
    /// Against lines with the directions of `axes`. `None` for a line without samples, or outside the lens model.
    pub(crate) fn new<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        axes: &Line3<S>,
        line: &Line<KNOTS>,
    ) -> Option<Self> {
        let mut observer = Observer::new(setup.camera(), motion, [axes.gravity, axes.lean]);
        let [first, middle, last] = line.first_middle_and_last()?.map(|sample| observer.observe(&sample));
        let (ends, middle) = ([first?, last?], middle?);
        let rows = ends.each_ref().map(|end| RowPlane::new(motion, end));
        Some(Self { polarity: line.first().polarity, rows, ends, middle })
    }
}

impl<S: Scalar> Landmark<S> {
    /// How well a line matches this edge; `None` where it cannot be the same.
    pub(crate) fn match_with(
        &self,
        setup: &Setup<S>,
        place: u32,
        observation: &LineObservation<S>,
    ) -> Option<Match<S>> {
        if self.polarity != observation.polarity {
            return None;
        }
        let state = &self.state;
        let total = state.sensitivity.total(state.covariance, setup, state.line3.bearing);
        let distance_of = |observation: &Observation<S>| {
            let (innovation, sigma) = self.innovation(&total, observation)?;
            let gate = S::from_i32(GATE_PX) + sigma * S::from_i32(4);
            // Between two that fit, the smaller sigma wins.
            (innovation.abs() <= gate).then(|| hypot(sigma, innovation))
        };
        if !self.extent.is_same_part(&self.extent_of(observation)?) {
            return None;
        }
        let [first, last] = &observation.ends;
        let distance = hypot(distance_of(first)?, distance_of(last)?);
        let (innovation, sigma) = self.innovation(&total, &observation.middle)?;
        let most = hypot(sigma, S::ratio(COLUMN_DECIPIXELS, 10)) * S::from_i32(STATIC_SIGMAS);
        Some(Match { place, distance, has_moved: innovation.abs() > most })
    }

    /// Ranges a line that is this edge, with what earlier frames have told, and updates the state.
    ///
    /// A line that is where a static edge cannot be has moved: it starts anew.
    pub(crate) fn update<M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
    ) -> Range<S> {
        let has_moved = self.matched.is_some_and(|matched| matched.has_moved);
        let earlier = (!has_moved).then_some(self.state);
        let (range, state) = Range::continued(setup, motion, line, earlier);
        match state.filter(|_| is_informative(range.status)) {
            Some(state) => {
                self.state = state;
                let observation = LineObservation::new(setup, motion, &state.line3, line);
                self.extent = observation.and_then(|seen| self.extent_of(&seen)).unwrap_or(self.extent);
                self.frames = if has_moved { 1 } else { self.frames.saturating_add(1) };
                self.hold_off = if has_moved { HOLD_OFF_FRAMES } else { self.hold_off.saturating_sub(1) };
            }
            // The line says nothing: as if it were hidden.
            None => self.matched = None,
        }
        range
    }

    /// A range of this edge under its name; no distance until it counts as static again.
    pub(crate) fn name(&self, range: Range<S>) -> Range<S> {
        range.named(self.id, self.frames, self.hold_off > 0, self.is_weak && self.frames < TELLING_FRAMES)
    }

    /// Whether a line lies so near to the predicted edge that the two shift each other.
    pub(crate) fn is_near(&self, observation: &LineObservation<S>) -> bool {
        if !self.extent_of(observation).is_some_and(|extent| self.extent.overlaps(&extent)) {
            return false;
        }
        let near = S::from_i32(NEAR_PX);
        let mut observations = observation.ends.iter().chain([&observation.middle]);
        observations.any(|observation| {
            self.state.line3.residual(observation).px().is_some_and(|innovation| innovation.abs() < near)
        })
    }

    /// Which part of this edge a line of this frame covers.
    pub(crate) fn extent_of(&self, observation: &LineObservation<S>) -> Option<Extent<S>> {
        Extent::between(&self.state.line3, &observation.rows)
    }

    /// How far along the row an observation lies from the prediction, and one sigma of that, in pixels.
    fn innovation(&self, total: &Covariance<S>, observation: &Observation<S>) -> Option<(S, S)> {
        let residual = self.state.line3.residual(observation);
        let innovation = residual.px()?;
        let per_px = S::ONE / residual.per_px;
        let sensitivity = [residual.per_bearing, residual.per_inverse_depth, residual.per_tilt];
        let variance = total.variance_along(sensitivity.map(|part| part * per_px));
        let sigma = (variance.max(S::ZERO) + observation.sigma_px * observation.sigma_px).sqrt();
        (innovation.is_finite() && sigma.is_finite()).then_some((innovation, sigma))
    }

    /// The same at the start of the next frame; `None` where the edge is beside or behind the camera then.
    pub(crate) fn propagated(self, setup: &Setup<S>, transition: &FrameTransition<S>) -> Option<Self> {
        let extent = self.extent.propagated(&self.state.line3, transition)?;
        Some(Self { state: self.state.propagated(setup, transition)?, matched: None, extent, ..self })
    }
}

/// Whether a line with this status says where the edge is.
pub(crate) fn is_informative(status: RangeStatus) -> bool {
    matches!(status, RangeStatus::Ok | RangeStatus::Far | RangeStatus::Slow)
}

/// Whether a line with this status may become a landmark: what a single frame cannot tell from chance, several can.
pub(crate) fn may_begin(status: RangeStatus) -> bool {
    is_informative(status) || matches!(status, RangeStatus::Cluttered | RangeStatus::Short)
}
