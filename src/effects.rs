//! [`Effects`]: what a wrong tilt, lens, speed, rotation rate, readout time or focal length does to an estimate.

use crate::budget::Budget;
use crate::covariance::Covariance;
use crate::scalar::hypot;
use crate::sight::{LineInSpace, Sight};
use crate::solve::{Rows, Solution};
use crate::vector::{cross, dot, on_axis, scale};
use crate::{Scalar, Setup};

/// Something that is assumed, and may be wrong in the same way for all samples of an edge.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Cause {
    /// The edge's tilt as the prior has it: its own lean and the direction of gravity.
    Tilt,
    /// The lens's own blur, in pixels.
    Lens,
    /// Relative error of the speed.
    Speed,
    /// Rotation about one of the camera's axes, in rad/s.
    Rate(usize),
    /// Relative error of the readout time.
    Readout,
    /// Relative error of the focal length.
    Focal,
}

pub(crate) const CAUSES: usize = 8;

impl Cause {
    pub(crate) const ALL: [Self; CAUSES] =
        [Self::Tilt, Self::Lens, Self::Speed, Self::Rate(0), Self::Rate(1), Self::Rate(2), Self::Readout, Self::Focal];

    /// One standard deviation, for an edge at a bearing.
    pub(crate) fn sigma<S: Scalar>(self, setup: &Setup<S>, bearing: S) -> S {
        let uncertainty = setup.uncertainty();
        match self {
            Self::Tilt => uncertainty.sigma_tilt_at(bearing),
            Self::Lens => setup.motion_blur().map_or(S::ZERO, |blur| blur.sigma_lens_blur_px),
            Self::Speed => uncertainty.sigma_speed,
            Self::Rate(_) => uncertainty.sigma_rate_rad_s,
            Self::Readout => uncertainty.sigma_readout,
            Self::Focal => uncertainty.sigma_focal,
        }
    }

    /// An error of this cause and of no other.
    pub(crate) fn alone<S: Scalar>(self, error: S) -> [S; CAUSES] {
        Self::ALL.map(|cause| if cause == self { error } else { S::ZERO })
    }

    /// Whether the noise of the believed rows has it already.
    fn is_believed(self) -> bool {
        matches!(self, Self::Tilt | Self::Lens)
    }

    /// What a unit error adds to y = −F/m_x of a sight.
    fn error<S: Scalar>(self, sight: &Sight<S>, edge: &LineInSpace<S>) -> S {
        let still = [S::ZERO; 3];
        let (direction, position) = match self {
            Self::Tilt | Self::Lens => return S::ZERO,
            Self::Speed => (still, sight.position),
            Self::Rate(axis) => (cross(on_axis(axis, sight.time_s), sight.direction), still),
            Self::Readout => (cross(sight.turned, sight.direction), sight.advanced),
            Self::Focal => (sight.off_axis, still),
        };
        let down = edge.direction();
        let m = cross(sight.direction, down);
        let [mx, _, _] = m;
        let turned = edge.offset(cross(direction, down), sight);
        (edge.inverse_depth * dot(m, position) - turned) / mx
    }
}

/// By how much a unit error of each cause moves bearing, inverse depth and tilt.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Effects<S>(pub(crate) [[S; 3]; CAUSES]);

impl<S: Scalar> Effects<S> {
    pub(crate) const NONE: Self = Self([[S::ZERO; 3]; CAUSES]);

    pub(crate) fn of<const N: usize>(
        sights: &[Sight<S>],
        edge: &LineInSpace<S>,
        rows: &Rows<S, N>,
        solution: &Solution<S>,
        setup: &Setup<S>,
    ) -> Self {
        let mut effects = Self::NONE;
        for ((index, cause), effect) in Cause::ALL.into_iter().enumerate().zip(&mut effects.0) {
            if cause.sigma(setup, edge.bearing) > S::ZERO {
                let observed = sights.iter().map(|sight| cause.error(sight, edge));
                let believed = rows.believed.iter().map(|row| row.errors.get(index).copied().unwrap_or(S::ZERO));
                *effect = solution.response(rows, observed.chain(believed));
            }
        }
        effects
    }

    /// Each cause with its effect and its standard deviation.
    fn weighed(&self, setup: &Setup<S>, bearing: S) -> impl Iterator<Item = (Cause, [S; 3])> {
        let causes = Cause::ALL.into_iter().zip(self.0);
        causes.map(move |(cause, effect)| (cause, scale(effect, cause.sigma(setup, bearing))))
    }

    /// The covariance of noise and beliefs, with all that moves the samples together.
    pub(crate) fn total(&self, own: Covariance<S>, setup: &Setup<S>, bearing: S) -> Covariance<S> {
        let common = self.weighed(setup, bearing).filter(|(cause, _)| !cause.is_believed());
        common.fold(own, |sum, (_, effect)| sum.and(effect))
    }

    /// Which part of the inverse depth's sigma comes from where.
    pub(crate) fn budget(&self, own: &Covariance<S>, setup: &Setup<S>, bearing: S) -> Budget<S> {
        let [_, own_per_m, _] = own.sigma;
        let mut budget = Budget::of_noise(own_per_m);
        for (cause, [_, effect, _]) in self.weighed(setup, bearing) {
            let part = effect.abs();
            if cause.is_believed() {
                let part = part.min(budget.noise_per_m);
                budget.noise_per_m = ((budget.noise_per_m - part) * (budget.noise_per_m + part)).sqrt();
            }
            match cause {
                Cause::Tilt => {
                    let sigma = cause.sigma(setup, bearing);
                    let lean = if sigma > S::ZERO { setup.uncertainty().sigma_tilt / sigma } else { S::ZERO };
                    budget.lean_per_m = part * lean;
                    budget.gravity_per_m = part * ((S::ONE - lean) * (S::ONE + lean)).sqrt();
                }
                Cause::Lens => budget.lens_per_m = part,
                Cause::Speed => budget.speed_per_m = part,
                Cause::Rate(_) => budget.rate_per_m = hypot(budget.rate_per_m, part),
                Cause::Readout => budget.readout_per_m = part,
                Cause::Focal => budget.focal_per_m = part,
            }
        }
        budget
    }
}
