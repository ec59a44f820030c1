//! `--frame-interval-s` and `--trajectory`: sequences, and motions that change.

use std::fmt::Write;

use serde_json::Value;

use crate::simulations::SCENE;
use crate::tool::{Folder, Outcome, SETUP, assert_near, column, number};

const HEADER: &str = "time_s,vx,vy,vz,wx,wy,wz";

/// [`SETUP`] without its velocity.
fn setup_without_motion() -> String {
    SETUP.replace("velocity_m_s = [-1.5, 0, 0]\n", "")
}

/// A trajectory of constant values, every 10 ms from -0.1 s on.
fn constant(samples: u32, values: &str) -> String {
    let line = |k| format!("{:.3},{values}\n", f64::from(k) * 0.01 - 0.1);
    (0..samples).map(line).collect()
}

/// One edge at bearing 0.1 on every tenth row.
fn one_line(depth_m: f64, rest: &str) -> String {
    (0..480).step_by(10).map(|row| format!("{row},{:.5}{rest}\n", column(0.1, depth_m, row))).collect()
}

fn edges(setup: &str, edges: &str, trajectory: &str, rest: &[&str]) -> Outcome {
    let folder = Folder::of(setup, edges).with("drive.csv", trajectory);
    let arguments = ["edges", "edges.csv", "--setup", "setup.toml", "--json", "--trajectory", "drive.csv"];
    folder.run(&[&arguments[..], rest].concat())
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().unwrap_or_else(|| panic!("{key} is no list: {value}"))
}

/// All of the truth's edges are found with their depths.
#[track_caller]
fn assert_found(truth: &Value, found: &Value) {
    for (truth, found) in list(truth, "frames").iter().zip(list(found, "frames")) {
        let (edges, ranges) = (list(truth, "edges"), list(found, "ranges"));
        assert_eq!(edges.len(), ranges.len(), "{found}");
        for (edge, range) in edges.iter().zip(ranges) {
            assert_eq!(range["status"], "ok", "{range}");
            assert_near(number(range, "bearing"), number(edge, "bearing"), 3e-4);
            let (rho, sigma) = (number(range, "inverse_depth_per_m"), number(range, "sigma_inverse_depth_per_m"));
            assert_near(rho, number(edge, "inverse_depth_per_m"), 5.0 * sigma);
            assert!(sigma < 0.02 * rho, "{range}");
        }
    }
}

/// Turning right and rolling; three frames.
const RATE: [f64; 3] = [0.0, 0.3, 0.4];

fn turning_frames() -> (Folder, Value) {
    let setup = SETUP.replace("[motion]", &format!("[motion]\nrate_rad_s = {RATE:?}"));
    let folder = Folder::new().with("setup.toml", setup).with("scene.toml", SCENE);
    let arguments = ["simulate", "--setup", "setup.toml", "--scene", "scene.toml", "--out", "out", "--frames", "3"];
    let truth = folder.run(&[&arguments[..], &["--frame-interval-s", "0.1", "--json"]].concat()).json();
    (folder, truth)
}

fn frames(folder: &Folder, rest: &[&str]) -> Outcome {
    let files = ["out/frame-0000.png", "out/frame-0001.png", "out/frame-0002.png"];
    folder.run(&[&["frame", "--json"], &files[..], rest].concat())
}

/// A velocity that keeps its direction in space, in the axes of the turning camera.
fn turned(velocity: [f64; 3], time_s: f64) -> [f64; 3] {
    let rate = RATE.iter().map(|rate| rate * rate).sum::<f64>().sqrt();
    let [x, y, z] = RATE.map(|component| component / rate);
    let (s, c) = (-rate * time_s).sin_cos();
    let [vx, vy, vz] = velocity;
    let along = (x * vx + y * vy + z * vz) * (1.0 - c);
    [
        vx * c + (y * vz - z * vy) * s + x * along,
        vy * c + (z * vx - x * vz) * s + y * along,
        vz * c + (x * vy - y * vx) * s + z * along,
    ]
}

/// The simulated motion, so many times a second.
fn turning_drive(hertz: u32, with_gravity: bool) -> String {
    let mut text = format!("{HEADER}{}\n", if with_gravity { ",gx,gy,gz" } else { "" });
    for k in 0..=hertz * 24 / 100 {
        let time_s = f64::from(k) / f64::from(hertz);
        let ([vx, vy, vz], [wx, wy, wz]) = (turned([-1.5, 0.0, 0.0], time_s), RATE);
        let _ = write!(text, "{time_s},{vx},{vy},{vz},{wx},{wy},{wz}");
        if with_gravity {
            let [gx, gy, gz] = turned([0.0, 9.81, 0.0], time_s);
            let _ = write!(text, ",{gx},{gy},{gz}");
        }
        text.push('\n');
    }
    text
}

#[test]
fn a_sequence_goes_on_as_it_was_simulated() {
    let (folder, truth) = turning_frames();
    let sequence = frames(&folder, &["--setup", "setup.toml", "--frame-interval-s", "0.1"]).json();
    assert_found(&truth, &sequence);
    // On its own, each frame starts with the setup's motion, which is that of the first one.
    let apart = frames(&folder, &["--setup", "setup.toml"]).json();
    for (alone, first) in list(&apart["frames"][0], "ranges").iter().zip(list(&sequence["frames"][0], "ranges")) {
        assert_eq!(alone["depth_m"], first["depth_m"]);
    }
    for (alone, range) in list(&apart["frames"][2], "ranges").iter().zip(list(&sequence["frames"][2], "ranges")) {
        assert!(number(alone, "depth_m") < 0.5 * number(range, "depth_m"), "{alone}");
    }
}

#[test]
fn a_trajectory_of_the_same_motion() {
    let (folder, truth) = turning_frames();
    let mut folder = folder.with("bare.toml", setup_without_motion());
    for (hertz, with_gravity) in [(50, false), (200, true), (1000, false), (20_000, true)] {
        folder = folder.with("drive.csv", turning_drive(hertz, with_gravity));
        let arguments = ["--setup", "bare.toml", "--frame-interval-s", "0.1", "--trajectory", "drive.csv"];
        assert_found(&truth, &frames(&folder, &arguments).json());
    }
}

#[test]
fn a_constant_trajectory_is_the_setups_motion() {
    let text = format!("row,column\n{}", one_line(2.0, ""));
    let expected = Folder::of(SETUP, &text).ranges().remove(0);
    for setup in [SETUP.to_string(), setup_without_motion(), SETUP.replace("-1.5", "7")] {
        let drive = format!("{HEADER}\n{}", constant(30, "-1.5,0,0,0,0,0"));
        let document = edges(&setup, &text, &drive, &[]).json();
        let range = &document["frames"][0]["ranges"][0];
        for key in ["inverse_depth_per_m", "sigma_inverse_depth_per_m", "bearing"] {
            assert_near(number(range, key), number(&expected, key), 1e-9);
        }
    }
    let uncertain = setup_without_motion().replace("sigma_speed = 0", "sigma_speed = 0.1");
    let drive = format!("{HEADER}\n{}", constant(30, "-1.5,0,0,0,0,0"));
    let document = edges(&uncertain, &text, &drive, &[]).json();
    let range = &document["frames"][0]["ranges"][0];
    let sigma = number(range, "sigma_inverse_depth_per_m") / number(range, "inverse_depth_per_m");
    assert_near(sigma, 0.1, 0.001);
}

/// The faster, the farther: edges that look alike, in frames at which the camera has another speed.
#[test]
fn frames_of_edges_have_their_numbers() {
    let text = format!("row,column,frame\n{}{}{}", one_line(2.0, ",0"), one_line(2.0, ",2"), one_line(2.0, ",10"));
    let mut drive = format!("{HEADER}\n");
    for k in 0..60 {
        let speed = if k < 15 { 1.5 } else { 3.0 };
        let _ = writeln!(drive, "{},{},0,0,0,0,0", f64::from(k) * 0.02, -speed);
    }
    let document = edges(SETUP, &text, &drive, &["--frame-interval-s", "0.1"]).json();
    let depth = |index: usize| number(&document["frames"][index]["ranges"][0], "depth_m");
    for (index, depth_m) in [2.0, 2.0, 4.0].into_iter().enumerate() {
        assert_near(depth(index), depth_m, 0.01);
    }
}

/// Whatever its number is: a recording may begin anywhere.
#[test]
fn time_is_counted_from_the_first_frame() {
    let turning = SETUP.replace("[motion]\n", "[motion]\nrate_rad_s = [0, 0.3, 0]\n");
    let speeding_up =
        format!("{HEADER}\n-0.01,-1.5,0,0,0,0,0\n0.1,-1.5,0,0,0,0,0\n0.2,-3,0,0,0,0,0\n0.3,-3,0,0,0,0,0\n");
    let ranges = |setup: &str, first: i64, rest: &[&str]| {
        let text = format!("{}{}", one_line(2.0, &format!(",{first}")), one_line(2.0, &format!(",{}", first + 1)));
        let folder = Folder::of(setup, &format!("row,column,frame\n{text}")).with("drive.csv", &speeding_up);
        let interval = ["edges", "edges.csv", "--setup", "setup.toml", "--json", "--frame-interval-s", "0.05"];
        let document = folder.run(&[&interval[..], rest].concat()).json();
        [0, 1].map(|frame| document["frames"][frame]["ranges"].clone())
    };
    for first in [5, 1000, -7, i64::MAX - 1, i64::MIN] {
        assert_eq!(ranges(&turning, first, &[]), ranges(&turning, 0, &[]), "{first}");
        let rest = ["--trajectory", "drive.csv"];
        assert_eq!(ranges(SETUP, first, &rest), ranges(SETUP, 0, &rest), "{first}");
    }
}

#[test]
fn frames_that_are_ages_apart_are_refused() {
    let text = format!("row,column,frame\n5,1,{}\n5,1,{}\n", i64::MIN, i64::MAX);
    let outcome =
        edges(SETUP, &text, &format!("{HEADER}\n{}", constant(20, "-1.5,0,0,0,0,0")), &["--frame-interval-s", "1"]);
    let expected = "error: from edges.csv#-9223372036854775808 to edges.csv#9223372036854775807 it is 18446744073709552000 \
                    s, but must be at most 1000000 s\n";
    assert_eq!((outcome.code, outcome.stderr.as_str()), (1, expected));
}

/// It would be told and estimated.
#[test]
fn gravity_of_a_trajectory_contradicts_one_that_is_estimated() {
    let drive = format!("{HEADER},gx,gy,gz\n{}", constant(20, "-1.5,0,0,0,0,0,0,1,0"));
    let text = format!("row,column\n{}", one_line(2.0, ""));
    for (source, rest) in [("learn", &["--frame-interval-s", "0.05"][..]), ("fit", &[])] {
        let setup = SETUP.replace("[attitude]\n", &format!("[attitude]\ngravity = {source:?}\n"));
        let outcome = edges(&setup, &text, &drive, rest);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""), "{source}");
        let message = "error: drive.csv: the columns `gx`, `gy` and `gz` must be left out";
        assert!(outcome.stderr.starts_with(message), "{}", outcome.stderr);
        let without = format!("{HEADER}\n{}", constant(20, "-1.5,0,0,0,0,0"));
        assert_eq!(edges(&setup, &text, &without, rest).code, 0);
    }
}

#[test]
fn gravity_is_carried_on_from_the_first_frame() {
    // The camera has rolled by 0.2 rad when the frame starts at 0.4 s; its edges are upright in space.
    let lean = |sign: f64| {
        let lines = (0..480).step_by(10).map(|row| {
            let off = sign * 0.2_f64.tan() * (f64::from(row) - 239.5);
            format!("{row},{:.5},4\n", 319.5 + off + 600.0 * 1.5 / 2.0 * f64::from(row) * 0.0333 / 480.0)
        });
        format!("row,column,frame\n{}{}", one_line(2.0, ",0"), lines.collect::<String>())
    };
    let setup = SETUP.replace("sigma_tilt_deg = 0", "sigma_tilt_deg = 0\ngravity = [0, 1, 0]");
    let mut drive = format!("{HEADER}\n");
    for k in 0..60 {
        let _ = writeln!(drive, "{},-1.5,0,0,0,0,{}", f64::from(k) * 0.01, if k < 40 { 0.5 } else { 0.0 });
    }
    let range = |text: &str| {
        let document = edges(&setup, text, &drive, &["--frame-interval-s", "0.1"]).json();
        document["frames"][1]["ranges"][0].clone()
    };
    // Rolled clockwise, the camera sees what is upright lean to the right at its lower end.
    assert_eq!(range(&lean(1.0))["status"], "ok");
    assert_ne!(range(&lean(-1.0))["status"], "ok");
}

fn first_range(drive: &str) -> Value {
    let text = format!("row,column\n{}", one_line(2.0, ""));
    edges(SETUP, &text, drive, &[]).json()["frames"][0]["ranges"][0].clone()
}

#[test]
fn columns_that_are_missing_are_zero() {
    let whole = first_range(&format!("{HEADER},gx,gy,gz\n{}", constant(30, "-1.5,0,0,0,0.1,0,0,1,0")));
    assert_eq!(first_range(&format!("time_s,vx,wy,gy\n{}", constant(30, "-1.5,0.1,1"))), whole);
    assert_eq!(first_range(&format!("time_s,wy,vx\n{}", constant(30, "0.1,-1.5"))), whole);
}

/// Samples of a speed that rises from 1 to 2 m/s, as different clocks and loggers stamp them.
#[test]
fn stamps_are_taken_as_they_are_meant() {
    let speed = |time_s: f64| -(1.0 + time_s);
    let drive = |stamps: &dyn Fn(u32) -> f64| {
        let line = |k: u32| format!("{:.4},{:.6}\n", stamps(k), speed(f64::from(k) * 0.0025 - 0.1));
        format!("time_s,vx\n{}", (0..120).map(line).collect::<String>())
    };
    let depth = |drive: &str| number(&first_range(drive), "depth_m");
    let exact = depth(&drive(&|k| f64::from(k) * 0.0025 - 0.1));
    // A clock of 10 ms ticks four times as slowly as the samples come.
    assert_near(depth(&drive(&|k| f64::from(k / 4) * 0.01 - 0.1)), exact, 1e-6);
    // The logger wrote each line twice.
    let twice: String =
        drive(&|k| f64::from(k) * 0.0025 - 0.1).lines().skip(1).map(|line| format!("{line}\n{line}\n")).collect();
    assert_near(depth(&format!("time_s,vx\n{twice}")), exact, 1e-6);
    // Bursts of four samples within 0.3 ms, every 20 ms.
    let bursts: String = (0..60)
        .map(|k| {
            let time_s = f64::from(k / 4) * 0.02 + f64::from(k % 4) * 1e-4 - 0.1;
            format!("{time_s:.5},{:.6}\n", speed(time_s))
        })
        .collect();
    assert_near(depth(&format!("time_s,vx\n{bursts}")), exact, 1e-4);
    // Two values of one instant are a jump: before the frame the one, from then on the other.
    let jump = "time_s,vx\n-0.02,-9\n-0.01,-9\n-0.001,-9\n-0.001,-1.5\n0.01,-1.5\n0.02,-1.5\n0.03,-1.5\n0.04,-1.5\n";
    assert_near(depth(jump), number(&first_range("time_s,vx\n-0.1,-1.5\n0.1,-1.5\n"), "depth_m"), 1e-6);
}

#[track_caller]
fn refuse(trajectory: &str, message: &str) {
    let text = format!("row,column\n{}", one_line(2.0, ""));
    let outcome = edges(SETUP, &text, trajectory, &[]);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""));
    assert_eq!(outcome.stderr, format!("error: {message}\n"));
}

#[test]
fn trajectories_that_are_refused() {
    let file = |message: &str| format!("drive.csv: {message}");
    refuse("", &file("the file is empty: it must begin with a header such as `time_s`"));
    refuse("vx,vy,vz\n", &file("line 1: column `time_s` is missing: the header must name `time_s`"));
    let names = "`vx`, `vy`, `vz`, `wx`, `wy` and `wz`";
    refuse("time_s,gy\n", &file(&format!("the header names no motion: it must name some of {names}")));
    refuse("time,vx,vy,vz,wx,wy,wz\n", &file("line 1: unknown column `time`; the nearest is `time_s`"));
    let body = |lines: &str| format!("{HEADER}\n{lines}");
    refuse(&body("0,1,0,0,0,0,0\n"), &file("1 samples, but there must be at least 2"));
    let fast = "line 3: `vy` is `1e9`, but must be a number from -10000 to 10000 (m/s)";
    refuse(&body("0,1,0,0,0,0,0\n1,0,1e9,0,0,0,0\n"), &file(fast));
    let spinning = "line 2: `wx` is `nan`, but must be a number from -1000 to 1000 (rad/s)";
    refuse(&body("0,1,0,0,nan,0,0\n"), &file(spinning));
    refuse(&body("0,1,0,0,,0,0\n"), &file("line 2: `wx` is empty, but must be a number from -1000 to 1000 (rad/s)"));
    let order = "line 4: `time_s` is `0.4`, but must be at least 0.5, that of the line before";
    refuse(&body("0,1,0,0,0,0,0\n0.5,1,0,0,0,0,0\n0.4,1,0,0,0,0,0\n"), &file(order));
    refuse(&body("0.5,1,0,0,0,0,0\n0.5,1,0,0,0,0,0\n"), &file("1 samples, but there must be at least 2"));
    let epoch = "line 2: `time_s` is `1.7e9`, but must be a number from -1000000 to 1000000 (seconds since the start of \
                 the first frame)";
    refuse(&body("1.7e9,1,0,0,0,0,0\n"), &file(epoch));
    let weightless = "line 2: `gx`, `gy`, `gz` are 0 long, but must be a direction: 0.001 at least";
    refuse(&format!("{HEADER},gx,gy,gz\n0,1,0,0,0,0,0,0,0,0\n"), &file(weightless));
}

#[test]
fn trajectories_that_do_not_reach() {
    let gap = |at_s: &str, gap_s: &str, trusted_s: &str| {
        format!(
            "edges.csv: frame start at 0 s: the trajectory has no velocity at {at_s} s: a gap of {gap_s} s, but at most \
             {trusted_s} s are trusted, 3 times the usual interval of its samples"
        )
    };
    // The last row is read 479 line times after the first.
    let short = format!("{HEADER}\n{}", "-0.002,1,0,0,0,0,0\n0,1,0,0,0,0,0\n0.002,1,0,0,0,0,0\n");
    refuse(&short, &gap("0.033230625", "0.031230625", "0.006"));
    let late = format!("{HEADER}\n{}", "1,1,0,0,0,0,0\n1.1,1,0,0,0,0,0\n");
    refuse(&late, &gap("0", "1", "0.3"));
    let holed: String =
        [-3, -2, -1, 0, 1, 8, 9, 10, 11, 12].map(|k| format!("{},1,0,0,0,0,0\n", f64::from(k) / 250.0)).concat();
    refuse(&format!("{HEADER}\n{holed}"), &gap("0.004", "0.028", "0.012"));

    let (folder, _) = turning_frames();
    let drive: Vec<_> = turning_drive(100, false).lines().take(16).map(str::to_string).collect();
    let folder = folder.with("drive.csv", drive.join("\n"));
    // The first frame is covered up to the start of the second, the second is not.
    let arguments = ["--setup", "setup.toml", "--frame-interval-s", "0.1", "--trajectory", "drive.csv"];
    let outcome = frames(&folder, &arguments);
    assert_eq!(outcome.code, 1);
    let lines: Vec<_> = outcome.stderr.lines().collect();
    assert_eq!(lines.len(), 2, "{}", outcome.stderr);
    assert!(
        lines[0]
            .starts_with("error: out/frame-0001.png: frame start at 0.1 s: the trajectory has no velocity at 0.2 s")
    );
    let document = outcome.document();
    assert_eq!(list(&document, "frames").len(), 1);
}

#[test]
fn several_frames_need_an_interval() {
    let (folder, _) = turning_frames();
    let folder = folder.with("drive.csv", turning_drive(100, false));
    let outcome = frames(&folder, &["--setup", "setup.toml", "--trajectory", "drive.csv"]);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""));
    assert!(outcome.stderr.contains("--trajectory for several frames needs --frame-interval-s"), "{}", outcome.stderr);
    let one = ["frame", "out/frame-0000.png", "--setup", "setup.toml", "--trajectory", "drive.csv", "--json"];
    assert_eq!(list(&folder.run(&one).json()["frames"][0], "ranges").len(), 4);
    let text = format!("row,column,frame\n{}{}", one_line(2.0, ",0"), one_line(2.0, ",1"));
    let outcome = edges(SETUP, &text, &format!("{HEADER}\n{}", constant(30, "1,0,0,0,0,0")), &[]);
    assert_eq!(outcome.code, 1);
    assert!(outcome.stderr.contains("--trajectory for several frames needs --frame-interval-s"), "{}", outcome.stderr);
    let negative = frames(&folder, &["--setup", "setup.toml", "--frame-interval-s", "-1"]);
    assert_eq!(negative.code, 2);
}
