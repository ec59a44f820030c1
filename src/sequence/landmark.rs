//! [`Landmark`]: an edge of earlier frames, and where this frame should show it.

use super::extent::Extent;
use super::gate::{Comparison, sigma_px};
use super::line_observation::LineObservation;
use super::propagation::FrameTransition;
use super::tuning::{
    COLUMN_DECIPIXELS, CONTRAST_PERCENT, DOUBTFUL_SIGMAS, GATE_SIGMAS, HOLD_OFF_FRAMES, MOST_CONTRAST_SIGMAS,
    STATIC_SIGMAS, STRIP_PX, TELLING_FRAMES, WANDER_PARTS_PX,
};
use super::vertical::EdgePlane;
use crate::edge::Polarity;
use crate::line::Line;
use crate::motion::Motion;
use crate::range::{
    Covariance, Line3, LineState, Observation, Observer, Range, RangeStatus, RowPlane, Sample, SampleSet,
};
use crate::scalar::{NS_PER_S, Scalar, add, cross, dot, hypot, scale, sub};
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
    /// Of its last line, in grey levels; zero where it is not known.
    pub(crate) contrast: u8,
    pub(crate) evidence: Evidence,
    /// How many lines of this frame run beside it as it would.
    pub(crate) parallel_lines: u8,
    /// How often lines that have nothing to do with each other agree as well as those of its frames, for each line that
    /// begins.
    pub(crate) chance: S,
    /// Middle of the columns where this frame should show it, and how far from there a line of it may begin or end.
    pub(crate) column_px: S,
    pub(crate) reach_px: S,
    /// The best line of this frame so far.
    pub(crate) matched: Option<Match<S>>,
    pub(crate) state: LineState<S>,
    /// Which part of the line the edge was last seen on.
    pub(crate) extent: Extent<S>,
}

/// What speaks for an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) enum Evidence {
    /// One frame has shown it well, or several agree.
    Enough,
    /// One frame has shown it well, but where the edges of the scene were known: three must agree.
    Newcomer,
    /// No frame has shown it well: three must agree, and better than by chance. It is not told.
    Weak,
}

/// A line of this frame, by its place in the table that it comes from.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Match<S> {
    pub(crate) place: u32,
    /// See [`Comparison::cost`].
    pub(crate) cost: S,
    /// Half the width of the band around the prediction in which the line was to be expected, or was found, in pixels.
    pub(crate) band_px: S,
    /// It lies where a static edge cannot be.
    pub(crate) has_moved: bool,
    /// It lies where a static edge seldom is.
    pub(crate) is_doubtful: bool,
}

/// What the first frame tells in a second one that may have been taken at another time than told; nothing where an edge
/// cannot be so much later.
pub(super) struct UnsureTime<S> {
    pub(super) earlier: Option<LineState<S>>,
}

impl<S: Scalar> Landmark<S> {
    /// An edge that one frame has shown.
    pub(crate) fn new(
        id: u32,
        observation: &LineObservation<S>,
        evidence: Evidence,
        state: LineState<S>,
        extent: Extent<S>,
    ) -> Self {
        Self {
            id,
            polarity: observation.polarity,
            contrast: observation.contrast,
            frames: 1,
            missed: 0,
            hold_off: 0,
            evidence,
            parallel_lines: 0,
            chance: S::ONE,
            column_px: S::ZERO,
            reach_px: S::ZERO,
            // No line that is still to be taken has this place.
            matched: Some(Match {
                place: u32::MAX,
                cost: S::ZERO,
                band_px: S::ZERO,
                has_moved: false,
                is_doubtful: false,
            }),
            state,
            extent,
        }
    }

    /// Whether the line at a place of this frame is the best for this edge.
    pub(super) fn is_matched_by(&self, place: usize) -> bool {
        self.matched.is_some_and(|matched| u32::try_from(place).is_ok_and(|place| matched.place == place))
    }

    /// How well a line matches this edge; `None` where it cannot be the same.
    pub(crate) fn match_with(
        &mut self,
        setup: &Setup<S>,
        place: u32,
        observation: &LineObservation<S>,
        is_first_offer: bool,
    ) -> Option<Match<S>> {
        if !self.may_show(observation) {
            return None;
        }
        let comparison = Comparison::of(&self.state.line3, &self.total(setup), observation)?;
        let distance = comparison.middle_px.abs();
        if is_first_offer && comparison.is_parallel && distance < S::from_i32(STRIP_PX) {
            self.parallel_lines = self.parallel_lines.saturating_add(1);
        }
        let gate = S::from_i32(GATE_SIGMAS * GATE_SIGMAS);
        let sigma = static_sigma(comparison.sigma_middle_px);
        let has_moved = distance > sigma * S::from_i32(STATIC_SIGMAS);
        // Nothing but what is stated: it would not be in the sigma of what goes on.
        let stated = hypot(comparison.sigma_middle_px, observation.middle.sigma_px());
        let is_doubtful = distance > stated * S::from_i32(DOUBTFUL_SIGMAS);
        // Where no edge is known yet, none can have moved.
        let contrast = contrast_square(self.contrast, observation.contrast);
        let fits = comparison.square + contrast <= gate && !(self.is_tentative() && has_moved);
        fits.then_some(Match {
            place,
            cost: comparison.cost + contrast,
            band_px: distance.max(sigma),
            has_moved,
            is_doubtful,
        })
    }

    /// Whether a line can be one of this edge, wherever in the row it lies.
    pub(super) fn may_show(&self, line: &LineObservation<S>) -> bool {
        self.polarity == line.polarity && self.extent_of(line).is_some_and(|extent| self.extent.is_same_part(&extent))
    }

    /// Prepares for the lines of a frame: where it should show the edge.
    pub(crate) fn predict<M: Motion<S>>(&mut self, setup: &Setup<S>, motion: &M) {
        self.matched = None;
        self.parallel_lines = 0;
        let total = self.total(setup);
        let line3 = &self.state.line3;
        let ends = self.extent.ends().map(|place| predicted(setup, motion, line3, place));
        let wide = |end: &Sample<S>| {
            let observation = Observer::new(setup.camera(), motion, [line3.gravity, line3.lean]).observe(end)?;
            sigma_px(line3, &total, &observation)
        };
        let [first, last] = &ends;
        let half = S::ratio(1, 2);
        let wander = ends.iter().filter_map(wide).fold(S::ONE, S::max) * S::from_i32(GATE_SIGMAS);
        self.column_px = (first.column_px + last.column_px) * half;
        self.reach_px = (first.column_px - last.column_px).abs() * half + wander.max(S::from_i32(STRIP_PX));
    }

    pub(super) fn total(&self, setup: &Setup<S>) -> Covariance<S> {
        self.state.sensitivity.total(self.state.covariance, setup, &self.state.line3)
    }

    /// Ranges a line that is this edge, with what earlier frames have told, and updates the state.
    ///
    /// A line that is where a static edge cannot be has moved: it starts anew. In two frames time and depth are the
    /// same, so that what the second one tells is as unsure as the time, unless other edges have shown that it is
    /// right: its range is then to be told anew. `unsure_interval_s` is the time since the frame before, if none have.
    /// So is the time of each frame that has missed it.
    #[inline(never)]
    pub(super) fn update<M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
        left_out: SampleSet,
        unsure_interval_s: Option<S>,
    ) -> (Range<S>, Option<UnsureTime<S>>) {
        let Some(matched) = self.matched else { return (Range::from_line(setup, motion, line), None) };
        // Two frames whose time was unsure are known by a third one to belong together; that they do not is no motion.
        let is_unsure = self.frames <= 2 && unsure_interval_s.is_some();
        let has_moved = matched.has_moved && !is_unsure;
        let is_refuted = is_unsure && (matched.has_moved || self.frames == 2 && matched.is_doubtful);
        let begins_anew = has_moved || is_refuted;
        let earlier = (!begins_anew).then_some(&self.state);
        let mut state = None;
        let range = Range::continued(setup, motion, line, earlier, left_out, &mut state);
        match &state {
            Some(state) if is_informative(range.status) => {
                let is_second = self.frames == 1 && !begins_anew;
                let told = unsure_interval_s.filter(|_| is_second).map(|interval_s| {
                    let since_first_s = interval_s * S::from_i32(i32::from(self.missed) + 1);
                    UnsureTime { earlier: self.state.with_unsure_time(motion, &state.line3, since_first_s) }
                });
                self.state = *state;
                self.contrast = line.contrast();
                self.extent = self.seen_extent(setup, motion, line).unwrap_or(self.extent);
                self.frames = if begins_anew { 1 } else { self.frames.saturating_add(1) };
                self.hold_off = if has_moved { HOLD_OFF_FRAMES } else { self.hold_off.saturating_sub(1) };
                let expected = S::from_i32(self.parallel_lines.max(1).into()) * matched.band_px / S::from_i32(STRIP_PX);
                self.chance = self.chance * expected.min(S::ONE);
                (range, told)
            }
            _ => {
                // The line says nothing: as if it were hidden.
                self.matched = None;
                (range, None)
            }
        }
    }

    /// Which part of the line the edge is seen on.
    #[inline(never)]
    fn seen_extent<M: Motion<S>, const KNOTS: usize>(
        &self,
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
    ) -> Option<Extent<S>> {
        self.extent_of(&LineObservation::new(setup, motion, &self.state.line3, line)?)
    }

    /// A range of this edge under its name; no distance until it counts as static again, nor until the frames agree
    /// better than by chance.
    ///
    /// `is_unsure`: the range is what two frames have told, of which nothing shows that their time was right.
    pub(crate) fn name(&mut self, range: Range<S>, most_chance: S, is_unsure: bool) -> Range<S> {
        if self.frames >= TELLING_FRAMES && (self.evidence == Evidence::Newcomer || self.chance <= most_chance) {
            self.evidence = Evidence::Enough;
        }
        range.named(self.id, self.frames, self.hold_off > 0, self.is_tentative() || is_unsure)
    }

    /// Whether it may be no edge, or a frame may have shown another one instead, more often than not where most edges of
    /// a scene are known: where fewer than three frames have shown one that is new, or two agree no better than by
    /// chance.
    pub(crate) fn may_be_chance(&self, most_chance: S) -> bool {
        let is_new = self.evidence == Evidence::Newcomer;
        self.frames < TELLING_FRAMES && (is_new || self.frames == 2 && self.chance > most_chance)
    }

    /// Whether the frames so far may agree by chance, whatever else is known.
    pub(super) fn is_tentative(&self) -> bool {
        self.evidence == Evidence::Weak
    }

    /// Whether an observation of another line lies so near to the predicted edge that the two shift each other.
    pub(crate) fn is_near(&self, row: &RowPlane<S>, observation: &Observation<S>, near_px: S) -> bool {
        let line3 = &self.state.line3;
        self.extent.contains(line3.along(row))
            && line3.residual(observation).px().is_some_and(|innovation| innovation.abs() < near_px)
    }

    /// Whether a sample of this frame's line of a static edge lies where the edge cannot be: the line runs on past it.
    pub(crate) fn is_off(&self, setup: &Setup<S>, observation: &Observation<S>) -> bool {
        let line3 = &self.state.line3;
        let is_static = self.matched.is_some_and(|matched| !matched.has_moved);
        let sigma = sigma_px(line3, &self.total(setup), observation);
        is_static
            && line3.residual(observation).px().zip(sigma).is_some_and(|(off, sigma)| {
                let sigma = hypot(hypot(sigma, observation.sigma_px()), S::ratio(1, WANDER_PARTS_PX));
                off.abs() > sigma * S::from_i32(GATE_SIGMAS)
            })
    }

    /// Which part of this edge a line of this frame covers.
    pub(crate) fn extent_of(&self, observation: &LineObservation<S>) -> Option<Extent<S>> {
        Extent::between(&self.state.line3, &observation.rows)
    }

    /// The plane through the camera and this edge, once frames have measured its lean; before, it only repeats what was
    /// assumed of the vertical.
    pub(super) fn plane(&self, setup: &Setup<S>) -> Option<EdgePlane<S>> {
        let [_, _, sigma_tilt] = self.state.covariance.sigma();
        let lean = setup.uncertainty().sigma_tilt;
        let [from, to] = self.extent.ends();
        let is_measured = self.frames > 1 && self.missed == 0 && sigma_tilt + sigma_tilt < lean;
        is_measured.then(|| EdgePlane::of_edge(&self.state.line3, hypot(sigma_tilt, lean), to - from))
    }

    /// The same edge with another estimate of the vertical: its line in the image stays, and so does the depth in the
    /// middle of what was seen. `None` where that is beside the camera.
    pub(crate) fn with_gravity(self, gravity: [S; 3]) -> Option<Self> {
        let line3 = self.state.line3;
        let [from, to] = self.extent.ends();
        let point = add([line3.bearing, S::ZERO, S::ONE], scale(line3.direction(), (from + to) * S::ratio(1, 2)));
        let normal = cross(point, line3.direction());
        let start = Line3::start(gravity);
        let tilt = -(dot(normal, start.gravity) / dot(normal, start.lean));
        let upright = Line3 { tilt, ..start };
        let ([_, y, _], [_, down_y, _]) = (point, upright.direction());
        let [x, _, depth] = sub(point, scale(upright.direction(), y / down_y));
        let turned = Line3 { bearing: x / depth, inverse_depth: line3.inverse_depth / depth, ..upright };
        let is_sound = depth > S::ratio(1, 10) && tilt.is_finite() && turned.bearing.is_finite();
        // Beyond the middle the line lay at wrong depths, and drew the estimate aside accordingly.
        let change = sub(gravity, line3.gravity);
        let off = line3.inverse_depth * dot(change, change).sqrt() * (to - from) * S::ratio(1, 2);
        let covariance = self.state.covariance.and([S::ZERO, off, S::ZERO]);
        is_sound.then_some(Self { state: LineState { line3: turned, covariance, ..self.state }, ..self })
    }

    /// The same at the start of the next frame; `None` where the edge is beside or behind the camera then.
    pub(crate) fn propagated(self, setup: &Setup<S>, transition: &FrameTransition<S>) -> Option<Self> {
        let extent = self.extent.propagated(&self.state.line3, transition)?;
        Some(Self { state: self.state.propagated(setup, transition)?, matched: None, extent, ..self })
    }
}

/// Square of how much two contrasts differ, in sigmas; nothing where one is not known.
fn contrast_square<S: Scalar>(one: u8, other: u8) -> S {
    if one == 0 || other == 0 {
        return S::ZERO;
    }
    let (one, other) = (i32::from(one), i32::from(other));
    // The difference in parts of the mean is nearly that of the logarithms.
    let sigmas = S::ratio(200 * (one - other), CONTRAST_PERCENT * (one + other));
    (sigmas * sigmas).min(S::from_i32(MOST_CONTRAST_SIGMAS * MOST_CONTRAST_SIGMAS))
}

/// One sigma of how far a line may be from its prediction, in pixels: of both together.
pub(super) fn static_sigma<S: Scalar>(predicted_px: S) -> S {
    hypot(predicted_px, S::ratio(COLUMN_DECIPIXELS, 10))
}

/// Where a frame should show a place along an edge; beside the image, the nearest place in it.
fn predicted<S: Scalar, M: Motion<S>>(setup: &Setup<S>, motion: &M, line3: &Line3<S>, place: S) -> Sample<S> {
    let camera = setup.camera();
    let image = camera.intrinsics();
    let [down_x, down_y, down_z] = line3.direction();
    let depth = (S::ONE + place * down_z).max(S::ratio(1, 10));
    let (column_px, row_px) = camera.pixel((line3.bearing + place * down_x) / depth, place * down_y / depth);
    let inside = |value: S, size: u16| {
        let most = S::from_i32(i32::from(size) - 1);
        if value.is_finite() { value.max(S::ZERO).min(most) } else { most * S::ratio(1, 2) }
    };
    let row_px = inside(row_px, image.rows);
    let seconds = |row: u16| S::from_ratio(setup.readout().row_time_ns(row), NS_PER_S);
    let (first_s, last_s) = (seconds(0), seconds(image.rows.saturating_sub(1)));
    let time_s = first_s + (last_s - first_s) * (row_px / S::from_i32(i32::from(image.rows.max(2)) - 1));
    let mut sample = Sample::point(inside(column_px, image.columns), row_px, time_s, S::ONE);
    // The camera has moved since frame start.
    let seen = Observer::new(camera, motion, [line3.gravity, line3.lean]).observe(&sample);
    if let Some(off_px) = seen.and_then(|seen| line3.residual(&seen).px()) {
        sample.column_px = inside(sample.column_px - off_px, image.columns);
    }
    sample
}

/// Whether a line with this status says where the edge is.
pub(crate) fn is_informative(status: RangeStatus) -> bool {
    matches!(status, RangeStatus::Ok | RangeStatus::Far | RangeStatus::Slow)
}

/// Whether a line with this status may become a landmark: what a single frame cannot tell from chance, several can.
pub(crate) fn may_begin(status: RangeStatus) -> bool {
    is_informative(status) || matches!(status, RangeStatus::Cluttered | RangeStatus::Short)
}
