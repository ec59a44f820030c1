//! [`Rig`]: a camera, its readout and its exposure.

use shutter_range::sim::Exposure;
use shutter_range::{
    Camera, Distortion, Intrinsics, MotionBlur, ParameterError, Readout, ReadoutDirection, Response, Scalar, Setup,
    Uncertainty,
};

/// A level camera without distortion, read from the top.
#[derive(Clone, Copy, Debug)]
pub struct Rig {
    pub columns: u16,
    pub rows: u16,
    pub focal_px: f32,
    /// Of the whole frame: rows × line time.
    pub readout_ns: u64,
    pub exposure: Exposure,
}

impl Rig {
    pub const QVGA: Self = Self {
        columns: 320,
        rows: 240,
        focal_px: 300.0,
        readout_ns: 33_333_333,
        exposure: Exposure { time_s: 1.0 / 500.0, psf_sigma_px: 0.7, read_noise: 2.5, shot_gain: 0.03 },
    };

    pub const VGA: Self = Self { columns: 640, rows: 480, focal_px: 600.0, ..Self::QVGA };

    pub const HD: Self = Self {
        columns: 1920,
        rows: 1080,
        focal_px: 2549.0,
        readout_ns: 20_000_000,
        exposure: Exposure { time_s: 1.0 / 2000.0, psf_sigma_px: 0.7, read_noise: 2.0, shot_gain: 0.02 },
    };

    pub fn pixels(&self) -> usize {
        usize::from(self.columns) * usize::from(self.rows)
    }

    /// Bearing of the image's right border.
    pub fn half_field(&self) -> f32 {
        0.5 * f32::from(self.columns) / self.focal_px
    }

    pub fn camera<S: Scalar + From<f32>>(&self) -> Result<Camera<S>, ParameterError> {
        Camera::new(Intrinsics::centred(self.columns, self.rows, self.focal_px.into()), Distortion::NONE)
    }

    pub fn readout(&self) -> Result<Readout, ParameterError> {
        Readout::from_frame_readout_ns(self.rows, self.readout_ns, ReadoutDirection::TopToBottom)
    }

    /// As a user would set it up who knows exposure and lens, and that edges are upright.
    pub fn setup<S: Scalar + From<f32>>(&self) -> Result<Setup<S>, ParameterError> {
        let blur = MotionBlur::from_calibrated_lens(self.exposure.time_s.into(), self.exposure.psf_sigma_px.into());
        Setup::new(self.camera()?, self.readout()?)?
            .with_uncertainty(Uncertainty::NONE)?
            .with_response(Response::Linear)
            .with_motion_blur(blur)
    }
}
