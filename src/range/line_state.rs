//! [`State`]: what is known of an edge, and how it changes on the way to the next frame.

use super::covariance::Covariance;
use super::equation::{BelievedRow, Row};
use super::line3::LineInSpace;
use super::sensitivity::Effects;
use crate::scalar::{Scalar, dot, hypot};

/// Bearing, inverse depth and tilt with all that is known of their errors.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct State<S> {
    pub(crate) edge: LineInSpace<S>,
    /// Of noise and beliefs, without what moves all samples together.
    pub(crate) covariance: Covariance<S>,
    pub(crate) effects: Effects<S>,
}

impl<S: Scalar> State<S> {
    pub(crate) fn rows(&self, edge: &LineInSpace<S>) -> [BelievedRow<S>; 3] {
        let off = [
            self.edge.bearing - edge.bearing,
            self.edge.inverse_depth - edge.inverse_depth,
            self.edge.tilt - edge.tilt,
        ];
        self.covariance.statements().map(|(coefficients, root_weight)| {
            let [one, q, w] = coefficients;
            let row = Row { one, q, w, y: dot(coefficients, off), root_weight };
            BelievedRow { row, errors: self.effects.0.map(|effect| dot(coefficients, effect)) }
        })
    }

    /// Whether another edge is surely at another depth.
    pub(crate) fn is_apart(&self, other: &Self) -> bool {
        let ([_, sigma, _], [_, others_sigma, _]) = (self.covariance.sigma, other.covariance.sigma);
        let apart = (self.edge.inverse_depth - other.edge.inverse_depth).abs();
        apart > hypot(sigma, others_sigma) * S::from_i32(3)
    }
}
