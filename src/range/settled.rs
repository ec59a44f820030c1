//! [`Settled`]: what shared errors do to a fit that has settled. docs/model.md, section 6.

use super::equation::{Equation, Equations};
use super::least_squares::Solution;
use super::observation::Observation;
use super::prior::Knowledge;
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
        if let Some(blur) = self.respond_of_priors(effects) {
            self.respond_of_path(effects, blur);
        }
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

    /// The equation of the blur, if it takes part.
    #[inline(never)]
    fn respond_of_priors(&self, effects: &mut [[S; 3]; SHARED_ERRORS]) -> Option<&Equation<S>> {
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
        let blur = equations_of_prior.next().filter(|_| prior.blur().is_some())?;
        let [_, of_lens, ..] = effects;
        solution.respond(of_lens, blur, -equations.per_lens_px);
        Some(blur)
    }

    /// Whether each error has a sigma and moves observations: what is in the prior moves none.
    #[inline(never)] // what it needs is not on the stack of those who ask
    fn counts(&self) -> [bool; SHARED_ERRORS] {
        let Self { setup, motion, at, .. } = self;
        let has_sigma = |error: SharedError| error.sigma(setup, at.bearing, motion.gravity()) > S::ZERO;
        let counts = |error: SharedError| !error.is_in_prior() && has_sigma(error);
        SharedError::ALL.map(counts)
    }

    /// An error adds to the path of the blur what it does in the time of an exposure, where the line is seen in its middle;
    /// and a relative one of the focal length, besides, takes that part of it, since so many pixels are another angle.
    /// That of the speed is in q, and the readout has no part in it. By how much the camera turns and moves before that
    /// place is read changes little of this, and is left out.
    #[inline(never)]
    fn respond_of_path(&self, [_, _, _, of_each @ ..]: &mut [[S; 3]; SHARED_ERRORS], equation: &Equation<S>) {
        let Self { motion, at, solution, .. } = self;
        let [_, _, _, counts @ ..] = self.counts();
        let path = self.prior.blur().filter(|_| counts != [false; OF_EACH]).and_then(|blur| blur.path_errors(at));
        let (Some(path), Some(observation)) = (path, self.observations.get(self.observations.len() / 2)) else {
            return;
        };
        let [velocity_m_s, rate_rad_s] = motion.constant_rates().unwrap_or_else(|| {
            let Pose { velocity_m_s, rate_rad_s, .. } = motion.pose(S::ZERO);
            [velocity_m_s, rate_rad_s]
        });
        let ([u, w], none) = (observation.bearings(), S::ZERO);
        let per_miss = -(path.exposure_s * path.y_per_px / at.residual(&observation.normals).whole_per_px());
        let h = cross(self.direction, [at.bearing, none, S::ONE]);
        let of_advance = -(at.inverse_depth * dot([u, w, none], cross(self.direction, velocity_m_s)));
        let of_focal = of_advance + dot(cross(rate_rad_s, [u, w, none]), h);
        let [y_of_x, y_of_y, y_of_z] = scale(cross([u, w, S::ONE], h), per_miss);
        let [of_x, of_y, of_z, _, of_f] = of_each;
        solution.respond(of_x, equation, y_of_x);
        solution.respond(of_y, equation, y_of_y);
        solution.respond(of_z, equation, y_of_z);
        solution.respond(of_f, equation, of_focal * per_miss - path.y_of_length);
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
