//! The section [mount] of a setup file: how the camera sits on a robot, whose motion and gravity are then those told.

use anyhow::Result;

use super::bounds::Bounds;
use super::keys::Section;

/// The axes in which motion and gravity are told.
pub(crate) const fn axes_told(mount: Option<&Mount>) -> &'static str {
    match mount {
        Some(_) => "x forward, y left, z up",
        None => "x right, y down, z forward",
    }
}

/// Vectors in the robot's axes (x forward, y left, z up, as ROS has it) as the camera sees them (x right, y down, z
/// forward).
#[derive(Clone, Copy)]
pub(crate) struct Mount {
    /// Rows: the camera's axes in those of the robot.
    axes: [[f64; 3]; 3],
    position_m: [f64; 3],
}

impl Mount {
    /// `None` where the file has no such section: all is told in the camera's axes.
    pub(crate) fn of(section: &Section<'_>) -> Result<Option<Self>> {
        const TURN: Bounds = Bounds::number(-180.0, 180.0, "degrees");
        const POSITION: Bounds = Bounds::number(-1000.0, 1000.0, "m");
        if !section.is_there() {
            return Ok(None);
        }
        let angle = |key| -> Result<f64> { Ok(section.number(key, TURN)?.unwrap_or(0.0).to_radians()) };
        let position_m = section.numbers("position_m", POSITION, "x forward, y left, z up (m)")?.unwrap_or([0.0; 3]);
        Ok(Some(Self { axes: axes(angle("yaw_deg")?, angle("pitch_deg")?, angle("roll_deg")?), position_m }))
    }

    pub(crate) fn in_camera(&self, vector: [f64; 3]) -> [f64; 3] {
        self.axes.map(|axis| dot(axis, vector))
    }

    /// The camera's velocity, where the robot has this one and turns: a camera off the robot's centre is swept around
    /// it.
    pub(crate) fn velocity_in_camera(&self, velocity_m_s: [f64; 3], rate_rad_s: [f64; 3]) -> [f64; 3] {
        let swept = self.swept(rate_rad_s);
        self.in_camera(std::array::from_fn(|axis| velocity_m_s[axis] + swept[axis]))
    }

    /// Velocity and rate of the robot, where the camera has these.
    pub(crate) fn motion_of_robot(&self, velocity_m_s: [f64; 3], rate_rad_s: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let rate = self.in_robot(rate_rad_s);
        let (velocity, swept) = (self.in_robot(velocity_m_s), self.swept(rate));
        (std::array::from_fn(|axis| velocity[axis] - swept[axis]), rate)
    }

    fn in_robot(&self, vector: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| self.axes.iter().zip(vector).map(|(camera, part)| camera[axis] * part).sum())
    }

    /// Velocity of the camera around the robot's centre.
    fn swept(&self, [wx, wy, wz]: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.position_m;
        [wy * z - wz * y, wz * x - wx * z, wx * y - wy * x]
    }
}

/// Yaw about up (left positive), then pitch about the camera's own left (up positive), then roll about its optical axis
/// (right side down positive).
fn axes(yaw: f64, pitch: f64, roll: f64) -> [[f64; 3]; 3] {
    let ((sy, cy), (sp, cp), (sr, cr)) = (yaw.sin_cos(), pitch.sin_cos(), roll.sin_cos());
    let forward = [cy * cp, sy * cp, sp];
    let left = [-sy, cy, 0.0];
    let up = [-cy * sp, -sy * sp, cp];
    let rolled = |a: f64, b: f64| std::array::from_fn(|axis| a * left[axis] + b * up[axis]);
    // Right and down are against left and up, each turned by the roll.
    [rolled(-cr, -sr), rolled(sr, -cr), forward]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
