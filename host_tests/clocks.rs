//! Stamps as real boards give them: in ticks, in blocks, late, or of another clock altogether.

use rand::{Rng, SeedableRng, rngs::StdRng};
use shutter_range::{EdgeError, EdgePoint, Range, RangeStatus, Ranger, Setup, StampPolicy, Uncertainty};

use crate::projection::Scene;
use crate::scenes::{TENTH_DEGREE, tilt_of};

const MS: i64 = 1_000_000;

/// The range of the scene's edge with stamps of another clock.
fn range_with(setup: &Setup<f64>, scene: &Scene, stamp: impl Fn(&EdgePoint) -> i64) -> Result<Range<f64>, EdgeError> {
    let mut ranger: Ranger<8, 16, 8> = Ranger::new();
    for point in scene.points() {
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

/// Nothing but the readout tells the time: stamps may be anything.
#[test]
fn ignored_stamps_may_be_anything() {
    let scene = Scene { depth_m: 3.0, ..Scene::vga() };
    let setup = setup(&scene).with_stamp_policy(StampPolicy::Ignored);
    for stamp in [|_| i64::MAX, |row: i64| -row * MS, |row: i64| 7_200_000 * MS + row, |row: i64| row % 7 * MS] {
        let range = range_with(&setup, &scene, |point| stamp(point.row.into())).expect("stamps are not looked at");
        assert_right("ignored", &range, &scene);
    }
}

/// Where stamps alone tell the time, one that is earlier than those of the rows before is refused wherever it stands in
/// its row; where the readout can tell it, it does.
#[test]
fn stamps_that_run_backwards() {
    let scene = Scene { depth_m: 3.0, ..Scene::vga() };
    let checked = setup(&scene);
    let trusted = checked.with_stamp_policy(StampPolicy::Trusted);
    let point = |row: u16, column: i32, time_ns: i64| EdgePoint::new(row, column << 16, time_ns);
    for before_in_row in [None, Some(110_000)] {
        let mut rangers: [Ranger<4, 8, 4>; 2] = [Ranger::new(), Ranger::new()];
        let [by_stamps, by_readout] = &mut rangers;
        for (ranger, setup) in [(&mut *by_stamps, &trusted), (&mut *by_readout, &checked)] {
            ranger.edge_point(setup, point(0, 100, 50_000)).expect("the first point");
            if let Some(time_ns) = before_in_row {
                ranger.edge_point(setup, point(1, 100, time_ns)).expect("a later point");
            }
        }
        let back = Err(EdgeError::TimeOrder { time_ns: 20_000, previous_ns: 50_000 });
        assert_eq!(by_stamps.edge_point(&trusted, point(1, 300, 20_000)), back);
        assert_eq!(by_stamps.edge_point(&trusted, point(1, 300, 50_000)), Ok(()));
        assert_eq!(by_readout.edge_point(&checked, point(1, 300, 20_000)), Ok(()));
        assert!(by_readout.has_irregular_stamps());
    }
}

/// One late interrupt costs no point of the rows after it.
#[test]
fn a_late_row_costs_no_other() {
    let scene = Scene { depth_m: 3.0, ..Scene::vga() };
    let setup = setup(&scene);
    for late_ns in [MS * 3 / 10, MS, 5 * MS, 13 * MS] {
        let late = |point: &EdgePoint| point.time_ns + if point.row == 100 { late_ns } else { 0 };
        let range = range_with(&setup, &scene, late).expect("late by less than the frame");
        assert_eq!(range.points, 480, "late by {late_ns} ns");
        assert_right(&format!("late by {late_ns} ns"), &range, &scene);
    }
}

/// Both points of the row in which stamps are found to be irregular have the readout's time.
#[test]
fn a_row_that_becomes_irregular_has_one_time() {
    let scene = Scene { depth_m: 3.0, ..Scene::vga() };
    let setup = scene.setup_with::<f64>(Uncertainty::NONE);
    let mut ranger: Ranger<8, 16, 8> = Ranger::new();
    for row in 0..480 {
        let time_ns = setup.readout().row_time_ns(row);
        let stamp_ns = time_ns * 104 / 100;
        for (column_px, late_ns) in [(200.0, 0), (400.0, if row == 300 { MS * 9 / 10 } else { 0 })] {
            let column_px = column_px + 400.0 * time_ns as f64 * 1e-9;
            let point = EdgePoint::new(row, (column_px * 65536.0) as i32, stamp_ns + late_ns);
            ranger.edge_point(&setup, point).expect("within the frame");
        }
    }
    assert!(ranger.has_irregular_stamps());
    ranger.end_frame(&setup);
    let lines: Vec<_> = std::iter::from_fn(|| ranger.next_line()).collect();
    let times = |line: &shutter_range::Line<16>| line.samples::<f64>().map(|sample| sample.time_s).collect::<Vec<_>>();
    assert_eq!(lines.iter().map(|line| line.points()).collect::<Vec<_>>(), [480, 480]);
    assert_eq!(times(&lines[0]), times(&lines[1]));
    assert_eq!(ranger.counters().stray_points, 0);
}

/// A row that is said to have no points tells nothing of the stamps of others: here they are 0.3 ms late, and 4 % slower
/// than the readout.
#[test]
fn an_empty_row_has_no_stamp() {
    let scene = Scene { depth_m: 3.0, ..Scene::vga() };
    let setup = scene.setup_with::<f64>(Uncertainty::NONE);
    let line = |ends_first_row: bool| {
        let mut ranger: Ranger<8, 16, 8> = Ranger::new();
        if ends_first_row {
            ranger.end_row(&setup, 0).expect("the first row");
        }
        for point in scene.points().into_iter().filter(|point| point.row > 0) {
            let time_ns = point.time_ns * 104 / 100 + MS * 3 / 10;
            ranger.edge_point(&setup, EdgePoint { time_ns, ..point }).expect("within the frame");
        }
        assert!(!ranger.has_irregular_stamps());
        ranger.end_frame(&setup);
        ranger.next_line().expect("a line")
    };
    assert_eq!(line(true), line(false));
}

/// A line that nobody has taken keeps the times of its own frame, also where the stamps of the next one are in ticks.
#[test]
fn a_line_that_waits_keeps_its_times() {
    let scene = Scene { depth_m: 3.0, ..Scene::vga() };
    let slower = Scene { readout_s: scene.readout_s * 0.98, ..scene.clone() };
    let setup = slower.setup_with::<f64>(Uncertainty::NONE);
    let first_line = |waits: bool| {
        let mut ranger: Ranger<8, 16, 8> = Ranger::new();
        let mut frame = |tick_ns: i64, waits: bool| {
            for point in scene.points() {
                let stamped = EdgePoint { time_ns: point.time_ns / tick_ns * tick_ns, ..point };
                ranger.edge_point(&setup, stamped).expect("within the frame");
            }
            ranger.end_frame(&setup);
            if waits { Vec::new() } else { std::iter::from_fn(|| ranger.next_line()).collect() }
        };
        let first = frame(1, waits);
        // The line that has ended last is taken first.
        let second = frame(4 * MS, false);
        first.into_iter().chain(second.into_iter().rev()).next().expect("a line of the first frame")
    };
    assert_eq!(first_line(true), first_line(false));
}
