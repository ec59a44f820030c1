//! One stream of stamped vectors: which instant a stamp means, how far a value is trusted, and its value at any time.

use heapless::Deque;

use super::sensor_clock::StampConvention;
use crate::error::{TrajectoryError, TrajectoryGap, TrajectoryStream};
use crate::scalar::{NS_PER_S, Scalar, add, scale, sub};

/// 146 years in nanoseconds: differences of such times cannot overflow.
const MAX_TIME_NS: u64 = 1 << 62;

/// Seconds of a difference of times, which alone is small enough for single precision.
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
    /// `None` where there is no such sensor: no samples, no gaps, and the value is zero.
    stamps: Option<StampConvention>,
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    samples: Deque<Stamped<S>, N>,
}

impl<S: Scalar, const N: usize> Stream<S, N> {
    pub(crate) const fn new(stream: TrajectoryStream, stamps: Option<StampConvention>) -> Self {
        Self { stream, stamps, samples: Deque::new() }
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
        // There is room now.
        let _ = self.samples.push_back(Stamped { time_ns, value });
        Ok(())
    }

    /// Whether all values between two times are trusted.
    pub(crate) fn cover(&self, from_ns: i64, to_ns: i64) -> Result<(), TrajectoryGap> {
        let stream = self.stream;
        let Some(stamps) = &self.stamps else { return Ok(()) };
        let (Some(first), Some(last)) = (self.samples.front(), self.samples.back()) else {
            return Err(TrajectoryGap::Missing(stream));
        };
        let max_gap_ns = stamps.clock().max_gap_ns;
        let trust = |from: i64, to: i64, at_ns| match to.saturating_sub(from) {
            gap if gap > 0 && gap.unsigned_abs() > max_gap_ns => {
                Err(TrajectoryGap::Stale { stream, at_ns, gap_ns: gap.unsigned_abs(), max_gap_ns })
            }
            _ => Ok(()),
        };
        trust(from_ns, first.time_ns, from_ns)?;
        let pairs = self.samples.iter().zip(self.samples.iter().skip(1));
        for (before, after) in pairs.filter(|(before, after)| after.time_ns > from_ns && before.time_ns < to_ns) {
            trust(before.time_ns, after.time_ns, before.time_ns.max(from_ns))?;
        }
        trust(last.time_ns, to_ns, to_ns)
    }

    /// How many samples there are up to a time, that time included or not. A binary search.
    pub(crate) fn count_until(&self, time_ns: i64, inclusive: bool) -> usize {
        let until = |sample: &Stamped<S>| sample.time_ns < time_ns || (inclusive && sample.time_ns == time_ns);
        let (older, newer) = self.samples.as_slices();
        older.partition_point(until) + newer.partition_point(until)
    }

    /// The samples on either side: the last of `count`, and the next one.
    pub(crate) fn around(&self, count: usize) -> (Option<&Stamped<S>>, Option<&Stamped<S>>) {
        (count.checked_sub(1).and_then(|index| self.samples.get(index)), self.samples.get(count))
    }

    /// The value `time_s` after `zero_ns`, between the last of `count` samples and the next one. Held at the ends.
    pub(crate) fn value(&self, count: usize, zero_ns: i64, time_s: S) -> [S; 3] {
        match (self.around(count), &self.stamps) {
            ((Some(before), Some(after)), Some(StampConvention::Instant(_))) => {
                blend(before.value, after.value, part(before, after, zero_ns, time_s))
            }
            ((_, Some(sample)) | (Some(sample), None), _) => sample.value,
            ((None, None), _) => [S::ZERO; 3],
        }
    }
}

/// How far a time is on the way from one sample to the next, 0 to 1.
pub(crate) fn part<S: Scalar>(before: &Stamped<S>, after: &Stamped<S>, zero_ns: i64, time_s: S) -> S {
    let before_s: S = seconds(before.time_ns.saturating_sub(zero_ns));
    let interval_s = seconds::<S>(after.time_ns.saturating_sub(before.time_ns));
    // Samples that coincide after rounding give no number, which `max` leaves out.
    ((time_s - before_s) / interval_s).max(S::ZERO).min(S::ONE)
}

pub(crate) fn blend<S: Scalar>(before: [S; 3], after: [S; 3], part: S) -> [S; 3] {
    add(before, scale(sub(after, before), part))
}
