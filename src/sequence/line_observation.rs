//! [`LineObservation`]: a line of this frame as rays, for comparison with predicted edges.

use crate::edge::Polarity;
use crate::line::Line;
use crate::motion::Motion;
use crate::range::{Line3, Observation, Observer, RowPlane};
use crate::scalar::Scalar;
use crate::setup::Setup;

/// A line of this frame at its ends and in its middle.
pub(crate) struct LineObservation<S: Scalar> {
    pub(crate) polarity: Polarity,
    /// In grey levels; zero where it is not known.
    pub(crate) contrast: u8,
    /// The rows of its ends.
    pub(super) rows: [RowPlane<S>; 2],
    pub(super) ends: [Observation<S>; 2],
    pub(super) middle: Observation<S>,
    /// The columns that the line covers.
    pub(super) columns_px: [S; 2],
}

impl<S: Scalar> LineObservation<S> {
    /// Against lines with the directions of `axes`. `None` for a line without samples, or outside the lens model.
    pub(crate) fn new<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        axes: &Line3<S>,
        line: &Line<KNOTS>,
    ) -> Option<Self> {
        let mut observer = Observer::new(setup.camera(), motion, [axes.gravity, axes.lean]);
        let samples = line.first_middle_and_last()?;
        let [first, _, last] = samples.each_ref().map(|sample| sample.column_px);
        let [first_seen, middle, last_seen] = samples.map(|sample| observer.observe(&sample));
        let ends = [first_seen?, last_seen?];
        Some(Self {
            polarity: line.first().polarity,
            contrast: line.contrast(),
            columns_px: [first.min(last), first.max(last)],
            rows: ends.each_ref().map(|end| RowPlane::new(motion, end)),
            ends,
            middle: middle?,
        })
    }
}
