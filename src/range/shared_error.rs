//! [`SharedError`]: an error that all samples of an edge share. docs/model.md, section 6.

use super::line3::Line3;
use super::observation::Observation;
use crate::scalar::{Scalar, cross, dot, on_axis};
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
    pub(crate) fn sigma<S: Scalar>(self, setup: &Setup<S>, bearing: S) -> S {
        let uncertainty = setup.uncertainty();
        match self {
            Self::Tilt => uncertainty.sigma_tilt_at(bearing),
            Self::Lens => setup.motion_blur().map_or(S::ZERO, |blur| blur.sigma_lens_blur_px),
            Self::Speed => uncertainty.sigma_speed,
            Self::Rate(_) => uncertainty.sigma_rate_rad_s,
            Self::Readout => uncertainty.sigma_readout,
            Self::Focal => uncertainty.sigma_focal,
        }
    }

    /// An error of this kind alone.
    pub(crate) fn alone<S: Scalar>(self, error: S) -> [S; SHARED_ERRORS] {
        Self::ALL.map(|cause| if cause == self { error } else { S::ZERO })
    }

    /// Whether the noise of the prior equations includes it already.
    pub(super) fn is_in_prior(self) -> bool {
        matches!(self, Self::Tilt | Self::Lens)
    }

    /// What a unit error adds to y = −F/m_x of an observation.
    pub(super) fn error<S: Scalar>(self, observation: &Observation<S>, line3: &Line3<S>) -> S {
        let still = [S::ZERO; 3];
        let (direction, position) = match self {
            Self::Tilt | Self::Lens => return S::ZERO,
            Self::Speed => (still, observation.position),
            Self::Rate(axis) => (cross(on_axis(axis, observation.time_s), observation.direction), still),
            Self::Readout => (cross(observation.turned, observation.direction), observation.advanced),
            Self::Focal => (observation.off_axis, still),
        };
        let down = line3.direction();
        let m = cross(observation.direction, down);
        let [mx, _, _] = m;
        let turned = line3.offset(cross(direction, down), observation);
        (line3.inverse_depth * dot(m, position) - turned) / mx
    }
}
