//! [`Shot`]: a scene before a moving rig, and the frame that shows it.

use shutter_range::sim::{Scene, Simulator};
use shutter_range::{ParameterError, Scalar, Twist};

use crate::Rig;

/// A scene, the camera before it and how that moves.
#[derive(Clone, Debug)]
pub struct Shot {
    pub rig: Rig,
    pub scene: Scene<32>,
    /// Velocity of the camera, which is level and does not turn.
    pub velocity_m_s: [f32; 3],
    /// Seed of the noise.
    pub seed: u64,
}

impl Shot {
    pub fn motion<S: Scalar + From<f32>>(&self) -> Result<Twist<S>, ParameterError> {
        Twist::level(self.velocity_m_s.map(S::from))
    }

    /// The frame, row by row.
    pub fn render(&self) -> Result<Vec<u8>, ParameterError> {
        let Rig { columns, rows, exposure, .. } = self.rig;
        let (camera, readout) = (self.rig.camera()?, self.rig.readout()?);
        let simulator = Simulator::new(&self.scene, &camera, &readout, &self.motion()?, exposure, self.seed)?;
        let mut frame = vec![0; self.rig.pixels()];
        (0..rows).zip(frame.chunks_mut(columns.into())).for_each(|(row, pixels)| simulator.row(row, pixels));
        Ok(frame)
    }

    /// Where the camera is when a row is exposed, some seconds from the middle of the exposure.
    pub(crate) fn position_m(&self, row: f64, offset_s: f64) -> [f64; 3] {
        let line_time_s = self.rig.readout_ns as f64 * 1e-9 / f64::from(self.rig.rows);
        let time_s = row * line_time_s + offset_s;
        self.velocity_m_s.map(|speed| f64::from(speed) * time_s)
    }
}
