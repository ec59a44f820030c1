//! Stamps as real boards give them: in ticks, in blocks, late, or of another clock altogether.

use rand::{Rng, SeedableRng, rngs::StdRng};
use shutter_range::{EdgeError, EdgePoint, Range, RangeStatus, Ranger, Setup, StampPolicy, Uncertainty};

use crate::projection::Scene;
use crate::scenes::{TENTH_DEGREE, tilt_of};

const MS: i64 = 1_000_000;

/// The range of the scene's edge with stamps of another clock.
fn range_with(setup: &Setup<f64>, scene: &Scene, stamp: impl Fn(&EdgePoint) -> i64) -> Result<Range<f64>, EdgeError> {
    let mut ranger: Ranger<8, 16, 8> = Ranger::new();
    for point in scene.edges() {
        ranger.edge_point(setup, EdgePoint { time_ns: stamp(&point), ..point })?;
    }
    ranger.end_frame(setup);
    let mut ranges = ranger.ranges(setup, &scene.motion::<f64>());
    assert_eq!(ranges.len(), 1, "{ranges:?}");
    Ok(ranges.remove(0))
}

fn setup(scene: &Scene) -> Setup<f64> {
    scene.setup_with(tilt_of(TENTH_DEGREE))
}

fn assert_right(name: &str, range: &Range<f64>, scene: &Scene) {
    let off = range.estimate.inverse_depth_per_m * scene.depth_m - 1.0;
    assert_eq!(range.status, RangeStatus::Ok, "{name}: {range:?}");
    assert!(off.abs() < 1e-3, "{name}: {off}");
}

#[test]
fn ticks_blocks_and_late_rows_leave_the_time_to_the_readout() {
    let scene = Scene { depth_m: 3.0, ..Scene::vga() };
    let setup = setup(&scene);
    let ticks = |tick_ns: i64| move |point: &EdgePoint| point.time_ns / tick_ns * tick_ns;
    for tick_ns in [MS / 2, MS, 4 * MS, 10 * MS] {
        let range = range_with(&setup, &scene, ticks(tick_ns)).expect("within the frame");
        assert_right(&format!("ticks of {tick_ns} ns"), &range, &scene);
    }
    let line_time_ns = setup.readout().row_time_ns(1);
    for rows in [16, 40, 120] {
        let block = |point: &EdgePoint| i64::from(point.row / rows * rows) * line_time_ns;
        let range = range_with(&setup, &scene, block).expect("within the frame");
        assert_right(&format!("blocks of {rows} rows"), &range, &scene);
    }
    for from_row in [10, 200, 470] {
        let late = |point: &EdgePoint| point.time_ns + if point.row >= from_row { 2 * MS } else { 0 };
        let range = range_with(&setup, &scene, late).expect("late by less than the frame");
        assert_right(&format!("late from row {from_row}"), &range, &scene);
    }
}

#[test]
fn jitter_of_an_interrupt_is_harmless() {
    let scene = Scene { depth_m: 3.0, ..Scene::vga() };
    let mut random = StdRng::seed_from_u64(1);
    let jitter: Vec<i64> = (0..480).map(|_| random.random_range(0..50_000)).collect();
    let jittered = |point: &EdgePoint| point.time_ns + jitter[usize::from(point.row)];
    let range = range_with(&setup(&scene), &scene, jittered).expect("within the frame");
    // Averaged over 480 rows, 50 µs are a few millionths of a metre of path; their mean is a constant delay.
    assert_right("jitter", &range, &scene);
}

#[test]
fn stamps_of_another_clock_are_an_error_that_names_both_times() {
    let scene = Scene { depth_m: 3.0, ..Scene::vga() };
    let setup = setup(&scene);
    let since_boot = range_with(&setup, &scene, |point| point.time_ns + 120_000 * MS).expect_err("120 s too late");
    assert_eq!(since_boot, EdgeError::Stamp { row: 0, time_ns: 120_000 * MS, expected_ns: 0 });
    let in_ms = range_with(&setup, &scene, |point| point.time_ns / 1_000_000).expect_err("a thousandth of the pace");
    let EdgeError::Stamp { row, expected_ns, .. } = in_ms else { panic!("{in_ms}") };
    assert_eq!(expected_ns, setup.readout().row_time_ns(row));
    let too_fast = range_with(&setup, &scene, |point| point.time_ns * 2).expect_err("twice the pace");
    assert!(matches!(too_fast, EdgeError::Stamp { .. }), "{too_fast}");
    assert!(since_boot.to_string().contains("120000000000 ns"), "{since_boot}");
}

#[test]
fn trusted_stamps_replace_a_wrong_readout_and_ignored_ones_are_not_looked_at() {
    let scene = Scene { depth_m: 3.0, ..Scene::vga() };
    // The readout is said to be twice as fast as the stamps tell.
    let wrong = Scene { readout_s: scene.readout_s / 2.0, ..scene.clone() };
    let trusting = setup(&wrong).with_stamp_policy(StampPolicy::Trusted);
    let range = range_with(&trusting, &scene, |point| point.time_ns).expect("trusted");
    assert_right("trusted", &range, &scene);
    let ignoring = setup(&scene).with_stamp_policy(StampPolicy::Ignored);
    let range = range_with(&ignoring, &scene, |_| 0).expect("ignored");
    assert_right("ignored", &range, &scene);
}

#[test]
fn a_readout_that_is_off_by_a_few_per_cent_is_told_by_the_stamps() {
    let scene = Scene { depth_m: 3.0, ..Scene::vga() };
    let slower = Scene { readout_s: scene.readout_s * 0.98, ..scene.clone() };
    let setup = slower.setup_with::<f64>(Uncertainty::NONE);
    let range = range_with(&setup, &scene, |point| point.time_ns).expect("within a twentieth");
    assert_right("2 % slower than stated", &range, &scene);
}
