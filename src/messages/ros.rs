//! [`RangeMessage`] and [`LaserScan`]: the fields of ROS's `sensor_msgs/Range` and `sensor_msgs/LaserScan`.

use super::reach::{Reach, Reading};
use crate::error::ParameterError;
use crate::range::Range;
use crate::scalar::Scalar;

/// The fields of ROS's `sensor_msgs/Range` for one edge, by their names; header and radiation type are the sender's,
/// and `frame_id` must look at the edge. Without a distance they are as REP 117 says.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RangeMessage {
    /// Radians; 0, as an edge has no width.
    pub field_of_view: f32,
    /// Metres.
    pub min_range: f32,
    /// Metres.
    pub max_range: f32,
    /// Metres. −∞: nearer than `min_range`; +∞: farther than `max_range`; NaN: no reading.
    pub range: f32,
    /// Square metres; 0: unknown, as without a distance.
    pub variance: f32,
}

impl RangeMessage {
    /// Of an edge.
    #[must_use]
    pub fn of_range<S: Scalar>(range: &Range<S>, reach: &Reach) -> Self {
        let (distance_m, variance) = match reach.reading(range) {
            Reading::Distance { distance_m, .. } if distance_m < reach.min_m() => (f32::NEG_INFINITY, 0.0),
            // A variance of zero would be an unknown one.
            Reading::Distance { distance_m, sigma_m } => (distance_m, (sigma_m * sigma_m).max(f32::MIN_POSITIVE)),
            Reading::Beyond => (f32::INFINITY, 0.0),
            Reading::Nothing => (f32::NAN, 0.0),
        };
        Self { field_of_view: 0.0, min_range: reach.min_m(), max_range: reach.max_m(), range: distance_m, variance }
    }
}

/// The fields of ROS's `sensor_msgs/LaserScan`, by their names; the header and the times are the sender's. `BEAMS`
/// beams in a `frame_id` whose x axis is the camera's optical axis, y left and z up (the camera's link, not its optical
/// frame).
///
/// A beam has the nearest of its edges, and NaN where none has a distance: never +∞, which would clear a costmap, since
/// a camera that sees edges does not know what is free between them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LaserScan<const BEAMS: usize> {
    /// Radians, positive to the left: the first beam, to the right.
    pub angle_min: f32,
    /// Radians: the last beam, to the left.
    pub angle_max: f32,
    /// Radians.
    pub angle_increment: f32,
    /// Metres.
    pub range_min: f32,
    /// Metres.
    pub range_max: f32,
    /// Metres; NaN: no reading.
    pub ranges: [f32; BEAMS],
}

impl<const BEAMS: usize> LaserScan<BEAMS> {
    /// Without readings, over `field_rad` about the optical axis.
    ///
    /// *Errors*: a field that is not above zero and at most π.
    pub fn new(reach: &Reach, field_rad: f32) -> Result<Self, ParameterError> {
        const { assert!(BEAMS > 1, "at least two beams") };
        if !(field_rad > 0.0 && field_rad <= core::f32::consts::PI) {
            return Err(ParameterError::new("field_rad", field_rad.into(), "above 0, at most pi (rad)"));
        }
        Ok(Self {
            angle_min: -field_rad / 2.0,
            angle_max: field_rad / 2.0,
            angle_increment: field_rad / (BEAMS as f32 - 1.0),
            range_min: reach.min_m(),
            range_max: reach.max_m(),
            ranges: [f32::NAN; BEAMS],
        })
    }

    /// Takes an edge in. One without a distance within reach, or beside the beams, changes nothing.
    pub fn add<S: Scalar>(&mut self, range: &Range<S>, reach: &Reach) {
        let Reading::Distance { distance_m, .. } = reach.reading(range) else { return };
        // A bearing is positive to the right.
        let left_rad = -range.estimate.bearing.atan().to_f64() as f32;
        let beam = (left_rad - self.angle_min) / self.angle_increment + 0.5;
        let nearest = if beam >= 0.0 { self.ranges.get_mut(beam as usize) } else { None };
        if let Some(nearest) = nearest.filter(|_| distance_m >= reach.min_m()) {
            *nearest = nearest.min(distance_m);
        }
    }
}
