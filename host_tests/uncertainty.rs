//! What a setup states about speed, rotation, gravity, readout and focal length: each sigma against the error that the
//! same disturbance causes.

use rand::Rng;
use shutter_range::{
    Distortion, EdgePoint, Estimate, Intrinsics, Motion, Pose, Range, RangeStatus, Sample, Setup, Sigmas, Uncertainty,
    fit,
};

use crate::journey::{normal, seed};
use crate::projection::Scene;
use crate::scenes::{TENTH_DEGREE, line_of, q16, range_of, tilt_of};

/// A disturbance so small that its effect is linear.
const SMALL: f64 = 1e-3;
/// What the second order of a disturbance of [`SMALL`] may add, with tilt and depth as alike as they are in one frame.
const SECOND_ORDER: f64 = 0.03;

fn scene() -> Scene {
    Scene { velocity_m_s: [-1.2, 0.0, 0.7], rate_rad_s: [0.1, -0.3, 0.2], bearing: 0.15, ..Scene::vga() }
}

fn estimate(scene: &Scene, of: &Scene, uncertainty: Uncertainty<f64>) -> Estimate<f64> {
    range_of(scene, uncertainty, &of.points()).estimate
}

/// Sigma from the stated uncertainty alone, next to the change that the disturbance makes.
fn assert_explains(name: &str, uncertainty: Uncertainty<f64>, disturbed: &[Scene]) {
    let scene = scene();
    let plain = estimate(&scene, &scene, Uncertainty::NONE);
    let common = estimate(&scene, &scene, uncertainty);
    let sigma = (common.sigma_inverse_depth_per_m.powi(2) - plain.sigma_inverse_depth_per_m.powi(2)).sqrt();
    let changes = disturbed.iter().map(|other| {
        let moved = estimate(other, &scene, Uncertainty::NONE);
        moved.inverse_depth_per_m - plain.inverse_depth_per_m
    });
    let change = changes.map(|change| change * change).sum::<f64>().sqrt();
    assert!((sigma / change - 1.0).abs() < SECOND_ORDER, "{name}: sigma {sigma}, change {change}");
    // Rounding of the difference of two squares above.
    assert!((common.budget.correlated_per_m() / sigma - 1.0).abs() < 0.01, "{name}: all of it is common");
}

#[test]
fn sigma_explains_an_error_of_the_speed() {
    let faster = Scene { velocity_m_s: scene().velocity_m_s.map(|v| v * (1.0 + SMALL)), ..scene() };
    assert_explains("speed", Uncertainty::NONE.with_sigma_speed(SMALL), &[faster]);
}

#[test]
fn sigma_explains_an_error_of_the_rotation_rate() {
    let turned = |axis: usize| {
        let mut other = scene();
        other.rate_rad_s[axis] += SMALL;
        other
    };
    let uncertainty = Uncertainty::NONE.with_sigma_rate_rad_s(SMALL);
    assert_explains("rate", uncertainty, &[turned(0), turned(1), turned(2)]);
}

#[test]
fn sigma_explains_an_error_of_the_readout() {
    // The points' stamps are those of the true readout: scale time by scaling all rates.
    let scale = 1.0 + SMALL;
    let slower = Scene {
        velocity_m_s: scene().velocity_m_s.map(|v| v * scale),
        rate_rad_s: scene().rate_rad_s.map(|r| r * scale),
        ..scene()
    };
    assert_explains("readout", Uncertainty::NONE.with_sigma_readout(SMALL), &[slower]);
}

/// A wrong readout time moves the camera by its velocity at that time, not by its mean one.
#[test]
fn sigma_explains_an_error_of_the_readout_of_a_braking_camera() {
    struct Braking {
        time_scale: f64,
    }
    impl Motion<f64> for Braking {
        fn pose(&self, time_s: f64) -> Pose<f64> {
            let t = time_s * self.time_scale;
            let unturned = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            Pose {
                position_m: [-0.2 * t - 30.0 * t * t, 0.0, 0.0],
                rotation: unturned,
                velocity_m_s: [-0.2 - 60.0 * t, 0.0, 0.0],
                rate_rad_s: [0.0; 3],
            }
        }

        fn gravity(&self) -> [f64; 3] {
            [0.0, 1.0, 0.0]
        }
    }
    let scene = Scene::vga();
    let truth = Braking { time_scale: 1.0 };
    let samples: Vec<_> = (0..480)
        .step_by(10)
        .map(|row| {
            let [x, _, _] = truth.pose(scene.time_s(row)).position_m;
            Sample::point(scene.cx + scene.focal_px * (0.1 - x / 2.0), f64::from(row), scene.time_s(row), 0.1)
        })
        .collect();
    let estimate = |motion: &Braking, uncertainty| {
        fit::<f64, _, 48>(&scene.setup_with(uncertainty), motion, samples.iter().copied()).expect("sound")
    };
    let plain = estimate(&truth, Uncertainty::NONE);
    assert!((plain.inverse_depth_per_m - 0.5).abs() < 1e-9, "rounding");
    let wrong = estimate(&Braking { time_scale: 1.0 + SMALL }, Uncertainty::NONE);
    let change = (wrong.inverse_depth_per_m - plain.inverse_depth_per_m).abs();
    let sigma = estimate(&truth, Uncertainty::NONE.with_sigma_readout(SMALL)).budget.correlated_per_m();
    assert!((sigma / change - 1.0).abs() < SECOND_ORDER, "sigma {sigma}, change {change}");
}

#[test]
fn sigma_explains_an_error_of_the_focal_length() {
    let longer = Scene { focal_px: scene().focal_px * (1.0 + SMALL), ..scene() };
    assert_explains("focal", Uncertainty::NONE.with_sigma_focal(SMALL), &[longer]);
}

/// In roll and in pitch, where one frame cannot tell tilt from depth.
#[test]
fn sigma_explains_an_error_of_gravity() {
    let scene = Scene { bearing: 0.3, ..Scene::vga() };
    let changed = |gravity: [f64; 3]| {
        let other = Scene { gravity, ..scene.clone() };
        estimate(&other, &scene, Uncertainty::NONE).inverse_depth_per_m - 1.0 / scene.depth_m
    };
    let (roll, pitch) = (changed([SMALL, 1.0, 0.0]), changed([0.0, 1.0, SMALL]));
    let uncertainty = Uncertainty::NONE.with_sigma_gravity(SMALL);
    let sigma = estimate(&scene, &scene, uncertainty).sigma_inverse_depth_per_m;
    // Second order, and the points' own noise of 0.1 px, which is in sigma.
    assert!((sigma / roll.hypot(pitch) - 1.0).abs() < 0.05, "sigma {sigma}, roll {roll}, pitch {pitch}");
}

/// Before a camera at rest an edge has a bearing and a tilt and no depth: the bearing at y = 0 is what the line through
/// the points says there, which they do not reach.
#[test]
fn sigma_of_the_bearing_of_a_camera_at_rest_includes_tilt() {
    let scene = Scene { velocity_m_s: [0.0; 3], ..Scene::vga() };
    let points: Vec<_> = scene.points().into_iter().filter(|point| point.row >= 320).collect();
    for sigma_tilt in [0.0, 1e-5, 1e-3, 1.0] {
        let estimate = range_of::<f64>(&scene, tilt_of(sigma_tilt), &points).estimate;
        // Regression of u = a + β w over the points, with a prior on β.
        let bearings: Vec<_> = points.iter().map(|point| (f64::from(point.row) - scene.cy) / scene.focal_px).collect();
        let (count, per_sigma) = (bearings.len() as f64, scene.focal_px / 0.1);
        let mean = bearings.iter().sum::<f64>() / count;
        let about_mean = bearings.iter().map(|w| (w - mean).powi(2)).sum::<f64>();
        let information_of_tilt = about_mean * per_sigma * per_sigma + (sigma_tilt * sigma_tilt).recip();
        let of_tilt = if sigma_tilt > 0.0 { information_of_tilt.sqrt().recip() } else { 0.0 };
        let sigma = (count.sqrt() * per_sigma).recip().hypot(mean * of_tilt);
        // Knots of 16 rows instead of single points.
        assert!((estimate.sigma_bearing / sigma - 1.0).abs() < 0.01, "{sigma_tilt}: {estimate:?} for {sigma}");
        assert!((estimate.sigma_tilt - of_tilt).abs() <= 0.01 * of_tilt, "{sigma_tilt}: {estimate:?} for {of_tilt}");
        assert_eq!(estimate.status(), RangeStatus::Slow);
    }
}

/// At 15 m in the paper's set-up, 0.1° over a slope of 0.035 px per row is 0.75 m; 340 points of 0.1 px are worth 0.024
/// m.
#[test]
fn tilt_is_the_error_budget_of_the_paper() {
    let scene = Scene {
        columns: 1920,
        rows: 1080,
        focal_px: 2549.88,
        cx: 959.5,
        cy: 539.5,
        readout_s: 1.0 / 50.0,
        velocity_m_s: [-40.0 / 3.6, 0.0, 0.0],
        bearing: 0.0,
        depth_m: 15.0,
        ..Scene::vga()
    };
    // A rod of 2 m: 340 rows.
    let rod: Vec<_> = scene.points().into_iter().filter(|point| (370..710).contains(&point.row)).collect();
    let sigma_m = |uncertainty| range_of(&scene, uncertainty, &rod).depth(Sigmas(2.0)).estimate_m.expect("near").1;
    let (tilt, pixels): (f64, f64) = (sigma_m(tilt_of(TENTH_DEGREE)), sigma_m(Uncertainty::NONE));
    assert!((0.74..0.77).contains(&tilt), "{tilt}");
    assert!(pixels < 0.03, "{pixels}");
}

#[test]
fn a_line_and_its_samples_have_the_same_estimate() {
    let scene = scene();
    let setup = scene.setup::<f64>();
    let line = line_of::<16>(&scene.points());
    let by_line = Range::from_line(&setup, &scene.motion(), &line);
    let by_samples = fit::<f64, _, 16>(&setup, &scene.motion(), line.samples()).expect("a sound line");
    assert_eq!(by_line.estimate, by_samples);
}

/// The same edge through a distorting camera and its model.
#[test]
fn distortion_is_undone() {
    let scene = scene();
    let distortion = Distortion::from_opencv([-0.28, 0.09, 0.0008, -0.0005, -0.01]);
    let intrinsics = Intrinsics { cx: scene.cx, cy: scene.cy, ..Intrinsics::centred(640, 480, scene.focal_px) };
    let camera = shutter_range::Camera::new(intrinsics, distortion).expect("a real lens");
    let readout = *scene.setup::<f64>().readout();
    let setup = Setup::new(camera, readout).expect("sound").with_uncertainty(Uncertainty::NONE).expect("sound");
    let points: Vec<_> = (0..scene.rows).filter_map(|row| distorted_point(&scene, &camera, row)).collect();
    assert!(points.len() > 400, "most of the 480 rows");
    let range = Range::from_line(&setup, &scene.motion(), &line_of::<16>(&points));
    // Points of 1/65536 px, and what the curve of the lens costs within knots of 32 rows.
    assert!((range.estimate.inverse_depth_per_m * scene.depth_m - 1.0).abs() < 1e-4, "{range:?}");
    assert!((range.column_at_first_row - points[0].column_px::<f64>()).abs() < 2e-3);
}

/// However far the point itself is off: 60 px and very noisy, where the lens bends the row and the edge.
#[test]
fn the_columns_at_the_ends_are_those_of_the_fitted_edge() {
    let scene = Scene { bearing: 0.3, ..scene() };
    let distortion = Distortion::from_opencv([-0.28, 0.09, 0.0008, -0.0005, -0.01]);
    let intrinsics = Intrinsics { cx: scene.cx, cy: scene.cy, ..Intrinsics::centred(640, 480, scene.focal_px) };
    let camera = shutter_range::Camera::new(intrinsics, distortion).expect("a real lens");
    let readout = *scene.setup::<f64>().readout();
    let setup = Setup::new(camera, readout).expect("sound").with_uncertainty(Uncertainty::NONE).expect("sound");
    let exact: Vec<_> = (0..scene.rows).filter_map(|row| distorted_point(&scene, &camera, row)).collect();
    let mut points = exact.clone();
    let last = points.len() - 1;
    for (end, off_px) in [(0, 60.0), (last, -60.0)] {
        points[end].column_q16 += q16(off_px);
        points[end].sigma_q16 = EdgePoint::MAX_SIGMA_Q16;
    }
    let range = Range::from_line(&setup, &scene.motion(), &line_of::<16>(&points));
    // As in `distortion_is_undone`, with knots of noisy points left out of the fit in all but name.
    assert!((range.column_at_first_row - exact[0].column_px::<f64>()).abs() < 5e-3, "{range:?}");
    assert!((range.column_at_last_row - exact[last].column_px::<f64>()).abs() < 5e-3, "{range:?}");
}

/// The point where the edge crosses a *recorded* row, by bisection over the ideal row.
fn distorted_point(scene: &Scene, camera: &shutter_range::Camera<f64>, row: u16) -> Option<EdgePoint> {
    let time_s = scene.time_s(row);
    let recorded = |ideal_row: f64| {
        let u = (scene.column_at(ideal_row, time_s) - scene.cx) / scene.focal_px;
        camera.pixel(u, (ideal_row - scene.cy) / scene.focal_px)
    };
    let (mut above, mut below) = (-200.0, 700.0);
    for _ in 0..60 {
        let middle = 0.5 * (above + below);
        if recorded(middle).1 < f64::from(row) { above = middle } else { below = middle }
    }
    let (column, _) = recorded(above);
    (0.0..=639.0).contains(&column).then(|| scene.point_at(row, column))
}

/// For a level camera that moves sideways past an edge in the middle of the image.
#[test]
fn the_budget_is_as_the_table_of_its_documentation_says() {
    // The table's formulas are of first order, where the edge moves by up to 10 % of its depth within the frame.
    const FIRST_ORDER: f64 = 0.1;
    // The same, and knots of 32 rows instead of single ones.
    const FIRST_ORDER_OF_NOISE: f64 = 0.15;
    use shutter_range::ErrorSource::{Focal, Gravity, Lean, Noise, Rate, Readout, Speed};
    let none = Uncertainty::NONE;
    for depth_m in [0.5, 2.0, 8.0] {
        let scene = Scene { bearing: 0.0, depth_m, ..Scene::vga() };
        let (f, v, line_time) = (scene.focal_px, 1.5, scene.readout_s / f64::from(scene.rows));
        let skew = depth_m / (f * v * line_time);
        let cases = [
            (Lean, none.with_sigma_tilt(SMALL), SMALL * skew),
            (Gravity, none.with_sigma_gravity(SMALL), SMALL * skew),
            (Speed, none.with_sigma_speed(0.02), 0.02),
            (Rate, none.with_sigma_rate_rad_s(0.01), 0.01 * depth_m / v),
            (Readout, none.with_sigma_readout(0.02), 0.02),
            (Focal, none.with_sigma_focal(0.02), 0.02),
        ];
        for (source, uncertainty, relative) in cases {
            let estimate = estimate(&scene, &scene, uncertainty);
            let part = |of| estimate.budget.parts().into_iter().find(|(source, _)| *source == of).expect("a part").1;
            let found = part(source) * depth_m;
            assert!((found / relative - 1.0).abs() < FIRST_ORDER, "{source:?} at {depth_m} m: {found}, not {relative}");
            let rows = scene.visible_rows().len() as f64;
            let noise = 0.1 * (12.0 / rows.powi(3)).sqrt() * skew;
            assert!(
                (part(Noise) * depth_m / noise - 1.0).abs() < FIRST_ORDER_OF_NOISE,
                "noise at {depth_m} m: {} not {noise}",
                part(Noise)
            );
            assert_eq!(estimate.budget.dominant() == source, found > noise);
            let whole = estimate.budget.independent_per_m().hypot(estimate.budget.correlated_per_m());
            assert!((whole / estimate.sigma_inverse_depth_per_m - 1.0).abs() < 1e-6, "rounding of roots of squares");
        }
    }
}

/// A camera that moves along the edge knows its depth by the lean, and neither lean nor bearing well: what the prior of
/// the tilt does to the depth depends on where in this range the bearing is.
#[test]
fn the_budget_adds_up_where_the_bearing_is_hardly_known() {
    let random = &mut seed(83);
    let mut told = 0;
    for case in 0..200 {
        let scene = Scene {
            focal_px: 170.0,
            velocity_m_s: [0.0, random.random_range(1.0..9.0), 0.0],
            tilt: random.random_range(0.05..0.3),
            bearing: random.random_range(-0.4..0.4),
            ..Scene::vga()
        };
        let sigma_gravity = random.random_range(0.4..0.7);
        let noisy = |point: EdgePoint| {
            let column_q16 = point.column_q16 + q16(normal(random));
            EdgePoint { column_q16, ..point }.with_sigma_q16(q16(1.0) as u32)
        };
        let points: Vec<_> = scene.points().into_iter().step_by(4).map(noisy).collect();
        let uncertainty = Uncertainty::NONE.with_sigma_gravity(sigma_gravity).with_sigma_tilt(0.01);
        let Range { estimate, .. } = range_of::<f64>(&scene, uncertainty, &points);
        if estimate.sigma_inverse_depth_per_m < 1e5 {
            told += 1;
            let whole = estimate.budget.independent_per_m().hypot(estimate.budget.correlated_per_m());
            assert!((whole / estimate.sigma_inverse_depth_per_m - 1.0).abs() < 1e-6, "{case}: {estimate:?}");
        }
    }
    assert!(told > 40, "{told}");
}

/// A camera that looks up or down, and rolls: its pitch leans what is beside the axis by more.
#[test]
fn sigma_explains_an_error_of_gravity_of_a_camera_that_is_not_level() {
    for (pitch_deg, roll, bearing) in [(20.0, 0.0, 0.45), (40.0, 0.0, 0.45), (-40.0, 0.1, -0.45), (55.0, -0.1, 0.4)] {
        let (sine, cosine) = f64::to_radians(pitch_deg).sin_cos();
        let length = f64::hypot(1.0, roll);
        let [x, y, z] = [roll, cosine, sine].map(|part| part / length);
        let scene = Scene { gravity: [x, y, z], bearing, ..Scene::vga() };
        // So noisy that their curve does not tell the lean.
        let points: Vec<_> = scene.points().into_iter().map(|point| point.with_sigma_q16(q16(10.0) as u32)).collect();
        let estimate = |told: &Scene, uncertainty| range_of::<f64>(told, uncertainty, &points).estimate;
        // To the right of the image, and towards the scene.
        let flat = x.hypot(y);
        let across = [[y / flat, -x / flat, 0.0], [-(x * z) / flat, -(y * z) / flat, flat]];
        let changes = across.map(|way| {
            let changed = |step: f64| {
                let gravity = std::array::from_fn(|axis| scene.gravity[axis] + step * way[axis]);
                let told = Scene { gravity, ..scene.clone() };
                estimate(&told, Uncertainty::NONE).inverse_depth_per_m
            };
            (changed(SMALL) - changed(-SMALL)) / 2.0
        });
        let change = changes[0].hypot(changes[1]);
        let part = estimate(&scene, Uncertainty::NONE.with_sigma_gravity(SMALL)).budget.gravity_per_m;
        assert!((part / change - 1.0).abs() < SECOND_ORDER, "{pitch_deg} degrees: {part} for {changes:?}");
    }
}
