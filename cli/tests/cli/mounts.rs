//! [mount]: motion and attitude in the axes of a robot.

use serde_json::Value;

use crate::tool::{Folder, SETUP, assert_near, number};

fn edges() -> String {
    let row = |row: u32| format!("{row},{:.4}\n", 280.0 - 0.02 * f64::from(row));
    format!("row,column\n{}", (0..480).step_by(8).map(row).collect::<String>())
}

/// The only range with these sections in place of [`SETUP`]'s.
fn range(sections: &str) -> Value {
    let camera = SETUP.split("[motion]").next().expect("a camera");
    Folder::of(&format!("{camera}{sections}"), &edges()).ranges().remove(0)
}

#[track_caller]
fn assert_same(sections: &str, expected: &str) {
    let (found, expected) = (range(sections), range(expected));
    for key in ["inverse_depth_per_m", "sigma_inverse_depth_per_m", "bearing", "tilt_deg"] {
        assert_near(number(&found, key), number(&expected, key), 1e-9);
    }
    assert_eq!(found["status"], expected["status"]);
}

const FORWARD: &str = "[motion]\nvelocity_m_s = [1.5, 0, 0]\n";

#[test]
fn a_camera_that_looks_to_the_side() {
    // To the right, the robot's forward is the camera's left; to the left, its right.
    assert_same(&format!("{FORWARD}[mount]\nyaw_deg = -90\n"), "[motion]\nvelocity_m_s = [-1.5, 0, 0]\n");
    assert_same(&format!("{FORWARD}[mount]\nyaw_deg = 90\n"), "[motion]\nvelocity_m_s = [1.5, 0, 0]\n");
    assert_same(&format!("{FORWARD}[mount]\n"), "[motion]\nvelocity_m_s = [0, 0, 1.5]\n");
    let half = 1.5 * 0.5_f64.sqrt();
    let diagonal = format!("[motion]\nvelocity_m_s = [{}, 0, {half}]\n", -half);
    assert_same(&format!("{FORWARD}[mount]\nyaw_deg = -45\n"), &diagonal);
    // The robot strafes to its left, and slides down.
    let sideways = "[motion]\nvelocity_m_s = [0, 1, -0.5]\n[mount]\n";
    assert_same(sideways, "[motion]\nvelocity_m_s = [-1, 0.5, 0]\n");
}

#[test]
fn pitch_and_roll_turn_gravity() {
    let (sine, cosine) = 10_f64.to_radians().sin_cos();
    // Pitched up and looking right: down has a part against the optical axis.
    let up = format!("[motion]\nvelocity_m_s = [-1.5, 0, 0]\n[attitude]\ngravity = [0, {cosine}, {}]\n", -sine);
    assert_same(&format!("{FORWARD}[mount]\nyaw_deg = -90\npitch_deg = 10\n"), &up);
    // The camera's right side down: down has a part to the right, and left, where the robot drives, goes up.
    let rolled = format!(
        "[motion]\nvelocity_m_s = [{}, {}, 0]\n[attitude]\ngravity = [{sine}, {cosine}, 0]\n",
        -1.5 * cosine,
        1.5 * sine
    );
    assert_same(&format!("{FORWARD}[mount]\nyaw_deg = -90\nroll_deg = 10\n"), &rolled);
    // A robot on a slope, told by gravity in its own axes.
    let slope = format!("{FORWARD}[attitude]\ngravity = [{sine}, 0, {}]\n[mount]\nyaw_deg = -90\n", -cosine);
    assert_same(
        &slope,
        &format!("[motion]\nvelocity_m_s = [-1.5, 0, 0]\n[attitude]\ngravity = [{}, {cosine}, 0]\n", -sine),
    );
}

#[test]
fn a_camera_off_the_centre_is_swept_around_it() {
    // Turning left at 1 rad/s, half a metre ahead of the centre: the camera is swept to the left at 0.5 m/s.
    let turning = "[motion]\nvelocity_m_s = [1.5, 0, 0]\nrate_rad_s = [0, 0, 1]\n[mount]\nposition_m = [0.5, 0, 0.2]\n";
    assert_same(turning, "[motion]\nvelocity_m_s = [-0.5, 0, 1.5]\nrate_rad_s = [0, -1, 0]\n");
}

#[test]
fn a_trajectory_is_that_of_the_robot() {
    let camera = SETUP.split("[motion]").next().expect("a camera");
    let drive = |columns: &str, values: &str| {
        let line = |k: i32| format!("{:.3},{values}\n", f64::from(k) * 0.01 - 0.05);
        format!("time_s,{columns}\n{}", (0..20).map(line).collect::<String>())
    };
    let ranges = |sections: &str, drive: String| {
        let folder = Folder::of(&format!("{camera}{sections}"), &edges()).with("drive.csv", drive);
        folder.run(&["edges", "edges.csv", "--setup", "setup.toml", "--trajectory", "drive.csv", "--json"]).json()
    };
    let robot = ranges("[mount]\nyaw_deg = -90\nposition_m = [0.5, 0, 0]\n", drive("vx,wz,gz", "1.5,0.2,-9.81"));
    let expected = ranges("", drive("vx,vy,vz,wx,wy,wz", "-1.5,0,-0.1,0,-0.2,0"));
    let [found, expected] = [robot, expected].map(|document| document["frames"][0]["ranges"][0].clone());
    for key in ["inverse_depth_per_m", "sigma_inverse_depth_per_m", "tilt_deg"] {
        assert_near(number(&found, key), number(&expected, key), 1e-9);
    }
}

#[test]
fn mounts_that_are_refused() {
    let camera = SETUP.split("[motion]").next().expect("a camera");
    let refused = |mount: &str| Folder::of(&format!("{camera}{FORWARD}[mount]\n{mount}\n"), &edges()).edges().stderr;
    assert_eq!(
        refused("yaw_deg = 270"),
        "error: setup.toml: `mount.yaw_deg` is 270, but must be a number from -180 to 180 (degrees)\n"
    );
    assert!(refused("position_m = [0, 0]").contains("3 numbers: x forward, y left, z up (m)"));
    assert!(refused("yaw = 3").contains("unknown key `mount.yaw`; the nearest is `mount.yaw_deg`"));
    // Level upright edges are hardly seen from a camera that looks up.
    assert!(refused("pitch_deg = 90").contains("off the optical axis"), "{}", refused("pitch_deg = 90"));
    // The axes that are named are those in which it was told: this is down for a camera, and left for a robot.
    let left = refused("yaw_deg = -90\n[attitude]\ngravity = [0.0, 1.0, 0.0]");
    let axes = "`attitude.gravity` is [0.0, 1.0, 0.0], 0.0° off the optical axis, but must be at least 15° (axes: x \
                forward, y left, z up)";
    assert!(left.contains(axes), "{left}");
}
