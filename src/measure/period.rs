//! [`Period`]: what a meter says.

use crate::error::ParameterError;
use crate::scalar::Scalar;
use crate::setup::{Readout, ReadoutDirection};

/// A measured period with its sigma, and what became of the stamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Period {
    /// The period in picoseconds.
    pub period_ps: u64,
    /// One standard deviation of it in picoseconds: scatter of the stamps and tolerance of the timer.
    pub sigma_ps: u64,
    /// Stamps that it rests on.
    pub stamps: u32,
    /// Periods without a stamp: missed interrupts, and blanking rows where line-valid pauses.
    pub missed: u32,
    /// Stamps that fitted nowhere: late interrupts and glitches.
    pub outliers: u32,
}

impl Period {
    /// Sigma relative to the period, in parts per million, rounded up.
    #[must_use]
    pub fn sigma_ppm(&self) -> u32 {
        let scaled = u128::from(self.sigma_ps) * 1_000_000 + u128::from(self.period_ps.saturating_sub(1));
        let ppm = scaled.checked_div(u128::from(self.period_ps)).unwrap_or(u128::MAX);
        u32::try_from(ppm).unwrap_or(u32::MAX)
    }

    /// Sigma relative to the period: what [`Uncertainty::sigma_readout`](crate::Uncertainty::sigma_readout) asks for.
    /// At most 1.
    #[must_use]
    pub fn sigma<S: Scalar>(&self) -> S {
        S::from_ratio(i64::from(self.sigma_ppm().min(1_000_000)), 1_000_000)
    }

    /// The readout of an image of `rows`, where the period is the sensor's line time and the sensor spends `lines` of
    /// its own on the image: as many as the image has rows, or twice as many where it skips or averages every second
    /// one.
    ///
    /// *Errors*: zero rows, zero lines; a frame longer than a minute.
    pub fn readout(&self, rows: u16, lines: u16, direction: ReadoutDirection) -> Result<Readout, ParameterError> {
        let frame_ps = u128::from(self.period_ps) * u128::from(lines);
        let line_time_ps = (frame_ps + u128::from(rows / 2)).checked_div(u128::from(rows)).unwrap_or(0);
        Readout::from_line_time_ps(rows, u64::try_from(line_time_ps).unwrap_or(u64::MAX), direction)
    }
}
