//! `calibrate flicker` and `calibrate scale`, on what `simulate` writes and on the paper's table.

use crate::painting::{painted, png};
use crate::tool::{Folder, Outcome, assert_near, number};

const CAMERA: &str = "\
[camera]
columns = 160
rows = 240
fx = 300
line_time_us = 65.33
exposure_s = 0.0003
[motion]
velocity_m_s = [0, 0, 0]
";
const WALL: &str = "[background]\nlevel = 100\ncontrast = 15\n";

fn lit(lamp: &str) -> Folder {
    let folder = Folder::new().with("camera.toml", CAMERA).with("scene.toml", format!("{WALL}[lamp]\n{lamp}\n"));
    let arguments = ["simulate", "--setup", "camera.toml", "--scene", "scene.toml", "--out", "lamp", "--frames", "6"];
    let outcome = folder.run(&[&arguments[..], &["--frame-interval-s", "0.0337"]].concat());
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    folder
}

fn flicker(folder: &Folder, frames: usize, more: &[&str]) -> Outcome {
    let names: Vec<_> = (0..frames).map(|frame| format!("lamp/frame-{frame:04}.png")).collect();
    let mut arguments = vec!["calibrate", "flicker", "--frequency-hz", "1000"];
    arguments.extend(names.iter().map(String::as_str));
    arguments.extend(more);
    folder.run(&arguments)
}

#[test]
fn a_lamp_gives_the_line_time() {
    let folder = lit("frequency_hz = 1000\ndepth = 0.8\nduty = 0.4");
    let document = flicker(&folder, 6, &["--json", "--svg", "bands.svg"]).json();
    assert_eq!(document["status"], "ok");
    let (line_time_us, sigma_us) = (number(&document, "line_time_us"), number(&document, "sigma_line_time_us"));
    assert_near(line_time_us, 65.33, 4.0 * sigma_us);
    assert_near(number(&document, "readout_s"), 240.0 * 65.33e-6, 1e-5);
    assert!(sigma_us < 0.02 && number(&document, "periods") > 15.0, "{document}");
    let svg = String::from_utf8(folder.read("bands.svg")).expect("UTF-8");
    assert!(svg.starts_with("<svg") && svg.contains("periods in a frame"), "{}", svg.len());
    // What the text says goes into a setup as it is.
    let text = flicker(&folder, 6, &[]).stdout;
    let keys = text.split("[camera]\n").nth(1).expect("keys");
    let setup = CAMERA.replace("line_time_us = 65.33\n", keys);
    let folder = folder.with("setup.toml", setup).with("edges.csv", "row,column\n");
    assert_eq!(folder.edges().code, 0, "{}", folder.edges().stderr);
}

#[test]
fn what_cannot_be_told_has_a_reason() {
    let steady = lit("frequency_hz = 1000\ndepth = 0");
    let outcome = flicker(&steady, 6, &["--json"]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (1, ""));
    let document = outcome.document();
    assert!(document["status"] == "no_bands" && document["line_time_us"].is_null(), "{document}");
    let one = flicker(&steady, 1, &["--json"]);
    assert_eq!((one.code, &one.document()["status"]), (1, &"too_few_frames".into()));
    let explained = flicker(&steady, 6, &["--exposure-s", "0.003"]);
    assert!(explained.stdout.contains("the exposure is 3 whole periods of the lamp"), "{}", explained.stdout);
    let mains = flicker(&steady, 6, &["--exposure-s", "0.02"]);
    assert_eq!(mains.code, 1);
    let hint = steady.run(&["calibrate", "flicker", "lamp/frame-0000.png", "--frequency-hz", "50"]);
    assert!(hint.stdout.contains("flickers at 100 Hz"), "{}", hint.stdout);
}

/// No lamp at all: what changes from frame to frame is the scene, and its row means wave, too.
#[test]
fn a_camera_that_moves_tells_no_line_time() {
    let moving = CAMERA.replace("velocity_m_s = [0, 0, 0]", "velocity_m_s = [1.5, 0, 0]");
    let moving = moving.replace("columns = 160", "columns = 640").replace("rows = 240", "rows = 480");
    let folder = Folder::new().with("camera.toml", moving.replace("fx = 300", "fx = 600"));
    let simulated = folder.run(&["simulate", "--setup", "camera.toml", "--out", "lamp", "--frames", "4"]);
    assert_eq!(simulated.code, 0, "{}", simulated.stderr);
    let outcome = flicker(&folder, 4, &["--json"]);
    let document = outcome.document();
    assert!(document["status"] == "moving" && document["line_time_us"].is_null(), "{document}");
    assert_eq!((outcome.code, outcome.stderr.as_str()), (1, ""));
    let text = flicker(&folder, 4, &[]).stdout;
    assert!(text.starts_with("no line time: ") && text.contains("hold the camera still"), "{text}");
}

#[test]
fn flicker_refuses_what_is_wrong() {
    let folder = lit("frequency_hz = 1000").with("text.png", "no picture");
    let wrong_in = |folder: &Folder, arguments: &[&str]| folder.run(&[&["calibrate", "flicker"], arguments].concat());
    let wrong = |arguments: &[&str]| wrong_in(&folder, arguments);
    assert_eq!(wrong(&["lamp/frame-0000.png"]).code, 2, "the frequency is missing");
    for frequency in ["0", "-5", "nan", "1e9", "x"] {
        let outcome = wrong(&["lamp/frame-0000.png", "--frequency-hz", frequency]);
        assert_eq!(outcome.code, 2, "{frequency}: {}", outcome.stderr);
    }
    assert_eq!(wrong(&["--frequency-hz", "1000"]).code, 2, "the frames are missing");
    assert_eq!(wrong(&["lamp/frame-0000.png", "--frequency-hz", "1000", "--svg", "bands.png"]).code, 2);
    for file in ["text.png", "missing.png"] {
        let outcome = wrong(&[file, "--frequency-hz", "1000"]);
        assert_eq!(outcome.code, 1);
        assert!(outcome.stderr.contains(file), "{}", outcome.stderr);
    }
    let scene = format!("{WALL}[lamp]\nfrequency_hz = -3\n");
    let folder = folder.with("bad.toml", scene).with("large.png", png(painted()));
    let unlike = wrong_in(&folder, &["lamp/frame-0000.png", "large.png", "--frequency-hz", "1000"]);
    let message = "large.png: the frame is 640 × 480 pixels, but must be 160 × 240, as lamp/frame-0000.png is";
    assert_eq!((unlike.code, unlike.stderr), (1, format!("error: {message}\n")));
    let outcome = folder.run(&["simulate", "--setup", "camera.toml", "--scene", "bad.toml", "--out", "bad"]);
    assert!(outcome.stderr.starts_with("error: bad.toml: `lamp.frequency_hz` is -3, but"), "{}", outcome.stderr);
}

/// The paper's, with the readout of each pass.
fn table_2() -> Folder {
    let published = include_str!("../../../host_tests/data/table2.csv");
    let mut passes = "speed_m_s,distance_m,angle_deg,readout_s\n".to_string();
    for line in published.lines().skip(1) {
        let cells: Vec<_> = line.split(',').collect();
        let shutter: f64 = cells[1].strip_prefix("1/").expect("a fraction").parse().expect("a number");
        passes += &format!("{},{},{},{}\n", cells[2], cells[3], cells[4], 1.0 / shutter);
    }
    Folder::new().with("passes.csv", passes)
}

#[test]
fn table_2_gives_kappa_with_and_without_a_tilt() {
    let folder = table_2();
    let free = folder.run(&["calibrate", "scale", "passes.csv", "--json", "--svg", "passes.svg"]).json();
    assert_near(number(&free, "kappa"), 2.352, 0.001);
    assert_near(number(&free, "sigma_kappa"), 0.0135, 0.001);
    assert_near(number(&free, "tilt_deg"), 0.006, 0.001);
    assert_near(number(&free, "sigma_tilt_deg"), 0.034, 0.001);
    assert_eq!(free["passes"].as_array().expect("passes").len(), 40);
    let upright =
        folder.run(&["calibrate", "scale", "passes.csv", "--sigma-roll-deg", "0", "--rows", "1080", "--json"]).json();
    assert_near(number(&upright, "kappa"), 2.354, 0.001);
    assert_near(number(&upright, "fx"), 2.354 * 1080.0, 1.5);
    assert!(String::from_utf8(folder.read("passes.svg")).expect("UTF-8").contains("two sigma"));
}

/// A post that a simulated camera passes in both directions; the tool finds its edges.
#[test]
fn frames_of_passes_give_the_focal_length() {
    let mut folder = Folder::new()
        .with("post.toml", "[background]\nlevel = 180\n[[bar]]\nbearing = 0\ndepth_m = 1\nwidth_m = 0.1\nlevel = 50\n");
    let mut passes = "frame,speed_m_s,distance_m,sigma_deg\n".to_string();
    for (name, speed) in [("left", -1.5), ("right", 1.5)] {
        let setup = CAMERA.replace("[0, 0, 0]", &format!("[{speed}, 0, 0]"));
        folder = folder.with("camera.toml", setup);
        let arguments = ["simulate", "--setup", "camera.toml", "--scene", "post.toml", "--out", name, "--frames", "2"];
        assert_eq!(folder.run(&arguments).code, 0);
        passes += &format!("{name}/frame-0000.png,{0},1,0.02\n{name}/frame-0001.png,{0},1,0.02\n", -speed);
    }
    let folder = folder.with("passes.csv", passes);
    let by_focal = folder.run(&["calibrate", "scale", "passes.csv", "--focal-px", "300", "--json"]).json();
    assert_near(number(&by_focal, "line_time_us"), 65.33, 0.2);
    let readout_s = (65.33e-6 * 240.0).to_string();
    let by_readout = ["calibrate", "scale", "passes.csv", "--readout-s", &readout_s, "--rows", "240", "--json"];
    assert_near(number(&folder.run(&by_readout).json(), "fx"), 300.0, 1.0);
}

#[test]
fn contradictory_and_wrong_passes() {
    let scale =
        |passes: &str| Folder::new().with("passes.csv", passes).run(&["calibrate", "scale", "passes.csv", "--json"]);
    let status = |passes: &str| {
        let outcome = scale(passes);
        assert_eq!((outcome.code, outcome.stderr.as_str()), (1, ""), "{passes}");
        outcome.document()["status"].as_str().expect("a word").to_string()
    };
    let head = "speed_m_s,distance_m,slope\n";
    assert_eq!(status(&format!("{head}1,1,0.04\n1,2,0.02\n")), "too_few_passes");
    assert_eq!(status(&format!("{head}1,1,0.5\n1,2,-0.2\n-1,2,0.3\n-1,1,-0.6\n2,1,-0.9\n")), "contradictory");
    assert_eq!(status(&format!("{head}1,1,-0.04\n1,2,-0.02\n-1,2,0.02\n")), "reversed");
    assert_eq!(status(&format!("{head}1,1,0.04\n1,1,0.04\n1,1,0.04\n")), "alike");
    for (passes, message) in [
        ("speed_m_s,distance_m\n1,1\n", "the header must name one of `slope`, `angle_deg` and `frame`"),
        ("speed_m_s,distance_m,slope,angle_deg\n1,1,1,1\n", "but names 2"),
        ("distance_m,slope\n1,1\n", "column `speed_m_s` is missing"),
        ("speed_m_s,distance_m,slope\n0,1,0.1\n1,1,0.1\n1,1,0.1\n", "line 2: speed_m_s is 0"),
        ("speed_m_s,distance_m,slope\n1,-1,0.1\n", "line 2: `distance_m` is `-1`"),
        ("speed_m_s,distance_m,frame\n1,1,nothing.png\n", "error: passes.csv: line 2: reading nothing.png: "),
        (
            "speed_m_s,distance_m,slope,readout_s\n1,1,0.1,33\n",
            "line 2: `readout_s` is `33`, but must be a number from ",
        ),
        ("speed_m_s,distance_m,slope,readout_s\n1,1,0.1,0.02\n1,1,0.1,\n", "`readout_s` is empty on some lines"),
    ] {
        let outcome = scale(passes);
        assert_eq!(outcome.code, 1, "{passes}");
        assert!(outcome.stderr.contains(message), "{passes}: {}", outcome.stderr);
    }
}

/// Without and with the readout of each pass.
fn few_passes() -> Folder {
    let passes = "speed_m_s,distance_m,slope\n1,2,0.02\n-1,2,-0.02\n2,2,0.04\n";
    let stated = passes.replace("slope\n", "slope,readout_s\n").replace("02\n", "02,0.03\n").replace("4\n", "4,0.03\n");
    Folder::new().with("passes.csv", passes).with("stated.csv", stated)
}

/// No option of a run that succeeds was without effect.
#[test]
fn options_that_would_say_nothing_are_refused() {
    let folder = few_passes();
    let scale = |arguments: &[&str]| folder.run(&[&["calibrate", "scale"], arguments].concat());
    for (arguments, code, message) in [
        (&["stated.csv", "--focal-px", "600"][..], 1, "error: stated.csv: the column `readout_s` states the readout"),
        (
            &["stated.csv", "--readout-s", "0.05", "--rows", "480"],
            1,
            "error: stated.csv: the column `readout_s` states",
        ),
        (&["passes.csv", "--rows", "480"], 1, "give --readout-s, or a column `readout_s`"),
        (&["passes.csv", "--rows", "480", "--focal-px", "600"], 2, "'--rows <N>'"),
        (&["passes.csv", "--readout-s", "33", "--rows", "480"], 2, "it must be a number from 0.001 to 0.5 (seconds"),
        (&["passes.csv", "--focal-px", "1e9"], 2, "it must be a number from 1 to 1000000 (focal length in pixels)"),
    ] {
        let outcome = scale(arguments);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (code, ""), "{arguments:?}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(message), "{arguments:?}: {}", outcome.stderr);
    }
    let hints = |arguments: &[&str]| scale(&[arguments, &["--json"]].concat()).json()["hints"].to_string();
    for with_kappa in [&["passes.csv", "--readout-s", "0.03"][..], &["stated.csv"]] {
        assert!(hints(with_kappa).contains("--rows"), "{with_kappa:?}");
        assert!(scale(with_kappa).stdout.contains("hint: with --rows"), "{with_kappa:?}");
        let complete = [with_kappa, &["--rows", "480"]].concat();
        assert_eq!(hints(&complete), "[]");
        assert_near(number(&scale(&[&complete[..], &["--json"]].concat()).json(), "fx"), 0.04 / 0.03 * 480.0, 1e-6);
    }
}
