//! `--frame-times`: sequences whose frames do not come at regular intervals.

use std::fs;

use serde_json::Value;

use crate::simulations::SCENE;
use crate::tool::{Folder, Outcome, SETUP, assert_near, column, number};

/// Three frames 0.1 s apart.
fn simulated() -> Folder {
    let folder = Folder::new().with("setup.toml", SETUP).with("scene.toml", SCENE);
    let arguments = ["simulate", "--setup", "setup.toml", "--scene", "scene.toml", "--out", "out", "--frames", "3"];
    let outcome = folder.run(&[&arguments[..], &["--frame-interval-s", "0.1"]].concat());
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    folder
}

fn frames(folder: &Folder, files: &[&str], rest: &[&str]) -> Outcome {
    folder.run(&[&["frame", "--setup", "setup.toml", "--json"], files, rest].concat())
}

const FILES: [&str; 3] = ["out/frame-0000.png", "out/frame-0001.png", "out/frame-0002.png"];

#[test]
fn regular_times_are_an_interval() {
    let folder = simulated();
    let expected = frames(&folder, &FILES, &["--frame-interval-s", "0.1"]).json();
    // Of any clock.
    for times in ["time_s\n0\n0.1\n0.2\n", "time_s\n1700000000.0\n1700000000.1\n1700000000.2\n"] {
        let folder = simulated().with("times.csv", times);
        let document = frames(&folder, &FILES, &["--frame-times", "times.csv"]).json();
        for (frame, other) in [(0, 0), (1, 1), (2, 2)] {
            let [ranges, others] = [&document["frames"][frame]["ranges"], &expected["frames"][other]["ranges"]];
            let pairs = ranges.as_array().into_iter().flatten().zip(others.as_array().into_iter().flatten());
            for (range, other) in pairs {
                assert_eq!(range["line_id"], other["line_id"]);
                assert_near(number(range, "depth_m"), number(other, "depth_m"), 1e-5);
            }
        }
    }
}

/// The middle frame is missing: with its time, the others are a sequence all the same.
#[test]
fn frames_are_found_by_their_names() {
    let names = "name,time_s\nframe-0002.png,5.2\nout/frame-0000.png,5.0\nframe-0001.png,5.1\n";
    let folder = simulated().with("times.csv", names);
    let document = frames(&folder, &[FILES[0], FILES[2]], &["--frame-times", "times.csv"]).json();
    for range in document["frames"][1]["ranges"].as_array().expect("ranges") {
        assert_eq!((&range["status"], &range["frames"]), (&"ok".into(), &2.into()), "{range}");
    }
}

#[test]
fn frames_of_edges_are_found_by_their_numbers() {
    let line = |frame: u32, bearing: f64| {
        (0..480).step_by(10).map(move |row| format!("{row},{:.4},{frame}\n", column(bearing, 2.0, row)))
    };
    // 1.5 m/s at 2 m: 0.75 rad/s.
    let points: String = line(3, 0.1).chain(line(7, 0.1 + 0.75 * 0.13)).collect();
    let run = |times: &str| {
        let folder = Folder::of(SETUP, &format!("row,column,frame\n{points}")).with("times.csv", times);
        folder.run(&["edges", "edges.csv", "--setup", "setup.toml", "--json", "--frame-times", "times.csv"])
    };
    for times in
        ["time_s\n1\n1.13\n", "name,time_s\n7,1.13\n5,1.1\n3,1\n", "name,time_s\nedges.csv#3,1\nedges.csv#7,1.13\n"]
    {
        let document = run(times).json();
        let range = &document["frames"][1]["ranges"][0];
        assert_eq!((&range["status"], &range["frames"]), (&"ok".into(), &2.into()), "{range}");
        assert_near(number(range, "depth_m"), 2.0, 0.001);
    }
}

#[track_caller]
fn refuse(times: &str, message: &str) {
    let outcome = frames(&simulated().with("times.csv", times), &FILES, &["--frame-times", "times.csv"]);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""));
    assert_eq!(outcome.stderr, format!("error: {message}\n"));
}

#[test]
fn times_that_do_not_fit_the_frames_are_refused() {
    let file = |message: &str| format!("times.csv: {message}");
    refuse("time_s\n0\n0.1\n", &file("2 times, but must be 3, one for each frame (or give the column `name`)"));
    refuse("name,time_s\nframe-0000.png,0\n", &file("no line has the `name` out/frame-0001.png"));
    refuse("name,time_s\na,0\nb,1\na,2\n", &file("line 4: `name` is `a`, but must be another one than on line 2"));
    refuse("name,time_s\n,0\n", &file("line 2: `name` is empty, but must be the name of a frame"));
    refuse(
        "time_s\n0\nsoon\n0.2\n",
        &file("line 3: `time_s` is `soon`, but must be a number from -10000000000 to 10000000000 (seconds)"),
    );
    refuse("time\n0\n", &file("line 1: unknown column `time`; the nearest is `time_s`"));
    let order =
        "out/frame-0002.png starts at 0.05 s, but must start after out/frame-0001.png, which comes before it, at 0.1 s";
    refuse("time_s\n0\n0.1\n0.05\n", &file(order));
}

/// A frame takes 33.3 ms to read, 69 µs a row.
#[test]
fn a_frame_that_starts_before_the_last_one_is_read_is_refused() {
    let message = |which: &str, seconds: &str| {
        format!("from {which} it is {seconds} s, but must be at least 0.0333 s, the readout of a frame in the setup")
    };
    let first_two = "out/frame-0000.png to out/frame-0001.png";
    refuse("time_s\n0\n0.025\n0.1\n", &message(first_two, "0.025"));
    // Whose difference is 0.030000000000000027 in binary.
    refuse("time_s\n1\n1.03\n2\n", &message(first_two, "0.03"));
    refuse("time_s\n0\n1\n1.02\n", &message("out/frame-0001.png to out/frame-0002.png", "0.02"));
    let folder = simulated();
    let outcome = frames(&folder, &FILES, &["--frame-interval-s", "0.0332"]);
    assert_eq!((outcome.code, outcome.stderr), (1, format!("error: {}\n", message("one frame to the next", "0.0332"))));
    // Clocks are rounded: one row less is allowed.
    assert_eq!(frames(&folder, &FILES, &["--frame-interval-s", "0.03325"]).code, 0);
}

#[test]
fn an_interval_and_times_contradict_each_other() {
    let folder = simulated().with("times.csv", "time_s\n0\n0.1\n0.2\n");
    let outcome = frames(&folder, &FILES, &["--frame-times", "times.csv", "--frame-interval-s", "0.1"]);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""));
}

/// Its times are those since the start of the first frame.
#[test]
fn a_trajectory_goes_with_frame_times() {
    let drive = "time_s,vx,vy,vz,wx,wy,wz\n-0.1,-1.5,0,0,0,0,0\n0.1,-1.5,0,0,0,0,0\n0.4,-1.5,0,0,0,0,0\n";
    let folder = simulated().with("times.csv", "time_s\n7\n7.1\n7.2\n").with("drive.csv", drive);
    let document = frames(&folder, &FILES, &["--frame-times", "times.csv", "--trajectory", "drive.csv"]).json();
    let last: &Value = &document["frames"][2]["ranges"];
    assert!(last.as_array().expect("ranges").iter().all(|range| range["frames"] == 3), "{last}");
}

/// Automatic exposure goes from 10 to 2 ms between two frames.
#[test]
fn each_frame_has_its_exposure() {
    let base = SETUP
        .replace("readout_s = ", "response = \"linear\"\nlens_blur_px = 0.7\nreadout_s = ")
        .replace("sigma_tilt_deg = 0", "sigma_tilt_deg = 0.5");
    let mut folder = Folder::new().with("setup.toml", &base).with("scene.toml", SCENE);
    for (name, exposure_s) in [("short", "0.002"), ("long", "0.01")] {
        folder = folder.with("exposed.toml", base.replace("fx = ", &format!("exposure_s = {exposure_s}\nfx = ")));
        let arguments = ["simulate", "--setup", "exposed.toml", "--scene", "scene.toml", "--out", name];
        let outcome = folder.run(&[&arguments[..], &["--frames", "2", "--frame-interval-s", "0.1"]].concat());
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    }
    let files = ["long/frame-0000.png", "short/frame-0001.png"];
    let ranges = |folder: &Folder, times: &str| -> Vec<Value> {
        fs::write(folder.path().join("times.csv"), times).expect("writing an input file");
        let document = frames(folder, &files, &["--frame-times", "times.csv"]).json();
        let of = |frame: usize| document["frames"][frame]["ranges"].as_array().expect("ranges").clone();
        [of(0), of(1)].concat()
    };
    let found = ranges(&folder, "time_s,exposure_s\n0,0.01\n0.1,0.002\n");
    assert_eq!(found.len(), 8);
    for range in &found {
        let true_m = if number(range, "bearing") < 0.1 { 2.0 } else { 3.0 };
        let sigma_per_m = number(range, "sigma_inverse_depth_per_m");
        assert_near(number(range, "inverse_depth_per_m"), 1.0 / true_m, 4.0 * sigma_per_m);
    }
    // Without an exposure, blur says nothing of the lean of a single frame's edges.
    let unknown = ranges(&folder, "time_s\n0\n0.1\n");
    let [with, without] = [&found[0], &unknown[0]].map(|range| number(range, "sigma_inverse_depth_per_m"));
    assert!(without > 1.5 * with, "{without} for {with}");
    // That of the other frame contradicts the slope, or moves the distance.
    let swapped = ranges(&folder, "time_s,exposure_s\n0,0.002\n0.1,0.01\n");
    let is_wrong = |range: &Value| {
        let sigma_per_m = number(range, "sigma_inverse_depth_per_m");
        range["status"] == "leaning" || (number(range, "inverse_depth_per_m") - 0.5).abs() > 4.0 * sigma_per_m
    };
    assert!(is_wrong(&swapped[0]), "{}", swapped[0]);
}

#[test]
fn exposures_that_are_refused() {
    let refused = |times: &str| {
        let folder = simulated().with("times.csv", times);
        frames(&folder, &FILES, &["--frame-times", "times.csv"]).stderr
    };
    assert!(refused("time_s,exposure_s\n0,0.002\n0.1,\n0.2,1\n").contains("line 3: `exposure_s` is empty"));
    assert!(
        refused("time_s,exposure_s\n0,0.002\n0.1,0.2\n0.2,0.002\n").contains("out/frame-0001.png: `exposure_s` is 0.2")
    );
    assert!(refused("time_s,exposure_s\n0,0\n0.1,0.2\n0.2,0.002\n").contains("line 2: `exposure_s` is `0`"));
}
