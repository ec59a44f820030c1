//! [`PixelRow`]: a row of pixels, read as light.

use crate::setup::Response;

/// A row of pixels and how their grey levels follow the light.
#[derive(Clone, Copy)]
pub(crate) struct PixelRow<'p> {
    pub(crate) pixels: &'p [u8],
    pub(crate) response: &'p Response,
}

impl<'p> PixelRow<'p> {
    pub(super) fn get(&self, from: i64, to: i64) -> Option<&'p [u8]> {
        self.pixels.get(usize::try_from(from).ok()?..usize::try_from(to).ok()?)
    }

    /// The light of a grey level in 1/256 of a level.
    pub(super) fn light_q8(&self, level: u8) -> i64 {
        i64::from(self.response.light_q8(level))
    }

    /// Sum of the light of up to 255 pixels, in 1/256 of a level.
    pub(super) fn sum_q8(&self, pixels: &[u8]) -> u32 {
        pixels.iter().map(|pixel| u32::from(self.response.light_q8(*pixel))).sum()
    }

    /// Noise of the light at a column, from that of the grey levels, both in 1/256 of a level.
    pub(super) fn noise_of_light_q8(&self, column_q16: i64, noise_q8: u32) -> u32 {
        // The curve is steep at one end of an edge and flat at the other: its middle stands for both.
        const STEP: u8 = 8;
        let middle = usize::try_from(column_q16 >> 16).ok().and_then(|column| self.pixels.get(column));
        let Some(level) = middle.map(|level| (*level).clamp(STEP, u8::MAX - STEP)) else { return noise_q8 };
        let rise_q8 = self.light_q8(level + STEP) - self.light_q8(level - STEP);
        let slope_q8 = u32::try_from(rise_q8 / (2 * i64::from(STEP))).unwrap_or(0).max(1);
        noise_q8.saturating_mul(slope_q8) >> 8
    }
}
