//! [`Uncertainty`]: how well tilt, gravity, motion, readout and focal length are known.

use crate::error::ParameterError;
use crate::scalar::{Scalar, hypot, over};

/// How well everything is known that a frame does not measure: one standard deviation each.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Uncertainty<S> {
    /// Lean of each edge in the image plane, as a slope (radians). In one frame nothing but this prior tells a leaning
    /// edge from a near one. 0.1° is what the paper's field test shows; masonry and poles lean by 0.1 to 0.3°, the
    /// sides of tapered lamp posts by 0.35°, garden fences by 1°. An edge that leans by more than four times as much is
    /// `Leaning`. Zero: every edge is taken to be upright.
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
    /// How far edges wander from a straight line, one standard deviation in pixels, alike over some sixteen rows. What
    /// a line shows beyond it is added by itself; this is the floor. 0.03 px unless you know better; zero means that
    /// edges are straight.
    pub edge_roughness_px: S,
    /// The time between two frames of a sequence, in seconds. 0.1 ms unless you know better. Zero: none is ever lost,
    /// late or early. Otherwise the second frame that shows an edge tells its depth to a third at best by parallax,
    /// unless other edges show that the time was right.
    pub sigma_time_s: S,
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
        edge_roughness_px: S::ZERO,
        sigma_time_s: S::ZERO,
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

    /// The same with another [`sigma_time_s`](Self::sigma_time_s).
    #[must_use]
    pub const fn with_sigma_time_s(mut self, sigma_time_s: S) -> Self {
        self.sigma_time_s = sigma_time_s;
        self
    }

    /// The same with another [`edge_roughness_px`](Self::edge_roughness_px).
    #[must_use]
    pub const fn with_edge_roughness_px(mut self, edge_roughness_px: S) -> Self {
        self.edge_roughness_px = edge_roughness_px;
        self
    }

    /// The same with another [`sigma_focal`](Self::sigma_focal).
    #[must_use]
    pub const fn with_sigma_focal(mut self, sigma_focal: S) -> Self {
        self.sigma_focal = sigma_focal;
        self
    }

    /// Whether edges may be tilted.
    pub(crate) fn allows_tilt(&self) -> bool {
        self.sigma_tilt > S::ZERO || self.sigma_gravity > S::ZERO
    }

    /// Sigma of the tilt of an edge at a bearing: its own lean, the camera's roll, and what the camera's pitch makes of
    /// the bearing.
    #[inline(never)] // several places ask for it
    pub(crate) fn sigma_tilt_at(&self, bearing: S, gravity: [S; 3]) -> S {
        if self.sigma_gravity == S::ZERO {
            return self.sigma_tilt;
        }
        let gravity = hypot(self.sigma_gravity, self.sigma_gravity * tilt_per_pitch(bearing, gravity));
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
            ("edge_roughness_px", self.edge_roughness_px),
            ("sigma_time_s", self.sigma_time_s),
        ];
        match parameters.into_iter().find(|(_, sigma)| !(*sigma >= S::ZERO && *sigma <= S::ONE)) {
            Some((name, sigma)) => Err(ParameterError::new(name, sigma.to_f64(), "0 to 1")),
            None => Ok(()),
        }
    }
}

/// Lean in the image of an upright edge at a bearing for a unit change of gravity towards the scene: (n · f)/(n · e) with
/// n = (a, 0, 1) × g, e across gravity in the image plane and f = e × g. For a level camera that is −a.
pub(crate) fn tilt_per_pitch<S: Scalar>(bearing: S, [x, y, z]: [S; 3]) -> S {
    -(bearing * y) * over((x * x).plus_product(y, y) - bearing * x * z)
}

impl<S: Scalar> Default for Uncertainty<S> {
    /// What a careful amateur knows: edges upright to 0.1° and straight to 0.03 px, speed to 2 %, readout and focal
    /// length to 1 %, the time between frames to 0.1 ms if none is lost; gravity and rotation exactly.
    fn default() -> Self {
        Self {
            sigma_tilt: S::ratio(1_745, 1_000_000),
            sigma_speed: S::ratio(2, 100),
            sigma_readout: S::ratio(1, 100),
            sigma_focal: S::ratio(1, 100),
            edge_roughness_px: S::ratio(3, 100),
            sigma_time_s: S::ratio(1, 10_000),
            ..Self::NONE
        }
    }
}
