//! [`Reach`]: what a message says of its sensor's range, and what an edge is to it.

use crate::error::ParameterError;
use crate::range::{Range, RangeStatus, Sigmas};
use crate::scalar::Scalar;

/// From where to where distances are to be believed, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reach {
    min_m: f32,
    max_m: f32,
}

/// The most that MAVLink's centimetres in 16 bits hold beside "no obstacle" and "unknown".
const MOST_M: f32 = 655.33;

impl Reach {
    /// Both in metres.
    ///
    /// *Errors*: unless 0 ≤ `min_m` < `max_m` ≤ 655.33.
    pub fn new(min_m: f32, max_m: f32) -> Result<Self, ParameterError> {
        if !(0.0..MOST_M).contains(&min_m) {
            return Err(ParameterError::new("min_m", min_m.into(), "0 to 655.33 (m)"));
        }
        if !(max_m > min_m && max_m <= MOST_M) {
            return Err(ParameterError::new("max_m", max_m.into(), "above min_m, at most 655.33 (m)"));
        }
        Ok(Self { min_m, max_m })
    }

    /// The nearest distance that is believed, in metres.
    #[must_use]
    pub const fn min_m(&self) -> f32 {
        self.min_m
    }

    /// The farthest one.
    #[must_use]
    pub const fn max_m(&self) -> f32 {
        self.max_m
    }

    pub(super) fn reading<S: Scalar>(&self, range: &Range<S>) -> Reading {
        let distance = range.distance(Sigmas(S::from_i32(2)));
        let to_f32 = |value: S| value.to_f64() as f32;
        match (range.status, distance.estimate_m, distance.nearest_m) {
            (RangeStatus::Ok, Some((distance_m, sigma_m)), _) => {
                let (distance_m, sigma_m) = (to_f32(distance_m), to_f32(sigma_m));
                if distance_m > self.max_m { Reading::Beyond } else { Reading::Distance { distance_m, sigma_m } }
            }
            (RangeStatus::Far, _, Some(nearest_m)) if to_f32(nearest_m) >= self.max_m => Reading::Beyond,
            _ => Reading::Nothing,
        }
    }
}

/// An edge as a sensor of a limited reach has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Reading {
    Distance {
        distance_m: f32,
        sigma_m: f32,
    },
    /// Farther than the sensor reaches.
    Beyond,
    Nothing,
}

/// Whole centimetres, to the nearest.
pub(super) fn centimetres(distance_m: f32) -> u16 {
    (distance_m * 100.0 + 0.5) as u16
}
