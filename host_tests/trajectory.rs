//! `Trajectory`: stamps, clocks and gaps.

use proptest::prelude::*;
use shutter_range::{
    Motion, Scalar, SensorClock, StampConvention, Trajectory, TrajectoryConfig, TrajectoryError, TrajectoryGap,
    TrajectoryStream,
};

use crate::scenes::seeded;

pub(crate) type Vector = [f64; 3];
pub(crate) const MS: i64 = 1_000_000;
pub(crate) const EXACT: SensorClock = SensorClock { offset_ns: 0, max_gap_ns: 100 * MS as u64 };
pub(crate) const INSTANTS: StampConvention = StampConvention::Instant(EXACT);
const MEANS: StampConvention = StampConvention::MeanSincePrevious(EXACT);

/// Rounding of poses of up to a metre in double precision, a few steps.
pub(crate) const ROUNDING: f64 = 1e-15;

/// The same where roots and series of some terms come in.
pub(crate) const ROUNDING_OF_ROTATION: f64 = 1e-12;

pub(crate) fn streams(velocity: StampConvention) -> TrajectoryConfig {
    TrajectoryConfig { velocity, rate: Some(INSTANTS), gravity: None }
}

pub(crate) fn seconds(time_ns: i64) -> f64 {
    time_ns as f64 * 1e-9
}

pub(crate) fn numbers<S: Scalar>(vector: Vector) -> [S; 3] {
    vector.map(S::from_f64)
}

/// Declared as what they are, instants and means give the same ride.
#[test]
fn a_mean_taken_for_an_instant_lags_by_half_a_period() {
    let speed = |t: f64| 2.0 - t;
    let period_ns = 20 * MS;
    let frame = |stamps, at_stamp: fn(f64) -> f64| {
        let mut trajectory: Trajectory<f64, 16> = Trajectory::new(TrajectoryConfig { rate: None, ..streams(stamps) });
        for k in 0..16 {
            let velocity = [speed(at_stamp(seconds(k * period_ns))), 0.0, 0.0];
            trajectory.push_velocity(k * period_ns, velocity).expect("sound");
        }
        trajectory.frame(5 * period_ns, 0..=2 * period_ns).expect("covered").pose(0.04).position_m[0]
    };
    let exact = (speed(0.1) + speed(0.14)) / 2.0 * 0.04;
    assert!((frame(INSTANTS, |t| t) - exact).abs() < ROUNDING);
    assert!((frame(MEANS, |t| t - 0.01) - exact).abs() < ROUNDING);
    let late = frame(INSTANTS, |t| t - 0.01) - exact;
    assert!((late - 0.01 * 0.04).abs() < ROUNDING, "{late}");
}

#[test]
fn means_are_constant_up_to_their_stamp() {
    let mut trajectory: Trajectory<f64, 4> = Trajectory::new(TrajectoryConfig { rate: None, ..streams(MEANS) });
    for (stamp_ns, speed) in [(0, 9.0), (10 * MS, 1.0), (20 * MS, 3.0)] {
        trajectory.push_velocity(stamp_ns, [speed, 0.0, 0.0]).expect("sound");
    }
    let motion = trajectory.frame(5 * MS, -6 * MS..=25 * MS).expect("covered");
    for (time_s, x) in
        [(0.005, 0.005), (0.01, 0.02), (0.015, 0.035), (0.025, 0.065), (-0.005, -0.005), (-0.006, -0.014)]
    {
        assert!((motion.pose(time_s).position_m[0] - x).abs() < ROUNDING, "{time_s} s");
    }
}

/// A clock that is behind has a positive offset.
#[test]
fn camera_time_is_stamp_plus_offset() {
    for offset_ns in [-7_000_000_000_000, -3 * MS, 0, 4 * MS, 123_456_789_012_345] {
        let behind = SensorClock { offset_ns, ..EXACT };
        let mut trajectory: Trajectory<f64, 16> = Trajectory::new(TrajectoryConfig {
            velocity: INSTANTS,
            rate: Some(StampConvention::Instant(behind)),
            gravity: None,
        });
        for k in 0..16 {
            let t = seconds(k * 5 * MS);
            trajectory.push_velocity(k * 5 * MS, [0.0; 3]).expect("sound");
            trajectory.push_rate(k * 5 * MS - offset_ns, [0.0, 10.0 * t, 0.0]).expect("sound");
        }
        let pose = trajectory.frame(20 * MS, 0..=30 * MS).expect("covered").pose(0.03);
        let angle: f64 = 5.0 * (0.05 * 0.05 - 0.02 * 0.02);
        assert!((pose.rotation[0][2] - angle.sin()).abs() < ROUNDING_OF_ROTATION, "{offset_ns}");
    }
}

/// The camera rolls: down turns the other way in its axes.
#[test]
fn gravity_is_rotated_with_the_camera() {
    let roll_rate = 2.0;
    let down_at = |t: f64| [(roll_rate * t).sin(), (roll_rate * t).cos(), 0.0];
    let gravity_at = |stamps_ns: &[i64], start_ns: i64| {
        let mut trajectory: Trajectory<f64, 64> =
            Trajectory::new(TrajectoryConfig { gravity: Some(EXACT), ..streams(INSTANTS) });
        for k in 0..64 {
            trajectory.push_velocity(k * 5 * MS, [1.0, 0.0, 0.0]).expect("sound");
            trajectory.push_rate(k * 5 * MS, [0.0, 0.0, roll_rate]).expect("sound");
        }
        for stamp_ns in stamps_ns {
            let gravity = down_at(seconds(*stamp_ns)).map(|component| 9.81 * component);
            trajectory.push_gravity(*stamp_ns, gravity).expect("sound");
        }
        trajectory.frame(start_ns, 0..=30 * MS).map(|motion| motion.gravity())
    };
    for (stamps_ns, start_ns) in
        [(&[100 * MS, 180 * MS][..], 120 * MS), (&[100 * MS], 190 * MS), (&[100 * MS], 20 * MS)]
    {
        let (down, expected) = (gravity_at(stamps_ns, start_ns).expect("covered"), down_at(seconds(start_ns)));
        let is_expected = down.iter().zip(expected).all(|(a, b)| (a - b).abs() < ROUNDING_OF_ROTATION);
        assert!(is_expected, "{stamps_ns:?} {start_ns}");
    }
    let stale = TrajectoryGap::Stale {
        stream: TrajectoryStream::Gravity,
        at_ns: 201 * MS,
        gap_ns: 101 * MS as u64,
        max_gap_ns: EXACT.max_gap_ns,
    };
    assert_eq!(gravity_at(&[100 * MS], 201 * MS), Err(stale));
    assert_eq!(gravity_at(&[], 0), Err(TrajectoryGap::Missing(TrajectoryStream::Gravity)));
}

#[test]
fn the_oldest_samples_give_way() {
    let mut trajectory: Trajectory<f64, 4> = Trajectory::new(TrajectoryConfig { rate: None, ..streams(INSTANTS) });
    for k in 0..11 {
        trajectory.push_velocity(k * 80 * MS, [k as f64, 0.0, 0.0]).expect("sound");
    }
    // Left are 560, 640, 720 and 800 ms; 460 ms is as far as the first of them is trusted.
    let pose = trajectory.frame(600 * MS, 0..=80 * MS).expect("covered").pose(0.08);
    assert!((pose.position_m[0] - 0.08 * 8.0).abs() < ROUNDING);
    assert!(trajectory.frame(460 * MS, 0..=MS).is_ok());
    assert_eq!(trajectory.frame(459 * MS, 0..=MS).err(), Some(stale(459 * MS, 101 * MS)));
    trajectory.clear();
    assert_eq!(trajectory.frame(600 * MS, 0..=MS).err(), Some(TrajectoryGap::Missing(TrajectoryStream::Velocity)));
    assert_eq!(trajectory.push_velocity(0, [0.0; 3]), Ok(()), "a clock that was set back");
}

fn stale(at_ns: i64, gap_ns: i64) -> TrajectoryGap {
    let gap_ns = gap_ns.unsigned_abs();
    TrajectoryGap::Stale { stream: TrajectoryStream::Velocity, at_ns, gap_ns, max_gap_ns: EXACT.max_gap_ns }
}

#[test]
fn gaps_have_numbers() {
    let mut trajectory: Trajectory<f32, 8> = Trajectory::new(TrajectoryConfig { rate: None, ..streams(INSTANTS) });
    for stamp_ns in [0, 50 * MS, 200 * MS, 250 * MS] {
        trajectory.push_velocity(stamp_ns, [1.0, 0.0, 0.0]).expect("sound");
    }
    let gap = |start_ns, from_ns, to_ns| trajectory.frame(start_ns, from_ns..=to_ns).err();
    assert_eq!(gap(0, 0, 50 * MS), None);
    assert_eq!(gap(0, 0, 50 * MS + 1), Some(stale(50 * MS, 150 * MS)));
    assert_eq!(gap(60 * MS, 0, 30 * MS), Some(stale(60 * MS, 150 * MS)));
    assert_eq!(gap(200 * MS, 0, 150 * MS), None);
    assert_eq!(gap(200 * MS, 0, 151 * MS), Some(stale(351 * MS, 101 * MS)));
    assert_eq!(gap(200 * MS, -MS, 0), Some(stale(199 * MS, 150 * MS)));
    assert_eq!(gap(0, -100 * MS, 0), None);
    assert_eq!(gap(0, -101 * MS, 0), Some(stale(-101 * MS, 101 * MS)));
    let message = gap(200 * MS, 0, 151 * MS).expect("a gap").to_string();
    assert_eq!(message, "no velocity at 351000000 ns: a gap of 101000000 ns, but at most 100000000 ns are trusted");

    // A rotation that was promised and never came is no rotation of zero.
    let mut trajectory: Trajectory<f32, 8> = Trajectory::new(streams(INSTANTS));
    trajectory.push_velocity(0, [1.0, 0.0, 0.0]).expect("sound");
    let missing = trajectory.frame(0, 0..=MS).err();
    assert_eq!(missing, Some(TrajectoryGap::Missing(TrajectoryStream::Rate)));
    assert_eq!(missing.expect("a gap").to_string(), "no rotation rate: not a single sample");
}

#[test]
fn samples_that_cannot_be_are_refused() {
    let mut trajectory: Trajectory<f64, 8> =
        Trajectory::new(TrajectoryConfig { gravity: Some(EXACT), ..streams(INSTANTS) });
    let value = |result: Result<(), TrajectoryError>| match result {
        Err(TrajectoryError::Value(error)) => error.parameter,
        other => panic!("{other:?}"),
    };
    for nonsense in [f64::NAN, f64::INFINITY, 2e6] {
        assert_eq!(value(trajectory.push_velocity(0, [0.0, nonsense, 0.0])), "velocity_m_s");
        assert_eq!(value(trajectory.push_rate(0, [nonsense, 0.0, 0.0])), "rate_rad_s");
        assert_eq!(value(trajectory.push_gravity(0, [0.0, 0.0, nonsense])), "gravity");
    }
    assert_eq!(value(trajectory.push_gravity(0, [0.0; 3])), "gravity");
    let stream = TrajectoryStream::Velocity;
    for stamp_ns in [i64::MIN, i64::MAX] {
        let refused = trajectory.push_velocity(stamp_ns, [0.0; 3]);
        assert_eq!(refused, Err(TrajectoryError::StampRange { stream, stamp_ns }));
    }
    assert_eq!(trajectory.push_velocity(5, [1.0, 0.0, 0.0]), Ok(()));
    for stamp_ns in [5, 4, -1] {
        let refused = trajectory.push_velocity(stamp_ns, [0.0; 3]);
        assert_eq!(refused, Err(TrajectoryError::StampOrder { stream, stamp_ns, previous_ns: 5 }));
    }
    let message = trajectory.push_velocity(4, [0.0; 3]).expect_err("backwards").to_string();
    assert_eq!(message, "velocity at 4 ns came after 5 ns: stamps must increase");
    let mut bare: Trajectory<f64, 8> = Trajectory::new(TrajectoryConfig { rate: None, ..streams(INSTANTS) });
    assert_eq!(bare.push_rate(0, [0.0; 3]), Err(TrajectoryError::Undeclared(TrajectoryStream::Rate)));
    assert_eq!(bare.push_gravity(0, [0.0, 1.0, 0.0]), Err(TrajectoryError::Undeclared(TrajectoryStream::Gravity)));
}

#[test]
fn it_can_be_a_static_and_is_as_small_as_promised() {
    const TRAJECTORY: Trajectory<f32, 32> =
        Trajectory::new(TrajectoryConfig { velocity: MEANS, rate: None, gravity: None });
    assert!(TRAJECTORY.frame(0, 0..=0).is_err());
    // The 24 bytes for each sample of the documentation, and those of three empty buffers.
    assert!(size_of::<Trajectory<f32, 32>>() <= 3 * (32 * 24 + 64), "{}", size_of::<Trajectory<f32, 32>>());
}

proptest! {
    #![proptest_config(seeded(200))]

    /// No panic, whatever the stamps.
    #[test]
    fn any_samples_give_finite_poses(
        stamps in prop::collection::vec(any::<i64>(), 0..12),
        near in prop::collection::vec(-1_000_000_000..1_000_000_000_i64, 0..12),
        value in [-1e4..1e4, -1e4..1e4, -1e4..1e4],
        (offset_ns, max_gap_ns, start_ns, from_ns, to_ns) in any::<(i64, u64, i64, i64, i64)>(),
        time_s in -10.0..10.0_f32,
    ) {
        let clock = SensorClock { offset_ns: offset_ns % 1000, max_gap_ns };
        let streams = TrajectoryConfig {
            velocity: StampConvention::MeanSincePrevious(clock),
            rate: Some(StampConvention::Instant(SensorClock { offset_ns, max_gap_ns })),
            gravity: Some(clock),
        };
        let mut trajectory: Trajectory<f32, 4> = Trajectory::new(streams);
        for stamp_ns in stamps.into_iter().chain(near) {
            let _ = trajectory.push_velocity(stamp_ns, numbers(value));
            let _ = trajectory.push_rate(stamp_ns, numbers(value.map(|component| component / 10.0)));
            let _ = trajectory.push_gravity(stamp_ns, numbers(value));
        }
        for start_ns in [start_ns, start_ns % 1_000_000_000] {
            if let Ok(motion) = trajectory.frame(start_ns, from_ns..=to_ns) {
                let pose = motion.pose(time_s);
                let all = pose.position_m.into_iter().chain(pose.rotation.into_iter().flatten()).chain(motion.gravity());
                prop_assert!(all.into_iter().all(f32::is_finite), "{:?} {:?}", pose, motion.gravity());
            }
        }
    }
}
