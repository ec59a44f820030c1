//! [`Pass`]: one look at an upright edge while passing it, with everything known but the camera.

use crate::error::ParameterError;
use crate::rse::Shear;
use crate::scalar::{Scalar, hypot};

/// The slope of an upright edge that was passed at a known depth and speed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pass<S> {
    /// In pixels of column per row; the tangent of the paper's θ.
    pub(super) slope: S,
    /// Slope that the pass would have for a scale of one.
    pub(super) per_scale: S,
    sigma_slope: S,
    sigma_relative: S,
}

impl<S: Scalar> Pass<S> {
    /// From the slope (px per row), the speed of the edge along the rows (m/s, positive to the right: that of a camera
    /// that moves to the left) and its depth in metres. Sigma: the edge leans by 0.1°, speed and depth are exact.
    ///
    /// *Errors*: a number that is not finite; a depth or a speed of zero, a depth below; any beyond 10⁴.
    pub fn new(slope: S, speed_m_s: S, depth_m: S) -> Result<Self, ParameterError> {
        Self::of(slope, Shear::parallel(S::ONE, S::ZERO), speed_m_s, depth_m)
    }

    /// The same where the edge moves at an angle ω to the image plane, as [`Shear::oblique`] has it, and shows at a
    /// bearing.
    ///
    /// *Errors*: as [`Pass::new`]; a bearing beyond ±100, a heading beyond ±2π; a motion without slope, along the ray.
    pub fn oblique(slope: S, speed_m_s: S, depth_m: S, bearing: S, heading_rad: S) -> Result<Self, ParameterError> {
        if !(bearing.abs() <= S::from_i32(100)) {
            return Err(ParameterError::new("bearing", bearing.to_f64(), "-100 to 100"));
        }
        if !(heading_rad.abs() <= S::ratio(6_284, 1_000)) {
            return Err(ParameterError::new("heading_rad", heading_rad.to_f64(), "-2 pi to 2 pi"));
        }
        Self::of(slope, Shear::oblique(S::ONE, bearing, heading_rad), speed_m_s, depth_m)
    }

    fn of(slope: S, shear: Shear<S>, speed_m_s: S, depth_m: S) -> Result<Self, ParameterError> {
        let most = S::from_i32(10_000);
        if !(slope.abs() <= most) {
            return Err(ParameterError::new("slope", slope.to_f64(), "-10000 to 10000 (px per row)"));
        }
        if !(speed_m_s.abs() <= most && speed_m_s != S::ZERO) {
            return Err(ParameterError::new("speed_m_s", speed_m_s.to_f64(), "-10000 to 10000 (m/s), but not 0"));
        }
        if !(depth_m > S::ZERO && depth_m <= most) {
            return Err(ParameterError::new("depth_m", depth_m.to_f64(), "above 0, at most 10000 (m)"));
        }
        let per_scale = shear.slope(depth_m, speed_m_s, S::ONE);
        if !(per_scale.is_finite() && per_scale != S::ZERO) {
            return Err(ParameterError::new(
                "heading_rad",
                per_scale.to_f64(),
                "not that of a motion without any slope",
            ));
        }
        let sigma_slope = S::ratio(1_745, 1_000_000);
        Ok(Self { slope, per_scale, sigma_slope, sigma_relative: S::ZERO })
    }

    /// The same in a camera mode with its own readout time of the frame, in seconds: the scale is then κ = f/n instead
    /// of κ times the readout.
    ///
    /// *Errors*: a time that is not above zero and at most 60 s.
    pub fn with_frame_readout_s(self, frame_readout_s: S) -> Result<Self, ParameterError> {
        if !(frame_readout_s > S::ZERO && frame_readout_s <= S::from_i32(60)) {
            return Err(ParameterError::new("frame_readout_s", frame_readout_s.to_f64(), "above 0, at most 60 (s)"));
        }
        Ok(Self { per_scale: self.per_scale * frame_readout_s, ..self })
    }

    /// The same with what it is known to, one standard deviation each: the slope in pixels per row (the lean of the
    /// edge and the reading), and speed over depth, relative.
    ///
    /// *Errors*: a sigma of the slope that is not above zero and at most 1; a relative one outside 0 to 1.
    pub fn with_sigmas(self, sigma_slope: S, sigma_relative: S) -> Result<Self, ParameterError> {
        if !(sigma_slope > S::ZERO && sigma_slope <= S::ONE) {
            return Err(ParameterError::new("sigma_slope", sigma_slope.to_f64(), "above 0, at most 1 (px per row)"));
        }
        if !(sigma_relative >= S::ZERO && sigma_relative <= S::ONE) {
            return Err(ParameterError::new("sigma_relative", sigma_relative.to_f64(), "0 to 1"));
        }
        Ok(Self { sigma_slope, sigma_relative, ..self })
    }

    /// Sigma of the difference to what a scale predicts.
    pub(super) fn sigma(&self, scale: S) -> S {
        hypot(self.sigma_slope, self.sigma_relative * self.per_scale * scale)
    }
}
