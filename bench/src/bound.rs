//! The Cramér–Rao bound: no unbiased estimator can do better on the same pixels.

use shutter_range::sim::Exposure;

use crate::Shot;
use crate::truth::UprightEdge;

/// Least standard deviation of an edge's inverse depth in 1/m, from the rows that show it, with the bearing unknown and
/// levels, blur and motion known. Infinite where the rows cannot tell.
///
/// Each row tells the column with a variance of 1/Σ (slope of the blurred step)²/noise²; all rows together tell two
/// unknowns.
pub(crate) fn sigma_inverse_depth(shot: &Shot, edge: &UprightEdge, rows: &[u16]) -> f64 {
    // Fisher information: bearing twice, bearing and inverse depth, inverse depth twice.
    let [mut aa, mut ar, mut rr] = [0.0; 3];
    for row in rows {
        let row = f64::from(*row);
        let information = information_of_row(shot, edge, row);
        let [to_bearing, to_inverse_depth] = derivatives(shot, edge, row);
        aa += information * to_bearing * to_bearing;
        ar += information * to_bearing * to_inverse_depth;
        rr += information * to_inverse_depth * to_inverse_depth;
    }
    let determinant = aa * rr - ar * ar;
    if determinant > 0.0 { (aa / determinant).sqrt() } else { f64::INFINITY }
}

/// Change of the column with bearing and inverse depth, in pixels: u = (a − ρ x)/(1 − ρ z).
fn derivatives(shot: &Shot, edge: &UprightEdge, row: f64) -> [f64; 2] {
    let (bearing, inverse_depth) = (edge.bearing(), 1.0 / edge.depth_m);
    let [x_m, _, z_m] = shot.position_m(row, 0.0);
    let nearness = 1.0 - inverse_depth * z_m;
    let u = (bearing - inverse_depth * x_m) / nearness;
    let scale = f64::from(shot.rig.focal_px) / nearness;
    [scale, scale * (u * z_m - x_m)]
}

/// Fisher information of one row about the column, in 1/px²: one over the least variance.
fn information_of_row(shot: &Shot, edge: &UprightEdge, row: f64) -> f64 {
    let half_s = 0.5 * f64::from(shot.rig.exposure.time_s);
    let column = edge.column(shot, row, 0.0);
    let motion_px = (edge.column(shot, row, half_s) - edge.column(shot, row, -half_s)).abs();
    let blur = Blur { sigma_px: f64::from(shot.rig.exposure.psf_sigma_px), motion_px };
    let [left, right] = edge.levels;
    let reach = 0.5 * motion_px + 5.0 * blur.sigma_px + 1.0;
    let (from, to) = ((column - reach).floor().max(0.0), (column + reach).ceil());
    let last = f64::from(shot.rig.columns - 1);
    let mut information = 0.0;
    let mut pixel = from;
    while pixel <= to.min(last) {
        let x = pixel - column;
        // The pixel's box makes the slope of its value a difference.
        let slope = (right - left) * (blur.step(x + 0.5) - blur.step(x - 0.5));
        let level = left + (right - left) * blur.step(x);
        information += slope * slope / noise_variance(&shot.rig.exposure, level);
        pixel += 1.0;
    }
    information
}

/// Variance of one pixel in square grey levels: read noise, shot noise, rounding.
fn noise_variance(exposure: &Exposure, level: f64) -> f64 {
    let read = f64::from(exposure.read_noise);
    read * read + f64::from(exposure.shot_gain) * level + 1.0 / 12.0
}

struct Blur {
    sigma_px: f64,
    motion_px: f64,
}

impl Blur {
    /// The step from 0 to 1 at x = 0, after the lens and the motion's box.
    fn step(&self, x: f64) -> f64 {
        let Self { sigma_px, motion_px } = *self;
        // Over so short a motion the mean of the step is the step itself.
        if motion_px < 1e-3 * sigma_px {
            return normal_below(x / sigma_px);
        }
        let area = |x: f64| {
            let z = x / sigma_px;
            x * normal_below(z) + sigma_px * normal_density(z)
        };
        (area(x + 0.5 * motion_px) - area(x - 0.5 * motion_px)) / motion_px
    }
}

fn normal_below(z: f64) -> f64 {
    0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
}

fn normal_density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt()
}

#[cfg(test)]
mod tests {
    use shutter_range::sim::{Background, Bar, Scene};

    use super::*;
    use crate::Rig;

    /// For a wide Gaussian: 2 √π σ σn²/A² for each row, and σx √(12/N³) for the slope.
    #[test]
    fn the_bound_of_a_long_edge_is_that_of_the_closed_form() {
        let mut rig = Rig::VGA;
        (rig.exposure.time_s, rig.exposure.psf_sigma_px, rig.exposure.shot_gain) = (0.0, 2.0, 0.0);
        let mut scene = Scene::new(Background::plain(50.0)).unwrap();
        scene.push(Bar::upright(0.0, 2.0, 0.12, 150.0)).unwrap();
        let shot = Shot { rig, scene, velocity_m_s: [2.0, 0.0, 0.0], seed: 0 };
        let edge = UprightEdge::all(&shot)[0];
        let rows = edge.visible_rows(&shot);
        assert_eq!(rows.len(), 480);
        let bound = sigma_inverse_depth(&shot, &edge, &rows);
        let blur: f64 = (4.0_f64 + 1.0 / 12.0).sqrt();
        let sigma_px = (2.0 * std::f64::consts::PI.sqrt() * blur * (6.25 + 1.0 / 12.0)).sqrt() / 100.0;
        let px_per_row = 600.0 * 2.0 / 30.0 / 480.0;
        let expected = sigma_px * (12.0 / 480.0_f64.powi(3)).sqrt() / px_per_row;
        // The closed form takes the box of a pixel for a variance of 1/12, and sums for integrals.
        assert!((bound / expected - 1.0).abs() < 0.01, "{bound} for {expected}");
    }
}
