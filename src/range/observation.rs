//! [`Observation`]: a sample as a ray in the axes of the frame-start camera. docs/model.md, section 3.

use super::sample::Sample;
use crate::motion::Motion;
use crate::scalar::{Scalar, add, cross, dot, scale, sub};
use crate::setup::Camera;

/// The ray of a sample: its direction, where it starts, and how it changes along the row.
#[derive(Clone, Copy)]
pub(crate) struct Observation<S> {
    /// `R r`
    pub(crate) direction: [S; 3],
    /// `R (u, w, 0)`: what a relative change of focal length adds to the direction.
    pub(crate) off_axis: [S; 3],
    /// Change of the direction per pixel of column.
    pub(crate) along_row: [S; 3],
    pub(crate) position: [S; 3],
    /// The mean of `m · p` over the sample's spread minus the `m · p` of the means.
    pub(crate) covariance: S,
    /// Velocity times time: derivative of the position by a relative error of all times.
    pub(crate) advanced: [S; 3],
    /// Rotation rate times time: the same for the attitude.
    pub(crate) turned: [S; 3],
    pub(crate) time_s: S,
    pub(crate) sigma_px: S,
    /// False once the robust fit has rejected it.
    pub(crate) is_inlier: bool,
    /// Factor on the stated noise while the fit is reweighted; one otherwise.
    pub(crate) robust_scale: S,
}

impl<S: Scalar> Observation<S> {
    pub(crate) fn new<M: Motion<S>>(camera: &Camera<S>, motion: &M, sample: &Sample<S>) -> Option<Self> {
        let middle = Self::at(camera, motion, sample, S::ZERO)?;
        if sample.spread.row_px == S::ZERO {
            return Some(middle);
        }
        // Up to the third order, the mean over a span is that of two points one standard deviation off its middle.
        let before = Self::at(camera, motion, sample, -S::ONE)?;
        let after = Self::at(camera, motion, sample, S::ONE)?;
        let half = S::ratio(1, 2);
        let mean = |a, b| scale(add(a, b), half);
        let half_change = |a, b| scale(sub(a, b), half);
        let m_change = cross(half_change(after.direction, before.direction), motion.gravity());
        Some(Self {
            direction: mean(after.direction, before.direction),
            position: mean(after.position, before.position),
            covariance: dot(m_change, half_change(after.position, before.position)),
            ..middle
        })
    }

    /// The ray so many standard deviations along the sample's span; `None` where the lens model has none.
    fn at<M: Motion<S>>(camera: &Camera<S>, motion: &M, sample: &Sample<S>, spreads: S) -> Option<Self> {
        let spread = &sample.spread;
        let time_s = sample.time_s + spread.time_s * spreads;
        let ray = camera.ray(sample.column_px + spread.column_px * spreads, sample.row_px + spread.row_px * spreads)?;
        let pose = motion.pose(time_s);
        Some(Self {
            direction: pose.rotate([ray.u, ray.w, S::ONE]),
            off_axis: pose.rotate([ray.u, ray.w, S::ZERO]),
            along_row: pose.rotate([ray.du_dcolumn, ray.dw_dcolumn, S::ZERO]),
            position: pose.position_m,
            covariance: S::ZERO,
            advanced: scale(pose.velocity_m_s, time_s),
            turned: scale(pose.rate_rad_s, time_s),
            time_s,
            // No less than the rounding of the column itself.
            sigma_px: sample.sigma_px.max((sample.column_px.abs() + S::ONE) * (S::EPSILON + S::EPSILON)),
            is_inlier: true,
            robust_scale: S::ONE,
        })
    }
}
