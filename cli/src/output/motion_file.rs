//! `trajectory.csv`: the motion of a simulated camera, as wheels and a gyroscope would tell it.

use std::fmt::Write;

use anyhow::Result;
use shutter_range::sim::Simulator;

use crate::input::mount::Mount;

/// As a gyroscope delivers them.
const SAMPLES_PER_S: f64 = 200.0;
/// Before the first frame and after the last one: a clock may be off.
const MARGIN_S: f64 = 0.1;

/// From the start of the first frame until some time after it, in the axes that the setup tells motion in. The clock of
/// the samples is behind that of the frames by an offset.
pub(crate) fn text<const OBJECTS: usize>(
    simulator: &Simulator<'_, OBJECTS>,
    mount: Option<&Mount>,
    until_s: f64,
    clock_offset_s: f64,
) -> Result<String> {
    let mut text = "time_s,vx,vy,vz,wx,wy,wz\n".to_string();
    let first = (-MARGIN_S * SAMPLES_PER_S) as i64;
    let last = ((until_s + MARGIN_S) * SAMPLES_PER_S).ceil() as i64;
    for sample in first..=last {
        let time_s = sample as f64 / SAMPLES_PER_S;
        let motion = simulator.clone().at_frame(0, (time_s * 1e9).round() as i64).motion()?;
        let [velocity, rate] = [motion.velocity_m_s(), motion.rate_rad_s()].map(|vector| vector.map(f64::from));
        let (velocity, rate) = mount.map_or((velocity, rate), |mount| mount.motion_of_robot(velocity, rate));
        let [[vx, vy, vz], [wx, wy, wz]] = [velocity, rate];
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:.6},{vx:.6},{vy:.6},{vz:.6},{wx:.6},{wy:.6},{wz:.6}", time_s - clock_offset_s);
    }
    Ok(text)
}
