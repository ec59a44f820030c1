//! From the start of one frame to the start of the next.

use crate::motion::Pose;
use crate::range::{Line3, LineState, SharedError};
use crate::scalar::{Scalar, add, cross, dot, hypot, on_axis, scale, sub};
use crate::setup::Setup;

impl<S: Scalar> LineState<S> {
    /// The same edge for a camera at another place: what is known of it there, less what drifts on the way.
    ///
    /// `None` where the edge is then beside or behind the camera.
    pub(crate) fn propagated(&self, setup: &Setup<S>, transition: &FrameTransition<S>) -> Option<Self> {
        let view = View::of(&self.line3, transition)?;
        let jacobian = view.jacobian(&self.line3, transition);
        let uncertainty = setup.uncertainty();
        // What of the edge's lean towards or away from the camera a turn brings into the image plane, and what of that and of
        // the camera's pitch shows there as the bearing changes.
        let turned = view.turned_lean(&self.line3, transition) * uncertainty.sigma_tilt;
        let passed =
            (view.line3.bearing - self.line3.bearing) * hypot(uncertainty.sigma_tilt, uncertainty.sigma_gravity);
        let mut covariance = self.covariance.through(jacobian).and([S::ZERO, S::ZERO, hypot(turned, passed)]);
        // Of an error that drifts, a part of what it has done so far is as good as random now.
        let (kept, lost) = transition.drift();
        let mut sensitivity = self.sensitivity;
        for (cause, effect) in SharedError::ALL.into_iter().zip(&mut sensitivity.0) {
            let mut propagated = times(jacobian, *effect);
            if matches!(cause, SharedError::Speed | SharedError::Rate(_)) {
                let sigma = cause.sigma(setup, self.line3.bearing);
                covariance = covariance.and(scale(propagated, sigma * lost));
                propagated = scale(propagated, kept);
            }
            *effect = add(propagated, view.change_of(cause, &self.line3, transition));
        }
        Some(Self { line3: view.line3, covariance, sensitivity })
    }
}

/// From the start of one frame to the start of another.
pub(crate) struct FrameTransition<S> {
    /// Of the camera at the later frame's start, in the axes of the earlier one.
    pub(crate) pose: Pose<S>,
    pub(crate) elapsed_s: S,
    /// Down, in the axes of the later frame's start.
    pub(crate) gravity: [S; 3],
}

impl<S: Scalar> FrameTransition<S> {
    /// A direction of the earlier frame in the axes of the later one.
    fn turn(&self, direction: [S; 3]) -> [S; 3] {
        let [x, y, z] = self.pose.rotation;
        let [dx, dy, dz] = direction;
        add(add(scale(x, dx), scale(y, dy)), scale(z, dz))
    }

    /// Which part of an error that stays much the same for a second is still the same, and which part is lost: their squares
    /// add up to one.
    fn drift(&self) -> (S, S) {
        let kept = S::ONE / (S::ONE + self.elapsed_s.abs());
        (kept, ((S::ONE - kept) * (S::ONE + kept)).sqrt())
    }
}

/// An edge as the later frame has it.
struct View<S> {
    line3: Line3<S>,
    /// ρ P for the edge's point in the plane y = 0 of the earlier frame.
    foot: [S; 3],
    down: [S; 3],
    /// How far along `down` the plane y = 0 of the later frame lies from there.
    along: S,
    /// Depth of the new point, in units of the old one's.
    depth: S,
    /// Of `down` along gravity.
    length: S,
}

impl<S: Scalar> View<S> {
    fn of(line3: &Line3<S>, transition: &FrameTransition<S>) -> Option<Self> {
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

    /// What small changes of `foot`, `down` and the old inverse depth do to the new bearing, inverse depth and tilt.
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

    /// What a unit error of a cause adds on the way.
    fn change_of(&self, cause: SharedError, old: &Line3<S>, transition: &FrameTransition<S>) -> [S; 3] {
        let none = [S::ZERO; 3];
        match cause {
            SharedError::Speed => {
                let back = transition.turn(scale(transition.pose.position_m, -old.inverse_depth));
                self.change(back, none, S::ZERO)
            }
            SharedError::Rate(axis) => {
                let angle = on_axis(axis, transition.elapsed_s);
                self.change(cross(self.foot, angle), cross(self.down, angle), S::ZERO)
            }
            // Of the rows of a frame alone.
            SharedError::Tilt | SharedError::Lens | SharedError::Readout | SharedError::Focal => none,
        }
    }

    fn turned_lean(&self, old: &Line3<S>, transition: &FrameTransition<S>) -> S {
        dot(transition.turn(old.lean), cross(self.line3.gravity, self.line3.lean))
    }
}

fn times<S: Scalar>(matrix: [[S; 3]; 3], vector: [S; 3]) -> [S; 3] {
    matrix.map(|row| dot(row, vector))
}
