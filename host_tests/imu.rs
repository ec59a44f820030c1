//! The offset of a gyroscope's clock and the direction of down, from upright edges before a camera that turns.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use shutter_range::calibrate::{ImuCalibration, ImuEstimate, ImuRefusal};
use shutter_range::{
    EdgePoint, Line, Scalar, SensorClock, Setup, StampConvention, Trajectory, TrajectoryConfig, Uncertainty,
};

const ROWS: u16 = 240;
const FOCAL_PX: f64 = 300.0;
const READOUT_NS: u64 = 30_000_000;
const STEP_S: f64 = 0.002;

/// A camera that swings before edges far away, and what its gyroscope tells.
#[derive(Clone, Copy)]
struct Swing {
    /// Of the clock: camera time is stamp plus offset.
    offset_s: f64,
    /// Gravity in the camera's axes beside (0, 1, 0).
    roll: f64,
    pitch: f64,
    /// Amplitude of the yaw, in radians, and its frequency.
    yaw: f64,
    frequency_hz: f64,
    /// Noise of the columns in pixels, of the rates in rad/s, and lean of each edge.
    sigma_px: f64,
    sigma_rate: f64,
    sigma_lean: f64,
    frames: u32,
    /// So many of the edges are no upright ones.
    leaning: usize,
    seed: u64,
}

const SWING: Swing = Swing {
    offset_s: 0.007,
    roll: 0.012,
    pitch: -0.02,
    yaw: 0.25,
    frequency_hz: 1.0,
    sigma_px: 0.05,
    sigma_rate: 0.002,
    sigma_lean: 0.001_745,
    frames: 60,
    leaning: 0,
    seed: 1,
};

impl Swing {
    /// Angle and rate of the yaw about gravity, right-handed.
    fn angle(&self, time_s: f64) -> f64 {
        let turned = std::f64::consts::TAU * self.frequency_hz * time_s;
        self.yaw * (turned.sin() + 0.2 * (2.3 * turned).sin())
    }

    fn rate(&self, time_s: f64) -> f64 {
        (self.angle(time_s + 1e-5) - self.angle(time_s - 1e-5)) / 2e-5
    }

    fn down(&self) -> [f64; 3] {
        let length = (1.0 + self.roll * self.roll + self.pitch * self.pitch).sqrt();
        [self.roll / length, 1.0 / length, self.pitch / length]
    }

    /// Turns a direction about gravity.
    fn turned(&self, [x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
        let [a, b, c] = self.down();
        let along = a * x + b * y + c * z;
        let across = [b * z - c * y, c * x - a * z, a * y - b * x];
        let (sine, cosine) = angle.sin_cos();
        let part = |v: f64, w: f64, d: f64| v * cosine + w * sine + d * along * (1.0 - cosine);
        [part(x, across[0], a), part(y, across[1], b), part(z, across[2], c)]
    }

    /// Points of an edge at an azimuth (about gravity, from the optical axis), with its lean, in the frame that starts
    /// at a time.
    fn points(&self, azimuth: f64, lean: f64, start_s: f64, random: &mut StdRng) -> Vec<EdgePoint> {
        let [a, b, c] = self.down();
        // A horizontal direction straight ahead, turned to the azimuth; the edge's plane contains it and the edge's
        // direction.
        let ahead = [-a * c, -b * c, 1.0 - c * c];
        let foot = self.turned(ahead, azimuth);
        let side = cross([a, b, c], foot);
        let along = [a - lean * side[0], b - lean * side[1], c - lean * side[2]];
        let normal = cross(foot, along);
        let mut points = Vec::new();
        for row in 0..ROWS {
            let time_ns = (u64::from(row) * READOUT_NS / u64::from(ROWS)) as i64;
            // The camera has turned by an angle; in its axes the world has turned back.
            let [nx, ny, nz] = self.turned(normal, -self.angle(start_s + time_ns as f64 * 1e-9));
            let w = (f64::from(row) - 119.5) / FOCAL_PX;
            let column_px = 159.5 + FOCAL_PX * -(ny * w + nz) / nx;
            let noise: f64 = random.sample(StandardNormal);
            if (0.0..=319.0).contains(&column_px) {
                let column_q16 = ((column_px + self.sigma_px * noise) * 65536.0).round() as i32;
                points.push(EdgePoint::new(row, column_q16, time_ns).with_sigma_q16((self.sigma_px * 65536.0) as u32));
            }
        }
        points
    }

    /// The gyroscope's samples around a frame, for an assumed offset, as axes of the camera have them.
    fn gyroscope<S: Scalar>(
        &self,
        start_s: f64,
        assumed_s: f64,
        gravity: [f64; 3],
        axis_sign: f64,
    ) -> Trajectory<S, 64> {
        let clock = SensorClock { offset_ns: (assumed_s * 1e9).round() as i64, max_gap_ns: 20_000_000 };
        let mut trajectory = Trajectory::new(TrajectoryConfig {
            velocity: StampConvention::Instant(SensorClock { offset_ns: 0, max_gap_ns: 1_000_000_000 }),
            rate: Some(StampConvention::Instant(clock)),
            gravity: Some(SensorClock { offset_ns: 0, max_gap_ns: 1_000_000_000 }),
        });
        let number = S::from_f64;
        let first = ((start_s - 0.06) * 200.0).floor() as i64;
        for index in first..first + 40 {
            // In the gyroscope's clock, which is behind by the true offset.
            let stamp_s = index as f64 / 200.0;
            let mut random = StdRng::seed_from_u64(self.seed ^ (index.unsigned_abs() << 8));
            let rate = axis_sign * self.rate(stamp_s + self.offset_s);
            let rates = self.down().map(|part| part * rate + self.sigma_rate * random.sample::<f64, _>(StandardNormal));
            trajectory.push_rate((stamp_s * 1e9).round() as i64, rates.map(number)).expect("stamps rise");
            if index == first || index == first + 39 {
                let at_ns = ((start_s + if index == first { -0.03 } else { 0.06 }) * 1e9) as i64;
                trajectory.push_velocity(at_ns, [S::ZERO; 3]).expect("stamps rise");
                trajectory.push_gravity(at_ns, gravity.map(number)).expect("stamps rise");
            }
        }
        trajectory
    }

    /// A pass over all frames with an assumed offset and gravity.
    fn pass<S: Scalar>(
        &self,
        assumed_s: f64,
        gravity: [f64; 3],
        axis_sign: f64,
    ) -> Result<ImuEstimate<S>, ImuRefusal<S>> {
        let number = S::from_f64;
        let lean = number(self.sigma_lean.max(1e-4));
        let mut calibration =
            ImuCalibration::<S, 8>::new(gravity.map(number), number(STEP_S), lean).expect("sound parameters");
        let setup = Setup::<S>::pinhole(320, ROWS, number(FOCAL_PX), READOUT_NS).expect("a setup");
        // The mean of six samples, and some more.
        let rate = number(0.001_f64.min(0.5 * self.sigma_rate));
        let setup = setup.with_uncertainty(Uncertainty::NONE.with_sigma_rate_rad_s(rate)).expect("sigmas");
        let mut random = StdRng::seed_from_u64(self.seed);
        let mut leans: Vec<f64> = (0..5).map(|_| self.sigma_lean * random.sample::<f64, _>(StandardNormal)).collect();
        leans.iter_mut().zip([0.36, -0.84]).take(self.leaning).for_each(|(lean, more)| *lean += more);
        for frame in 0..self.frames {
            let start_s = 1.0 + f64::from(frame) / 15.0;
            let gyroscopes = [-STEP_S, 0.0, STEP_S]
                .map(|step_s| self.gyroscope::<S>(start_s, assumed_s + step_s, gravity, axis_sign));
            let start_ns = (start_s * 1e9).round() as i64;
            let frames = gyroscopes
                .each_ref()
                .map(|gyroscope| gyroscope.frame(start_ns, 0..=READOUT_NS as i64).expect("no gap"));
            for (index, lean) in leans.iter().enumerate() {
                let azimuth = 0.35 * (index as f64 - 2.0) + 0.03;
                let points = self.points(azimuth, *lean, start_s, &mut random);
                if points.len() < 100 {
                    continue;
                }
                let mut line: Line<16> = Line::new(points[0]);
                points[1..].iter().for_each(|point| line.push(*point).expect("rows in order"));
                calibration.line(&setup, frames.each_ref(), index as u32, &line).expect("a line");
            }
        }
        calibration.estimate()
    }

    /// As a user does it: once more with the offset and the gravity that were found.
    fn calibrate(&self, from_s: f64) -> Result<(f64, ImuEstimate<f64>), ImuRefusal<f64>> {
        let (mut offset_s, mut gravity) = (from_s, LEVEL);
        for _ in 0..2 {
            let found = self.pass::<f64>(offset_s, gravity, 1.0)?;
            (offset_s, gravity) = (offset_s + found.time_offset_s, found.gravity);
        }
        Ok((offset_s, self.pass(offset_s, gravity, 1.0)?))
    }
}

const LEVEL: [f64; 3] = [0.0, 1.0, 0.0];

/// Roll and pitch of a gravity.
fn angles([x, y, z]: [f64; 3]) -> [f64; 2] {
    [x / y, z / y]
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

#[test]
fn offset_roll_and_pitch_are_found() {
    for seed in 1..=4 {
        let (offset_s, found) = Swing { seed, ..SWING }.calibrate(0.0).expect("an estimate");
        println!("{:.5} ± {:.5} s, {found:?}", offset_s, found.sigma_time_offset_s);
        assert!((offset_s - SWING.offset_s).abs() < 0.001 && found.sigma_time_offset_s < 0.0005, "{offset_s}");
        let [roll, pitch] = angles(found.gravity);
        assert!((roll - SWING.roll).abs() < 0.003 && (pitch - SWING.pitch).abs() < 0.001, "{:?}", found.gravity);
        assert!(found.roll_rad.abs() < 1e-4 && found.pitch_rad.abs() < 1e-4, "settled: {found:?}");
    }
}

/// 95.4 %, with some four sigma of a share of 100 on the lower side: offset, roll, pitch.
#[test]
fn two_sigma_hold_what_they_say() {
    let runs = 100;
    let mut within = [0; 3];
    for seed in 1..=runs {
        let mut random = StdRng::seed_from_u64(seed + 1000);
        let swing = Swing {
            offset_s: random.random_range(-0.01..0.01),
            roll: random.random_range(-0.02..0.02),
            pitch: random.random_range(-0.02..0.02),
            frames: 30,
            seed,
            ..SWING
        };
        let (offset_s, found) = swing.calibrate(swing.offset_s).expect("an estimate");
        let [roll, pitch] = angles(found.gravity);
        let off = [
            (offset_s - swing.offset_s) / found.sigma_time_offset_s,
            (roll - swing.roll) / found.sigma_roll_rad,
            (pitch - swing.pitch) / found.sigma_pitch_rad,
        ];
        within.iter_mut().zip(off).for_each(|(within, off)| *within += u32::from(off.abs() <= 2.0));
    }
    let shares = within.map(|within| f64::from(within) / runs as f64);
    println!("{shares:?}");
    assert!(shares.iter().all(|share| (0.88..=0.99).contains(share)), "{shares:?}");
}

/// A camera at rest: roll and pitch as well, and an offset of which nothing is known.
#[test]
fn at_rest_there_is_roll_and_no_offset() {
    let found = Swing { yaw: 0.0, sigma_rate: 0.0, ..SWING }.pass::<f64>(0.0, LEVEL, 1.0).expect("an estimate");
    assert!((found.roll_rad - SWING.roll).abs() < 2.5 * found.sigma_roll_rad, "{found:?}");
    assert!((found.pitch_rad - SWING.pitch).abs() < 2.5 * found.sigma_pitch_rad, "{found:?}");
    assert!(found.sigma_roll_rad < 0.002 && found.sigma_time_offset_s > 0.09, "{found:?}");
}

/// A gyroscope whose sign is wrong sees the edges lean as nothing else explains.
#[test]
fn a_wrong_sign_is_inconsistent() {
    let refusal = SWING.pass::<f64>(SWING.offset_s, LEVEL, -1.0).expect_err("the wrong sign");
    assert!(matches!(refusal, ImuRefusal::Inconsistent { .. }), "{refusal}");
}

/// Two of five edges lean by some 20 and 40°: they are no upright ones.
#[test]
fn leaning_bars_are_left_out() {
    let upright = SWING.calibrate(0.0).expect("an estimate").1;
    let (offset_s, found) = Swing { leaning: 2, ..SWING }.calibrate(0.0).expect("an estimate");
    assert!(found.lines_left_out > 20 && found.lines < upright.lines, "{found:?}");
    assert!((offset_s - SWING.offset_s).abs() < 0.001, "{offset_s}");
    let few = Swing { frames: 1, ..SWING }.pass::<f64>(0.0, LEVEL, 1.0);
    assert!(matches!(few, Err(ImuRefusal::TooFewLines(1..=5))), "{few:?}");
}

#[test]
fn back_ends_agree() {
    let exact = SWING.pass::<f64>(0.006, LEVEL, 1.0).expect("an estimate");
    let single = SWING.pass::<f32>(0.006, LEVEL, 1.0).expect("an estimate");
    let off = |single: f32, exact: f64, sigma: f64| (f64::from(single) - exact).abs() / sigma;
    assert!(off(single.time_offset_s, exact.time_offset_s, exact.sigma_time_offset_s) < 0.2, "{single:?}");
    assert!(off(single.roll_rad, exact.roll_rad, exact.sigma_roll_rad) < 0.2, "{single:?}");
    assert!(off(single.pitch_rad, exact.pitch_rad, exact.sigma_pitch_rad) < 0.2, "{single:?}");
}

#[test]
fn parameters_are_checked() {
    let level = [0.0, 1.0, 0.0];
    for (gravity, step_s, lean, name) in [
        ([0.0; 3], 0.01, 0.01, "gravity"),
        ([0.0, 0.0, 1.0], 0.01, 0.01, "gravity"),
        ([0.0, f64::NAN, 1.0], 0.01, 0.01, "gravity"),
        (level, 0.0, 0.01, "step_s"),
        (level, 1.0, 0.01, "step_s"),
        (level, 0.01, 0.0, "sigma_lean"),
        (level, 0.01, f64::INFINITY, "sigma_lean"),
    ] {
        assert_eq!(ImuCalibration::<f64, 4>::new(gravity, step_s, lean).expect_err("refused").parameter, name);
    }
}
