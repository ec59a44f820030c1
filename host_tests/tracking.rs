//! `Tracker` and `Ranger`: which points become which line.

use rand::{Rng, SeedableRng, rngs::StdRng};
use shutter_range::{EdgePoint, Estimate, Polarity, Range, RangeStatus, Ranger, ReadoutDirection, Uncertainty};

use crate::projection::Scene;
use crate::scenes::{TENTH_DEGREE, q16, reference_lines, tilt_of};

/// Streams rows of points (from the top) through a ranger and returns its ranges from left to right.
fn ranges(scene: &Scene, rows: &[Vec<EdgePoint>]) -> Vec<Range<f64>> {
    let setup = scene.setup_with::<f64>(tilt_of(TENTH_DEGREE));
    let mut ranger: Ranger<32, 16, 64> = Ranger::new();
    let mut found = Vec::new();
    for (row, points) in rows.iter().enumerate() {
        for point in points {
            ranger.edge_point(&setup, *point).expect("a sound point");
        }
        ranger.end_row(&setup, row as u16).expect("rows in order");
        found.extend(std::iter::from_fn(|| ranger.next_range(&setup, &scene.motion())));
    }
    ranger.end_frame(&setup);
    found.extend(std::iter::from_fn(|| ranger.next_range(&setup, &scene.motion())));
    found.sort_by(|a, b| a.column_at_first_row.total_cmp(&b.column_at_first_row));
    found
}

/// The points of several posts in one frame, row by row: a bearing, a depth and a polarity each.
fn rows_of(scene: &Scene, posts: &[(f64, f64, Polarity)]) -> Vec<Vec<EdgePoint>> {
    let point = |row, &(bearing, depth_m, polarity): &(f64, f64, Polarity)| {
        let column = Scene { bearing, depth_m, ..scene.clone() }.column(row);
        (0.0..639.0).contains(&column).then(|| scene.point_at(row, column).with_polarity(polarity))
    };
    (0..scene.rows).map(|row| posts.iter().filter_map(|post| point(row, post)).collect()).collect()
}

fn assert_depths(found: &[Range<f64>], depths_m: &[f64]) {
    assert_eq!(found.len(), depths_m.len(), "{found:#?}");
    for (range, depth_m) in found.iter().zip(depths_m) {
        assert_eq!(range.status, RangeStatus::Ok);
        let error = range.estimate.inverse_depth_per_m * depth_m - 1.0;
        assert!(error.abs() < MOST_ERROR, "{depth_m} m: {error}");
    }
}

use Polarity::{Falling, Rising};

/// Most relative error of a depth from exact points: what rounding to 1/65536 px, knots and sparse rows cost. A single
/// point of another edge would cost more.
const MOST_ERROR: f64 = 1e-3;

#[test]
fn several_lines_are_tracked_at_once() {
    let posts =
        [(-0.3, 2.0, Rising), (-0.25, 2.0, Falling), (0.0, 5.0, Rising), (0.1, 1.0, Rising), (0.3, 3.0, Falling)];
    let scene = Scene::vga();
    assert_depths(&ranges(&scene, &rows_of(&scene, &posts)), &[2.0, 2.0, 5.0, 1.0, 3.0]);
}

/// Two edges of a thin rod, three pixels apart, and a third of the same polarity close by.
#[test]
fn close_neighbours_stay_apart() {
    let posts = [(0.0, 2.0, Rising), (3.0 / 600.0, 2.0, Falling), (8.0 / 600.0, 2.0, Rising)];
    let scene = Scene::vga();
    assert_depths(&ranges(&scene, &rows_of(&scene, &posts)), &[2.0, 2.0, 2.0]);
}

/// Two edges of one polarity within each other's blur, of which the older one is not seen in a row: there may be fewer
/// lines than edges, but none has points of both.
#[test]
fn two_edges_within_their_blur_are_not_mixed() {
    let scene = Scene::vga();
    for (apart_px, width_q8) in [(1.5, 256), (3.0, 512)] {
        let posts = [(0.0, 2.0, Rising), (apart_px / 600.0, 2.0, Rising)];
        let mut rows = rows_of(&scene, &posts);
        for point in rows.iter_mut().flatten() {
            point.width_q8 = width_q8;
        }
        rows[..200].iter_mut().for_each(|row| row.truncate(1));
        for row in [202, 204, 206] {
            let mut missed = rows.clone();
            missed[row].remove(0);
            let mut found = ranges(&scene, &missed);
            found.retain(|range| range.status != RangeStatus::Short);
            assert_depths(&found, &vec![2.0; found.len().max(1)]);
        }
    }
}

/// A near post overtakes a far one: it is the slope that tells the lines apart, not their order.
#[test]
fn crossing_lines_keep_their_identity_by_slope() {
    let scene = Scene::vga();
    let posts = [(0.0, 1.0, Rising), (0.02, 8.0, Rising)];
    let mut rows = rows_of(&scene, &posts);
    // Where they cross, the nearer hides the farther.
    for points in &mut rows {
        if let [near, far] = points[..] {
            if (near.column_q16 - far.column_q16).abs() < q16(0.3) {
                points.pop();
            }
        }
    }
    let found = ranges(&scene, &rows);
    let mut long: Vec<_> = found.iter().filter(|range| range.points > 300).collect();
    long.sort_by(|a, b| b.estimate.inverse_depth_per_m.total_cmp(&a.estimate.inverse_depth_per_m));
    assert_eq!(long.len(), 2, "most of their 480 points each: {found:#?}");
    assert!((long[0].estimate.inverse_depth_per_m - 1.0).abs() < MOST_ERROR);
    // With an eighth of the slope, and the gap where it was hidden.
    assert!((long[1].estimate.inverse_depth_per_m * 8.0 - 1.0).abs() < 10.0 * MOST_ERROR);
}

/// They cross quickly and slowly: whatever becomes of the lines, no depth is wrong.
#[test]
fn crossing_lines_under_noise_give_no_wrong_depth() {
    // Chance in 18 ranges, and the points around the crossing that the other line may have taken.
    const MOST_SIGMAS: f64 = 5.0;
    let scene = Scene::vga();
    let mut random = StdRng::seed_from_u64(11);
    for (apart, near_m, far_m) in [(0.02, 1.0, 6.0), (0.008, 2.0, 4.0), (0.004, 1.5, 2.0)] {
        for sigma_px in [0.05, 0.1, 0.3] {
            let mut rows = rows_of(&scene, &[(0.0, near_m, Rising), (apart, far_m, Rising)]);
            for point in rows.iter_mut().flatten() {
                let noise: f64 = random.sample(rand_distr::StandardNormal);
                point.column_q16 += q16(noise * sigma_px);
                point.sigma_q16 = q16(sigma_px) as u32;
            }
            let found = ranges(&scene, &rows);
            assert!(found.iter().any(|range| range.status == RangeStatus::Ok), "{apart} {sigma_px}");
            for range in found.iter().filter(|range| range.status == RangeStatus::Ok) {
                let Estimate { inverse_depth_per_m, sigma_inverse_depth_per_m, .. } = range.estimate;
                let sigmas = |depth_m: f64| (inverse_depth_per_m - 1.0 / depth_m).abs() / sigma_inverse_depth_per_m;
                assert!(sigmas(near_m).min(sigmas(far_m)) < MOST_SIGMAS, "{apart} rad, {sigma_px} px: {range:#?}");
            }
        }
    }
}

#[test]
fn a_line_goes_on_over_gaps_of_a_few_rows() {
    let scene = Scene::vga();
    let mut rows = rows_of(&scene, &[(0.05, 2.0, Rising)]);
    rows[100..112].iter_mut().for_each(Vec::clear);
    rows[300..305].iter_mut().for_each(Vec::clear);
    assert_depths(&ranges(&scene, &rows), &[2.0]);
    // A long gap ends the line, and another begins.
    rows[150..280].iter_mut().for_each(Vec::clear);
    assert_depths(&ranges(&scene, &rows), &[2.0, 2.0]);
}

/// Only one row in two, ten or 23 is streamed.
#[test]
fn sparse_rows_make_lines() {
    let scene = Scene::vga();
    let setup = scene.setup::<f64>();
    for step in [2, 10, 23] {
        let mut ranger: Ranger<8, 16, 8> = Ranger::new();
        for points in rows_of(&scene, &[(-0.2, 3.0, Rising), (0.05, 1.0, Rising)]).iter().step_by(step) {
            for point in points {
                ranger.edge_point(&setup, *point).expect("a sound point");
            }
        }
        ranger.end_frame(&setup);
        let mut found: Vec<_> =
            std::iter::from_fn(|| ranger.next_range(&setup, &scene.motion())).collect::<Vec<Range<f64>>>();
        found.sort_by(|a, b| a.column_at_first_row.total_cmp(&b.column_at_first_row));
        assert_depths(&found, &[3.0, 1.0]);
    }
}

/// Attitude and rotation bend them; on every row and on one in twenty.
#[test]
fn curved_edges_are_one_line() {
    for line in reference_lines() {
        let scene = line.scene();
        let setup = scene.setup::<f64>();
        for points in [line.points(), scene.points()] {
            let mut ranger: Ranger<4, 32, 4> = Ranger::new();
            for point in points {
                ranger.edge_point(&setup, point).expect("a sound point");
            }
            ranger.end_frame(&setup);
            let found = ranger.ranges(&setup, &scene.motion::<f64>());
            assert_eq!(found.len(), 1, "{}: {found:#?}", line.kind);
            let error = found[0].estimate.inverse_depth_per_m * line.truth.depth_m - 1.0;
            assert!(error.abs() < MOST_ERROR, "{}: {error}", line.kind);
        }
    }
}

#[test]
fn lines_are_found_among_false_points() {
    let scene = Scene::vga();
    let mut random = StdRng::seed_from_u64(7);
    let mut rows = rows_of(&scene, &[(-0.1, 2.0, Rising), (0.15, 1.5, Falling)]);
    for (row, points) in rows.iter_mut().enumerate() {
        for _ in 0..2 {
            let polarity = if random.random() { Rising } else { Falling };
            points.push(scene.point_at(row as u16, random.random_range(0.0..639.0)).with_polarity(polarity));
        }
    }
    let found = ranges(&scene, &rows);
    let long: Vec<_> = found.iter().filter(|range| range.points > 400).collect();
    assert_eq!(long.len(), 2, "nearly all of their 480 points each: {found:#?}");
    for (range, depth_m) in long.iter().zip([2.0, 1.5]) {
        let error = (range.estimate.inverse_depth_per_m - 1.0 / depth_m).abs();
        assert!(error < 3.0 * range.estimate.sigma_inverse_depth_per_m, "three sigma: {range:?}");
    }
}

#[test]
fn a_full_table_refuses_the_newcomer_and_keeps_its_lines() {
    let scene = Scene::vga();
    let setup = scene.setup::<f64>();
    let posts: Vec<_> = (0..6).map(|k| (f64::from(k) * 0.08 - 0.3, 3.0, Rising)).collect();
    let mut ranger: Ranger<4, 16, 16> = Ranger::new();
    for points in rows_of(&scene, &posts) {
        // From row 100 on, two more lines than there is room for.
        let known = if points[0].row < 100 { 4 } else { 6 };
        for point in points.iter().take(known) {
            ranger.edge_point(&setup, *point).expect("a sound point");
        }
    }
    ranger.end_frame(&setup);
    let found = ranger.ranges(&setup, &scene.motion::<f64>());
    assert_depths(&found, &[3.0; 4]);
    assert!(found.iter().all(|range| range.points == 480));
    assert_eq!(ranger.counters().dropped_lines, 2 * 380);
    assert_eq!(ranger.counters().dropped_points, 2 * 380);
}

#[test]
fn a_full_row_refuses_the_newcomer() {
    let scene = Scene::vga();
    let setup = scene.setup::<f64>();
    let mut ranger: Ranger<8, 8, 3> = Ranger::new();
    for column in [10, 20, 30, 40, 50] {
        ranger.edge_point(&setup, EdgePoint::new(0, column << 16, 0)).expect("a sound point");
    }
    assert_eq!(ranger.counters().dropped_points, 2);
}

#[test]
fn the_points_of_a_row_come_in_any_order() {
    let scene = Scene::vga();
    let rows = rows_of(&scene, &[(-0.3, 2.0, Rising), (0.0, 5.0, Rising), (0.1, 1.0, Rising)]);
    let mut shuffled = rows.clone();
    shuffled.iter_mut().for_each(|points| points.reverse());
    assert_eq!(ranges(&scene, &rows), ranges(&scene, &shuffled));
}

/// Also over frames.
#[test]
fn ended_lines_wait_until_they_are_taken() {
    let scene = Scene::vga();
    let setup = scene.setup::<f64>();
    let mut ranger: Ranger<4, 16, 16> = Ranger::new();
    for _frame in 0..2 {
        for points in rows_of(&scene, &[(-0.2, 2.0, Rising), (0.1, 1.0, Rising)]) {
            for point in points {
                ranger.edge_point(&setup, point).expect("a sound point");
            }
        }
        ranger.end_frame(&setup);
    }
    assert_eq!(ranger.ranges(&setup, &scene.motion::<f64>()).len(), 4);
    let counters = ranger.counters();
    assert_eq!((counters.points, counters.stray_points, counters.dropped_lines), (2 * 2 * 480, 0, 0));
}

#[test]
fn rows_read_from_below_make_the_same_line() {
    let scene = Scene::vga();
    let setup = scene.setup_read::<f64>(Uncertainty::NONE, ReadoutDirection::BottomToTop);
    let mut ranger: Ranger<4, 16, 4> = Ranger::new();
    for before in 0..scene.rows {
        let row = scene.rows - 1 - before;
        let column = scene.column_at(f64::from(row), scene.time_s(before));
        let time_ns = setup.readout().row_time_ns(row);
        ranger.edge_point(&setup, EdgePoint::new(row, q16(column), time_ns)).expect("a sound point");
    }
    ranger.end_frame(&setup);
    let found = ranger.ranges(&setup, &scene.motion::<f64>());
    assert_depths(&found, &[2.0]);
    assert_eq!((found[0].first_row, found[0].last_row), (0, 479));
    let top = scene.column_at(0.0, scene.time_s(479));
    // Points of 1/65536 px, and what knots cost.
    assert!((found[0].column_at_first_row - top).abs() < 1e-3);
}

#[test]
fn a_ranger_can_be_a_static() {
    static RANGER: std::sync::Mutex<Ranger<4, 8, 4>> = std::sync::Mutex::new(Ranger::new());
    assert!(RANGER.lock().expect("not poisoned").counters().dropped_points == 0);
}
