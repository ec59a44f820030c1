//! [`CameraMode`]: a camera in one of its modes, and the noise of its pixels.

use super::target::Target;
use super::tuning::EXCESS;
use crate::edge::{PLATEAU, SpreadFunction};
use crate::error::ParameterError;
use crate::scalar::Scalar;
use crate::setup::Setup;

/// Noise of pixels in grey levels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PixelNoise<S> {
    /// Read noise, one sigma, 0 to 100.
    pub read_noise: S,
    /// Variance of shot noise per grey level, 0 to 100.
    pub shot_gain: S,
}

impl<S: Scalar> Default for PixelNoise<S> {
    /// A small sensor in usual light: 2.5 levels, and 0.03 per level.
    fn default() -> Self {
        Self { read_noise: S::ratio(5, 2), shot_gain: S::ratio(3, 100) }
    }
}

/// A camera in one of its modes: what a [`Setup`] says of it, and the noise of its pixels.
///
/// Exposure and lens are those of the setup's [`MotionBlur`](crate::MotionBlur); without it, edges are taken to be
/// sharp but for a usual lens.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CameraMode<S> {
    setup: Setup<S>,
    noise: PixelNoise<S>,
}

/// What a row tells of an edge.
#[derive(Clone, Copy)]
pub(super) struct EdgeLook<S> {
    /// Blur in pixels, one sigma, that of the pixel itself included.
    pub(super) width_px: S,
    /// Sigma of the column in pixels.
    pub(super) sigma_px: S,
    /// Whether a row shows it by itself.
    pub(super) is_seen: bool,
}

impl<S: Scalar> CameraMode<S> {
    /// *Errors*: a noise outside its limits.
    pub fn new(setup: Setup<S>, noise: PixelNoise<S>) -> Result<Self, ParameterError> {
        for (name, value) in [("read_noise", noise.read_noise), ("shot_gain", noise.shot_gain)] {
            if !(value >= S::ZERO && value <= S::from_i32(100)) {
                return Err(ParameterError::new(name, value.to_f64(), "0 to 100 (grey levels)"));
            }
        }
        Ok(Self { setup, noise })
    }

    /// What is known of the camera.
    #[must_use]
    pub const fn setup(&self) -> &Setup<S> {
        &self.setup
    }

    /// Exposure in seconds; zero where it is not known.
    pub(super) fn exposure_s(&self) -> S {
        self.setup.motion_blur().map_or(S::ZERO, |blur| blur.exposure_s)
    }

    /// An edge of a target that is `object_px` wide, smeared over a path.
    ///
    /// *Source*: docs/model.md, sections 5.3, 7.1 and 7.4.
    pub(super) fn look(&self, target: &Target<S>, path_px: S, object_px: S) -> EdgeLook<S> {
        let lens_px = self.setup.motion_blur().map_or(S::ratio(3, 4), |blur| blur.lens_blur_px);
        let width_px = (lens_px * lens_px + (S::ONE + path_px * path_px) * S::ratio(1, 12)).sqrt();
        let (read, contrast) = (self.noise.read_noise, target.contrast().max(S::ratio(1, 256)));
        let noise = (read * read + self.noise.shot_gain * target.mean_level() + S::ratio(1, 12)).sqrt();
        // ΣS² of the slope S of a Gaussian is 1/(2 √π σ); of a box of the same width it is 2 % more.
        let per_slope_square = S::ratio(35_449, 10_000) * width_px;
        let per_plateau = |pixels: S| per_slope_square * per_slope_square * S::ratio(1, 4) / pixels;
        let [own, behind] = plateaus(width_px, object_px);
        let variance = per_slope_square + per_plateau(own) + per_plateau(behind);
        // Windows of four pixels side by side must differ by four sigma of their difference, and by six levels.
        let shown = contrast * (S::from_i32(4) / path_px.abs().max(S::from_i32(4)));
        let least = (noise * S::ratio(283, 100)).max(S::from_i32(6));
        EdgeLook {
            width_px,
            sigma_px: noise / contrast * variance.sqrt() * S::ratio(EXCESS.0, EXCESS.1),
            is_seen: shown > least,
        }
    }
}

/// How many pixels tell the level of an object so wide, and that behind it.
fn plateaus<S: Scalar>(width_px: S, object_px: S) -> [S; 2] {
    let width_q8 = (width_px.to_f64() * 256.0) as u16;
    let reach_px = S::ratio(SpreadFunction::new(width_q8).reach_q8(), 256);
    let far = reach_px + S::from_i32(PLATEAU);
    // Up to where the other edge's blur begins, or half the way to it.
    let view = (object_px - reach_px).max(object_px * S::ratio(1, 2));
    let own = (view - reach_px).max(S::ONE).min(far);
    [own, far]
}
