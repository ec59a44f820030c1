//! [`FrameTransition`]: from the start of one frame to the start of the next. docs/model.md, section 8.

use super::tuning::{DRIFT_PER_ROUGHNESS, UNSURE_TIME};
use crate::motion::{Motion, Pose};
use crate::range::{Covariance, Line3, LineState, Sensitivity, SharedError};
use crate::scalar::{Scalar, add, cross, dot, hypot, on_axis, scale, sub};
use crate::setup::{Setup, tilt_per_pitch};

impl<S: Scalar> LineState<S> {
    /// The same edge as seen from the next frame's start, with what drifts on the way added to the covariance.
    ///
    /// `None` where the edge is then beside or behind the camera.
    pub(crate) fn propagated(&self, setup: &Setup<S>, transition: &FrameTransition<S>) -> Option<Self> {
        let propagated_line = Propagated::of(&self.line3, transition)?;
        let jacobian = propagated_line.jacobian(&self.line3, transition);
        let uncertainty = setup.uncertainty();
        // A turn brings some of the lean towards or away from the camera into the image plane; so does a change of the
        // bearing, which also lets the camera's pitch show as a tilt.
        let turned = propagated_line.turned_lean(&self.line3, transition) * uncertainty.sigma_tilt;
        let passed = (propagated_line.line3.bearing - self.line3.bearing) * uncertainty.sigma_tilt;
        let pitch_of = |line3: &Line3<S>| tilt_per_pitch(line3.bearing, line3.gravity);
        let pitched = (pitch_of(&propagated_line.line3) - pitch_of(&self.line3)) * uncertainty.sigma_gravity;
        let tilted = hypot(hypot(turned, passed), pitched);
        let mut covariance = self.covariance.through(jacobian).and([S::ZERO, S::ZERO, tilted]);
        let drift_px = uncertainty.edge_roughness_px * S::from_i32(DRIFT_PER_ROUGHNESS);
        covariance = covariance.and([drift_px / setup.camera().intrinsics().fx, S::ZERO, S::ZERO]);
        if transition.sigma_time_s > S::ZERO {
            let per_second = propagated_line.change_with_time(&self.line3, transition);
            covariance = covariance.and(scale(per_second, transition.sigma_time_s));
        }
        // A part of what a drifting error has done so far is independent of its present value.
        let (kept, lost) = transition.drift();
        let mut sensitivity = self.sensitivity;
        for (error, effect) in SharedError::ALL.into_iter().zip(&mut sensitivity.0) {
            let mut propagated = times(jacobian, *effect);
            if matches!(error, SharedError::Speed | SharedError::Rate(_)) {
                let sigma = error.sigma(setup, self.line3.bearing, self.line3.gravity);
                covariance = covariance.and(scale(propagated, sigma * lost));
                propagated = scale(propagated, kept);
            }
            *effect = add(propagated, propagated_line.change_of(error, &self.line3, transition));
        }
        let state = Self { line3: propagated_line.line3, covariance, sensitivity };
        Some(if uncertainty.allows_tilt() { state } else { state.upright() })
    }

    /// The same where nothing shows that the time since it was seen first is right. `other` is the same edge at another
    /// depth that it may have: it goes along its way as the nearer one of the two does. `None` where that leads beside
    /// or behind the camera.
    #[inline(never)]
    pub(crate) fn with_unsure_time<M: Motion<S>>(&self, motion: &M, other: &Line3<S>, elapsed_s: S) -> Option<Self> {
        let inverse_depth = self.line3.inverse_depth.abs().max(other.inverse_depth.abs());
        let line3 = Line3 { inverse_depth, ..*other };
        let sigma_time_s = elapsed_s * S::ratio(UNSURE_TIME.0, UNSURE_TIME.1);
        let later = FrameTransition::within(motion, sigma_time_s, line3.gravity).line(&line3)?;
        // Gravity is told anew for each frame: the tilt does not change with the time.
        let change = [later.bearing - line3.bearing, later.inverse_depth - line3.inverse_depth, S::ZERO];
        Some(Self { covariance: self.covariance.and(change), ..*self })
    }

    /// The same for an edge that is stated to be upright: it is so in the new axes as well. Where these differ from
    /// what the turn made of the old ones, the turn was wrong.
    fn upright(self) -> Self {
        let Covariance { variance: [a, r, _], mixed: [ar, ..] } = self.covariance;
        Self {
            line3: Line3 { tilt: S::ZERO, ..self.line3 },
            covariance: Covariance { variance: [a, r, S::ZERO], mixed: [ar, S::ZERO, S::ZERO] },
            sensitivity: Sensitivity(self.sensitivity.0.map(|[a, r, _]| [a, r, S::ZERO])),
        }
    }
}

/// The way of the camera from the start of one frame to the start of the next.
pub(crate) struct FrameTransition<S> {
    /// Pose of the camera at the later frame's start, in the axes of the earlier one.
    pub(crate) pose: Pose<S>,
    pub(crate) elapsed_s: S,
    /// One sigma of `elapsed_s`.
    pub(crate) sigma_time_s: S,
    /// Down, in the axes of the later frame's start.
    pub(crate) gravity: [S; 3],
}

impl<S: Scalar> FrameTransition<S> {
    /// So much later in the same motion.
    pub(super) fn within<M: Motion<S>>(motion: &M, elapsed_s: S, gravity: [S; 3]) -> Self {
        Self { pose: motion.pose(elapsed_s), elapsed_s, sigma_time_s: S::ZERO, gravity }
    }

    /// A direction of the earlier frame in the axes of the later one.
    fn turn(&self, direction: [S; 3]) -> [S; 3] {
        let [x, y, z] = self.pose.rotation;
        let [dx, dy, dz] = direction;
        add(add(scale(x, dx), scale(y, dy)), scale(z, dz))
    }

    /// A line as it lies in the axes of the later frame; `None` where it is beside or behind the camera.
    pub(super) fn line(&self, line3: &Line3<S>) -> Option<Line3<S>> {
        Propagated::of(line3, self).map(|propagated| propagated.line3)
    }

    /// For an error that is correlated over about a second: which part of it is kept, and which is replaced by a new
    /// one. The squares add up to one.
    fn drift(&self) -> (S, S) {
        let kept = S::ONE / (S::ONE + self.elapsed_s.abs());
        (kept, ((S::ONE - kept) * (S::ONE + kept)).sqrt())
    }
}

/// An edge in the axes of the later frame, with what its derivatives need.
pub(super) struct Propagated<S> {
    line3: Line3<S>,
    /// ρ P of the edge's point in the plane y = 0 of the earlier frame.
    foot: [S; 3],
    down: [S; 3],
    /// Distance along `down` from there to the plane y = 0 of the later frame.
    along: S,
    /// Depth of the new point in units of the depth of the old one.
    depth: S,
    /// Component of `down` along gravity.
    length: S,
}

impl<S: Scalar> Propagated<S> {
    pub(super) fn of(line3: &Line3<S>, transition: &FrameTransition<S>) -> Option<Self> {
        let from = [line3.bearing, S::ZERO, S::ONE];
        let foot = transition.turn(sub(from, scale(transition.pose.position_m, line3.inverse_depth)));
        let down = transition.turn(line3.direction());
        let ([_, y, _], [_, dy, _]) = (foot, down);
        let tenth = S::ratio(1, 10);
        let along = y / dy;
        let [x, _, depth] = sub(foot, scale(down, along));
        let start = Line3::start(transition.gravity);
        let length = dot(down, start.gravity);
        if !(dy.abs() > tenth && depth > tenth * tenth && length > tenth) {
            return None;
        }
        let line3 = Line3 {
            bearing: x / depth,
            inverse_depth: line3.inverse_depth / depth,
            tilt: dot(down, start.lean) / length,
            ..start
        };
        Some(Self { line3, foot, down, along, depth, length })
    }

    /// Where a place along the old line lies along the new one, in units of the new depth.
    pub(super) fn along(&self, place: S) -> S {
        (place + self.along) * self.length / self.depth
    }

    /// Change of the new bearing, inverse depth and tilt with small changes of `foot`, `down` and the old inverse
    /// depth.
    fn change(&self, foot: [S; 3], down: [S; 3], inverse_depth: S) -> [S; 3] {
        let ([_, y, _], [_, down_y, _], [_, dy, _]) = (foot, down, self.down);
        let along = (y - self.along * down_y) / dy;
        let [x, _, z] = sub(foot, add(scale(self.down, along), scale(down, self.along)));
        [
            (x - self.line3.bearing * z) / self.depth,
            (inverse_depth - self.line3.inverse_depth * z) / self.depth,
            (dot(down, self.line3.lean) - self.line3.tilt * dot(down, self.line3.gravity)) / self.length,
        ]
    }

    fn jacobian(&self, old: &Line3<S>, transition: &FrameTransition<S>) -> [[S; 3]; 3] {
        let none = [S::ZERO; 3];
        let [aa, ra, ba] = self.change(transition.turn([S::ONE, S::ZERO, S::ZERO]), none, S::ZERO);
        let [ar, rr, br] = self.change(transition.turn(scale(transition.pose.position_m, -S::ONE)), none, S::ONE);
        let [ab, rb, bb] = self.change(none, transition.turn(old.lean), S::ZERO);
        [[aa, ar, ab], [ra, rr, rb], [ba, br, bb]]
    }

    /// What a unit of a shared error adds on the way.
    fn change_of(&self, error: SharedError, old: &Line3<S>, transition: &FrameTransition<S>) -> [S; 3] {
        let none = [S::ZERO; 3];
        match error {
            SharedError::Speed => {
                let back = transition.turn(scale(transition.pose.position_m, -old.inverse_depth));
                self.change(back, none, S::ZERO)
            }
            SharedError::Rate(axis) => {
                let angle = on_axis(axis, transition.elapsed_s);
                self.change(cross(self.foot, angle), cross(self.down, angle), S::ZERO)
            }
            // These act within a frame, not between frames.
            SharedError::Tilt | SharedError::Lens | SharedError::Readout | SharedError::Focal => none,
        }
    }

    /// Change with the time of the transition: the camera goes on with its velocity and its rotation.
    fn change_with_time(&self, old: &Line3<S>, transition: &FrameTransition<S>) -> [S; 3] {
        let none = [S::ZERO; 3];
        let elapsed_s = transition.elapsed_s;
        if elapsed_s == S::ZERO {
            return none;
        }
        let turning = transition.pose.rate_rad_s.into_iter().enumerate().fold(none, |sum, (axis, rate)| {
            add(sum, scale(self.change_of(SharedError::Rate(axis), old, transition), rate))
        });
        let moving = self.change_of(SharedError::Speed, old, transition);
        scale(add(moving, turning), S::ONE / elapsed_s)
    }

    fn turned_lean(&self, old: &Line3<S>, transition: &FrameTransition<S>) -> S {
        dot(transition.turn(old.lean), cross(self.line3.gravity, self.line3.lean))
    }
}

fn times<S: Scalar>(matrix: [[S; 3]; 3], vector: [S; 3]) -> [S; 3] {
    matrix.map(|row| dot(row, vector))
}
