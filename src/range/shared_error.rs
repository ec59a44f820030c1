//! [`SharedError`]: an error that all samples of an edge share. docs/model.md, section 6.

use crate::scalar::Scalar;
use crate::setup::Setup;

/// Something that is assumed, and may be wrong in the same way for all samples of an edge.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum SharedError {
    /// The tilt of the prior: the edge's own lean and the direction of gravity.
    Tilt,
    /// The lens's own blur, in pixels.
    Lens,
    /// Relative error of the speed.
    Speed,
    /// Rotation about one of the camera's axes, in rad/s.
    Rate(usize),
    /// Relative error of the readout time.
    Readout,
    /// Relative error of the focal length.
    Focal,
}

pub(crate) const SHARED_ERRORS: usize = 8;

impl SharedError {
    pub(crate) const ALL: [Self; SHARED_ERRORS] =
        [Self::Tilt, Self::Lens, Self::Speed, Self::Rate(0), Self::Rate(1), Self::Rate(2), Self::Readout, Self::Focal];

    /// One standard deviation, for an edge at a bearing.
    pub(crate) fn sigma<S: Scalar>(self, setup: &Setup<S>, bearing: S, gravity: [S; 3]) -> S {
        let uncertainty = setup.uncertainty();
        match self {
            Self::Tilt => uncertainty.sigma_tilt_at(bearing, gravity),
            Self::Lens => setup.motion_blur().map_or(S::ZERO, |blur| blur.sigma_lens_blur_px),
            Self::Speed => uncertainty.sigma_speed,
            Self::Rate(_) => uncertainty.sigma_rate_rad_s,
            Self::Readout => uncertainty.sigma_readout,
            Self::Focal => uncertainty.sigma_focal,
        }
    }

    /// Whether the noise of the prior equations includes it already.
    pub(super) fn is_in_prior(self) -> bool {
        matches!(self, Self::Tilt | Self::Lens)
    }
}
