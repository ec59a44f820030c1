//! [`Range`]: what is told of one line.

use crate::estimate::{Estimate, Interval, RangeStatus};
use crate::fit::{FitError, fit_line};
use crate::sight::{LineInSpace, Sight};
use crate::{Edge, Line, Motion, Polarity, Sample, Scalar, Setup};

/// The range of one upright edge: estimate, status, and where the edge is in the image.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Range<S> {
    /// What the estimate is worth; look here first.
    pub status: RangeStatus,
    /// Bearing and inverse depth with covariance.
    pub estimate: Estimate<S>,
    /// Topmost row of the edge in the image.
    pub first_row: u16,
    /// Lowest row of the edge in the image.
    pub last_row: u16,
    /// Column of the fitted edge at `first_row`, in recorded (distorted) pixels; that of the edge point itself where
    /// nothing could be fitted.
    pub column_at_first_row: S,
    /// Number of edge points.
    pub edges: u16,
    /// Dark to bright or bright to dark, from left to right.
    pub polarity: Polarity,
}

impl<S: Scalar> Range<S> {
    /// The range of a line.
    ///
    /// *Cost*: a [`fit`](crate::fit) over the line's knots and a few rays.
    #[must_use]
    pub fn of_line<M: Motion<S>, const KNOTS: usize>(setup: &Setup<S>, motion: &M, line: &Line<KNOTS>) -> Self {
        let (first, last) = (line.first(), line.last());
        let top = if first.row <= last.row { first } else { last };
        let mut range = Self {
            status: RangeStatus::Short,
            estimate: Estimate::nothing(),
            first_row: top.row,
            last_row: first.row.max(last.row),
            column_at_first_row: top.column_px(),
            edges: line.edges(),
            polarity: first.polarity,
        };
        match fit_line::<S, M, KNOTS>(setup, motion, line.samples()) {
            Ok((estimate, edge)) => {
                range.column_at_first_row = column_at(setup, motion, &edge, top);
                range.status =
                    if line.edges() < setup.limits().min_edges { RangeStatus::Short } else { estimate.status() };
                range.estimate = estimate;
            }
            Err(FitError::Sideways(_)) => range.status = RangeStatus::Sideways,
            // A line of too few knots; the others cannot come from a line.
            Err(_) => {}
        }
        range
    }

    /// Depth and its bounds at plus and minus `sigmas`, as [`Estimate::depth`]; no most likely value unless the status is
    /// [`Ok`](RangeStatus::Ok).
    #[must_use]
    pub fn depth(&self, sigmas: S) -> Interval<S> {
        self.if_ok(self.estimate.depth(sigmas))
    }

    /// Shortest distance to the edge's line, as [`Estimate::distance`]; no most likely value unless the status is
    /// [`Ok`](RangeStatus::Ok).
    #[must_use]
    pub fn distance(&self, sigmas: S) -> Interval<S> {
        self.if_ok(self.estimate.distance(sigmas))
    }

    fn if_ok(&self, interval: Interval<S>) -> Interval<S> {
        if self.status == RangeStatus::Ok { interval } else { Interval { estimate_m: None, ..interval } }
    }
}

/// Column at which the fitted edge crosses the row of `near`, by Newton's iteration along that row.
fn column_at<S: Scalar, M: Motion<S>>(setup: &Setup<S>, motion: &M, edge: &LineInSpace<S>, near: &Edge) -> S {
    let mut sample = Sample::point(near.column_px(), S::from_i32(i32::from(near.row)), near.time_s(), S::ONE);
    // Exact in one step without distortion.
    for _ in 0..3 {
        match edge.miss_px(&Sight::new(setup.camera(), motion, &sample)) {
            Some(miss) => sample.column_px = sample.column_px - miss,
            None => break,
        }
    }
    sample.column_px
}
