//! Several frames of the same edges: how they are recognised, their tilt, and a sigma that falls.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::painting::png;
use crate::tool::{Folder, SETUP, assert_near, column, number};

const FRAMES: usize = 5;

/// Two posts; the nearer one leans by half a degree.
const SCENE: &str = "\
[background]
level = 200
[[bar]]
bearing = -0.2
depth_m = 2.0
width_m = 0.12
level = 40
lean_deg = 0.5
[[bar]]
bearing = 0.1
depth_m = 2.2
width_m = 0.2
level = 60
";

fn simulated(setup: &str) -> (Folder, Value) {
    let folder = Folder::new().with("setup.toml", setup).with("scene.toml", SCENE);
    let arguments = ["simulate", "--setup", "setup.toml", "--scene", "scene.toml", "--out", "out", "--frames", "5"];
    let truth = folder.run(&[&arguments[..], &["--frame-interval-s", "0.04", "--json"]].concat()).json();
    (folder, truth)
}

fn frame(folder: &Folder, rest: &[&str]) -> Value {
    let files: Vec<_> = (0..FRAMES).map(|k| format!("out/frame-{k:04}.png")).collect();
    let files: Vec<_> = files.iter().map(String::as_str).collect();
    folder.run(&[&["frame", "--setup", "setup.toml", "--json"], files.as_slice(), rest].concat()).json()
}

fn ranges(document: &Value, frame: usize) -> &[Value] {
    document["frames"][frame]["ranges"].as_array().expect("a list of ranges")
}

fn setup(sigma_tilt_deg: f64, more: &str) -> String {
    let setup = SETUP.replace("sigma_tilt_deg = 0\n", &format!("sigma_tilt_deg = {sigma_tilt_deg}\n"));
    setup.replace("readout_s = 0.0333\n", &format!("readout_s = 0.0333\n{more}"))
}

#[test]
fn a_sequence_names_its_edges_and_learns_their_lean() {
    let (folder, truth) = simulated(&setup(0.5, ""));
    let found = frame(&folder, &["--frame-interval-s", "0.04"]);
    let ids: Vec<_> = ranges(&found, 0).iter().map(|range| range["line_id"].clone()).collect();
    assert_eq!(ids.len(), 4);
    for frame in 0..FRAMES {
        let edges = truth["frames"][frame]["edges"].as_array().expect("a list of edges");
        for ((range, edge), id) in ranges(&found, frame).iter().zip(edges).zip(&ids) {
            assert_eq!((&range["line_id"], &range["status"]), (id, &Value::from("ok")), "{range}");
            assert_eq!(number(range, "frames"), frame as f64 + 1.0);
            let (rho, sigma) = (number(range, "inverse_depth_per_m"), number(range, "sigma_inverse_depth_per_m"));
            assert_near(rho, number(edge, "inverse_depth_per_m"), 4.0 * sigma);
            let (most, least) = if frame == 0 { (1.0, 0.1) } else { (0.01, 0.0) };
            assert!((least..most).contains(&(sigma / rho)), "{range}");
            assert!(range["dominant"].is_string() && number(range, "sigma_common") == 0.0, "{range}");
        }
    }
    let [left, right, other, _] = ranges(&found, FRAMES - 1) else { panic!("{found}") };
    for (range, degrees) in [(left, 0.5), (right, 0.5), (other, 0.0)] {
        assert_near(number(range, "tilt_deg").abs(), degrees, 0.03);
        assert!(number(range, "sigma_tilt_deg") < 0.02, "{range}");
    }
}

/// Widths of the labels of an overlay of 640 columns: its boxes are the long runs of their dark grey, line by line.
fn label_widths(folder: &Folder, name: &str) -> Vec<usize> {
    let picture = image::load_from_memory(&folder.read(name)).expect("a picture").into_rgb8();
    let mut boxes = BTreeSet::new();
    for row in picture.rows() {
        let pixels: Vec<bool> = row.map(|pixel| pixel.0 == [16; 3]).collect();
        let runs = pixels.chunk_by(|a, b| a == b).scan(0, |end, run| {
            *end += run.len();
            Some((*end, run.len(), run[0]))
        });
        boxes.extend(runs.filter(|(_, length, is_dark)| *is_dark && *length > 40));
    }
    boxes.into_iter().map(|(_, width, _)| width).collect()
}

/// Of characters 6 px apart, 2 px of margin on either side.
fn label_width(range: &Value, frames: &str) -> usize {
    let distance_m = number(range, "distance_m");
    let sigma_m = number(range, "sigma_depth_m") * distance_m / number(range, "depth_m");
    let decimals = (-sigma_m.log10().floor()).max(0.0) as usize;
    format!("{distance_m:.decimals$} ± {sigma_m:.decimals$} m{frames}").chars().count() * 6 + 3
}

#[test]
fn an_overlay_tells_how_many_frames_agree() {
    let (folder, _) = simulated(&setup(0.5, ""));
    let found = frame(&folder, &["--frame-interval-s", "0.04", "--overlay", "seen.png"]);
    for (index, frames) in [(0, ""), (1, " (2)"), (FRAMES - 1, " (5)")] {
        let mut widths = label_widths(&folder, &format!("seen-frame-{index:04}.png"));
        let mut expected: Vec<_> = ranges(&found, index).iter().map(|range| label_width(range, frames)).collect();
        widths.sort_unstable();
        expected.sort_unstable();
        assert_eq!(widths, expected, "frame {index}");
    }
}

/// At the side of the picture an edge is farther away than it is deep: 10.3 m for 9.6 m.
#[test]
fn an_overlay_tells_distances_and_not_depths() {
    let grey = |x: u32, row: u32| (f64::from(x) - column(0.4, 9.6, row) + 0.5).clamp(0.0, 1.0) * 150.0 + 50.0;
    let picture = image::GrayImage::from_fn(640, 480, |x, row| image::Luma([grey(x, row).round() as u8]));
    let folder = Folder::new().with("setup.toml", SETUP).with("a.png", png(picture));
    let arguments =
        ["frame", "a.png", "--setup", "setup.toml", "--json", "--overlay", "seen.png", "--report", "seen.html"];
    let found = folder.run(&arguments).json();
    let [range] = ranges(&found, 0) else { panic!("{found}") };
    let (depth_m, distance_m) = (number(range, "depth_m"), number(range, "distance_m"));
    assert!(depth_m < 9.9 && distance_m > 10.0, "{range}");
    assert_eq!(label_widths(&folder, "seen.png"), [label_width(range, "")]);
    let page = String::from_utf8(folder.read("seen.html")).expect("UTF-8");
    assert!(
        page.contains(&format!(">{distance_m:.1} ±")) || page.contains(&format!(">{distance_m:.2} ±")),
        "its picture"
    );
}

/// Seven rows of a post are too short for one frame, and enough for three.
#[test]
fn tentative_lines_are_told_when_asked_for() {
    let mut points = "row,column,line,frame\n".to_string();
    for frame in 0..4 {
        for row in 200..207 {
            // At 2 m, beside a camera that moves to the left by 0.06 m from frame to frame.
            let column = 300.0 + 18.0 * f64::from(frame) + 450.0 * 0.0333 * f64::from(row) / 480.0;
            points += &format!("{row},{column},1,{frame}\n");
        }
    }
    let folder = Folder::of(SETUP, &points);
    let arguments = ["edges", "edges.csv", "--setup", "setup.toml", "--frame-interval-s", "0.04", "--json"];
    let [told, all] = [&[][..], &["--all"]].map(|rest| folder.run(&[&arguments[..], rest].concat()).json());
    let statuses =
        |document: &Value, frame| ranges(document, frame).iter().map(|r| r["status"].clone()).collect::<Vec<_>>();
    println!("{told:#}");
    assert_eq!((statuses(&told, 0), statuses(&all, 0)), (vec!["short".into()], vec!["short".into()]));
    assert_eq!((statuses(&told, 1), statuses(&all, 1)), (Vec::new(), vec![Value::from("tentative")]));
    let strays = [&told, &all].map(|document| number(&document["frames"][1], "stray_edges"));
    assert_eq!(strays, [7.0, 0.0], "what is not told is counted");
    for frame in 2..4 {
        assert_eq!(statuses(&told, frame), ["ok"], "{told}");
        assert_eq!(told["frames"][frame], all["frames"][frame]);
    }
}

#[test]
fn frames_on_their_own_have_no_names() {
    let (folder, _) = simulated(&setup(0.1, ""));
    let found = frame(&folder, &[]);
    for range in (0..FRAMES).flat_map(|frame| ranges(&found, frame)) {
        assert_eq!((&range["line_id"], number(range, "frames")), (&Value::Null, 1.0), "{range}");
    }
}

/// The error that all edges share is relative to the depth. Two percent is what is assumed of a speed.
#[test]
fn a_speed_that_is_known_to_two_percent() {
    let setup = setup(0.0, "").replace("sigma_speed = 0\n", "");
    let (folder, _) = simulated(&setup);
    for range in ranges(&frame(&folder, &["--frame-interval-s", "0.04"]), FRAMES - 1) {
        assert_near(number(range, "sigma_common"), 0.02, 1e-3);
        assert_eq!(range["dominant"], "speed", "{range}");
    }
}

/// If the exposure is known, a single frame is enough.
#[test]
fn the_blur_measures_the_lean() {
    let (folder, _) = simulated(&setup(0.5, "exposure_s = 0.008\nlens_blur_px = 0.7\nresponse = \"linear\"\n"));
    let blind = setup(0.5, "");
    let relative_error = |folder: &Folder| {
        let found = frame(folder, &[]);
        let off = |range: &Value| (number(range, "inverse_depth_per_m") * 2.0 - 1.0).abs();
        ranges(&found, 0).iter().take(2).map(off).fold(0.0, f64::max)
    };
    let with_blur = relative_error(&folder);
    let without = relative_error(&folder.with("setup.toml", blind));
    assert!(without > 0.15 && with_blur < without / 4.0, "{with_blur} with, {without} without");
}

#[test]
fn frames_of_the_same_instant_are_no_sequence() {
    let (folder, _) = simulated(&setup(0.1, ""));
    for interval in ["0", "-0.04", "nan", "4000"] {
        let arguments = ["frame", "out/frame-0000.png", "--setup", "setup.toml", "--frame-interval-s", interval];
        let outcome = folder.run(&arguments);
        assert_eq!(outcome.code, 2, "{interval}: {}", outcome.stderr);
        assert!(outcome.stderr.contains("above 0, at most 3600 (seconds)"), "{}", outcome.stderr);
    }
}

/// A map shows each edge of the drive once, with the camera's path, and says what it needs.
#[test]
fn a_map_shows_the_edges_from_above() {
    let (folder, _) = simulated(&setup(0.5, ""));
    frame(&folder, &["--frame-interval-s", "0.04", "--map", "drive.svg"]);
    let svg = String::from_utf8(folder.read("drive.svg")).expect("text");
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"), "{svg}");
    assert_eq!(svg.matches("5 frames</title>").count(), 4, "{svg}");
    assert_eq!(svg.matches("<title>camera</title>").count(), FRAMES);
    let files = ["out/frame-0000.png", "out/frame-0001.png"];
    let run = |rest: &[&str]| folder.run(&[&["frame", "--setup", "setup.toml"], &files[..], rest].concat());
    let outcome = run(&["--map", "m.svg"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("--map of several frames needs --frame-interval-s"), "{}", outcome.stderr);
    let outcome = run(&["--frame-interval-s", "0.04", "--map", "m.png"]);
    assert!(outcome.code == 2 && outcome.stderr.contains("it must end in .svg"), "{}", outcome.stderr);
}

/// Six edges before a camera that rolls by 4° and looks 7° down.
const SIX_EDGES: &str = "\
[background]
level = 200
[[bar]]
bearing = -0.35
depth_m = 2.0
width_m = 0.12
level = 40
[[bar]]
bearing = 0.0
depth_m = 2.6
width_m = 0.2
level = 60
[[bar]]
bearing = 0.3
depth_m = 2.2
width_m = 0.15
level = 50
";

const TURNED: [f64; 3] = [0.07, 0.99, 0.12];

fn turned_camera(rest: &[&str]) -> Value {
    let told = setup(0.1, "").replace("[attitude]\n", &format!("[attitude]\ngravity = {TURNED:?}\n"));
    let folder = Folder::new().with("told.toml", told.as_str()).with("scene.toml", SIX_EDGES);
    let learning = told.replace(&format!("gravity = {TURNED:?}"), "gravity = \"learn\"");
    let folder = folder.with("setup.toml", learning.as_str());
    let arguments = ["simulate", "--setup", "told.toml", "--scene", "scene.toml", "--out", "out", "--frames", "5"];
    let outcome = folder.run(&[&arguments[..], &["--frame-interval-s", "0.04"]].concat());
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    frame(&folder, rest)
}

#[test]
fn a_sequence_learns_its_gravity() {
    let found = turned_camera(&["--frame-interval-s", "0.04"]);
    let length = TURNED.iter().map(|part| part * part).sum::<f64>().sqrt();
    let last = &found["frames"][FRAMES - 1];
    let sigma_deg = number(last, "sigma_gravity_deg");
    assert!(sigma_deg < 0.5 && number(&found["frames"][0], "sigma_gravity_deg") > sigma_deg, "{last}");
    for (axis, part) in TURNED.into_iter().enumerate() {
        let learned = last["gravity"][axis].as_f64().expect("a number");
        assert_near(learned, part / length, 3.0 * sigma_deg.to_radians());
    }
    let ok = ranges(&found, FRAMES - 1).iter().filter(|range| range["status"] == "ok").count();
    assert!(ok >= 5, "{ok}");
}

#[test]
fn learning_gravity_needs_a_sequence() {
    for (gravity, expected) in [("\"learn\"", "for frames that are no sequence"), ("\"down\"", "\"learn\" or \"fit\"")]
    {
        let text = SETUP.replace("[attitude]\n", &format!("[attitude]\ngravity = {gravity}\n"));
        let folder = Folder::new().with("setup.toml", text.as_str()).with("a.csv", "row,column\n1,2\n");
        let outcome = folder.run(&["edges", "a.csv", "--setup", "setup.toml"]);
        assert!(outcome.code == 1 && outcome.stderr.contains(expected), "{}", outcome.stderr);
    }
}

/// A single frame without an exposure cannot tell roll and pitch, and says so.
#[test]
fn fitting_gravity_to_a_frame_says_where_it_cannot() {
    let text = SETUP.replace("[attitude]\n", "[attitude]\ngravity = \"fit\"\n");
    // Nobody is asked for what the setup has.
    for (camera, asks) in [("fx = 600", true), ("exposure_s = 0.001\nfx = 600", false)] {
        let folder = Folder::of(&text.replace("fx = 600", camera), "row,column\n1,2\n");
        let frame = folder.document()["frames"][0].take();
        let hint = frame["hints"][0].as_str().expect("a hint");
        assert!(hint.starts_with("gravity cannot be fitted to this frame"), "{hint}");
        assert_eq!(hint.contains("exposure_s"), asks, "{hint}");
        assert!(number(&frame, "sigma_gravity_deg") > 7.0);
    }
}
