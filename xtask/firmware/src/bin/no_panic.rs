//! The whole public data path without a way to panic: `.ci/no-panic` finds no panic routine in this program's symbols.
//! It prints nothing, because `core::fmt` can panic; its exit code tells how it went.
#![no_std]
#![no_main]

use core::hint::black_box;

use shutter_range::format::Compact;
use shutter_range::rse::{Endpoint, Shear, range_of_endpoints};
use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator, Texture};
use shutter_range::{
    Camera, Distortion, EdgePoint, Intrinsics, LensBlur, Line, Micro, Motion, MotionBlur, ParameterError, Q32, Range,
    RangeStatus, Ranger, Readout, ReadoutDirection, Response, Sample, Scalar, Scanner, SensorClock, Sequence, Setup,
    Sigmas, StampConvention, Strict, Trajectory, TrajectoryConfig, Translation, Twist, Uncertainty, fit,
};

const ROWS: u16 = 96;
const COLUMNS: u16 = 128;

type Tables = Ranger<6, 8, 24>;

budget_firmware::program!(run);

fn run() {
    let ranger = &mut Tables::new();
    let failed = [
        failed_part::<f32>(ranger),
        failed_part::<f64>(ranger),
        failed_part::<Micro>(ranger),
        failed_part::<Q32>(ranger),
    ];
    if let Some((back_end, part)) = (1..).zip(failed).find(|(_, part)| *part > 0) {
        semihosting::process::exit(10 * back_end + part);
    }
}

fn number<S: Scalar>(numerator: i32, denominator: i32) -> S {
    S::ratio(black_box(numerator), black_box(denominator))
}

/// A lens with distortion, and everything uncertain, so that all of the solver is linked.
fn setup<S: Scalar>(is_distorted: bool) -> Result<Setup<S>, ParameterError> {
    let lens = [-2, 1, 0, 0, 0].map(|thousandths| number(thousandths, 1000));
    let lens = if is_distorted { Distortion::from_opencv(lens) } else { Distortion::NONE };
    let camera = Camera::new(Intrinsics::centred(COLUMNS, ROWS, number(120, 1)), lens)?;
    let readout = Readout::from_frame_readout_ns(ROWS, black_box(33_300_000), ReadoutDirection::TopToBottom)?;
    let uncertainty = Uncertainty::default()
        .with_sigma_gravity(number(1, 1000))
        .with_sigma_speed(number(1, 100))
        .with_sigma_rate_rad_s(number(1, 1000))
        .with_sigma_readout(number(1, 1000))
        .with_sigma_time_s(number(1, 10_000))
        .with_sigma_focal(number(1, 1000));
    Setup::new(camera, readout)?
        .with_uncertainty(uncertainty)?
        .with_response(Response::Linear)
        .with_motion_blur(MotionBlur::from_exposure(number(1, 1000)))
}

fn motion<S: Scalar>() -> Result<Twist<S>, ParameterError> {
    let velocity = [number(-2, 1), S::ZERO, number(1, 10)];
    Twist::new(velocity, [S::ZERO, number(2, 100), S::ZERO], [S::ZERO, S::ONE, number(1, 100)])
}

/// The number of the part that has not done its work; zero where all have.
fn failed_part<S: Scalar>(ranger: &mut Tables) -> i32 {
    let (Ok(setup), Ok(motion)) = (setup::<S>(black_box(true)), motion()) else { return 1 };
    let parts = [
        pixels(ranger, &setup, &motion),
        small(&setup),
        points(ranger, &setup, &motion),
        Ok(by_hand(&setup, &motion)),
        equations::<S>(),
    ];
    (2..).zip(parts).find(|(_, went_well)| *went_well != Ok(true)).map_or(0, |(part, _)| part)
}

/// Rows of the simulator: whole frames, torn ones, refused rows; ranges, lines, and what the scanner finds on its own.
fn pixels<S: Scalar>(ranger: &mut Tables, setup: &Setup<S>, motion: &Twist<S>) -> Result<bool, ParameterError> {
    let texture = Texture { contrast: black_box(5.0), cell: 0.05, seed: 1 };
    let mut scene = Scene::<3>::new(Background::textured(200.0, texture))?;
    scene.push(Bar::upright(black_box(0.0), 1.0, 0.2, 40.0))?;
    scene.push(Bar::upright(black_box(0.3), 2.0, 0.1, 60.0).leaning(0.2).between(-1.0, 1.0).rough(0.001, 0.1, 1))?;
    let camera = Setup::pinhole(COLUMNS, ROWS, black_box(120.0_f32), 33_300_000)?;
    let of_camera = Twist::level([black_box(-2.0_f32), 0.0, 0.1])?;
    let exposure = Exposure::default();
    let simulator = Simulator::new(&scene, camera.camera(), camera.readout(), &of_camera, exposure, 1)?;
    let truths = simulator.truth().count();
    let mut row_of_pixels = [0_u8; COLUMNS as usize];
    let mut scanner = Scanner::new();
    let (mut scanned, mut ranged) = (0_u32, 0_u32);
    for frame in 0..3_u32 {
        let simulator = simulator.clone().at_frame(frame, i64::from(frame) * 40_000_000);
        for row in 0..ROWS {
            simulator.row(row, &mut row_of_pixels);
            scanner.scan(&row_of_pixels, |point| scanned += u32::from(point.column_q16 > 0));
            let _ = ranger.row(setup, black_box(row), &row_of_pixels);
            while let Some(range) = ranger.next_range(setup, motion) {
                ranged += u32::from(range.estimate.inverse_depth_per_m.is_finite());
            }
        }
        match black_box(frame) {
            1 => ranger.tear(),
            // A row that is refused, which tears the frame as well.
            2 => ranger.row(setup, 7, row_of_pixels.get(..black_box(10)).unwrap_or(&[])).unwrap_or(()),
            _ => {}
        }
        ranger.end_frame(setup);
        while let Some(line) = ranger.next_line() {
            ranged += u32::from(Range::from_line(setup, motion, &line).points > 0);
        }
    }
    Ok(truths > 0 && scanned > 0 && ranged > 0 && ranger.counters().stray_points > 0)
}

/// What small programs use: rows that are only scanned or compact, lines and ranges that are not repaired.
#[inline(never)]
fn small<S: Scalar>(setup: &Setup<S>) -> Result<bool, ParameterError> {
    let motion = Translation::level([number(-2, 1), S::ZERO, number(1, 10)])?;
    let (mut ranger, mut ranged): (Ranger<4, 8, 8, Strict>, _) = (Ranger::strict(), 0_u32);
    for frame in 0..2 {
        for row in 0..ROWS {
            let mut pixels = [black_box(60_u8); COLUMNS as usize];
            let from = 40 + usize::from(row) / 8;
            pixels.get_mut(from..from + 24).into_iter().flatten().for_each(|pixel| *pixel = 180);
            let _ = if black_box(frame) == 0 {
                ranger.scanned_row(setup, black_box(row), &pixels)
            } else {
                ranger.row(setup, black_box(row), Compact(&pixels))
            };
        }
        ranger.end_frame(setup);
        while let Some(line) = ranger.next_line() {
            let ranges = [Range::strict(setup, &motion, &line), Range::without_blur(setup, &motion, &line)];
            ranged += ranges.iter().filter(|range| range.estimate.inverse_depth_per_m.is_finite()).count() as u32;
        }
    }
    Ok(ranged >= 8)
}

/// Edge points: rows in order and not, ends of rows, a sequence under a trajectory.
fn points<S: Scalar>(ranger: &mut Tables, setup: &Setup<S>, motion: &Twist<S>) -> Result<bool, ParameterError> {
    let trajectory = drive();
    let window_ns = 0..=setup.readout().row_time_ns(ROWS);
    let Ok(frame_motion) = trajectory.frame(black_box(10_000_000), window_ns) else { return Ok(false) };
    let mut sequence: Sequence<S, 3> = Sequence::new();
    let mut lens = LensBlur::new(MotionBlur::from_exposure(number(1, 1000)));
    let interval_s = number(1, 30);
    let mut sound = 0_u32;
    for _ in 0..2 {
        stream(ranger, setup);
        let mut take = |range: Range<S>| {
            let near = range.depth(Sigmas(number(2, 1))).nearest_m.is_some();
            let far = range.distance(Sigmas(number(2, 1))).farthest_m.is_some();
            sound += u32::from(near || far || range.status == RangeStatus::Ok);
            lens.learn(&range);
        };
        sequence.frame(setup, &frame_motion, ranger, &mut take);
        sequence.advance(setup, &frame_motion.pose(interval_s), interval_s, frame_motion.gravity())?;
        let lines = [line(setup, 20), line(setup, 60)];
        sequence.lines(setup, motion, &lines, &mut take);
        sequence.advance(setup, &motion.pose(interval_s), interval_s, motion.gravity())?;
    }
    sequence.clear();
    let setup = setup.clone().with_motion_blur(lens.motion_blur())?;
    Ok(sound > 0 && sequence.landmarks() == 0 && setup.motion_blur().is_some())
}

fn point<S: Scalar>(setup: &Setup<S>, row: u16, column: i32) -> EdgePoint {
    let column_q16 = black_box((column << 16) + 9_000 * i32::from(row));
    EdgePoint::new(row, column_q16, setup.readout().row_time_ns(row))
}

fn stream<S: Scalar>(ranger: &mut Tables, setup: &Setup<S>) {
    for row in 0..ROWS {
        for column in [30, 70] {
            let _ = ranger.edge_point(setup, point(setup, black_box(row), column));
        }
        let _ = ranger.end_row(setup, row);
    }
    // Out of order, and beside the image.
    let _ = ranger.edge_point(setup, point(setup, black_box(3), 30));
    let _ = ranger.edge_point(setup, point(setup, black_box(3), 3000));
    ranger.end_frame(setup);
}

fn line<S: Scalar>(setup: &Setup<S>, column: i32) -> Line<8> {
    let mut line = Line::new(point(setup, 0, column));
    for row in 1..ROWS {
        let _ = line.push(point(setup, black_box(row), column));
    }
    line
}

/// Samples of odometry and an inertial sensor every 5 ms; more than there is room for.
fn drive<S: Scalar>() -> Trajectory<S, 12> {
    let clock = SensorClock { offset_ns: black_box(-1_000_000), max_gap_ns: 10_000_000 };
    let mut trajectory = Trajectory::new(TrajectoryConfig {
        velocity: StampConvention::MeanSincePrevious(clock),
        rate: Some(StampConvention::Instant(clock)),
        gravity: Some(clock),
    });
    for k in 0..14 {
        let stamp_ns = black_box(k * 5_000_000);
        let _ = trajectory.push_velocity(stamp_ns, [number(-2, 1), S::ZERO, number(1, 10)]);
        let _ = trajectory.push_rate(stamp_ns, [S::ZERO, number(2, 100), S::ZERO]);
        let _ = trajectory.push_gravity(stamp_ns, [S::ZERO, number(981, 100), S::ZERO]);
    }
    trajectory
}

/// A line and samples of one's own.
fn by_hand<S: Scalar>(setup: &Setup<S>, motion: &Twist<S>) -> bool {
    let line = line(setup, 40);
    let range = Range::from_line(setup, motion, &line);
    let budget = range.estimate.budget;
    let parts = budget.parts().iter().filter(|(_, part)| *part >= S::ZERO).count();
    let is_stated = budget.independent_per_m() >= S::ZERO && budget.correlated_per_m() >= S::ZERO;
    let of_samples = fit::<_, _, 8>(setup, motion, line.samples());
    let by_one =
        fit::<_, _, 8>(setup, motion, [Sample::point(number(3, 1), number(4, 1), number(1, 100), number(1, 10))]);
    let _ = black_box(budget.dominant());
    parts > 0 && is_stated && of_samples.is_ok() && by_one.is_err()
}

/// The paper's equations, and two ends of an edge.
fn equations<S: Scalar>() -> Result<bool, ParameterError> {
    let shear: Shear<S> = Shear::oblique(number(2361, 1000), number(1, 10), number(3, 10));
    let depth_m =
        shear.depth_m(shear.angle_rad(number(5, 1), number(10, 1), number(1, 50)), number(10, 1), number(1, 50));
    let end = |w, u, hundredths| Endpoint { u, w, time_s: number(hundredths, 100), sigma: number(1, 1000) };
    let ends = [end(number(-1, 3), number(1, 10), 0), end(number(1, 3), number(11, 100), 2)];
    let [first, last] = ends;
    let estimate = range_of_endpoints(first, last, [number(-2, 1), S::ZERO, S::ZERO], number(2, 1000))?;
    // The shortest trigonometry is good to a few per cent.
    Ok((depth_m - number(5, 1)).abs() < number(1, 2) && estimate.inverse_depth_per_m > S::ZERO)
}
