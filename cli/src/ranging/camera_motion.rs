//! [`CameraMotion`]: how the camera moves in each frame, and from frame to frame.

use std::path::Path;

use anyhow::{Context, Error, Result, anyhow, ensure};
use shutter_range::{
    FrameMotion, Motion, Pose, SensorClock, StampConvention, Trajectory, TrajectoryConfig, TrajectoryGap, Twist,
};

use super::frame_starts::FrameStarts;
use crate::input::frame_times::FrameName;
use crate::input::repeated_stamps::Sample;
use crate::input::setup::{self, GravitySource, SetupFile, SetupSource};
use crate::input::trajectory_file;
use crate::setup_arguments::{MotionArgs, SetupArgs};

/// A trajectory has at most this many samples from the start of one frame to that of the next.
const SAMPLES: usize = 4096;

/// A gap between samples is interpolated if it is at most this many times their usual interval.
const TRUSTED_INTERVALS: u64 = 3;

pub(crate) struct CameraMotion {
    starts: FrameStarts,
    /// When the last row is read, since the start of its frame.
    last_row_ns: i64,
    source: Source,
}

enum Source {
    /// In a sequence the motion at the start of the first frame, which goes on for ever; otherwise that of every frame.
    Constant(Twist<f64>),
    Measured(Box<Measured>),
}

struct Measured {
    /// Gravity is missing beyond a gap, which it cannot be propagated over.
    samples: Vec<Sample>,
    /// The samples around one frame.
    window: Trajectory<f64, SAMPLES>,
}

/// The motion of one frame, in the axes of the camera at its start.
pub(crate) enum MotionInFrame<'a> {
    Constant(Twist<f64>),
    Measured(FrameMotion<'a, f64, SAMPLES>),
}

impl MotionArgs {
    /// With a trajectory, the setup may leave out the velocity.
    pub(crate) fn load_setup(&self, setup: &SetupArgs) -> Result<SetupFile> {
        setup::load(SetupSource { has_trajectory: self.trajectory.is_some(), ..setup.source() })
    }

    /// Whether the frames are one sequence.
    pub(crate) fn is_sequence(&self) -> bool {
        self.frame_interval_s.is_some() || self.frame_times.is_some()
    }

    /// Refuses a number of frames that needs further arguments.
    pub(crate) fn check_frames(&self, frames: usize) -> Result<(), String> {
        if self.trajectory.is_some() && !self.is_sequence() && frames > 1 {
            let needed = "--trajectory for several frames needs --frame-interval-s or --frame-times";
            return Err(format!("{needed}: when does each of them start?"));
        }
        Ok(())
    }
}

impl CameraMotion {
    /// For these frames in their order, with their numbers.
    pub(crate) fn new(arguments: &MotionArgs, file: &SetupFile, frames: Vec<(i64, FrameName)>) -> Result<Self> {
        let starts = FrameStarts::new(arguments, file, frames)?;
        let source = match &arguments.trajectory {
            Some(path) => Source::Measured(Measured::load(path, file)?),
            None => Source::Constant(file.motion),
        };
        let readout = file.setup.readout();
        let last_row_ns = readout.row_time_ns(readout.row_after(u16::MAX));
        Ok(Self { starts, last_row_ns, source })
    }

    /// For samples that need not be as a file has them, each with its gravity.
    pub(crate) fn of_samples(
        arguments: &MotionArgs,
        file: &SetupFile,
        frames: Vec<(i64, FrameName)>,
        samples: Vec<Sample>,
    ) -> Result<Self> {
        let starts = FrameStarts::new(arguments, file, frames)?;
        let readout = file.setup.readout();
        let last_row_ns = readout.row_time_ns(readout.row_after(u16::MAX));
        Ok(Self { starts, last_row_ns, source: Source::Measured(Box::new(Measured::new(samples))) })
    }

    /// Seconds from the start of the first frame to that of another one.
    pub(crate) fn start_s(&self, number: i64) -> f64 {
        self.starts.start_s(number)
    }

    pub(crate) fn is_sequence(&self) -> bool {
        self.starts.is_sequence()
    }

    /// Of a frame, where each has its own.
    pub(crate) fn exposure_s(&self, number: i64) -> Option<f64> {
        self.starts.exposure_s(number)
    }

    /// Seconds from the start of a frame to that of the next one; zero where there is none.
    pub(crate) fn to_next_s(&self, number: i64, next: Option<i64>) -> f64 {
        next.map_or(0.0, |next| self.starts.start_s(next) - self.starts.start_s(number))
    }

    /// The motion of a frame from its start to its last row, and to the start of the next frame, if there is one.
    pub(crate) fn in_frame(&mut self, number: i64, next: Option<i64>) -> Result<MotionInFrame<'_>> {
        let start_s = self.starts.start_s(number);
        let to_next_s = self.to_next_s(number, next);
        let (start_ns, until_ns) = (nanoseconds(start_s), self.last_row_ns.max(nanoseconds(to_next_s)));
        match &mut self.source {
            Source::Constant(twist) => Ok(MotionInFrame::Constant(propagated(twist, start_s)?)),
            Source::Measured(measured) => {
                let motion = measured.in_frame(start_ns, until_ns);
                let frame = || format!("frame start at {} s", start_ns as f64 / 1e9);
                Ok(MotionInFrame::Measured(motion.with_context(frame)?))
            }
        }
    }
}

fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

/// The same motion in the axes of the camera after some time.
fn propagated(twist: &Twist<f64>, time_s: f64) -> Result<Twist<f64>> {
    let pose = twist.pose(time_s);
    let velocity_m_s = in_axes_of(&pose, twist.velocity_m_s());
    Ok(Twist::new(velocity_m_s, twist.rate_rad_s(), in_axes_of(&pose, twist.gravity()))?)
}

/// A vector in the axes of the camera at this pose, from those at frame start: by the transpose of its rotation.
fn in_axes_of(pose: &Pose<f64>, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let [first, second, third] = pose.rotation;
    std::array::from_fn(|axis| first[axis] * x + second[axis] * y + third[axis] * z)
}

impl Measured {
    fn load(path: &Path, file: &SetupFile) -> Result<Box<Self>> {
        let mut samples = trajectory_file::load(path, file)?;
        let max_gap_ns = TRUSTED_INTERVALS * usual_interval_ns(&samples);
        let has_gravity = samples.iter().any(|sample| sample.gravity.is_some());
        ensure!(
            !has_gravity || file.gravity_source == GravitySource::Told,
            "{}: the columns `gx`, `gy` and `gz` must be left out where the setup's `attitude.gravity` is \"learn\" or \
             \"fit\": it is estimated then",
            path.display()
        );
        if !has_gravity {
            propagate_gravity(&mut samples, file.motion.gravity(), max_gap_ns)?;
        }
        Ok(Box::new(Self::new(samples)))
    }

    fn new(samples: Vec<Sample>) -> Self {
        let max_gap_ns = TRUSTED_INTERVALS * usual_interval_ns(&samples);
        Self { samples, window: Trajectory::new(config(max_gap_ns)) }
    }

    fn in_frame(&mut self, start_ns: i64, until_ns: i64) -> Result<FrameMotion<'_, f64, SAMPLES>> {
        let after = |time_ns: i64| self.samples.partition_point(|sample| sample.time_ns <= time_ns);
        let (first, last) = (after(start_ns).saturating_sub(1), after(start_ns.saturating_add(until_ns)));
        let around = self.samples.get(first..self.samples.len().min(last + 1)).unwrap_or_default();
        ensure!(
            around.len() <= SAMPLES,
            "the trajectory has {} samples in {} s, but must have at most {SAMPLES} from frame to frame",
            around.len(),
            until_ns as f64 / 1e9
        );
        self.window.clear();
        for sample in around {
            push(&mut self.window, sample)?;
        }
        self.window.frame(start_ns, 0..=until_ns).map_err(gap_error)
    }
}

/// A line of the file has the values of one instant, on the clock of the frames.
fn config(max_gap_ns: u64) -> TrajectoryConfig {
    let clock = SensorClock { offset_ns: 0, max_gap_ns };
    TrajectoryConfig {
        velocity: StampConvention::Instant(clock),
        rate: Some(StampConvention::Instant(clock)),
        gravity: Some(clock),
    }
}

fn push<const N: usize>(trajectory: &mut Trajectory<f64, N>, sample: &Sample) -> Result<()> {
    trajectory.push_velocity(sample.time_ns, sample.velocity_m_s)?;
    trajectory.push_rate(sample.time_ns, sample.rate_rad_s)?;
    if let Some(gravity) = sample.gravity {
        trajectory.push_gravity(sample.time_ns, gravity)?;
    }
    Ok(())
}

/// Time from sample to sample: the median over time, so that samples which come in bursts have the interval of the
/// bursts. One gap alone is none, however long.
fn usual_interval_ns(samples: &[Sample]) -> u64 {
    const FEWEST_BURSTS: usize = 3;
    let mut intervals: Vec<u64> =
        samples.iter().zip(samples.iter().skip(1)).map(|(a, b)| a.time_ns.abs_diff(b.time_ns)).collect();
    intervals.sort_unstable();
    let (half_ns, mut sum_ns) = (intervals.iter().sum::<u64>() / 2, 0);
    let by_time = intervals.iter().position(|interval_ns| {
        sum_ns += interval_ns;
        sum_ns >= half_ns
    });
    let by_time = by_time.filter(|index| intervals.len() - index >= FEWEST_BURSTS);
    intervals.get(by_time.unwrap_or(intervals.len() / 2)).copied().unwrap_or(0)
}

/// Gives the samples gravity: from the start of the first frame, by the rotation of the camera, up to the first gap.
fn propagate_gravity(samples: &mut [Sample], gravity: [f64; 3], max_gap_ns: u64) -> Result<()> {
    let from_start = samples.partition_point(|sample| sample.time_ns <= 0);
    let after = gravity_along(samples, from_start..samples.len(), gravity, max_gap_ns)?;
    let before = gravity_along(samples, (0..from_start).rev(), gravity, max_gap_ns)?;
    for (index, gravity) in after.into_iter().chain(before) {
        if let Some(sample) = samples.get_mut(index) {
            sample.gravity = Some(gravity);
        }
    }
    Ok(())
}

/// Gravity at one sample after the other, away from the start of the first frame, with their indices.
fn gravity_along(
    samples: &[Sample],
    indices: impl Iterator<Item = usize>,
    mut gravity: [f64; 3],
    max_gap_ns: u64,
) -> Result<Vec<(usize, [f64; 3])>> {
    // From one sample to the next, these two and the one on the other side are all that is needed.
    let mut window: Trajectory<f64, 3> = Trajectory::new(TrajectoryConfig { gravity: None, ..config(max_gap_ns) });
    let mut from_ns = 0;
    let mut found = Vec::new();
    for index in indices {
        window.clear();
        for sample in samples.iter().take(index + 2).skip(index.saturating_sub(1)) {
            push(&mut window, sample)?;
        }
        let step_ns = samples.get(index).map_or(from_ns, |sample| sample.time_ns) - from_ns;
        let Ok(motion) = window.frame(from_ns, step_ns.min(0)..=step_ns.max(0)) else { break };
        gravity = in_axes_of(&motion.pose(step_ns as f64 / 1e9), gravity);
        from_ns += step_ns;
        found.push((index, gravity));
    }
    Ok(found)
}

fn gap_error(gap: TrajectoryGap) -> Error {
    let seconds = |ns: u64| ns as f64 / 1e9;
    match gap {
        TrajectoryGap::Stale { stream, at_ns, gap_ns, max_gap_ns } => anyhow!(
            "the trajectory has no {stream} at {} s: a gap of {} s, but at most {} s are trusted, {TRUSTED_INTERVALS} \
             times the usual interval of its samples",
            at_ns as f64 / 1e9,
            seconds(gap_ns),
            seconds(max_gap_ns)
        ),
        // Every sample has a velocity and a rate, so it is gravity that is missing.
        _ => anyhow!(
            "the trajectory has a gap between the first frame and this one, so that its gravity is unknown: give the \
             columns `gx`, `gy` and `gz`"
        ),
    }
}

impl Motion<f64> for MotionInFrame<'_> {
    fn pose(&self, time_s: f64) -> Pose<f64> {
        match self {
            Self::Constant(twist) => twist.pose(time_s),
            Self::Measured(motion) => motion.pose(time_s),
        }
    }

    fn gravity(&self) -> [f64; 3] {
        match self {
            Self::Constant(twist) => twist.gravity(),
            Self::Measured(motion) => motion.gravity(),
        }
    }
}
