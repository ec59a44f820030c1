//! Motion blur as a measurement: in a single frame it tells lean from depth, and several frames tell the lens's own.

use rand::Rng;
use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator};
use shutter_range::{
    EdgePoint, ErrorSource, LensBlur, Motion, MotionBlur, Q32, Range, RangeStatus, Ranger, ReadoutDirection, Response,
    Scalar, Sequence, Setup, Sigmas, Twist,
};

use crate::journey::seed;
use crate::projection;
use crate::scenes::{HALF_DEGREE, TENTH_DEGREE, line_of, tilt_of};

const EXPOSURE_S: f32 = 0.008;

type WideRanger = Ranger<16, 16, 64>;

/// VGA at 2 m: a bar 12 cm wide that leans, before a camera that moves at 1.5 m/s.
struct Shot {
    scene: Scene<1>,
    setup: Setup<f32>,
    motion: Twist<f32>,
    exposure: Exposure,
    seed: u64,
}

impl Shot {
    fn new(lean: f64, seed: u64) -> Self {
        let mut scene = Scene::new(Background::plain(180.0)).expect("sound background");
        scene.push(Bar::upright(0.05, 2.0, 0.12, 70.0).leaning(lean as f32)).expect("a sound bar");
        let world = projection::Scene::vga();
        let setup = world.setup_read(tilt_of(HALF_DEGREE), ReadoutDirection::TopToBottom);
        let exposure = Exposure { time_s: EXPOSURE_S, ..Exposure::default() };
        Self { scene, setup, motion: world.motion(), exposure, seed }
    }

    fn with(self, blur: MotionBlur<f32>) -> Self {
        Self { setup: self.setup.with_response(Response::Linear).with_motion_blur(blur).expect("sound blur"), ..self }
    }

    /// A ranger that has taken one of the frames.
    fn taken(&self, frame: u32, interval_s: f64) -> WideRanger {
        let (camera, readout) = (self.setup.camera(), self.setup.readout());
        let simulator = Simulator::new(&self.scene, camera, readout, &self.motion, self.exposure, self.seed);
        let start_ns = (f64::from(frame) * interval_s * 1e9).round() as i64;
        let simulator = simulator.expect("sound parameters").at_frame(frame, start_ns);
        let mut ranger = WideRanger::new();
        let mut pixels = vec![0; usize::from(camera.intrinsics().columns)];
        for row in 0..readout.rows() {
            simulator.row(row, &mut pixels);
            ranger.row(&self.setup, row, &pixels).expect("rows in order");
        }
        ranger.end_frame(&self.setup);
        ranger
    }

    fn ranges(&self) -> Vec<Range<f32>> {
        self.taken(0, 0.0).ranges(&self.setup, &self.motion)
    }
}

/// Error of the inverse depth of a bar 2 m away: relative, and in sigmas.
fn errors(range: &Range<f32>) -> (f64, f64) {
    let estimate = &range.estimate;
    let error = f64::from(estimate.inverse_depth_per_m) - 0.5;
    (error / 0.5, error / f64::from(estimate.sigma_inverse_depth_per_m))
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt()
}

/// An edge that leans by half a degree, which its position alone takes for a quarter of the depth.
#[test]
fn blur_tells_lean_from_depth_in_one_frame() {
    let known = MotionBlur::from_calibrated_lens(EXPOSURE_S, Exposure::default().psf_sigma_px);
    let unknown = MotionBlur::from_exposure(EXPOSURE_S);
    // The lens leaves 2 · 0.7 px · 0.035 px of the variance of 1.65 px² open, or 2 · 0.75 px · 0.144 px where it is
    // unknown, and the shape 2 % of it. A path of B = 3.6 px makes that 2.7 or 10 % of the inverse depth: over 2 ·
    // B²/12.
    for (name, blur, part, stated) in [("lens known", known, 0.1, 0.04), ("lens unknown", unknown, 0.25, 0.12)] {
        let (mut alone, mut fused, mut normal) = (Vec::new(), Vec::new(), Vec::new());
        for seed in 0..20 {
            let lean = if seed % 2 == 0 { HALF_DEGREE } else { -HALF_DEGREE };
            alone.extend(Shot::new(lean, seed).ranges().iter().map(|range| errors(range).0));
            for range in Shot::new(lean, seed).with(blur).ranges() {
                assert_eq!(range.status, RangeStatus::Ok, "{range:?}");
                let sigma = range.estimate.sigma_inverse_depth_per_m / range.estimate.inverse_depth_per_m;
                assert!(f64::from(sigma) < stated, "{name}: {sigma}");
                fused.push(errors(&range).0);
                normal.push(errors(&range).1);
            }
        }
        assert_eq!((alone.len(), fused.len()), (40, 40));
        println!("{name}: {:.3} alone, {:.4} with blur, {:.2} sigma", rms(&alone), rms(&fused), rms(&normal));
        // Half a degree over a slope of 0.031 px per row is 28 %, of which half at least must be there to be told.
        assert!(rms(&alone) > 0.15, "{}", rms(&alone));
        // A tenth is the README's 3 % where the lens is known. Unknown, it leaves 10 of 28 % in sigma; it is 0.05 px
        // off here.
        assert!(rms(&fused) < part * rms(&alone), "{name}: {} of {}", rms(&fused), rms(&alone));
        // One, and two sigma of an RMS over 40 errors (1/√80).
        assert!(rms(&normal) < 1.2, "{name}: {} sigma", rms(&normal));
        assert!(normal.iter().all(|error| error.abs() < 3.0), "three sigma, {name}: {normal:?}");
    }
}

/// Where the lens is not known, it dominates; where it is, it does not.
#[test]
fn the_budget_names_the_lens_only_where_its_blur_is_unknown() {
    let dominant = |blur| Shot::new(0.0, 1).with(blur).ranges().first().expect("a range").estimate.budget.dominant();
    assert_eq!(dominant(MotionBlur::from_exposure(EXPOSURE_S)), ErrorSource::Lens);
    assert_ne!(
        dominant(MotionBlur::from_calibrated_lens(EXPOSURE_S, 0.7).with_sigma_lens_blur_px(0.001)),
        ErrorSource::Lens
    );
}

/// With a free tilt the depth comes from the blur alone: from the path B in a variance of lens² + 1/12 + B²/12.
#[test]
fn what_lens_and_shape_leave_open_is_in_the_sigma() {
    const LENS_PX: f64 = 0.7;
    let scene = projection::Scene { bearing: 0.0, ..projection::Scene::vga() };
    let path_px = 600.0 * 1.5 / 2.0 * f64::from(EXPOSURE_S);
    let variance_px2 = LENS_PX * LENS_PX + (1.0 + path_px * path_px) / 12.0;
    let width_q8 = (variance_px2.sqrt() * 256.0).round() as u16;
    // 0.01 px of noise, so that the widths' own counts for nothing.
    let point = |point| EdgePoint { width_q8, sigma_q16: 655, ..point };
    let points: Vec<_> = scene.points().into_iter().map(point).collect();
    for sigma_lens_px in [0.001, 0.035, 0.144] {
        let blur = MotionBlur::from_calibrated_lens(f64::from(EXPOSURE_S), LENS_PX);
        let blur = blur.with_sigma_lens_blur_px(sigma_lens_px).with_sigma_blur(0.01);
        let setup = scene.setup_with::<f64>(tilt_of(1.0)).with_motion_blur(blur).expect("sound blur");
        let range = Range::from_line(&setup, &scene.motion(), &line_of::<16>(&points));
        // Each as a part of the inverse depth; 1 % of the width is 2 % of its variance.
        let per_variance = 1.0 / (2.0 * path_px * path_px / 12.0);
        let (lens, shape) = (2.0 * LENS_PX * sigma_lens_px * per_variance, 0.02 * variance_px2 * per_variance);
        let estimate = &range.estimate;
        assert_eq!(range.status, RangeStatus::Ok, "{range:?}");
        // The noise of the widths' mean, a tenth of the shape's part, and what second order a path of 3.6 px has.
        let stated = estimate.sigma_inverse_depth_per_m / estimate.inverse_depth_per_m;
        assert!((stated / lens.hypot(shape) - 1.0).abs() < 0.05, "{sigma_lens_px} px: {stated}, {lens}, {shape}");
        let part_of_lens = estimate.budget.lens_per_m / estimate.inverse_depth_per_m;
        assert!((part_of_lens / lens - 1.0).abs() < 0.05, "{sigma_lens_px} px: {part_of_lens} for {lens}");
    }
}

/// What an unknown camera does to widths it does to all edges: they may refuse a slope, but draw no depth aside.
#[test]
fn an_unknown_pipeline_draws_no_depth_aside() {
    let scene = projection::Scene { bearing: 0.0, ..projection::Scene::vga() };
    let path_px = 600.0 * 1.5 / 2.0 * f64::from(EXPOSURE_S);
    let width_px = (0.75_f64.powi(2) + (1.0 + path_px * path_px) / 12.0).sqrt();
    let blur = MotionBlur::from_exposure(f64::from(EXPOSURE_S));
    let setup = scene.setup_with::<f64>(tilt_of(3.0 * TENTH_DEGREE));
    let range = |setup: &Setup<f64>, factor: f64| {
        let width_q8 = (factor * width_px * 256.0).round() as u16;
        let points: Vec<_> = scene.points().into_iter().map(|point| EdgePoint { width_q8, ..point }).collect();
        Range::from_line(setup, &scene.motion(), &line_of::<16>(&points))
    };
    let with = |blur: MotionBlur<f64>| setup.with_motion_blur(blur).expect("sound blur");
    let without = range(&setup, 1.0);
    for factor in [0.6, 0.75, 1.0, 1.4] {
        for unknown in [with(blur), with(blur).with_response(Response::Srgb), with(blur.with_sigma_blur(0.25))] {
            let range = range(&unknown, factor);
            assert_eq!((range.status, range.estimate), (RangeStatus::Ok, without.estimate), "{factor}");
        }
        // Trusted a little better than that it has a say, and its factor with it: halfway to what it says at most.
        let trusted = range(&with(blur.with_sigma_blur(0.2)), factor).estimate;
        let ratio = trusted.inverse_depth_per_m / without.estimate.inverse_depth_per_m;
        let drawn = if factor == 1.0 { (ratio - 1.0).abs() < 0.005 } else { (ratio < 0.98) == (factor < 1.0) };
        assert!(drawn && (0.7..1.4).contains(&ratio), "{factor}: {ratio}");
        assert!(trusted.sigma_inverse_depth_per_m < without.estimate.sigma_inverse_depth_per_m, "{factor}");
    }
    // The sharpness of an edge at rest, in a line that is skewed as by a path of three pixels: four sigma and more.
    let sharp = range(&with(blur), 0.15);
    assert_eq!((sharp.status, sharp.estimate), (RangeStatus::Leaning, without.estimate));
}

/// From the second frame on the depth is known without the blur, so the blur tells the lens.
#[test]
fn a_sequence_learns_the_lens() {
    let interval_s = 0.04;
    for psf_sigma_px in [0.55, 0.7, 0.95] {
        let mut lens = LensBlur::new(MotionBlur::from_exposure(EXPOSURE_S));
        let before = lens.motion_blur().sigma_lens_blur_px;
        let mut sequence = Sequence::<f32, 8>::new();
        for frame in 0..4 {
            let mut shot = Shot::new(HALF_DEGREE, 3).with(lens.motion_blur());
            shot.exposure.psf_sigma_px = psf_sigma_px;
            let mut ranger = shot.taken(frame, interval_s);
            sequence.frame(&shot.setup, &shot.motion, &mut ranger, |range| lens.learn(&range));
            let pose = shot.motion.pose(interval_s as f32);
            sequence.advance(&shot.setup, &pose, interval_s as f32, shot.motion.gravity()).expect("sound gravity");
        }
        let MotionBlur { lens_blur_px, sigma_lens_blur_px, .. } = lens.motion_blur();
        println!("{psf_sigma_px} px: {lens_blur_px} +- {sigma_lens_blur_px} px");
        // `LensBlur` begins at 0.144 px; a twentieth of the blur, 0.05 px at most, is the floor that it stops at.
        assert!(sigma_lens_blur_px < before / 1.5, "{sigma_lens_blur_px}");
        assert!(
            (lens_blur_px - psf_sigma_px).abs() < 2.5 * sigma_lens_blur_px,
            "2.5 sigma, {psf_sigma_px}: {lens_blur_px}"
        );
    }
}

/// The points of an edge with the widths that the projection's own path during the exposure gives them.
fn blurred(scene: &projection::Scene, exposure_s: f64, lens_px: f64) -> Vec<EdgePoint> {
    let blurred = |point: EdgePoint| {
        let (row, time_s) = (f64::from(point.row), scene.time_s(point.row));
        let end = |later_s: f64| scene.column_at(row, time_s + later_s);
        let path_px = end(exposure_s / 2.0) - end(-exposure_s / 2.0);
        let width_px = (lens_px * lens_px + (1.0 + path_px * path_px) / 12.0).sqrt();
        // 0.01 px of noise.
        EdgePoint { width_q8: (width_px * 256.0).round() as u16, sigma_q16: 655, ..point }
    };
    scene.points().into_iter().map(blurred).collect()
}

/// A path is as long as speed, rotation and focal length make it: what is wrong with these draws a depth aside that
/// rests on its blur, as much as one that rests on its slope.
#[test]
fn sigma_explains_errors_that_the_blur_shares() {
    // Relative, or in rad/s, and what its second order and widths in steps of 1/256 px add.
    const STEP: f64 = 1e-3;
    const SECOND_ORDER: f64 = 0.05;
    let (exposure_s, random) = (f64::from(EXPOSURE_S), &mut seed(81));
    let blur = MotionBlur::from_calibrated_lens(exposure_s, 0.7);
    for case in 0..40 {
        let mut about = |middle: f64, off: f64| middle + random.random_range(-off..off);
        let scene = projection::Scene {
            velocity_m_s: [about(-1.5, 0.3), about(0.0, 0.2), about(0.0, 0.4)],
            rate_rad_s: [about(0.0, 0.2), about(0.0, 0.2), about(0.0, 0.2)],
            bearing: about(0.0, 0.2),
            depth_m: about(1.5, 0.7),
            ..projection::Scene::vga()
        };
        let line = line_of::<16>(&blurred(&scene, exposure_s, 0.7));
        let range = |told: &projection::Scene, uncertainty| {
            let setup = told.setup_with::<f64>(uncertainty).with_response(Response::Linear);
            Range::from_line(&setup.with_motion_blur(blur).expect("sound blur"), &told.motion(), &line)
        };
        let change = |disturb: &dyn Fn(&mut projection::Scene, f64)| {
            let [more, less] = [STEP, -STEP].map(|step| {
                let mut told = scene.clone();
                disturb(&mut told, step);
                range(&told, tilt_of(10.0 * TENTH_DEGREE)).estimate.inverse_depth_per_m
            });
            (more - less) / 2.0
        };
        let speed = change(&|told, step| told.velocity_m_s = told.velocity_m_s.map(|v| v * (1.0 + step)));
        let focal = change(&|told, step| told.focal_px *= 1.0 + step);
        let rates = [0, 1, 2].map(|axis| change(&|told, step| told.rate_rad_s[axis] += step));
        let uncertainty = tilt_of(10.0 * TENTH_DEGREE).with_sigma_speed(STEP).with_sigma_focal(STEP);
        let Range { status, estimate, .. } = range(&scene, uncertainty.with_sigma_rate_rad_s(STEP));
        assert_eq!(status, RangeStatus::Ok, "{case}: {estimate:?}");
        // The slope alone leaves this depth to 20 % or more: it rests on the blur.
        assert!(estimate.budget.noise_per_m < 0.05 * estimate.inverse_depth_per_m, "{case}: {estimate:?}");
        let rate = rates.iter().fold(0.0, |sum: f64, rate| sum.hypot(*rate));
        let budget = &estimate.budget;
        let parts = [(speed, budget.speed_per_m), (focal, budget.focal_per_m), (rate, budget.rate_per_m)];
        for (name, (change, part)) in ["speed", "focal", "rate"].into_iter().zip(parts) {
            // What cancels counts as half of what an error of the speed does.
            let most = SECOND_ORDER * change.abs().max(0.5 * speed.abs());
            assert!((part - change.abs()).abs() < most, "{case}, {name}: {part} for a change of {change}");
        }
    }
}

/// A post that leans exactly against its skew stands still in the image: its blur alone tells that it is near.
#[test]
fn a_lean_that_hides_the_motion_is_no_lower_bound() {
    let scene = |depth_m: f64, speed_m_s: f64, tilt: f64| projection::Scene {
        velocity_m_s: [-speed_m_s, 0.0, 0.0],
        bearing: 0.0,
        depth_m,
        tilt,
        ..projection::Scene::vga()
    };
    let range = |scene: &projection::Scene, points: &[EdgePoint], exposure_s, response: Response| {
        let setup = scene.setup_with::<f64>(tilt_of(TENTH_DEGREE)).with_response(response);
        let setup = setup.with_motion_blur(MotionBlur::from_calibrated_lens(exposure_s, 0.7)).expect("sound blur");
        Range::from_line(&setup, &scene.motion(), &line_of::<16>(points))
    };
    for response in [Response::Unknown, Response::Linear] {
        for (depth_m, speed_m_s, exposure_s) in
            [(1.0, 1.5, 0.012), (1.0, 3.0, 0.012), (1.0, 3.0, 0.02), (2.0, 4.0, 0.02)]
        {
            // A lean of β moves the column by β f for each f rows.
            let upright = scene(depth_m, speed_m_s, 0.0);
            let slope = (upright.column(479) - upright.column(0)) / 479.0;
            let hidden = scene(depth_m, speed_m_s, -slope);
            let range = range(&hidden, &blurred(&hidden, exposure_s, 0.7), exposure_s, response);
            assert_eq!(range.status, RangeStatus::Leaning, "{response:?}, {speed_m_s} m/s: {range:?}");
            assert_eq!(range.depth(Sigmas(2.0)).nearest_m, None);
        }
        // What is far has the blur of the lens, and may be a little out of focus.
        for (depth_m, lens_px) in [(60.0, 0.7), (200.0, 0.7), (1000.0, 0.8), (1000.0, 0.6)] {
            let far = scene(depth_m, 1.5, 0.0);
            let range = range(&far, &blurred(&far, 0.008, lens_px), 0.008, response);
            assert_eq!(range.status, RangeStatus::Far, "{response:?}, {depth_m} m: {range:?}");
        }
    }
}

/// So long a path is no straight one: its blur tells nothing, in no type of number.
#[test]
fn a_turn_within_the_exposure_tells_nothing() {
    fn assert_tells<S: Scalar>(name: &str, rate_rad_s: f64, exposure_s: f64, tells: bool) {
        let scene = projection::Scene { focal_px: 160.0, ..projection::Scene::vga() };
        let points: Vec<_> = scene.points().into_iter().map(|point| EdgePoint { width_q8: 768, ..point }).collect();
        let line = line_of::<16>(&points);
        let blur = MotionBlur::from_calibrated_lens(S::from_f64(exposure_s), S::from_f64(0.7));
        let setup = scene.setup_with::<S>(tilt_of(TENTH_DEGREE)).with_motion_blur(blur).expect("sound blur");
        for rates in [[1.0, 1.0, 1.0], [0.0, 0.0, 1.7], [1.2, -1.2, 0.0]] {
            let turning = projection::Scene { rate_rad_s: rates.map(|rate| rate * rate_rad_s), ..scene.clone() };
            let motion = turning.motion::<S>();
            let (usual, without) =
                (Range::from_line(&setup, &motion, &line), Range::without_blur(&setup, &motion, &line));
            assert_eq!(usual.lens_blur.is_some(), tells, "{name}, {rates:?}: {usual:?}");
            assert_eq!(usual.estimate, without.estimate, "{name}, {rates:?}");
            assert!(tells || usual.status == without.status, "{name}, {rates:?}: {usual:?}");
        }
    }
    // Half of the turn is 1.7 or 3.4 radians, and a twentieth of one.
    for (rate_rad_s, exposure_s, tells) in [(20.0, 0.1, false), (20.0, 0.2, false), (3.0, 0.02, true)] {
        assert_tells::<f64>("f64", rate_rad_s, exposure_s, tells);
        assert_tells::<f32>("f32", rate_rad_s, exposure_s, tells);
        assert_tells::<Q32>("Q32", rate_rad_s, exposure_s, tells);
    }
}
