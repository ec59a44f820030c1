//! [`LineObservation`]: a line of this frame as rays, for comparison with predicted edges.

use crate::edge::Polarity;
use crate::line::Line;
use crate::motion::Motion;
use crate::range::{Observation, Sample};
use crate::scalar::Scalar;
use crate::setup::Setup;

/// A line of this frame at its ends and in its middle.
pub(crate) struct LineObservation<S> {
    pub(crate) polarity: Polarity,
    pub(crate) ends: [Observation<S>; 2],
    pub(super) middle: Observation<S>,
    /// The columns that the line covers.
    pub(super) columns_px: [S; 2],
}

impl<S: Scalar> LineObservation<S> {
    /// `None` for a line without samples, or outside the lens model.
    pub(crate) fn new<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
    ) -> Option<Self> {
        let observation = |sample: Sample<S>| Observation::new(setup.camera(), motion, &sample);
        let samples = || line.samples::<S>();
        let (first, last) = (samples().next()?, samples().last()?);
        Some(Self {
            polarity: line.first().polarity,
            columns_px: [first.column_px.min(last.column_px), first.column_px.max(last.column_px)],
            ends: [observation(first)?, observation(last)?],
            middle: observation(samples().nth(samples().count() / 2)?)?,
        })
    }
}
