//! What `simulate` does with a folder that is not empty, and after an interruption.

use std::fs;
use std::time::{Duration, Instant};

use crate::simulations::{simulate, with_setup};
use crate::tool::{Folder, Outcome, command};

fn run(folder: &Folder, rest: &[&str]) -> Outcome {
    simulate(folder, &[&["--out", "out"], rest].concat())
}

#[track_caller]
fn assert_done(outcome: &Outcome) {
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
}

#[track_caller]
fn assert_refused(outcome: &Outcome, message: &str) {
    assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""));
    assert_eq!(outcome.stderr, format!("error: {message}\n"));
}

const OTHERS: [&str; 4] = ["scene.toml", "setup.toml", "trajectory.csv", "truth.json"];

#[track_caller]
fn assert_frames(folder: &Folder, frames: u32) {
    let names = (0..frames).map(|number| format!("frame-{number:04}.png"));
    assert_eq!(folder.files_of("out"), names.chain(OTHERS.map(str::to_string)).collect::<Vec<_>>());
}

#[test]
fn an_empty_folder_is_as_good_as_a_new_one() {
    let folder = with_setup();
    folder.make("out");
    assert_done(&run(&folder, &[]));
    assert_frames(&folder, 1);
}

#[test]
fn an_earlier_simulation_is_refused_without_overwrite() {
    let folder = with_setup();
    assert_done(&run(&folder, &["--frames", "2"]));
    let before = folder.read("out/frame-0000.png");
    let message =
        "out holds frame-0000.png: --overwrite replaces an earlier simulation, or choose another folder for --out";
    assert_refused(&run(&folder, &["--seed", "2"]), message);
    assert_eq!(folder.read("out/frame-0000.png"), before);
    assert_frames(&folder, 2);
}

/// A recording of a camera may have files of the same names.
#[test]
fn what_is_no_simulation_is_not_replaced() {
    for name in ["frame-0007.png", "frame-123456.png", "scene.toml", "setup.toml", "trajectory.csv", "truth.json"] {
        let folder = with_setup();
        folder.make("out");
        let folder = folder.with(&format!("out/{name}"), "content");
        let missing = if name == "truth.json" { "scene.toml" } else { "truth.json" };
        let reason = format!("out holds {name}, but no {missing}: it is no earlier simulation");
        let message = format!("{reason}, and --out must be a new or an empty folder");
        for options in [&[][..], &["--overwrite"]] {
            assert_refused(&run(&folder, options), &message);
            assert_eq!(folder.files_of("out"), [name]);
            assert_eq!(folder.read(&format!("out/{name}")), b"content");
        }
    }
}

#[test]
fn overwrite_replaces_all_files_of_the_earlier_simulation_and_no_others() {
    let folder = with_setup();
    assert_done(&run(&folder, &["--frames", "3"]));
    let first = folder.read("out/frame-0000.png");
    let folder = folder.with("out/frame-0001.txt", "a note").with("out/seen-frame-0000.png", "an overlay");
    assert_done(&run(&folder, &["--frames", "2", "--seed", "2", "--overwrite"]));
    let expected =
        ["frame-0000.png", "frame-0001.png", "frame-0001.txt", "scene.toml", "seen-frame-0000.png", "setup.toml"];
    assert_eq!(folder.files_of("out"), [&expected[..], &["trajectory.csv", "truth.json"]].concat());
    assert_ne!(folder.read("out/frame-0000.png"), first);
    assert_eq!(folder.read("out/frame-0001.txt"), b"a note");
}

#[test]
fn other_files_are_left_alone() {
    let folder = with_setup();
    folder.make("out");
    let folder = folder.with("out/notes.txt", "a note");
    assert_refused(&run(&folder, &[]), "out holds notes.txt: --out must be a new or an empty folder");
    assert_eq!(folder.files_of("out"), ["notes.txt"]);
}

#[test]
fn a_file_is_no_folder() {
    let folder = with_setup().with("out", "a file");
    let outcome = run(&folder, &[]);
    assert_eq!(outcome.code, 1);
    assert!(outcome.stderr.starts_with("error: making out: "), "{}", outcome.stderr);
    assert_eq!(folder.read("out"), b"a file");
}

#[test]
fn an_interrupted_simulation_can_simply_be_run_again() {
    let folder = with_setup();
    let arguments = ["simulate", "--setup", "setup.toml", "--out", "out", "--frames", "1000"];
    let mut child = command(folder.path(), &arguments).spawn().expect("the tool starts");
    let start = Instant::now();
    while !folder.path().join("out/.simulating/frame-0001.png").exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no frame was written");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().expect("the tool still runs");
    child.wait().expect("the tool ends");
    assert_eq!(folder.files_of("out"), [".simulating"], "no frame has its final name");
    assert_done(&run(&folder, &["--frames", "2"]));
    assert_frames(&folder, 2);
}

/// As if the tool had been killed after it moved the first of two frames.
fn interrupted_while_moving() -> Folder {
    let folder = with_setup();
    assert_done(&run(&folder, &["--frames", "2", "--seed", "2"]));
    folder.make("out/.simulated");
    for name in ["frame-0001.png", "scene.toml", "setup.toml", "trajectory.csv", "truth.json"] {
        let moved = fs::rename(folder.path().join("out").join(name), folder.path().join("out/.simulated").join(name));
        moved.expect("moving a file");
    }
    folder
}

#[test]
fn a_simulation_interrupted_at_its_end_can_simply_be_run_again() {
    let folder = interrupted_while_moving();
    assert_done(&run(&folder, &[]));
    assert_frames(&folder, 1);
    let again = with_setup();
    assert_done(&run(&again, &[]));
    assert_eq!(folder.read("out/frame-0000.png"), again.read("out/frame-0000.png"));
}

#[test]
fn a_complete_simulation_is_not_taken_for_an_interrupted_one() {
    let folder = with_setup();
    assert_done(&run(&folder, &[]));
    folder.make("out/.simulated");
    assert!(run(&folder, &[]).stderr.starts_with("error: out holds frame-0000.png: "));
    assert_done(&run(&folder, &["--overwrite"]));
    assert_frames(&folder, 1);
}

#[test]
fn a_simulation_does_not_replace_its_own_inputs() {
    let folder = with_setup();
    assert_done(&run(&folder, &[]));
    folder.hard_link("out/scene.toml", "scene.toml");
    folder.link("out/setup.toml", "linked.toml");
    for (setup, scene, message) in [
        ("out/setup.toml", "out/scene.toml", "--out would replace out/scene.toml, which --scene reads"),
        ("./out/../out/setup.toml", "other.toml", "--out would replace out/setup.toml, which --setup reads"),
        ("linked.toml", "other.toml", "--out would replace out/setup.toml, which --setup reads"),
        ("setup.toml", "scene.toml", "--out would replace out/scene.toml, which --scene reads"),
    ] {
        let outcome = folder.run(&["simulate", "--setup", setup, "--scene", scene, "--out", "out", "--overwrite"]);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{setup} {scene}");
        assert!(outcome.stderr.contains(message), "{setup} {scene}: {}", outcome.stderr);
    }
    let outcome = simulate(&folder, &["--out", "."]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("--out would replace ./setup.toml, which --setup reads"), "{}", outcome.stderr);
    assert_frames(&folder, 1);
}
