//! [`Stage`]: one thing that a camera does to its pixels.

use super::checked::check;
use super::neighbours::{bilateral, demosaiced, median, sharpened_3x3, sharpened_5x5};
use super::random::{gaussian, hash, mix};
use super::tone_curve::{ToneCurve, ToneTable};
use super::window::{Rows, Window};
use crate::error::ParameterError;

/// One thing that a camera does to its pixels, between the sensor and the eight bits that it delivers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Stage {
    /// Each column has an offset of its own, alike in all rows and frames: one sigma in grey levels, 0 to 100.
    ColumnOffsets {
        /// One sigma in grey levels.
        sigma: f32,
        /// Picks the offsets.
        seed: u32,
    },
    /// Brighter by a factor, 0 to 100; what would be brighter than white is white.
    Gain(f32),
    /// A grey scene seen through a Bayer mosaic (red and green in even rows) whose colours are interpolated linearly
    /// and made grey again: soft, and not alike in even and odd columns.
    Mosaic,
    /// Denoising by the median of 3 × 3 pixels.
    Median,
    /// Denoising by a mean of 3 × 3 pixels that leaves out what differs by more than a sigma or so, in grey levels,
    /// 0.01 to 1000.
    Bilateral(f32),
    /// A tone curve.
    Tone(ToneCurve),
    /// Sharpening: so many times the difference to a mean of 3 × 3 pixels (1 2 1 both ways) is added, 0 to 100.
    Sharpen3(f32),
    /// The same with 5 × 5 pixels (2 4 5 4 2 both ways).
    Sharpen5(f32),
}

impl Stage {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        match *self {
            Self::ColumnOffsets { sigma, .. } => check([("sigma", sigma, [0.0, 100.0], "0 to 100 (grey levels)")]),
            Self::Gain(gain) => check([("gain", gain, [0.0, 100.0], "0 to 100")]),
            Self::Mosaic | Self::Median => Ok(()),
            Self::Bilateral(sigma) => check([("sigma", sigma, [0.01, 1000.0], "0.01 to 1000 (grey levels)")]),
            Self::Tone(curve) => curve.check(),
            Self::Sharpen3(strength) | Self::Sharpen5(strength) => {
                check([("strength", strength, [0.0, 100.0], "0 to 100")])
            }
        }
    }

    /// Whether it takes pixels one by one.
    const fn is_pointwise(&self) -> bool {
        matches!(self, Self::ColumnOffsets { .. } | Self::Gain(_) | Self::Tone(_))
    }
}

/// A stage at work on the rows of a frame, in 1/256 of a grey level.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct RunningStage<const COLUMNS: usize> {
    stage: Stage,
    tone: Option<ToneTable>,
    window: Window<COLUMNS>,
}

impl<const COLUMNS: usize> RunningStage<COLUMNS> {
    pub(super) fn new(stage: Stage) -> Self {
        let tone = if let Stage::Tone(curve) = &stage { Some(ToneTable::new(curve)) } else { None };
        Self { stage, tone, window: Window::new() }
    }

    /// Takes a row and gives the next one that is ready.
    pub(super) fn push(&mut self, row: &[u16; COLUMNS]) -> Option<[u16; COLUMNS]> {
        if self.stage.is_pointwise() {
            return Some(self.point_by_point(row));
        }
        let (number, rows) = self.window.push(row)?;
        Some(filtered(&self.stage, number, &rows))
    }

    /// The last row once more, for a stage that has yet to give some.
    pub(super) fn last(&self) -> Option<[u16; COLUMNS]> {
        self.window.last()
    }

    pub(super) const fn end_frame(&mut self) {
        self.window.clear();
    }

    fn point_by_point(&self, row: &[u16; COLUMNS]) -> [u16; COLUMNS] {
        let mut out = *row;
        for (column, level) in (0_u64..).zip(&mut out) {
            *level = match self.stage {
                // The conversions cut off below 0 and above 65535.
                Stage::ColumnOffsets { sigma, seed } => {
                    let offset = sigma * gaussian(hash(mix(u64::from(seed)), column));
                    (f32::from(*level) + 256.0 * offset + 0.5) as u16
                }
                Stage::Gain(gain) => (f32::from(*level) * gain + 0.5) as u16,
                _ => self.tone.as_ref().map_or(*level, |tone| tone.at(*level)),
            };
        }
        out
    }
}

fn filtered<const COLUMNS: usize>(stage: &Stage, number: usize, rows: &Rows<'_, COLUMNS>) -> [u16; COLUMNS] {
    let mut out = [0; COLUMNS];
    match *stage {
        Stage::Mosaic => demosaiced(number, rows, &mut out),
        Stage::Median => median(rows, &mut out),
        Stage::Bilateral(sigma) => bilateral(rows, sigma, &mut out),
        Stage::Sharpen3(strength) => sharpened_3x3(rows, strength, &mut out),
        Stage::Sharpen5(strength) => sharpened_5x5(rows, strength, &mut out),
        Stage::ColumnOffsets { .. } | Stage::Gain(_) | Stage::Tone(_) => {}
    }
    out
}
