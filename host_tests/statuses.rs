//! Every status of a range, reached the way a user would.

use shutter_range::messages::{DistanceSensor, Reach};
use shutter_range::{EdgePoint, Interval, Line, MotionBlur, Range, RangeStatus, Response, Sigmas, Uncertainty};

use crate::journey::{normal, seed};
use crate::projection::Scene;
use crate::scenes::{TENTH_DEGREE, line_of, q16, range_of, tilt_of};

fn range(scene: &Scene) -> Range<f32> {
    range_of(scene, tilt_of(TENTH_DEGREE), &scene.points())
}

#[test]
fn an_upright_edge_in_reach_is_ok_with_an_interval() {
    let range = range(&Scene::vga());
    assert_eq!(range.status, RangeStatus::Ok);
    let depth = range.depth(Sigmas(2.0));
    let (estimate, sigma) = depth.estimate_m.expect("ok");
    let (nearest, farthest) = (depth.nearest_m.expect("positive"), depth.farthest_m.expect("bounded"));
    assert!(nearest < estimate && estimate < farthest);
    assert!((nearest..farthest).contains(&2.0));
    // Symmetric in inverse depth, in depth the bounds are wider by four times the square of a relative sigma of 5.6 %.
    assert!(((farthest - nearest) / (4.0 * sigma) - 1.0).abs() < 0.05);
    let (distance, _) = range.distance(Sigmas(2.0)).estimate_m.expect("ok");
    assert!((f64::from(distance) / (2.0 * f64::hypot(1.0, 0.05)) - 1.0).abs() < 1e-3, "points of 1/65536 px");
}

/// The nearest possible depth is all that the motion can tell.
#[test]
fn an_edge_beyond_reach_is_far_with_a_nearest_depth() {
    let range = range(&Scene { depth_m: 400.0, ..Scene::vga() });
    assert_eq!(range.status, RangeStatus::Far);
    let depth = range.depth(Sigmas(2.0));
    assert_eq!((depth.estimate_m, depth.farthest_m), (None, None));
    // A sigma of tilt of 0.1° alone is 0.028 per metre: two of it, and the true depth.
    assert!((10.0..400.0).contains(&depth.nearest_m.expect("a bound")));
}

#[test]
fn a_motion_that_says_too_little_is_slow() {
    let crawling = range(&Scene { velocity_m_s: [-0.005, 0.0, 0.0], ..Scene::vga() });
    assert_eq!(crawling.status, RangeStatus::Slow);
    let still = range(&Scene { velocity_m_s: [0.0; 3], ..Scene::vga() });
    assert_eq!(still.status, RangeStatus::Slow);
    assert_eq!(still.estimate.inverse_depth_per_m, 0.0);
    assert_eq!(still.estimate.sigma_inverse_depth_per_m, 1e6);
    assert!(still.depth(Sigmas(2.0)).estimate_m.is_none());
}

/// A pure rotation shears the image without saying anything about depth.
#[test]
fn pure_rotation_gives_no_distance() {
    let scene = Scene { velocity_m_s: [0.0; 3], rate_rad_s: [0.05, 0.4, -0.1], ..Scene::vga() };
    assert_eq!(range(&scene).status, RangeStatus::Slow);
}

/// The edge leans or moves.
#[test]
fn a_slope_against_the_motion_is_inconsistent() {
    let scene = Scene::vga();
    let against = Scene { velocity_m_s: [1.5, 0.0, 0.0], ..scene.clone() };
    let range = range_of::<f32>(&against, tilt_of(TENTH_DEGREE), &scene.points());
    assert_eq!(range.status, RangeStatus::Inconsistent);
    assert!(range.depth(Sigmas(2.0)).estimate_m.is_none());
}

/// A dozen noisy rows, each a knot by itself: in one line of five one of them departs by more than the limit, by
/// chance.
#[test]
fn noise_is_no_bend() {
    const NOISE_PX: f64 = 0.6;
    let scene = Scene::vga();
    let random = &mut seed(70);
    let mut departed = 0;
    for _ in 0..400 {
        let off: Vec<_> = (0..12).map(|_| NOISE_PX * normal(random)).collect();
        departed += u32::from(off.iter().any(|off| off.abs() > 1.5));
        let point =
            |(row, off): (u16, &f64)| scene.point_at(row, scene.column(row) + off).with_sigma_q16(q16(NOISE_PX) as u32);
        let points: Vec<_> = (0..).zip(&off).map(point).collect();
        let range = range_of::<f64>(&scene, tilt_of(TENTH_DEGREE), &points);
        assert!(!range.estimate.bent, "{off:?}: {range:?}");
    }
    assert!(departed > 40, "{departed}");
}

/// The edge of the scene with a bow: `sagitta_px` between its ends and its middle.
fn bowed(scene: &Scene, sagitta_px: f64) -> Vec<EdgePoint> {
    let bow = |edge: EdgePoint| {
        let off = (f64::from(edge.row) - 240.0) / 240.0;
        EdgePoint { column_q16: edge.column_q16 + q16(sagitta_px * off * off), ..edge }
    };
    scene.points().into_iter().map(bow).collect()
}

#[test]
fn a_bow_of_less_than_a_pixel_is_a_larger_sigma() {
    let scene = Scene::vga();
    for sagitta_px in [0.2, 0.5, 1.0] {
        let range = range_of::<f32>(&scene, Uncertainty::default(), &bowed(&scene, sagitta_px));
        let sigma = range.estimate.sigma_inverse_depth_per_m;
        assert_eq!(range.status, RangeStatus::Ok, "{range:?}");
        assert!((range.estimate.inverse_depth_per_m - 0.5).abs() < 2.0 * sigma, "{range:?}");
    }
}

#[test]
fn curved_and_broken_edges_are_bent() {
    let scene = Scene::vga();
    // At its ends it is two thirds of that away from the best straight line.
    let range = range_of::<f32>(&scene, Uncertainty::default(), &bowed(&scene, 5.0));
    assert_eq!(range.status, RangeStatus::Bent);
    assert!(range.depth(Sigmas(2.0)).estimate_m.is_none());
    // Two halves of different edges are no straight edge either.
    let broken: Vec<_> = scene
        .points()
        .into_iter()
        .map(|point| EdgePoint { column_q16: point.column_q16 + if point.row > 240 { q16(4.0) } else { 0 }, ..point })
        .collect();
    assert_eq!(range_of::<f32>(&scene, Uncertainty::default(), &broken).status, RangeStatus::Bent);
}

#[test]
fn a_line_of_fewer_than_eight_points_is_short() {
    let scene = Scene::vga();
    for count in 1..8 {
        let range = range_of::<f64>(&scene, Uncertainty::NONE, &scene.points()[..count]);
        assert_eq!(range.status, RangeStatus::Short, "{count} points");
        assert_eq!(usize::from(range.points), count);
    }
    assert_ne!(range_of::<f64>(&scene, Uncertainty::NONE, &scene.points()[..8]).status, RangeStatus::Short);
}

/// Upright edges run along the rows of a camera that lies on its side, or looks straight up or down.
#[test]
fn a_camera_on_its_side_is_sideways() {
    let line: Line<16> = line_of(&Scene::vga().points());
    for gravity in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.05, 0.0]] {
        let scene = Scene { gravity, ..Scene::vga() };
        let range = Range::from_line(&scene.setup::<f32>(), &scene.motion(), &line);
        assert_eq!(range.status, RangeStatus::Sideways, "{gravity:?}");
        assert_eq!(range.estimate.sigma_inverse_depth_per_m, 1e6);
        assert!(range.column_at_first_row.is_finite());
    }
}

/// An edge that leans, with the width of one that does not move: its numbers look sound.
fn leaning() -> Range<f32> {
    let scene = Scene::vga();
    let blur = MotionBlur::from_calibrated_lens(0.008, 0.7);
    let setup = scene.setup_with(tilt_of(TENTH_DEGREE)).with_response(Response::Linear);
    let setup = setup.with_motion_blur(blur).expect("sound blur");
    // √(0.7² + 1/12) px.
    let points: Vec<_> = scene.points().into_iter().map(|point| EdgePoint { width_q8: 194, ..point }).collect();
    Range::from_line(&setup, &scene.motion(), &line_of::<16>(&points))
}

#[test]
fn a_range_hands_out_no_more_than_its_status_allows() {
    let seven: Vec<_> = Scene::vga().points().into_iter().step_by(70).collect();
    let short = range_of::<f32>(&Scene::vga(), Uncertainty::NONE, &seven);
    let (two, estimate) = (Sigmas(2.0), &short.estimate);
    assert_eq!((short.status, estimate.status()), (RangeStatus::Short, RangeStatus::Ok), "{short:?}");
    for (allowed, by_numbers) in
        [(short.depth(two), estimate.depth(two)), (short.distance(two), estimate.distance(two))]
    {
        assert!(by_numbers.estimate_m.is_some() && by_numbers.nearest_m.is_some());
        assert_eq!(allowed, Interval { estimate_m: None, ..by_numbers }, "bounds, but no most likely value");
    }
    let leaning = leaning();
    let estimate = &leaning.estimate;
    assert_eq!((leaning.status, estimate.status()), (RangeStatus::Leaning, RangeStatus::Ok), "{leaning:?}");
    for interval in [leaning.depth(two), leaning.distance(two)] {
        assert_eq!(interval, Interval { estimate_m: None, nearest_m: None, farthest_m: None }, "nothing");
    }
}

#[test]
fn the_first_row_is_the_topmost_and_its_column_is_fitted() {
    let scene = Scene { velocity_m_s: [-1.2, 0.0, 0.5], rate_rad_s: [0.1, 0.3, -0.2], ..Scene::vga() };
    let range = range_of::<f64>(&scene, Uncertainty::NONE, &scene.points());
    assert_eq!((range.first_row, range.last_row), (0, 479));
    // What the curve within a knot costs.
    assert!((range.column_at_first_row - scene.column(0)).abs() < 1e-3);
}

#[test]
fn a_range_reads_like_a_sentence() {
    let scene = Scene::vga();
    assert_eq!(range(&scene).to_string(), "2.0 m ± 0.1");
    let exact = range_of::<f32>(&scene, Uncertainty::NONE, &scene.points());
    assert_eq!(exact.to_string(), "2.000 m ± 0.002");
    let far = range(&Scene { depth_m: 400.0, ..scene.clone() });
    let bound_m = far.depth(Sigmas(2.0)).nearest_m.expect("a bound");
    // A lower bound is rounded downwards.
    assert_eq!(far.to_string(), format!("farther than {} m", bound_m.floor()));
    assert!(bound_m > 10.0 && bound_m.fract() > 0.0, "{bound_m}");
    let still = range(&Scene { velocity_m_s: [0.0; 3], ..scene.clone() });
    assert_eq!(still.to_string(), "the motion says too little");
    let short = range_of::<f32>(&scene, tilt_of(TENTH_DEGREE), &scene.points()[..5]);
    assert_eq!(short.to_string(), "too short");
    let against = Scene { velocity_m_s: [1.5, 0.0, 0.0], ..scene.clone() };
    let against = range_of::<f32>(&against, tilt_of(TENTH_DEGREE), &scene.points());
    assert_eq!(against.to_string(), "slopes against the motion");
}

/// Of edges at infinity half come out behind the camera, within three sigma. No such thing exists: each has a bound, and
/// none is farther than of an edge that noise has left just at infinity.
#[test]
fn what_is_far_has_a_bound_at_any_sigma() {
    let random = &mut seed(71);
    let (mut behind, mut beyond) = (0, 0);
    for _ in 0..1000 {
        let scene = Scene { depth_m: 1e6, tilt: TENTH_DEGREE * normal(random), ..Scene::vga() };
        let range = range(&scene);
        if range.status != RangeStatus::Far {
            continue;
        }
        let sigma_per_m = range.estimate.sigma_inverse_depth_per_m;
        behind += u32::from(range.estimate.inverse_depth_per_m < -sigma_per_m);
        for sigmas in [0.5, 1.0, 2.0, 3.0] {
            let depth = range.depth(Sigmas(sigmas));
            let nearest_m = depth.nearest_m.expect("a bound");
            assert!(nearest_m <= 1.001 / (sigmas * sigma_per_m) && nearest_m > 5.0, "{sigmas} sigmas: {range:?}");
            assert_eq!(depth.estimate_m, None);
        }
        let message =
            DistanceSensor::of_range(&range, &Reach::new(0.2, 10.0).expect("a sound reach"), [1.0, 0.0, 0.0, 0.0]);
        // Of nothing it has a quality of 1.
        beyond += u32::from((message.current_distance, message.signal_quality) == (1001, 100));
    }
    // One in six is below minus one sigma.
    assert!(behind > 100 && beyond > 700, "{behind}, {beyond}");
}
