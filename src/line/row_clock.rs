//! [`RowClock`]: whether the stamps of a frame's rows agree with the readout.

use crate::error::EdgeError;
use crate::scalar::Scalar;
use crate::setup::{Setup, StampPolicy};

/// The stamps of the rows so far, against the readout.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct RowClock {
    /// The stamp of the first row minus its time by the readout.
    first_deviation_ns: i64,
    /// The same row's time by the readout.
    first_ns: i64,
    /// The stamps do not rise with the rows: the readout tells the time.
    pub(crate) is_irregular: bool,
}

/// Two stamps may be so far off each other by the jitter of an interrupt.
const MOST_JITTER_NS: i64 = 100_000;

/// A readout may be off by one part in so many.
const READOUT_PART: i64 = 20;

/// Stamps that fall behind by so large a part of the frame, in percent, are no ticks or blocks, but something else.
const MOST_LAG_PERCENT: i64 = 40;

impl RowClock {
    /// With the stamp of the first row.
    pub(crate) fn new<S: Scalar>(setup: &Setup<S>, row: u16, stamp_ns: i64) -> Self {
        let first_ns = setup.readout().row_time_ns(row);
        Self { first_deviation_ns: stamp_ns.saturating_sub(first_ns), first_ns, is_irregular: false }
    }

    /// Takes the stamp of a row and returns the row's time.
    ///
    /// *Errors*: [`EdgeError::Stamp`], where nothing changes.
    pub(crate) fn time_ns<S: Scalar>(&mut self, setup: &Setup<S>, row: u16, stamp_ns: i64) -> Result<i64, EdgeError> {
        let expected_ns = setup.readout().row_time_ns(row);
        match setup.stamp_policy() {
            StampPolicy::Trusted => return Ok(stamp_ns),
            StampPolicy::Ignored => return Ok(expected_ns),
            StampPolicy::Checked => {}
        }
        let last = setup.readout().row_after(setup.readout().rows());
        let frame_ns = setup.readout().row_time_ns(last);
        let margin_ns = frame_ns / READOUT_PART + exposure_ns(setup) + MOST_JITTER_NS;
        let most_lag_ns = margin_ns.max(frame_ns / 100 * MOST_LAG_PERCENT);
        let deviation_ns =
            stamp_ns.saturating_sub(expected_ns).saturating_sub(self.first_deviation_ns).saturating_abs();
        let elapsed_ns = expected_ns.saturating_sub(self.first_ns);
        let is_irregular = self.is_irregular || deviation_ns > MOST_JITTER_NS + elapsed_ns / READOUT_PART;
        // Ticks and late rows may reach beyond the frame.
        let beside_ns = if is_irregular { most_lag_ns } else { margin_ns };
        let is_within = (-beside_ns..=frame_ns.saturating_add(beside_ns)).contains(&stamp_ns);
        if !is_within || deviation_ns > most_lag_ns {
            return Err(EdgeError::Stamp { row, time_ns: stamp_ns, expected_ns });
        }
        self.is_irregular = is_irregular;
        Ok(if self.is_irregular { expected_ns } else { stamp_ns })
    }
}

/// A stamp may mean either end of the exposure.
fn exposure_ns<S: Scalar>(setup: &Setup<S>) -> i64 {
    setup.motion_blur().map_or(0, |blur| (blur.exposure_s * S::from_i32(1_000_000_000)).to_i64())
}
