//! [`Setup`]: all that stays the same from frame to frame, checked once.

use super::camera::{Camera, Intrinsics};
use super::limits::Limits;
use super::motion_blur::MotionBlur;
use super::readout::{Readout, ReadoutDirection};
use super::response::Response;
use super::stamp_policy::StampPolicy;
use super::uncertainty::Uncertainty;
use crate::error::ParameterError;
use crate::scalar::Scalar;

/// Camera, readout, uncertainty and limits that go together.
///
/// The motion is no part of it: it is measured anew for every frame and has its own check
/// ([`Twist::new`](crate::Twist::new)).
///
/// ```
/// use shutter_range::{Setup, Uncertainty};
/// // 640 × 480 pixels, a focal length of 600 px, read from the top in 33.3 ms.
/// let setup = Setup::pinhole(640, 480, 600.0_f32, 33_300_000)?;
/// let setup = setup.with_uncertainty(Uncertainty::default().with_sigma_speed(0.02))?;
/// assert_eq!(setup.readout().row_time_ns(479), 33_230_625);
/// # Ok::<(), shutter_range::ParameterError>(())
/// ```
///
/// A lens with distortion, a principal point beside the middle, or rows that are read from the bottom:
///
/// ```
/// use shutter_range::{Camera, Distortion, Intrinsics, Readout, ReadoutDirection, Setup};
/// let intrinsics = Intrinsics { cx: 310.0, ..Intrinsics::centred(640, 480, 600.0_f32) };
/// let camera = Camera::new(intrinsics, Distortion::from_opencv([-0.05, 0.01, 0.0, 0.0, 0.0]))?;
/// let readout = Readout::from_line_time_ps(480, 65_333_333, ReadoutDirection::BottomToTop)?;
/// let setup = Setup::new(camera, readout)?;
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
    response: Response,
    stamp_policy: StampPolicy,
}

impl<S: Scalar> Setup<S> {
    /// A camera and its readout, with the default [`Uncertainty`] and [`Limits`] and an unknown exposure.
    ///
    /// *Errors*: camera and readout with different numbers of rows.
    pub fn new(camera: Camera<S>, readout: Readout) -> Result<Self, ParameterError> {
        if readout.rows() != camera.intrinsics().rows {
            let expected = "the number of rows of the camera's image";
            return Err(ParameterError::of_whole("rows of the readout", readout.rows().into(), expected));
        }
        Ok(Self {
            camera,
            readout,
            uncertainty: Uncertainty::default(),
            limits: Limits::DEFAULT,
            motion_blur: None,
            response: Response::Unknown,
            stamp_policy: StampPolicy::Checked,
        })
    }

    /// The usual camera: square pixels, the principal point in the middle, no distortion, row 0 read first.
    ///
    /// `focal_px` is the focal length in pixels, `frame_readout_ns` the time from the start of the first row to that of
    /// the row after the last one: rows × line time.
    ///
    /// *Errors*: as [`Camera::new`] and [`Readout::from_frame_readout_ns`].
    pub fn pinhole(columns: u16, rows: u16, focal_px: S, frame_readout_ns: u64) -> Result<Self, ParameterError> {
        let camera = Camera::without_distortion(Intrinsics::centred(columns, rows, focal_px))?;
        Self::new(camera, Readout::from_frame_readout_ns(rows, frame_readout_ns, ReadoutDirection::TopToBottom)?)
    }

    /// The same with another uncertainty of motion, readout, camera and edges.
    ///
    /// *Errors*: a sigma that is negative, not finite or above 1.
    pub fn with_uncertainty(self, uncertainty: Uncertainty<S>) -> Result<Self, ParameterError> {
        uncertainty.check()?;
        Ok(Self { uncertainty, ..self })
    }

    /// The same with a known exposure: edges whose blur contradicts their slope are then
    /// [`Leaning`](crate::RangeStatus::Leaning).
    ///
    /// *Errors*: an exposure or a blur that is negative, not finite, or beyond 60 s and 1000 px; a
    /// [`sigma_blur`](MotionBlur::sigma_blur) outside 0 to 10.
    pub fn with_motion_blur(self, motion_blur: MotionBlur<S>) -> Result<Self, ParameterError> {
        motion_blur.check()?;
        Ok(Self { motion_blur: Some(motion_blur), ..self })
    }

    /// The same for a frame of another exposure, in seconds: automatic exposure sets it anew for each. What was stated
    /// of the lens stays; without that it is an unknown one.
    ///
    /// Range a frame with the exposure that its rows had: with most sensors one that is set counts two frames later.
    ///
    /// ```
    /// # use shutter_range::{MotionBlur, Setup};
    /// let setup = Setup::pinhole(640, 480, 600.0_f32, 33_300_000)?.with_motion_blur(MotionBlur::from_exposure(0.008))?;
    /// let darker = setup.with_exposure_s(0.016)?;
    /// assert_eq!(darker.motion_blur().map(|blur| blur.exposure_s), Some(0.016));
    /// # Ok::<(), shutter_range::ParameterError>(())
    /// ```
    ///
    /// *Errors*: as [`Setup::with_motion_blur`].
    pub fn with_exposure_s(self, exposure_s: S) -> Result<Self, ParameterError> {
        let blur = self.motion_blur.unwrap_or_else(|| MotionBlur::from_exposure(exposure_s));
        self.with_motion_blur(MotionBlur { exposure_s, ..blur })
    }

    /// The same with a known response of the pixels.
    #[must_use]
    pub fn with_response(self, response: Response) -> Self {
        Self { response, ..self }
    }

    /// The same with another way to tell the time of a row of edge points.
    #[must_use]
    pub fn with_stamp_policy(self, stamp_policy: StampPolicy) -> Self {
        Self { stamp_policy, ..self }
    }

    /// The same with other limits.
    ///
    /// *Errors*: a limit outside the range that its field states.
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

    /// How well motion, readout, camera and the edges' tilt are known.
    #[must_use]
    pub const fn uncertainty(&self) -> &Uncertainty<S> {
        &self.uncertainty
    }

    /// The exposure and the lens's blur, if they are known.
    #[must_use]
    pub const fn motion_blur(&self) -> Option<&MotionBlur<S>> {
        self.motion_blur.as_ref()
    }

    /// What tells the time of a row of edge points.
    #[must_use]
    pub const fn stamp_policy(&self) -> StampPolicy {
        self.stamp_policy
    }

    /// How grey levels follow the light.
    #[must_use]
    pub const fn response(&self) -> &Response {
        &self.response
    }

    /// How far the width of an edge can be trusted, as a sigma of its logarithm: as stated with the motion blur, or
    /// 0.02 where the pixels are stated to be linear and 0.25 where they are not.
    pub(crate) fn sigma_blur(&self) -> S {
        let stated = self.motion_blur.as_ref().and_then(|blur| blur.sigma_blur);
        stated.unwrap_or_else(|| if self.response.is_linear() { S::ratio(1, 50) } else { Self::sigma_blur_unknown() })
    }

    /// Whether widths can be trusted better than those of an unknown camera. If not, a width may refuse a slope, but
    /// takes no part in the depth: what a camera does to one edge it does to all of them.
    pub(crate) fn widths_are_known(&self) -> bool {
        self.sigma_blur() < Self::sigma_blur_unknown()
    }

    /// Sharpening, tone curves, denoising and codecs change widths by 5 to 50 %.
    fn sigma_blur_unknown() -> S {
        S::ratio(1, 4)
    }

    /// Limits of the tracker and of ranges.
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
    response: Response,
    stamp_policy: StampPolicy,
}

#[cfg(feature = "serde")]
impl<S: Scalar> TryFrom<RawSetup<S>> for Setup<S> {
    type Error = ParameterError;

    fn try_from(raw: RawSetup<S>) -> Result<Self, ParameterError> {
        let setup = Self::new(raw.camera, raw.readout)?.with_uncertainty(raw.uncertainty)?.with_limits(raw.limits)?;
        let setup = setup.with_response(raw.response).with_stamp_policy(raw.stamp_policy);
        raw.motion_blur.map_or(Ok(setup), |blur| setup.with_motion_blur(blur))
    }
}
