//! [`ToneCurve`]: how a camera turns light into grey levels.

use super::checked::check;
use crate::error::ParameterError;

/// How a camera turns light into grey levels. Each curve takes 0 to 0 and 255 to 255.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ToneCurve {
    /// The curve of sRGB (IEC 61966-2-1).
    Srgb,
    /// A power: of light x in 0 to 1 it makes x^(1/γ), γ 0.1 to 10.
    Gamma(f32),
    /// A logistic curve, which spreads the middle tones and squeezes the dark and the bright ones.
    S {
        /// Where it is steepest, in 0 to 1 of the light.
        middle: f32,
        /// How steep, 0.1 to 50; in the middle about a quarter of it.
        steepness: f32,
    },
}

/// Light and grey level at the upper end.
const WHITE: f32 = 255.0;

impl ToneCurve {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        match *self {
            Self::Srgb => Ok(()),
            Self::Gamma(gamma) => check([("gamma", gamma, [0.1, 10.0], "0.1 to 10")]),
            Self::S { middle, steepness } => {
                check([("middle", middle, [0.0, 1.0], "0 to 1"), ("steepness", steepness, [0.1, 50.0], "0.1 to 50")])
            }
        }
    }

    /// The grey level of a light, both 0 to 1.
    fn of_light(&self, light: f32) -> f32 {
        match *self {
            Self::Srgb if light <= 0.003_130_8 => 12.92 * light,
            Self::Srgb => 1.055 * libm::powf(light, 1.0 / 2.4) - 0.055,
            Self::Gamma(gamma) => libm::powf(light, 1.0 / gamma),
            Self::S { middle, steepness } => {
                let logistic = |x: f32| 1.0 / (1.0 + libm::expf(-steepness * (x - middle)));
                let (black, white) = (logistic(0.0), logistic(1.0));
                (logistic(light) - black) / (white - black)
            }
        }
    }
}

/// A tone curve at every whole level, in 1/256 of a level; between them it is straight.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct ToneTable([u16; 257]);

impl ToneTable {
    pub(super) fn new(curve: &ToneCurve) -> Self {
        let mut table = [0; 257];
        for (entry, level) in table.iter_mut().zip(0_u16..) {
            let light = (f32::from(level) / WHITE).min(1.0);
            *entry = (curve.of_light(light) * WHITE * 256.0 + 0.5) as u16;
        }
        Self(table)
    }

    /// From and to 1/256 of a level.
    pub(super) fn at(&self, light_q8: u16) -> u16 {
        let (level, part) = (usize::from(light_q8 >> 8), u32::from(light_q8 & 255));
        match self.0.get(level..level + 2) {
            // At most 65535, as its ends are.
            Some(&[below, above]) => ((u32::from(below) * (256 - part) + u32::from(above) * part + 128) >> 8) as u16,
            _ => light_q8,
        }
    }
}
