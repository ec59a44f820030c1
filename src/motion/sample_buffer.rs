//! One stream of stamped vectors: which instant a stamp means, for how long a value is trusted, and the value at any
//! time.

use heapless::Deque;

use super::sensor_clock::StampConvention;
use crate::error::{TrajectoryError, TrajectoryGap, TrajectoryStream};
use crate::scalar::{NS_PER_S, Scalar, add, scale, sub};

/// 146 years in nanoseconds: differences of such times cannot overflow.
const MAX_TIME_NS: u64 = 1 << 62;

/// A time difference in seconds; a time itself would have too many digits for single precision.
pub(crate) fn seconds<S: Scalar>(difference_ns: i64) -> S {
    S::from_ratio(difference_ns, NS_PER_S)
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Stamped<S> {
    /// In the camera's clock.
    pub(crate) time_ns: i64,
    pub(crate) value: [S; 3],
}

/// The last `N` samples, the oldest first.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Stream<S, const N: usize> {
    stream: TrajectoryStream,
    /// `None` where there is no such sensor: then there are no samples and no gaps, and the value is zero.
    stamps: Option<StampConvention>,
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    samples: Deque<Stamped<S>, N>,
}

impl<S: Scalar, const N: usize> Stream<S, N> {
    pub(crate) const fn new(stream: TrajectoryStream, stamps: Option<StampConvention>) -> Self {
        Self { stream, stamps, samples: Deque::new() }
    }

    /// Whether there is such a sensor.
    pub(crate) const fn is_declared(&self) -> bool {
        self.stamps.is_some()
    }

    pub(crate) fn clear(&mut self) {
        self.samples.clear();
    }

    pub(crate) fn push(&mut self, stamp_ns: i64, value: [S; 3]) -> Result<(), TrajectoryError> {
        let stream = self.stream;
        let Some(stamps) = &self.stamps else { return Err(TrajectoryError::Undeclared(stream)) };
        let offset_ns = stamps.clock().offset_ns;
        let time_ns = stamp_ns.checked_add(offset_ns).filter(|time_ns| time_ns.unsigned_abs() <= MAX_TIME_NS);
        let Some(time_ns) = time_ns else { return Err(TrajectoryError::StampRange { stream, stamp_ns }) };
        if let Some(last) = self.samples.back().filter(|last| last.time_ns >= time_ns) {
            let previous_ns = last.time_ns.saturating_sub(offset_ns);
            return Err(TrajectoryError::StampOrder { stream, stamp_ns, previous_ns });
        }
        if self.samples.is_full() {
            self.samples.pop_front();
        }
        // Not full: room was made above.
        let _ = self.samples.push_back(Stamped { time_ns, value });
        Ok(())
    }

    /// Whether the values at all times from `from_ns` to `to_ns` are trusted.
    ///
    /// *Errors*: the first gap that is longer than the clock allows.
    pub(crate) fn check_gaps(&self, from_ns: i64, to_ns: i64) -> Result<(), TrajectoryGap> {
        let stream = self.stream;
        let Some(stamps) = &self.stamps else { return Ok(()) };
        let (Some(first), Some(last)) = (self.samples.front(), self.samples.back()) else {
            return Err(TrajectoryGap::Missing(stream));
        };
        let max_gap_ns = stamps.clock().max_gap_ns;
        let check = |from: i64, to: i64, at_ns| match to.saturating_sub(from) {
            gap if gap > 0 && gap.unsigned_abs() > max_gap_ns => {
                Err(TrajectoryGap::Stale { stream, at_ns, gap_ns: gap.unsigned_abs(), max_gap_ns })
            }
            _ => Ok(()),
        };
        check(from_ns, first.time_ns, from_ns)?;
        let pairs = self.samples.iter().zip(self.samples.iter().skip(1));
        for (before, after) in pairs.filter(|(before, after)| after.time_ns > from_ns && before.time_ns < to_ns) {
            check(before.time_ns, after.time_ns, before.time_ns.max(from_ns))?;
        }
        check(last.time_ns, to_ns, to_ns)
    }

    /// Number of samples before a time, those at that time included or not. A binary search.
    pub(crate) fn count_until(&self, time_ns: i64, inclusive: bool) -> usize {
        let until = |sample: &Stamped<S>| sample.time_ns < time_ns || (inclusive && sample.time_ns == time_ns);
        let (older, newer) = self.samples.as_slices();
        older.partition_point(until) + newer.partition_point(until)
    }

    /// The last of the first `count` samples, and the one after it.
    pub(crate) fn around(&self, count: usize) -> (Option<&Stamped<S>>, Option<&Stamped<S>>) {
        (count.checked_sub(1).and_then(|index| self.samples.get(index)), self.samples.get(count))
    }

    /// The value `time_s` after `zero_ns`, which lies between the last of the first `count` samples and the next one.
    /// The first and the last value hold beyond the ends.
    pub(crate) fn value(&self, count: usize, zero_ns: i64, time_s: S) -> [S; 3] {
        match (self.around(count), &self.stamps) {
            ((Some(before), Some(after)), Some(StampConvention::Instant(_))) => {
                interpolate(before.value, after.value, fraction(before, after, zero_ns, time_s))
            }
            ((_, Some(sample)) | (Some(sample), None), _) => sample.value,
            ((None, None), _) => [S::ZERO; 3],
        }
    }
}

/// Where the time `time_s` after `zero_ns` lies between two samples: 0 at the one before, 1 at the one after.
pub(crate) fn fraction<S: Scalar>(before: &Stamped<S>, after: &Stamped<S>, zero_ns: i64, time_s: S) -> S {
    let before_s: S = seconds(before.time_ns.saturating_sub(zero_ns));
    let interval_s = seconds::<S>(after.time_ns.saturating_sub(before.time_ns));
    // NaN where two samples coincide after rounding; `max` then takes the zero.
    ((time_s - before_s) / interval_s).max(S::ZERO).min(S::ONE)
}

pub(crate) fn interpolate<S: Scalar>(before: [S; 3], after: [S; 3], fraction: S) -> [S; 3] {
    add(before, scale(sub(after, before), fraction))
}
