//! [`Record`]: a range for a wire or a log, with a version.

use core::error::Error;
use core::fmt::{self, Display, Formatter};

use crate::range::{Range, RangeStatus};
use crate::scalar::Scalar;

/// A range for a wire or a log. With the feature `serde` and `postcard` it takes 17 to 28 bytes; a record of another
/// version is refused when it is read, never misread.
///
/// Version 1 is, in this order: the version, a byte; the frame's number; the line's id, if it has one; the status;
/// three 32-bit floats; the number of points. A field is never given another meaning: that would be version 2.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(into = "VersionedRecord", try_from = "VersionedRecord"))]
pub struct Record {
    /// Number of the frame, the sender's.
    pub frame: u32,
    /// Which line of a [`Sequence`](crate::Sequence) it is.
    pub line_id: Option<u32>,
    /// What the numbers are worth.
    pub status: RangeStatus,
    /// Bearing X/Z, positive to the right.
    pub bearing: f32,
    /// Inverse depth per metre. Unlike a depth it says what it knows of a far edge, too.
    pub inverse_depth_per_m: f32,
    /// One standard deviation of it.
    pub sigma_inverse_depth_per_m: f32,
    /// Edge points that it rests on.
    pub points: u16,
}

impl Record {
    /// The version that is written, and the only one that is read.
    pub const VERSION: u8 = 1;

    /// Of a range.
    #[must_use]
    pub fn of_range<S: Scalar>(range: &Range<S>, frame: u32) -> Self {
        let estimate = &range.estimate;
        let to_f32 = |value: S| value.to_f64() as f32;
        Self {
            frame,
            line_id: range.line_id,
            status: range.status,
            bearing: to_f32(estimate.bearing),
            inverse_depth_per_m: to_f32(estimate.inverse_depth_per_m),
            sigma_inverse_depth_per_m: to_f32(estimate.sigma_inverse_depth_per_m),
            points: range.points_used,
        }
    }
}

/// A record of another version than [`Record::VERSION`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RecordVersionError {
    /// The version that was read.
    pub found: u8,
}

impl Display for RecordVersionError {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        write!(formatter, "a record has version {}, but must have version {}", self.found, Record::VERSION)
    }
}

impl Error for RecordVersionError {}

/// What is written: numbers of a fixed meaning.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
struct VersionedRecord {
    version: u8,
    frame: u32,
    line_id: Option<u32>,
    status: RangeStatus,
    numbers: [f32; 3],
    points: u16,
}

#[cfg(feature = "serde")]
impl From<Record> for VersionedRecord {
    fn from(record: Record) -> Self {
        let Record { frame, line_id, status, points, .. } = record;
        let numbers = [record.bearing, record.inverse_depth_per_m, record.sigma_inverse_depth_per_m];
        Self { version: Record::VERSION, frame, line_id, status, numbers, points }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<VersionedRecord> for Record {
    type Error = RecordVersionError;

    fn try_from(written: VersionedRecord) -> Result<Self, RecordVersionError> {
        let VersionedRecord { version, frame, line_id, status, numbers, points } = written;
        if version != Self::VERSION {
            return Err(RecordVersionError { found: version });
        }
        let [bearing, inverse_depth_per_m, sigma_inverse_depth_per_m] = numbers;
        Ok(Self { frame, line_id, status, bearing, inverse_depth_per_m, sigma_inverse_depth_per_m, points })
    }
}
