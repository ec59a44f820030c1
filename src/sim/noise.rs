//! Noise without state: the number of each pixel is a hash of seed, frame, row and column.

use super::exposure::Exposure;
use super::random::{gaussian, hash};

/// The noise of one row.
pub(super) struct RowNoise {
    key: u64,
    read_variance: f32,
    shot_gain: f32,
    /// Level and sigma of the previous pixel, which are most often those of the next one.
    last: (f32, f32),
}

impl RowNoise {
    pub(super) fn new(exposure: &Exposure, frame_key: u64, row: u16) -> Self {
        let read_variance = exposure.read_noise * exposure.read_noise;
        let key = hash(frame_key, u64::from(row));
        Self { key, read_variance, shot_gain: exposure.shot_gain, last: (0.0, libm::sqrtf(read_variance)) }
    }

    /// The level that the sensor gives for a level: with noise, neither rounded nor bounded.
    pub(super) fn noisy(&mut self, column: u16, level: f32) -> f32 {
        let (last_level, mut sigma) = self.last;
        if level != last_level {
            sigma = libm::sqrtf(self.read_variance + self.shot_gain * level.max(0.0));
            self.last = (level, sigma);
        }
        let noise = if sigma > 0.0 { sigma * gaussian(hash(self.key, u64::from(column))) } else { 0.0 };
        level + noise
    }
}
