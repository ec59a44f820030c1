//! The run whose bits are the same everywhere: every range that it gives is printed into a hash.

use core::fmt::{self, Debug, Write};

use crate::job::{Job, Source};
use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator, Texture};
use shutter_range::{
    Motion, MotionBlur, Range, Ranger, Response, Scalar, SensorClock, Sequence, Setup, StampConvention, Trajectory,
    TrajectoryConfig, Twist,
};

/// The parts of the run, in its order.
pub const PARTS: [&str; 4] = ["frames", "reference edges", "sequence", "trajectory"];

/// FNV-1a of what is printed.
struct Digest(u64);

impl Digest {
    const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn byte(&mut self, byte: u8) {
        self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }

    /// All of its fields, to the last bit: floating point is printed so that it can be read back.
    fn add(&mut self, value: &impl Debug) {
        // Writing into a hash does not fail.
        let _ = write!(self, "{value:?}");
    }
}

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.bytes().for_each(|byte| self.byte(byte));
        Ok(())
    }
}

/// The digests of all [`PARTS`].
pub fn run<S: Scalar + Debug>(job: &mut Job<impl Source>) -> [u64; PARTS.len()] {
    [frames::<S>(), reference_edges::<S>(job), sequence::<S>(job), trajectory::<S>(job)]
}

/// Pixels of the simulator, and their ranges.
fn frames<S: Scalar>() -> u64 {
    let mut digest = Digest::new();
    let blur = MotionBlur::from_calibrated_lens(S::ratio(2, 1000), S::ratio(7, 10));
    let setup = Setup::pinhole(320, 240, S::from_i32(300), 33_300_000)
        .and_then(|setup| setup.with_response(Response::Linear).with_motion_blur(blur))
        .expect("a sound setup");
    let camera = Setup::pinhole(320, 240, 300.0_f32, 33_300_000).expect("a sound setup");
    let velocity = [S::ratio(-3, 2), S::ZERO, S::ratio(1, 4)];
    let motion = Twist::level(velocity).expect("a sound motion");
    let of_camera = Twist::level([-1.5_f32, 0.0, 0.25]).expect("a sound motion");
    let texture = Texture { contrast: 20.0, cell: 0.03, seed: 3 };
    let mut scene = Scene::<4>::new(Background::textured(170.0, texture)).expect("a sound background");
    for bar in [
        Bar::upright(-0.25, 1.0, 0.12, 60.0),
        Bar::upright(0.0, 2.0, 0.1, 40.0).leaning(0.003),
        Bar::upright(0.2, 3.0, 0.2, 90.0).between(-0.6, 0.5),
        Bar::upright(0.3, 4.0, 0.1, 220.0).leaning(0.3),
    ] {
        scene.push(bar).expect("room for it");
    }
    let exposure = Exposure { time_s: 0.002, psf_sigma_px: 0.7, read_noise: 2.5, shot_gain: 0.03 };
    let simulator =
        Simulator::new(&scene, camera.camera(), camera.readout(), &of_camera, exposure, 1).expect("a sound simulator");
    let mut ranger: Ranger<16, 16, 64> = Ranger::new();
    let mut pixels = [0; 320];
    for row in 0..240 {
        simulator.row(row, &mut pixels);
        pixels.iter().for_each(|pixel| digest.byte(*pixel));
        ranger.row(&setup, row, &pixels).expect("rows in order");
        while let Some(range) = ranger.next_range(&setup, &motion) {
            digest.add(&range);
        }
    }
    ranger.end_frame(&setup);
    while let Some(range) = ranger.next_range(&setup, &motion) {
        digest.add(&range);
    }
    digest.add(ranger.counters());
    digest.0
}

/// Lines of which each has a camera and a motion of its own.
fn reference_edges<S: Scalar>(job: &mut Job<impl Source>) -> u64 {
    let mut digest = Digest::new();
    for _ in 0..job.u16() {
        let (setup, motion): (Setup<S>, Twist<S>) = (job.setup(), job.twist());
        digest.add(&Range::from_line(&setup, &motion, &job.line()));
    }
    digest.0
}

/// Frames of edge points.
fn sequence<S: Scalar>(job: &mut Job<impl Source>) -> u64 {
    let mut digest = Digest::new();
    let mut ranger: Ranger<16, 16, 64> = Ranger::new();
    let mut sequence: Sequence<S, 16> = Sequence::new();
    let setup: Setup<S> = job.setup();
    let mut motion = job.twist();
    let interval_s = S::from_ratio(setup.readout().row_time_ns(setup.readout().rows()), 1_000_000_000);
    for _ in 0..job.u16() {
        for _ in 0..setup.readout().rows() {
            for _ in 0..job.u16() {
                ranger.edge_point(&setup, job.point()).expect("rows in order");
            }
        }
        ranger.end_frame(&setup);
        sequence.frame(&setup, &motion, &mut ranger, |range| digest.add(&range));
        let pose = motion.pose(interval_s);
        motion = job.twist();
        sequence.advance(&setup, &pose, interval_s, motion.gravity()).expect("sound gravity");
    }
    digest.0
}

/// Lines under a motion that is made of samples.
fn trajectory<S: Scalar>(job: &mut Job<impl Source>) -> u64 {
    let mut digest = Digest::new();
    let clock = SensorClock { offset_ns: -1_000_000, max_gap_ns: 10_000_000 };
    let mut trajectory: Trajectory<S, 12> = Trajectory::new(TrajectoryConfig {
        velocity: StampConvention::MeanSincePrevious(clock),
        rate: Some(StampConvention::Instant(clock)),
        gravity: Some(clock),
    });
    for k in 0..12 {
        let (stamp_ns, part) = (i64::from(k) * 5_000_000, |unit| S::ratio(k, unit));
        let samples = [
            trajectory.push_velocity(stamp_ns, [S::ratio(-3, 2) - part(50), part(100), part(40)]),
            trajectory.push_rate(stamp_ns, [part(300), S::ratio(-1, 4) + part(90), part(200)]),
            trajectory.push_gravity(stamp_ns, [S::ratio(1, 2), S::ratio(98, 10), part(20)]),
        ];
        samples.into_iter().for_each(|sample| sample.expect("stamps in order"));
    }
    let setup: Setup<S> = job.setup();
    let window_ns = 0..=setup.readout().row_time_ns(setup.readout().rows());
    let motion = trajectory.frame(10_000_000, window_ns).expect("samples around the frame");
    for _ in 0..job.u16() {
        digest.add(&Range::from_line(&setup, &motion, &job.line()));
    }
    digest.0
}
