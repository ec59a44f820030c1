//! Files that cannot be written: an error, and nothing half-written under their name. A limit on the size of files
//! stands for the full disk.

use crate::painting::{painted, png};
use crate::tool::{Folder, Outcome, SETUP};

/// Too few bytes for any picture of these tests.
const BLOCKS: &str = "8";

fn with_frame() -> Folder {
    Folder::new().with("setup.toml", SETUP).with("a.png", png(painted()))
}

fn overlay_on_a_full_disk(folder: &Folder) -> Outcome {
    folder.run_with_file_limit(BLOCKS, &["frame", "a.png", "--setup", "setup.toml", "--overlay", "seen.png"])
}

#[track_caller]
fn assert_too_large(outcome: &Outcome, name: &str) {
    assert_eq!(outcome.code, 1, "{}", outcome.stderr);
    assert_eq!(outcome.stderr, format!("error: writing {name}: File too large (os error 27)\n"));
}

#[test]
fn an_overlay_that_does_not_fit_is_an_error_and_leaves_no_file() {
    let folder = with_frame();
    let outcome = overlay_on_a_full_disk(&folder);
    assert_too_large(&outcome, "seen.png");
    assert!(outcome.stdout.starts_with("a.png\n"), "its ranges are reported all the same: {}", outcome.stdout);
    assert_eq!(folder.files(), ["a.png", "setup.toml"]);
}

#[test]
fn an_overlay_that_does_not_fit_leaves_the_earlier_one() {
    let folder = with_frame().with("seen.png", "the earlier one");
    assert_too_large(&overlay_on_a_full_disk(&folder), "seen.png");
    assert_eq!(folder.files(), ["a.png", "seen.png", "setup.toml"]);
    assert_eq!(folder.read("seen.png"), b"the earlier one");
}

#[cfg(target_os = "linux")]
#[test]
fn an_overlay_to_a_full_device_is_an_error() {
    let folder = with_frame();
    folder.link("/dev/full", "seen.png");
    let outcome = folder.run(&["frame", "a.png", "--setup", "setup.toml", "--overlay", "seen.png"]);
    assert_eq!(outcome.code, 1);
    assert_eq!(outcome.stderr, "error: writing seen.png: No space left on device (os error 28)\n");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_an_error() {
    for arguments in [&["table2"][..], &["table2", "--json"]] {
        let outcome = Folder::new().run_with_output_to("/dev/full", arguments);
        assert_eq!(outcome.code, 1, "{arguments:?}");
        assert_eq!(outcome.stderr, "error: standard output: No space left on device (os error 28)\n");
    }
}

#[test]
fn a_simulation_that_does_not_fit_is_an_error_and_leaves_nothing() {
    let folder = Folder::new().with("setup.toml", SETUP);
    let outcome = folder.run_with_file_limit(BLOCKS, &["simulate", "--setup", "setup.toml", "--out", "out"]);
    assert_too_large(&outcome, "out/.simulating/frame-0000.png");
    assert_eq!((outcome.stdout.as_str(), folder.files()), ("", vec!["setup.toml".to_string()]));
}

#[test]
fn a_truth_that_does_not_fit_is_an_error() {
    let tiny = SETUP.replace("columns = 640\nrows = 480\nfx = 600", "columns = 16\nrows = 9\nfx = 10");
    let folder = Folder::new().with("setup.toml", tiny);
    let arguments = ["simulate", "--setup", "setup.toml", "--out", "out", "--frames", "20"];
    assert_too_large(&folder.run_with_file_limit(BLOCKS, &arguments), "out/.simulating/truth.json");
    assert_eq!(folder.files(), ["setup.toml"]);
    assert_eq!(folder.run(&arguments).code, 0, "with room, the same command succeeds");
}

#[test]
fn a_simulation_that_does_not_fit_leaves_the_earlier_one() {
    let folder = Folder::new().with("setup.toml", SETUP);
    let arguments = ["simulate", "--setup", "setup.toml", "--out", "out", "--overwrite"];
    assert_eq!(folder.run(&arguments).code, 0);
    let (files, frame) = (folder.files_of("out"), folder.read("out/frame-0000.png"));
    let outcome = folder.run_with_file_limit(BLOCKS, &[&arguments[..], &["--seed", "2"]].concat());
    assert_too_large(&outcome, "out/.simulating/frame-0000.png");
    assert_eq!((folder.files_of("out"), folder.read("out/frame-0000.png")), (files, frame));
}
