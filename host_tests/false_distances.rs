//! Where nothing upright stands there is no distance: texture, leaning bars, clutter and flat frames, with linear
//! pixels stated and with a camera of which nothing but the exposure is known.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use shutter_range::sim::{Background, Bar, Exposure, Scene, Texture};
use shutter_range::{MotionBlur, Range, RangeStatus, Response, Setup};

use crate::drawn::{Frame, large_ranger, ranges, rendered, through};
use crate::projection;
use crate::scenes::{TENTH_DEGREE, tilt_of};

const FRAMES: u64 = 200;

const EXPOSURE: Exposure = Exposure { time_s: 0.002, psf_sigma_px: 0.7, read_noise: 2.5, shot_gain: 0.03 };

type Draw = fn(&mut StdRng) -> Scene<32>;

/// Nothing but noise.
fn flat(random: &mut StdRng) -> Scene<32> {
    Scene::new(Background::plain(random.random_range(60.0..200.0))).expect("sound background")
}

/// Cells of about 12 px, up to 30 grey levels about the mean.
fn textured(random: &mut StdRng, level: f32) -> Scene<32> {
    let texture = Texture { contrast: 30.0, cell: 12.0 / 600.0, seed: random.random() };
    Scene::new(Background::textured(level, texture)).expect("sound background")
}

fn texture(random: &mut StdRng) -> Scene<32> {
    textured(random, 120.0)
}

/// Leans by 8° to 75°.
fn leaning_bar(random: &mut StdRng, level: f32) -> Bar {
    let lean = random.random_range(8.0..75.0_f32).to_radians().tan() * if random.random() { 1.0 } else { -1.0 };
    let (depth_m, width_m) = (random.random_range(2.5..6.0), random.random_range(0.03..0.12));
    Bar::upright(random.random_range(-0.53..0.53), depth_m, width_m, level).between(-0.7, 0.7).leaning(lean)
}

fn leaning(random: &mut StdRng) -> Scene<32> {
    let mut scene = Scene::new(Background::plain(180.0)).expect("sound background");
    for _ in 0..8 {
        let level = random.random_range(20.0..90.0);
        scene.push(leaning_bar(random, level)).expect("a sound bar");
    }
    scene
}

/// Many leaning bars before a texture, and one upright post before all.
fn clutter(random: &mut StdRng) -> Scene<32> {
    let mut scene = textured(random, 150.0);
    for _ in 0..24 {
        let level = random.random_range(90.0..230.0);
        scene.push(leaning_bar(random, level)).expect("a sound bar");
    }
    scene
        .push(Bar::upright(random.random_range(-0.3..0.3), POST_M as f32, 0.12, 30.0).between(-0.5, 0.5))
        .expect("a bar");
    scene
}

const POST_M: f64 = 2.0;

/// A frame and where its post's edges are, if it has one.
struct Shot {
    world: projection::Scene,
    frame: Frame,
    posts_edges: Vec<projection::Scene>,
}

impl Shot {
    fn new(draw: Draw, seed: u64) -> Self {
        let random = &mut StdRng::seed_from_u64(seed);
        let velocity = random.random_range(1.0..3.0) * if random.random() { 1.0 } else { -1.0 };
        let world = projection::Scene { velocity_m_s: [velocity, 0.0, 0.0], ..projection::Scene::vga() };
        let scene = draw(random);
        let frame = through(&rendered(&scene, &world, EXPOSURE, EXPOSURE.psf_sigma_px, seed), []);
        let upright = scene.objects().iter().filter_map(|object| match object {
            shutter_range::sim::Object::Bar(bar) if bar.lean == 0.0 => Some(f64::from(bar.bearing)),
            _ => None,
        });
        let sides = |bearing| [-0.06, 0.06].map(|x_m| bearing + x_m / POST_M);
        let edge = |bearing| projection::Scene { bearing, depth_m: POST_M, ..world.clone() };
        let posts_edges = upright.flat_map(sides).map(edge).collect();
        Self { posts_edges, world, frame }
    }

    /// A distance that one might go by, where there is nothing.
    fn is_false(&self, range: &Range<f64>) -> bool {
        let of_post = |edge: &projection::Scene| {
            let off = |column: f64, row| (column - edge.column(row)).abs();
            off(range.column_at_first_row, range.first_row) < 4.0 && off(range.column_at_last_row, range.last_row) < 5.0
        };
        let depth_m = 1.0 / range.estimate.inverse_depth_per_m;
        range.status == RangeStatus::Ok && (0.15..60.0).contains(&depth_m) && !self.posts_edges.iter().any(of_post)
    }
}

/// False distances a frame, with linear pixels stated and with nothing stated, at most.
fn assert_hardly_any(name: &str, draw: Draw) {
    let mut ranger = large_ranger();
    let mut counts = [0, 0];
    for seed in 0..FRAMES {
        let shot = Shot::new(draw, seed);
        let setup = shot.world.setup_with(tilt_of::<f64>(TENTH_DEGREE).with_edge_roughness_px(0.03));
        let exposure_s = f64::from(EXPOSURE.time_s);
        let known = |blur| setup.with_motion_blur(blur).expect("sound blur");
        let setups: [Setup<f64>; 2] = [
            known(MotionBlur::from_calibrated_lens(exposure_s, 0.7)).with_response(Response::Linear),
            known(MotionBlur::from_exposure(exposure_s)),
        ];
        for (count, setup) in counts.iter_mut().zip(setups) {
            let found = ranges(&mut ranger, &setup, &shot.world.motion(), &shot.frame);
            *count += found.iter().filter(|range| shot.is_false(range)).count();
        }
    }
    let [linear, unknown] = counts.map(|count| count as f64 / FRAMES as f64);
    println!(
        "{name:<10} false distances a frame: {linear:.2} with linear pixels stated, {unknown:.2} with a camera unknown"
    );
    // One in ten frames may have one. By chance alone 0.04 of so many frames differs by 0.014 (one standard deviation).
    assert!(linear <= 0.06 && unknown <= 0.06, "{name}: {linear}, {unknown}");
}

#[test]
fn of_flat_frames() {
    assert_hardly_any("flat", flat);
}

#[test]
fn of_texture() {
    assert_hardly_any("texture", texture);
}

#[test]
fn of_leaning_bars() {
    assert_hardly_any("leaning", leaning);
}

#[test]
fn of_clutter() {
    assert_hardly_any("clutter", clutter);
}
