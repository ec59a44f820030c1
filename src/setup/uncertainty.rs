//! [`Uncertainty`]: how well tilt, gravity, motion, readout and focal length are known.

use crate::error::ParameterError;
use crate::scalar::{Scalar, hypot};

/// How well everything is known that a frame does not measure: one standard deviation each.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Uncertainty<S> {
    /// Lean of each edge in the image plane, as a slope (radians). In a single frame without a known exposure, nothing but
    /// this prior tells a leaning edge from a near one; 0.1° is what the paper's field test shows. Zero: every edge is
    /// taken to be upright.
    pub sigma_tilt: S,
    /// Direction of gravity, in roll and in pitch, in radians.
    pub sigma_gravity: S,
    /// Relative error of the speed.
    pub sigma_speed: S,
    /// Rotation rate about each axis, in rad/s.
    pub sigma_rate_rad_s: S,
    /// Relative error of the readout time.
    pub sigma_readout: S,
    /// Relative error of the focal length.
    pub sigma_focal: S,
}

impl<S: Scalar> Uncertainty<S> {
    /// All known exactly but the columns, whose noise each point states.
    pub const NONE: Self = Self {
        sigma_tilt: S::ZERO,
        sigma_gravity: S::ZERO,
        sigma_speed: S::ZERO,
        sigma_rate_rad_s: S::ZERO,
        sigma_readout: S::ZERO,
        sigma_focal: S::ZERO,
    };

    /// The same with another [`sigma_tilt`](Self::sigma_tilt).
    #[must_use]
    pub const fn with_sigma_tilt(mut self, sigma_tilt: S) -> Self {
        self.sigma_tilt = sigma_tilt;
        self
    }

    /// The same with another [`sigma_gravity`](Self::sigma_gravity).
    #[must_use]
    pub const fn with_sigma_gravity(mut self, sigma_gravity: S) -> Self {
        self.sigma_gravity = sigma_gravity;
        self
    }

    /// The same with another [`sigma_speed`](Self::sigma_speed).
    #[must_use]
    pub const fn with_sigma_speed(mut self, sigma_speed: S) -> Self {
        self.sigma_speed = sigma_speed;
        self
    }

    /// The same with another [`sigma_rate_rad_s`](Self::sigma_rate_rad_s).
    #[must_use]
    pub const fn with_sigma_rate_rad_s(mut self, sigma_rate_rad_s: S) -> Self {
        self.sigma_rate_rad_s = sigma_rate_rad_s;
        self
    }

    /// The same with another [`sigma_readout`](Self::sigma_readout).
    #[must_use]
    pub const fn with_sigma_readout(mut self, sigma_readout: S) -> Self {
        self.sigma_readout = sigma_readout;
        self
    }

    /// The same with another [`sigma_focal`](Self::sigma_focal).
    #[must_use]
    pub const fn with_sigma_focal(mut self, sigma_focal: S) -> Self {
        self.sigma_focal = sigma_focal;
        self
    }

    /// Sigma of the tilt of an edge at a bearing: its own lean, the camera's roll, and bearing times the camera's pitch.
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
    /// 0.1° of tilt, and all else exact.
    fn default() -> Self {
        Self { sigma_tilt: S::ratio(1_745, 1_000_000), ..Self::NONE }
    }
}
