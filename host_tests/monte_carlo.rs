//! The normalised error of inverse depth: with honest sigmas its standard deviation is one and its mean zero.

use rand::{Rng, SeedableRng, rngs::StdRng};
use rand_distr::StandardNormal;
use shutter_range::{EdgePoint, Estimate, Uncertainty};

use crate::projection::Scene;
use crate::scenes::{TENTH_DEGREE, q16, range_of, tilt_of};

const RUNS: usize = 4000;
/// Four sigma of a deviation from [`RUNS`], which is 1/√8000; what the README promises.
const DEVIATION_OFF_ONE: f64 = 0.05;
/// In forward motion at 0.3 px the noisy regressor leaves a bias of up to 0.12 sigma; and two sigma of a mean, 1/√4000.
const BIAS: f64 = 0.15;
/// The 95.45 % of a normal distribution, with three to four sigma of a share of [`RUNS`], 0.33 %, on either side.
const INSIDE_TWO_SIGMA: std::ops::Range<f64> = 0.94..0.965;

struct Spread {
    mean: f64,
    deviation: f64,
    inside_two_sigma: f64,
}

fn spread(errors: &[f64]) -> Spread {
    let count = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / count;
    let variance = errors.iter().map(|error| (error - mean).powi(2)).sum::<f64>() / count;
    let inside = errors.iter().filter(|error| error.abs() <= 2.0).count() as f64 / count;
    Spread { mean, deviation: variance.sqrt(), inside_two_sigma: inside }
}

fn noisy(points: &[EdgePoint], sigma_px: f64, random: &mut StdRng) -> Vec<EdgePoint> {
    let noise = |point: &EdgePoint| {
        let error: f64 = random.sample(StandardNormal);
        EdgePoint { column_q16: point.column_q16 + q16(error * sigma_px), sigma_q16: q16(sigma_px) as u32, ..*point }
    };
    points.iter().map(noise).collect()
}

fn normalised_error(scene: &Scene, estimate: &Estimate<f64>) -> f64 {
    (estimate.inverse_depth_per_m - 1.0 / scene.depth_m) / estimate.sigma_inverse_depth_per_m
}

fn scenes() -> [(&'static str, Scene); 5] {
    let scene = Scene::vga();
    [
        ("parallel", scene.clone()),
        ("forward", Scene { velocity_m_s: [0.0, 0.0, 2.0], bearing: 0.3, ..scene.clone() }),
        ("oblique", Scene { velocity_m_s: [-1.0, 0.0, 1.5], bearing: -0.2, ..scene.clone() }),
        ("far", Scene { depth_m: 30.0, ..scene.clone() }),
        (
            "everything",
            Scene {
                velocity_m_s: [-1.2, 0.1, 0.8],
                rate_rad_s: [0.3, -0.4, 0.2],
                gravity: [0.1, (1.0_f64 - 0.01 - 0.04).sqrt(), -0.2],
                ..scene
            },
        ),
    ]
}

fn assert_honest(name: &str, errors: &[f64]) {
    let Spread { mean, deviation, inside_two_sigma } = spread(errors);
    println!("{name}: mean {mean:+.3}, deviation {deviation:.3}, inside two sigma {inside_two_sigma:.3}");
    assert!((deviation - 1.0).abs() < DEVIATION_OFF_ONE, "{name}: deviation {deviation}");
    assert!(mean.abs() < BIAS, "{name}: bias {mean}");
    assert!(INSIDE_TWO_SIGMA.contains(&inside_two_sigma), "{name}: inside two sigma {inside_two_sigma}");
}

#[test]
fn sigma_is_honest_under_pixel_noise() {
    for sigma_px in [0.05, 0.3] {
        for (name, scene) in scenes() {
            let mut random = StdRng::seed_from_u64(1);
            let points = scene.points();
            let errors: Vec<_> = (0..RUNS)
                .map(|_| range_of(&scene, Uncertainty::NONE, &noisy(&points, sigma_px, &mut random)).estimate)
                .map(|estimate| normalised_error(&scene, &estimate))
                .collect();
            assert_honest(&format!("{name}, {sigma_px} px"), &errors);
        }
    }
}

/// Each edge leans by its own 0.1°, and the prior says so.
#[test]
fn sigma_is_honest_under_pixel_noise_and_tilt() {
    for sigma_px in [0.05, 0.3] {
        for (name, scene) in scenes() {
            let mut random = StdRng::seed_from_u64(2);
            let errors: Vec<_> = (0..RUNS)
                .map(|_| {
                    let lean: f64 = random.sample(StandardNormal);
                    let points = Scene { tilt: lean * TENTH_DEGREE, ..scene.clone() }.points();
                    range_of(&scene, tilt_of(TENTH_DEGREE), &noisy(&points, sigma_px, &mut random)).estimate
                })
                .map(|estimate| normalised_error(&scene, &estimate))
                .collect();
            assert_honest(&format!("{name}, {sigma_px} px and 0.1° of tilt"), &errors);
        }
    }
}

/// The sigma of the bearing and the correlation are honest, too.
#[test]
fn bearing_and_inverse_depth_whitened_together_have_unit_covariance() {
    for (name, scene) in scenes() {
        let mut random = StdRng::seed_from_u64(3);
        let points = scene.points();
        let mut squares = 0.0;
        for _ in 0..RUNS {
            let found = range_of::<f64>(&scene, Uncertainty::NONE, &noisy(&points, 0.1, &mut random)).estimate;
            let a = (found.bearing - scene.bearing) / found.sigma_bearing;
            let rho = normalised_error(&scene, &found);
            let r = found.correlation;
            squares += (a * a - 2.0 * r * a * rho + rho * rho) / (1.0 - r * r);
        }
        let mean_square = squares / RUNS as f64;
        // Chi squared with two degrees of freedom: five sigma of its mean, 2/√4000 each.
        assert!((mean_square - 2.0).abs() < 0.15, "{name}: {mean_square}");
    }
}

/// A fit whose residuals exceed the stated noise says so, and enlarges its sigma.
#[test]
fn understated_noise_is_noticed() {
    let scene = Scene::vga();
    let mut random = StdRng::seed_from_u64(4);
    let errors: Vec<_> = (0..1000)
        .map(|_| {
            let noisy = noisy(&scene.points(), 0.4, &mut random);
            let claimed: Vec<_> = noisy.iter().map(|point| point.with_sigma_q16(q16(0.1) as u32)).collect();
            let found = range_of::<f64>(&scene, Uncertainty::NONE, &claimed).estimate;
            // Four on average; below 1.5 is out of the reach of chance for the 13 degrees of freedom of 15 knots.
            assert!(found.misfit > 1.5, "{}", found.misfit);
            normalised_error(&scene, &found)
        })
        .collect();
    // Enlarged by a misfit that is estimated itself, errors have Student's distribution: a deviation of √(13/11),
    // about.
    assert!((0.8..1.3).contains(&spread(&errors).deviation), "{}", spread(&errors).deviation);
}
