//! [`Setup`]: everything that stays the same from frame to frame, checked once.

use super::camera::Camera;
use super::limits::Limits;
use super::motion_blur::MotionBlur;
use super::readout::Readout;
use super::uncertainty::Uncertainty;
use crate::error::ParameterError;
use crate::scalar::Scalar;

/// Camera, readout, uncertainty and limits that fit together.
///
/// The motion is not part of it: it is measured anew for every frame, and has its own check ([`Twist::new`](crate::Twist::new)).
///
/// ```
/// use shutter_range::{Camera, Distortion, Intrinsics, Limits, Readout, ReadoutDirection, Setup, Uncertainty};
/// let camera = Camera::new(Intrinsics::centred(640, 480, 600.0_f32), Distortion::NONE)?;
/// let readout = Readout::from_frame_readout_ns(480, 33_300_000, ReadoutDirection::TopToBottom)?;
/// let setup = Setup::new(camera, readout, Uncertainty::default(), Limits::default())?;
/// assert_eq!(setup.readout().rows(), 480);
/// # Ok::<(), shutter_range::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "RawSetup<S>"))]
#[cfg_attr(feature = "serde", serde(bound(deserialize = "S: Scalar + serde::Deserialize<'de>")))]
pub struct Setup<S> {
    camera: Camera<S>,
    readout: Readout,
    uncertainty: Uncertainty<S>,
    limits: Limits,
    motion_blur: Option<MotionBlur<S>>,
}

impl<S: Scalar> Setup<S> {
    /// Checks that the parts are sound and belong together.
    ///
    /// *Errors*: camera and readout with different numbers of rows; a sigma that is negative, not finite or above 1;
    /// limits out of range.
    pub fn new(
        camera: Camera<S>,
        readout: Readout,
        uncertainty: Uncertainty<S>,
        limits: Limits,
    ) -> Result<Self, ParameterError> {
        if readout.rows() != camera.intrinsics().rows {
            let expected = "the number of rows of the camera's image";
            return Err(ParameterError::new("rows of the readout", f64::from(readout.rows()), expected));
        }
        uncertainty.check()?;
        limits.check()?;
        Ok(Self { camera, readout, uncertainty, limits, motion_blur: None })
    }

    /// The same with a known exposure: edges whose blur contradicts their slope are then
    /// [`Inconsistent`](crate::RangeStatus::Inconsistent).
    ///
    /// *Errors*: an exposure or a blur that is negative, not finite, or beyond 60 s and 1000 px.
    pub fn with_motion_blur(self, motion_blur: MotionBlur<S>) -> Result<Self, ParameterError> {
        motion_blur.check()?;
        Ok(Self { motion_blur: Some(motion_blur), ..self })
    }

    /// The same with other limits.
    ///
    /// *Errors*: limits out of range.
    pub fn with_limits(self, limits: Limits) -> Result<Self, ParameterError> {
        limits.check()?;
        Ok(Self { limits, ..self })
    }

    /// The camera.
    #[must_use]
    pub const fn camera(&self) -> &Camera<S> {
        &self.camera
    }

    /// The readout.
    #[must_use]
    pub const fn readout(&self) -> &Readout {
        &self.readout
    }

    /// What is known how well.
    #[must_use]
    pub const fn uncertainty(&self) -> &Uncertainty<S> {
        &self.uncertainty
    }

    /// What is known of the blur, if anything.
    #[must_use]
    pub const fn motion_blur(&self) -> Option<&MotionBlur<S>> {
        self.motion_blur.as_ref()
    }

    /// Limits of the tracker.
    #[must_use]
    pub const fn limits(&self) -> &Limits {
        &self.limits
    }
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(bound(deserialize = "S: Scalar + serde::Deserialize<'de>"))]
struct RawSetup<S> {
    camera: Camera<S>,
    readout: Readout,
    uncertainty: Uncertainty<S>,
    limits: Limits,
    motion_blur: Option<MotionBlur<S>>,
}

#[cfg(feature = "serde")]
impl<S: Scalar> TryFrom<RawSetup<S>> for Setup<S> {
    type Error = ParameterError;

    fn try_from(raw: RawSetup<S>) -> Result<Self, ParameterError> {
        let setup = Self::new(raw.camera, raw.readout, raw.uncertainty, raw.limits)?;
        raw.motion_blur.map_or(Ok(setup), |blur| setup.with_motion_blur(blur))
    }
}
