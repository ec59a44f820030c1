//! Ranges in the fields of the messages that robots speak: plain numbers, whichever crate puts them on a wire.
//!
//! | message | carries | cannot carry |
//! | --- | --- | --- |
//! | [`DistanceSensor`] (MAVLink `DISTANCE_SENSOR`) | one edge: distance, sigma up to 15 cm, direction | that an edge is far without a bound within its range; why there is no reading |
//! | [`ObstacleDistance`] (MAVLink `OBSTACLE_DISTANCE`) | the nearest edge of each of 72 sectors | sigma; a sector without an edge is unknown, never free |
//! | [`RangeMessage`] (ROS `sensor_msgs/Range`) | one edge: distance, variance | its direction, which is that of `frame_id` |
//! | [`LaserScan`] (ROS `sensor_msgs/LaserScan`) | the nearest edge of each beam | sigma, tilt; that a beam is free |
//! | [`Record`] | all of a [`Range`](crate::Range) that can be used elsewhere, in 17 to 28 bytes with `postcard` | where the edge is in the image |
//!
//! An edge has a distance where its status is `Ok`. What is `Far` is beyond the sensor's range if its lower bound is,
//! and no reading otherwise; neither is anything else. Distances are the shortest ones to the edge's line ([`Reach`]
//! says from where to where the sensor is to be believed).

mod reach;
mod distance_sensor;
mod obstacle_distance;
mod ros;
mod record;

pub use distance_sensor::DistanceSensor;
pub use obstacle_distance::ObstacleDistance;
pub use reach::Reach;
pub use record::{Record, RecordVersionError};
pub use ros::{LaserScan, RangeMessage};
