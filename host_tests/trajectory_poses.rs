//! `Trajectory`: poses against an integration of small steps that shares no code with it.

use proptest::prelude::*;
use shutter_range::{
    EdgePoint, FrameMotion, Micro, Motion, Pose, Q32, Range, Scalar, SensorClock, StampConvention, Trajectory,
    TrajectoryConfig, Twist, Uncertainty,
};

use crate::projection::Scene;
use crate::scenes::{line_of, q16, seeded};
use crate::trajectory::{EXACT, INSTANTS, MS, ROUNDING, ROUNDING_OF_ROTATION, Vector, numbers, seconds, streams};

/// A motion in the camera's own axes as functions of time.
#[derive(Clone, Copy)]
struct Ride {
    velocity_m_s: fn(f64) -> Vector,
    rate_rad_s: fn(f64) -> Vector,
}

/// Braking by 1 m/s² while driving forward and left, turning ever faster, nodding and rolling.
const WILD: Ride = Ride {
    velocity_m_s: |t| [-1.5 - 0.4 * t, 0.1 * (20.0 * t).sin(), 2.0 - t],
    rate_rad_s: |t| [0.3 * (30.0 * t).cos(), 0.5 + 3.0 * t, 0.2 * (30.0 * t).sin()],
};

impl Ride {
    /// Position and attitude at `time_s`, having been at rest in the origin at `start_s`: Runge and Kutta.
    fn pose(&self, start_s: f64, time_s: f64) -> (Vector, [Vector; 3]) {
        let steps = ((time_s - start_s).abs() / 1e-4).ceil().max(1.0);
        let h = (time_s - start_s) / steps;
        let mut state = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for step in 0..steps as u32 {
            let t = start_s + f64::from(step) * h;
            let after = |slope: &[Vector; 4], h: f64| combined(&state, slope, h);
            let k1 = self.slope(t, &state);
            let k2 = self.slope(t + h / 2.0, &after(&k1, h / 2.0));
            let k3 = self.slope(t + h / 2.0, &after(&k2, h / 2.0));
            let k4 = self.slope(t + h, &after(&k3, h));
            let outer = combined(&k1, &k4, 1.0);
            let inner = combined(&k2, &k3, 1.0);
            state = combined(&state, &combined(&outer, &inner, 2.0), h / 6.0);
        }
        let [position, rotation @ ..] = state;
        (position, rotation)
    }

    /// p' = R v, and for each row r of R: r' = r × ω.
    fn slope(&self, t: f64, [_, rows @ ..]: &[Vector; 4]) -> [Vector; 4] {
        let (v, [wx, wy, wz]) = ((self.velocity_m_s)(t), (self.rate_rad_s)(t));
        let [a, b, c] = rows.map(|[x, y, z]| [y * wz - z * wy, z * wx - x * wz, x * wy - y * wx]);
        [rows.map(|row| inner(row, v)), a, b, c]
    }

    /// Samples from `from_ns` on, at multiples of the period.
    fn feed<S: Scalar, const N: usize>(&self, trajectory: &mut Trajectory<S, N>, from_ns: i64, period_ns: i64) {
        for k in 0..N as i64 {
            let stamp_ns = from_ns + k * period_ns;
            let t = seconds(stamp_ns);
            trajectory.push_velocity(stamp_ns, numbers((self.velocity_m_s)(t))).expect("sound");
            trajectory.push_rate(stamp_ns, numbers((self.rate_rad_s)(t))).expect("sound");
        }
    }
}

fn combined(a: &[Vector; 4], b: &[Vector; 4], factor: f64) -> [Vector; 4] {
    std::array::from_fn(|row| std::array::from_fn(|column| a[row][column] + factor * b[row][column]))
}

fn inner(a: Vector, b: Vector) -> f64 {
    a.into_iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The largest difference in any component of position or rotation.
fn difference<S: Scalar>(pose: &Pose<S>, position: Vector, rotation: [Vector; 3]) -> f64 {
    let got = pose.position_m.into_iter().chain(pose.rotation.into_iter().flatten());
    let expected = position.into_iter().chain(rotation.into_iter().flatten());
    got.zip(expected).map(|(got, expected)| (got.to_f64() - expected).abs()).fold(0.0, f64::max)
}

fn same_as_the_twist<S: Scalar>(tolerance: f64) {
    // Along the axis of its rotation, a velocity is the same in the camera's axes and in those of frame start.
    for (velocity, rate) in [([1.5, -0.3, 2.0], [0.0; 3]), ([0.6, -1.2, 0.9], [0.2, -0.4, 0.3])] {
        let twist = Twist::new(numbers(velocity), numbers(rate), numbers([0.0, 1.0, 0.0])).expect("sound");
        let mut trajectory: Trajectory<S, 16> = Trajectory::new(streams(INSTANTS));
        let ride = |k: i64| 5_000_000_000_000 + k * 7 * MS;
        for k in 0..16 {
            trajectory.push_velocity(ride(k), numbers(velocity)).expect("sound");
            trajectory.push_rate(ride(k) + 3 * MS, numbers(rate)).expect("sound");
        }
        let motion = trajectory.frame(ride(5) + MS, -30 * MS..=60 * MS).expect("covered");
        for time_ns in [-30 * MS, -MS, 0, 1, 17 * MS, 60 * MS] {
            let expected: Pose<S> = twist.pose(S::from_f64(seconds(time_ns)));
            let pose = motion.pose(S::from_f64(seconds(time_ns)));
            let rotation = expected.rotation.map(|row| row.map(S::to_f64));
            let error = difference(&pose, expected.position_m.map(S::to_f64), rotation);
            assert!(error < tolerance, "{time_ns} ns: {error}");
            for (got, expected) in pose.velocity_m_s.into_iter().zip(velocity) {
                assert!((got.to_f64() - expected).abs() < 10.0 * tolerance);
            }
        }
        assert_eq!(motion.gravity(), twist.gravity());
    }
}

#[test]
fn a_constant_twist_is_a_twist() {
    // One rounding at each stamp, of which there are up to twenty: 1e-16, 6e-8 and 9e-10 of numbers near one; `Q32`
    // cuts off instead.
    same_as_the_twist::<f64>(ROUNDING);
    same_as_the_twist::<f32>(5e-7);
    same_as_the_twist::<Micro>(5e-7);
    same_as_the_twist::<Q32>(3e-8);
}

/// Forward at 2 m/s, turning right: on a circle, also far beyond what the series is for.
#[test]
fn an_arc_is_a_circle() {
    for yaw_rate in [0.01, 1.0, 40.0] {
        let mut trajectory: Trajectory<f64, 8> = Trajectory::new(streams(INSTANTS));
        for k in 0..8 {
            trajectory.push_velocity(k * 40 * MS, [0.0, 0.0, 2.0]).expect("sound");
            trajectory.push_rate(k * 40 * MS, [0.0, yaw_rate, 0.0]).expect("sound");
        }
        let motion = trajectory.frame(100 * MS, -100 * MS..=100 * MS).expect("covered");
        for time_s in [-0.1, -0.03, 0.01, 0.1] {
            let (angle, radius): (f64, f64) = (yaw_rate * time_s, 2.0 / yaw_rate);
            let (sine, cosine) = angle.sin_cos();
            let position = [2.0 * radius * (angle / 2.0).sin().powi(2), 0.0, radius * sine];
            let rotation = [[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]];
            let pose = motion.pose(time_s);
            assert!(difference(&pose, position, rotation) < ROUNDING_OF_ROTATION, "{yaw_rate} rad/s, {time_s} s");
            assert!((pose.velocity_m_s[0] - 2.0 * sine).abs() < ROUNDING_OF_ROTATION);
            assert!((pose.rate_rad_s[1] - yaw_rate).abs() < ROUNDING_OF_ROTATION);
        }
    }
}

/// Wheel odometry of 20 Hz while braking by 1 m/s²: the samples lie on a line, so nothing is lost.
#[test]
fn braking_is_exact() {
    let at = |t: f64| 2.0 * t - 0.5 * t * t;
    let mut trajectory: Trajectory<f64, 8> = Trajectory::new(TrajectoryConfig { rate: None, ..streams(INSTANTS) });
    for k in 0..8 {
        trajectory.push_velocity(k * 50 * MS, [0.0, 0.0, 2.0 - seconds(k * 50 * MS)]).expect("sound");
    }
    let start_ns = 130 * MS;
    let motion = trajectory.frame(start_ns, -100 * MS..=150 * MS).expect("covered");
    for time_s in [-0.1, -0.08, 0.0, 0.005, 0.02, 0.1, 0.15] {
        let expected = at(seconds(start_ns) + time_s) - at(seconds(start_ns));
        let pose = motion.pose(time_s);
        assert!((pose.position_m[2] - expected).abs() < ROUNDING, "{time_s} s");
        assert!((pose.velocity_m_s[2] - (2.0 - seconds(start_ns) - time_s)).abs() < ROUNDING);
    }
}

/// Odometry of 20 Hz and a gyroscope of 200 Hz on a clock of its own.
#[test]
fn streams_of_different_rates_follow_an_integration_of_small_steps() {
    let gyro = SensorClock { offset_ns: 90_000_123, max_gap_ns: 6 * MS as u64 };
    let mut trajectory: Trajectory<f64, 64> = Trajectory::new(TrajectoryConfig {
        velocity: INSTANTS,
        rate: Some(StampConvention::Instant(gyro)),
        gravity: None,
    });
    for k in 0..8 {
        let stamp_ns = k * 50 * MS;
        trajectory.push_velocity(stamp_ns, (WILD.velocity_m_s)(seconds(stamp_ns))).expect("sound");
    }
    for k in 0..60 {
        let stamp_ns = k * 5 * MS - gyro.offset_ns;
        trajectory.push_rate(stamp_ns, (WILD.rate_rad_s)(seconds(k * 5 * MS))).expect("sound");
    }
    let start_ns = 101 * MS;
    let motion = trajectory.frame(start_ns, -33 * MS..=66 * MS).expect("covered");
    for time_ns in [-33 * MS, 2 * MS, 33 * MS, 66 * MS] {
        let (position, rotation) = WILD.pose(seconds(start_ns), seconds(start_ns + time_ns));
        let error = difference(&motion.pose(seconds(time_ns)), position, rotation);
        // The sideways swing of 0.1 m/s at 3 Hz, cut to chords of 50 ms: 0.012 m/s for up to 66 ms.
        assert!(error < 1e-3, "{time_ns} ns: {error}");
    }
}

/// With twice as many samples the error is a quarter, though axis, rate and velocity all change.
#[test]
fn the_error_is_of_second_order() {
    let error = |period_ns: i64| {
        let mut trajectory: Trajectory<f64, 256> = Trajectory::new(streams(INSTANTS));
        WILD.feed(&mut trajectory, 0, period_ns);
        let motion = trajectory.frame(10 * MS, -10 * MS..=100 * MS).expect("covered");
        let at = |time_ns: i64| {
            let (position, rotation) = WILD.pose(0.01, 0.01 + seconds(time_ns));
            difference(&motion.pose(seconds(time_ns)), position, rotation)
        };
        at(-10 * MS).max(at(33 * MS)).max(at(100 * MS))
    };
    let errors = [4 * MS, 2 * MS, MS].map(error);
    // h²/12 of a pitch rate whose change goes from −9 to 9 rad/s²: 1.5e-6.
    assert!(errors[2] < 2e-6, "{errors:?}");
    for pair in errors.windows(2) {
        // Four, but for where stamps fall in the window.
        assert!((3.3..4.7).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

/// To the next frame's start, and back again.
#[test]
fn poses_compose_from_frame_to_frame() {
    // A few roundings at each of the 14 stamps in between.
    const ROUNDING: f64 = 1e-14;
    let mut trajectory: Trajectory<f64, 64> = Trajectory::new(streams(INSTANTS));
    WILD.feed(&mut trajectory, 0, 5 * MS);
    let (first_ns, interval_ns) = (100 * MS, 35 * MS);
    let here = trajectory.frame(first_ns, 0..=70 * MS).expect("covered");
    let there = trajectory.frame(first_ns + interval_ns, -interval_ns..=interval_ns).expect("covered");
    let (step, next) = (here.pose(0.035), there.pose(0.02));
    let onwards = [0, 1, 2].map(|axis| step.position_m[axis] + step.rotate(next.position_m)[axis]);
    let direct = here.pose(0.055);
    assert!(onwards.iter().zip(direct.position_m).all(|(a, b)| (a - b).abs() < ROUNDING));
    let back = there.pose(-0.035);
    let again = [0, 1, 2].map(|axis| back.position_m[axis] + back.rotate(step.position_m)[axis]);
    assert!(again.iter().all(|component| component.abs() < ROUNDING), "{again:?}");
    for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        let there_and_back = back.rotate(step.rotate(axis));
        assert!(there_and_back.iter().zip(axis).all(|(a, b)| (a - b).abs() < ROUNDING));
    }
}

/// The points of an upright edge on all rows of the wild ride, from poses of small steps.
fn points_of_a_wild_ride(scene: &Scene, start_s: f64) -> Vec<EdgePoint> {
    let point = |row: u16| {
        let (position, rotation) = WILD.pose(start_s, start_s + scene.time_s(row));
        let in_camera = |v: Vector| [0, 1, 2].map(|axis| (0..3).map(|k| rotation[k][axis] * v[k]).sum::<f64>());
        let foot = [scene.bearing * scene.depth_m, 0.0, scene.depth_m];
        let a = in_camera([0, 1, 2].map(|axis| foot[axis] - position[axis]));
        let b = in_camera(scene.gravity);
        let w = (f64::from(row) - scene.cy) / scene.focal_px;
        let along = (w * a[2] - a[1]) / (b[1] - w * b[2]);
        let column = scene.cx + scene.focal_px * (a[0] + along * b[0]) / (a[2] + along * b[2]);
        EdgePoint::new(row, q16(column), (scene.time_s(row) * 1e9).round() as i64)
    };
    (0..scene.rows).map(point).collect()
}

/// Braking, yawing and nodding within the frame: with a sensor of 1 kHz the depth is right, with the twist of frame
/// start it is not.
#[test]
fn a_changing_motion_costs_no_depth_where_it_is_sampled() {
    // Second order in 1 ms, on a skew of a few pixels.
    const SAMPLED: f64 = 2e-5;
    // A fifth of the change of the velocity within a frame, which the twist misses together with that of the rotation
    // rate.
    const CONSTANT: f64 = 3e-3;
    let start_ns = 40 * MS;
    let start_s = seconds(start_ns);
    for (bearing, depth_m) in [(0.05, 2.0), (-0.3, 1.2), (0.2, 4.0)] {
        let scene = Scene { bearing, depth_m, gravity: [0.03, 0.9991, 0.03], ..Scene::vga() };
        let length = inner(scene.gravity, scene.gravity).sqrt();
        let scene = Scene { gravity: scene.gravity.map(|component| component / length), ..scene };
        let points = points_of_a_wild_ride(&scene, start_s);
        let mut trajectory: Trajectory<f64, 128> =
            Trajectory::new(TrajectoryConfig { gravity: Some(EXACT), ..streams(INSTANTS) });
        WILD.feed(&mut trajectory, 0, MS);
        trajectory.push_gravity(start_ns, scene.gravity).expect("sound");
        let motion: FrameMotion<'_, f64, 128> = trajectory.frame(start_ns, 0..=34 * MS).expect("covered");
        let setup = scene.setup_with(Uncertainty::NONE);
        let line = line_of::<64>(&points);
        let error = |inverse_depth: f64| (inverse_depth * depth_m - 1.0).abs();
        let found = error(Range::from_line(&setup, &motion, &line).estimate.inverse_depth_per_m);
        assert!(found < SAMPLED, "{found} at {depth_m} m");
        let twist = Twist::new((WILD.velocity_m_s)(start_s), (WILD.rate_rad_s)(start_s), scene.gravity);
        let constant = Range::from_line(&setup, &twist.expect("sound"), &line).estimate.inverse_depth_per_m;
        assert!(error(constant) > CONSTANT, "{} at {depth_m} m", error(constant));
    }
}

fn mirrored_velocity([x, y, z]: Vector) -> Vector {
    [-x, y, z]
}

fn mirrored_rate([x, y, z]: Vector) -> Vector {
    [x, -y, -z]
}

fn vectors(most: f64) -> impl Strategy<Value = Vec<Vector>> {
    prop::collection::vec([-most..most, -most..most, -most..most], 8)
}

proptest! {
    #![proptest_config(seeded(200))]

    #[test]
    fn mirrored_samples_give_mirrored_poses(velocities in vectors(5.0), rates in vectors(3.0), time_s in -0.05..0.1_f64) {
        let pose = |velocity: fn(Vector) -> Vector, rate: fn(Vector) -> Vector| {
            let mut trajectory: Trajectory<f64, 8> = Trajectory::new(streams(INSTANTS));
            for ((k, v), w) in (0..).zip(&velocities).zip(&rates) {
                trajectory.push_velocity(k * 20 * MS, velocity(*v)).expect("sound");
                trajectory.push_rate(k * 15 * MS, rate(*w)).expect("sound");
            }
            trajectory.frame(50 * MS, 0..=0).expect("covered").pose(time_s)
        };
        let (here, there) = (pose(|v| v, |w| w), pose(mirrored_velocity, mirrored_rate));
        prop_assert_eq!(mirrored_velocity(here.position_m), there.position_m);
        prop_assert_eq!(mirrored_rate(here.rate_rad_s), there.rate_rad_s);
        prop_assert_eq!(mirrored_velocity(here.rotate([1.0, 2.0, 3.0])), there.rotate([-1.0, 2.0, 3.0]));
    }
}

/// However far a camera turns, what it sees keeps its length: to two thousandths of a degree, and in fixed point and short
/// floats to as much.
#[test]
fn a_rotation_of_any_angle_keeps_lengths() {
    fn worst<S: Scalar>() -> f64 {
        let twist = Twist::new(numbers([0.0; 3]), numbers([300.0, -700.0, 500.0]), numbers([0.0, 1.0, 0.0]))
            .expect("a sound motion");
        let times = (0..60).map(|step| 1e-4 * 1.4_f64.powi(step));
        let rows = times.flat_map(|time_s| twist.pose(S::from_f64(time_s)).rotation);
        rows.map(|row: [S; 3]| row.iter().map(|part| part.to_f64().powi(2)).sum::<f64>())
            .fold(0.0, |worst: f64, square| worst.max((square - 1.0).abs()))
    }
    for (name, worst) in
        [("f64", worst::<f64>()), ("f32", worst::<f32>()), ("Micro", worst::<Micro>()), ("Q32", worst::<Q32>())]
    {
        println!("{name}: {worst:e}");
        assert!(worst < 4e-5, "{name}: {worst:e}");
    }
}
