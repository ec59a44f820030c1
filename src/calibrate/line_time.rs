//! [`LineTime`]: what the bands of a lamp say, and [`FlickerRefusal`]: why they say nothing.

use core::error::Error;
use core::fmt::{self, Display, Formatter};

use crate::error::ParameterError;
use crate::scalar::Scalar;
use crate::setup::{Readout, ReadoutDirection};

/// A measured line time with its sigma.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct LineTime<S> {
    /// From one row of the image to the next, in picoseconds.
    pub line_time_ps: u64,
    /// One standard deviation, relative: what [`Uncertainty::sigma_readout`](crate::Uncertainty::sigma_readout) asks
    /// for. The lamp's own is part of it.
    pub sigma: S,
    /// Periods of the lamp in a frame.
    pub periods: S,
    /// Pairs of frames that it rests on.
    pub pairs: u16,
    /// How the pairs scatter, in units of what noise explains: about one.
    pub scatter: S,
    pub(super) rows: u16,
}

impl<S: Scalar> LineTime<S> {
    /// The readout of the image, for a [`Setup`](crate::Setup). Bands do not tell its direction.
    ///
    /// *Errors*: a frame longer than a minute.
    pub fn readout(&self, direction: ReadoutDirection) -> Result<Readout, ParameterError> {
        Readout::from_line_time_ps(self.rows, self.line_time_ps, direction)
    }

    /// Line time in microseconds.
    #[must_use]
    pub fn line_time_us(&self) -> S {
        S::from_ratio(i64::try_from(self.line_time_ps).unwrap_or(i64::MAX), 1_000_000)
    }
}

/// Why there is no line time. A status, not an error: other frames may have one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum FlickerRefusal<S> {
    /// Fewer than two whole frames: one alone does not tell the lamp's bands from the scene's own.
    TooFewFrames,
    /// No bands that move from frame to frame.
    NoBands,
    /// The same, and the exposure is so nearly this many periods of the lamp that all rows get the same light.
    ExposureOfPeriods {
        /// The whole number of periods.
        periods: u32,
    },
    /// There are bands, but too few of them in a frame.
    TooFewPeriods {
        /// Periods in a frame.
        periods: S,
    },
    /// The pairs of frames differ by far more than noise explains: the camera has moved, or changed its mode.
    Inconsistent {
        /// How the pairs scatter, in units of what noise explains.
        scatter: S,
    },
    /// Below half a period in a row and above it there is a line time that the interval between frames allows.
    Ambiguous {
        /// The shorter one, in picoseconds.
        line_time_ps: u64,
        /// The longer one, in picoseconds.
        or_ps: u64,
    },
}

impl<S> FlickerRefusal<S> {
    /// Its name in lower case, as the command line has it.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::TooFewFrames => "too_few_frames",
            Self::NoBands => "no_bands",
            Self::ExposureOfPeriods { .. } => "exposure_of_periods",
            Self::TooFewPeriods { .. } => "too_few_periods",
            Self::Inconsistent { .. } => "inconsistent",
            Self::Ambiguous { .. } => "ambiguous",
        }
    }
}

impl<S: Scalar> Display for FlickerRefusal<S> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFewFrames => {
                write!(
                    formatter,
                    "fewer than two whole frames: one alone does not tell the lamp's bands from the scene's own"
                )
            }
            Self::NoBands => write!(
                formatter,
                "no bands move from frame to frame: the lamp is steady or too weak, the exposure is a whole number of its \
                 periods, or its frequency is a multiple of the frame rate (change one of them)"
            ),
            Self::ExposureOfPeriods { periods } => write!(
                formatter,
                "no bands: the exposure is {periods} whole periods of the lamp, so that all rows get the same light; make it \
                 shorter"
            ),
            Self::TooFewPeriods { periods } => write!(
                formatter,
                "too few bands: {:.1} periods of the lamp in a frame, but there must be at least 2: take a faster lamp",
                periods.to_f64()
            ),
            Self::Inconsistent { scatter } => write!(
                formatter,
                "the frames contradict each other, by {:.0} times their noise: keep the camera still and in one mode",
                scatter.to_f64()
            ),
            Self::Ambiguous { line_time_ps, or_ps } => write!(
                formatter,
                "the line time is {:.3} or {:.3} us, and the interval between frames allows both: take a slower lamp",
                *line_time_ps as f64 / 1e6,
                *or_ps as f64 / 1e6
            ),
        }
    }
}

impl<S: Scalar> Error for FlickerRefusal<S> {}
