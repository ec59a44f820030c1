//! [`LineState`]: what is known of an edge after a frame.

use super::covariance::Covariance;
use super::equation::Equation;
use super::line3::Line3;
use super::sensitivity::Sensitivity;
use super::unknowns::Unknowns;
use crate::scalar::{Scalar, dot, over};

/// Bearing, inverse depth and tilt, their covariance, and their derivatives by shared errors.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct LineState<S> {
    pub(crate) line3: Line3<S>,
    /// From noise and priors, without the errors that all samples share.
    pub(crate) covariance: Covariance<S>,
    pub(crate) sensitivity: Sensitivity<S>,
}

/// One of three independent statements about an edge: coefficients of the errors of its unknowns.
#[derive(Clone, Copy)]
pub(crate) struct Statement<S> {
    pub(super) coefficients: [S; 3],
    /// Zero where nothing is stated.
    pub(super) per_sigma: S,
}

impl<S: Scalar> Statement<S> {
    /// About `stated`, for a line that is to be found from `at` on.
    pub(super) fn equation(&self, stated: &Line3<S>, at: &Unknowns<S>) -> Equation<S> {
        let off = [stated.bearing - at.bearing, stated.inverse_depth - at.inverse_depth, stated.tilt - at.tilt];
        let [one, q, w] = self.coefficients;
        Equation { one, q, w, y: dot(self.coefficients, off) }.scaled(self.per_sigma)
    }
}

impl<S: Scalar> LineState<S> {
    /// Room for one.
    pub(crate) const NOTHING: Self =
        Self { line3: Line3::NOTHING, covariance: Covariance::NONE, sensitivity: Sensitivity::NONE };

    pub(crate) fn statements(&self) -> [Statement<S>; 3] {
        let statements = self.covariance.statements();
        statements.map(|(coefficients, variance)| Statement { coefficients, per_sigma: over(variance.sqrt()) })
    }

    /// Whether another edge is at another depth, by three sigma.
    pub(crate) fn is_apart(&self, other: &Self) -> bool {
        let ([_, variance, _], [_, others_variance, _]) = (self.covariance.variance, other.covariance.variance);
        let apart = (self.line3.inverse_depth - other.line3.inverse_depth).abs();
        apart > (variance + others_variance).sqrt() * S::from_i32(3)
    }
}
