//! [`Course`]: how the camera moves in each frame, and from frame to frame.

use std::path::Path;

use anyhow::{Context, Error, Result, anyhow, ensure};
use shutter_range::{
    FrameMotion, Motion, Pose, SensorClock, StampConvention, Trajectory, TrajectoryConfig, TrajectoryGap, Twist,
};

use crate::arguments::CourseArgs;
use crate::input::setup::{self, SetupFile};
use crate::input::trajectory_file::{self, Sample};

/// Samples from the start of one frame to that of the next, at most.
const SAMPLES: usize = 4096;

/// Values are held and interpolated over so many of the usual intervals of a trajectory's samples.
const TRUSTED_INTERVALS: u64 = 3;

pub(crate) struct Course {
    /// From the start of one frame to that of the next; `None` where frames are independent of each other.
    interval_s: Option<f64>,
    /// Of the row read last.
    last_row_ns: i64,
    source: Source,
}

enum Source {
    /// That of the first frame, which goes on for ever; without an interval that of every frame.
    Constant(Twist<f64>),
    Measured(Box<Measured>),
}

struct Measured {
    /// All with gravity but those that it cannot be carried on to.
    samples: Vec<Sample>,
    /// Those around one frame.
    window: Trajectory<f64, SAMPLES>,
}

/// The motion of one frame.
pub(crate) enum CameraMotion<'a> {
    Constant(Twist<f64>),
    Measured(FrameMotion<'a, f64, SAMPLES>),
}

impl CourseArgs {
    /// With a trajectory, the setup may leave out the velocity.
    pub(crate) fn load_setup(&self, path: &Path) -> Result<SetupFile> {
        if self.trajectory.is_some() { setup::load_without_velocity(path) } else { setup::load(path) }
    }

    /// What is wrong with so many frames, if anything.
    pub(crate) fn refuse_frames(&self, frames: usize) -> Result<(), String> {
        if self.trajectory.is_some() && self.frame_interval_s.is_none() && frames > 1 {
            let needed = "--trajectory for several frames needs --frame-interval-s: when does each of them start?";
            return Err(needed.to_string());
        }
        Ok(())
    }
}

impl Course {
    pub(crate) fn new(arguments: &CourseArgs, file: &SetupFile) -> Result<Self> {
        let source = match &arguments.trajectory {
            Some(path) => Source::Measured(Measured::load(path, file.motion.gravity())?),
            None => Source::Constant(file.motion),
        };
        let readout = file.setup.readout();
        let last_row_ns = readout.row_time_ns(readout.row_after(u16::MAX));
        Ok(Self { interval_s: arguments.frame_interval_s, last_row_ns, source })
    }

    pub(crate) fn is_sequence(&self) -> bool {
        self.interval_s.is_some()
    }

    /// Seconds from the start of a frame to that of the next one; zero where there is none.
    pub(crate) fn to_next_s(&self, number: i64, next: Option<i64>) -> f64 {
        next.map_or(0.0, |next| self.start_s(next) - self.start_s(number))
    }

    /// Seconds from the start of frame 0 to that of another.
    fn start_s(&self, number: i64) -> f64 {
        number as f64 * self.interval_s.unwrap_or(0.0)
    }

    /// The motion of a frame, in the axes of its start: good for its rows, and up to the start of the next frame, if any.
    pub(crate) fn motion(&mut self, number: i64, next: Option<i64>) -> Result<CameraMotion<'_>> {
        let start_s = self.start_s(number);
        let to_next_s = self.to_next_s(number, next);
        let (start_ns, until_ns) = (nanoseconds(start_s), self.last_row_ns.max(nanoseconds(to_next_s)));
        match &mut self.source {
            Source::Constant(twist) => Ok(CameraMotion::Constant(later(twist, start_s)?)),
            Source::Measured(measured) => {
                let motion = measured.motion(start_ns, until_ns);
                let named = || format!("frame start at {} s", start_ns as f64 / 1e9);
                Ok(CameraMotion::Measured(motion.with_context(named)?))
            }
        }
    }
}

fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

/// The same motion in the axes that the camera has then.
fn later(twist: &Twist<f64>, time_s: f64) -> Result<Twist<f64>> {
    let pose = twist.pose(time_s);
    let velocity_m_s = turned_back(&pose, twist.velocity_m_s());
    Ok(Twist::new(velocity_m_s, twist.rate_rad_s(), turned_back(&pose, twist.gravity()))?)
}

/// A direction of the frame-start camera's axes in those that it has now.
fn turned_back(pose: &Pose<f64>, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let [first, second, third] = pose.rotation;
    std::array::from_fn(|axis| first[axis] * x + second[axis] * y + third[axis] * z)
}

impl Measured {
    fn load(path: &Path, gravity: [f64; 3]) -> Result<Box<Self>> {
        let mut samples = trajectory_file::load(path)?;
        let max_gap_ns = TRUSTED_INTERVALS * usual_interval_ns(&samples);
        if samples.iter().all(|sample| sample.gravity.is_none()) {
            carry_gravity(&mut samples, gravity, max_gap_ns)?;
        }
        Ok(Box::new(Self { samples, window: Trajectory::new(instants(max_gap_ns)) }))
    }

    fn motion(&mut self, start_ns: i64, until_ns: i64) -> Result<FrameMotion<'_, f64, SAMPLES>> {
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
        self.window.frame(start_ns, 0..=until_ns).map_err(told)
    }
}

/// All values are those of the instant of their line, on the frames' clock.
fn instants(max_gap_ns: u64) -> TrajectoryConfig {
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

/// Median time from sample to sample.
fn usual_interval_ns(samples: &[Sample]) -> u64 {
    let mut intervals: Vec<u64> =
        samples.iter().zip(samples.iter().skip(1)).map(|(a, b)| a.time_ns.abs_diff(b.time_ns)).collect();
    intervals.sort_unstable();
    intervals.get(intervals.len() / 2).copied().unwrap_or(0)
}

/// Gives the samples the gravity that the first frame starts with, turned along with the camera up to the first gap.
fn carry_gravity(samples: &mut [Sample], gravity: [f64; 3], max_gap_ns: u64) -> Result<()> {
    let from_start = samples.partition_point(|sample| sample.time_ns <= 0);
    let onwards = carried(samples, from_start..samples.len(), gravity, max_gap_ns)?;
    let backwards = carried(samples, (0..from_start).rev(), gravity, max_gap_ns)?;
    for (index, gravity) in onwards.into_iter().chain(backwards) {
        if let Some(sample) = samples.get_mut(index) {
            sample.gravity = Some(gravity);
        }
    }
    Ok(())
}

/// Gravity at one sample after the other, away from the start of the first frame.
fn carried(
    samples: &[Sample],
    indices: impl Iterator<Item = usize>,
    mut gravity: [f64; 3],
    max_gap_ns: u64,
) -> Result<Vec<(usize, [f64; 3])>> {
    // Those on either side are enough from one to the next.
    let mut window: Trajectory<f64, 3> = Trajectory::new(TrajectoryConfig { gravity: None, ..instants(max_gap_ns) });
    let mut from_ns = 0;
    let mut found = Vec::new();
    for index in indices {
        window.clear();
        for sample in samples.iter().take(index + 2).skip(index.saturating_sub(1)) {
            push(&mut window, sample)?;
        }
        let step_ns = samples.get(index).map_or(from_ns, |sample| sample.time_ns) - from_ns;
        let Ok(motion) = window.frame(from_ns, step_ns.min(0)..=step_ns.max(0)) else { break };
        gravity = turned_back(&motion.pose(step_ns as f64 / 1e9), gravity);
        from_ns += step_ns;
        found.push((index, gravity));
    }
    Ok(found)
}

/// What is missing, in seconds.
fn told(gap: TrajectoryGap) -> Error {
    let seconds = |ns: u64| ns as f64 / 1e9;
    match gap {
        TrajectoryGap::Stale { stream, at_ns, gap_ns, max_gap_ns } => anyhow!(
            "the trajectory has no {stream} at {} s: a gap of {} s, but at most {} s are trusted, {TRUSTED_INTERVALS} \
             times the usual interval of its samples",
            at_ns as f64 / 1e9,
            seconds(gap_ns),
            seconds(max_gap_ns)
        ),
        // The others come with every sample.
        _ => anyhow!(
            "the trajectory has a gap between the first frame and this one, so that gravity cannot be carried on: \
             columns `gx`, `gy` and `gz` would tell"
        ),
    }
}

impl Motion<f64> for CameraMotion<'_> {
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
