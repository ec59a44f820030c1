//! [`MotionBlur`]: the exposure and the lens's own blur.

use crate::error::ParameterError;
use crate::scalar::Scalar;

/// The exposure and the lens's own blur. With them the blur of an edge becomes a measurement of its motion, which tells
/// a leaning edge from a moving one.
///
/// A moving edge is smeared over its path during the exposure, whatever its lean; a slope without that blur is a lean.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionBlur<S> {
    /// Exposure of a row in seconds.
    pub exposure_s: S,
    /// One sigma of the lens's own blur in pixels, without that of the pixel itself.
    pub lens_blur_px: S,
    /// One standard deviation of `lens_blur_px`, in pixels.
    pub sigma_lens_blur_px: S,
    /// How far the width of an edge can be trusted: one sigma of ln(measured / expected width), 0 to 10. `None`: 0.02 where
    /// [`Response::Linear`](crate::Response::Linear) is stated, else 0.25, since what a camera does to its pixels
    /// changes widths by 5 to 50 %, and more where an edge's levels overshoot, as sharpening makes them. What a camera
    /// does is common to all edges of a frame: from 0.25 on, a width may refuse a slope as
    /// [`Leaning`](crate::RangeStatus::Leaning), but takes no part in the depth.
    pub sigma_blur: Option<S>,
}

impl<S: Scalar> MotionBlur<S> {
    /// A known exposure and an unknown lens, whose blur is taken to be anywhere from 0.5 to 1.0 px.
    #[must_use]
    pub fn from_exposure(exposure_s: S) -> Self {
        Self { exposure_s, lens_blur_px: S::ratio(3, 4), sigma_lens_blur_px: S::ratio(144, 1000), sigma_blur: None }
    }

    /// A known exposure and a calibrated lens, whose blur is known to 5 %.
    #[must_use]
    pub fn from_calibrated_lens(exposure_s: S, lens_blur_px: S) -> Self {
        Self { exposure_s, lens_blur_px, sigma_lens_blur_px: lens_blur_px * S::ratio(1, 20), sigma_blur: None }
    }

    /// The same with a stated [`sigma_blur`](Self::sigma_blur).
    #[must_use]
    pub const fn with_sigma_blur(mut self, sigma_blur: S) -> Self {
        self.sigma_blur = Some(sigma_blur);
        self
    }

    /// The same with another [`lens_blur_px`](Self::lens_blur_px).
    #[must_use]
    pub const fn with_lens_blur_px(mut self, lens_blur_px: S) -> Self {
        self.lens_blur_px = lens_blur_px;
        self
    }

    /// The same with another [`sigma_lens_blur_px`](Self::sigma_lens_blur_px).
    #[must_use]
    pub const fn with_sigma_lens_blur_px(mut self, sigma_lens_blur_px: S) -> Self {
        self.sigma_lens_blur_px = sigma_lens_blur_px;
        self
    }

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let parameters = [
            ("exposure_s", self.exposure_s, 60),
            ("lens_blur_px", self.lens_blur_px, 1000),
            ("sigma_lens_blur_px", self.sigma_lens_blur_px, 1000),
        ];
        match parameters.into_iter().find(|(_, value, most)| !(*value >= S::ZERO && *value <= S::from_i32(*most))) {
            Some((name, value, _)) => Err(ParameterError::new(name, value.to_f64(), "0 to 60 s, or 0 to 1000 px")),
            None => self.check_sigma_blur(),
        }
    }

    fn check_sigma_blur(&self) -> Result<(), ParameterError> {
        match self.sigma_blur {
            Some(sigma) if !(sigma >= S::ZERO && sigma <= S::from_i32(10)) => {
                Err(ParameterError::new("sigma_blur", sigma.to_f64(), "0 to 10 (sigma of a logarithm)"))
            }
            _ => Ok(()),
        }
    }
}
