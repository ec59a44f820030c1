//! [`RaySpans`]: the rays of stretches of pixels along a line, one after the other.

use super::camera::Camera;
use super::lens_spans::{LensSpans, RaySpan};
use super::optics::Optics;
use crate::scalar::Scalar;

/// From stretch to stretch along a line.
pub(crate) struct RaySpans<'a, S: Scalar> {
    camera: &'a Camera<S>,
    /// `None` without distortion.
    optics: Option<&'a dyn Optics<S>>,
    /// What its lens has seen so far.
    lens: Option<LensSpans<'a, S>>,
}

impl<'a, S: Scalar> RaySpans<'a, S> {
    pub(crate) fn new(camera: &'a Camera<S>) -> Self {
        Self { camera, optics: camera.optics(), lens: None }
    }

    /// Of the pixels from `half` before `at` to `half` after it, both column and row; `None` where the model of the
    /// lens folds over.
    ///
    /// *Cost*: eight operations, or that of [`LensSpans::span`].
    pub(crate) fn span(&mut self, at: [S; 2], half: [S; 2]) -> Option<RaySpan<S::Near>> {
        let (recorded, [per_fx, per_fy]) = (self.camera.normalised(at[0], at[1]), self.camera.per_focal());
        let half = [half[0] * per_fx, half[1] * per_fy];
        match self.optics {
            None => Some(RaySpan::of_whole(recorded, half, [per_fx, S::ZERO])),
            Some(optics) => optics.span(&mut self.lens, self.camera.largest(), &[recorded, half], per_fx),
        }
    }
}
