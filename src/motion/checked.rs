//! Checks of the motions that users hand over.

use super::motion::Pose;
use crate::error::ParameterError;
use crate::scalar::{Scalar, dot};

/// Faster than anything that carries a camera, and far from overflow in fixed point.
const MAX_SPEED_M_S: i32 = 10_000;
const MAX_RATE_RAD_S: i32 = 1_000;
const MAX_WAY_M: i32 = 1_000_000;
const MAX_ELAPSED_S: i32 = 1_000_000;

/// Only the direction counts: it may be in g, in m/s², or in what an accelerometer of 16 bits counts.
const MAX_GRAVITY: i32 = 1_000_000;

pub(crate) fn checked_velocity<S: Scalar>(velocity_m_s: [S; 3]) -> Result<[S; 3], ParameterError> {
    check("velocity_m_s", velocity_m_s, MAX_SPEED_M_S, "finite, at most 10000 (m/s)")?;
    Ok(velocity_m_s)
}

pub(crate) fn checked_rate<S: Scalar>(rate_rad_s: [S; 3]) -> Result<[S; 3], ParameterError> {
    check("rate_rad_s", rate_rad_s, MAX_RATE_RAD_S, "finite, at most 1000 (rad/s)")?;
    Ok(rate_rad_s)
}

/// The pose at the start of the next frame, so much later.
pub(crate) fn check_next_frame<S: Scalar>(pose: &Pose<S>, elapsed_s: S) -> Result<(), ParameterError> {
    if !(elapsed_s.abs() <= S::from_i32(MAX_ELAPSED_S)) {
        return Err(ParameterError::new("elapsed_s", elapsed_s.to_f64(), "finite, at most 1000000 (s)"));
    }
    checked_velocity(pose.velocity_m_s)?;
    checked_rate(pose.rate_rad_s)?;
    check("position_m", pose.position_m, MAX_WAY_M, "finite, at most 1000000 (m)")?;
    pose.rotation.into_iter().try_for_each(|row| check("rotation", row, 2, "finite, a row of a rotation matrix"))
}

/// The direction as a unit vector.
pub(crate) fn checked_direction<S: Scalar>(gravity: [S; 3]) -> Result<[S; 3], ParameterError> {
    check("gravity", gravity, MAX_GRAVITY, "finite, at most 1000000 (only its direction counts)")?;
    let square = dot(gravity, gravity);
    if square == S::ONE {
        return Ok(gravity);
    }
    let length = square.sqrt();
    if !(length >= S::ratio(1, 1_000)) {
        return Err(ParameterError::new("gravity", length.to_f64(), "a direction: at least 0.001 long"));
    }
    Ok(gravity.map(|component| component / length))
}

fn check<S: Scalar>(
    name: &'static str,
    vector: [S; 3],
    limit: i32,
    expected: &'static str,
) -> Result<(), ParameterError> {
    match vector.into_iter().find(|c| !(c.is_finite() && c.abs() <= S::from_i32(limit))) {
        Some(component) => Err(ParameterError::new(name, component.to_f64(), expected)),
        None => Ok(()),
    }
}
