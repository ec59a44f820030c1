//! [`Continuity`]: whether a frame shows the known edges where and when it was told to. docs/model.md, section 8.9.

use super::gate::deviation;
use super::landmark::{Landmark, static_sigma};
use super::line_observation::LineObservation;
use super::propagation::FrameTransition;
use super::tuning::{ALIKE_SIGMAS, LEAST_ASKED, MOST_ASKED, MOST_HIDDEN, MOST_SIGMAS_EACH};
use crate::line::Line;
use crate::motion::Motion;
use crate::range::Line3;
use crate::scalar::{Scalar, hypot};
use crate::setup::Setup;

/// How a frame goes on from those before it: whether all known edges are off alike.
///
/// A frame that was lost, came twice, or was taken earlier or later than told moves all edges along their ways by one
/// time. So does a camera that suddenly moves faster or slower than told; edges at about one depth do not tell the two
/// apart, nor from a turn.
///
/// In two frames time and depth are the same: a frame lost between the first two that show an edge is mostly noticed in
/// the third, and what the second has told of it was wrong. Three frames that agree are sure of it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Continuity<S> {
    /// Known edges are where they should be, or too few of them are seen to say more.
    Steady,
    /// They are off by one time: the frame was taken so much later than told, or earlier if negative. What is known has
    /// been moved on accordingly.
    Shifted {
        /// Seconds to add to the time since the frame before: a whole interval after a lost frame.
        seconds: S,
        /// One standard deviation of it.
        sigma_s: S,
    },
    /// They show what the frame before has shown: it came twice, or the camera stood still. Nothing was learned from
    /// it.
    Repeated,
    /// They are off alike, or nearly none is where it should be, and no one time tells why: all are forgotten, and each
    /// line of this frame stands for itself.
    Restarted,
}

/// What known edges say of a frame.
pub(super) struct Census<S> {
    asked: i32,
    /// Where a static edge can be.
    in_place: i32,
    /// Those in place that several frames have shown.
    sure: i32,
    matched: i32,
    /// How far they are along their ways, in sigmas of each, and which part of their variances they share.
    sum: S,
    shared: S,
}

impl<S: Scalar> Census<S> {
    /// Asks edges of earlier frames about the lines that have been found for them; `interval_s` is the time since the
    /// frame before.
    pub(super) fn of<'l, M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        known: &[Landmark<S>],
        interval_s: S,
        line_at: impl Fn(usize) -> Option<&'l Line<KNOTS>>,
    ) -> Self {
        let mut census = Self { asked: 0, in_place: 0, sure: 0, matched: 0, sum: S::ZERO, shared: S::ZERO };
        for landmark in asked(known) {
            census.asked += 1;
            let Some(matched) = landmark.matched else { continue };
            census.in_place += i32::from(!matched.has_moved);
            census.sure += i32::from(!matched.has_moved && landmark.frames > 1);
            let line = line_at(matched.place as usize);
            let seen = line.and_then(|line| LineObservation::new(setup, motion, &landmark.state.line3, line));
            if let Some(off) = seen.and_then(|seen| Off::of(setup, motion, landmark, &seen, interval_s)) {
                let most = S::from_i32(MOST_SIGMAS_EACH);
                let sigma = hypot(off.sigma_px, off.shared_px);
                let sigmas = (off.px / sigma).max(-most).min(most);
                let part = off.shared_px / sigma;
                census.matched += 1;
                census.sum = census.sum + if off.per_s > S::ZERO { sigmas } else { -sigmas };
                census.shared = census.shared + part * part;
            }
        }
        census
    }

    /// Whether most edges of a frame of so many lines are where they should be, and not all off alike.
    pub(super) fn is_steady(&self, lines: u16) -> bool {
        // A frame that is empty, or nearly, says nothing.
        if self.asked < LEAST_ASKED || 2 * i32::from(lines) < self.asked {
            return true;
        }
        4 * self.in_place >= self.asked && !self.is_off_alike()
    }

    /// Whether edges that several frames have shown are where the time since the frame before has them: then it is
    /// right for all others, too.
    pub(super) fn shows_interval(&self) -> bool {
        self.sure >= LEAST_ASKED && !self.is_off_alike()
    }

    fn is_off_alike(&self) -> bool {
        let number = S::from_i32(self.matched);
        // N (1 - p) + N² p, with p the part that is shared.
        let variance = number - self.shared + number * self.shared;
        self.matched >= LEAST_ASKED && self.sum.abs() > variance.sqrt() * S::from_i32(ALIKE_SIGMAS)
    }
}

/// Some of the edges that frames have shown lately, from all over the image.
pub(super) fn asked<S: Scalar>(known: &[Landmark<S>]) -> impl Iterator<Item = &Landmark<S>> {
    let is_asked =
        |landmark: &&Landmark<S>| !landmark.is_tentative() && landmark.hold_off == 0 && landmark.missed <= MOST_HIDDEN;
    let step = known.iter().filter(is_asked).count().div_ceil(MOST_ASKED).max(1);
    known.iter().filter(is_asked).step_by(step)
}

/// How far a line lies from where its edge should be.
struct Off<S> {
    px: S,
    /// How fast the edge moves along the row as time goes on, in pixels per second.
    per_s: S,
    /// One sigma of `px`: what is the edge's own, and what all edges have in common.
    sigma_px: S,
    shared_px: S,
}

impl<S: Scalar> Off<S> {
    fn of<M: Motion<S>>(
        setup: &Setup<S>,
        motion: &M,
        landmark: &Landmark<S>,
        seen: &LineObservation<S>,
        interval_s: S,
    ) -> Option<Self> {
        let state = &landmark.state;
        let (px, sensitivity) = deviation(&state.line3, &seen.middle)?;
        let own = state.covariance.variance_along(sensitivity).max(S::ZERO);
        let all = landmark.total(setup).variance_along(sensitivity);
        let step_s = interval_s * S::ratio(1, 4);
        // Every edge is in front, even where its estimate is beyond infinity.
        let before = Line3 { inverse_depth: state.line3.inverse_depth.abs(), ..state.line3 };
        let after = FrameTransition::within(motion, step_s, before.gravity).line(&before)?;
        let ((at_first, _), (at_last, _)) = (deviation(&before, &seen.middle)?, deviation(&after, &seen.middle)?);
        let per_s = (at_first - at_last) / step_s;
        let off = Self { px, per_s, sigma_px: static_sigma(own.sqrt()), shared_px: (all - own).max(S::ZERO).sqrt() };
        let finite = [off.px, off.per_s, off.sigma_px, off.shared_px].into_iter().all(S::is_finite);
        (finite && per_s != S::ZERO).then_some(off)
    }
}
