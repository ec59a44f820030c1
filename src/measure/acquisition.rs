//! The first stamps: what period do most of them agree on, and which of them disagree?
//!
//! Late and missed interrupts are among them from the beginning, so everything here is a median: of the intervals for
//! the number of periods between two stamps, of the slopes of all pairs for the period (Theil and Sen), of the
//! residuals for the phase. The scatter is what two thirds of them do not reach.

use heapless::Vec;

use super::timer::{FRACTION_BITS, Timer};
use super::tuning::{
    ACQUISITION_PAIRS, ACQUISITION_STAMPS, FEWEST_TO_TELL_OUTLIERS, FULL_GATE_DEVIATIONS,
    LEAST_DEVIATIONS_IN_WIDEST_GATE, LEAST_GATE_TICKS, MISSED_BEYOND_A_TURN, PARTIAL_GATE_DEVIATIONS, SHARE_OF_A_HALF,
    WIDEST_GATES_PER_PERIOD, WIDEST_GATES_PER_TURN,
};

/// A stamp in periods and ticks since the first one.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub(super) periods: i64,
    pub(super) ticks: i64,
}

type Points = Vec<Point, ACQUISITION_STAMPS>;

/// What the first stamps agree on.
pub(super) struct Lock {
    /// In 1/65536 tick, as all here with that ending.
    pub(super) period_q16: i64,
    pub(super) gate_q16: i64,
    /// Two thirds of the stamps lie nearer to the line than this.
    pub(super) deviation_q16: i64,
    /// The stamps that lie on the line.
    pub(super) points: Points,
    /// The last of them as it was read, and how far the line passes after it.
    pub(super) last_stamp: u32,
    pub(super) offset_q16: i64,
}

/// `None` where there are fewer than two stamps or fewer than two thirds agree.
///
/// *Cost*: 36 divisions of 64 bits and some thousand comparisons, once.
pub(super) fn lock(timer: &Timer, stamps: &[u32], expected_q16: Option<i64>) -> Option<Lock> {
    let (points, kept) = match expected_q16 {
        Some(expected_q16) => count_by_expectation(timer, stamps, expected_q16),
        None => count_by_median(timer, stamps)?,
    };
    let period_q16 = median_slope(&points)?;
    let residual = |point: &Point| (point.ticks << FRACTION_BITS) - point.periods * period_q16;
    let phase_q16 = quantile(points.iter().map(residual), 1, 2)?;
    let deviation_q16 = quantile(points.iter().map(|point| (residual(point) - phase_q16).abs()), 2, 3)?;
    if is_noise(timer, deviation_q16, period_q16) {
        return None;
    }
    let wanted_q16 = match points.len() {
        ACQUISITION_STAMPS => FULL_GATE_DEVIATIONS * deviation_q16,
        FEWEST_TO_TELL_OUTLIERS.. => PARTIAL_GATE_DEVIATIONS * deviation_q16,
        _ => i64::MAX,
    };
    let gate_q16 = gate(timer, wanted_q16, period_q16);
    let mut on_line = Points::new();
    let mut last = None;
    for (point, stamp) in points.iter().zip(&kept) {
        if (residual(point) - phase_q16).abs() <= gate_q16 {
            // There is room: both have the same capacity.
            let _ = on_line.push(*point);
            last = Some((*stamp, phase_q16 - residual(point)));
        }
    }
    let (last_stamp, offset_q16) = last?;
    let enough = on_line.len() >= 2 && 3 * on_line.len() >= 2 * stamps.len();
    enough.then_some(Lock { period_q16, gate_q16, deviation_q16, points: on_line, last_stamp, offset_q16 })
}

/// A gate between what rounding asks for and what keeps neighbours apart.
pub(super) fn gate(timer: &Timer, wanted_q16: i64, period_q16: i64) -> i64 {
    wanted_q16.max(LEAST_GATE_TICKS << FRACTION_BITS).min(widest_gate(timer, period_q16))
}

/// Whether stamps deviate so much that they might lie anywhere.
pub(super) fn is_noise(timer: &Timer, deviation_q16: i64, period_q16: i64) -> bool {
    deviation_q16 > widest_gate(timer, period_q16) / LEAST_DEVIATIONS_IN_WIDEST_GATE
}

fn widest_gate(timer: &Timer, period_q16: i64) -> i64 {
    let turn_q16 = timer.turn() << FRACTION_BITS;
    (period_q16 / WIDEST_GATES_PER_PERIOD).min(turn_q16 / WIDEST_GATES_PER_TURN)
}

type Kept = Vec<u32, ACQUISITION_STAMPS>;

/// Periods shorter than a turn: the usual interval is one period.
fn count_by_median(timer: &Timer, stamps: &[u32]) -> Option<(Points, Kept)> {
    let intervals = stamps.iter().zip(stamps.iter().skip(1));
    let intervals = intervals.map(|(&earlier, &later)| i64::from(timer.ticks_between(earlier, later)));
    let usual = usual_interval(intervals.clone())?;
    let mut ticks = 0;
    let (mut points, mut kept) = (Points::new(), Kept::new());
    let first = stamps.first()?;
    let _ = (points.push(Point { periods: 0, ticks }), kept.push(*first));
    for (interval, stamp) in intervals.zip(stamps.iter().skip(1)) {
        ticks += interval;
        let periods = (ticks + usual / 2).checked_div(usual)?;
        // Two stamps in one period: the second is a stray.
        if points.last().is_none_or(|last: &Point| periods > last.periods) {
            let _ = (points.push(Point { periods, ticks }), kept.push(*stamp));
        }
    }
    Some((points, kept))
}

/// The median, or half of it where a quarter of the intervals are that short: then every second interrupt was missed.
fn usual_interval(intervals: impl Iterator<Item = i64> + Clone) -> Option<i64> {
    let (median, short) = (quantile(intervals.clone(), 1, 2)?, quantile(intervals, 1, 4)?);
    let is_half = (2 * short - median).abs() < median / SHARE_OF_A_HALF;
    Some(if is_half { short } else { median })
}

/// Periods that may be longer than a turn: the fewest that fit what the counter shows.
fn count_by_expectation(timer: &Timer, stamps: &[u32], expected_q16: i64) -> (Points, Kept) {
    let (mut points, mut kept) = (Points::new(), Kept::new());
    let (mut periods, mut ticks_q16) = (0, 0);
    let tolerance_q16 = gate(timer, i64::MAX, expected_q16);
    for &stamp in stamps {
        if let Some(&previous) = kept.last() {
            let shown_q16 = i64::from(timer.ticks_between(previous, stamp)) << FRACTION_BITS;
            let fits = |count: &i64| timer.wrapped(shown_q16 - count * expected_q16).abs() <= tolerance_q16;
            let Some(count) = (1..=MISSED_BEYOND_A_TURN + 1).find(fits) else { continue };
            periods += count;
            ticks_q16 += count * expected_q16 + timer.wrapped(shown_q16 - count * expected_q16);
        }
        let _ = (points.push(Point { periods, ticks: ticks_q16 >> FRACTION_BITS }), kept.push(stamp));
    }
    (points, kept)
}

fn median_slope(points: &Points) -> Option<i64> {
    let mut slopes: Vec<i64, ACQUISITION_PAIRS> = Vec::new();
    for (index, a) in points.iter().enumerate() {
        for b in points.iter().skip(index + 1) {
            let rise_q16 = (b.ticks - a.ticks) << FRACTION_BITS;
            let _ = slopes.push(rise_q16.checked_div(b.periods - a.periods)?);
        }
    }
    quantile(slopes.iter().copied(), 1, 2).filter(|slope| *slope > 0)
}

/// The value that so large a share of all does not reach: the median for one half. `None` of nothing.
///
/// By counting, because there are 36 values at most, and a sort of the standard library can panic.
fn quantile(values: impl Iterator<Item = i64> + Clone, numerator: usize, denominator: usize) -> Option<i64> {
    let rank = (values.clone().count() * numerator).checked_div(denominator)?;
    let count = |condition: &dyn Fn(&i64) -> bool| values.clone().filter(condition).count();
    values.clone().find(|value| count(&|other| other < value) <= rank && rank < count(&|other| other <= value))
}
