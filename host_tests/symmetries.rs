//! Properties that need no truth: the mirror, speed and time, units, the direction of readout.

use proptest::prelude::*;
use shutter_range::{EdgePoint, Range, ReadoutDirection, Uncertainty};

use crate::projection::Scene;
use crate::scenes::{line_of, range_of, seeded};

/// Scenes in which the edge stays in the image and moves by a few pixels at least.
pub(crate) fn scenes() -> impl Strategy<Value = Scene> {
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
    range_of(scene, Uncertainty::NONE, &scene.points())
}

/// Room for the rounding of double precision, which a skew of a few pixels enlarges.
const ROUNDING: f64 = 1e-9;
/// The same for a quotient of two estimates.
const ROUNDING_OF_RATIO: f64 = 1e-6;

fn mirrored_point(scene: &Scene, point: &EdgePoint) -> EdgePoint {
    EdgePoint { column_q16: (i32::from(scene.columns - 1) << 16) - point.column_q16, ..*point }
}

proptest! {
    #![proptest_config(seeded(200))]

    #[test]
    fn the_depth_is_found(scene in scenes()) {
        let found = exact(&scene).estimate;
        // Points of 1/65536 px and curves within knots, on a skew of a few pixels.
        prop_assert!((found.inverse_depth_per_m * scene.depth_m - 1.0).abs() < 1e-4);
        prop_assert!((found.bearing - scene.bearing).abs() < 1e-5);
    }

    #[test]
    fn mirrored_image_and_motion_have_the_opposite_bearing_and_the_same_depth(scene in scenes()) {
        let [vx, vy, vz] = scene.velocity_m_s;
        let [rx, ry, rz] = scene.rate_rad_s;
        let [gx, gy, gz] = scene.gravity;
        let mirrored = Scene {
            velocity_m_s: [-vx, vy, vz],
            rate_rad_s: [rx, -ry, -rz],
            gravity: [-gx, gy, gz],
            ..scene.clone()
        };
        let points: Vec<_> = scene.points().iter().map(|point| mirrored_point(&scene, point)).collect();
        let (here, there) = (exact(&scene).estimate, range_of::<f64>(&mirrored, Uncertainty::NONE, &points).estimate);
        prop_assert!((here.bearing + there.bearing).abs() < ROUNDING);
        prop_assert!((here.inverse_depth_per_m - there.inverse_depth_per_m).abs() < ROUNDING);
        prop_assert!((here.correlation + there.correlation).abs() < ROUNDING_OF_RATIO);
    }

    /// The same points and rotation, and half the sigma of inverse depth.
    #[test]
    fn twice_the_speed_is_twice_the_depth(scene in scenes()) {
        let faster = Scene { velocity_m_s: scene.velocity_m_s.map(|v| 2.0 * v), ..scene.clone() };
        let (here, there) = (exact(&scene).estimate, range_of::<f64>(&faster, Uncertainty::NONE, &scene.points()).estimate);
        prop_assert!((here.inverse_depth_per_m / there.inverse_depth_per_m - 2.0).abs() < ROUNDING_OF_RATIO);
        // Nobody needs a sigma to more than a thousandth.
        prop_assert!((here.sigma_inverse_depth_per_m / there.sigma_inverse_depth_per_m - 2.0).abs() < 1e-3);
    }

    #[test]
    fn half_the_readout_time_at_twice_the_speed_is_the_same_picture(scene in scenes()) {
        let quick = Scene {
            readout_s: scene.readout_s / 2.0,
            velocity_m_s: scene.velocity_m_s.map(|v| 2.0 * v),
            rate_rad_s: scene.rate_rad_s.map(|r| 2.0 * r),
            ..scene.clone()
        };
        prop_assert!((scene.column(300) - quick.column(300)).abs() < ROUNDING);
        let (here, there) = (exact(&scene).estimate, exact(&quick).estimate);
        // Times are rounded to nanoseconds, of 17 ms or 33 ms.
        prop_assert!((here.inverse_depth_per_m / there.inverse_depth_per_m - 1.0).abs() < 1e-5);
    }

    /// Metres or feet.
    #[test]
    fn the_depth_comes_in_the_unit_of_the_speed(scene in scenes(), unit in 0.1..10.0_f64) {
        let other = Scene { velocity_m_s: scene.velocity_m_s.map(|v| v * unit), ..scene.clone() };
        let (here, there) = (exact(&scene).estimate, range_of::<f64>(&other, Uncertainty::NONE, &scene.points()).estimate);
        let ratio: f64 = here.inverse_depth_per_m / there.inverse_depth_per_m;
        prop_assert!((ratio / unit - 1.0_f64).abs() < ROUNDING_OF_RATIO);
    }

    /// Rows and columns both are turned over: what was read from the top is read from below.
    #[test]
    fn a_camera_upside_down_has_the_opposite_bearing_and_the_same_depth(scene in scenes()) {
        let [vx, vy, vz] = scene.velocity_m_s;
        let [rx, ry, rz] = scene.rate_rad_s;
        let [gx, gy, gz] = scene.gravity;
        let turned = Scene {
            velocity_m_s: [-vx, -vy, vz],
            rate_rad_s: [-rx, -ry, rz],
            gravity: [-gx, -gy, gz],
            ..scene.clone()
        };
        let points: Vec<_> = scene.points().iter()
            .map(|point| EdgePoint { row: scene.rows - 1 - point.row, ..mirrored_point(&scene, point) })
            .collect();
        let setup = turned.setup_read::<f64>(Uncertainty::NONE, ReadoutDirection::BottomToTop);
        prop_assert_eq!(setup.readout().row_time_ns(points[0].row), points[0].time_ns);
        let there = Range::from_line(&setup, &turned.motion(), &line_of::<16>(&points));
        let here = exact(&scene);
        prop_assert!((here.estimate.bearing + there.estimate.bearing).abs() < ROUNDING);
        let ratio = here.estimate.inverse_depth_per_m / there.estimate.inverse_depth_per_m;
        prop_assert!((ratio - 1.0).abs() < ROUNDING_OF_RATIO);
        prop_assert!(there.first_row < there.last_row);
    }
}
