//! [`Trajectory`]: the motion of a frame from samples of wheel odometry and an inertial sensor.

use core::ops::RangeInclusive;

use super::checked::{checked_direction, checked_rate, checked_velocity};
use super::motion::{Motion, Pose};
use super::sample_buffer::{Stamped, Stream, fraction, interpolate, seconds};
use super::sensor_clock::{SensorClock, StampConvention};
use crate::error::{TrajectoryError, TrajectoryGap, TrajectoryStream};
use crate::scalar::{Scalar, dot};

/// Which streams a [`Trajectory`] has, and what their stamps mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TrajectoryConfig {
    /// Stamps of the velocity.
    pub velocity: StampConvention,
    /// Stamps of the rotation rate; `None` for a camera that does not turn.
    pub rate: Option<StampConvention>,
    /// Clock of the direction of gravity, whose values are those of the stamped instants; `None` for a camera that is
    /// level at every frame start.
    pub gravity: Option<SensorClock>,
}

/// The last `N` samples each of velocity, rotation rate and gravity, stamped by their own clocks, from which it makes
/// the [`Motion`] of any frame.
///
/// All values are in the camera's axes *at their own instant*, as sensors fixed to the camera measure them; rotate them
/// from the sensor's axes into the camera's first. The streams may have different rates, and a frame may lie before,
/// between or after the samples: values hold for as long as their [`SensorClock`] trusts them. Where one is missing or
/// stale there is no motion but a [`TrajectoryGap`], which says for how long. A full buffer drops its oldest sample.
///
/// From one stamp to the next, of whatever stream, velocity and rotation rate are taken to be constant in the camera's
/// axes, at their values halfway. That is exact for constant ones (the camera then moves along an arc, where a
/// [`Twist`](crate::Twist) keeps its direction in space) and for a velocity that changes linearly without rotation.
/// Otherwise the error is of second order in the time between stamps.
///
/// *Memory*: three times `N` × (8 bytes + 3 numbers), in `f32` 24 bytes.
///
/// ```
/// use shutter_range::{Motion, Readout, StampConvention, SensorClock, TrajectoryConfig, Trajectory};
/// // Wheel ticks counted over 50 ms, in the camera's clock; a gyroscope of 200 Hz whose clock is 2 s ahead of it.
/// let wheels = SensorClock { offset_ns: 0, max_gap_ns: 150_000_000 };
/// let gyro = SensorClock { offset_ns: -2_000_000_000, max_gap_ns: 20_000_000 };
/// let mut trajectory: Trajectory<f32, 16> = Trajectory::new(TrajectoryConfig {
///     velocity: StampConvention::MeanSincePrevious(wheels),
///     rate: Some(StampConvention::Instant(gyro)),
///     gravity: None, // level
/// });
/// for k in 0..16 {
///     trajectory.push_rate(2_000_000_000 + k * 5_000_000, [0.0, 0.4, 0.0])?;
/// }
/// trajectory.push_velocity(0, [0.0, 0.0, 1.0])?;
/// trajectory.push_velocity(50_000_000, [0.0, 0.0, 1.2])?;
///
/// // A frame that starts at 20 ms, for the time of its rows.
/// let readout = Readout::from_frame_readout_ns(480, 33_300_000, Default::default())?;
/// let motion = trajectory.frame(20_000_000, 0..=readout.row_time_ns(479))?;
/// assert!((motion.pose(0.03).position_m[2] - 0.036).abs() < 1e-5);
///
/// // Three frames later the gyroscope has been silent since 75 ms.
/// let gap = trajectory.frame(120_000_000, 0..=readout.row_time_ns(479)).unwrap_err();
/// assert!(gap.to_string().starts_with("no rotation rate at 153"));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Trajectory<S, const N: usize> {
    velocity: Stream<S, N>,
    rate: Stream<S, N>,
    gravity: Stream<S, N>,
}

impl<S: Scalar, const N: usize> Trajectory<S, N> {
    const AT_LEAST_ONE: () = assert!(N >= 1, "a trajectory needs room for a sample");

    /// A trajectory without samples.
    #[must_use]
    pub const fn new(config: TrajectoryConfig) -> Self {
        let () = Self::AT_LEAST_ONE;
        let gravity = match config.gravity {
            Some(clock) => Some(StampConvention::Instant(clock)),
            None => None,
        };
        Self {
            velocity: Stream::new(TrajectoryStream::Velocity, Some(config.velocity)),
            rate: Stream::new(TrajectoryStream::Rate, config.rate),
            gravity: Stream::new(TrajectoryStream::Gravity, gravity),
        }
    }

    /// Forgets all samples; for use after a clock was set back.
    pub fn clear(&mut self) {
        self.velocity.clear();
        self.rate.clear();
        self.gravity.clear();
    }

    /// Takes a velocity in m/s, in the camera's axes of that instant.
    ///
    /// *Errors*: a component that is not finite or beyond 10000 m/s; a stamp that is not later than the previous one,
    /// or beyond ±2⁶² ns.
    pub fn push_velocity(&mut self, stamp_ns: i64, velocity_m_s: [S; 3]) -> Result<(), TrajectoryError> {
        self.velocity.push(stamp_ns, checked_velocity(velocity_m_s)?)
    }

    /// Takes a rotation rate in rad/s, with the signs of [`Twist::new`](crate::Twist::new).
    ///
    /// *Errors*: as [`Trajectory::push_velocity`], but beyond 1000 rad/s; a trajectory that was made without rotation
    /// rate.
    pub fn push_rate(&mut self, stamp_ns: i64, rate_rad_s: [S; 3]) -> Result<(), TrajectoryError> {
        self.rate.push(stamp_ns, checked_rate(rate_rad_s)?)
    }

    /// Takes the direction of "down", of a length as [`Twist::new`](crate::Twist::new) takes it: an accelerometer at rest shows
    /// its opposite.
    ///
    /// *Errors*: as [`Trajectory::push_velocity`]; a gravity without direction; a trajectory that was made without
    /// gravity.
    pub fn push_gravity(&mut self, stamp_ns: i64, gravity: [S; 3]) -> Result<(), TrajectoryError> {
        self.gravity.push(stamp_ns, checked_direction(gravity)?)
    }

    /// The motion of the frame that starts at `start_ns` of the camera's clock: the middle of the exposure of the row
    /// read first. Poses can be asked for within `window_ns`, in nanoseconds since frame start: from zero to the time
    /// of the row read last for a single frame, and up to the frame interval, or from before zero, to get from frame to
    /// frame.
    ///
    /// Gravity at frame start is interpolated between the samples before and after it, which are first rotated to frame
    /// start with the camera's rotation; so the rotation rate must be known at their stamps, too.
    ///
    /// *Errors*: the first stream that is missing or stale, as a [`TrajectoryGap`].
    ///
    /// *Cost*: two comparisons for each sample, and two poses where there is a stream of gravity.
    pub fn frame(&self, start_ns: i64, window_ns: RangeInclusive<i64>) -> Result<FrameMotion<'_, S, N>, TrajectoryGap> {
        let from_ns = start_ns.saturating_add(0.min(*window_ns.start()));
        let to_ns = start_ns.saturating_add(0.max(*window_ns.end()));
        self.velocity.check_gaps(from_ns, to_ns)?;
        self.gravity.check_gaps(start_ns, start_ns)?;
        let (before, after) = self.gravity.around(self.gravity.count_until(start_ns, true));
        let from_ns = before.map_or(from_ns, |sample| from_ns.min(sample.time_ns));
        let to_ns = after.map_or(to_ns, |sample| to_ns.max(sample.time_ns));
        self.rate.check_gaps(from_ns, to_ns)?;
        let level = FrameMotion { trajectory: self, start_ns, gravity: [S::ZERO, S::ONE, S::ZERO] };
        let gravity = level.gravity_between(before, after);
        Ok(FrameMotion { gravity, ..level })
    }
}

/// The motion of one frame, from [`Trajectory::frame`].
///
/// *Cost of a pose*: for each stamp between frame start and its time two binary searches and some 150 operations.
/// Outside the window that was asked for, the nearest values hold however old they are.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FrameMotion<'a, S, const N: usize> {
    trajectory: &'a Trajectory<S, N>,
    start_ns: i64,
    gravity: [S; 3],
}

impl<S: Scalar, const N: usize> FrameMotion<'_, S, N> {
    /// Gravity at frame start in the axes there, from the samples before and after.
    fn gravity_between(&self, before: Option<&Stamped<S>>, after: Option<&Stamped<S>>) -> [S; 3] {
        let at_start =
            |sample: &Stamped<S>| self.pose(seconds(sample.time_ns.saturating_sub(self.start_ns))).rotate(sample.value);
        match (before, after) {
            (Some(before), Some(after)) => {
                let fraction = fraction(before, after, self.start_ns, S::ZERO);
                let down = interpolate(at_start(before), at_start(after), fraction);
                let length = dot(down, down).sqrt();
                // There is no direction halfway between opposite ones.
                if length > S::ratio(1, 1_000) { down.map(|component| component / length) } else { at_start(before) }
            }
            (Some(sample), None) | (None, Some(sample)) => at_start(sample),
            (None, None) => self.gravity,
        }
    }

    /// The segment from `from_ns` (of the camera's clock) to the next stamp of any stream, forwards or backwards.
    fn segment(&self, from_ns: i64, forwards: bool) -> Segment {
        let Trajectory { velocity, rate, .. } = self.trajectory;
        let velocities = velocity.count_until(from_ns, forwards);
        let rates = rate.count_until(from_ns, forwards);
        let (of_velocity, of_rate) = (velocity.around(velocities), rate.around(rates));
        let time_ns = |sample: &Stamped<S>| sample.time_ns;
        let end_ns = if forwards {
            of_velocity.1.into_iter().chain(of_rate.1).map(time_ns).min()
        } else {
            of_velocity.0.into_iter().chain(of_rate.0).map(time_ns).max()
        };
        Segment { velocities, rates, end_ns }
    }

    /// Velocity and rotation rate in the camera's axes at a time within a segment.
    fn twist(&self, segment: &Segment, time_s: S) -> ([S; 3], [S; 3]) {
        let Trajectory { velocity, rate, .. } = self.trajectory;
        let velocity = velocity.value(segment.velocities, self.start_ns, time_s);
        (velocity, rate.value(segment.rates, self.start_ns, time_s))
    }
}

/// A segment of time between two stamps.
struct Segment {
    /// Number of samples of the velocity before it.
    velocities: usize,
    /// Number of samples of the rotation rate before it.
    rates: usize,
    /// The stamp at which it ends; `None` where there is no more.
    end_ns: Option<i64>,
}

impl<S: Scalar, const N: usize> Motion<S> for FrameMotion<'_, S, N> {
    fn pose(&self, time_s: S) -> Pose<S> {
        let forwards = time_s >= S::ZERO;
        let mut pose = Pose::START;
        let (mut from_ns, mut from_s) = (self.start_ns, S::ZERO);
        loop {
            let segment = self.segment(from_ns, forwards);
            let end = segment.end_ns.map(|end_ns| (end_ns, seconds(end_ns.saturating_sub(self.start_ns))));
            let end = end.filter(|(_, end_s)| if forwards { *end_s < time_s } else { *end_s > time_s });
            let to_s = end.map_or(time_s, |(_, end_s)| end_s);
            let (velocity, rate) = self.twist(&segment, (from_s + to_s) * S::ratio(1, 2));
            pose = pose.moved(velocity, rate, to_s - from_s);
            match end {
                Some(end) => (from_ns, from_s) = end,
                None => {
                    let (velocity, rate) = self.twist(&segment, time_s);
                    return Pose { velocity_m_s: pose.rotate(velocity), rate_rad_s: pose.rotate(rate), ..pose };
                }
            }
        }
    }

    fn keeps_attitude(&self) -> bool {
        !self.trajectory.rate.is_declared()
    }

    fn gravity(&self) -> [S; 3] {
        self.gravity
    }
}
