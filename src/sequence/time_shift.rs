//! [`TimeShift`]: the one time by which all known edges are off. docs/model.md, section 8.9.

use heapless::Vec;

use super::continuity::asked;
use super::gate::deviation;
use super::landmark::{Landmark, static_sigma};
use super::line_observation::LineObservation;
use super::propagation::FrameTransition;
use super::tuning::{BINS, BINS_EACH, COUNTED_TWICE, LEAST_ASKED, LEAST_FRAMES, MOST_ASKED, SURE_PART, WINDOWS};
use crate::motion::Motion;
use crate::range::{Covariance, Line3};
use crate::scalar::Scalar;
use crate::setup::Setup;

/// How much later than told a frame was taken, in intervals.
pub(super) struct TimeShift<S> {
    pub(super) intervals: S,
    pub(super) sigma: S,
}

impl<S: Scalar> TimeShift<S> {
    /// Whether the frame was taken when the one before was.
    pub(super) fn is_repetition(&self) -> bool {
        (self.intervals + S::ONE).abs() < (self.sigma * S::from_i32(3)).max(S::ratio(1, 100))
    }
}

/// An edge that votes.
struct Voter<'k, S> {
    landmark: &'k Landmark<S>,
    total: Covariance<S>,
    /// The bins that its lines vote for.
    bins: u64,
}

/// Edges that vote on lines of a frame.
pub(super) struct Vote<'k, S, M> {
    motion: &'k M,
    interval_s: S,
    voters: Vec<Voter<'k, S>, MOST_ASKED>,
}

impl<'k, S: Scalar, M: Motion<S>> Vote<'k, S, M> {
    pub(super) fn new(setup: &Setup<S>, motion: &'k M, known: &'k [Landmark<S>], interval_s: S) -> Self {
        let sure = asked(known).filter(|landmark| landmark.frames >= LEAST_FRAMES);
        let voter = |landmark: &'k Landmark<S>| Voter { landmark, total: landmark.total(setup), bins: 0 };
        Self { motion, interval_s, voters: sure.map(voter).take(MOST_ASKED).collect() }
    }

    /// The shift on which most edges agree; `None` where fewer do, or where they agree as well on another one.
    pub(super) fn shift<I: Iterator<Item = LineObservation<S>>>(
        mut self,
        lines: impl Fn() -> I,
    ) -> Option<TimeShift<S>> {
        lines().for_each(|line| self.vote(&line));
        let mut shift = TimeShift { intervals: self.elected()?, sigma: S::ONE };
        for window in WINDOWS {
            shift = self.refined(shift.intervals, S::ratio(window, 100), lines())?;
        }
        Some(shift)
    }

    fn vote(&mut self, line: &LineObservation<S>) {
        let (motion, interval_s) = (self.motion, self.interval_s);
        for voter in &mut self.voters {
            let shift = voter.rest(motion, interval_s, S::ZERO, line);
            let bin = shift.map(|shift| ((shift.intervals * S::from_i32(BINS_EACH)) + S::from_i32(BINS / 2)).to_i64());
            let bit = bin.and_then(|bin| u32::try_from(bin).ok()).and_then(|bin| 1_u64.checked_shl(bin));
            voter.bins |= bit.unwrap_or(0);
        }
    }

    /// The middle of the bin that, with its neighbours, has most votes.
    fn elected(&self) -> Option<S> {
        let votes = |bin: i32| {
            let around = (0b111_u128 << bin >> 1) as u64;
            i32::try_from(self.voters.iter().filter(|voter| voter.bins & around != 0).count()).unwrap_or(i32::MAX)
        };
        let best = (0..BINS).max_by_key(|bin| votes(*bin))?;
        // The middle of a plateau.
        let last = (best - 2..=best).rev().find(|bin| votes(*bin) == votes(best))?;
        let first = (best - 2..=last).find(|bin| votes(*bin) == votes(best))?;
        let all = i32::try_from(self.voters.len()).unwrap_or(i32::MAX);
        let others = (0..BINS).filter(|bin| (bin - best).abs() > 4).map(votes).max().unwrap_or(0);
        let is_elected = votes(best) >= LEAST_ASKED && 2 * votes(best) > all && 4 * others < 3 * votes(best);
        is_elected.then(|| S::ratio(first + best + 1 - BINS, 2 * BINS_EACH))
    }

    /// The weighted mean of the pairs within a window around a shift.
    fn refined(
        &self,
        intervals: S,
        window: S,
        lines: impl Iterator<Item = LineObservation<S>>,
    ) -> Option<TimeShift<S>> {
        let (mut sum, mut weights, mut pairs) = (S::ZERO, S::ZERO, 0);
        for line in lines {
            for voter in &self.voters {
                let rest = voter.rest(self.motion, self.interval_s, intervals, &line);
                if let Some(rest) = rest.filter(|rest| rest.intervals.abs() < window) {
                    let weight = S::ONE / (rest.sigma * rest.sigma);
                    (sum, weights, pairs) = (sum + weight * rest.intervals, weights + weight, pairs + 1);
                }
            }
        }
        let shift =
            TimeShift { intervals: intervals + sum / weights, sigma: (S::from_i32(COUNTED_TWICE) / weights).sqrt() };
        (pairs >= LEAST_ASKED && shift.intervals.is_finite() && shift.sigma.is_finite()).then_some(shift)
    }
}

impl<S: Scalar> Voter<'_, S> {
    /// How much later than `after` intervals this edge was where a line is; `None` where the line is none of its own,
    /// or tells it too badly.
    fn rest<M: Motion<S>>(
        &self,
        motion: &M,
        interval_s: S,
        after: S,
        line: &LineObservation<S>,
    ) -> Option<TimeShift<S>> {
        let landmark = self.landmark;
        if !landmark.may_show(line) {
            return None;
        }
        let at = |intervals: S| -> Option<(S, S)> {
            let line3 = moved(motion, &landmark.state.line3, intervals * interval_s)?;
            let (px, sensitivity) = deviation(&line3, &line.middle)?;
            Some((px, self.total.variance_along(sensitivity)))
        };
        let half = S::ratio(1, 2);
        let ((px, variance), (before, _), (later, _)) = (at(after)?, at(after - half)?, at(after + half)?);
        let per_interval = before - later;
        let rest = TimeShift {
            intervals: px / per_interval,
            sigma: static_sigma(variance.max(S::ZERO).sqrt()) / per_interval.abs(),
        };
        let is_sure = rest.sigma > S::ZERO && rest.sigma * S::from_i32(SURE_PART) < S::ONE;
        (rest.intervals.is_finite() && is_sure).then_some(rest)
    }
}

/// A line as the camera sees it at another time of the same motion.
fn moved<S: Scalar, M: Motion<S>>(motion: &M, line3: &Line3<S>, elapsed_s: S) -> Option<Line3<S>> {
    if elapsed_s == S::ZERO {
        return Some(*line3);
    }
    FrameTransition::within(motion, elapsed_s, line3.gravity).line(line3)
}
