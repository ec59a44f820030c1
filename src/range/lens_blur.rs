//! [`LensBlur`]: the lens's own blur, learned from the edges that pass.

use super::blur::LensBlurMeasurement;
use super::range::Range;
use super::status::RangeStatus;
use crate::scalar::{Scalar, hypot};
use crate::setup::MotionBlur;

/// The lens's own blur, estimated from the edges seen so far, starting from a prior.
///
/// Edges that hardly move during the exposure, or whose depth is known from several frames, show the lens's blur; once
/// that is known, the blur of other edges measures their motion.
///
/// ```
/// use shutter_range::{LensBlur, MotionBlur};
/// let mut lens = LensBlur::new(MotionBlur::from_exposure(0.008_f32));
/// // For each range: lens.learn(&range);
/// // For the next frame: setup.with_motion_blur(lens.motion_blur())?;
/// assert_eq!(lens.motion_blur().lens_blur_px, 0.75);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LensBlur<S> {
    known: MotionBlur<S>,
    variance_px2: S,
    sigma_px2: S,
}

impl<S: Scalar> LensBlur<S> {
    /// Starts from a prior: [`MotionBlur::from_exposure`] where nothing is known of the lens.
    #[must_use]
    pub fn new(known: MotionBlur<S>) -> Self {
        let lens = known.lens_blur_px.max(S::ratio(1, 10));
        let sigma_px2 = (lens + lens) * known.sigma_lens_blur_px;
        Self { known, variance_px2: lens * lens, sigma_px2 }
    }

    /// Takes in what a range says of the lens, if anything. A range more than four sigma off is left out.
    ///
    /// Sigma stays above a twentieth of the blur: no lens is equally sharp everywhere.
    pub fn learn(&mut self, range: &Range<S>) {
        let upright = matches!(range.status, RangeStatus::Ok | RangeStatus::Far);
        let Some(LensBlurMeasurement { variance_px2, sigma_px2 }) = range.lens_blur.filter(|_| upright) else { return };
        let off = variance_px2 - self.variance_px2;
        let joint = hypot(self.sigma_px2, sigma_px2);
        if !(joint > S::ZERO && off.abs() <= joint * S::from_i32(4)) {
            return;
        }
        let part = self.sigma_px2 / joint;
        self.variance_px2 = (self.variance_px2 + off * part * part).max(S::ratio(1, 100));
        // Twice a twentieth of the variance, which is a square.
        self.sigma_px2 = (sigma_px2 * part).max(self.variance_px2 * S::ratio(1, 10)).min(self.sigma_px2);
    }

    /// The current estimate.
    #[must_use]
    pub fn motion_blur(&self) -> MotionBlur<S> {
        let lens_blur_px = self.variance_px2.sqrt();
        let sigma_lens_blur_px = self.sigma_px2 / (lens_blur_px + lens_blur_px);
        self.known.with_lens_blur_px(lens_blur_px).with_sigma_lens_blur_px(sigma_lens_blur_px)
    }
}
