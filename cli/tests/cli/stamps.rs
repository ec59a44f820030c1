//! Stamps of edge points against the readout: 33.3 ms for 480 rows.

use serde_json::Value;

use crate::tool::{Folder, SETUP, assert_near, column, number};

/// One edge at 3 m with the stamp that `time_s` makes of the row's own time; `rest` are more cells.
fn stamped(step: usize, header: &str, rest: &str, time_s: impl Fn(u32, f64) -> f64) -> String {
    let line = |row: u32| {
        let own_s = f64::from(row) * 0.0333 / 480.0;
        format!("{row},{:.4},{:.6}{rest}\n", column(0.05, 3.0, row), time_s(row, own_s))
    };
    format!("row,column,time_s{header}\n{}", (0..480).step_by(step).map(line).collect::<String>())
}

/// With and without the number of a line.
#[track_caller]
fn refuse(message: &str, time_s: impl Fn(u32, f64) -> f64) {
    for (header, rest) in [("", ""), (",line", ",1")] {
        let outcome = Folder::of(SETUP, &stamped(10, header, rest, &time_s)).edges();
        assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""));
        assert_eq!(outcome.stderr, format!("error: edges.csv: {message}\n"));
    }
}

#[test]
fn stamps_in_milliseconds_are_refused() {
    let near = "but must be near 0.000694, when a readout of 0.0333 s reads row 10";
    refuse(&format!("line 3: `time_s` is 0.69375, {near}: these seem to be milliseconds"), |_, own_s| own_s * 1e3);
    refuse(&format!("line 3: `time_s` is 693.75, {near}: these seem to be microseconds"), |_, own_s| own_s * 1e6);
}

#[test]
fn stamps_since_boot_are_refused() {
    let near = "but must be near 0.000000, when a readout of 0.0333 s reads row 0";
    let cause = "is it counted from frame start, in seconds, and not from the start of the clock?";
    refuse(&format!("line 2: `time_s` is 120, {near}: {cause}"), |_, own_s| own_s + 120.0);
    refuse(&format!("line 2: `time_s` is 1700000000, {near}: {cause}"), |_, own_s| own_s + 1.7e9);
}

const OTHER_CAUSE: &str = "is it the row's own since frame start? Check the readout time and `camera.direction`, too";

#[test]
fn stamps_of_another_frame_are_refused() {
    let near = "but must be near 0.000000, when a readout of 0.0333 s reads row 0";
    refuse(&format!("line 2: `time_s` is 0.04, {near}: {OTHER_CAUSE}"), |_, own_s| own_s + 0.04);
}

#[test]
fn stamps_at_another_pace_are_refused() {
    let near = "but must be near 0.026640, when a readout of 0.0333 s reads row 384";
    let message = format!("line 386: `time_s` is 0.01332, {near}: {OTHER_CAUSE}");
    for (header, rest) in [("", ""), (",line", ",1")] {
        let outcome = Folder::of(SETUP, &stamped(1, header, rest, |_, own_s| own_s / 2.0)).edges();
        assert_eq!((outcome.code, outcome.stderr), (1, format!("error: edges.csv: {message}\n")));
    }
    // As if it had been read from the bottom.
    let near = "but must be near 0.006938, when a readout of 0.0333 s reads row 100";
    refuse(&format!("line 12: `time_s` is 0.025669, {near}: {OTHER_CAUSE}"), |_, own_s| 0.0333 - own_s - 0.000694);
}

/// Both are half an exposure from the middle, which a stamp should be of.
#[test]
fn a_known_exposure_allows_for_either_end_of_it() {
    let edges = |offset_s: f64| stamped(10, "", "", move |_, own_s| own_s + offset_s);
    let exposed = SETUP.replace("fx = 600", "fx = 600\nexposure_s = 0.01");
    let (_, hints) = found(&exposed, &edges(0.001));
    assert!(hints.is_empty(), "{hints:?}");
    for (offset_s, told) in [(0.005, "0.0050 s later"), (-0.005, "0.0050 s earlier")] {
        let edges = edges(offset_s);
        assert_eq!(Folder::of(SETUP, &edges).edges().code, 1);
        let (range, hints) = found(&exposed, &edges);
        assert_eq!(range["status"], "ok");
        assert!(hints.len() == 1 && hints[0].starts_with(&format!("the stamps are {told} than")), "{hints:?}");
    }
    for offset_s in [0.01, -0.01] {
        assert_eq!(Folder::of(&exposed, &edges(offset_s)).edges().code, 1, "a whole exposure");
    }
}

/// The only range and the hints.
fn found(setup: &str, edges: &str) -> (Value, Vec<String>) {
    let mut document = Folder::of(setup, edges).document();
    let frame = document["frames"][0].take();
    let hints = serde_json::from_value(frame["hints"].clone()).expect("a list of texts");
    assert_eq!(frame["ranges"].as_array().map(Vec::len), Some(1), "{frame}");
    (frame["ranges"][0].clone(), hints)
}

/// The stamps depart from the readout by so much, which is told, and the readout tells the time: the edge is at 3 m.
#[track_caller]
fn assert_told(seconds: &str, clock: impl Fn(u32, f64) -> f64) {
    let setup = SETUP.replace("sigma_tilt_deg = 0", "sigma_tilt_deg = 0.1");
    for (header, rest) in [("", ""), (",line", ",1")] {
        let (range, hints) = found(&setup, &stamped(1, header, rest, &clock));
        let hint = format!("the stamps depart from the readout's pace by up to {seconds} s: ticks of a coarse clock, ");
        assert!(hints.len() == 1 && hints[0].starts_with(&hint), "{hints:?}");
        assert_eq!(range["status"], "ok");
        assert_near(number(&range, "depth_m"), 3.0, 0.001);
    }
}

#[test]
fn the_readout_tells_the_time_of_a_coarse_clock() {
    assert_told("0.0100", |_, own_s| (own_s / 0.01).floor() * 0.01);
    assert_told("0.0010", |_, own_s| (own_s / 0.001).floor() * 0.001);
}

/// A transfer by DMA has one stamp.
#[test]
fn the_readout_tells_the_time_of_rows_that_share_a_stamp() {
    let row_s = 0.0333 / 480.0;
    assert_told("0.0083", |row, _| f64::from(row / 120 * 120) * row_s);
    assert_told("0.0041", |row, _| f64::from(row / 60 * 60 + 60) * row_s);
    assert_told("0.0010", |row, _| f64::from(row / 16 * 16) * row_s);
}

#[test]
fn the_readout_tells_the_time_of_rows_that_come_late() {
    assert_told("0.0020", |row, own_s| if row < 200 { own_s } else { own_s + 0.002 });
}

/// Also where it is longer than a row, so that stamps run backwards.
#[test]
fn jitter_of_a_clock_is_harmless() {
    for header_and_cell in [("", ""), (",line", ",1")] {
        let jitter = |row: u32, own_s: f64| own_s + f64::from((row.wrapping_mul(2_654_435_761) >> 16) % 101) * 1e-6;
        let (range, hints) = found(SETUP, &stamped(1, header_and_cell.0, header_and_cell.1, jitter));
        assert_eq!((range["status"].as_str(), hints.len()), (Some("ok"), 0), "{range}");
        assert_near(number(&range, "depth_m"), 3.0, 0.01);
    }
}
