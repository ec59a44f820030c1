//! What a wrong speed, rotation rate, readout time or focal length does to all edges of a frame together.

use crate::scalar::hypot;
use crate::sight::{LineInSpace, Sight};
use crate::solve::{Row, Solution};
use crate::vector::{cross, dot, scale};
use crate::{Scalar, Uncertainty};

/// One sigma each, and the correlation of the two.
pub(crate) struct Common<S> {
    pub(crate) bearing: S,
    pub(crate) inverse_depth: S,
    pub(crate) correlation: S,
}

#[derive(Clone, Copy)]
enum Cause<S> {
    /// Relative error of the speed.
    Speed,
    /// Rotation about an axis, per rad/s.
    Rate([S; 3]),
    /// Relative error of the readout time.
    Readout,
    /// Relative error of the focal length.
    Focal,
}

/// What an error changes in a sight, per unit of the error.
struct Change<S> {
    direction: [S; 3],
    position: [S; 3],
}

impl<S: Scalar> Cause<S> {
    fn change(self, sight: &Sight<S>) -> Change<S> {
        let still = [S::ZERO; 3];
        match self {
            Self::Speed => Change { direction: still, position: sight.position },
            Self::Rate(axis) => {
                Change { direction: cross(scale(axis, sight.time_s), sight.direction), position: still }
            }
            Self::Readout => Change { direction: cross(sight.turned, sight.direction), position: sight.advanced },
            Self::Focal => Change { direction: sight.off_axis, position: still },
        }
    }
}

impl<S: Scalar> Common<S> {
    /// The joint effect of all that the setup states.
    pub(crate) fn of(
        sights: &[Sight<S>],
        edge: &LineInSpace<S>,
        rows: &[Row<S>],
        solution: &Solution<S>,
        uncertainty: &Uncertainty<S>,
    ) -> Self {
        let rate = uncertainty.sigma_rate_rad_s;
        let causes = [
            (Cause::Speed, uncertainty.sigma_speed),
            (Cause::Rate([S::ONE, S::ZERO, S::ZERO]), rate),
            (Cause::Rate([S::ZERO, S::ONE, S::ZERO]), rate),
            (Cause::Rate([S::ZERO, S::ZERO, S::ONE]), rate),
            (Cause::Readout, uncertainty.sigma_readout),
            (Cause::Focal, uncertainty.sigma_focal),
        ];
        let mut total = Self { bearing: S::ZERO, inverse_depth: S::ZERO, correlation: S::ZERO };
        for (cause, sigma) in causes.into_iter().filter(|(_, sigma)| *sigma > S::ZERO) {
            let errors = sights.iter().map(|sight| error_of(&cause.change(sight), sight, edge));
            let [bearing, inverse_depth] = solution.response(rows, errors);
            total.add(bearing * sigma, inverse_depth * sigma);
        }
        total
    }

    /// Adds one independent effect.
    fn add(&mut self, bearing: S, inverse_depth: S) {
        let sigma_bearing = hypot(self.bearing, bearing);
        let sigma_inverse_depth = hypot(self.inverse_depth, inverse_depth);
        if sigma_bearing > S::ZERO && sigma_inverse_depth > S::ZERO {
            self.correlation =
                self.correlation * (self.bearing / sigma_bearing) * (self.inverse_depth / sigma_inverse_depth)
                    + (bearing / sigma_bearing) * (inverse_depth / sigma_inverse_depth);
        }
        self.bearing = sigma_bearing;
        self.inverse_depth = sigma_inverse_depth;
    }
}

/// What a change of the sight does to y = −F/m_x.
fn error_of<S: Scalar>(change: &Change<S>, sight: &Sight<S>, edge: &LineInSpace<S>) -> S {
    let down = edge.direction();
    let m = cross(sight.direction, down);
    let [mx, _, _] = m;
    let turned = edge.offset(cross(change.direction, down), sight);
    (edge.inverse_depth * dot(m, change.position) - turned) / mx
}
