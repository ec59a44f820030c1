//! Inputs without an end, or larger than anything of their kind.

use std::fs::File;

use crate::painting::{painted, png};
use crate::tool::{Folder, SETUP};

const POINTS: &str = "row,column\n1,2\n";
const SIZE_OF_SETUP: &str = "1048576 bytes, but a setup must have at most 1048576";
const SIZE_OF_EDGES: &str = "268435456 bytes, but a file of edge points must have at most 268435456";
/// 18 bytes for each of 640 × 480 pixels and 64 MiB.
const SIZE_OF_PICTURE: &str = "72638464 bytes, but a picture of 640 × 480 pixels must have at most 72638464";

fn folder() -> Folder {
    Folder::of(SETUP, POINTS).with("a.png", png(painted()))
}

#[track_caller]
fn assert_fails(folder: &Folder, arguments: &[&str], message: &str) {
    let outcome = folder.run(arguments);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""), "{arguments:?}");
    assert_eq!(outcome.stderr, format!("error: {message}\n"));
}

#[test]
fn an_endless_file_is_an_error_wherever_a_file_is_read() {
    let endless = |size: &str| format!("/dev/zero: the file has more than {size}");
    let folder = folder();
    assert_fails(&folder, &["edges", "/dev/zero", "--setup", "setup.toml"], &endless(SIZE_OF_EDGES));
    assert_fails(&folder, &["edges", "edges.csv", "--setup", "/dev/zero"], &endless(SIZE_OF_SETUP));
    assert_fails(&folder, &["frame", "/dev/zero", "--setup", "setup.toml"], &endless(SIZE_OF_PICTURE));
    let dump = "307200 bytes, but --raw 640 × 480 must have 307200";
    assert_fails(&folder, &["frame", "/dev/zero", "--setup", "setup.toml", "--raw", "640x480"], &endless(dump));
    let trajectory = "268435456 bytes, but a trajectory must have at most 268435456";
    let arguments = ["edges", "edges.csv", "--setup", "setup.toml", "--trajectory", "/dev/zero"];
    assert_fails(&folder, &arguments, &endless(trajectory));
    let scene = "1048576 bytes, but a scene must have at most 1048576";
    let arguments = ["simulate", "--setup", "setup.toml", "--out", "out", "--scene", "/dev/zero"];
    assert_fails(&folder, &arguments, &endless(scene));
}

#[test]
fn an_endless_standard_input_is_an_error() {
    let endless = File::open("/dev/zero").expect("a device");
    let outcome = folder().run_with_input_from(endless, &["edges", "-", "--setup", "setup.toml"]);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""));
    assert_eq!(outcome.stderr, format!("error: -: the file has more than {SIZE_OF_EDGES}\n"));
}

#[test]
fn a_huge_file_is_an_error_with_its_size() {
    let folder = folder();
    let huge = File::create(folder.path().join("huge")).expect("a file");
    huge.set_len(1 << 40).expect("a file without content takes no room");
    let message = |size: &str| format!("huge: the file has 1099511627776 {}", size.split_once(' ').expect("a unit").1);
    assert_fails(&folder, &["edges", "huge", "--setup", "setup.toml"], &message(SIZE_OF_EDGES));
    assert_fails(&folder, &["edges", "edges.csv", "--setup", "huge"], &message(SIZE_OF_SETUP));
    assert_fails(&folder, &["frame", "huge", "--setup", "setup.toml"], &message(SIZE_OF_PICTURE));
}

#[test]
fn a_picture_with_much_beside_its_pixels_is_read() {
    // As phones append a video clip to their pictures.
    let folder = folder().with("long.png", [png(painted()), vec![0; 10 << 20]].concat());
    let ranges = |name: &str| {
        let document = folder.run(&["frame", name, "--setup", "setup.toml", "--json"]).json();
        document["frames"][0]["ranges"].clone()
    };
    assert_eq!(ranges("long.png"), ranges("a.png"));
}
