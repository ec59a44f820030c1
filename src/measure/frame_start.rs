//! [`FrameStart`]: when a frame began, from its VSYNC.

use crate::error::ParameterError;

/// The time from VSYNC to frame start: blanking rows, and back by half an exposure.
///
/// *Frame start* is the middle of the exposure of the row that is read first. VSYNC comes so many blanking rows before
/// that row is read, and the row's exposure ends when it is read:
///
/// frame start = VSYNC + blanking rows × line time − exposure / 2
///
/// ```
/// use shutter_range::measure::FrameStart;
/// // 20 blanking rows of 65.3 µs, 4 ms of exposure: frame start is before VSYNC.
/// let start = FrameStart::new(20, 65_333_333)?.with_exposure_ns(4_000_000)?;
/// assert_eq!(start.frame_start_ns(10_000_000), 10_000_000 + 1_306_667 - 2_000_000);
/// # Ok::<(), shutter_range::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FrameStart {
    blanking_ps: u64,
    exposure_ns: u64,
}

/// One minute, the longest frame there is: sums of such times cannot overflow.
const LONGEST_PS: u64 = 60_000_000_000_000;

impl FrameStart {
    /// So many rows between VSYNC and the start of the first row's readout, of the *sensor's* line time in picoseconds,
    /// and no exposure.
    ///
    /// *Errors*: blanking of more than a minute.
    pub const fn new(blanking_rows: u16, line_time_ps: u64) -> Result<Self, ParameterError> {
        let blanking_ps = line_time_ps.saturating_mul(blanking_rows as u64);
        if blanking_ps > LONGEST_PS {
            return Err(ParameterError::new("line_time_ps", line_time_ps as f64, "short: blanking below one minute"));
        }
        Ok(Self { blanking_ps, exposure_ns: 0 })
    }

    /// From one stamp of VSYNC and one of the first line-valid after it, in nanoseconds: what no data sheet says.
    ///
    /// *Errors*: line-valid before VSYNC, or more than a minute after it.
    pub const fn from_stamps_ns(vsync_ns: i64, first_line_ns: i64) -> Result<Self, ParameterError> {
        let blanking_ns = first_line_ns.saturating_sub(vsync_ns);
        if blanking_ns < 0 || blanking_ns as u64 > LONGEST_PS / 1000 {
            return Err(ParameterError::new("first_line_ns", blanking_ns as f64, "0 to one minute after vsync_ns"));
        }
        Ok(Self { blanking_ps: blanking_ns as u64 * 1000, exposure_ns: 0 })
    }

    /// The same with an exposure in nanoseconds.
    ///
    /// *Errors*: more than a minute.
    pub const fn with_exposure_ns(mut self, exposure_ns: u64) -> Result<Self, ParameterError> {
        if exposure_ns > LONGEST_PS / 1000 {
            return Err(ParameterError::new("exposure_ns", exposure_ns as f64, "at most one minute"));
        }
        self.exposure_ns = exposure_ns;
        Ok(self)
    }

    /// Time from VSYNC to the readout of the first row, in picoseconds.
    #[must_use]
    pub const fn blanking_ps(&self) -> u64 {
        self.blanking_ps
    }

    /// Blanking rows of the sensor's line time in picoseconds, rounded; zero for a line time of zero.
    #[must_use]
    pub const fn blanking_rows(&self, line_time_ps: u64) -> u64 {
        match (self.blanking_ps + line_time_ps / 2).checked_div(line_time_ps) {
            Some(rows) => rows,
            None => 0,
        }
    }

    /// Frame start of the frame whose VSYNC came then, both in nanoseconds of the same clock.
    #[must_use]
    pub const fn frame_start_ns(&self, vsync_ns: i64) -> i64 {
        let after_ps = self.blanking_ps as i64 - self.exposure_ns as i64 * 500;
        // Rounded down, so that it is the same wherever zero is.
        vsync_ns.saturating_add((after_ps + 500).div_euclid(1000))
    }
}
