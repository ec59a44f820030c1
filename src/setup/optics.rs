//! [`Optics`]: what a lens that distorts does to rays, by way of the camera that has one.
//!
//! A program whose cameras have no distortion never makes [`CameraOptics::DISTORTING`], so that the linker leaves out
//! what only a lens with distortion needs: 3 kB on a Cortex-M0, in fixed point 9 (`cargo xtask budget` fails where one
//! of its programs holds any of it).

use core::fmt;

use super::distortion::Distortion;
use super::lens::Mapped;
use super::lens_spans::{LensSpans, RaySpan};
use crate::scalar::{Scalar, Whole};

/// What a lens that distorts does.
pub(super) trait Optics<S> {
    /// From the ideal to the recorded point.
    fn distorted(&self, point: [S; 2]) -> Mapped<Whole<S>>;

    /// From the recorded to the ideal point; `None` where the model folds over.
    fn undistorted(&self, recorded: [S; 2]) -> Option<Mapped<Whole<S>>>;

    /// The rays of a stretch of pixels, as [`LensSpans::span`] has them; `spans` has seen those before, if there were
    /// any.
    fn span<'d>(
        &'d self,
        spans: &mut Option<LensSpans<'d, S>>,
        largest: [S; 2],
        stretch: &[[S; 2]; 2],
        per_fx: S,
    ) -> Option<RaySpan<S::Near>>
    where
        S: Scalar;
}

impl<S: Scalar> Optics<S> for Distortion<S> {
    fn distorted(&self, point: [S; 2]) -> Mapped<Whole<S>> {
        self.distort(point)
    }

    fn undistorted(&self, recorded: [S; 2]) -> Option<Mapped<Whole<S>>> {
        self.undistort(recorded)
    }

    fn span<'d>(
        &'d self,
        spans: &mut Option<LensSpans<'d, S>>,
        largest: [S; 2],
        stretch: &[[S; 2]; 2],
        per_fx: S,
    ) -> Option<RaySpan<S::Near>> {
        if spans.is_none() {
            LensSpans::begin(spans, self, largest);
        }
        spans.as_mut()?.span(stretch, per_fx)
    }
}

/// The way from a camera's distortion to its optics: there is none without distortion.
#[derive(Clone, Copy)]
pub(super) struct CameraOptics<S>(Option<OpticsOf<S>>);

type OpticsOf<S> = for<'d> fn(&'d Distortion<S>) -> &'d dyn Optics<S>;

impl<S: Scalar> CameraOptics<S> {
    pub(super) const STRAIGHT: Self = Self(None);
    pub(super) const DISTORTING: Self = Self(Some(|distortion| distortion));

    pub(super) const fn is_straight(&self) -> bool {
        self.0.is_none()
    }

    pub(super) fn of<'d>(&self, distortion: &'d Distortion<S>) -> Option<&'d dyn Optics<S>> {
        self.0.map(|optics| optics(distortion))
    }
}

/// They follow from the distortion: two are equal where that is.
impl<S> PartialEq for CameraOptics<S> {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl<S> fmt::Debug for CameraOptics<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "distorting" } else { "straight" })
    }
}

#[cfg(feature = "defmt")]
impl<S> defmt::Format for CameraOptics<S> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "{=bool}", self.0.is_some());
    }
}
