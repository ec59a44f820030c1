//! Two sides of one post, in every back end.

use shutter_range::{Line, Micro, Polarity, Post, Q32, Range, RangeStatus, Scalar, Sigmas};

use crate::projection::Scene;
use crate::scenes::{TENTH_DEGREE, line_of, tilt_of};

/// 0.34° on either side, as lamp posts have it.
const TAPER: f64 = 0.006;

/// A side of a post that leans, in the scene of a camera that passes.
fn side<S: Scalar>(scene: &Scene, sigma_tilt: f64, polarity: Polarity) -> Range<S> {
    let points: Vec<_> = scene.points().into_iter().map(|point| point.with_polarity(polarity)).collect();
    let line: Line<16> = line_of(&points);
    Range::from_line(&scene.setup_with(tilt_of(sigma_tilt)), &scene.motion(), &line)
}

/// Of a post of 6 cm, with a lean of its own and one of its sides.
fn sides<S: Scalar>(lean: f64, taper: f64, sigma_tilt: f64) -> [Range<S>; 2] {
    let upright = Scene::vga();
    let half_width = 0.03 / upright.depth_m;
    let scene = |sign: f64| Scene {
        bearing: upright.bearing + sign * half_width,
        tilt: lean + sign * taper,
        ..upright.clone()
    };
    [side(&scene(-1.0), sigma_tilt, Polarity::Falling), side(&scene(1.0), sigma_tilt, Polarity::Rising)]
}

fn assert_taper_cancels<S: Scalar>(name: &str) {
    let ranges = sides::<S>(0.0, TAPER, 4.0 * TENTH_DEGREE);
    let off = |inverse_depth: S| (inverse_depth.to_f64() * Scene::vga().depth_m - 1.0).abs();
    for (index, range) in ranges.iter().enumerate() {
        assert!((off(range.estimate.inverse_depth_per_m) - 0.19).abs() < 0.02, "{name}: {range:?}");
        let post = Post::of(&ranges, index).expect("the side of a post");
        assert_eq!((post.other, post.status()), (1 - index, RangeStatus::Ok), "{name}");
        assert!(off(post.inverse_depth_per_m) < 0.005, "{name}: {post:?}");
        let distance = post.distance(Sigmas(S::from_i32(2)));
        let (Some((middle_m, sigma_m)), Some(nearest_m), Some(farthest_m)) =
            (distance.estimate_m, distance.nearest_m, distance.farthest_m)
        else {
            panic!("{name}: {distance:?}");
        };
        assert!(nearest_m < middle_m && middle_m < farthest_m && sigma_m > S::ZERO, "{name}: {distance:?}");
        let truth_m = Scene::vga().depth_m * (1.0 + Scene::vga().bearing.powi(2)).sqrt();
        assert!((middle_m.to_f64() / truth_m - 1.0).abs() < 0.005, "{name}: {middle_m:?}");
    }
}

#[test]
fn taper_cancels_in_every_back_end() {
    assert_taper_cancels::<f64>("f64");
    assert_taper_cancels::<f32>("f32");
    assert_taper_cancels::<Micro>("Micro");
    assert_taper_cancels::<Q32>("Q32");
}

/// A lean of the whole post stays, and stays in its sigma.
#[test]
fn a_lean_of_the_whole_post_does_not_cancel() {
    let ranges = sides::<f64>(TENTH_DEGREE, 0.0, TENTH_DEGREE);
    let post = Post::of(&ranges, 0).expect("a post");
    let off = (post.inverse_depth_per_m * Scene::vga().depth_m - 1.0).abs();
    let sigma = post.sigma_inverse_depth_per_m * Scene::vga().depth_m;
    // 5.6 % for a slope of 1.79°.
    assert!((0.05..0.06).contains(&off) && (0.05..0.06).contains(&sigma), "{off} {sigma}");
}

#[test]
fn what_is_no_post() {
    let [left, right] = sides::<f64>(0.0, 0.0, TENTH_DEGREE);
    let same = Range { polarity: left.polarity, ..right };
    let bent = Range { status: RangeStatus::Bent, ..right };
    let lower = Range { first_row: right.first_row + 200, ..right };
    for other in [same, bent, lower] {
        assert_eq!(Post::of(&[left, other], 0), None, "{other:?}");
    }
    assert_eq!(Post::of(&[left, right], 2), None);
    assert_eq!(Post::<f64>::of(&[], 0), None);
    assert_eq!(Post::of(&[left], 0), None);
}

/// The gap between two posts has opposite edges as well, but is wider.
#[test]
fn the_narrowest_pairs_are_posts() {
    let moved = |range: Range<f64>, by: f64| Range {
        column_at_first_row: range.column_at_first_row + by,
        column_at_last_row: range.column_at_last_row + by,
        ..range
    };
    let [left, right] = sides::<f64>(0.0, 0.0, TENTH_DEGREE);
    let ranges = [left, right, moved(left, 60.0), moved(right, 60.0), moved(left, 120.0)];
    let others: Vec<_> = (0..5).map(|index| Post::of(&ranges, index).map(|post| post.other)).collect();
    assert_eq!(others, [Some(1), Some(0), Some(3), Some(2), None]);
}
