//! [`Setup`]: everything that stays the same from frame to frame, checked once.

use crate::scalar::hypot;
use crate::{Camera, ParameterError, Readout, Scalar};

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

    fn check(&self) -> Result<(), ParameterError> {
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

/// What the tracker takes for one edge, and how long a line must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Limits {
    /// Steepest slope that a line may begin with, in 1/65536 px of column per row.
    pub max_slope_q16: u32,
    /// How far an edge may lie from the column that a young line predicts, beyond four sigma of its noise, in 1/65536 px;
    /// an eighth of it where the line has 64 edges. Of pixels, no farther than four times as far as the line's edges scatter.
    pub gate_q16: u32,
    /// Edges after which a tentative line is confirmed.
    pub confirm_edges: u16,
    /// Rows in a row without an edge after which a tentative line is dropped.
    pub tentative_gap_rows: u16,
    /// Rows in a row without an edge after which a confirmed line ends; two more for each edge it has, or one for every two where
    /// its edges are somebody's own.
    pub gap_rows: u16,
    /// A line of fewer edges is `short`.
    pub min_edges: u16,
}

impl Limits {
    /// Up to one pixel per row; 2 px of gate; confirmed after 5 edges, over gaps of 2 rows, later 12; 8 edges make a range.
    pub const DEFAULT: Self = Self {
        max_slope_q16: 1 << 16,
        gate_q16: 2 << 16,
        confirm_edges: 5,
        tentative_gap_rows: 2,
        gap_rows: 12,
        min_edges: 8,
    };

    fn check(&self) -> Result<(), ParameterError> {
        let wide = |name, value: u32| {
            let most = 1024 << 16;
            let expected = "at most 1024 px, in 1/65536 px";
            if value > most { Err(ParameterError::new(name, f64::from(value), expected)) } else { Ok(()) }
        };
        wide("max_slope_q16", self.max_slope_q16)?;
        wide("gate_q16", self.gate_q16)?;
        for (name, value, least) in [("confirm_edges", self.confirm_edges, 2), ("min_edges", self.min_edges, 3)] {
            if value < least {
                return Err(ParameterError::new(name, f64::from(value), "at least 2 to confirm, 3 for a range"));
            }
        }
        Ok(())
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// What is known of the blur of edges: with it, motion blur bears witness against leaning edges.
///
/// A moving edge is smeared over its path during the exposure, whatever its lean; a slope without that blur is a lean.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotionBlur<S> {
    /// Exposure of a row in seconds.
    pub exposure_s: S,
    /// One sigma of the lens's own blur in pixels, without that of the pixel itself.
    pub lens_blur_px: S,
    /// How well the lens's blur is known, one standard deviation in pixels.
    pub sigma_lens_blur_px: S,
}

impl<S: Scalar> MotionBlur<S> {
    /// A known exposure and a lens of which nothing is known: 0.5 to 1.0 px.
    #[must_use]
    pub fn of_exposure(exposure_s: S) -> Self {
        Self { exposure_s, lens_blur_px: S::ratio(3, 4), sigma_lens_blur_px: S::ratio(144, 1000) }
    }

    /// A known exposure and a calibrated lens, good to 5 %.
    #[must_use]
    pub fn of_lens(exposure_s: S, lens_blur_px: S) -> Self {
        Self { exposure_s, lens_blur_px, sigma_lens_blur_px: lens_blur_px * S::ratio(1, 20) }
    }

    fn check(&self) -> Result<(), ParameterError> {
        let parameters = [
            ("exposure_s", self.exposure_s, 60),
            ("lens_blur_px", self.lens_blur_px, 1000),
            ("sigma_lens_blur_px", self.sigma_lens_blur_px, 1000),
        ];
        match parameters.into_iter().find(|(_, value, most)| !(*value >= S::ZERO && *value <= S::from_i32(*most))) {
            Some((name, value, _)) => Err(ParameterError::new(name, value.to_f64(), "0 to 60 s, or 0 to 1000 px")),
            None => Ok(()),
        }
    }
}

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
