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
    /// Stamps of the row that was asked about last lie between these where they agree with the readout, in nanoseconds.
    regular_ns: [i64; 2],
    row: u16,
    /// The stamps do not rise with the rows: the readout tells the time.
    pub(crate) is_irregular: bool,
}

/// Two stamps may be so far off each other by the jitter of an interrupt.
const MOST_JITTER_NS: i64 = 100_000;

/// A readout may be off by one part in so many.
const READOUT_PART: u32 = 20;

/// Stamps that fall behind by so large a part of the frame, in percent, are no ticks or blocks, but something else.
const MOST_LAG_PERCENT: i64 = 40;

/// A part of a time: in 32 bits, since a longer quotient costs ten times as much; of more than four seconds in steps of
/// 2¹⁶ ns.
fn part_of(time_ns: i64, parts: u32) -> i64 {
    let of = |time: u32| i64::from(time.checked_div(parts).unwrap_or(0));
    match u32::try_from(time_ns) {
        Ok(short_ns) => of(short_ns),
        // No frame takes days.
        Err(_) => of((time_ns >> 16).clamp(0, u32::MAX.into()) as u32) << 16,
    }
}

impl RowClock {
    /// With the stamp of the first row.
    pub(crate) fn new<S: Scalar>(setup: &Setup<S>, row: u16, stamp_ns: i64) -> Self {
        let first_ns = setup.readout().row_time_ns(row);
        let first_deviation_ns = stamp_ns.saturating_sub(first_ns);
        // None is regular before one has been asked about.
        Self { first_deviation_ns, first_ns, regular_ns: [1, 0], row, is_irregular: false }
    }

    /// Takes the stamp of a row and returns the row's time.
    ///
    /// *Errors*: [`EdgeError::Stamp`], where nothing changes.
    pub(crate) fn time_ns<S: Scalar>(&mut self, setup: &Setup<S>, row: u16, stamp_ns: i64) -> Result<i64, EdgeError> {
        match setup.stamp_policy() {
            StampPolicy::Trusted => return Ok(stamp_ns),
            StampPolicy::Ignored => return Ok(setup.readout().row_time_ns(row)),
            StampPolicy::Checked => {}
        }
        let [from_ns, to_ns] = self.regular_ns;
        if row == self.row && !self.is_irregular && (from_ns..=to_ns).contains(&stamp_ns) {
            return Ok(stamp_ns);
        }
        self.check(setup, row, stamp_ns)
    }

    /// Likewise for the first stamp of a row, or one that disagrees with the readout.
    #[inline(never)]
    fn check<S: Scalar>(&mut self, setup: &Setup<S>, row: u16, stamp_ns: i64) -> Result<i64, EdgeError> {
        let expected_ns = setup.readout().row_time_ns(row);
        let last = setup.readout().row_after(setup.readout().rows());
        let frame_ns = setup.readout().row_time_ns(last);
        let margin_ns = part_of(frame_ns, READOUT_PART) + exposure_ns(setup) + MOST_JITTER_NS;
        let most_lag_ns = margin_ns.max(part_of(frame_ns, 100) * MOST_LAG_PERCENT);
        let usual_ns = expected_ns.saturating_add(self.first_deviation_ns);
        let deviation_ns = stamp_ns.saturating_sub(usual_ns).saturating_abs();
        let elapsed_ns = expected_ns.saturating_sub(self.first_ns);
        let most_ns = MOST_JITTER_NS + part_of(elapsed_ns, READOUT_PART);
        let is_irregular = self.is_irregular || deviation_ns > most_ns;
        // Ticks and late rows may reach beyond the frame.
        let beside_ns = if is_irregular { most_lag_ns } else { margin_ns };
        let is_within = (-beside_ns..=frame_ns.saturating_add(beside_ns)).contains(&stamp_ns);
        if !is_within || deviation_ns > most_lag_ns {
            return Err(EdgeError::Stamp { row, time_ns: stamp_ns, expected_ns });
        }
        (self.is_irregular, self.row) = (is_irregular, row);
        let most_ns = most_ns.min(most_lag_ns);
        self.regular_ns = [
            usual_ns.saturating_sub(most_ns).max(-margin_ns),
            usual_ns.saturating_add(most_ns).min(frame_ns.saturating_add(margin_ns)),
        ];
        Ok(if self.is_irregular { expected_ns } else { stamp_ns })
    }
}

/// A stamp may mean either end of the exposure.
fn exposure_ns<S: Scalar>(setup: &Setup<S>) -> i64 {
    setup.motion_blur().map_or(0, |blur| (blur.exposure_s * S::from_i32(1_000_000_000)).to_i64())
}
