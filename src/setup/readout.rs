//! [`Readout`]: when each row of a frame is exposed.

use crate::error::ParameterError;

/// The order in which the rows of the *image* are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ReadoutDirection {
    /// Row 0 is read first.
    #[default]
    TopToBottom,
    /// The last row is read first: the image was turned upside down after it was read.
    BottomToTop,
}

/// Line time, number of rows and direction of a rolling shutter.
///
/// The line time runs from the start of one row to the start of the next, *per row of the output image*: a sensor that
/// skips or scales rows spends several of its own line times on one row of the image. It is neither the exposure nor
/// the frame interval divided by the number of rows. A row's time is the middle of its exposure, counted from that of
/// the row read first.
///
/// ```
/// use shutter_range::{Readout, ReadoutDirection};
/// // An OV7670 at 24 MHz: 784 pixel periods of two clocks each, 480 rows.
/// let readout = Readout::from_line_length(480, 784 * 2, 24_000_000, 480, ReadoutDirection::TopToBottom)?;
/// assert_eq!(readout.line_time_ps(), 65_333_333);
/// assert_eq!(readout.row_time_ns(3), 196_000);
/// # Ok::<(), shutter_range::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "RawReadout"))]
pub struct Readout {
    rows: u16,
    line_time_ps: u64,
    direction: ReadoutDirection,
    /// The line time once more, in whole nanoseconds and what is left of it: a row's time then needs no quotient of 64
    /// bits.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    whole_ns: u64,
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    rest_ps: u16,
}

/// One minute: slower than any sensor, and small enough that no sum of times can overflow.
const MAX_FRAME_READOUT_PS: u64 = 60_000_000_000_000;

impl Readout {
    /// From the line time in picoseconds (nanoseconds alone would cost up to 8·10⁻⁵ of the distance).
    ///
    /// *Errors*: zero rows; a line time of zero, or one that makes the frame longer than a minute.
    pub const fn from_line_time_ps(
        rows: u16,
        line_time_ps: u64,
        direction: ReadoutDirection,
    ) -> Result<Self, ParameterError> {
        if rows == 0 {
            return Err(ParameterError::new("rows", 0.0, "at least 1"));
        }
        if line_time_ps == 0 || line_time_ps > MAX_FRAME_READOUT_PS / rows as u64 {
            let expected = "above zero (a global shutter has no effect to measure), and a frame below one minute";
            return Err(ParameterError::of_whole("line_time_ps", line_time_ps, expected));
        }
        let (whole_ns, rest_ps) = (line_time_ps / 1000, (line_time_ps % 1000) as u16);
        Ok(Self { rows, line_time_ps, direction, whole_ns, rest_ps })
    }

    /// From the readout time of the whole frame in nanoseconds: rows × line time.
    ///
    /// *Errors*: zero rows; a readout of zero or above one minute.
    pub const fn from_frame_readout_ns(
        rows: u16,
        frame_readout_ns: u64,
        direction: ReadoutDirection,
    ) -> Result<Self, ParameterError> {
        if frame_readout_ns == 0 || frame_readout_ns > MAX_FRAME_READOUT_PS / 1000 {
            let expected = "above zero (a global shutter has no effect to measure) and at most one minute";
            return Err(ParameterError::of_whole("frame_readout_ns", frame_readout_ns, expected));
        }
        match divide_rounding(frame_readout_ns * 1000, rows as u64) {
            Some(line_time_ps) => Self::from_line_time_ps(rows, line_time_ps, direction),
            None => Err(ParameterError::new("rows", 0.0, "at least 1")),
        }
    }

    /// From a sensor's registers: line length in clocks (HTS), clock frequency, and the number of sensor rows that are
    /// read for the `rows` of the image (960 for 480 rows with every second one skipped or binned late).
    ///
    /// *Errors*: a zero among the arguments; a line time out of range.
    pub const fn from_line_length(
        rows: u16,
        line_length_clocks: u32,
        clock_hz: u32,
        sensor_rows: u16,
        direction: ReadoutDirection,
    ) -> Result<Self, ParameterError> {
        if sensor_rows == 0 {
            return Err(ParameterError::new("sensor_rows", 0.0, "at least 1"));
        }
        let clocks = line_length_clocks as u128 * sensor_rows as u128;
        let divisor = clock_hz as u128 * rows as u128;
        let Some(line_time_ps) = (clocks * 1_000_000_000_000 + divisor / 2).checked_div(divisor) else {
            return Err(ParameterError::new("clock_hz × rows", 0.0, "above zero"));
        };
        let line_time_ps = if line_time_ps > u64::MAX as u128 { u64::MAX } else { line_time_ps as u64 };
        Self::from_line_time_ps(rows, line_time_ps, direction)
    }

    /// Number of rows of the image.
    #[must_use]
    pub const fn rows(&self) -> u16 {
        self.rows
    }

    /// Time from the start of one row to the start of the next, in picoseconds.
    #[must_use]
    pub const fn line_time_ps(&self) -> u64 {
        self.line_time_ps
    }

    /// The order in which rows are read.
    #[must_use]
    pub const fn direction(&self) -> ReadoutDirection {
        self.direction
    }

    /// How many rows were read before `row`. Rows outside the image count as the nearest one inside.
    #[must_use]
    pub const fn rows_before(&self, row: u16) -> u16 {
        let last = self.rows.saturating_sub(1);
        let row = if row < last { row } else { last };
        match self.direction {
            ReadoutDirection::TopToBottom => row,
            ReadoutDirection::BottomToTop => last - row,
        }
    }

    /// The row that is read after `rows_before` others; the last one where there are not so many.
    #[must_use]
    pub const fn row_after(&self, rows_before: u16) -> u16 {
        // Counting rows from either end is its own inverse.
        self.rows_before(rows_before)
    }

    /// Middle of the exposure of `row` in nanoseconds since frame start, rounded once from an exact product.
    #[must_use]
    pub const fn row_time_ns(&self, row: u16) -> i64 {
        let rows = self.rows_before(row);
        (rows as u64 * self.whole_ns + thousandth(rows as u32 * self.rest_ps as u32 + 500) as u64) as i64
    }
}

/// One of a thousand parts of a number below 2²⁶, rounded down: cores without division take more than a hundred
/// instructions for one, and every row of pixels asks for it.
const fn thousandth(number: u32) -> u32 {
    // 1024 are one thousand and 24 more, as often as that holds.
    let (first, rest) = (number >> 10, (number >> 10) * 24 + (number & 1023));
    let (second, rest) = (rest >> 10, (rest >> 10) * 24 + (rest & 1023));
    // One over a thousand is good to 2⁻²⁸, for what is below 2¹⁷.
    first + second + (((rest >> 3) * 33_555) >> 22)
}

const fn divide_rounding(numerator: u64, denominator: u64) -> Option<u64> {
    (numerator + denominator / 2).checked_div(denominator)
}

#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct RawReadout {
    rows: u16,
    line_time_ps: u64,
    direction: ReadoutDirection,
}

#[cfg(feature = "serde")]
impl TryFrom<RawReadout> for Readout {
    type Error = ParameterError;

    fn try_from(raw: RawReadout) -> Result<Self, ParameterError> {
        Self::from_line_time_ps(raw.rows, raw.line_time_ps, raw.direction)
    }
}

#[cfg(test)]
mod tests {
    use super::thousandth;

    #[test]
    fn a_thousandth_is_rounded_down() {
        let multiples = (0..1 << 26).step_by(1000);
        for number in multiples.flat_map(|number: u32| [number, number + 1, number + 500, number + 999]) {
            assert_eq!(thousandth(number), number / 1000, "{number}");
        }
    }
}
