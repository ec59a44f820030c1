//! The charts of command `figures`: those of the paper, from the library's own functions, and four that it lacks.

use anyhow::{Context, Result};
use shutter_range::calibrate::{Pass, fit_scale};
use shutter_range::plan::{CameraMode, PixelNoise, Planner, Target};
use shutter_range::rse::{PAPER_KAPPA, Shear};
use shutter_range::{MotionBlur, Response, Setup, Twist, Uncertainty};

use super::table2::{self, Row};
use crate::output::chart::{Axis, Chart};
use crate::output::report;

/// The paper's usual speed, 40 km/h, its usual "shutter speed", and the distance of most of its cases.
const SPEED_M_S: f64 = 40.0 / 3.6;
const READOUT_S: f64 = 1.0 / 50.0;
const DISTANCE_M: f64 = 5.2;
/// Focal length that the paper's calibration printed, in mm, for which κ holds.
const FOCAL_MM: f64 = 54.230_267;
/// Lean of an edge, one sigma: what Table 2 shows.
const LEAN_DEG: f64 = 0.1;

/// Each chart with the name of its file.
pub(crate) fn all() -> Result<Vec<(&'static str, Chart)>> {
    let rows = table2::summary()?.rows;
    Ok(vec![
        ("9a", against_bearing("Figure 9a: camera moves along its axis", &[90.0])),
        (
            "11a",
            against_bearing("Figure 11a: camera moves at an angle to the image plane", &[15.0, 30.0, 45.0, 60.0, 75.0]),
        ),
        ("12a", against_distance()),
        ("12b", against_speed()),
        ("12c", against_readout()),
        ("12d", against_focal_length()),
        ("15a", measured_against_speed(&rows)),
        ("15b", measured_against_distance(&rows)),
        ("15c", measured_against_readout(&rows)),
        ("tilt", tilt_of_table2(&rows)?),
        ("lidar", beside_lidar(&rows)?),
        ("budget", budget()?),
    ])
}

/// Evenly spaced numbers, both ends included.
fn between(from: f64, to: f64) -> Vec<f64> {
    const PARTS: u32 = 120;
    (0..=PARTS).map(|part| from + (to - from) * f64::from(part) / f64::from(PARTS)).collect()
}

fn curve(xs: &[f64], y: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    xs.iter().map(|x| (*x, y(*x))).collect()
}

/// θ in degrees, eq. (3).
fn angle_deg(kappa: f64, depth_m: f64, speed_m_s: f64, readout_s: f64) -> f64 {
    Shear::parallel(kappa, 0.0).angle_rad(depth_m, speed_m_s, readout_s).to_degrees()
}

/// Eqs. (10) and (13).
fn against_bearing(title: &str, headings_deg: &[f64]) -> Chart {
    let alphas = between(-40.0, 40.0);
    let mut chart = Chart::new(
        &format!("{title} ({DISTANCE_M} m, 40 km/h, 1/50 s)"),
        Axis::new("alpha (deg)", -40.0, 40.0),
        Axis::new("RSE angle (deg)", -6.0, 9.0),
    );
    for heading_deg in headings_deg {
        let theta = |alpha_deg: f64| {
            let bearing = alpha_deg.to_radians().tan();
            let shear = Shear::oblique(PAPER_KAPPA, bearing, heading_deg.to_radians());
            shear.angle_rad(DISTANCE_M, SPEED_M_S, READOUT_S).to_degrees()
        };
        chart = chart.curve(&format!("omega = {heading_deg}°"), curve(&alphas, theta));
    }
    chart
}

fn against_distance() -> Chart {
    let axes = (Axis::new("vertical distance (m)", 0.0, 25.0), Axis::new("RSE angle (deg)", 0.0, 90.0));
    let mut chart = Chart::new("Figure 12a: distance (1/50 s)", axes.0, axes.1);
    for km_h in [30.0, 40.0, 50.0] {
        let theta = |depth_m: f64| angle_deg(PAPER_KAPPA, depth_m, km_h / 3.6, READOUT_S);
        chart = chart.curve(&format!("{km_h} km/h"), curve(&between(0.01, 25.0), theta));
    }
    chart
}

/// The distances of the paper's cases, each a curve.
fn of_distances(title: &str, x: Axis, most_deg: f64, theta: impl Fn(f64, f64) -> f64) -> Chart {
    let xs = between(x.from, x.to);
    let mut chart = Chart::new(title, x, Axis::new("RSE angle (deg)", 0.0, most_deg));
    for depth_m in [5.0, 7.0, 10.0, 15.0] {
        chart = chart.curve(&format!("{depth_m} m"), curve(&xs, |x| theta(depth_m, x)));
    }
    chart
}

fn against_speed() -> Chart {
    of_distances("Figure 12b: speed (1/50 s)", Axis::new("speed (m/s)", 0.0, 30.0), 18.0, |depth_m, speed_m_s| {
        angle_deg(PAPER_KAPPA, depth_m, speed_m_s, READOUT_S)
    })
}

fn against_readout() -> Chart {
    let x = Axis::new("readout of the frame, the paper's shutter speed (s)", 0.0, 0.05);
    of_distances("Figure 12c: shutter speed (40 km/h)", x, 16.0, |depth_m, readout_s| {
        angle_deg(PAPER_KAPPA, depth_m, SPEED_M_S, readout_s)
    })
}

fn against_focal_length() -> Chart {
    let x = Axis::new("focal length (mm)", 0.0, 200.0);
    of_distances("Figure 12d: focal length (40 km/h, 1/50 s)", x, 24.0, |depth_m, focal_mm| {
        angle_deg(PAPER_KAPPA * focal_mm / FOCAL_MM, depth_m, SPEED_M_S, READOUT_S)
    })
}

/// θ of a measurement as it would be at another distance and speed: tan θ goes with v and 1/h.
fn moved_to_deg(row: &Row, depth_m: f64, speed_m_s: f64) -> f64 {
    let slope = row.rse_deg.to_radians().tan() * (row.gps_m / depth_m) * (speed_m_s / row.speed_m_s);
    slope.atan().to_degrees()
}

/// A curve with two sigma of lean on either side, and the measurements of some cases.
fn measured(title: &str, axes: (Axis, Axis), theta: impl Fn(f64) -> f64, points: Vec<(f64, f64)>) -> Chart {
    let xs = between(axes.0.from, axes.0.to);
    let band = xs.iter().map(|x| (*x, theta(*x) - 2.0 * LEAN_DEG, theta(*x) + 2.0 * LEAN_DEG)).collect();
    let chart = Chart::new(title, axes.0, axes.1).band("two sigma of 0.1° of lean", band);
    chart.curve("equation (3)", curve(&xs, theta)).points("Table 2", points)
}

fn of_cases<'r>(rows: &'r [Row], cases: &'r [u32]) -> impl Iterator<Item = &'r Row> {
    rows.iter().filter(|row| cases.contains(&row.case))
}

fn measured_against_speed(rows: &[Row]) -> Chart {
    let points = of_cases(rows, &[1, 2, 3]).map(|row| (row.speed_m_s, moved_to_deg(row, DISTANCE_M, row.speed_m_s)));
    measured(
        "Figure 15a: speed (cases 1 to 3, moved to 5.2 m)",
        (Axis::new("speed (m/s)", 7.0, 15.0), Axis::new("RSE angle (deg)", 3.0, 8.5)),
        |speed_m_s| angle_deg(PAPER_KAPPA, DISTANCE_M, speed_m_s, READOUT_S),
        points.collect(),
    )
}

fn measured_against_distance(rows: &[Row]) -> Chart {
    let points = of_cases(rows, &[2, 4, 5, 6]).map(|row| (row.gps_m, moved_to_deg(row, row.gps_m, SPEED_M_S)));
    measured(
        "Figure 15b: distance (cases 2, 4, 5 and 6, moved to 40 km/h)",
        (Axis::new("GPS distance (m)", 4.0, 18.0), Axis::new("RSE angle (deg)", 1.0, 7.5)),
        |depth_m| angle_deg(PAPER_KAPPA, depth_m, SPEED_M_S, READOUT_S),
        points.collect(),
    )
}

fn measured_against_readout(rows: &[Row]) -> Chart {
    let points = of_cases(rows, &[2, 7, 8]).map(|row| (row.readout_s, moved_to_deg(row, DISTANCE_M, SPEED_M_S)));
    measured(
        "Figure 15c: shutter speed (cases 2, 7 and 8, moved to 5.2 m and 40 km/h)",
        (Axis::new("readout of the frame (s)", 0.01, 0.045), Axis::new("RSE angle (deg)", 2.0, 13.0)),
        |readout_s| angle_deg(PAPER_KAPPA, DISTANCE_M, SPEED_M_S, readout_s),
        points.collect(),
    )
}

/// What the printed angles are above those of the fitted scale, whatever the distance: it looks like lean.
fn tilt_of_table2(rows: &[Row]) -> Result<Chart> {
    let pass = |row: &Row| {
        let pass = Pass::new(row.rse_deg.to_radians().tan(), row.speed_m_s, row.gps_m);
        pass.and_then(|pass| pass.with_frame_readout_s(row.readout_s))
    };
    let passes = rows.iter().map(pass).collect::<Result<Vec<_>, _>>()?;
    let fitted = fit_scale::<f64, 64>(&passes, None)?;
    let off_deg = |row: &Row| row.rse_deg - angle_deg(fitted.scale, row.gps_m, row.speed_m_s, row.readout_s);
    let (tilt_deg, sigma_deg) = (fitted.tilt.to_degrees(), fitted.sigma_tilt.to_degrees());
    let title = "The tilt that explains Table 2: printed angle less that of the GPS distance";
    let ends = [4.0, 18.0];
    let band = |half: f64| ends.map(|x| (x, tilt_deg - half, tilt_deg + half)).to_vec();
    Ok(Chart::new(title, Axis::new("GPS distance (m)", 4.0, 18.0), Axis::new("off (deg)", -0.4, 0.4))
        .band("two sigma of 0.1° of lean", band(2.0 * LEAN_DEG))
        .curve(&format!("constant tilt {tilt_deg:.3} ± {sigma_deg:.3}°"), ends.map(|x| (x, tilt_deg)).to_vec())
        .points("Table 2", rows.iter().map(|row| (row.gps_m, off_deg(row))).collect()))
}

/// The paper's camera with all that is uncertain, and its rod of 2 m.
fn paper_mode(uncertainty: Uncertainty<f64>) -> Result<CameraMode<f64>> {
    let setup = Setup::pinhole(1920, 1080, PAPER_KAPPA * 1080.0, 20_000_000)?.with_uncertainty(uncertainty)?;
    let setup = setup.with_response(Response::Linear);
    Ok(CameraMode::new(setup, PixelNoise { read_noise: 2.0, shot_gain: 0.02 })?)
}

fn rod() -> Target<f64> {
    Target { width_m: 0.05, top_m: -1.0, bottom_m: 1.0, ..Target::default() }
}

/// Sigma of the distance in metres.
fn planned(mode: &CameraMode<f64>, depths_m: &[f64]) -> Result<Vec<(f64, f64)>> {
    let motion = Twist::level([SPEED_M_S, 0.0, 0.0])?;
    let planner = Planner::new(mode, &motion, rod())?;
    let sigma_m = |depth_m: f64| planner.predict(depth_m).map(|planned| (depth_m, planned.relative_sigma() * depth_m));
    depths_m.iter().map(|depth_m| sigma_m(*depth_m).context("planning")).collect()
}

/// 3 cm at 6 m, 0.005 m for each metre: what the paper says of a low-cost laser sensor.
fn beside_lidar(rows: &[Row]) -> Result<Chart> {
    let depths_m = between(2.0, 18.0);
    let straight = Uncertainty::NONE.with_edge_roughness_px(0.03);
    let lean = straight.with_sigma_tilt(LEAN_DEG.to_radians());
    let errors = rows.iter().map(|row| (row.gps_m, (row.computed_m - row.gps_m).abs())).collect();
    let axes = (Axis::new("distance (m)", 2.0, 18.0), Axis::new("error, one sigma (m)", 0.0, 1.0));
    Ok(Chart::new("Beside low-cost lidar: the paper's camera at 40 km/h", axes.0, axes.1)
        .curve("lidar: 0.005 m per metre", curve(&depths_m, |depth_m| 0.005 * depth_m))
        .curve("edges that lean by 0.1°", planned(&paper_mode(lean)?, &depths_m)?)
        .curve("edges known to be upright", planned(&paper_mode(straight)?, &depths_m)?)
        .points("Table 2: |computed - GPS|", errors))
}

/// With what a careful amateur knows.
fn budget() -> Result<Chart> {
    let setup = Setup::pinhole(640, 480, 600.0, 33_300_000)?.with_response(Response::Linear);
    let setup = setup.with_motion_blur(MotionBlur::from_calibrated_lens(0.002, 0.7))?;
    let mode = CameraMode::new(setup, PixelNoise::default())?;
    let motion = Twist::level([1.5, 0.0, 0.0])?;
    let planner = Planner::new(&mode, &motion, Target::default())?;
    let mut whole = Vec::new();
    let mut parts: Vec<(&str, Vec<(f64, f64)>)> = Vec::new();
    for depth_m in between(0.5, 6.0) {
        let planned = planner.predict(depth_m)?;
        let estimate = &planned.range.estimate;
        whole.push((depth_m, 100.0 * planned.relative_sigma()));
        for (index, (source, per_m)) in estimate.budget.parts().into_iter().enumerate() {
            if parts.len() <= index {
                parts.push((report::source(source), Vec::new()));
            }
            if let Some((_, points)) = parts.get_mut(index) {
                points.push((depth_m, 100.0 * per_m / estimate.inverse_depth_per_m));
            }
        }
    }
    let title = "Error budget: VGA, 1.5 m/s, 2 ms of exposure, default uncertainties";
    let axes = (Axis::new("depth (m)", 0.5, 6.0), Axis::new("one sigma, relative (%)", 0.0, 20.0));
    let mut chart = Chart::new(title, axes.0, axes.1).curve("all", whole);
    for (source, points) in parts.into_iter().filter(|(_, points)| points.iter().any(|(_, percent)| *percent > 0.1)) {
        chart = chart.curve(source, points);
    }
    Ok(chart)
}
