//! Pixels and edge points to ranges without a way to panic: the board's program of this example contains no panic
//! routine, and its tables lie in memory that is zeroed at reset, not in flash; `.ci/no-panic` checks both in its
//! symbols. It prints nothing, because `core::fmt` can panic; its exit code tells how it went.
//!
//! Desktop: `cargo run --release --example no_panic`
//! Board (emulated Cortex-M4F): `cargo run --release --example no_panic --target thumbv7em-none-eabihf`
#![cfg_attr(target_os = "none", no_std, no_main)]

use shutter_range::{
    Camera, Distortion, EdgePoint, Intrinsics, LensBlur, Motion, MotionBlur, ParameterError, RangeStatus, Ranger,
    Readout, ReadoutDirection, SensorClock, Sequence, Setup, Sigmas, StampConvention, Trajectory, TrajectoryConfig,
    Twist, Uncertainty,
};

const ROWS: u16 = 120;
const COLUMNS: usize = 160;

/// A lens with distortion, and everything uncertain, so that all of the solver is linked.
fn setup() -> Result<Setup<f32>, ParameterError> {
    let lens = Distortion::from_opencv([-0.002, 0.0005, 0.00001, -0.00001, 0.0]);
    let camera = Camera::new(Intrinsics::centred(COLUMNS as u16, ROWS, 150.0), lens)?;
    let readout = Readout::from_frame_readout_ns(ROWS, 16_666_667, ReadoutDirection::TopToBottom)?;
    let uncertainty = Uncertainty::default()
        .with_sigma_gravity(0.001)
        .with_sigma_speed(0.01)
        .with_sigma_rate_rad_s(0.001)
        .with_sigma_readout(0.001)
        .with_sigma_focal(0.001);
    Setup::new(camera, readout)?.with_uncertainty(uncertainty)?.with_motion_blur(MotionBlur::from_exposure(0.001))
}

/// One row of a picture with a bright post that leans as a moving camera sees it.
fn paint(row: u16, pixels: &mut [u8]) {
    let left_q8 = (60 << 8) + 40 * u32::from(row);
    for (column, pixel) in pixels.iter_mut().enumerate() {
        let covered = ((column as u32) << 8).saturating_sub(left_q8).min(256);
        let noise = (column as u32 * 7919 + u32::from(row) * 104_729) % 5;
        *pixel = (40 + noise + ((covered * 150) >> 8)) as u8;
    }
}

/// Samples of odometry and an inertial sensor every 5 ms, from before the frame to its end.
fn drive() -> Trajectory<f32, 4> {
    let clock = SensorClock { offset_ns: -1_000_000, max_gap_ns: 10_000_000 };
    let velocity = StampConvention::MeanSincePrevious(clock);
    let mut trajectory = Trajectory::new(TrajectoryConfig {
        velocity,
        rate: Some(StampConvention::Instant(clock)),
        gravity: Some(clock),
    });
    for k in 0..6 {
        let _ = trajectory.push_velocity(k * 5_000_000, [-2.0, 0.0, 0.1]);
        let _ = trajectory.push_rate(k * 5_000_000, [0.0, 0.02, 0.0]);
        let _ = trajectory.push_gravity(k * 5_000_000, [0.0, 9.81, 0.0]);
    }
    trajectory
}

type Tables = Ranger<4, 6, 16>;

fn run(ranger: &mut Tables) -> Result<bool, ParameterError> {
    let setup = setup()?;
    let motion = Twist::new([-2.0_f32, 0.0, 0.1], [0.0, 0.02, 0.0], [0.0, 1.0, 0.0])?;
    let mut pixels = [0_u8; COLUMNS];
    let (mut from_pixels, mut from_points) = (false, false);
    for row in 0..ROWS {
        paint(row, &mut pixels);
        let _ = ranger.row(&setup, row, &pixels);
    }
    ranger.end_frame(&setup);
    while let Some(range) = ranger.next_range(&setup, &motion) {
        from_pixels |= range.estimate.inverse_depth_per_m > 0.0;
    }
    for row in 0..ROWS {
        let point = EdgePoint::new(row, (60 << 16) + 10_000 * i32::from(row), setup.readout().row_time_ns(row));
        let _ = ranger.edge_point(&setup, point);
    }
    ranger.end_frame(&setup);
    let trajectory = drive();
    let Ok(motion) = trajectory.frame(10_000_000, 0..=setup.readout().row_time_ns(ROWS)) else { return Ok(false) };
    let mut sequence: Sequence<f32, 2> = Sequence::new();
    let mut lens = LensBlur::new(MotionBlur::from_exposure(0.001));
    for _ in 0..2 {
        sequence.frame(&setup, &motion, ranger, |range| {
            from_points |= range.status == RangeStatus::Ok && range.distance(Sigmas(2.0)).farthest_m.is_some();
            lens.learn(&range);
        });
        sequence.advance(&setup, &motion.pose(0.017), 0.017, motion.gravity())?;
    }
    let setup = setup.with_motion_blur(lens.motion_blur())?;
    Ok(from_pixels && from_points && setup.motion_blur().is_some())
}

#[cfg(not(target_os = "none"))]
fn main() {
    std::process::exit(if run(&mut Tables::new()) == Ok(true) { 0 } else { 1 });
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    // `entry` hands the function a safe `&'static mut` to its statics.
    static mut TABLES: Tables = Tables::new();
    semihosting::process::exit(if run(TABLES) == Ok(true) { 0 } else { 1 })
}
