//! [`ObstacleDistance`]: the fields of MAVLink's `OBSTACLE_DISTANCE`.

use super::reach::{Reach, Reading, centimetres};
use crate::range::Range;
use crate::scalar::Scalar;

/// The fields of MAVLink's `OBSTACLE_DISTANCE` (330), by their names; its time and type are the sender's.
///
/// A sector has the nearest of its edges. Where none has a distance it is *unknown*: the camera sees edges, not free
/// space, so it never claims "no obstacle". Sigma is not in the message: leave edges out that are not good enough.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ObstacleDistance {
    /// Centimetres, to the nearest, at least 1 (0 is touching); 65535: unknown.
    pub distances: [u16; Self::SECTORS],
    /// Degrees, for receivers that do not know `increment_f`: the whole ones of it.
    pub increment: u8,
    /// Centimetres.
    pub min_distance: u16,
    /// Centimetres.
    pub max_distance: u16,
    /// Degrees from one sector to the next, to the right.
    pub increment_f: f32,
    /// Direction of the middle of the first sector in degrees, positive to the right of the body's nose.
    pub angle_offset: f32,
    /// `MAV_FRAME_BODY_FRD` (12). The message's default would be north.
    pub frame: u8,
}

const UNKNOWN: u16 = u16::MAX;
/// `MAV_FRAME_BODY_FRD`.
const BODY_FRD: u8 = 12;

impl ObstacleDistance {
    /// As many as the message has.
    pub const SECTORS: usize = 72;

    /// All unknown. The sectors lie evenly about the optical axis of a camera that looks `camera_yaw_deg` to the right
    /// of the body's nose, over `field_deg`, 1 to 360.
    #[must_use]
    pub fn new(reach: &Reach, camera_yaw_deg: f32, field_deg: f32) -> Self {
        let increment_f = field_deg.clamp(1.0, 360.0) / Self::SECTORS as f32;
        Self {
            distances: [UNKNOWN; Self::SECTORS],
            increment: increment_f as u8,
            min_distance: centimetres(reach.min_m()),
            max_distance: centimetres(reach.max_m()),
            increment_f,
            angle_offset: camera_yaw_deg - increment_f * (Self::SECTORS as f32 - 1.0) / 2.0,
            frame: BODY_FRD,
        }
    }

    /// Takes an edge in. One without a distance, farther than `reach` or beside the sectors changes nothing; one that
    /// is nearer than `reach` is told as it is.
    pub fn add<S: Scalar>(&mut self, range: &Range<S>, reach: &Reach) {
        let Reading::Distance { distance_m, .. } = reach.reading(range) else { return };
        let right_deg = range.estimate.bearing.atan().to_f64().to_degrees() as f32;
        let sector = right_deg / self.increment_f + Self::SECTORS as f32 / 2.0;
        // The conversion would make the first one of what is left of it.
        let nearest = if sector >= 0.0 { self.distances.get_mut(sector as usize) } else { None };
        if let Some(nearest) = nearest {
            *nearest = (*nearest).min(centimetres(distance_m).max(1));
        }
    }
}
