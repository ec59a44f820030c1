//! [`Mode`]: what a sensor does now.

use super::error::SensorError;
use crate::error::ParameterError;
use crate::scalar::Scalar;
use crate::setup::{Readout, ReadoutDirection};

/// The part of the pixel array that an image shows, in pixels of the array as the sensor counts them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Window {
    /// First column and row, in the chip's own counting (some do not begin at zero).
    pub first_column: u16,
    /// First row.
    pub first_row: u16,
    /// Width: so many columns of the array become the image's columns.
    pub columns: u16,
    /// Height: so many rows of the array become the image's rows.
    pub rows: u16,
}

/// What a sensor does now, by its registers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Mode {
    /// Columns of the image.
    pub columns: u16,
    /// Rows of the image, and the time from one to the next. Always from top to bottom: a flip in the sensor changes
    /// which row is read first, and that row is the first of the image.
    pub readout: Readout,
    /// How many of its own lines the sensor spends on the image: over the image's rows, the lines for each row.
    pub lines: u16,
    /// Line time of the sensor in picoseconds: the unit of exposure and frame time.
    pub sensor_line_time_ps: u64,
    /// Lines of a frame with its blanking. An automatic exposure may lengthen it in some chips.
    pub frame_lines: u32,
    /// Exposure in 1/16 of a line.
    pub exposure_sixteenths: u32,
    /// The sensor chooses the exposure: what was read is that of an instant, and may even be half old, half new.
    pub automatic_exposure: bool,
    /// The image is mirrored left to right: edges lean the other way, and a motion to the right goes left in it.
    pub mirrored: bool,
    /// The image is upside down: gravity points upwards in it.
    pub flipped: bool,
    /// What of the pixel array the image shows.
    pub window: Window,
    /// How well the line time is known, one standard deviation in parts per million. See [`Evidence`].
    pub sigma_ppm: u32,
}

/// How well a formula for the line time is borne out. What the sources leave open widens sigma.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Evidence {
    /// A frame rate that someone measured or states independently agrees: 0.1 %, for a clock that is right to its last
    /// stated digit.
    Confirmed,
    /// It follows from descriptions of the registers alone: 5 %.
    Described,
    /// Sources differ by a factor of two: 50 %, so that the other value lies at two sigma. Measure it
    /// ([`PeriodMeter`](crate::measure::PeriodMeter)).
    Disputed,
}

impl Evidence {
    /// One standard deviation, relative, in parts per million.
    #[must_use]
    pub const fn sigma_ppm(self) -> u32 {
        match self {
            Self::Confirmed => 1_000,
            Self::Described => 50_000,
            Self::Disputed => 500_000,
        }
    }
}

/// What a chip's formula makes of its registers.
pub(super) struct Timing {
    pub(super) line_clocks: u32,
    pub(super) clock: Clock,
    pub(super) frame_lines: u32,
    pub(super) exposure_sixteenths: u32,
    pub(super) automatic_exposure: bool,
    pub(super) mirrored: bool,
    pub(super) flipped: bool,
    pub(super) columns: u32,
    pub(super) rows: u32,
    pub(super) lines: u32,
    pub(super) window: [u32; 4],
    pub(super) evidence: Evidence,
}

/// A frequency as a fraction of hertz: divided once, at the end.
#[derive(Clone, Copy)]
pub(super) struct Clock {
    numerator: u64,
    denominator: u64,
}

/// What the boards' clocks are between, generously.
const CLOCK_RANGE_HZ: core::ops::RangeInclusive<u32> = 1_000_000..=100_000_000;

impl Clock {
    /// The board's clock.
    pub(super) fn external(hz: u32) -> Result<Self, ParameterError> {
        if CLOCK_RANGE_HZ.contains(&hz) {
            Ok(Self { numerator: hz.into(), denominator: 1 })
        } else {
            Err(ParameterError::new("clock_hz", hz.into(), "1 to 100 MHz"))
        }
    }

    /// Multiplied and divided. Both factors are small: registers of 8 bits.
    pub(super) fn times(self, multiplier: u32, divisor: u32) -> Self {
        Self {
            numerator: self.numerator.saturating_mul(multiplier.into()),
            denominator: self.denominator.saturating_mul(divisor.into()),
        }
    }

    /// The frequency in hertz, rounded down.
    pub(super) fn hz(self) -> u64 {
        self.numerator.checked_div(self.denominator).unwrap_or(0)
    }

    fn ps(self, clocks: u32) -> Option<u64> {
        const PS_PER_S: u128 = 1_000_000_000_000;
        let scaled = u128::from(clocks) * PS_PER_S * u128::from(self.denominator) + u128::from(self.numerator / 2);
        scaled.checked_div(self.numerator.into()).and_then(|ps| u64::try_from(ps).ok())
    }
}

impl Mode {
    pub(super) fn from_timing<E>(timing: &Timing) -> Result<Self, SensorError<E>> {
        let &Timing { line_clocks, clock, columns, rows, lines, window, .. } = timing;
        let [columns, rows, lines] = [columns, rows, lines].map(saturated);
        let line_ps = clock.ps(line_clocks).unwrap_or(u64::MAX);
        let frame_ps = u128::from(line_ps) * u128::from(lines);
        let row_ps = (frame_ps + u128::from(rows / 2)).checked_div(u128::from(rows)).unwrap_or(0);
        let row_ps = u64::try_from(row_ps).unwrap_or(u64::MAX);
        let readout = Readout::from_line_time_ps(rows, row_ps, ReadoutDirection::TopToBottom)?;
        let [first_column, first_row, window_columns, window_rows] = window.map(saturated);
        Ok(Self {
            columns,
            readout,
            lines,
            sensor_line_time_ps: line_ps,
            frame_lines: timing.frame_lines,
            exposure_sixteenths: timing.exposure_sixteenths,
            automatic_exposure: timing.automatic_exposure,
            mirrored: timing.mirrored,
            flipped: timing.flipped,
            window: Window { first_column, first_row, columns: window_columns, rows: window_rows },
            sigma_ppm: timing.evidence.sigma_ppm(),
        })
    }

    /// Rows of the image.
    #[must_use]
    pub const fn rows(&self) -> u16 {
        self.readout.rows()
    }

    /// Exposure in nanoseconds, rounded.
    #[must_use]
    pub fn exposure_ns(&self) -> u64 {
        let ps = u128::from(self.sensor_line_time_ps) * u128::from(self.exposure_sixteenths) / 16;
        u64::try_from((ps + 500) / 1000).unwrap_or(u64::MAX)
    }

    /// Exposure in seconds: what [`MotionBlur`](crate::MotionBlur) asks for.
    #[must_use]
    pub fn exposure_s<S: Scalar>(&self) -> S {
        S::from_ratio(i64::try_from(self.exposure_ns()).unwrap_or(i64::MAX), 1_000_000_000)
    }

    /// Time from one frame to the next in nanoseconds, rounded.
    #[must_use]
    pub fn frame_time_ns(&self) -> u64 {
        let ps = u128::from(self.sensor_line_time_ps) * u128::from(self.frame_lines);
        u64::try_from((ps + 500) / 1000).unwrap_or(u64::MAX)
    }

    /// How well the line time is known: what [`Uncertainty::sigma_readout`](crate::Uncertainty::sigma_readout) asks
    /// for.
    #[must_use]
    pub fn sigma<S: Scalar>(&self) -> S {
        S::from_ratio(self.sigma_ppm.into(), 1_000_000)
    }
}

fn saturated(value: u32) -> u16 {
    u16::try_from(value).unwrap_or(u16::MAX)
}
