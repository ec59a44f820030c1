//! `rse`: the paper's equations one by one, and the exact range from two endpoints.

use proptest::prelude::*;
use shutter_range::rse::{self, Endpoint, Shear, range_of_endpoints};
use shutter_range::{RangeStatus, Sample, Uncertainty, fit};

use crate::projection::Scene;
use crate::scenes::{seeded, tilt_of};

/// Room for the rounding of double precision, which the quotients below enlarge a thousandfold at most.
const ROUNDING: f64 = 1e-9;

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * a.abs().max(b.abs()).max(1e-3)
}

#[test]
fn the_equations_of_the_picture_give_what_is_worked_out_by_hand() {
    // (1): 480 rows in 1/30 s, 1 ms later.
    assert!(close(rse::row_after(100.0, 480.0, 1.0 / 30.0, 0.001), 114.4));
    // (2) and (8): 3 cm at 2 m with 600 px.
    assert!(close(rse::column_after(300.0, 600.0, 0.03, 2.0), 309.0));
    // (5) and (6).
    assert!(close(rse::bearing(499.5, 319.5, 600.0), 0.3));
    assert!(close(rse::bearing(139.5, 319.5, 600.0), -0.3));
    assert!(close(rse::distance_m(4.0, 0.75), 5.0));
    // κ = c/(n p): 50 mm, 4010 rows of 5.98 µm.
    assert!(close(rse::kappa(50.0, 4010.0, 5.98), 50.0 / (4010.0 * 0.00598)));
}

proptest! {
    #![proptest_config(seeded(256))]

    #[test]
    fn the_equation_can_be_solved_for_each_of_its_quantities(
        kappa in 0.5..5.0, tan_alpha in -0.8..0.8, heading in -3.0..3.0, depth in 0.3..50.0, speed in 0.1..20.0, readout in 0.005..0.1,
    ) {
        let shear = Shear::oblique(kappa, tan_alpha, heading);
        let angle = shear.angle_rad(depth, speed, readout);
        prop_assume!(f64::abs(angle) > 1e-4 && angle.abs() < 1.5);
        prop_assert!((shear.depth_m(angle, speed, readout) / depth - 1.0).abs() < ROUNDING);
        prop_assert!((shear.speed_m_s(angle, depth, readout) / speed - 1.0).abs() < ROUNDING);
        prop_assert!((shear.frame_readout_s(angle, depth, speed) / readout - 1.0).abs() < ROUNDING);
        let distance = depth * f64::hypot(1.0, tan_alpha);
        prop_assert!((shear.distance_m(angle, speed, readout) / distance - 1.0).abs() < ROUNDING);
    }

    /// The paper's own form of eq. (13): cos(ω − α)/cos α, with α an angle.
    #[test]
    fn the_three_scenarios_are_one_equation(tan_alpha in -0.8..0.8_f64, heading in -3.0..3.0_f64) {
        // Slopes are below 0.1: rounding is 1e-17 and more where the terms cancel.
        const ROUNDING: f64 = 1e-12;
        let alpha = tan_alpha.atan();
        let slope = |shear: Shear<f64>| shear.slope(3.0, 2.0, 0.02);
        let base = 2.361 * 0.02 * 2.0 / 3.0;
        let oblique = slope(Shear::oblique(2.361, tan_alpha, heading));
        prop_assert!((oblique - base * (heading - alpha).cos() / alpha.cos()).abs() < ROUNDING);
        let right_angle = std::f64::consts::FRAC_PI_2;
        let perpendicular = slope(Shear::perpendicular(2.361, tan_alpha));
        prop_assert!((perpendicular - slope(Shear::oblique(2.361, tan_alpha, right_angle))).abs() < ROUNDING);
        let parallel = slope(Shear::parallel(2.361, tan_alpha));
        prop_assert!((parallel - slope(Shear::oblique(2.361, tan_alpha, 0.0))).abs() < ROUNDING);
    }

    /// (9) and (12) against the geometry of the plan: an object that moves by (v cos ω, −v sin ω).
    #[test]
    fn the_sideways_shift_is_that_of_the_plan(tan_alpha in -0.8..0.8_f64, heading in -3.0..3.0_f64, depth in 1.0..20.0_f64) {
        let step = 1e-6;
        let shift: f64 = Shear::oblique(1.0, tan_alpha, heading).sideways_m(2.0, step);
        let moved_u = (tan_alpha * depth + 2.0 * step * heading.cos()) / (depth - 2.0 * step * heading.sin());
        // Second order in a step of 2e-6 m, and no quotient of shifts that are next to nothing.
        prop_assert!(((moved_u - tan_alpha) * depth / shift - 1.0).abs() < 1e-3 || shift.abs() < 1e-8);
    }

    /// The paper's two lights, for any translation.
    #[test]
    fn two_exact_endpoints_give_the_exact_range(vx in -3.0..3.0, vy in -1.0..1.0, vz in -3.0..3.0, bearing in -0.3..0.3, depth_m in 0.8..10.0) {
        prop_assume!(f64::abs(bearing * vz - vx) > 0.1);
        let scene = Scene { velocity_m_s: [vx, vy, vz], bearing, depth_m, ..Scene::vga() };
        let found = range_of_endpoints(end(&scene, 40), end(&scene, 430), scene.velocity_m_s, 0.0).expect("two ends");
        prop_assert!((found.inverse_depth_per_m * depth_m - 1.0).abs() < ROUNDING);
        prop_assert!((found.bearing - bearing).abs() < ROUNDING);
    }

    /// The same estimate and the same covariance as those of the least-squares fit through the two points.
    #[test]
    fn endpoints_agree_with_the_fit(vx in -3.0..3.0, vz in -2.0..2.0, bearing in -0.3..0.3, depth_m in 0.8..10.0) {
        prop_assume!(f64::abs(bearing * vz - vx) > 0.2);
        let scene = Scene { velocity_m_s: [vx, 0.0, vz], bearing, depth_m, ..Scene::vga() };
        let rows = [40, 430];
        let by_ends =
            range_of_endpoints(end(&scene, rows[0]), end(&scene, rows[1]), scene.velocity_m_s, 0.0).expect("two ends");
        let sample = |row| Sample::point(scene.column(row), f64::from(row), scene.time_s(row), 0.1);
        let by_fit = fit::<f64, _, 2>(&scene.setup(), &scene.motion(), rows.map(sample)).expect("two samples");
        prop_assert!((by_ends.inverse_depth_per_m / by_fit.inverse_depth_per_m - 1.0).abs() < ROUNDING);
        prop_assert!((by_ends.bearing - by_fit.bearing).abs() < ROUNDING);
        // Rounding under the roots of the fit's variances.
        prop_assert!((by_ends.sigma_inverse_depth_per_m / by_fit.sigma_inverse_depth_per_m - 1.0).abs() < 1e-6);
        prop_assert!((by_ends.sigma_bearing / by_fit.sigma_bearing - 1.0).abs() < 1e-6);
        prop_assert!((by_ends.correlation - by_fit.correlation).abs() < 1e-6);
    }

    /// Noise is that of both ends, and lean what the same tilt makes without noise.
    #[test]
    fn the_budget_of_two_ends_adds_up(vx in -3.0..3.0, vz in -2.0..2.0, bearing in -0.3..0.3, depth_m in 0.8..10.0, tilt in 0.0..0.01) {
        prop_assume!(f64::abs(bearing * vz - vx) > 0.2);
        let scene = Scene { velocity_m_s: [vx, 0.0, vz], bearing, depth_m, ..Scene::vga() };
        let (top, low) = (end(&scene, 40), end(&scene, 430));
        let range = |top, low, tilt| range_of_endpoints(top, low, scene.velocity_m_s, tilt).expect("two ends");
        let still = |end| Endpoint { sigma: 1e-15, ..end };
        let (both, noise, lean) = (range(top, low, tilt), range(top, low, 0.0), range(still(top), still(low), tilt));
        let [noise, lean] = [noise, lean].map(|part| part.sigma_inverse_depth_per_m);
        prop_assert!(close(both.budget.noise_per_m, noise) && close(both.budget.lean_per_m, lean), "{both:?}");
        prop_assert!(close(both.budget.independent_per_m(), both.sigma_inverse_depth_per_m), "{both:?}");
        prop_assert_eq!(both.budget.correlated_per_m(), 0.0);
    }
}

fn end(scene: &Scene, row: u16) -> Endpoint<f64> {
    Endpoint {
        u: (scene.column(row) - scene.cx) / scene.focal_px,
        w: (f64::from(row) - scene.cy) / scene.focal_px,
        time_s: scene.time_s(row),
        sigma: 0.1 / scene.focal_px,
    }
}

#[test]
fn a_tilt_of_one_sigma_moves_the_range_by_one_sigma() {
    // Second order in a tilt of 1e-6, and what the ends' noise of 1e-13 adds.
    const CURVATURE: f64 = 1e-3;
    let upright = Scene { velocity_m_s: [-1.0, 0.0, 0.8], ..Scene::vga() };
    let leaning = Scene { tilt: 1e-6, ..upright.clone() };
    let range = |scene: &Scene, sigma_tilt| {
        let still = Endpoint { sigma: 1e-13, ..end(scene, 40) };
        let low = Endpoint { sigma: 1e-13, ..end(scene, 430) };
        range_of_endpoints(still, low, scene.velocity_m_s, sigma_tilt).expect("two ends")
    };
    let moved = (range(&leaning, 0.0).inverse_depth_per_m - range(&upright, 0.0).inverse_depth_per_m).abs();
    assert!((range(&upright, 1e-6).sigma_inverse_depth_per_m / moved - 1.0).abs() < CURVATURE);
    let moved = (range(&leaning, 0.0).bearing - range(&upright, 0.0).bearing).abs();
    assert!((range(&upright, 1e-6).sigma_bearing / moved - 1.0).abs() < CURVATURE);
}

#[test]
fn endpoints_without_motion_are_slow_and_nonsense_is_refused() {
    let scene = Scene::vga();
    let (top, low) = (end(&scene, 40), end(&scene, 430));
    let still = range_of_endpoints(top, Endpoint { u: top.u, ..low }, [0.0; 3], 0.0).expect("sound, but still");
    assert_eq!(still.status(), RangeStatus::Slow);
    let refused = |first, second, velocity, tilt| {
        range_of_endpoints(first, second, velocity, tilt).expect_err("nonsense").parameter
    };
    assert_eq!(refused(Endpoint { u: f64::NAN, ..top }, low, [1.0, 0.0, 0.0], 0.0), "u");
    assert_eq!(refused(top, Endpoint { sigma: 0.0, ..low }, [1.0, 0.0, 0.0], 0.0), "sigma");
    assert_eq!(refused(top, Endpoint { time_s: top.time_s, ..low }, [1.0, 0.0, 0.0], 0.0), "time_s");
    assert_eq!(refused(top, low, [f64::INFINITY, 0.0, 0.0], 0.0), "velocity_m_s");
    assert_eq!(refused(top, low, [1.0, 0.0, 0.0], -1.0), "sigma_tilt");
}

/// Forward motion: reading Z(t2) as Z(0) is wrong by v t/Z; ours is not.
#[test]
fn the_paper_misreads_the_instant() {
    let scene = Scene { velocity_m_s: [0.0, 0.0, 5.0], bearing: 0.2, depth_m: 0.5, ..Scene::vga() };
    let (top, low) = (end(&scene, 100), end(&scene, 380));
    let exact = range_of_endpoints(top, low, scene.velocity_m_s, 0.0).expect("two ends");
    assert!((exact.inverse_depth_per_m * 0.5 - 1.0).abs() < ROUNDING);
    let at_second = (top.u * 5.0) * (low.time_s - top.time_s) / (low.u - top.u);
    let misread = 1.0 - at_second / 0.5;
    assert!((misread - 5.0 * low.time_s / 0.5).abs() < ROUNDING);
    let setup = scene.setup_with(tilt_of(0.0));
    let samples = [100, 380].map(|row| Sample::point(scene.column(row), f64::from(row), scene.time_s(row), 0.1));
    assert_eq!(setup.uncertainty(), &Uncertainty::NONE);
    assert!(fit::<f64, _, 4>(&setup, &scene.motion(), samples).is_ok());
}
