//! Motion blur as a measurement: in a single frame it tells lean from depth, and several frames tell the lens's own.

use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator};
use shutter_range::{
    ErrorSource, LensBlur, Motion, MotionBlur, Range, RangeStatus, Ranger, ReadoutDirection, Response, Sequence, Setup,
    Twist,
};

use crate::projection;
use crate::scenes::{TENTH_DEGREE, tilt_of};

const HALF_DEGREE: f64 = 5.0 * TENTH_DEGREE;
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

    /// A ranger that has seen one of the frames.
    fn seen(&self, frame: u32, interval_s: f64) -> WideRanger {
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
        self.seen(0, 0.0).ranges(&self.setup, &self.motion)
    }
}

/// Error of the inverse depth of a bar 2 m away: relative, and in sigmas.
fn errors(range: &Range<f32>) -> (f64, f64) {
    let estimate = &range.estimate;
    let off = f64::from(estimate.inverse_depth_per_m) - 0.5;
    (off / 0.5, off / f64::from(estimate.sigma_inverse_depth_per_m))
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt()
}

/// An edge that leans by half a degree, which its position alone takes for a quarter of the depth.
#[test]
fn blur_tells_lean_from_depth_in_one_frame() {
    let known = MotionBlur::from_calibrated_lens(EXPOSURE_S, Exposure::default().psf_sigma_px);
    let unknown = MotionBlur::from_exposure(EXPOSURE_S);
    // The relative sigma is what an unknown lens leaves open, a good third of what the position alone does.
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
        assert!(rms(&alone) > 0.15, "{}", rms(&alone));
        assert!(rms(&fused) < part * rms(&alone), "{name}: {} of {}", rms(&fused), rms(&alone));
        assert!(rms(&normal) < 1.2, "{name}: {} sigma", rms(&normal));
        assert!(normal.iter().all(|off| off.abs() < 3.0), "{name}: {normal:?}");
    }
}

/// Where the lens is not known, it dominates; where it is, it does not.
#[test]
fn the_budget_names_the_lens() {
    let dominant = |blur| Shot::new(0.0, 1).with(blur).ranges().first().expect("a range").estimate.budget.dominant();
    assert_eq!(dominant(MotionBlur::from_exposure(EXPOSURE_S)), ErrorSource::Lens);
    assert_ne!(
        dominant(MotionBlur::from_calibrated_lens(EXPOSURE_S, 0.7).with_sigma_lens_blur_px(0.001)),
        ErrorSource::Lens
    );
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
            let mut ranger = shot.seen(frame, interval_s);
            sequence.frame(&shot.setup, &shot.motion, &mut ranger, |range| lens.learn(&range));
            let pose = shot.motion.pose(interval_s as f32);
            sequence.advance(&shot.setup, &pose, interval_s as f32, shot.motion.gravity()).expect("sound gravity");
        }
        let MotionBlur { lens_blur_px, sigma_lens_blur_px, .. } = lens.motion_blur();
        println!("{psf_sigma_px} px: {lens_blur_px} +- {sigma_lens_blur_px} px");
        assert!(sigma_lens_blur_px < before / 1.5, "{sigma_lens_blur_px}");
        assert!((lens_blur_px - psf_sigma_px).abs() < 2.5 * sigma_lens_blur_px, "{psf_sigma_px}: {lens_blur_px}");
    }
}
