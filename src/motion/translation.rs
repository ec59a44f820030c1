//! [`Translation`]: constant velocity without turning.

use super::checked::{checked_direction, checked_velocity};
use super::motion::{Motion, Pose};
use crate::error::ParameterError;
use crate::scalar::{Scalar, scale};

/// Constant velocity without turning: a [`Twist`](crate::Twist) for programs in which the camera never turns within a
/// frame, as on a rail or a slider. Without any other motion such a program takes less flash.
///
/// ```
/// use shutter_range::{Motion, Translation};
/// let motion = Translation::level([1.5, 0.0, 0.0])?; // to the right at 1.5 m/s
/// assert_eq!(motion.pose(0.01).position_m, [0.015, 0.0, 0.0]);
/// # Ok::<(), shutter_range::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "RawTranslation<S>"))]
#[cfg_attr(feature = "serde", serde(bound(deserialize = "S: Scalar + serde::Deserialize<'de>")))]
pub struct Translation<S> {
    velocity_m_s: [S; 3],
    gravity: [S; 3],
}

impl<S: Scalar> Translation<S> {
    /// From the camera's velocity (m/s) and the direction of gravity, both in the camera's axes at frame start, as
    /// [`Twist::new`](crate::Twist::new) has them.
    ///
    /// *Errors*: a component that is not finite or beyond 10000 m/s; a gravity without direction.
    pub fn new(velocity_m_s: [S; 3], gravity: [S; 3]) -> Result<Self, ParameterError> {
        Ok(Self { velocity_m_s: checked_velocity(velocity_m_s)?, gravity: checked_direction(gravity)? })
    }

    /// A level camera.
    ///
    /// *Errors*: as [`Translation::new`].
    pub fn level(velocity_m_s: [S; 3]) -> Result<Self, ParameterError> {
        Self::new(velocity_m_s, [S::ZERO, S::ONE, S::ZERO])
    }

    /// Velocity in m/s.
    #[must_use]
    pub const fn velocity_m_s(&self) -> [S; 3] {
        self.velocity_m_s
    }
}

impl<S: Scalar> Motion<S> for Translation<S> {
    const MAY_TURN: bool = false;

    fn pose(&self, time_s: S) -> Pose<S> {
        let velocity_m_s = self.velocity_m_s;
        Pose { position_m: scale(velocity_m_s, time_s), velocity_m_s, ..Pose::START }
    }

    fn keeps_attitude(&self) -> bool {
        true
    }

    fn constant_rates(&self) -> Option<[[S; 3]; 2]> {
        Some([self.velocity_m_s, [S::ZERO; 3]])
    }

    fn gravity(&self) -> [S; 3] {
        self.gravity
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawTranslation<S> {
    velocity_m_s: [S; 3],
    gravity: [S; 3],
}

#[cfg(feature = "serde")]
impl<S: Scalar> TryFrom<RawTranslation<S>> for Translation<S> {
    type Error = ParameterError;

    fn try_from(raw: RawTranslation<S>) -> Result<Self, ParameterError> {
        Self::new(raw.velocity_m_s, raw.gravity)
    }
}
