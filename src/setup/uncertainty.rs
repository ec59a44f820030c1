//! [`Uncertainty`]: how well the things that a frame cannot tell are known.

use crate::error::ParameterError;
use crate::scalar::{Scalar, hypot};

/// How well the things that a frame cannot tell are known: one standard deviation each.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Uncertainty<S> {
    /// Lean of each edge in the image plane, as a slope (radians). In one frame nothing but this prior tells a leaning
    /// edge from a near one; 0.1° is what the paper's field test shows. Zero: every edge is taken to be upright.
    pub sigma_tilt: S,
    /// Direction of gravity, roll and pitch alike, in radians.
    pub sigma_gravity: S,
    /// Speed, relative.
    pub sigma_speed: S,
    /// Rotation rate about each axis, in rad/s.
    pub sigma_rate_rad_s: S,
    /// Readout time, relative.
    pub sigma_readout: S,
    /// Focal length, relative.
    pub sigma_focal: S,
}

impl<S: Scalar> Uncertainty<S> {
    /// Everything known exactly, pixel noise apart.
    pub const NONE: Self = Self {
        sigma_tilt: S::ZERO,
        sigma_gravity: S::ZERO,
        sigma_speed: S::ZERO,
        sigma_rate_rad_s: S::ZERO,
        sigma_readout: S::ZERO,
        sigma_focal: S::ZERO,
    };

    /// Of the tilt of an edge at a bearing: its own lean, the camera's roll, and its pitch, which enters with the bearing.
    pub(crate) fn sigma_tilt_at(&self, bearing: S) -> S {
        let gravity = hypot(self.sigma_gravity, self.sigma_gravity * bearing);
        hypot(self.sigma_tilt, gravity)
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let parameters = [
            ("sigma_tilt", self.sigma_tilt),
            ("sigma_gravity", self.sigma_gravity),
            ("sigma_speed", self.sigma_speed),
            ("sigma_rate_rad_s", self.sigma_rate_rad_s),
            ("sigma_readout", self.sigma_readout),
            ("sigma_focal", self.sigma_focal),
        ];
        match parameters.into_iter().find(|(_, sigma)| !(*sigma >= S::ZERO && *sigma <= S::ONE)) {
            Some((name, sigma)) => Err(ParameterError::new(name, sigma.to_f64(), "0 to 1")),
            None => Ok(()),
        }
    }
}

impl<S: Scalar> Default for Uncertainty<S> {
    /// A tilt of 0.1°, all else exact.
    fn default() -> Self {
        Self { sigma_tilt: S::ratio(1_745, 1_000_000), ..Self::NONE }
    }
}
