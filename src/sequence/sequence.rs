//! [`Sequence`]: edges that are continued from frame to frame.

use super::blend::Blend;
use super::continuity::{Census, Continuity};
use super::extent::Extent;
use super::landmark::{Evidence, Landmark, UnsureTime, is_informative, may_begin};
use super::landmark_table::LandmarkTable;
use super::line_observation::LineObservation;
use super::propagation::FrameTransition;
use super::time_shift::{TimeShift, Vote};
use super::tuning::{CHANCE_EDGES, CLEAR_TIMES};
use super::vertical::Vertical;
use crate::error::ParameterError;
use crate::line::{Line, Repair};
use crate::motion::{Motion, Pose, check_next_frame, checked_direction};
use crate::range::{Range, RangeStatus, SampleSet};
use crate::ranger::Ranger;
use crate::scalar::Scalar;
use crate::setup::Setup;

/// The edges of earlier frames, at most `LANDMARKS`, each updated where a frame shows it again.
///
/// A single frame cannot tell a leaning edge from a near one; in several, parallax grows and the lean repeats, so that
/// a few frames of a moving camera make the tilt known and sigma falls accordingly. Each frame's knots enter the same
/// least squares as in a single frame, with the earlier frames as three prior equations: memory does not grow with
/// time.
///
/// A line is associated with the landmark that predicts it; the likeliest pairs come first. The stated errors of speed
/// and rotation are correlated over about a second, so that they do not average out over its frames, and drift over
/// longer times; so sigma does not shrink for ever.
///
/// Where two edges at different depths pass within eight pixels of each other, their columns are those of neither:
/// these rows are left out, and a new edge there becomes a landmark once most of it stands clear.
///
/// An object that moves at a constant velocity looks static at another distance as long as the camera's velocity is
/// constant, too. Once speed or heading changes, it is not where it should be: its status is then
/// [`Moving`](crate::RangeStatus::Moving), until 30 frames in a row have agreed with a static edge again. An object
/// that is more than three pixels and four sigma off its prediction is taken for another edge.
///
/// What begins where four edges are known, or wholly beside one of them, is a chance line more often than an edge: its
/// status is [`Tentative`](crate::RangeStatus::Tentative) until three frames agree.
///
/// *Room*: a landmark for each line of a frame that has a place in space, and a quarter more for edges that are hidden
/// for a while (measured in docs/model.md, section 8.6). When the table is full, the landmark that has not been seen
/// for longest goes first, a tentative one before all others. A line for which there is no room is told as that of a
/// single frame, without a name.
///
/// *Memory*: 208 bytes for each landmark in `f32`, and 48.
///
/// ```
/// use shutter_range::{EdgePoint, Motion, Ranger, Sequence, Setup, Sigmas, Twist, Uncertainty};
/// let half_a_degree = Uncertainty::NONE.with_sigma_tilt(0.0087);
/// let setup = Setup::pinhole(640, 480, 600.0_f64, 33_300_000)?.with_uncertainty(half_a_degree)?;
/// let motion = Twist::level([-1.5, 0.0, 0.0])?;
/// let interval_s = 0.04;
/// let mut ranger: Ranger<16, 12, 32> = Ranger::new();
/// let mut sequence: Sequence<f64, 16> = Sequence::new();
/// let mut sigma_m = vec![];
/// for frame in 0..5 {
///     for row in 0..480 {
///         let time_ns = setup.readout().row_time_ns(row);
///         // A post 2 m away that leans by half a degree.
///         let moved_m = 1.5 * (interval_s * frame as f64 + time_ns as f64 * 1e-9);
///         let column_px = 200.0 + 600.0 * moved_m / 2.0 + 0.0087 * (row as f64 - 239.5);
///         ranger.edge_point(&setup, EdgePoint::new(row, (column_px * 65536.0) as i32, time_ns))?;
///     }
///     ranger.end_frame(&setup);
///     sequence.frame(&setup, &motion, &mut ranger, |range| {
///         sigma_m.push(range.depth(Sigmas(2.0)).estimate_m.expect("status is ok").1);
///     });
///     sequence.advance(&setup, &motion.pose(interval_s), interval_s, motion.gravity())?;
/// }
/// assert!(sigma_m[0] > 0.2 && sigma_m[4] < 0.002, "{sigma_m:?}");
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sequence<S, const LANDMARKS: usize> {
    landmarks: LandmarkTable<S, LANDMARKS>,
    next_id: u32,
    dropped_lines: u32,
    /// A frame has been taken since the last call of `advance`.
    has_frame: bool,
    /// From the frame before to this one; zero at the start.
    interval_s: S,
    continuity: Continuity<S>,
    /// Enough known edges are where `interval_s` has them: they vouch for the time, and for what else there is.
    interval_is_shown: bool,
    /// Lines of this frame.
    lines: u16,
}

impl<S: Scalar, const LANDMARKS: usize> Sequence<S, LANDMARKS> {
    /// A sequence that has seen nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            landmarks: LandmarkTable::new(),
            next_id: 0,
            dropped_lines: 0,
            has_frame: false,
            interval_s: S::ZERO,
            continuity: Continuity::Steady,
            interval_is_shown: false,
            lines: 0,
        }
    }

    /// Ranges all lines that a ranger has ready, each with what earlier frames have told of it, and hands the ranges
    /// over in no particular order. Call it once a frame, after [`Ranger::end_frame`]. Nobody else may take lines of
    /// that ranger, so its table needs room for all lines of a frame. Call [`advance`](Self::advance) between two
    /// frames; without it, the edges of earlier frames are forgotten.
    ///
    /// A frame that shows all known edges off alike is told by [`continuity`](Self::continuity): they are moved on by
    /// the time that it was late, or forgotten where that cannot be told.
    ///
    /// *Cost*: for each landmark a prediction; for each line one fit as in [`Range::from_line`] or two, and a
    /// comparison with each landmark of its polarity that is predicted within its reach: four sigma, at least 32
    /// pixels. For at most 32 landmarks another comparison; only in a frame that does not follow on, these with all
    /// lines, and all predictions again.
    pub fn frame<M: Motion<S>, R: Repair, const LINES: usize, const KNOTS: usize, const POINTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        ranger: &mut Ranger<LINES, KNOTS, POINTS, R>,
        mut found: impl FnMut(Range<S>),
    ) {
        self.associate(setup, motion, ranger.places(), |place| ranger.line_at(place));
        while let Some((place, line)) = ranger.placed_line() {
            let range = self.continue_line(setup, motion, place, line);
            ranger.leave_line();
            found(range);
        }
        self.landmarks.count_missed();
    }

    /// The same for lines from elsewhere, in their order. Call it once a frame, with all its lines.
    pub fn lines<M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        lines: &[Line<KNOTS>],
        mut found: impl FnMut(Range<S>),
    ) {
        self.associate(setup, motion, 0..lines.len(), |place| lines.get(place));
        for (place, line) in lines.iter().enumerate() {
            found(self.continue_line(setup, motion, place, line));
        }
        self.landmarks.count_missed();
    }

    /// Propagates to the next frame's start: the `pose` of the camera there in the axes of this frame's start, the time
    /// in between, and gravity in the camera's axes there, of a length as [`Twist::new`](crate::Twist::new) takes it.
    /// What is then beside or behind the camera is forgotten. Call it between any two frames, also after a torn one.
    ///
    /// *Errors*: a time that is not finite or beyond 10⁶ s, a pose that is not finite or beyond 10⁶ m, 10 000 m/s or
    /// 1000 rad/s, or a gravity without direction; nothing has changed then.
    ///
    /// *Cost*: some 500 operations for each landmark.
    pub fn advance(
        &mut self,
        setup: &Setup<S>,
        pose: &Pose<S>,
        elapsed_s: S,
        gravity: [S; 3],
    ) -> Result<(), ParameterError> {
        check_next_frame(pose, elapsed_s)?;
        let sigma_time_s = setup.uncertainty().sigma_time_s;
        let transition = FrameTransition { pose: *pose, elapsed_s, sigma_time_s, gravity: checked_direction(gravity)? };
        // After a torn frame the time since the one before has two parts.
        let since_frame_s = if self.has_frame { S::ZERO } else { self.interval_s };
        self.has_frame = false;
        self.interval_s = since_frame_s + elapsed_s;
        self.landmarks.propagate(setup, &transition);
        Ok(())
    }

    /// Learns the vertical from the edges that several frames have shown, and takes it over for all of them: what their
    /// lines in the image are stays. Call it after a frame whose motion has the `gravity` of this vertical.
    ///
    /// *Cost*: 12 rounds of some 50 operations for each landmark.
    pub fn learn_vertical(&mut self, setup: &Setup<S>, vertical: &mut Vertical<S>) {
        let landmarks = &self.landmarks;
        vertical.learn(|| landmarks.iter().filter_map(|landmark| landmark.plane(setup)));
        let gravity = vertical.gravity();
        self.landmarks.replace_each(|landmark| landmark.with_gravity(gravity));
    }

    /// Forgets all edges, for when the motion to the next frame is not known. Their names are not used again.
    pub fn clear(&mut self) {
        self.landmarks.clear();
        self.interval_is_shown = false;
    }

    /// Whether the last frame has shown the known edges where they should be, or all of them off alike.
    #[must_use]
    pub const fn continuity(&self) -> Continuity<S> {
        self.continuity
    }

    /// Number of edges that are remembered.
    #[must_use]
    pub fn landmarks(&self) -> usize {
        self.landmarks.len()
    }

    /// Lines for which there was no room; a line that is refused in each frame counts each time.
    #[must_use]
    pub const fn dropped_lines(&self) -> u32 {
        self.dropped_lines
    }

    /// Associates the lines of a frame with the landmarks, which are moved on where the frame was taken at another time
    /// than told.
    #[inline(never)]
    fn associate<'l, M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        places: impl Iterator<Item = usize> + Clone,
        line_at: impl Fn(usize) -> Option<&'l Line<KNOTS>>,
    ) {
        // Nobody has said how the camera moved since the last frame.
        if self.has_frame {
            self.clear();
        }
        self.has_frame = true;
        self.lines = u16::try_from(places.clone().count()).unwrap_or(u16::MAX);
        self.landmarks.match_lines(setup, motion, places.clone(), &line_at);
        self.continuity = Continuity::Steady;
        if self.take_census(setup, motion, &line_at) {
            return;
        }
        let shift = self.shift(setup, motion, places.clone(), &line_at);
        self.continuity = shift.map_or(Continuity::Restarted, |shift| self.follow(setup, motion, &shift));
        self.landmarks.match_lines(setup, motion, places, &line_at);
        if self.continuity == Continuity::Restarted || !self.take_census(setup, motion, &line_at) {
            self.clear();
            self.continuity = Continuity::Restarted;
        }
    }

    /// By how much the frame was taken at another time than told, if its lines agree on that.
    #[inline(never)]
    fn shift<'l, M: Motion<S>, const KNOTS: usize>(
        &self,
        setup: &Setup<S>,
        motion: &M,
        places: impl Iterator<Item = usize> + Clone,
        line_at: impl Fn(usize) -> Option<&'l Line<KNOTS>>,
    ) -> Option<TimeShift<S>> {
        let axes = self.landmarks.axes(motion);
        let lines = || places.clone().filter_map(|place| LineObservation::new(setup, motion, &axes, line_at(place)?));
        Vote::new(setup, motion, self.landmarks.known(), self.interval_s).shift(lines)
    }

    /// Asks the known edges, and answers whether most are where they should be.
    fn take_census<'l, M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        line_at: impl Fn(usize) -> Option<&'l Line<KNOTS>>,
    ) -> bool {
        let census = Census::of(setup, motion, self.landmarks.known(), self.interval_s, line_at);
        self.interval_is_shown = census.shows_interval();
        census.is_steady(self.lines)
    }

    /// Moves all landmarks on to the time at which a frame was really taken.
    fn follow<M: Motion<S>>(&mut self, setup: &Setup<S>, motion: &M, shift: &TimeShift<S>) -> Continuity<S> {
        let (seconds, sigma_s) = (shift.intervals * self.interval_s, shift.sigma * self.interval_s.abs());
        let gravity = self.landmarks.axes(motion).gravity;
        let later = FrameTransition::within(motion, seconds, gravity);
        self.landmarks.propagate(setup, &FrameTransition { sigma_time_s: sigma_s, ..later });
        if shift.is_repetition() { Continuity::Repeated } else { Continuity::Shifted { seconds, sigma_s } }
    }

    // Not inlined, as its parts: what each of them needs then leaves the stack before the next one comes.
    #[inline(never)]
    fn continue_line<M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        place: usize,
        line: &Line<KNOTS>,
    ) -> Range<S> {
        let most_chance = S::ratio(CHANCE_EDGES, i32::from(self.lines.max(1)));
        let Some((columns_px, blend)) = Blend::of(setup, motion, &mut self.landmarks, place, line) else {
            return Range::from_line(setup, motion, line);
        };
        let has_line = |landmark: &&mut Landmark<S>| landmark.is_matched_by(place);
        let is_repeated = self.continuity == Continuity::Repeated;
        let time_may_be_wrong = setup.uncertainty().sigma_time_s > S::ZERO && !self.interval_is_shown;
        let unsure_interval_s = time_may_be_wrong.then_some(self.interval_s);
        let Some(landmark) = self.landmarks.around(columns_px).find(has_line) else {
            return self.begin(setup, motion, line, blend);
        };
        let time_is_unsure = blend.is_whole && landmark.frames == 2 && unsure_interval_s.is_some();
        let range = if blend.is_whole || is_repeated {
            Range::remembered(setup, motion, line, &landmark.state)
        } else {
            let (range, unsure) = landmark.update(setup, motion, line, blend.samples, unsure_interval_s);
            let anew = |UnsureTime { earlier }| {
                Range::continued(setup, motion, line, earlier.as_ref(), blend.samples, &mut None)
            };
            unsure.map_or(range, anew)
        };
        let is_doubtful = self.interval_is_shown && landmark.may_be_chance(most_chance);
        landmark.name(range, most_chance, time_is_unsure || is_doubtful)
    }

    /// A line that no landmark predicts becomes one, if there is room.
    #[inline(never)]
    fn begin<M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
        blend: Blend,
    ) -> Range<S> {
        let left_out = if blend.is_whole { SampleSet::default() } else { blend.samples };
        let mut state = None;
        let range = Range::continued(setup, motion, line, None, left_out, &mut state);
        // A bearing alone does not predict where the edge will be.
        let has_depth = range.estimate.sigma_inverse_depth_per_m < S::UNKNOWN;
        let Some(state) = state.filter(|_| may_begin(range.status) && has_depth) else { return range };
        // What comes into view beside an edge is often half hidden by it, and would start with a wrong column.
        if blend.is_whole {
            return range.tentative();
        }
        let id = self.next_id;
        let Some(observation) = LineObservation::new(setup, motion, &state.line3, line) else { return range };
        let Some(extent) = Extent::between(&state.line3, &observation.rows) else { return range };
        let is_weak = match range.status {
            // One frame would tell it; more of them tell it surely.
            RangeStatus::Ok => !line.stands_out(CLEAR_TIMES),
            status => !is_informative(status) || range.is_short_part_of(setup.readout()),
        };
        let evidence = match (is_weak, self.interval_is_shown) {
            (true, _) => Evidence::Weak,
            (false, true) => Evidence::Newcomer,
            (false, false) => Evidence::Enough,
        };
        let landmark = Landmark::new(id, &observation, evidence, state, extent);
        if self.landmarks.insert(landmark).is_err() {
            self.dropped_lines = self.dropped_lines.saturating_add(1);
            return range;
        }
        self.next_id = self.next_id.wrapping_add(1);
        let is_told = evidence == Evidence::Enough;
        if is_informative(range.status) { range.named(id, 1, false, !is_told) } else { range }
    }
}

impl<S: Scalar, const LANDMARKS: usize> Default for Sequence<S, LANDMARKS> {
    fn default() -> Self {
        Self::new()
    }
}
