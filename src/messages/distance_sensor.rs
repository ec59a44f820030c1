//! [`DistanceSensor`]: the fields of MAVLink's `DISTANCE_SENSOR`.

use super::reach::{Reach, Reading, centimetres};
use crate::range::Range;
use crate::scalar::Scalar;

/// The fields of MAVLink's `DISTANCE_SENSOR` (132) for one edge, by their names; its time, type and id are the
/// sender's.
///
/// The message knows no "no reading" but `signal_quality` 1; `current_distance` then lies beyond `max_distance`, so
/// that a receiver that looks at it alone does not brake.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DistanceSensor {
    /// Centimetres.
    pub min_distance: u16,
    /// Centimetres.
    pub max_distance: u16,
    /// Centimetres, to the nearest, also below `min_distance`; `max_distance + 1` where the edge is farther or nothing
    /// is known.
    pub current_distance: u16,
    /// `MAV_SENSOR_ROTATION_CUSTOM` (100): the quaternion tells the direction.
    pub orientation: u8,
    /// Variance in square centimetres, rounded up: 1 to 254, so a sigma up to 15.9 cm. 255: unknown, or more than that.
    pub covariance: u8,
    /// Radians; 0: unknown, as an edge has no width.
    pub horizontal_fov: f32,
    /// Radians; 0: unknown.
    pub vertical_fov: f32,
    /// Direction of the edge in the body's axes (forward, right, down): w, x, y, z.
    pub quaternion: [f32; 4],
    /// 100: a distance, or farther than `max_distance`. 1: invalid. (0 would be unknown.)
    pub signal_quality: u8,
}

/// `MAV_SENSOR_ROTATION_CUSTOM`.
const CUSTOM: u8 = 100;
const UNKNOWN_VARIANCE: u8 = u8::MAX;
const INVALID: u8 = 1;
const PERFECT: u8 = 100;

impl DistanceSensor {
    /// Of an edge; `camera` is the rotation from forward along the body's nose to the camera's optical axis, as a unit
    /// quaternion w, x, y, z in the body's axes: 1, 0, 0, 0 for a camera that looks ahead.
    #[must_use]
    pub fn of_range<S: Scalar>(range: &Range<S>, reach: &Reach, camera: [f32; 4]) -> Self {
        let max_distance = centimetres(reach.max_m());
        let (current_distance, covariance, signal_quality) = match reach.reading(range) {
            Reading::Distance { distance_m, sigma_m } => (centimetres(distance_m), variance_cm2(sigma_m), PERFECT),
            Reading::Beyond => (max_distance + 1, UNKNOWN_VARIANCE, PERFECT),
            Reading::Nothing => (max_distance + 1, UNKNOWN_VARIANCE, INVALID),
        };
        Self {
            min_distance: centimetres(reach.min_m()),
            max_distance,
            current_distance,
            orientation: CUSTOM,
            covariance,
            horizontal_fov: 0.0,
            vertical_fov: 0.0,
            quaternion: turned_right(camera, range.estimate.bearing),
            signal_quality,
        }
    }
}

fn variance_cm2(sigma_m: f32) -> u8 {
    let variance = sigma_m * sigma_m * 1e4;
    let whole = variance as u32;
    let rounded_up = whole + u32::from(whole as f32 != variance);
    // Zero would say that it is exact.
    u8::try_from(rounded_up.max(1)).unwrap_or(UNKNOWN_VARIANCE)
}

/// A rotation, and then one about the axis that is then "down", to the right by an angle of that tangent.
fn turned_right<S: Scalar>([w, x, y, z]: [f32; 4], tangent: S) -> [f32; 4] {
    let half = tangent.atan() / S::from_i32(2);
    let (cos, sin) = (half.cos().to_f64() as f32, half.sin().to_f64() as f32);
    [w * cos - z * sin, x * cos + y * sin, y * cos - x * sin, z * cos + w * sin]
}
