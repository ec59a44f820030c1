//! [`FrameSequence`]: ranges of frame after frame, each on its own or all as one sequence.

use anyhow::Result;
use shutter_range::{
    Continuity, FrameReport, LensBlur, Line, Motion, MotionBlur, Pose, Post, Range, RangeStatus, Scalar, Sequence,
    Setup,
};

use super::camera_motion::{CameraMotion, MotionInFrame};
use super::down::Down;
use super::tracking::KNOTS;
use crate::input::setup::SetupFile;

/// More edges than a scene has.
const LANDMARKS: usize = 1024;

pub(crate) struct FrameSequence {
    setup: Setup<f64>,
    /// The lens blur as measured so far; `None` where the setup has it, or where no exposure is known.
    lens: Option<LensBlur<f64>>,
    /// `None` where frames are independent of each other.
    sequence: Option<Box<Sequence<f64, LANDMARKS>>>,
    /// The way from the start of this frame to that of the next: the camera's pose there, and the seconds in between.
    to_next: Option<(Pose<f64>, f64)>,
    tells_tentative: bool,
    down: Down,
}

/// What is told of a frame's lines.
pub(crate) struct FrameRanges {
    /// From left to right, whatever the order in which the lines ended.
    pub(crate) ranges: Vec<Range<f64>>,
    /// Points of tentative lines, which are not told.
    pub(crate) untold_points: u32,
    /// For each range the post that it is a side of, if there is one.
    pub(crate) posts: Vec<Option<Post<f64>>>,
    /// The direction of down that was used.
    pub(crate) gravity: [f64; 3],
    pub(crate) sigma_gravity_rad: f64,
    pub(crate) hint: Option<String>,
}

impl FrameSequence {
    /// `first` is the number of the first frame.
    pub(crate) fn new(file: &SetupFile, motion: &CameraMotion, first: i64, tells_tentative: bool) -> Result<Self> {
        let setup = motion
            .exposure_s(first)
            .map_or(Ok(file.setup), |exposure_s| file.setup.with_motion_blur(file.optics.motion_blur(exposure_s)))?;
        let is_unknown = file.optics.lens_blur_px.is_none();
        let lens = setup.motion_blur().filter(|_| is_unknown).copied().map(LensBlur::new);
        let sequence = motion.is_sequence().then(Box::default);
        let down = Down::new(file.gravity_source, motion.is_sequence())?;
        Ok(Self { setup, lens, sequence, to_next: None, tells_tentative, down })
    }

    pub(crate) fn setup(&self) -> &Setup<f64> {
        &self.setup
    }

    /// Begins the next frame; `to_next_s` is how long it is from its start to that of the one after, and `exposure_s`
    /// its own exposure, where it has one.
    pub(crate) fn advance(
        &mut self,
        motion: &MotionInFrame<'_>,
        to_next_s: f64,
        exposure_s: Option<f64>,
    ) -> Result<()> {
        if let Some(exposure_s) = exposure_s {
            self.setup = self.setup.with_exposure_s(exposure_s)?;
        }
        let to_this = self.to_next.replace((motion.pose(to_next_s), to_next_s));
        if let (Some(sequence), Some((pose, elapsed_s))) = (&mut self.sequence, to_this) {
            self.down.advance(&pose, elapsed_s);
            sequence.advance(&self.setup, &pose, elapsed_s, self.down.motion(motion).gravity())?;
        }
        Ok(())
    }

    /// Forgets the frames so far: how the camera came from there to the next one is not known.
    pub(crate) fn restart(&mut self) {
        self.to_next = None;
        if let Some(sequence) = &mut self.sequence {
            sequence.clear();
        }
    }

    /// The ranges of a frame's lines, and what follows from all of them together.
    pub(crate) fn frame(&mut self, motion: &MotionInFrame<'_>, lines: &[Line<KNOTS>]) -> Result<FrameRanges> {
        let tells_tentative = self.tells_tentative;
        let is_told = |range: &Range<f64>| tells_tentative || range.status != RangeStatus::Tentative;
        let unknown = self.down.seek(&mut self.setup, motion, lines)?;
        let motion = &self.down.motion(motion);
        let sigma_gravity_rad = self.setup.uncertainty().sigma_gravity;
        let (mut ranges, untold): (Vec<_>, Vec<_>) = self.ranges(motion, lines)?.into_iter().partition(is_told);
        ranges.iter_mut().for_each(|range| see_in_its_column(range, &self.setup));
        ranges.sort_by(|a, b| a.column_at_first_row.total_cmp(&b.column_at_first_row));
        let mut report = FrameReport::new();
        ranges.iter().for_each(|range| report.add(range));
        Ok(FrameRanges {
            untold_points: untold.iter().map(|range| u32::from(range.points)).sum(),
            posts: (0..ranges.len()).map(|index| Post::of(&ranges, index)).collect(),
            gravity: motion.gravity(),
            sigma_gravity_rad,
            hint: unknown
                .or_else(|| self.discontinuity())
                .or_else(|| report.suspicion(&self.setup).map(|suspicion| suspicion.to_string())),
            ranges,
        })
    }

    /// What to tell a person of a frame that does not follow on from those before it.
    fn discontinuity(&self) -> Option<String> {
        match self.sequence.as_ref()?.continuity() {
            Continuity::Steady => None,
            Continuity::Shifted { seconds, sigma_s } => Some(format!(
                "the known edges say that the frame was taken {:.2} ± {:.2} ms {} than told, and are moved on by that time: was a \
                 frame lost, or its time or the speed wrong?",
                seconds.abs() * 1e3,
                2.0 * sigma_s * 1e3,
                if seconds < 0.0 { "earlier" } else { "later" },
            )),
            Continuity::Repeated => Some(
                "the frame shows what the one before has shown: it came twice, or the camera stood still; nothing is learned from it"
                    .to_string(),
            ),
            Continuity::Restarted => Some(
                "the known edges are not where they should be: a frame is missing or came twice, or its time or motion is wrong; \
                 they are forgotten, and each line stands for itself"
                    .to_string(),
            ),
        }
    }

    fn ranges<M: Motion<f64>>(&mut self, motion: &M, lines: &[Line<KNOTS>]) -> Result<Vec<Range<f64>>> {
        let Some(sequence) = &mut self.sequence else {
            return self.independent_ranges(motion, lines);
        };
        let mut ranges = Vec::new();
        sequence.lines(&self.setup, motion, lines, |range| ranges.push(range));
        if let Some(vertical) = self.down.learned() {
            sequence.learn_vertical(&self.setup, vertical);
        }
        if let Some(lens) = &mut self.lens {
            self.setup = with_learned_blur(&self.setup, lens, &ranges)?;
        }
        Ok(ranges)
    }

    /// A single frame measures the lens blur, too: once with the blur assumed, then with that of all lines together.
    fn independent_ranges<M: Motion<f64>>(&self, motion: &M, lines: &[Line<KNOTS>]) -> Result<Vec<Range<f64>>> {
        let ranges_with =
            |setup: &Setup<f64>| lines.iter().map(|line| Range::from_line(setup, motion, line)).collect::<Vec<_>>();
        let ranges = ranges_with(&self.setup);
        match self.lens {
            Some(mut lens) => Ok(ranges_with(&with_learned_blur(&self.setup, &mut lens, &ranges)?)),
            None => Ok(ranges),
        }
    }
}

/// An edge to which nothing could be fitted has no bearing but that of its column.
fn see_in_its_column(range: &mut Range<f64>, setup: &Setup<f64>) {
    if range.estimate.sigma_bearing < f64::UNKNOWN {
        return;
    }
    let ray = setup.camera().ray(range.column_at_first_row, range.first_row.into());
    range.estimate.bearing = ray.map_or(range.estimate.bearing, |ray| ray.u);
}

/// With the exposure that it has.
fn with_learned_blur(setup: &Setup<f64>, lens: &mut LensBlur<f64>, ranges: &[Range<f64>]) -> Result<Setup<f64>> {
    ranges.iter().for_each(|range| lens.learn(range));
    let learned: MotionBlur<f64> = lens.motion_blur();
    let exposure_s = setup.motion_blur().map_or(learned.exposure_s, |blur| blur.exposure_s);
    Ok(setup.with_motion_blur(learned)?.with_exposure_s(exposure_s)?)
}
