//! [`LineState`]: what is known of an edge after a frame.

use super::covariance::Covariance;
use super::equation::{Equation, PriorEquation};
use super::line3::Line3;
use super::sensitivity::Sensitivity;
use crate::scalar::{Scalar, dot, hypot};

/// Bearing, inverse depth and tilt, their covariance, and their derivatives by shared errors.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct LineState<S> {
    pub(crate) line3: Line3<S>,
    /// From noise and priors, without the errors that all samples share.
    pub(crate) covariance: Covariance<S>,
    pub(crate) sensitivity: Sensitivity<S>,
}

impl<S: Scalar> LineState<S> {
    pub(crate) fn equations(&self, line3: &Line3<S>) -> [PriorEquation<S>; 3] {
        let off = [
            self.line3.bearing - line3.bearing,
            self.line3.inverse_depth - line3.inverse_depth,
            self.line3.tilt - line3.tilt,
        ];
        self.covariance.statements().map(|(coefficients, root_weight)| {
            let [one, q, w] = coefficients;
            let equation = Equation { one, q, w, y: dot(coefficients, off), root_weight };
            PriorEquation { equation, errors: self.sensitivity.0.map(|effect| dot(coefficients, effect)) }
        })
    }

    /// Whether another edge is at another depth, by three sigma.
    pub(crate) fn is_apart(&self, other: &Self) -> bool {
        let ([_, sigma, _], [_, others_sigma, _]) = (self.covariance.sigma, other.covariance.sigma);
        let apart = (self.line3.inverse_depth - other.line3.inverse_depth).abs();
        apart > hypot(sigma, others_sigma) * S::from_i32(3)
    }
}
