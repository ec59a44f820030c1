//! Texture, and leaning bars that cross behind a post: they are no distance, and lead no line astray.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use shutter_range::sim::{Background, Bar, Exposure, Scene, Texture, Truth};
use shutter_range::{MotionBlur, Range, RangeStatus, Ranger, Response, Uncertainty};

use crate::rendered::{SmallRanger, TOP, errors, moving, ranges_of, render};
use crate::scenes::{TENTH_DEGREE, tilt_of};

const FRAMES: u64 = 40;
const POST_M: f32 = 1.2;
const LEANING_BARS: usize = 8;

/// A post 1.2 m away, leaning bars of any brightness at 2 to 5 m, and a wall at infinity.
fn scene(random: &mut StdRng) -> Scene<9> {
    let texture = Texture { contrast: 15.0, cell: 0.03, seed: random.random() };
    let mut scene = Scene::new(Background::textured(170.0, texture)).expect("sound background");
    for _ in 0..LEANING_BARS {
        let lean = random.random_range(0.15..2.0_f32) * if random.random() { 1.0 } else { -1.0 };
        let (bearing, depth_m) = (random.random_range(-0.5..0.5), random.random_range(2.0..5.0));
        let bar = Bar::upright(bearing, depth_m, random.random_range(0.05..0.15), random.random_range(60.0..230.0));
        scene.push(bar.leaning(lean)).expect("a sound bar");
    }
    let post = Bar::upright(random.random_range(-0.3..0.3), POST_M, 0.12, 60.0);
    scene.push(post).expect("a sound bar");
    scene
}

/// The range of an edge, the longest if there are several.
fn range_of<'a>(found: &'a [Range<f32>], truth: &Truth) -> Option<&'a Range<f32>> {
    let of_edge = |range: &&Range<f32>| {
        let near = (f64::from(range.estimate.bearing) - truth.bearing).abs() < 0.02;
        near && range.status == RangeStatus::Ok && range.polarity == truth.polarity
    };
    found.iter().filter(of_edge).max_by_key(|range| range.points)
}

/// Every edge of the post is found, with an honest sigma, and nothing else.
#[test]
fn crossing_bars_lead_no_line_astray() {
    // 95.4 % less two sigma of a share of 80.
    const LEAST_PERCENT_INSIDE: usize = 91;
    // The Cramér–Rao bound of 0.08 % knows texture and bars; not to know them costs a factor of eight here, twelve at
    // most.
    const MOST_RMS: f64 = 0.01;
    // What crosses behind the post can be as steep as an edge in motion, once in so many frames.
    const MOST_WRONG: usize = 1;
    let mut random = StdRng::seed_from_u64(1);
    let exposure = Exposure { time_s: 0.004, ..Exposure::default() };
    let world = moving(1.5);
    let blur = MotionBlur::from_calibrated_lens(exposure.time_s, exposure.psf_sigma_px);
    let setup = world
        .setup_read::<f32>(Uncertainty::NONE, TOP)
        .with_response(Response::Linear)
        .with_motion_blur(blur)
        .expect("sound blur");
    let (mut normal, mut relative, mut missed, mut wrong) = (Vec::new(), Vec::new(), 0, 0);
    for seed in 0..FRAMES {
        let (frame, truths) = render(&scene(&mut random), &world, TOP, exposure, seed);
        let truths: Vec<_> = truths.into_iter().filter(|truth| truth.depth_m == f64::from(POST_M)).collect();
        let mut ranger: Ranger<64, 16, 64> = Ranger::new();
        let found = ranges_of(&mut ranger, &setup, &world, &frame);
        for truth in &truths {
            match range_of(&found, truth).map(|range| errors(range, truth)) {
                Some((error, sigmas)) => {
                    relative.push(error);
                    normal.push(sigmas);
                }
                None => missed += 1,
            }
        }
        let is_of_post = |range: &Range<f32>| {
            truths.iter().any(|truth| (f64::from(range.estimate.bearing) - truth.bearing).abs() < 0.02)
        };
        wrong += found.iter().filter(|range| range.status == RangeStatus::Ok && !is_of_post(range)).count();
    }
    let rms = (relative.iter().map(|error| error * error).sum::<f64>() / relative.len() as f64).sqrt();
    let inside = normal.iter().filter(|sigmas| sigmas.abs() < 2.0).count();
    println!("{inside} of {} inside two sigma, RMS {rms:.4}, {wrong} wrong", normal.len());
    assert!(missed == 0, "{missed} of {}", normal.len() + missed);
    assert!(inside * 100 >= normal.len() * LEAST_PERCENT_INSIDE, "{inside} of {} inside two sigma", normal.len());
    assert!(rms < MOST_RMS, "{rms}");
    assert!(wrong <= MOST_WRONG, "{wrong} in {FRAMES} frames");
}

/// But for a straight edge in it that happens to be as steep and as blurred as one in motion: once in 40 frames.
#[test]
fn texture_is_no_bar() {
    let mut taken = Vec::new();
    for (contrast, cell) in [(25.0, 0.04), (25.0, 0.08), (50.0, 0.03), (50.0, 0.08), (80.0, 0.15)] {
        for seed in 1..9 {
            let world = moving(1.5);
            let exposure = Exposure { time_s: 0.004, ..Exposure::default() };
            let texture = Texture { contrast, cell, seed };
            let scene = Scene::<1>::new(Background::textured(128.0, texture)).expect("sound background");
            let (frame, _) = render(&scene, &world, TOP, exposure, seed.into());
            let blur = MotionBlur::from_calibrated_lens(exposure.time_s, exposure.psf_sigma_px);
            let setup = world
                .setup_read::<f32>(tilt_of(TENTH_DEGREE), TOP)
                .with_response(Response::Linear)
                .with_motion_blur(blur)
                .expect("sound");
            let found = ranges_of(&mut SmallRanger::new(), &setup, &world, &frame);
            let ok = found.iter().filter(|range| range.status == RangeStatus::Ok);
            taken.extend(ok.map(|range| (contrast, cell, seed, range.points, range.estimate)));
        }
    }
    for one in &taken {
        println!("{one:?}");
    }
    assert!(taken.len() <= 1, "more than one in 40 frames: {taken:#?}");
}

/// Rows of a texture of cells about four pixels wide and high, from a column on.
fn add_texture(frame: &mut [Vec<u8>], from: usize, random: &mut StdRng) {
    let cells: Vec<Vec<f32>> =
        (0..frame.len() / 4 + 2).map(|_| (0..100).map(|_| random.random_range(-40.0..40.0)).collect()).collect();
    for (y, row) in frame.iter_mut().enumerate() {
        for (x, pixel) in row.iter_mut().enumerate().skip(from) {
            let (v, u) = (y as f32 / 4.0, x as f32 / 4.0);
            let at = |i: usize, j: usize| cells[v as usize + i][u as usize + j];
            let along = |i| at(i, 0) + (at(i, 1) - at(i, 0)) * u.fract();
            let texture = along(0) + (along(1) - along(0)) * v.fract();
            *pixel = (f32::from(*pixel) + texture).clamp(0.0, 255.0) as u8;
        }
    }
}

/// How many edges of some bars are found, and how many they have, in eight frames with a texture from a column on.
fn found_beside_texture(bars: &[Bar], from: usize) -> (usize, usize) {
    let world = moving(1.5);
    let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
    let mut scene: Scene<2> = Scene::new(Background::plain(60.0)).expect("sound background");
    bars.iter().for_each(|bar| scene.push(*bar).expect("a sound bar"));
    let (mut found, mut edges) = (0, 0);
    for seed in 1..9 {
        let (mut frame, truths) = render(&scene, &world, TOP, Exposure::default(), seed);
        add_texture(&mut frame, from, &mut StdRng::seed_from_u64(seed));
        let ranges = ranges_of(&mut Ranger::<64, 16, 64>::new(), &setup, &world, &frame);
        edges += truths.len();
        found += truths.iter().filter(|truth| range_of(&ranges, truth).is_some()).count();
    }
    println!("{found} of {edges} edges");
    (found, edges)
}

/// What is usual in a row says little of a place: bars that are fainter than the texture in the rest of their rows are
/// found where there is none.
#[test]
fn an_edge_fainter_than_texture_elsewhere() {
    let (found, edges) = found_beside_texture(&[Bar::upright(-0.4, 1.2, 0.12, 80.0)], 120);
    // All; fourteen of sixteen where the whole row has one threshold.
    assert_eq!(found, edges);
}

/// So are thin ones that hardly stand out of noise.
#[test]
fn faint_bars_where_it_is_quiet() {
    let bars =
        [(-0.4, 1.2), (-0.2, 1.5)].map(|(bearing, depth_m)| Bar::upright(bearing, depth_m, 0.02 * depth_m, 77.0));
    let (found, edges) = found_beside_texture(&bars, 140);
    // 29 of 32, and 17 where the whole row has one threshold.
    assert!(4 * found >= 3 * edges, "{found} of {edges}");
}

/// Short bars of clear contrast are no clutter because there is texture a hundred pixels away in their rows.
#[test]
fn texture_elsewhere_is_no_clutter() {
    let world = moving(1.5);
    let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
    for seed in 1..9 {
        let mut scene: Scene<2> = Scene::new(Background::plain(60.0)).expect("sound background");
        for (bearing, depth_m) in [(-0.4, 1.2), (-0.15, 1.5)] {
            let bar = Bar::upright(bearing, depth_m, 0.12, 160.0).between(-0.08, 0.08);
            scene.push(bar).expect("a sound bar");
        }
        let (mut frame, truths) = render(&scene, &world, TOP, Exposure::default(), seed);
        add_texture(&mut frame, 220, &mut StdRng::seed_from_u64(seed));
        let found = ranges_of(&mut Ranger::<64, 16, 64>::new(), &setup, &world, &frame);
        let of_bars: Vec<_> =
            found.iter().filter(|range| range.column_at_first_row < 150.0 && range.points > 24).collect();
        assert_eq!(of_bars.len(), truths.len(), "seed {seed}: {of_bars:#?}");
        for (range, truth) in of_bars.into_iter().zip(&truths) {
            let (_, sigmas) = errors(range, truth);
            assert!(range.status == RangeStatus::Ok && sigmas.abs() < 4.0, "seed {seed}: {sigmas} sigma, {range:?}");
        }
    }
}

/// One post ends where another one begins, a little to the side of it or right below: two edges, not one with a kink.
#[test]
fn posts_above_each_other_stay_two_edges() {
    // Three sigma for 144 edges, and some more: where the posts meet, a few rows show a blend of both.
    const MOST_SIGMAS: f64 = 5.0;
    let world = moving(1.5);
    let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
    // Both right sides are near column 174 in the middle row.
    let right_side_at = |depth_m: f32| 0.05 - 7.5 / 300.0 / depth_m - 0.05 / depth_m;
    for gap_m in [0.0, 0.02, 0.05, 0.1] {
        for (upper_m, lower_m) in [(3.0, 1.5), (1.5, 3.0), (2.5, 1.0)] {
            for seed in 1..4 {
                let mut scene: Scene<2> = Scene::new(Background::plain(180.0)).expect("sound background");
                let upper = Bar::upright(right_side_at(upper_m), upper_m, 0.1, 60.0).between(-10.0, 0.0);
                let lower = Bar::upright(right_side_at(lower_m), lower_m, 0.1, 60.0).between(gap_m, 10.0);
                scene.push(upper).expect("a sound bar");
                scene.push(lower).expect("a sound bar");
                let (frame, truths) = render(&scene, &world, TOP, Exposure::default(), seed);
                let found = ranges_of(&mut SmallRanger::new(), &setup, &world, &frame);
                for truth in &truths {
                    let is_it = |range: &&Range<f32>| {
                        range.polarity == truth.polarity && range.first_row.abs_diff(truth.first_row) < 15
                    };
                    let range = found.iter().find(is_it).filter(|range| range.status == RangeStatus::Ok);
                    let sigmas = range.map(|range| errors(range, truth).1.abs());
                    let name = format!("{upper_m} m above {lower_m} m, gap {gap_m}, seed {seed}");
                    let is_near = sigmas.is_some_and(|sigmas| sigmas < MOST_SIGMAS);
                    assert!(is_near, "{name}: {sigmas:?} of {truth:?} in {found:#?}");
                }
            }
        }
    }
}
