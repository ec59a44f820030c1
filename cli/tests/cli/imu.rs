//! `calibrate imu`, on rendered frames of a camera that swings before posts far away.

use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator};
use shutter_range::{Camera, Distortion, Intrinsics, Readout, ReadoutDirection, Twist};

use crate::tool::{Folder, assert_near, number};

const SETUP: &str = "\
[camera]
columns = 160
rows = 240
fx = 150
readout_s = 0.03
edge_roughness_px = 0
[motion]
sigma_rate_rad_s = 0.001
";
const FRAMES: u32 = 24;
const INTERVAL_S: f64 = 1.0 / 15.0;
const OFFSET_S: f64 = 0.012;
const ROLL: f64 = 0.02;

/// Yaw to the right in radians, and its rate. With one frequency alone the acceleration goes with the bearings, as pitch does.
fn yaw(time_s: f64) -> f64 {
    let turned = std::f64::consts::TAU * time_s;
    0.12 * turned.sin() + 0.03 * (2.3 * turned).sin()
}

fn rate(time_s: f64) -> f64 {
    (yaw(time_s + 1e-4) - yaw(time_s - 1e-4)) / 2e-4
}

/// Each frame with the rate of its middle: what changes within 30 ms is no slope.
fn frame(number: u32) -> Vec<u8> {
    let start_s = f64::from(number) * INTERVAL_S;
    let gravity = [ROLL as f32, 1.0, 0.0];
    let mut scene = Scene::<4>::new(Background::plain(200.0)).expect("a background");
    for azimuth in [-0.25, 0.0, 0.25] {
        let bearing = f64::tan(azimuth - yaw(start_s));
        scene.push(Bar::upright(bearing as f32, 1000.0, 40.0, 50.0)).expect("a post");
    }
    let camera = Camera::new(Intrinsics::centred(160, 240, 150.0), Distortion::NONE).expect("a camera");
    let readout = Readout::from_frame_readout_ns(240, 30_000_000, ReadoutDirection::TopToBottom).expect("a readout");
    let turning = rate(start_s + 0.015) as f32;
    let motion = Twist::new([0.0; 3], [turning * ROLL as f32, turning, 0.0], gravity).expect("a motion");
    let exposure = Exposure { time_s: 0.0005, ..Exposure::default() };
    let simulator = Simulator::new(&scene, &camera, &readout, &motion, exposure, number.into()).expect("a simulator");
    let mut file = b"P5 160 240 255\n".to_vec();
    let mut pixels = [0; 160];
    for row in 0..240 {
        simulator.row(row, &mut pixels);
        file.extend(pixels);
    }
    file
}

fn swing() -> Folder {
    let mut gyroscope = "time_s,vx,vy,vz,wx,wy,wz\n".to_string();
    for index in -20..360 {
        let stamp_s = f64::from(index) / 200.0;
        let rate = rate(stamp_s + OFFSET_S);
        gyroscope += &format!("{stamp_s},0,0,0,{},{rate},0\n", rate * ROLL);
    }
    let folder = Folder::new().with("setup.toml", SETUP).with("gyro.csv", gyroscope);
    (0..FRAMES).fold(folder, |folder, number| folder.with(&format!("{number:02}.pgm"), frame(number)))
}

fn calibrate<'a>(names: &'a [String], more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["calibrate", "imu", "--setup", "setup.toml", "--frame-interval-s", "0.06666666667"];
    arguments.extend(names.iter().map(String::as_str));
    arguments.extend(more);
    arguments
}

#[test]
fn turning_gives_the_offset_of_the_clock_and_the_roll() {
    let folder = swing();
    let names: Vec<_> = (0..FRAMES).map(|number| format!("{number:02}.pgm")).collect();
    let more = ["--trajectory", "gyro.csv", "--json", "--svg", "leans.svg"];
    let document = folder.run(&calibrate(&names, &more)).json();
    let sigma_s = number(&document, "sigma_time_offset_s");
    assert!(sigma_s < 0.001, "{document}");
    assert_near(number(&document, "time_offset_s"), OFFSET_S, 3.0 * sigma_s);
    let sigma_deg = number(&document, "sigma_roll_deg");
    assert!(sigma_deg < 0.2, "{document}");
    assert_near(number(&document, "roll_deg"), ROLL.atan().to_degrees(), 0.15);
    assert_near(number(&document, "pitch_deg"), 0.0, 0.3);
    assert!(String::from_utf8(folder.read("leans.svg")).expect("UTF-8").contains("as given"));
    let text = folder.run(&calibrate(&names, &["--trajectory", "gyro.csv"])).stdout;
    assert!(text.contains("[attitude]\ngravity = [0.0"), "{text}");
}

#[test]
fn what_is_missing_is_asked_for() {
    let folder = swing();
    let names = ["00.pgm".to_string()];
    assert_eq!(folder.run(&calibrate(&names, &[])).code, 2, "no trajectory");
    let one = folder.run(&calibrate(&names, &["--trajectory", "gyro.csv", "--json"]));
    assert_eq!((one.code, one.stderr.as_str()), (1, ""));
    assert_eq!(one.document()["status"], "too_few_lines");
    let folder = folder.with("gyro.csv", "time_s,vx,vy,vz,wx,wy,wz\n5,0,0,0,0,0,0\n5.005,0,0,0,0,0,0\n");
    let late = folder.run(&calibrate(&names, &["--trajectory", "gyro.csv"]));
    assert_eq!(late.code, 1);
    assert!(late.stderr.contains("the trajectory has no"), "{}", late.stderr);
}
