//! What tables a street needs: posts of all widths and distances, bars that lean, and texture behind them.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use shutter_range::sim::{Background, Bar, Exposure, Scene, Texture, Truth};
use shutter_range::{Counters, Range, RangeStatus, Ranger, Uncertainty};

use crate::rendered::{Frame, TOP, errors, moving, ranges_of, render};

const FRAMES: u64 = 12;
const POSTS: usize = 8;
const OTHERS: usize = 8;

/// Posts in the places of a row of houses, one for each of eight parts of the image.
fn street(random: &mut StdRng) -> Scene<{ POSTS + OTHERS }> {
    let texture = Texture { contrast: 12.0, cell: 0.02, seed: random.random() };
    let mut scene = Scene::new(Background::textured(150.0, texture)).expect("sound background");
    for _ in 0..OTHERS {
        let lean = random.random_range(0.15..2.0_f32) * if random.random() { 1.0 } else { -1.0 };
        let (bearing, depth_m) = (random.random_range(-0.5..0.5), random.random_range(6.0..9.0));
        let bar = Bar::upright(bearing, depth_m, random.random_range(0.05..0.15), random.random_range(60.0..230.0));
        scene.push(bar.leaning(lean)).expect("a sound bar");
    }
    for place in 0..POSTS {
        let bearing = -0.46 + 0.115 * place as f32 + random.random_range(0.0..0.08);
        let (depth_m, level) = (random.random_range(1.5..5.0), random.random_range(20.0..90.0));
        let from = random.random_range(-0.5..-0.1);
        let post = Bar::upright(bearing, depth_m, depth_m * random.random_range(0.025..0.035), level);
        scene.push(post.between(from * depth_m, 0.5 * depth_m)).expect("a sound bar");
    }
    scene
}

/// Frames of the street and the edges of its posts.
fn frames() -> Vec<(Frame, Vec<Truth>)> {
    let exposure = Exposure { time_s: 0.002, ..Exposure::default() };
    let frame = |seed| {
        let scene = street(&mut StdRng::seed_from_u64(seed));
        let (frame, truths) = render(&scene, &moving(1.5), TOP, exposure, seed);
        (frame, truths.into_iter().filter(|truth| truth.depth_m < 5.5).collect())
    };
    (0..FRAMES).map(frame).collect()
}

/// What tables of some sizes tell of all frames.
struct Told {
    edges: usize,
    right: usize,
    /// Median of the relative errors of those that are right.
    error: f64,
    counters: Counters,
}

impl Told {
    fn share(&self) -> f64 {
        self.right as f64 / self.edges as f64
    }
}

fn told<const LINES: usize, const KNOTS: usize, const POINTS: usize>(frames: &[(Frame, Vec<Truth>)]) -> Told {
    let world = moving(1.5);
    let setup = world.setup_read::<f32>(Uncertainty::NONE.with_edge_roughness_px(0.03), TOP);
    let mut ranger = Box::new(Ranger::<LINES, KNOTS, POINTS>::new());
    let (mut edges, mut relative) = (0, Vec::new());
    for (frame, truths) in frames {
        let found = ranges_of(&mut ranger, &setup, &world, frame);
        for truth in truths {
            let is_its = |range: &&Range<f32>| {
                let is_near = (f64::from(range.estimate.bearing) - truth.bearing).abs() < 0.01;
                is_near && range.status == RangeStatus::Ok && range.polarity == truth.polarity
            };
            edges += 1;
            let of_edge = found.iter().filter(is_its).map(|range| errors(range, truth));
            relative
                .extend(of_edge.filter(|(_, normal)| normal.abs() < 4.0).map(|(relative, _)| relative.abs()).next());
        }
    }
    relative.sort_by(f64::total_cmp);
    let error = relative[relative.len() / 2];
    let bytes = size_of::<Ranger<LINES, KNOTS, POINTS>>();
    let told = Told { edges, right: relative.len(), error, counters: *ranger.counters() };
    println!(
        "| {LINES} | {KNOTS} | {POINTS} | {bytes} | {:.0} % | {:.2} % | {:.0} | {:.0} % |",
        100.0 * told.share(),
        100.0 * told.error,
        f64::from(told.counters.dropped_lines) / FRAMES as f64,
        100.0 * f64::from(told.counters.crowded_rows) / (240.0 * FRAMES as f64)
    );
    told
}

/// A place for each edge in view and half as many for what begins beside them is as good as any number; with half of
/// that lines are refused, and rows are told as crowded. Points and knots matter less.
#[test]
fn tables_for_a_street() {
    let frames = frames();
    println!("| lines | knots | points | bytes | right | error | refused a frame | crowded rows |");
    let few = [told::<8, 16, 64>(&frames), told::<16, 16, 64>(&frames)];
    let enough = [told::<24, 16, 64>(&frames), told::<32, 16, 64>(&frames), told::<48, 16, 64>(&frames)];
    let all = told::<128, 16, 128>(&frames);
    let (few_points, few_knots) = (told::<32, 16, 16>(&frames), told::<32, 8, 64>(&frames));
    assert!(all.share() > 0.98 && all.counters.dropped_lines == 0 && all.counters.crowded_rows < 30);
    for told in enough.iter().chain([&few_points, &few_knots]) {
        assert!(told.share() > all.share() - 0.03 && told.error < 1.15 * all.error, "{}", told.share());
    }
    for told in &few {
        let is_told = told.counters.dropped_lines > 0 && told.counters.crowded_rows > 0;
        assert!(told.share() < all.share() - 0.15 && is_told, "{}", told.share());
    }
}
