//! [`Prior`]: what is known of an edge before its line is seen.

use super::blur::BlurMeasurement;
use super::equation::{Equation, Equations, PriorEquation};
use super::line_state::LineState;
use super::line3::Line3;
use super::shared_error::SharedError;
use crate::scalar::Scalar;
use crate::setup::Setup;

/// Earlier frames, or an upright edge, and the blur: each becomes an equation of the same least squares.
#[derive(Clone, Copy)]
pub(crate) struct Prior<S> {
    /// What earlier frames have told; without it, the edge is upright but for the setup's sigma of tilt.
    pub(crate) state: Option<LineState<S>>,
    pub(crate) blur: Option<BlurMeasurement<S>>,
    /// Blur of the edge, one sigma in pixels.
    pub(crate) width_px: S,
    /// Samples that are known to be those of something else.
    pub(crate) left_out: SampleSet,
}

/// A set of a line's samples by their places; those beyond the 64th are in no set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SampleSet(u64);

impl SampleSet {
    pub(crate) fn insert(&mut self, place: usize) {
        self.0 |= Self::bit(place);
    }

    pub(crate) fn contains(self, place: usize) -> bool {
        self.0 & Self::bit(place) != 0
    }

    fn bit(place: usize) -> u64 {
        u32::try_from(place).ok().and_then(|place| 1_u64.checked_shl(place)).unwrap_or(0)
    }
}

impl<S: Scalar> Prior<S> {
    /// Adds its equations, linearised about `line3`.
    pub(crate) fn observe<const N: usize>(&self, setup: &Setup<S>, line3: &Line3<S>, equations: &mut Equations<S, N>) {
        match &self.state {
            Some(state) => state.equations(line3).into_iter().for_each(|equation| add(equations, equation)),
            None => add(equations, upright(setup, line3)),
        }
        if let Some(equation) = self.blur.as_ref().and_then(|blur| blur.equation(line3)) {
            add(equations, equation);
        }
    }
}

/// A prior with a sigma of zero is none.
fn add<S: Scalar, const N: usize>(equations: &mut Equations<S, N>, equation: PriorEquation<S>) {
    if equation.equation.root_weight > S::ZERO {
        // There is room: three of a state and one of the blur at most.
        let _ = equations.prior.push(equation);
    }
}

/// An upright edge, but for its lean and the direction of gravity.
fn upright<S: Scalar>(setup: &Setup<S>, line3: &Line3<S>) -> PriorEquation<S> {
    let root_weight = setup.uncertainty().sigma_tilt_at(line3.bearing);
    PriorEquation {
        equation: Equation { one: S::ZERO, q: S::ZERO, w: S::ONE, y: -line3.tilt, root_weight },
        errors: SharedError::Tilt.alone(S::ONE),
    }
}
