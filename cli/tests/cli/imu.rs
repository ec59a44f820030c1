//! `calibrate imu`, on what `simulate` writes of a camera that turns back and forth before posts.

use crate::tool::{Folder, assert_near, number};

const SETUP: &str = "\
[camera]
columns = 160
rows = 240
fx = 150
readout_s = 0.03
exposure_s = 0.0005
[motion]
velocity_m_s = [0, 0, 0]
sigma_rate_rad_s = 0.001
";
const POSTS: &str = "\
[background]
level = 200
[[bar]]
bearing = -0.25
depth_m = 3
width_m = 0.12
level = 50
[[bar]]
bearing = 0.02
depth_m = 4
width_m = 0.16
level = 60
[[bar]]
bearing = 0.26
depth_m = 3
width_m = 0.12
level = 40
";
const FRAMES: usize = 24;
const INTERVAL_S: &str = "0.06666666667";
const OFFSET_S: f64 = 0.012;
const ROLL: f64 = 0.02;

/// With the setup that does not know how the camera is held.
fn swing() -> Folder {
    let held = format!("{SETUP}[attitude]\ngravity = [{ROLL}, 1, 0]\n");
    let folder = Folder::new().with("held.toml", held).with("setup.toml", SETUP).with("posts.toml", POSTS);
    let (frames, offset) = (FRAMES.to_string(), OFFSET_S.to_string());
    let arguments = ["simulate", "--setup", "held.toml", "--scene", "posts.toml", "--out", "out", "--frames", &frames];
    let swing = ["--frame-interval-s", INTERVAL_S, "--swing-deg", "7", "--clock-offset-s", &offset];
    let outcome = folder.run(&[&arguments[..], &swing].concat());
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    folder
}

fn names(count: usize) -> Vec<String> {
    (0..count).map(|number| format!("out/frame-{number:04}.png")).collect()
}

fn calibrate<'a>(names: &'a [String], more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["calibrate", "imu", "--setup", "setup.toml", "--frame-interval-s", INTERVAL_S];
    arguments.extend(names.iter().map(String::as_str));
    arguments.extend(more);
    arguments
}

#[test]
fn turning_gives_the_offset_of_the_clock_and_the_roll() {
    let folder = swing();
    let names = names(FRAMES);
    let more = ["--trajectory", "out/trajectory.csv", "--json", "--svg", "leans.svg"];
    let document = folder.run(&calibrate(&names, &more)).json();
    let sigma_s = number(&document, "sigma_time_offset_s");
    assert!(sigma_s < 0.001, "{document}");
    assert_near(number(&document, "time_offset_s"), OFFSET_S, 3.0 * sigma_s);
    for (angle, sigma, true_deg) in
        [("roll_deg", "sigma_roll_deg", ROLL.atan().to_degrees()), ("pitch_deg", "sigma_pitch_deg", 0.0)]
    {
        let sigma_deg = number(&document, sigma);
        assert!(sigma_deg < 0.3, "{document}");
        assert_near(number(&document, angle), true_deg, 3.0 * sigma_deg);
    }
    assert!(String::from_utf8(folder.read("leans.svg")).expect("UTF-8").contains("as given"));
    let text = folder.run(&calibrate(&names, &["--trajectory", "out/trajectory.csv"])).stdout;
    assert!(text.contains("[attitude]\ngravity = [0.0"), "{text}");
}

/// With the offset taken off its stamps, the trajectory is that of the frames.
#[test]
fn what_was_found_makes_the_frames_agree() {
    let folder = swing();
    let trajectory = String::from_utf8(folder.read("out/trajectory.csv")).expect("UTF-8");
    let shifted = trajectory.lines().map(|line| match line.split_once(',') {
        Some((time_s, rest)) if time_s != "time_s" => {
            format!("{},{rest}\n", time_s.parse::<f64>().expect("seconds") + OFFSET_S)
        }
        _ => format!("{line}\n"),
    });
    let held = String::from_utf8(folder.read("held.toml")).expect("UTF-8");
    let folder = folder.with("shifted.csv", shifted.collect::<String>()).with("setup.toml", held);
    let names = names(FRAMES);
    let document = folder.run(&calibrate(&names, &["--trajectory", "shifted.csv", "--json"])).json();
    assert_near(number(&document, "time_offset_s"), 0.0, 3.0 * number(&document, "sigma_time_offset_s"));
    assert!(number(&document, "misfit") < 1.5, "{document}");
}

#[test]
fn what_is_missing_is_asked_for() {
    let folder = swing();
    let names = names(1);
    assert_eq!(folder.run(&calibrate(&names, &[])).code, 2, "no trajectory");
    let one = folder.run(&calibrate(&names, &["--trajectory", "out/trajectory.csv", "--json"]));
    assert_eq!((one.code, one.stderr.as_str()), (1, ""));
    assert_eq!(one.document()["status"], "too_few_lines");
    let folder = folder.with("gyro.csv", "time_s,vx,vy,vz,wx,wy,wz\n5,0,0,0,0,0,0\n5.005,0,0,0,0,0,0\n");
    let late = folder.run(&calibrate(&names, &["--trajectory", "gyro.csv"]));
    assert_eq!(late.code, 1);
    assert!(late.stderr.contains("the trajectory has no"), "{}", late.stderr);
}
