//! [`Tint`]: what the colours of a mosaic see of a grey level.

use super::checked::check;
use crate::error::ParameterError;

/// How bright red, green and blue are where the scene has a grey level: `offset + gain × level`, in grey levels.
///
/// Different gains are light of a colour; different offsets make dark things of another colour than bright ones. The
/// edge of two levels is an edge of two colours, blurred alike in each.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tint {
    /// Of red, green and blue at level 0, −255 to 255.
    pub offset: [f32; 3],
    /// Of red, green and blue per level, −1 to 1.
    pub gain: [f32; 3],
}

impl Tint {
    /// Every colour sees the grey level.
    pub const NEUTRAL: Self = Self { offset: [0.0; 3], gain: [1.0; 3] };

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let offsets = self.offset.map(|offset| ("offset", offset, [-255.0, 255.0], "-255 to 255 (grey levels)"));
        let gains = self.gain.map(|gain| ("gain", gain, [-1.0, 1.0], "-1 to 1"));
        check(offsets).and_then(|()| check(gains))
    }

    /// The level that a pixel of an RGGB mosaic sees.
    pub(super) fn level(&self, row: u16, column: u16, level: f32) -> f32 {
        let [red_offset, green_offset, blue_offset] = self.offset;
        let [red_gain, green_gain, blue_gain] = self.gain;
        let (offset, gain) = match (row % 2, column % 2) {
            (0, 0) => (red_offset, red_gain),
            (1, 1) => (blue_offset, blue_gain),
            _ => (green_offset, green_gain),
        };
        offset + gain * level
    }
}
