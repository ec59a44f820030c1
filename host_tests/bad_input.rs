//! Nonsense is refused by name, with its value and what would be right; nothing panics and nothing is NaN.

use proptest::prelude::*;
use shutter_range::{
    Camera, Distortion, EdgeError, EdgePoint, FitError, Intrinsics, Limits, Motion, ParameterError, Pose, Ranger,
    Readout, Sample, Sequence, Setup, Twist, Uncertainty, fit,
};

use crate::scenes::seeded;

use crate::projection::Scene;

const GOOD: Intrinsics<f64> = Intrinsics { columns: 640, rows: 480, fx: 600.0, fy: 600.0, cx: 319.5, cy: 239.5 };

fn camera(intrinsics: Intrinsics<f64>) -> ParameterError {
    Camera::new(intrinsics, Distortion::NONE).expect_err("nonsense")
}

#[test]
fn a_camera_refuses_nonsense_by_the_name_of_its_parameter() {
    for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -600.0, 1e9] {
        assert_eq!(camera(Intrinsics { fx: nonsense, ..GOOD }).parameter, "fx");
        assert_eq!(camera(Intrinsics { fy: nonsense, ..GOOD }).parameter, "fy");
    }
    for nonsense in [f64::NAN, f64::INFINITY, -1e4, 1e4] {
        assert_eq!(camera(Intrinsics { cx: nonsense, ..GOOD }).parameter, "cx");
        assert_eq!(camera(Intrinsics { cy: nonsense, ..GOOD }).parameter, "cy");
    }
    for nonsense in [0, 40_000] {
        assert_eq!(camera(Intrinsics { columns: nonsense, ..GOOD }).parameter, "columns");
        assert_eq!(camera(Intrinsics { rows: nonsense, ..GOOD }).parameter, "rows");
    }
    let bad_lens = Distortion { p2: f64::NAN, ..Distortion::NONE };
    assert_eq!(Camera::new(GOOD, bad_lens).expect_err("nonsense").parameter, "p2");
    let message = camera(Intrinsics { fx: -600.0, ..GOOD }).to_string();
    assert_eq!(message, "fx is -600, but must be 1 to 1000000 (focal length in pixels)");
}

#[test]
fn a_motion_refuses_nonsense_by_the_name_of_its_parameter() {
    let down = [0.0, 1.0, 0.0];
    for nonsense in [f64::NAN, f64::INFINITY, 2e6] {
        let vector = [0.0, nonsense, 0.0];
        assert_eq!(Twist::new(vector, [0.0; 3], down).expect_err("nonsense").parameter, "velocity_m_s");
        assert_eq!(Twist::new([0.0; 3], vector, down).expect_err("nonsense").parameter, "rate_rad_s");
        assert_eq!(Twist::new([0.0; 3], [0.0; 3], vector).expect_err("nonsense").parameter, "gravity");
    }
    assert_eq!(Twist::new([0.0; 3], [0.0; 3], [0.0; 3]).expect_err("no direction").parameter, "gravity");
    // An accelerometer's 9.81 m/s² is as good a direction as any, and so is what one of 16 bits counts.
    for length in [9.81, 1003.0, 32_767.0] {
        assert_eq!(Twist::new([0.0; 3], [0.0; 3], [0.0, length, 0.0]).map(|twist| twist.gravity()), Ok(down));
    }
}

#[test]
fn a_setup_refuses_nonsense_by_the_name_of_its_parameter() {
    let camera = Camera::new(GOOD, Distortion::NONE).expect("sound");
    let readout = |rows| Readout::from_line_time_ps(rows, 69_444_444, Default::default()).expect("sound");
    let parameter = |rows, uncertainty, limits| {
        let setup = Setup::new(camera, readout(rows)).and_then(|setup| setup.with_uncertainty(uncertainty));
        setup.and_then(|setup| setup.with_limits(limits)).expect_err("nonsense").parameter
    };
    assert_eq!(parameter(481, Uncertainty::NONE, Limits::DEFAULT), "rows of the readout");
    for sigma in [f64::NAN, -0.1, f64::INFINITY] {
        let uncertainty = Uncertainty::NONE.with_sigma_speed(sigma);
        assert_eq!(parameter(480, uncertainty, Limits::DEFAULT), "sigma_speed");
    }
    let limits = Limits::DEFAULT.with_confirm_points(1);
    assert_eq!(parameter(480, Uncertainty::NONE, limits), "confirm_points");
    let limits = Limits::DEFAULT.with_min_points(2);
    assert_eq!(parameter(480, Uncertainty::NONE, limits), "min_points");
    let limits = Limits::DEFAULT.with_gate_q16(u32::MAX);
    assert_eq!(parameter(480, Uncertainty::NONE, limits), "gate_q16");
}

#[test]
fn a_sequence_refuses_a_way_to_the_next_frame_that_cannot_be_by_its_name() {
    let setup = Setup::pinhole(640, 480, 600.0_f64, 33_300_000).expect("sound");
    let motion = Twist::level([1.0, 0.0, 0.0]).expect("sound");
    let pose = motion.pose(0.1);
    let advanced = |pose, elapsed_s, down| Sequence::<f64, 4>::new().advance(&setup, &pose, elapsed_s, down);
    let down = [0.0, 1.0, 0.0];
    assert_eq!(advanced(pose, 0.1, down), Ok(()));
    // Frames may be taken in any order.
    assert_eq!(advanced(pose, -0.1, down), Ok(()));
    for nonsense in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        let position = Pose { position_m: [0.0, nonsense, 0.0], ..pose };
        let rotation = Pose { rotation: [[1.0, 0.0, 0.0], [0.0, nonsense, 0.0], [0.0, 0.0, 1.0]], ..pose };
        let parameter = |pose, elapsed_s, down| advanced(pose, elapsed_s, down).expect_err("nonsense").parameter;
        assert_eq!(parameter(pose, nonsense, down), "elapsed_s");
        assert_eq!(parameter(position, 0.1, down), "position_m");
        assert_eq!(parameter(rotation, 0.1, down), "rotation");
        let velocity = Pose { velocity_m_s: [nonsense, 0.0, 0.0], ..pose };
        assert_eq!(parameter(velocity, 0.1, down), "velocity_m_s");
        let rate = Pose { rate_rad_s: [0.0, 0.0, nonsense], ..pose };
        assert_eq!(parameter(rate, 0.1, down), "rate_rad_s");
        assert_eq!(parameter(pose, 0.1, [0.0, nonsense, 0.0]), "gravity");
    }
}

#[test]
fn a_ranger_refuses_points_that_cannot_be_and_says_why() {
    let setup = Scene::vga().setup::<f64>();
    let mut ranger: Ranger<4, 8, 4> = Ranger::new();
    let outside = [(0, 641 << 16), (0, -(2 << 16)), (480, 5 << 16), (u16::MAX, 0), (0, i32::MAX), (0, i32::MIN)];
    for (row, column_q16) in outside {
        let refused = ranger.edge_point(&setup, EdgePoint::new(row, column_q16, 0));
        assert_eq!(refused, Err(EdgeError::OutsideImage { row, column_q16 }));
    }
    for sigma_q16 in [0, EdgePoint::MAX_SIGMA_Q16 + 1, u32::MAX] {
        let refused = ranger.edge_point(&setup, EdgePoint::new(3, 0, 0).with_sigma_q16(sigma_q16));
        assert_eq!(refused, Err(EdgeError::Sigma { row: 3, sigma_q16 }));
    }
    for time_ns in [i64::MIN, i64::MAX, 4_000_000_000_000] {
        assert_eq!(ranger.edge_point(&setup, EdgePoint::new(3, 0, time_ns)), Err(EdgeError::TimeRange { time_ns }));
    }
    assert_eq!(ranger.edge_point(&setup, EdgePoint::new(10, 1 << 16, 500)), Ok(()));
    let twice = Err(EdgeError::Duplicate { row: 10, column_q16: 1 << 16 });
    assert_eq!(ranger.edge_point(&setup, EdgePoint::new(10, 1 << 16, 500)), twice);
    assert_eq!(
        ranger.edge_point(&setup, EdgePoint::new(9, 1 << 16, 500)),
        Err(EdgeError::RowOrder { row: 9, previous: 10 })
    );
    assert_eq!(ranger.edge_point(&setup, EdgePoint::new(11, 1 << 16, 600)), Ok(()));
    assert_eq!(ranger.end_row(&setup, 480), Err(EdgeError::RowOrder { row: 480, previous: 11 }));
    assert_eq!(ranger.end_row(&setup, 10), Err(EdgeError::RowOrder { row: 10, previous: 11 }));
    ranger.end_frame(&setup);
    // A new frame begins anew.
    assert_eq!(ranger.edge_point(&setup, EdgePoint::new(0, 1 << 16, 0)), Ok(()));
}

#[test]
fn errors_read_like_sentences() {
    let order = EdgeError::RowOrder { row: 9, previous: 10 };
    assert_eq!(order.to_string(), "row 9 came after row 10: rows must come once, in the order of readout");
    let outside = EdgeError::OutsideImage { row: 3, column_q16: 641 << 16 };
    assert_eq!(outside.to_string(), "edge at row 3, column 641: outside the image");
}

#[test]
fn a_fit_refuses_samples_that_cannot_be_and_says_which() {
    let scene = Scene::vga();
    let (setup, motion) = (scene.setup::<f64>(), scene.motion());
    let sample = |row: u16| Sample::point(scene.column(row), f64::from(row), scene.time_s(row), 0.1);
    let fit_of = |samples: &[Sample<f64>]| fit::<f64, _, 8>(&setup, &motion, samples.iter().copied());
    assert_eq!(fit_of(&[]), Err(FitError::TooFewSamples(0)));
    assert_eq!(fit_of(&[sample(0)]), Err(FitError::TooFewSamples(1)));
    assert!(fit_of(&[sample(0), sample(100)]).is_ok());
    assert_eq!(fit_of(&(0..9).map(sample).collect::<Vec<_>>()), Err(FitError::TooManySamples));
    for nonsense in [f64::NAN, f64::INFINITY] {
        for broken in [
            Sample { column_px: nonsense, ..sample(5) },
            Sample { row_px: nonsense, ..sample(5) },
            Sample { time_s: nonsense, ..sample(5) },
            Sample { sigma_px: nonsense, ..sample(5) },
            Sample { sigma_px: 0.0, ..sample(5) },
        ] {
            assert_eq!(fit_of(&[sample(0), broken]), Err(FitError::InvalidSample(1)));
        }
    }
    // All at one place and time: the motion says nothing, and no number is NaN.
    let nothing = fit_of(&[sample(7); 5]).expect("sound, if useless");
    assert_eq!(nothing.sigma_inverse_depth_per_m, 1e6);
    assert!(nothing.bearing.is_finite() && nothing.correlation.is_finite());
}

proptest! {
    #![proptest_config(seeded(300))]

    /// No panic, and every number that comes out is finite.
    #[test]
    fn any_stream_of_points_gives_finite_numbers(
        points in proptest::collection::vec((0..500_u16, -50_000_000..50_000_000_i32, any::<i64>(), any::<u32>(), any::<bool>()), 0..300),
        velocity in proptest::array::uniform3(-100.0..100.0_f64),
        sorted in any::<bool>(),
        stamped in any::<bool>(),
    ) {
        let scene = Scene::vga();
        let setup = scene.setup_with(Uncertainty::<f32>::default());
        let motion = Twist::level(velocity.map(|v| v as f32)).expect("finite");
        let mut points = points;
        if sorted {
            points.sort();
        }
        let mut ranger: Ranger<4, 4, 4> = Ranger::new();
        for (row, column_q16, time_ns, sigma_q16, end) in points {
            let time_ns = if stamped { time_ns % 3_600_000_000_000 } else { setup.readout().row_time_ns(row) };
            // Refusals are answers here.
            let _ = ranger.edge_point(&setup, EdgePoint::new(row, column_q16, time_ns).with_sigma_q16(sigma_q16));
            if end {
                let _ = ranger.end_row(&setup, row);
            }
        }
        ranger.end_frame(&setup);
        while let Some(range) = ranger.next_range(&setup, &motion) {
            let e = range.estimate;
            let numbers = [
                e.bearing, e.inverse_depth_per_m, e.tilt, e.sigma_bearing, e.sigma_inverse_depth_per_m, e.sigma_tilt,
                e.correlation, e.distance_per_depth, e.misfit, range.column_at_first_row,
            ];
            prop_assert!(numbers.iter().all(|number| number.is_finite()), "{range:?}");
            prop_assert!(e.sigma_inverse_depth_per_m >= 0.0 && e.correlation.abs() <= 1.0);
        }
    }
}
