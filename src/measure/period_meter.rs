//! [`PeriodMeter`]: a period from stamps, one at a time.

use heapless::Vec;

use super::acquisition::{Lock, gate, is_noise, lock};
use super::period::Period;
use super::regression::Regression;
use super::timer::{FRACTION_BITS, Timer};
use super::tuning::{
    ACQUISITION_STAMPS, DEVIATION_SHIFT, GATE_DEVIATIONS, MISSED_BEYOND_A_TURN, MOST_DEVIATIONS, PERIOD_GAIN_SHIFT,
    PHASE_GAIN_SHIFT, STRANGE, TOO_STRANGE,
};
use crate::error::ParameterError;

/// What became of a stamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StampFate {
    /// One of the first: it waits until there are enough to tell which of them are right.
    Waiting,
    /// It was used; so many periods before it had no stamp.
    Used {
        /// Periods without a stamp since the last one that was used.
        missed: u16,
    },
    /// It fits nowhere: late, or a glitch. It was left out and counted.
    Outlier,
}

/// The period of an interrupt from its stamps, with sigma.
///
/// The stamps may jitter, some may be late or missing, and the counter may turn over between them. Those that come in
/// after a pause which is no multiple of the period, or which is longer than a turn of the counter, need a
/// [`gap`](Self::gap) before them: vertical blanking, most often.
///
/// *Range*: periods from 16 ticks to a turn of the counter; longer ones with
/// [`expecting_ps`](Self::expecting_ps). A stamp's jitter should be below a tenth of the period.
///
/// *Cost*: 384 bytes. A stamp takes one 64-bit division and a dozen products, one that fits nowhere a few of them for
/// each period of a turn of the counter; the ninth, which settles the first ones, 36 divisions and some thousand
/// comparisons.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PeriodMeter {
    timer: Timer,
    least_variance_q16: u64,
    expected_q16: Option<i64>,
    waiting: Vec<u32, ACQUISITION_STAMPS>,
    track: Option<Track>,
    regression: Option<Regression>,
    stamps: u32,
    missed: u32,
    outliers: u32,
}

/// Where the next stamp is due. Times are in 1/65536 tick.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Track {
    /// The last stamp that was used, and how far the line passes after it.
    last_stamp: u32,
    offset_q16: i64,
    period_q16: i64,
    gate_q16: i64,
    deviation_q16: i64,
    /// Since the piece began.
    periods: i64,
    ticks: i64,
    strangeness: u8,
}

/// Rounding to a whole tick: 1/12 of a tick squared.
const ROUNDING_VARIANCE_Q16: u64 = (1 << FRACTION_BITS) / 12;

/// Longest period in ticks: nine stamps with four periods missed before each, in 1/65536 tick, stay below 2⁶³.
const LONGEST_TICKS: u64 = 1 << 38;

impl PeriodMeter {
    /// A meter without stamps.
    #[must_use]
    pub const fn new(timer: Timer) -> Self {
        Self {
            timer,
            least_variance_q16: ROUNDING_VARIANCE_Q16,
            expected_q16: None,
            waiting: Vec::new(),
            track: None,
            regression: None,
            stamps: 0,
            missed: 0,
            outliers: 0,
        }
    }

    /// The same, where a stamp is known to jitter by so many ticks, one standard deviation. Fewer than five stamps
    /// cannot show their own scatter: sigma then rests on this, and without it on the rounding to a tick alone.
    #[must_use]
    pub const fn with_jitter_ticks(mut self, sigma_ticks: u16) -> Self {
        self.least_variance_q16 = ((sigma_ticks as u64 * sigma_ticks as u64) << FRACTION_BITS) + ROUNDING_VARIANCE_Q16;
        self
    }

    /// The same, where the period is known roughly, in picoseconds: then it may be longer than a turn of the counter.
    /// Right to 1/16 of a turn, or a quarter of a period if that is less.
    ///
    /// *Errors*: a period of zero, or of more than 2³⁸ ticks.
    pub fn expecting_ps(mut self, period_ps: u64) -> Result<Self, ParameterError> {
        let ticks_q16 = ((period_ps as u128) << FRACTION_BITS) * self.timer.hz() as u128 / 1_000_000_000_000;
        if ticks_q16 == 0 || ticks_q16 >> FRACTION_BITS > LONGEST_TICKS as u128 {
            return Err(ParameterError::new("period_ps", period_ps as f64, "above zero and at most 2^38 ticks"));
        }
        self.expected_q16 = Some(ticks_q16 as i64);
        Ok(self)
    }

    /// Takes the counter's value at an interrupt. Bits above the counter's own are ignored.
    pub fn push(&mut self, stamp: u32) -> StampFate {
        let Some(mut track) = self.track else { return self.wait(stamp) };
        let beyond_a_turn = self.expected_q16.is_some();
        let fate = match track.follow(&self.timer, stamp, beyond_a_turn) {
            Some(periods) => self.add(&mut track, periods),
            None => {
                self.outliers = self.outliers.saturating_add(1);
                track.strangeness += STRANGE;
                StampFate::Outlier
            }
        };
        self.track = Some(track);
        if track.strangeness >= TOO_STRANGE {
            self.gap();
        }
        if is_noise(&self.timer, track.deviation_q16, track.period_q16) {
            // It was none.
            (self.track, self.regression) = (None, None);
        }
        fate
    }

    /// The next stamp comes after a pause of unknown length. What is known of the period stays.
    pub fn gap(&mut self) {
        self.settle();
        self.outliers = self.outliers.saturating_add(self.waiting.len() as u32);
        self.waiting.clear();
        self.track = None;
        if let Some(regression) = &mut self.regression {
            regression.end_piece();
        }
    }

    /// The period so far; `None` before two stamps agree.
    ///
    /// *Cost*: some ten divisions and two roots of 128 bits; before the ninth stamp also what settling costs.
    #[must_use]
    pub fn period(&self) -> Option<Period> {
        let mut settled;
        let meter = if self.waiting.is_empty() {
            self
        } else {
            settled = self.clone();
            settled.settle();
            &settled
        };
        let slope = meter.regression.as_ref()?.slope(meter.least_variance_q16)?;
        let period_ps = meter.timer.ps(slope.period_q32);
        let of_timer = u128::from(period_ps) * u128::from(meter.timer.tolerance_ppm()) / 1_000_000;
        let of_stamps = u128::from(meter.timer.ps(slope.sigma_q32));
        let squares = of_timer.saturating_mul(of_timer).saturating_add(of_stamps.saturating_mul(of_stamps));
        let sigma_ps = u64::try_from(squares.isqrt()).unwrap_or(u64::MAX);
        let Self { stamps, missed, outliers, .. } = *meter;
        Some(Period { period_ps, sigma_ps, stamps, missed, outliers })
    }

    fn wait(&mut self, stamp: u32) -> StampFate {
        if self.waiting.is_full() {
            // They did not agree: the oldest may be to blame.
            let newer = self.waiting.get(1..).and_then(|newer| Vec::from_slice(newer).ok());
            self.waiting = newer.unwrap_or_default();
            self.outliers = self.outliers.saturating_add(1);
        }
        // There is room now.
        let _ = self.waiting.push(stamp);
        if self.waiting.is_full() {
            self.settle();
        }
        StampFate::Waiting
    }

    /// Takes the waiting stamps, as far as they agree.
    fn settle(&mut self) {
        let Some(lock) = lock(&self.timer, &self.waiting, self.expected_q16) else { return };
        self.begin_regression(&lock);
        let left_out = self.waiting.len().saturating_sub(lock.points.len());
        self.outliers = self.outliers.saturating_add(left_out as u32);
        self.waiting.clear();
        let mut track = Track::new(&lock);
        let first = lock.points.first().map_or(0, |point| point.periods);
        let first_ticks = lock.points.first().map_or(0, |point| point.ticks);
        let mut before = first;
        for point in &lock.points {
            track.periods = point.periods - first;
            track.ticks = point.ticks - first_ticks;
            self.count(point.periods - before);
            before = point.periods;
            self.record(&mut track);
        }
        self.track = Some(track);
    }

    /// Goes on with the line of before, unless the period is another one now.
    fn begin_regression(&mut self, lock: &Lock) {
        let reference = (lock.period_q16 + (1 << FRACTION_BITS >> 1)) >> FRACTION_BITS;
        let same = self.regression.as_ref().is_some_and(|known| {
            let difference = (known.reference() - reference).abs() << FRACTION_BITS;
            difference <= lock.gate_q16
        });
        if !same {
            self.regression = Some(Regression::new(reference));
            (self.stamps, self.missed) = (0, 0);
        }
    }

    fn add(&mut self, track: &mut Track, periods: i64) -> StampFate {
        let missed = self.count(periods);
        self.record(track);
        StampFate::Used { missed }
    }

    /// Counts a stamp so many periods after the one before.
    fn count(&mut self, periods: i64) -> u16 {
        let missed = u16::try_from(periods - 1).unwrap_or(0);
        self.stamps = self.stamps.saturating_add(1);
        self.missed = self.missed.saturating_add(u32::from(missed));
        missed
    }

    fn record(&mut self, track: &mut Track) {
        let Some(regression) = &mut self.regression else { return };
        if !regression.push(track.periods, track.ticks) {
            regression.end_piece();
            (track.periods, track.ticks) = (0, 0);
            regression.push(0, 0);
        }
    }
}

impl Track {
    fn new(lock: &Lock) -> Self {
        Self {
            last_stamp: lock.last_stamp,
            offset_q16: lock.offset_q16,
            period_q16: lock.period_q16,
            gate_q16: lock.gate_q16,
            deviation_q16: lock.deviation_q16.max(1 << FRACTION_BITS >> 1),
            periods: 0,
            ticks: 0,
            strangeness: 0,
        }
    }

    /// How many periods after the last stamp this one lies, having moved on to it; `None` where it fits nowhere.
    fn follow(&mut self, timer: &Timer, stamp: u32, beyond_a_turn: bool) -> Option<i64> {
        let shown_q16 = i64::from(timer.ticks_between(self.last_stamp, stamp)) << FRACTION_BITS;
        let most = self.most_periods(timer, beyond_a_turn);
        let error = |periods: i64| timer.wrapped(shown_q16 - self.offset_q16 - periods * self.period_q16);
        let periods = (1..=most).find(|periods| error(*periods).abs() <= self.gate_q16)?;
        let error_q16 = error(periods);
        self.ticks += (self.offset_q16 + periods * self.period_q16 + error_q16) >> FRACTION_BITS;
        self.periods += periods;
        self.last_stamp = stamp;
        self.offset_q16 = (error_q16 >> PHASE_GAIN_SHIFT) - error_q16;
        self.period_q16 += error_q16 >> PERIOD_GAIN_SHIFT;
        let deviation_q16 = error_q16.abs().min(MOST_DEVIATIONS * self.deviation_q16);
        self.deviation_q16 += (deviation_q16 - self.deviation_q16) >> DEVIATION_SHIFT;
        self.gate_q16 = gate(timer, GATE_DEVIATIONS * self.deviation_q16, self.period_q16);
        self.strangeness = self.strangeness.saturating_sub(1);
        Some(periods)
    }

    /// How many periods may lie between two stamps: those of a turn, because a stamp beyond would fit several.
    fn most_periods(&self, timer: &Timer, beyond_a_turn: bool) -> i64 {
        let of_a_turn = (timer.turn() << FRACTION_BITS).checked_div(self.period_q16).unwrap_or(0);
        let least = if beyond_a_turn { MISSED_BEYOND_A_TURN + 1 } else { 1 };
        of_a_turn.clamp(least, i64::from(u16::MAX))
    }
}
