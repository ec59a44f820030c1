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
    /// Further stamps of the row that was begun last lie between these, in nanoseconds, where they are its time: not before
    /// the rows before, and in agreement with the readout where it is asked.
    regular_ns: [i64; 2],
    /// The latest stamp so far.
    latest_ns: i64,
    allowance: Allowance,
    /// The stamps do not rise with the rows, at the pace of the readout: that tells the time.
    pub(crate) is_irregular: bool,
}

/// How far off the stamps of a frame may be, in nanoseconds.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Allowance {
    /// From the first row read to the last one.
    frame_ns: i64,
    /// Before and after that, of stamps that agree with the readout.
    margin_ns: i64,
    /// Of those that do not.
    most_lag_ns: i64,
}

impl Allowance {
    fn of<S: Scalar>(setup: &Setup<S>) -> Self {
        let last = setup.readout().row_after(setup.readout().rows());
        let frame_ns = setup.readout().row_time_ns(last);
        let margin_ns = part_of(frame_ns, READOUT_PART) + half_exposure_ns(setup) + MOST_JITTER_NS;
        let most_lag_ns = margin_ns.max(part_of(frame_ns, 100) * MOST_LAG_PERCENT);
        Self { frame_ns, margin_ns, most_lag_ns }
    }
}

/// Two stamps may be so far off each other by the jitter of an interrupt.
const MOST_JITTER_NS: i64 = 100_000;

/// A readout may be off by one part in so many.
const READOUT_PART: u32 = 20;

/// Stamps that fall behind by so large a part of the frame, in percent, are no ticks or blocks, but something else.
const MOST_LAG_PERCENT: i64 = 40;

/// No stamp lies between these.
const NONE_NS: [i64; 2] = [1, 0];

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
        let allowance = Allowance::of(setup);
        Self { first_deviation_ns, first_ns, regular_ns: NONE_NS, latest_ns: i64::MIN, allowance, is_irregular: false }
    }

    /// Takes a further stamp of a row that has begun where that is its time.
    #[inline(always)]
    pub(crate) fn takes(&mut self, stamp_ns: i64) -> bool {
        let [from_ns, to_ns] = self.regular_ns;
        let is_time = (from_ns..=to_ns).contains(&stamp_ns);
        if is_time {
            self.latest_ns = self.latest_ns.max(stamp_ns);
        }
        is_time
    }

    /// Takes another further stamp of such a row and returns the row's time.
    ///
    /// *Errors*: as [`Self::begin_row`].
    pub(crate) fn time_ns<S: Scalar>(&mut self, setup: &Setup<S>, row: u16, stamp_ns: i64) -> Result<i64, EdgeError> {
        let [from_ns, _] = self.regular_ns;
        let time_ns = self.time_after(setup, row, stamp_ns, from_ns)?;
        self.latest_ns = self.latest_ns.max(stamp_ns);
        Ok(time_ns)
    }

    /// Takes the first stamp of a row and returns the row's time.
    ///
    /// *Errors*: [`EdgeError::TimeRange`], [`EdgeError::TimeOrder`] and [`EdgeError::Stamp`], where nothing changes.
    #[inline(always)]
    pub(crate) fn begin_row<S: Scalar>(&mut self, setup: &Setup<S>, row: u16, stamp_ns: i64) -> Result<i64, EdgeError> {
        let time_ns = self.time_after(setup, row, stamp_ns, self.latest_ns)?;
        self.latest_ns = self.latest_ns.max(stamp_ns);
        Ok(time_ns)
    }

    /// A row's time, given the earliest stamp that does not come before those of the rows before.
    #[inline(never)]
    fn time_after<S: Scalar>(
        &mut self,
        setup: &Setup<S>,
        row: u16,
        stamp_ns: i64,
        before_ns: i64,
    ) -> Result<i64, EdgeError> {
        const HOUR_NS: i64 = 3_600_000_000_000;
        let policy = setup.stamp_policy();
        if policy == StampPolicy::Ignored {
            return Ok(setup.readout().row_time_ns(row));
        }
        if !(-HOUR_NS..=HOUR_NS).contains(&stamp_ns) {
            return Err(EdgeError::TimeRange { time_ns: stamp_ns });
        }
        if policy == StampPolicy::Checked {
            return self.check(setup, row, stamp_ns, before_ns);
        }
        if stamp_ns < before_ns {
            return Err(EdgeError::TimeOrder { time_ns: stamp_ns, previous_ns: before_ns });
        }
        self.regular_ns = [before_ns.max(-HOUR_NS), HOUR_NS];
        Ok(stamp_ns)
    }

    fn check<S: Scalar>(
        &mut self,
        setup: &Setup<S>,
        row: u16,
        stamp_ns: i64,
        before_ns: i64,
    ) -> Result<i64, EdgeError> {
        let expected_ns = setup.readout().row_time_ns(row);
        let Allowance { frame_ns, margin_ns, most_lag_ns } = self.allowance;
        let usual_ns = expected_ns.saturating_add(self.first_deviation_ns);
        let deviation_ns = stamp_ns.saturating_sub(usual_ns).saturating_abs();
        let elapsed_ns = expected_ns.saturating_sub(self.first_ns);
        let most_ns = MOST_JITTER_NS + part_of(elapsed_ns, READOUT_PART);
        let is_irregular = self.is_irregular || deviation_ns > most_ns || stamp_ns < before_ns;
        // Ticks and late rows may reach beyond the frame.
        let beside_ns = if is_irregular { most_lag_ns } else { margin_ns };
        let is_within = (-beside_ns..=frame_ns.saturating_add(beside_ns)).contains(&stamp_ns);
        if !is_within || deviation_ns > most_lag_ns {
            return Err(EdgeError::Stamp { row, time_ns: stamp_ns, expected_ns });
        }
        self.is_irregular = is_irregular;
        let most_ns = most_ns.min(most_lag_ns);
        self.regular_ns = if is_irregular {
            NONE_NS
        } else {
            [
                usual_ns.saturating_sub(most_ns).max(-margin_ns).max(before_ns),
                usual_ns.saturating_add(most_ns).min(frame_ns.saturating_add(margin_ns)),
            ]
        };
        Ok(if is_irregular { expected_ns } else { stamp_ns })
    }
}

/// A stamp may mean either end of the exposure, of which the time of a row is the middle.
fn half_exposure_ns<S: Scalar>(setup: &Setup<S>) -> i64 {
    setup.motion_blur().map_or(0, |blur| (blur.exposure_s * S::from_i32(500_000_000)).to_i64())
}
