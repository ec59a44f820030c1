//! Values that are possible but hardly ever meant: refused, unless the setup says that they are.

use crate::tool::{Folder, SETUP, column};

fn edges() -> String {
    let line = |row| format!("{row},{:.4}\n", column(0.1, 2.0, row));
    format!("row,column\n{}", (0..480).step_by(10).map(line).collect::<String>())
}

/// Refused, and accepted if the setup says that it is meant.
#[track_caller]
fn refuse(old: &str, new: &str, key: &str, message: &str) {
    assert!(SETUP.contains(old), "{old}");
    let setup = SETUP.replace(old, new);
    let outcome = Folder::of(&setup, &edges()).edges();
    assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""));
    let allowed = format!("if it is meant, say `unusual = [\"{key}\"]` at the top of the setup");
    assert_eq!(outcome.stderr, format!("error: setup.toml: {message}; {allowed}\n"));
    let outcome = Folder::of(&format!("unusual = [\"fx\", \"{key}\"]\n{setup}"), &edges()).edges();
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""), "{new}");
}

#[test]
fn a_readout_in_milliseconds_is_refused() {
    let readout = |key: &str, value: &str, seconds: &str| {
        let message =
            format!("`camera.{key}` is {value}, a readout of {seconds} s, but must be 0.001 to 0.5 s for a frame");
        refuse("readout_s = 0.0333", &format!("{key} = {value}"), key, &message);
    };
    readout("readout_s", "33.3", "33.3");
    readout("readout_s", "0.6", "0.6");
    readout("readout_s", "0.0009", "0.0009");
    readout("line_time_us", "69375.0", "33.3");
    let by_clock = "line_length_clocks = 1665\npixel_clock_hz = 24000";
    let message = "`camera.line_length_clocks` is 1665 and `camera.pixel_clock_hz` is 24000, a readout of 33.3 s, but \
                   must be 0.001 to 0.5 s for a frame";
    refuse("readout_s = 0.0333", by_clock, "line_length_clocks", message);
}

#[test]
fn an_exposure_in_milliseconds_is_refused() {
    let message = "`camera.exposure_s` is 8, an exposure of 8 s, but must be at most 0.1 s";
    refuse("fx = 600", "fx = 600\nexposure_s = 8", "exposure_s", message);
    // A slow readout may go with a long exposure.
    let slow = SETUP.replace("0.0333", "0.4").replace("fx = 600", "fx = 600\nexposure_s = 0.3");
    assert_eq!(Folder::of(&slow, "row,column\n").edges().code, 0);
}

#[test]
fn an_exposure_longer_than_the_time_between_frames_is_refused() {
    let setup = SETUP.replace("fx = 600", "fx = 600\nexposure_s = 0.06");
    let run = |setup: &str, interval: &str| {
        let arguments = ["edges", "edges.csv", "--setup", "setup.toml", "--frame-interval-s", interval];
        Folder::of(setup, &edges()).run(&arguments)
    };
    let outcome = run(&setup, "0.04");
    assert_eq!(outcome.code, 1);
    let message = "setup.toml: `camera.exposure_s` is 0.06, an exposure of 0.06 s, but must be at most 0.04 s, the time from \
                   frame to frame; if it is meant, say `unusual = [\"exposure_s\"]` at the top of the setup";
    assert_eq!(outcome.stderr, format!("error: {message}\n"));
    assert_eq!(run(&format!("unusual = [\"exposure_s\"]\n{setup}"), "0.04").code, 0);
    assert_eq!(run(&setup, "0.06").code, 0);
    assert_eq!(run(&setup.replace("0.06", "0.3"), "1").code, 0, "one frame a second");
}

#[test]
fn a_focal_length_in_millimetres_is_refused() {
    let message = "`camera.fx` is 3.6, a view of 178.7° over 640 pixels, but must be at most 170°";
    refuse("fx = 600", "fx = 3.6", "fx", message);
    let message = "`camera.focal_length_mm` is 0.0216, a view of 178.7° over 640 pixels, but must be at most 170°";
    refuse("fx = 600", "focal_length_mm = 0.0216\npixel_pitch_um = 6", "focal_length_mm", message);
    let message = "`camera.fy` is 3.6, a view of 178.3° over 480 pixels, but must be at most 170°";
    refuse("fx = 600", "fx = 600\nfy = 3.6", "fy", message);
}

#[test]
fn a_motion_that_no_robot_has_is_refused() {
    let message = "`motion.velocity_m_s` is [-160, 0, 0], a speed of 160.0 m/s, but must be at most 150 m/s";
    refuse("[-1.5, 0, 0]", "[-160, 0, 0]", "velocity_m_s", message);
    let message = "`motion.rate_rad_s` is [0, 57.3, 0], a rate of 57.3 rad/s, but must be at most 30 rad/s, five turns a \
                   second";
    refuse("[motion]", "[motion]\nrate_rad_s = [0, 57.3, 0]", "rate_rad_s", message);
}

#[test]
fn a_gravity_along_the_optical_axis_is_refused() {
    let message = "`attitude.gravity` is [0.0, 0.0, -9.81], 0.0° off the optical axis, but must be at least 15° (axes: x \
                   right, y down, z forward)";
    refuse("[attitude]", "[attitude]\ngravity = [0.0, 0.0, -9.81]", "gravity", message);
}

#[test]
fn a_trajectory_is_refused_for_the_same_values() {
    let run = |sample: &str, unusual: &str| {
        let trajectory = format!("time_s,vx,vy,vz,wx,wy,wz,gx,gy,gz\n-1,{sample}\n1,{sample}\n");
        let folder = Folder::of(&format!("unusual = [{unusual}]\n{SETUP}"), &edges()).with("drive.csv", trajectory);
        folder.run(&["edges", "edges.csv", "--setup", "setup.toml", "--trajectory", "drive.csv"])
    };
    for (sample, key, message) in [
        ("160,0,0,0,0,0,0,1,0", "velocity_m_s", "`vx`, `vy`, `vz` are [160.0, 0.0, 0.0], a speed of 160.0 m/s, but "),
        ("1,0,0,0,57,0,0,1,0", "rate_rad_s", "`wx`, `wy`, `wz` are [0.0, 57.0, 0.0], a rate of 57.0 rad/s, but "),
        ("1,0,0,0,0,0,0,0,1", "gravity", "`gx`, `gy`, `gz` are [0.0, 0.0, 1.0], 0.0° off the optical axis, but "),
    ] {
        let outcome = run(sample, "");
        assert_eq!(outcome.code, 1);
        assert!(outcome.stderr.starts_with(&format!("error: drive.csv: line 2: {message}")), "{}", outcome.stderr);
        let outcome = run(sample, &format!("\"{key}\""));
        assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""), "{sample}");
    }
}

#[test]
fn names_that_unusual_does_not_know_are_refused() {
    let error = |top: &str| Folder::of(&format!("{top}\n{SETUP}"), &edges()).edges().stderr;
    let message = |text: &str| format!("error: setup.toml: {text}\n");
    let near = "`unusual` names `readout`; the nearest key is `readout_s`";
    assert_eq!(error("unusual = [\"readout\"]"), message(near));
    let list = "`readout_s`, `line_time_us`, `line_length_clocks`, `exposure_s`, `fx`, `fy`, `focal_length_mm`, \
                `velocity_m_s`, `rate_rad_s` and `gravity`";
    let unlike = format!("`unusual` names `cx`; the keys with a usual range are {list}");
    assert_eq!(error("unusual = [\"cx\"]"), message(&unlike));
    for value in ["\"readout_s\"", "[1]", "true"] {
        let text = format!("is {}, but must be a list of keys such as [\"readout_s\"]", value.trim_matches(['[', ']']));
        assert_eq!(error(&format!("unusual = {value}")), message(&format!("`unusual` {text}")));
    }
    let inside = SETUP.replace("[attitude]", "[attitude]\nunusual = [\"readout_s\"]");
    let message = message("unknown key `attitude.unusual`; the nearest is `unusual` at the top of the file");
    assert_eq!(Folder::of(&inside, &edges()).edges().stderr, message);
}
