//! [`Sequence`]: edges that are continued from frame to frame.

use heapless::Vec;

use super::extent::Extent;
use super::landmark::{Landmark, LineObservation, Match, is_informative, may_begin};
use super::propagation::FrameTransition;
use crate::error::ParameterError;
use crate::line::Line;
use crate::motion::{Motion, Pose, checked_direction};
use crate::range::{Line3, LineState, Range, RangeStatus};
use crate::ranger::Ranger;
use crate::scalar::Scalar;
use crate::setup::Setup;

/// The edges of earlier frames, at most `LANDMARKS`, each updated where a frame shows it again.
///
/// A single frame cannot tell a leaning edge from a near one; in several, parallax grows and the lean repeats, so that
/// a few frames of a moving camera make the tilt known and sigma falls accordingly. Each frame's knots enter the same least
/// squares as in a single frame, with the earlier frames as three prior equations: memory does not grow with time.
///
/// A line is associated with the landmark that predicts it; the nearest pairs come first. The stated errors of speed and
/// rotation are correlated over about a second, so that they do not average out over its frames, and drift over longer
/// times; so sigma does not shrink for ever.
///
/// Where two edges at different depths pass within eight pixels of each other, their columns are those of neither: both
/// keep their earlier estimates, and a new edge there becomes a landmark once it stands clear.
///
/// An object that moves at a constant velocity looks static at another distance as long as the camera's velocity is
/// constant, too. Once speed or heading changes, it is not where it should be: its status is then
/// [`Moving`](crate::RangeStatus::Moving), until 30 frames in a row have agreed with a static edge again. An object that is
/// more than three pixels and four sigma off its prediction is taken for another edge.
///
/// *Memory*: 208 bytes for each landmark in `f32`, and 16.
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
    landmarks: Vec<Landmark<S>, LANDMARKS>,
    next_id: u32,
    dropped_lines: u32,
    /// A frame has been taken since the last call of `advance`.
    has_frame: bool,
}

/// A landmark that is missed in more frames in a row is forgotten.
const MOST_MISSED: u16 = 30;

impl<S: Scalar, const LANDMARKS: usize> Sequence<S, LANDMARKS> {
    /// A sequence that has seen nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { landmarks: Vec::new(), next_id: 0, dropped_lines: 0, has_frame: false }
    }

    /// Ranges all lines that a ranger has ready, each with what earlier frames have told of it, and hands the ranges over in
    /// no particular order. Call it once a frame, after [`Ranger::end_frame`]. Nobody else may take lines of that ranger, so
    /// its table needs room for all lines of a frame. Call [`advance`](Self::advance) between two frames; without it, the
    /// edges of earlier frames are forgotten.
    ///
    /// *Cost*: for each line one fit as in [`Range::from_line`] or two, and three predictions for each landmark of its polarity.
    pub fn frame<M: Motion<S>, const LINES: usize, const KNOTS: usize, const POINTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        ranger: &mut Ranger<LINES, KNOTS, POINTS>,
        mut found: impl FnMut(Range<S>),
    ) {
        self.associate(setup, motion, ranger.places(), |place| ranger.line_at(place));
        while let Some((place, line)) = ranger.next_placed_line() {
            found(self.continue_line(setup, motion, place, &line));
        }
        self.count_missed();
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
        self.count_missed();
    }

    /// Propagates to the next frame's start: the `pose` of the camera there in the axes of this frame's start, the time in
    /// between, and gravity in the camera's axes there, of any length. What is then beside or behind the camera is
    /// forgotten. Call it between any two frames, also after a torn one.
    ///
    /// *Errors*: a gravity without direction; nothing has changed then.
    ///
    /// *Cost*: some 500 operations for each landmark.
    pub fn advance(
        &mut self,
        setup: &Setup<S>,
        pose: &Pose<S>,
        elapsed_s: S,
        gravity: [S; 3],
    ) -> Result<(), ParameterError> {
        let transition = FrameTransition { pose: *pose, elapsed_s, gravity: checked_direction(gravity)? };
        self.has_frame = false;
        self.landmarks.retain_mut(|landmark| match landmark.propagated(setup, &transition) {
            Some(propagated) => {
                *landmark = propagated;
                true
            }
            None => false,
        });
        Ok(())
    }

    /// Forgets all edges, for when the motion to the next frame is not known. Their names are not used again.
    pub fn clear(&mut self) {
        self.landmarks.clear();
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

    /// Associates each line with at most one landmark, and each landmark with at most one line: a landmark keeps the nearest
    /// of the lines that are offered to it, and a line that is turned down is offered to the next one.
    fn associate<'l, M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        places: impl Iterator<Item = usize>,
        line_at: impl Fn(usize) -> Option<&'l Line<KNOTS>>,
    ) {
        // Nobody has said how the camera moved since the last frame.
        if self.has_frame {
            self.clear();
        }
        self.has_frame = true;
        self.landmarks.iter_mut().for_each(|landmark| landmark.matched = None);
        let axes = self.axes(motion);
        for place in places {
            let mut asking = u32::try_from(place).ok();
            while let Some(place) = asking {
                let seen = line_at(place as usize);
                let observation = seen.and_then(|line| LineObservation::new(setup, motion, &axes, line));
                asking = observation.and_then(|observation| self.offer(setup, place, &observation));
            }
        }
    }

    /// The directions of down and lean in this frame, as the landmarks have them.
    fn axes<M: Motion<S>>(&self, motion: &M) -> Line3<S> {
        self.landmarks.first().map_or_else(|| Line3::start(motion.gravity()), |landmark| landmark.state.line3)
    }

    /// A landmark without a line in this frame is hidden or gone.
    fn count_missed(&mut self) {
        for landmark in &mut self.landmarks {
            landmark.missed = if landmark.matched.is_some() { 0 } else { landmark.missed.saturating_add(1) };
        }
        self.landmarks.retain(|landmark| landmark.missed <= MOST_MISSED);
    }

    /// Offers a line to the nearest landmark that prefers it to its present one, and returns the place of the line that is
    /// turned down.
    fn offer(&mut self, setup: &Setup<S>, place: u32, observation: &LineObservation<S>) -> Option<u32> {
        let mut best: Option<(&mut Landmark<S>, Match<S>)> = None;
        for landmark in &mut self.landmarks {
            let Some(matched) = landmark.match_with(setup, place, observation) else { continue };
            let nearer = |other: &Match<S>| matched.distance < other.distance;
            if landmark.matched.as_ref().is_none_or(nearer) && best.as_ref().is_none_or(|(_, best)| nearer(best)) {
                best = Some((landmark, matched));
            }
        }
        let (landmark, matched) = best?;
        landmark.matched.replace(matched).map(|before| before.place)
    }

    fn continue_line<M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        place: usize,
        line: &Line<KNOTS>,
    ) -> Range<S> {
        let has_line = |landmark: &Landmark<S>| landmark.matched.is_some_and(|matched| matched.place as usize == place);
        let Some(index) = self.landmarks.iter().position(has_line) else {
            return self.begin(setup, motion, line);
        };
        let observation = LineObservation::new(setup, motion, &self.axes(motion), line);
        let others = self.landmarks.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, other)| other);
        let state = self.landmarks.get(index).map(|landmark| landmark.state);
        let blends = blends(observation.as_ref(), state.as_ref(), others);
        let Some(landmark) = self.landmarks.get_mut(index) else { return Range::from_line(setup, motion, line) };
        let range = if blends {
            Range::remembered(setup, motion, line, &landmark.state)
        } else {
            landmark.update(setup, motion, line)
        };
        landmark.name(range)
    }

    /// A line that no landmark predicts becomes one, if there is room.
    fn begin<M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
    ) -> Range<S> {
        let (range, state) = Range::continued(setup, motion, line, None);
        // A bearing alone does not predict where the edge will be.
        let has_depth = range.estimate.sigma_inverse_depth_per_m < S::UNKNOWN;
        let Some(state) = state.filter(|_| may_begin(range.status) && has_depth) else { return range };
        // What comes into view beside an edge is often half hidden by it, and would start with a wrong column.
        let observation = LineObservation::new(setup, motion, &self.axes(motion), line);
        let is_near =
            |landmark: &Landmark<S>| observation.as_ref().is_some_and(|observation| landmark.is_near(observation));
        if self.landmarks.iter().any(|landmark| landmark.frames > 1 && landmark.matched.is_some() && is_near(landmark))
        {
            return range;
        }
        let id = self.next_id;
        // No line that is still to be taken has this place.
        let matched = Some(Match { place: u32::MAX, distance: S::ZERO, has_moved: false });
        let (polarity, frames, missed, hold_off) = (line.first().polarity, 1, 0, 0);
        let seen = observation.and_then(|observation| Extent::between(&state.line3, &observation.rows));
        let Some(extent) = seen else { return range };
        let is_weak = !is_informative(range.status)
            || (range.is_short_part_of(setup.readout()) && range.status != RangeStatus::Ok);
        let landmark = Landmark { id, polarity, frames, missed, hold_off, is_weak, matched, state, extent };
        if self.landmarks.push(landmark).or_else(|landmark| self.replace_unseen(landmark)).is_err() {
            self.dropped_lines = self.dropped_lines.saturating_add(1);
            return range;
        }
        self.next_id = self.next_id.wrapping_add(1);
        if is_informative(range.status) { Range { line_id: Some(id), ..range } } else { range }
    }

    /// The table is full: replaces the landmark that has not been seen for longest. One that this frame shows is never
    /// replaced; if all are shown, the new one is refused.
    fn replace_unseen(&mut self, newcomer: Landmark<S>) -> Result<(), Landmark<S>> {
        let unseen = self.landmarks.iter_mut().filter(|landmark| landmark.matched.is_none());
        match unseen.max_by_key(|landmark| landmark.missed) {
            Some(place) => {
                *place = newcomer;
                Ok(())
            }
            None => Err(newcomer),
        }
    }
}

/// Whether an edge is so near to one at another depth that the two blend: the columns are then those of neither.
fn blends<'l, S: Scalar + 'l>(
    observation: Option<&LineObservation<S>>,
    state: Option<&LineState<S>>,
    mut others: impl Iterator<Item = &'l Landmark<S>>,
) -> bool {
    match (observation, state) {
        (Some(observation), Some(state)) => {
            others.any(|other| other.is_near(observation) && other.state.is_apart(state))
        }
        _ => false,
    }
}

impl<S: Scalar, const LANDMARKS: usize> Default for Sequence<S, LANDMARKS> {
    fn default() -> Self {
        Self::new()
    }
}
