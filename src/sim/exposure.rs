//! [`Exposure`]: what the sensor and the lens do to an ideal image.

use super::checked::check;
use crate::error::ParameterError;

/// Exposure, blur and noise. The default is that of a small sensor in good light.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Exposure {
    /// How long each row is exposed, in seconds, 0 to 60; the row's time is the middle of it.
    pub time_s: f32,
    /// Blur of the lens, one sigma in pixels, 0 to 20. Less than 0.05 px counts as 0.05 px: behind the pixel's own box
    /// of 1 px there is no difference to see.
    pub psf_sigma_px: f32,
    /// Read noise, one sigma in grey levels, 0 to 100.
    pub read_noise: f32,
    /// Shot noise: its variance in square grey levels per grey level of brightness, 0 to 100.
    pub shot_gain: f32,
}

impl Exposure {
    /// No motion blur and no noise; 0.5 px of lens blur.
    pub const IDEAL: Self = Self { time_s: 0.0, psf_sigma_px: 0.5, read_noise: 0.0, shot_gain: 0.0 };

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        check([
            ("time_s", self.time_s, [0.0, 60.0], "0 to 60 (s)"),
            ("psf_sigma_px", self.psf_sigma_px, [0.0, 20.0], "0 to 20 (px)"),
            ("read_noise", self.read_noise, [0.0, 100.0], "0 to 100 (grey levels)"),
            ("shot_gain", self.shot_gain, [0.0, 100.0], "0 to 100 (variance per grey level)"),
        ])
    }
}

impl Default for Exposure {
    /// 2 ms, 0.7 px, 1 grey level of read noise, 0.05 of shot noise.
    fn default() -> Self {
        Self { time_s: 0.002, psf_sigma_px: 0.7, read_noise: 1.0, shot_gain: 0.05 }
    }
}
