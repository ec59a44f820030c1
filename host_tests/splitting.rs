//! A line ends where its edge does: where it runs on along another one, each part keeps what it knows.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use shutter_range::sim::{Background, Bar, Exposure, Scene};
use shutter_range::{Range, RangeStatus, Ranger, Uncertainty};

use crate::rendered::{SmallRanger, TOP, errors, moving, ranges_of, render};

/// An upright post stands on a leaning one: their left sides meet in the middle row.
fn turning(lean: f32, depth_m: f32) -> Scene<2> {
    let mut scene = Scene::new(Background::plain(180.0)).expect("a sound background");
    let upper = Bar::upright(0.05, depth_m, 0.1, 60.0).between(-10.0, 0.0);
    let lower = Bar::upright(0.05, depth_m, 0.1, 60.0).between(0.0, 10.0).leaning(lean);
    scene.push(upper).expect("a sound bar");
    scene.push(lower).expect("a sound bar");
    scene
}

/// Whether the upper part of each side is a line of its own that ends at the turn, with the right depth.
fn assert_ends<const LINES: usize, const KNOTS: usize, const POINTS: usize>(lean: f32, seed: u64) {
    let world = moving(1.5);
    let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
    let (frame, truths) = render(&turning(lean, 2.0), &world, TOP, Exposure::default(), seed);
    let found = ranges_of(&mut Ranger::<LINES, KNOTS, POINTS>::new(), &setup, &world, &frame);
    for truth in truths.iter().filter(|truth| truth.first_row < 60) {
        let is_upper = |range: &&Range<f32>| range.polarity == truth.polarity && range.first_row < 10;
        let upper: Vec<_> = found.iter().filter(is_upper).collect();
        let [range] = upper[..] else { panic!("lean {lean}, seed {seed}: {upper:#?} for {truth:?}") };
        let name = format!("lean {lean}, seed {seed}, {KNOTS} knots: {:.1} sigma, {range:?}", errors(range, truth).1);
        assert!((90..=140).contains(&range.last_row), "{name}");
        assert!(range.status == RangeStatus::Ok && errors(range, truth).1.abs() < 4.0, "{name}");
    }
}

#[test]
fn a_line_ends_where_its_edge_turns() {
    for lean in [-0.05_f32, 0.05] {
        for seed in 1..9 {
            assert_ends::<16, 10, 32>(lean, seed);
            assert_ends::<64, 64, 64>(lean, seed);
        }
    }
}

/// However noisy and faint: as many lines as edges.
#[test]
fn straight_edges_are_not_split() {
    const FRAMES: u64 = 200;
    let world = moving(1.5);
    let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
    let mut random = StdRng::seed_from_u64(7);
    for seed in 0..FRAMES {
        let mut scene: Scene<3> = Scene::new(Background::plain(180.0)).expect("a sound background");
        for bearing in [-0.35, 0.0, 0.35] {
            let (depth_m, level) = (random.random_range(0.8..4.0_f32), random.random_range(40.0..140.0));
            scene.push(Bar::upright(bearing, depth_m, 0.08 * depth_m, level)).expect("a sound bar");
        }
        let exposure = Exposure { read_noise: random.random_range(1.0..6.0), ..Exposure::default() };
        let (frame, truths) = render(&scene, &world, TOP, exposure, seed);
        let found = ranges_of(&mut SmallRanger::new(), &setup, &world, &frame);
        assert_eq!(found.len(), truths.len(), "seed {seed}: {found:#?}");
    }
}

/// A post, and below it a piece of one that leans a little, much shorter than the gap between them.
fn with_piece_below() -> Scene<2> {
    let mut scene = Scene::new(Background::plain(180.0)).expect("a sound background");
    scene.push(Bar::upright(0.05, 2.0, 0.1, 60.0).between(-10.0, -0.2)).expect("a sound bar");
    scene.push(Bar::upright(0.05, 2.0, 0.1, 60.0).between(0.1, 0.18).leaning(0.02)).expect("a sound bar");
    scene
}

#[test]
fn a_line_ends_before_a_long_gap() {
    let world = moving(1.5);
    let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
    for seed in 1..9 {
        let (frame, truths) = render(&with_piece_below(), &world, TOP, Exposure::default(), seed);
        let found = ranges_of(&mut SmallRanger::new(), &setup, &world, &frame);
        for truth in truths.iter().filter(|truth| truth.first_row == 0) {
            let is_of_post = |range: &&Range<f32>| range.polarity == truth.polarity && range.first_row < 10;
            let range = found.iter().find(is_of_post).expect("the post");
            assert!(range.last_row.abs_diff(truth.last_row) <= 2, "seed {seed}: {range:?} for {truth:?}");
            assert!(errors(range, truth).1.abs() < 4.0, "seed {seed}: {range:?} for {truth:?}");
        }
    }
}
