//! `Tracker` and `Ranger`: which edges become which line.

use rand::{Rng, SeedableRng, rngs::StdRng};
use shutter_range::{EdgePoint, Estimate, Polarity, Range, RangeStatus, Ranger, ReadoutDirection, Uncertainty};

use crate::projection::Scene;
use crate::scenes::{TENTH_DEGREE, q16, reference_lines, tilt_of};

/// Streams rows of edges (from the top) through a ranger and returns its ranges from left to right.
fn ranges(scene: &Scene, rows: &[Vec<EdgePoint>]) -> Vec<Range<f64>> {
    let setup = scene.setup_with::<f64>(tilt_of(TENTH_DEGREE));
    let mut ranger: Ranger<32, 16, 64> = Ranger::new();
    let mut found = Vec::new();
    for (row, edges) in rows.iter().enumerate() {
        for edge in edges {
            ranger.edge_point(&setup, *edge).expect("a sound edge");
        }
        ranger.end_row(&setup, row as u16).expect("rows in order");
        found.extend(std::iter::from_fn(|| ranger.next_range(&setup, &scene.motion())));
    }
    ranger.end_frame(&setup);
    found.extend(std::iter::from_fn(|| ranger.next_range(&setup, &scene.motion())));
    found.sort_by(|a, b| a.column_at_first_row.total_cmp(&b.column_at_first_row));
    found
}

/// Several edges in one frame: a bearing, a depth and a polarity each.
fn rows_of(scene: &Scene, posts: &[(f64, f64, Polarity)]) -> Vec<Vec<EdgePoint>> {
    let edge = |row, &(bearing, depth_m, polarity): &(f64, f64, Polarity)| {
        let column = Scene { bearing, depth_m, ..scene.clone() }.column(row);
        (0.0..639.0).contains(&column).then(|| scene.edge_at(row, column).with_polarity(polarity))
    };
    (0..scene.rows).map(|row| posts.iter().filter_map(|post| edge(row, post)).collect()).collect()
}

fn assert_depths(found: &[Range<f64>], depths_m: &[f64]) {
    assert_eq!(found.len(), depths_m.len(), "{found:#?}");
    for (range, depth_m) in found.iter().zip(depths_m) {
        assert_eq!(range.status, RangeStatus::Ok);
        let off = range.estimate.inverse_depth_per_m * depth_m - 1.0;
        assert!(off.abs() < 1e-3, "{depth_m} m: {off}");
    }
}

use Polarity::{Falling, Rising};

#[test]
fn several_lines_in_one_frame() {
    let posts =
        [(-0.3, 2.0, Rising), (-0.25, 2.0, Falling), (0.0, 5.0, Rising), (0.1, 1.0, Rising), (0.3, 3.0, Falling)];
    let scene = Scene::vga();
    assert_depths(&ranges(&scene, &rows_of(&scene, &posts)), &[2.0, 2.0, 5.0, 1.0, 3.0]);
}

/// Two edges of a thin rod, three pixels apart, and a third of the same polarity close by.
#[test]
fn close_neighbours() {
    let posts = [(0.0, 2.0, Rising), (3.0 / 600.0, 2.0, Falling), (8.0 / 600.0, 2.0, Rising)];
    let scene = Scene::vga();
    assert_depths(&ranges(&scene, &rows_of(&scene, &posts)), &[2.0, 2.0, 2.0]);
}

/// Two edges of one polarity within each other's blur, of which the older one is not seen for a row: fewer edges than there are, but
/// each in its own line.
#[test]
fn two_within_their_blur() {
    let scene = Scene::vga();
    for (apart_px, width_q8) in [(1.5, 256), (3.0, 512)] {
        let posts = [(0.0, 2.0, Rising), (apart_px / 600.0, 2.0, Rising)];
        let mut rows = rows_of(&scene, &posts);
        for edge in rows.iter_mut().flatten() {
            edge.width_q8 = width_q8;
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

/// A near post overtakes a far one: the lines cross and keep their identity by slope, not by order.
#[test]
fn crossing_lines() {
    let scene = Scene::vga();
    let posts = [(0.0, 1.0, Rising), (0.02, 8.0, Rising)];
    let mut rows = rows_of(&scene, &posts);
    // Where they cross, the nearer hides the farther.
    for edges in &mut rows {
        if let [near, far] = edges[..] {
            if (near.column_q16 - far.column_q16).abs() < q16(0.3) {
                edges.pop();
            }
        }
    }
    let found = ranges(&scene, &rows);
    let mut depths: Vec<_> = found.iter().filter(|range| range.points > 300).collect();
    depths.sort_by(|a, b| b.estimate.inverse_depth_per_m.total_cmp(&a.estimate.inverse_depth_per_m));
    assert_eq!(depths.len(), 2, "{found:#?}");
    assert!((depths[0].estimate.inverse_depth_per_m - 1.0).abs() < 1e-3);
    assert!((depths[1].estimate.inverse_depth_per_m * 8.0 - 1.0).abs() < 1e-2);
}

/// Noisy posts that cross, quickly and slowly: whatever becomes of the lines, no distance is wrong.
#[test]
fn crossing_lines_under_noise() {
    let scene = Scene::vga();
    let mut random = StdRng::seed_from_u64(11);
    for (apart, near_m, far_m) in [(0.02, 1.0, 6.0), (0.008, 2.0, 4.0), (0.004, 1.5, 2.0)] {
        for sigma_px in [0.05, 0.1, 0.3] {
            let mut rows = rows_of(&scene, &[(0.0, near_m, Rising), (apart, far_m, Rising)]);
            for edge in rows.iter_mut().flatten() {
                let noise: f64 = random.sample(rand_distr::StandardNormal);
                edge.column_q16 += q16(noise * sigma_px);
                edge.sigma_q16 = q16(sigma_px) as u32;
            }
            let found = ranges(&scene, &rows);
            assert!(found.iter().any(|range| range.status == RangeStatus::Ok), "{apart} {sigma_px}");
            for range in found.iter().filter(|range| range.status == RangeStatus::Ok) {
                let Estimate { inverse_depth_per_m, sigma_inverse_depth_per_m, .. } = range.estimate;
                let off = |depth_m: f64| (inverse_depth_per_m - 1.0 / depth_m).abs() / sigma_inverse_depth_per_m;
                assert!(off(near_m).min(off(far_m)) < 5.0, "{apart} rad, {sigma_px} px: {range:#?}");
            }
        }
    }
}

#[test]
fn gaps_of_a_few_rows() {
    let scene = Scene::vga();
    let mut rows = rows_of(&scene, &[(0.05, 2.0, Rising)]);
    rows[100..112].iter_mut().for_each(Vec::clear);
    rows[300..305].iter_mut().for_each(Vec::clear);
    assert_depths(&ranges(&scene, &rows), &[2.0]);
    // A long gap ends the line, and another begins.
    rows[150..280].iter_mut().for_each(Vec::clear);
    assert_depths(&ranges(&scene, &rows), &[2.0, 2.0]);
}

/// One row in ten, and only those are streamed.
#[test]
fn sparse_rows() {
    let scene = Scene::vga();
    let setup = scene.setup::<f64>();
    for step in [2, 10, 23] {
        let mut ranger: Ranger<8, 16, 8> = Ranger::new();
        for edges in rows_of(&scene, &[(-0.2, 3.0, Rising), (0.05, 1.0, Rising)]).iter().step_by(step) {
            for edge in edges {
                ranger.edge_point(&setup, *edge).expect("a sound edge");
            }
        }
        ranger.end_frame(&setup);
        let mut found: Vec<_> =
            std::iter::from_fn(|| ranger.next_range(&setup, &scene.motion())).collect::<Vec<Range<f64>>>();
        found.sort_by(|a, b| a.column_at_first_row.total_cmp(&b.column_at_first_row));
        assert_depths(&found, &[3.0, 1.0]);
    }
}

/// Edges that attitude and rotation bend stay one line, on every row and on one in twenty.
#[test]
fn curved_edges_are_one_line() {
    for line in reference_lines() {
        let scene = line.scene();
        let setup = scene.setup::<f64>();
        for edges in [line.edges(), scene.edges()] {
            let mut ranger: Ranger<4, 32, 4> = Ranger::new();
            for edge in edges {
                ranger.edge_point(&setup, edge).expect("a sound edge");
            }
            ranger.end_frame(&setup);
            let found = ranger.ranges(&setup, &scene.motion::<f64>());
            assert_eq!(found.len(), 1, "{}: {found:#?}", line.kind);
            let off = found[0].estimate.inverse_depth_per_m * line.truth.depth_m - 1.0;
            assert!(off.abs() < 1e-3, "{}: {off}", line.kind);
        }
    }
}

/// False edges everywhere: true lines are found, stray edges are counted and make few lines.
#[test]
fn noise_between() {
    let scene = Scene::vga();
    let mut random = StdRng::seed_from_u64(7);
    let mut rows = rows_of(&scene, &[(-0.1, 2.0, Rising), (0.15, 1.5, Falling)]);
    for (row, edges) in rows.iter_mut().enumerate() {
        for _ in 0..2 {
            let polarity = if random.random() { Rising } else { Falling };
            edges.push(scene.edge_at(row as u16, random.random_range(0.0..639.0)).with_polarity(polarity));
        }
    }
    let found = ranges(&scene, &rows);
    let long: Vec<_> = found.iter().filter(|range| range.points > 400).collect();
    assert_eq!(long.len(), 2, "{found:#?}");
    for (range, depth_m) in long.iter().zip([2.0, 1.5]) {
        let off = (range.estimate.inverse_depth_per_m - 1.0 / depth_m).abs();
        assert!(off < 3.0 * range.estimate.sigma_inverse_depth_per_m, "{range:?}");
    }
}

#[test]
fn a_full_table_refuses_the_newcomer_and_keeps_its_lines() {
    let scene = Scene::vga();
    let setup = scene.setup::<f64>();
    let posts: Vec<_> = (0..6).map(|k| (f64::from(k) * 0.08 - 0.3, 3.0, Rising)).collect();
    let mut ranger: Ranger<4, 16, 16> = Ranger::new();
    for edges in rows_of(&scene, &posts) {
        // From row 100 on, two more lines than there is room for.
        let known = if edges[0].row < 100 { 4 } else { 6 };
        for edge in edges.iter().take(known) {
            ranger.edge_point(&setup, *edge).expect("a sound edge");
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
        ranger.edge_point(&setup, EdgePoint::new(0, column << 16, 0)).expect("a sound edge");
    }
    assert_eq!(ranger.counters().dropped_points, 2);
}

/// Each row's edges may come in any order.
#[test]
fn order_within_a_row_is_free() {
    let scene = Scene::vga();
    let rows = rows_of(&scene, &[(-0.3, 2.0, Rising), (0.0, 5.0, Rising), (0.1, 1.0, Rising)]);
    let mut shuffled = rows.clone();
    shuffled.iter_mut().for_each(|edges| edges.reverse());
    assert_eq!(ranges(&scene, &rows), ranges(&scene, &shuffled));
}

/// Lines that nobody takes stay in the table, also over frames.
#[test]
fn ended_lines_wait() {
    let scene = Scene::vga();
    let setup = scene.setup::<f64>();
    let mut ranger: Ranger<4, 16, 16> = Ranger::new();
    for _frame in 0..2 {
        for edges in rows_of(&scene, &[(-0.2, 2.0, Rising), (0.1, 1.0, Rising)]) {
            for edge in edges {
                ranger.edge_point(&setup, edge).expect("a sound edge");
            }
        }
        ranger.end_frame(&setup);
    }
    assert_eq!(ranger.ranges(&setup, &scene.motion::<f64>()).len(), 4);
    let counters = ranger.counters();
    assert_eq!((counters.points, counters.stray_points, counters.dropped_lines), (2 * 2 * 480, 0, 0));
}

#[test]
fn from_below() {
    let scene = Scene::vga();
    let setup = scene.setup_read::<f64>(Uncertainty::NONE, ReadoutDirection::BottomToTop);
    let mut ranger: Ranger<4, 16, 4> = Ranger::new();
    for before in 0..scene.rows {
        let row = scene.rows - 1 - before;
        let column = scene.column_at(f64::from(row), scene.time_s(before));
        let time_ns = setup.readout().row_time_ns(row);
        ranger.edge_point(&setup, EdgePoint::new(row, q16(column), time_ns)).expect("a sound edge");
    }
    ranger.end_frame(&setup);
    let found = ranger.ranges(&setup, &scene.motion::<f64>());
    assert_depths(&found, &[2.0]);
    assert_eq!((found[0].first_row, found[0].last_row), (0, 479));
    let top = scene.column_at(0.0, scene.time_s(479));
    assert!((found[0].column_at_first_row - top).abs() < 1e-3);
}

/// A static ranger costs nothing at start and is as good as any.
#[test]
fn can_be_a_static() {
    static RANGER: std::sync::Mutex<Ranger<4, 8, 4>> = std::sync::Mutex::new(Ranger::new());
    assert!(RANGER.lock().expect("not poisoned").counters().dropped_points == 0);
}
