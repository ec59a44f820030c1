//! [`Twist`]: constant velocity and constant rotation rate.

use super::checked::{checked_direction, checked_rate, checked_velocity};
use super::motion::{Motion, Pose};
use super::rotation::Rotation;
use crate::error::ParameterError;
use crate::scalar::{Scalar, scale};

/// Constant velocity and constant rotation rate.
///
/// For a camera that stands still before a moving object, give the opposite of the object's velocity.
///
/// ```
/// use shutter_range::{Motion, Twist};
/// // To the right at 1.5 m/s, turning left at 0.1 rad/s, level.
/// let motion = Twist::new([1.5, 0.0, 0.0], [0.0, -0.1, 0.0], [0.0, 1.0, 0.0])?;
/// assert_eq!(motion.pose(0.01).position_m, [0.015, 0.0, 0.0]);
/// # Ok::<(), shutter_range::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "RawTwist<S>"))]
#[cfg_attr(feature = "serde", serde(bound(deserialize = "S: Scalar + serde::Deserialize<'de>")))]
pub struct Twist<S> {
    velocity_m_s: [S; 3],
    rate_rad_s: [S; 3],
    gravity: [S; 3],
}

impl<S: Scalar> Twist<S> {
    /// From the camera's velocity (m/s) and rotation rate (rad/s), and the direction of gravity, all in the camera's
    /// axes at frame start. Rates are right-handed: a positive one about x turns the view up, about y to the right,
    /// about z rolls the camera clockwise. Of gravity only the direction counts; an accelerometer at rest shows its
    /// opposite.
    ///
    /// *Errors*: a component that is not finite or beyond 10000 m/s and 1000 rad/s; a gravity shorter than 0.001 or with a
    /// component beyond 10⁶.
    pub fn new(velocity_m_s: [S; 3], rate_rad_s: [S; 3], gravity: [S; 3]) -> Result<Self, ParameterError> {
        Ok(Self {
            velocity_m_s: checked_velocity(velocity_m_s)?,
            rate_rad_s: checked_rate(rate_rad_s)?,
            gravity: checked_direction(gravity)?,
        })
    }

    /// A level camera that moves without turning.
    ///
    /// *Errors*: as [`Twist::new`].
    pub fn level(velocity_m_s: [S; 3]) -> Result<Self, ParameterError> {
        Self::new(velocity_m_s, [S::ZERO; 3], [S::ZERO, S::ONE, S::ZERO])
    }

    /// Velocity in m/s.
    #[must_use]
    pub const fn velocity_m_s(&self) -> [S; 3] {
        self.velocity_m_s
    }

    /// Rotation rate in rad/s.
    #[must_use]
    pub const fn rate_rad_s(&self) -> [S; 3] {
        self.rate_rad_s
    }
}

impl<S: Scalar> Motion<S> for Twist<S> {
    fn pose(&self, time_s: S) -> Pose<S> {
        let rotation = if self.keeps_attitude() {
            Pose::START.rotation
        } else {
            Rotation::from_vector(scale(self.rate_rad_s, time_s)).matrix()
        };
        let (velocity_m_s, rate_rad_s) = (self.velocity_m_s, self.rate_rad_s);
        Pose { position_m: scale(velocity_m_s, time_s), rotation, velocity_m_s, rate_rad_s }
    }

    fn keeps_attitude(&self) -> bool {
        self.rate_rad_s.into_iter().all(|rate| rate == S::ZERO)
    }

    fn constant_rates(&self) -> Option<[[S; 3]; 2]> {
        Some([self.velocity_m_s, self.rate_rad_s])
    }

    fn gravity(&self) -> [S; 3] {
        self.gravity
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawTwist<S> {
    velocity_m_s: [S; 3],
    rate_rad_s: [S; 3],
    gravity: [S; 3],
}

#[cfg(feature = "serde")]
impl<S: Scalar> TryFrom<RawTwist<S>> for Twist<S> {
    type Error = ParameterError;

    fn try_from(raw: RawTwist<S>) -> Result<Self, ParameterError> {
        Self::new(raw.velocity_m_s, raw.rate_rad_s, raw.gravity)
    }
}
