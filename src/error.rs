//! Errors: for misuse only. What a scene cannot tell is a [`RangeStatus`](crate::RangeStatus), not an error.

use core::error::Error;
use core::fmt::{self, Display, Formatter};

/// A parameter that cannot be right: its name, its value and what would be right.
///
/// ```
/// let error = shutter_range::Readout::from_line_time_ps(480, 0, Default::default()).unwrap_err();
/// assert_eq!(error.parameter, "line_time_ps");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct ParameterError {
    /// The name of the parameter, with its unit where it has one.
    pub parameter: &'static str,
    /// The value that was refused.
    pub value: f64,
    /// What the parameter must be.
    pub expected: &'static str,
}

impl ParameterError {
    /// With a whole number, by its bits: no routine that converts is linked for it.
    pub(crate) const fn of_whole(name: &'static str, value: u64, expected: &'static str) -> Self {
        let zeros = value.leading_zeros();
        let bits = match zeros {
            64 => 0,
            0..=10 => ((1023 + 63 - zeros as u64) << 52) | ((value >> (11 - zeros)) & ((1 << 52) - 1)),
            _ => ((1023 + 63 - zeros as u64) << 52) | ((value << (zeros - 11)) & ((1 << 52) - 1)),
        };
        Self::new(name, f64::from_bits(bits), expected)
    }

    pub(crate) const fn new(parameter: &'static str, value: f64, expected: &'static str) -> Self {
        Self { parameter, value, expected }
    }
}

impl Display for ParameterError {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} is {}, but must be {}", self.parameter, self.value, self.expected)
    }
}

impl Error for ParameterError {}

/// A name that is none of a [`PixelFormat`](crate::format::PixelFormat).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FormatNameError;

impl Display for FormatNameError {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str(
            "the pixel format must be gray8, yuyv, yvyu, uyvy, vyuy, rgb565le, rgb565be, gray10p, gray10le, ",
        )?;
        formatter.write_str("gray12le, bayer8, bayer10p, bayer10le or bayer12le")
    }
}

impl Error for FormatNameError {}

/// Why a row of pixels was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RowError {
    /// A row is missing, repeated or out of order: the frame is torn.
    Order {
        /// The row that came.
        row: u16,
        /// The row that should have come.
        expected: u16,
    },
    /// The row does not have as many pixels as the camera has columns: the frame is torn.
    Length {
        /// The row that came.
        row: u16,
        /// Its number of pixels.
        pixels: usize,
        /// The camera's number of columns.
        columns: u16,
    },
    /// The frame is one of edge points. The row is left out and nothing else changes.
    FrameOfPoints {
        /// The row that came.
        row: u16,
    },
    /// All edges jump at one row: rows are missing, the frame is mixed with another one, bytes were lost, or the light
    /// is pulsed. So does one edge after the other wherever pulsed light changes. The frame is torn.
    Jump {
        /// The first row after the jump; where edges jump one after the other, that in which enough have done so.
        row: u16,
    },
    /// The frame was torn before; rows are taken again from the next frame on.
    Torn,
}

impl Display for RowError {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Order { row, expected } => {
                write!(formatter, "row {row} came where row {expected} was due: torn frame")
            }
            Self::Length { row, pixels, columns } => {
                write!(formatter, "row {row} has {pixels} pixels, but must have {columns}: torn frame")
            }
            Self::FrameOfPoints { row } => {
                write!(
                    formatter,
                    "row {row} came as pixels in a frame of edge points: a frame is made of one or the other"
                )
            }
            Self::Jump { row } => write_jump(formatter, row),
            Self::Torn => write!(formatter, "the frame is torn; rows are taken again after its end"),
        }
    }
}

impl Error for RowError {}

fn write_jump(formatter: &mut Formatter<'_>, row: u16) -> fmt::Result {
    write!(
        formatter,
        "edges jump at row {row} (rows are missing, the frame is mixed with another, or the light is pulsed): torn frame"
    )
}

/// Why an edge point was not taken. The point is left out and nothing else changes, but for [`Jump`](Self::Jump), which
/// tears the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum EdgeError {
    /// The column or row is not in the image.
    OutsideImage {
        /// Row of the point.
        row: u16,
        /// Column of the point in 1/65536 px.
        column_q16: i32,
    },
    /// The row was read before one that has come already, or its points are complete.
    RowOrder {
        /// Row of the point.
        row: u16,
        /// The row that came last.
        previous: u16,
    },
    /// The time stamp is earlier than that of a row read before, and no readout tells the time instead
    /// ([`StampPolicy::Trusted`](crate::StampPolicy::Trusted)).
    TimeOrder {
        /// Time of the point in nanoseconds since frame start.
        time_ns: i64,
        /// The time that came last.
        previous_ns: i64,
    },
    /// The same row and column came twice.
    Duplicate {
        /// Row of the point.
        row: u16,
        /// Column of the point in 1/65536 px.
        column_q16: i32,
    },
    /// The noise of the point is stated as zero, which no sensor reaches, or as more than 256 px.
    Sigma {
        /// Row of the point.
        row: u16,
        /// The stated noise in 1/65536 px.
        sigma_q16: u32,
    },
    /// The time stamp is more than an hour away from frame start.
    TimeRange {
        /// Time of the point in nanoseconds since frame start.
        time_ns: i64,
    },
    /// The stamp lies outside the frame that the readout allows, or the stamps do not rise with the rows. Mostly it is
    /// the time since the board started instead of that since frame start, or one in other units.
    Stamp {
        /// Row of the point.
        row: u16,
        /// The stamp in nanoseconds since frame start.
        time_ns: i64,
        /// When the readout reads the row.
        expected_ns: i64,
    },
    /// The frame is one of rows of pixels, in which the edge points are found.
    FrameOfPixels,
    /// All edges jump at one row: rows are missing, the frame is mixed with another one, bytes were lost, or the light
    /// is pulsed. The frame is torn.
    Jump {
        /// The first row after the jump.
        row: u16,
    },
    /// The frame is torn; points are taken again from the next frame on.
    Torn,
}

impl Display for EdgeError {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match *self {
            Self::OutsideImage { row, column_q16 } => {
                write!(formatter, "edge at row {row}, column {}: outside the image", f64::from(column_q16) / 65536.0)
            }
            Self::RowOrder { row, previous } => {
                write!(formatter, "row {row} came after row {previous}: rows must come once, in the order of readout")
            }
            Self::TimeOrder { time_ns, previous_ns } => {
                write!(formatter, "time {time_ns} ns came after {previous_ns} ns: times must not run backwards")
            }
            Self::Duplicate { row, column_q16 } => {
                write!(formatter, "edge at row {row}, column {} came twice", f64::from(column_q16) / 65536.0)
            }
            Self::Sigma { row, sigma_q16 } => {
                let sigma = f64::from(sigma_q16) / 65536.0;
                write!(formatter, "edge at row {row}: sigma is {sigma} px, but must be 1/65536 to 256 px")
            }
            Self::TimeRange { time_ns } => {
                write!(formatter, "time {time_ns} ns: must be within an hour of frame start")
            }
            Self::Stamp { row, time_ns, expected_ns } => {
                write!(
                    formatter,
                    "row {row} is stamped {time_ns} ns, but the readout reads it at {expected_ns} ns since frame start: \
                     is it a time since boot, or in other units?"
                )
            }
            Self::FrameOfPixels => {
                write!(formatter, "edge points came in a frame of pixels: a frame is made of one or the other")
            }
            Self::Jump { row } => write_jump(formatter, row),
            Self::Torn => write!(formatter, "the frame is torn; edge points are taken again after its end"),
        }
    }
}

impl Error for EdgeError {}

/// Why a sample was not taken by a [`Trajectory`](crate::Trajectory). It is left out and nothing else changes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum TrajectoryError {
    /// A component is not finite or too large, or a gravity has no direction.
    Value(ParameterError),
    /// The stamp is not later than the one before.
    StampOrder {
        /// Where the sample belongs.
        stream: TrajectoryStream,
        /// The stamp that came.
        stamp_ns: i64,
        /// The stamp before it.
        previous_ns: i64,
    },
    /// The stamp is more than 146 years from zero, in its own clock or the camera's.
    StampRange {
        /// Where the sample belongs.
        stream: TrajectoryStream,
        /// The stamp that came.
        stamp_ns: i64,
    },
    /// The trajectory was made without this stream.
    Undeclared(TrajectoryStream),
}

impl Display for TrajectoryError {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value(error) => error.fmt(formatter),
            Self::StampOrder { stream, stamp_ns, previous_ns } => {
                write!(formatter, "{stream} at {stamp_ns} ns came after {previous_ns} ns: stamps must increase")
            }
            Self::StampRange { stream, stamp_ns } => {
                write!(formatter, "{stream} at {stamp_ns} ns: must be within 146 years of zero")
            }
            Self::Undeclared(stream) => write!(formatter, "the trajectory was made without {stream}"),
        }
    }
}

impl Error for TrajectoryError {}

impl From<ParameterError> for TrajectoryError {
    fn from(error: ParameterError) -> Self {
        Self::Value(error)
    }
}

/// A stream of samples that a [`Trajectory`](crate::Trajectory) is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum TrajectoryStream {
    /// Of the camera, m/s.
    Velocity,
    /// Rotation rate, rad/s.
    Rate,
    /// Direction of "down".
    Gravity,
}

impl Display for TrajectoryStream {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Velocity => "velocity",
            Self::Rate => "rotation rate",
            Self::Gravity => "gravity",
        })
    }
}

/// Why there is no motion for a frame: data is missing or stale. A status, not an error: the next frame may have one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum TrajectoryGap {
    /// Not a single sample has come.
    Missing(TrajectoryStream),
    /// The frame needs values farther from any sample, or between samples farther apart, than is trusted.
    Stale {
        /// The stream with the gap.
        stream: TrajectoryStream,
        /// When the first untrusted value would be needed, in the camera's clock; after the last sample, when the last
        /// one would be.
        at_ns: i64,
        /// How long the gap is: between its two samples, or from the nearest one to `at_ns`.
        gap_ns: u64,
        /// The longest that is trusted: [`SensorClock::max_gap_ns`](crate::SensorClock::max_gap_ns).
        max_gap_ns: u64,
    },
}

impl Display for TrajectoryGap {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing(stream) => write!(formatter, "no {stream}: not a single sample"),
            Self::Stale { stream, at_ns, gap_ns, max_gap_ns } => write!(
                formatter,
                "no {stream} at {at_ns} ns: a gap of {gap_ns} ns, but at most {max_gap_ns} ns are trusted"
            ),
        }
    }
}

impl Error for TrajectoryGap {}

/// Why there is no estimate: a property of the scene or of the call, with its number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum FitError {
    /// Fewer than two samples (three with a tilt to be estimated).
    TooFewSamples(usize),
    /// More samples than the solver's table holds.
    TooManySamples,
    /// A sample's column, row, time or sigma is not finite, sigma is not positive, or the lens maps nothing there.
    InvalidSample(usize),
    /// The edges run along the rows at this sample: the camera lies on its side, or the edges' vanishing point is in
    /// view.
    Sideways(usize),
    /// The solution lies beyond the range of the numbers: these samples are not those of an edge.
    Diverged,
}

impl Display for FitError {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFewSamples(count) => write!(formatter, "{count} samples: at least 3 are needed (2 without tilt)"),
            Self::TooManySamples => write!(formatter, "more samples than the solver's table holds"),
            Self::InvalidSample(index) => {
                write!(
                    formatter,
                    "sample {index}: column, row and time must be finite, sigma above zero, the pixel in the image"
                )
            }
            Self::Diverged => write!(formatter, "the solution lies beyond the range of the numbers"),
            Self::Sideways(index) => write!(formatter, "sample {index}: upright edges run along the rows there"),
        }
    }
}

impl Error for FitError {}
