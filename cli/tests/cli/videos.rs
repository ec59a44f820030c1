//! y4m, as `ffmpeg -f yuv4mpegpipe -` writes it, on standard input and from files.

use std::io::{BufRead, BufReader, Write};

use serde_json::Value;

use crate::painting::{painted, painted_by, png};
use crate::tool::{Folder, Outcome, SETUP, command};

/// A header and the grey levels of frames, each followed by so many bytes of colour.
fn y4m(header: &str, frames: &[Vec<u8>], colour_bytes: usize) -> Vec<u8> {
    let frame = |grey: &Vec<u8>| [b"FRAME\n".to_vec(), grey.clone(), vec![128; colour_bytes]].concat();
    [format!("YUV4MPEG2 {header}\n").into_bytes(), frames.iter().flat_map(frame).collect()].concat()
}

fn run(video: &[u8], rest: &[&str]) -> Outcome {
    let folder = Folder::new().with("setup.toml", SETUP);
    folder.run_with_bytes(&[&["frame", "-", "--setup", "setup.toml", "--json"], rest].concat(), video)
}

fn frames(document: &Value) -> Vec<Value> {
    let without_name = |frame: &Value| {
        let mut frame = frame.clone();
        frame["name"].take();
        frame
    };
    document["frames"].as_array().expect("frames").iter().map(without_name).collect()
}

/// Those of the painted frame as a PNG.
fn expected() -> Value {
    let folder = Folder::new().with("setup.toml", SETUP).with("a.png", png(painted()));
    frames(&folder.run(&["frame", "a.png", "--setup", "setup.toml", "--json"]).json()).remove(0)
}

#[test]
fn every_layout_has_the_same_grey_levels() {
    let grey = painted().into_raw();
    let expected = expected();
    let quarter = 640 * 480 / 4;
    for (colours, bytes) in [
        ("", 2 * quarter),
        ("Cmono", 0),
        ("C420jpeg", 2 * quarter),
        ("C420mpeg2", 2 * quarter),
        ("C422", 4 * quarter),
        ("C444", 8 * quarter),
    ] {
        let video = y4m(&format!("W640 H480 F30:1 Ip A1:1 {colours}"), &[grey.clone(), grey.clone()], bytes);
        let document = run(&video, &[]).json();
        assert_eq!(frames(&document), [expected.clone(), expected.clone()], "{colours}");
        assert_eq!([0, 1].map(|index| document["frames"][index]["name"].clone()), ["-#0", "-#1"]);
    }
    // Ten bits, the lower byte first.
    let wide: Vec<u8> = grey.iter().flat_map(|level| ((u32::from(*level) * 1023 / 255) as u16).to_le_bytes()).collect();
    for (colours, bytes) in [("C420p10 XYSCSS=420P10", 4 * quarter), ("Cmono10", 0)] {
        let document = run(&y4m(&format!("W640 H480 {colours}"), std::slice::from_ref(&wide), bytes), &[]).json();
        assert_eq!(frames(&document).as_slice(), std::slice::from_ref(&expected), "{colours}");
    }
}

#[test]
fn videos_and_pictures_together_in_their_order() {
    let other = painted_by(|row| row / 2).into_raw();
    let video = y4m("W640 H480 Cmono", &[other, painted().into_raw()], 0);
    let folder = Folder::new()
        .with("setup.toml", SETUP)
        .with("clip.Y4M", video)
        .with("a.png", png(painted()))
        .with("b.png", png(painted()));
    let arguments = ["frame", "a.png", "clip.Y4M", "b.png", "--setup", "setup.toml", "--json", "--overlay", "seen.png"];
    let document = folder.run(&arguments).json();
    let names: Vec<_> =
        document["frames"].as_array().expect("frames").iter().map(|frame| frame["name"].clone()).collect();
    assert_eq!(names, ["a.png", "clip.Y4M#0", "clip.Y4M#1", "b.png"]);
    let found = frames(&document);
    assert_eq!((&found[0], &found[2]), (&found[3], &found[0]));
    assert_ne!(found[1], found[2]);
    let seen = folder.files().into_iter().filter(|name| name.starts_with("seen")).collect::<Vec<_>>();
    assert_eq!(seen, ["seen-a.png", "seen-b.png", "seen-clip-0000.png", "seen-clip-0001.png"]);
}

#[test]
fn a_video_is_a_sequence_when_asked_for() {
    let video = y4m("W640 H480 Cmono", &vec![painted().into_raw(); 3], 0);
    let apart = run(&video, &[]).json();
    assert!(apart["frames"][2]["ranges"][0]["line_id"].is_null());
    let sequence = run(&video, &["--frame-interval-s", "0.0333"]).json();
    assert_eq!(sequence["frames"].as_array().map(Vec::len), Some(3));
    assert!(sequence["frames"][0]["ranges"][0]["line_id"].is_u64(), "{sequence}");
}

/// A small camera's frames, and a reader that takes one line of what is told of them. How many frames were taken, all
/// of them read, and the outcome.
fn run_for_a_reader_of_one_line(folder: &Folder, frames: usize, rest: &[&str]) -> (bool, i32, String) {
    let mut tool = command(folder.path(), &[&["frame", "-", "--setup", "small.toml"], rest].concat())
        .spawn()
        .expect("the tool starts");
    let mut pipe = tool.stdin.take().expect("a pipe");
    let writer = std::thread::spawn(move || {
        let header = pipe.write_all(b"YUV4MPEG2 W32 H24 Cmono\n");
        let frame = [b"FRAME\n".to_vec(), vec![90; 32 * 24]].concat();
        header.is_ok() && (0..frames).all(|_| pipe.write_all(&frame).is_ok())
    });
    let mut line = String::new();
    BufReader::new(tool.stdout.take().expect("a pipe")).read_line(&mut line).expect("a line");
    let output = tool.wait_with_output().expect("the tool ends");
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    (writer.join().expect("no panic"), output.status.code().expect("no signal"), stderr)
}

#[test]
fn a_reader_that_has_seen_enough_ends_the_run() {
    let small = SETUP.replace("640", "32").replace("480", "24").replace("fx = 600", "fx = 30");
    let folder = Folder::new().with("small.toml", small);
    // More than the pipe holds.
    for rest in [&[][..], &["--json"], &["--json-lines"], &["--frame-interval-s", "0.04"]] {
        let ended = run_for_a_reader_of_one_line(&folder, 20_000, rest);
        assert_eq!(ended, (false, 0, String::new()), "{rest:?}");
    }
    // Files are written whoever reads the ranges.
    let ended = run_for_a_reader_of_one_line(&folder, 30, &["--overlay", "seen.png"]);
    assert_eq!(ended, (true, 0, String::new()));
    assert_eq!(folder.files().len(), 31);
}

#[track_caller]
fn refuse(video: &[u8], frames_before: usize, message: &str) {
    let outcome = run(video, &[]);
    assert_eq!(outcome.code, 1);
    assert!(outcome.stderr.contains(message) && outcome.stderr.lines().count() == 1, "{}", outcome.stderr);
    assert_eq!(frames(&outcome.document()).len(), frames_before);
}

#[test]
fn videos_that_are_refused() {
    let grey = painted().into_raw();
    let whole = y4m("W640 H480 Cmono", &[grey.clone(), grey.clone()], 0);
    refuse(b"", 0, "error: -: the stream is empty");
    // Whatever was to write it may have failed.
    refuse(&y4m("W640 H480 Cmono", &[], 0), 0, "error: -: the video has no frame: it ends after its header");
    refuse(&png(painted()), 0, "but must be y4m: ffmpeg -i VIDEO -f yuv4mpegpipe -");
    refuse(b"YUV4MPEG2 W640 H480", 0, "a header must end within 1024 bytes");
    refuse(&[b'Y'; 5000], 0, "a header must end within 1024 bytes");
    let header = |header: &str| format!("YUV4MPEG2 {header}\n").into_bytes();
    refuse(&header("H480"), 0, "the y4m header has no W");
    refuse(&header("Wx H480"), 0, "the y4m header has Wx, but must have a number of pixels");
    refuse(&header("W99999999999999999999 H1"), 0, "but must have a number of pixels");
    refuse(&header("W4294967295 H4294967295"), 0, "pixels, but must be 640 × 480");
    refuse(&header("W320 H240"), 0, "the frame is 320 × 240 pixels, but must be 640 × 480");
    refuse(&header("W640 H480 It"), 0, "the y4m header has It, but frames must not be interlaced");
    refuse(&header("W640 H480 C440"), 0, "the y4m header has C440, but must have mono, 420, 411, 422 or 444");
    refuse(&header("W640 H480 C420p99"), 0, "the y4m header has C420p99");
    refuse(&whole[..whole.len() - 1], 1, "error: -#1: the stream is truncated: it ends within the frame");
    refuse(&whole[..whole.len() / 2 - 20], 0, "error: -#0: the stream is truncated");
    refuse(
        &[&whole[..], b"NOISE\nnoise"].concat(),
        2,
        "error: -#2: the stream is damaged: a frame must begin with FRAME",
    );
    let outcome = run(&whole, &["--raw", "640x480"]);
    assert!(outcome.code == 2 && outcome.stderr.contains("--raw: a y4m video has a header"), "{}", outcome.stderr);
    let outcome = run(&whole, &["--frame-times", "times.csv"]);
    assert!(outcome.code == 2 && outcome.stderr.contains("give --frame-interval-s"), "{}", outcome.stderr);
}
