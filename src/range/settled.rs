//! [`Settled`]: what shared errors do to a fit that has settled. docs/model.md, section 6.

use super::blur::Blur;
use super::equation::{Equation, Equations};
use super::least_squares::Solution;
use super::observation::{Observation, Observer};
use super::prior::Knowledge;
use super::sample::Sample;
use super::sensitivity::Sensitivity;
use super::shared_error::{SHARED_ERRORS, SharedError};
use super::unknowns::Unknowns;
use crate::motion::{Motion, Pose};
use crate::scalar::{Scalar, add, cross, dot, scale, sub};
use crate::setup::Setup;

/// Errors that each observation has a part of its own of: all but tilt, lens and speed.
const OF_EACH: usize = SHARED_ERRORS - 3;

/// A fit that has settled: what its equations, centred, are of, and their solution.
pub(super) struct Settled<'a, S: Scalar, M, K, const N: usize> {
    pub(super) setup: &'a Setup<S>,
    pub(super) motion: &'a M,
    pub(super) prior: &'a K,
    pub(super) observations: &'a [Observation<S>],
    pub(super) equations: &'a Equations<S, N>,
    /// What the equations were linearised about, and the direction of that line.
    pub(super) at: &'a Unknowns<S>,
    pub(super) direction: [S; 3],
    pub(super) solution: &'a Solution<S>,
}

impl<S: Scalar, M: Motion<S>, K: Knowledge<S>, const N: usize> Settled<'_, S, M, K, N> {
    // Not inlined are its parts: what each of them needs then leaves the stack before the next one comes.
    #[inline(always)]
    pub(super) fn sensitivity(&self, Sensitivity(effects): &mut Sensitivity<S>) {
        *effects = [[S::ZERO; 3]; SHARED_ERRORS];
        self.respond_of_observations(effects);
        self.respond_of_priors(effects);
        self.solution.respond_all(effects);
    }

    #[inline(never)]
    fn respond_of_observations(&self, [_, _, speed, of_each @ ..]: &mut [[S; 3]; SHARED_ERRORS]) {
        let Self { observations, equations, at, solution, .. } = self;
        let [_, _, speed_counts, counts @ ..] = self.counts();
        if speed_counts {
            // q is the change of y with the inverse depth, which a relative error of the speed does not differ from.
            *speed = solution.response_of_q(-at.inverse_depth);
        }
        let inliers =
            observations.iter().zip(&equations.observed).filter(|(observation, _)| observation.normals.is_inlier);
        for (observation, equation) in inliers.filter(|_| counts != [false; OF_EACH]) {
            let errors = self.errors(observation, &self.motion.pose(observation.time_s()));
            let equation = &equation.whole(equations.units);
            for ((response, error), _) in of_each.iter_mut().zip(&errors).zip(counts).filter(|(_, counts)| *counts) {
                solution.respond(response, equation, *error);
            }
        }
    }

    #[inline(never)]
    fn respond_of_priors(&self, effects: &mut [[S; 3]; SHARED_ERRORS]) {
        let Self { setup, prior, equations, at, solution, .. } = self;
        let speed_counts = setup.uncertainty().sigma_speed > S::ZERO;
        let mut equations_of_prior = equations.prior.iter();
        prior.errors(setup, self.motion.gravity(), at, |prior_error| {
            let Some(equation) = equations_of_prior.next() else { return };
            if let ([_, _, speed, ..], true) = (&mut *effects, speed_counts) {
                // What was known before the line was seen does not know of it.
                solution.respond(speed, equation, at.inverse_depth * solution.unsolved_q(equation));
            }
            for (index, (response, error)) in effects.iter_mut().zip(SharedError::ALL).enumerate() {
                let error = prior_error.of(index, error);
                if error != S::ZERO {
                    solution.respond(response, equation, error);
                }
            }
        });
        if let (Some(equation), Some(blur)) = (equations_of_prior.next(), prior.blur()) {
            let [_, of_lens, _, of_each @ ..] = effects;
            solution.respond(of_lens, equation, -equations.per_lens_px);
            let [_, _, _, counts @ ..] = self.counts();
            if counts != [false; OF_EACH] {
                self.respond_of_blur(of_each, blur, equation);
            }
        }
    }

    /// Whether each error has a sigma and moves observations: what is in the prior moves none.
    fn counts(&self) -> [bool; SHARED_ERRORS] {
        let Self { setup, motion, at, .. } = self;
        let has_sigma = |error: SharedError| error.sigma(setup, at.bearing, motion.gravity()) > S::ZERO;
        let counts = |error: SharedError| !error.is_in_prior() && has_sigma(error);
        SharedError::ALL.map(counts)
    }

    /// An error adds to a path what it does at the end of the exposure less what it does at its start; and a relative
    /// one of the focal length, besides, that part of it, since so many pixels are another angle. That of the speed is
    /// in q, and the readout has no part in it.
    #[inline(never)]
    fn respond_of_blur(&self, of_each: &mut [[S; 3]; OF_EACH], blur: &dyn Blur<S>, equation: &Equation<S>) {
        let axes = self.prior.axes(self.motion);
        let mut observer = Observer::new(self.setup.camera(), self.motion, [axes.gravity, axes.lean]);
        let mut errors = |end: &Sample<S>| {
            let observation = observer.observe(end)?;
            Some(self.errors(&observation, &self.motion.pose(end.time_s)))
        };
        let [of_x, of_y, of_z, _, of_focal] = of_each;
        for path in blur.paths(self.at).iter().flatten() {
            let [start, end] = &path.ends;
            let (Some([x, y, z, _, focal]), Some(at_end)) = (errors(start), errors(end)) else { continue };
            let [end_x, end_y, end_z, _, end_focal] = at_end;
            let respond = |response: &mut [S; 3], off_px: S| {
                self.solution.respond(response, equation, off_px * path.y_per_px);
            };
            respond(of_x, end_x - x);
            respond(of_y, end_y - y);
            respond(of_z, end_z - z);
            respond(of_focal, end_focal - focal - path.px);
        }
    }

    /// What a unit of rotation rate about each axis, of readout time and of focal length adds to the y of an
    /// observation, in its sigma.
    #[inline(never)]
    fn errors(&self, observation: &Observation<S>, pose: &Pose<S>) -> [S; OF_EACH] {
        let (none, rho) = (S::ZERO, self.at.inverse_depth);
        let per_miss = -(observation.per_sigma() / self.at.residual(&observation.normals).whole_per_px());
        let is_steady = !M::MAY_TURN || self.motion.keeps_attitude();
        let [u, w] = observation.bearings();
        // R (u, w, 0), and R (u, w, 1)
        let (aside, direction) = if is_steady {
            ([u, w, none], [u, w, S::ONE])
        } else {
            let aside = pose.rotation.map(|[of_u, of_w, _]| (of_u * u).plus_product(of_w, w));
            (aside, add(aside, pose.rotation.map(|[_, _, ahead]| ahead)))
        };
        // The camera is further along its path, and has turned further.
        let m = cross(direction, self.direction);
        let of_advance = -(rho * observation.time_s() * dot(m, pose.velocity_m_s)) * per_miss;
        // F = d · h
        let place = sub([self.at.bearing, none, S::ONE], scale(pose.position_m, rho));
        let h = cross(self.direction, place);
        let of_focal = dot(aside, h) * per_miss;
        let of_rate = scale(cross(direction, h), observation.time_s() * per_miss);
        let of_readout = of_advance + dot(pose.rate_rad_s, of_rate);
        let [of_x, of_y, of_z] = of_rate;
        [of_x, of_y, of_z, of_readout, of_focal]
    }
}
