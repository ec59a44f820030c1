//! [`Belief`]: what is known of an edge before its columns are looked at.

use super::blur::BlurWitness;
use super::equation::{BelievedRow, Row, Rows};
use super::line_state::State;
use super::line3::LineInSpace;
use super::shared_error::Cause;
use crate::scalar::Scalar;
use crate::setup::Setup;

/// Prior and blur: each becomes a row of the same least squares that the columns enter.
#[derive(Clone, Copy)]
pub(crate) struct Belief<S> {
    /// What earlier frames told; otherwise an edge is upright but for the setup's sigma of tilt.
    pub(crate) state: Option<State<S>>,
    pub(crate) blur: Option<BlurWitness<S>>,
}

impl<S: Scalar> Belief<S> {
    /// Adds what is believed to a round about `edge`.
    pub(crate) fn observe<const N: usize>(&self, setup: &Setup<S>, edge: &LineInSpace<S>, rows: &mut Rows<S, N>) {
        match &self.state {
            Some(state) => state.rows(edge).into_iter().for_each(|row| add(rows, row)),
            None => add(rows, upright(setup, edge)),
        }
        if let Some(row) = self.blur.as_ref().and_then(|blur| blur.row(edge)) {
            add(rows, row);
        }
    }
}

/// A statement without a sigma says nothing.
fn add<S: Scalar, const N: usize>(rows: &mut Rows<S, N>, row: BelievedRow<S>) {
    if row.row.root_weight > S::ZERO {
        // Three of a state and one of blur at most.
        let _ = rows.believed.push(row);
    }
}

/// Upright, but for lean and the direction of gravity.
fn upright<S: Scalar>(setup: &Setup<S>, edge: &LineInSpace<S>) -> BelievedRow<S> {
    let root_weight = setup.uncertainty().sigma_tilt_at(edge.bearing);
    BelievedRow {
        row: Row { one: S::ZERO, q: S::ZERO, w: S::ONE, y: -edge.tilt, root_weight },
        errors: Cause::Tilt.alone(S::ONE),
    }
}
