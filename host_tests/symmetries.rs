//! Properties that need no truth: the mirror, speed and time, units, the direction of readout.

use proptest::prelude::*;
use shutter_range::{EdgePoint, Range, ReadoutDirection, Uncertainty};

use crate::projection::Scene;
use crate::scenes::{line_of, range_of, seeded};

/// Scenes in which the edge stays in the image and moves by a few pixels at least.
fn scenes() -> impl Strategy<Value = Scene> {
    let motion = (-3.0..3.0, -0.2..0.2, -2.0..2.0);
    let rate = (-0.5..0.5, -0.5..0.5, -0.5..0.5);
    let gravity = (-0.2..0.2, -0.3..0.3);
    (motion, rate, gravity, -0.3..0.3, 0.8..6.0)
        .prop_map(|((vx, vy, vz), (rx, ry, rz), (gx, gz), bearing, depth_m)| {
            let length = f64::hypot(f64::hypot(gx, gz), 1.0);
            Scene {
                velocity_m_s: [vx, vy, vz],
                rate_rad_s: [rx, ry, rz],
                gravity: [gx / length, 1.0 / length, gz / length],
                bearing,
                depth_m,
                ..Scene::vga()
            }
        })
        .prop_filter("the motion shows", |scene| {
            let [vx, _, vz] = scene.velocity_m_s;
            (scene.bearing * vz - vx).abs() > 0.2 && scene.visible_rows().len() > 200
        })
}

fn exact(scene: &Scene) -> Range<f64> {
    range_of(scene, Uncertainty::NONE, &scene.edges())
}

fn mirrored_edge(scene: &Scene, edge: &EdgePoint) -> EdgePoint {
    EdgePoint { column_q16: (i32::from(scene.columns - 1) << 16) - edge.column_q16, ..*edge }
}

proptest! {
    #![proptest_config(seeded(200))]

    #[test]
    fn the_depth_is_found(scene in scenes()) {
        let found = exact(&scene).estimate;
        prop_assert!((found.inverse_depth_per_m * scene.depth_m - 1.0).abs() < 1e-4);
        prop_assert!((found.bearing - scene.bearing).abs() < 1e-5);
    }

    /// Mirror the image and the motion: the bearing flips, the depth stays.
    #[test]
    fn mirror(scene in scenes()) {
        let [vx, vy, vz] = scene.velocity_m_s;
        let [rx, ry, rz] = scene.rate_rad_s;
        let [gx, gy, gz] = scene.gravity;
        let mirrored = Scene {
            velocity_m_s: [-vx, vy, vz],
            rate_rad_s: [rx, -ry, -rz],
            gravity: [-gx, gy, gz],
            ..scene.clone()
        };
        let edges: Vec<_> = scene.edges().iter().map(|edge| mirrored_edge(&scene, edge)).collect();
        let (here, there) = (exact(&scene).estimate, range_of::<f64>(&mirrored, Uncertainty::NONE, &edges).estimate);
        prop_assert!((here.bearing + there.bearing).abs() < 1e-9);
        prop_assert!((here.inverse_depth_per_m - there.inverse_depth_per_m).abs() < 1e-9);
        prop_assert!((here.correlation + there.correlation).abs() < 1e-6);
    }

    /// The same edges and twice the speed, rotation apart: twice the depth, and half the sigma of its inverse.
    #[test]
    fn speed_scales_depth(scene in scenes()) {
        let faster = Scene { velocity_m_s: scene.velocity_m_s.map(|v| 2.0 * v), ..scene.clone() };
        let (here, there) = (exact(&scene).estimate, range_of::<f64>(&faster, Uncertainty::NONE, &scene.edges()).estimate);
        prop_assert!((here.inverse_depth_per_m / there.inverse_depth_per_m - 2.0).abs() < 1e-6);
        prop_assert!((here.sigma_inverse_depth_per_m / there.sigma_inverse_depth_per_m - 2.0).abs() < 1e-3);
    }

    /// Half the readout time and twice the speeds is the same picture.
    #[test]
    fn time_and_speed_trade(scene in scenes()) {
        let quick = Scene {
            readout_s: scene.readout_s / 2.0,
            velocity_m_s: scene.velocity_m_s.map(|v| 2.0 * v),
            rate_rad_s: scene.rate_rad_s.map(|r| 2.0 * r),
            ..scene.clone()
        };
        prop_assert!((scene.column(300) - quick.column(300)).abs() < 1e-9);
        let (here, there) = (exact(&scene).estimate, exact(&quick).estimate);
        prop_assert!((here.inverse_depth_per_m / there.inverse_depth_per_m - 1.0).abs() < 1e-5);
    }

    /// Metres or feet: with speeds in another unit the depth comes in that unit.
    #[test]
    fn units(scene in scenes(), unit in 0.1..10.0_f64) {
        let other = Scene { velocity_m_s: scene.velocity_m_s.map(|v| v * unit), ..scene.clone() };
        let (here, there) = (exact(&scene).estimate, range_of::<f64>(&other, Uncertainty::NONE, &scene.edges()).estimate);
        let ratio: f64 = here.inverse_depth_per_m / there.inverse_depth_per_m;
        prop_assert!((ratio / unit - 1.0_f64).abs() < 1e-6);
    }

    /// Turn the camera upside down, rows and columns both: what was read from the top is read from below.
    #[test]
    fn upside_down(scene in scenes()) {
        let [vx, vy, vz] = scene.velocity_m_s;
        let [rx, ry, rz] = scene.rate_rad_s;
        let [gx, gy, gz] = scene.gravity;
        let turned = Scene {
            velocity_m_s: [-vx, -vy, vz],
            rate_rad_s: [-rx, -ry, rz],
            gravity: [-gx, -gy, gz],
            ..scene.clone()
        };
        let edges: Vec<_> = scene.edges().iter()
            .map(|edge| EdgePoint { row: scene.rows - 1 - edge.row, ..mirrored_edge(&scene, edge) })
            .collect();
        let setup = turned.setup_read::<f64>(Uncertainty::NONE, ReadoutDirection::BottomToTop);
        prop_assert_eq!(setup.readout().row_time_ns(edges[0].row), edges[0].time_ns);
        let there = Range::from_line(&setup, &turned.motion(), &line_of::<16>(&edges));
        let here = exact(&scene);
        prop_assert!((here.estimate.bearing + there.estimate.bearing).abs() < 1e-9);
        let ratio = here.estimate.inverse_depth_per_m / there.estimate.inverse_depth_per_m;
        prop_assert!((ratio - 1.0).abs() < 1e-6);
        prop_assert!(there.first_row < there.last_row);
    }
}
