//! Stamps of edge points against the readout: 33.3 ms for 480 rows.

use serde_json::Value;

use crate::tool::{Folder, SETUP, column};

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

const FRAME: &str = "but must be -0.0035 to 0.0368 for a readout of 0.0333 s, which reads row";

#[test]
fn stamps_in_milliseconds_are_refused() {
    let message = format!("line 3: `time_s` is 0.69375, {FRAME} 10 at 0.000694: these seem to be milliseconds");
    refuse(&message, |_, own_s| own_s * 1e3);
}

#[test]
fn stamps_in_microseconds_are_refused() {
    let message = format!("line 3: `time_s` is 693.75, {FRAME} 10 at 0.000694: these seem to be microseconds");
    refuse(&message, |_, own_s| own_s * 1e6);
}

#[test]
fn stamps_since_boot_are_refused() {
    let cause = "is it counted from frame start, in seconds, and not from the start of the clock?";
    let message = format!("line 2: `time_s` is 120, {FRAME} 0 at 0.000000: {cause}");
    refuse(&message, |_, own_s| own_s + 120.0);
    let message = format!("line 2: `time_s` is 1700000000, {FRAME} 0 at 0.000000: {cause}");
    refuse(&message, |_, own_s| own_s + 1.7e9);
}

#[test]
fn stamps_of_another_frame_are_refused() {
    let cause = "is it the row's own, in seconds since frame start, and not that of its block or of the whole frame?";
    let message = format!("line 2: `time_s` is 0.04, {FRAME} 0 at 0.000000: {cause}");
    refuse(&message, |_, own_s| own_s + 0.04);
}

#[test]
fn stamps_at_another_pace_are_refused() {
    let message = "line 49: `time_s` rises by 0.0163 from row 0 to row 470, which are 0.0326 s apart by the readout of \
                   0.0333 s: check the stamps, the readout time in the setup";
    refuse(message, |_, own_s| own_s / 2.0);
    let message = "line 49: `time_s` rises by -0.0326 from row 0 to row 470, which are 0.0326 s apart by the readout of \
                   0.0333 s: check the stamps, the readout time in the setup, and `camera.direction`";
    refuse(message, |_, own_s| 0.0333 - own_s - 0.00069);
}

#[test]
fn an_exposure_or_a_readout_that_is_hardly_known_allow_more() {
    let late = |_: u32, own_s: f64| own_s + 0.01;
    let edges = stamped(10, "", "", late);
    assert_eq!(Folder::of(SETUP, &edges).edges().code, 1);
    for (old, new) in [("fx = 600", "fx = 600\nexposure_s = 0.01"), ("sigma_readout = 0", "sigma_readout = 0.1")] {
        let outcome = Folder::of(&SETUP.replace(old, new), &edges).edges();
        assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""), "{new}");
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

/// The range of an edge whose stamps depart from the readout by so much, which must be told.
#[track_caller]
fn departing(seconds: &str, clock: impl Fn(u32, f64) -> f64) -> Value {
    let setup = SETUP.replace("sigma_tilt_deg = 0", "sigma_tilt_deg = 0.1");
    let (range, hints) = found(&setup, &stamped(1, ",line", ",1", clock));
    let hint = format!("the stamps depart from the readout's pace by {seconds} s: ticks of a coarse clock, ");
    assert!(hints.iter().any(|found| found.starts_with(&hint)), "{hints:?}");
    range
}

#[test]
fn ticks_and_late_rows_are_told_and_give_no_distance() {
    let ticks = departing("0.0100", |_, own_s| (own_s / 0.01).floor() * 0.01);
    let late = departing("0.0020", |row, own_s| if row < 200 { own_s } else { own_s + 0.002 });
    for range in [ticks, late] {
        assert!(range["status"] != "ok" && range["status"] != "far", "{range}");
    }
}

/// A transfer by DMA has one stamp.
#[test]
fn rows_that_share_a_stamp_are_told() {
    let row_s = 0.0333 / 480.0;
    departing("0.0083", |row, _| f64::from(row / 120 * 120) * row_s);
    departing("0.0041", |row, _| f64::from(row / 60 * 60 + 60) * row_s);
}

#[test]
fn jitter_of_a_clock_is_harmless() {
    let jitter = |row: u32, own_s: f64| own_s + f64::from((row * 7919) % 101) * 1e-6 - 50e-6;
    let (range, hints) = found(SETUP, &stamped(1, ",line", ",1", jitter));
    assert_eq!((range["status"].as_str(), hints.len()), (Some("ok"), 0), "{range}");
}
