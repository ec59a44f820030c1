//! [`Range`]: what is told of one line.

use crate::estimate::{Estimate, Interval, RangeStatus};
use crate::fit::{FitError, fit_line};
use crate::scalar::hypot;
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
    /// The same at `last_row`.
    pub column_at_last_row: S,
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
        let (top, bottom) = if first.row <= last.row { (first, last) } else { (last, first) };
        let mut range = Self {
            status: RangeStatus::Short,
            estimate: Estimate::nothing(),
            first_row: top.row,
            last_row: first.row.max(last.row),
            column_at_first_row: top.column_px(),
            column_at_last_row: bottom.column_px(),
            edges: line.edges(),
            polarity: first.polarity,
        };
        match fit_line::<S, M, KNOTS>(setup, motion, line.samples()) {
            Ok((estimate, edge)) => {
                range.column_at_first_row = column_at(setup, motion, &edge, top);
                range.column_at_last_row = column_at(setup, motion, &edge, bottom);
                range.status =
                    if line.edges() < setup.limits().min_edges { RangeStatus::Short } else { estimate.status() };
                range.estimate = estimate;
                if range.status == RangeStatus::Ok && is_fragment(&range, line) {
                    range.status = RangeStatus::Bent;
                }
                if range.status == RangeStatus::Ok && blur_contradicts(setup, motion, line, &estimate, &edge) {
                    range.status = RangeStatus::Inconsistent;
                }
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

/// A short line of pixels that fits badly or has gaps is a piece of something else: only a long one can be straight beside a
/// restless background. Edges of unknown width are somebody's own, with a noise that may be understated.
fn is_fragment<S: Scalar, const KNOTS: usize>(range: &Range<S>, line: &Line<KNOTS>) -> bool {
    const LONG_EDGES: u16 = 48;
    let of_pixels = line.last().width_q8 > 0;
    let rows = u32::from(range.last_row.abs_diff(range.first_row)) + 1;
    let has_gaps = u32::from(range.edges) * 4 < rows * 3;
    of_pixels && range.edges < LONG_EDGES && (has_gaps || range.estimate.misfit > S::ratio(3, 2))
}

/// Whether the edges' width contradicts the motion that their slope implies.
///
/// Of the edge's variance, lens² + 1/12 + B²/12, the motion's path during the exposure contributes B. An edge that is
/// sharper than its slope implies leans; one that is much more blurred, before a known lens, moves more than it shows.
///
/// *Source*: blur = |slope caused by motion| · exposure / line time, whatever the lean.
fn blur_contradicts<S: Scalar, M: Motion<S>, const KNOTS: usize>(
    setup: &Setup<S>,
    motion: &M,
    line: &Line<KNOTS>,
    estimate: &Estimate<S>,
    edge: &LineInSpace<S>,
) -> bool {
    let (Some(blur), Some(width)) = (setup.motion_blur(), line.mean_width_px::<S>()) else {
        return false;
    };
    // An edge that the row does not cross half an exposure earlier or later is none.
    let Some(path) = path_px(setup, motion, line, edge, blur.exposure_s) else {
        return true;
    };
    let twelfth = S::ratio(1, 12);
    let lens = blur.lens_blur_px;
    let of_path = |path: S| lens * lens + twelfth + path * path * twelfth;
    let measured = width * width;
    // The path is only as sure as the slope: two sigma less and two more.
    let two = S::from_i32(2) * estimate.sigma_inverse_depth_per_m / estimate.inverse_depth_per_m;
    let least = of_path(path * (S::ONE - two).max(S::ZERO));
    let most = of_path(path * (S::ONE + two));
    // One sigma of each other part: the lens, the width (√2 of the column's, per edge), and the shape of the profile.
    let of_lens = S::ratio(2, 1) * lens * blur.sigma_lens_blur_px;
    let edges = S::from_i32(i32::from(line.edges()));
    let sigma_px = S::from_ratio(i64::from(line.last().sigma_q16), 1 << 16);
    let of_width = width * sigma_px * S::ratio(283, 100) / edges.sqrt();
    let four = |expected: S| hypot(hypot(of_lens, of_width), expected * S::ratio(7, 100)) * S::from_i32(4);
    measured < least - four(least) || measured > most * S::ratio(3, 2) + four(most)
}

/// Path of the edge along its row during the exposure, in pixels, in the middle of the line.
fn path_px<S: Scalar, M: Motion<S>, const KNOTS: usize>(
    setup: &Setup<S>,
    motion: &M,
    line: &Line<KNOTS>,
    edge: &LineInSpace<S>,
    exposure_s: S,
) -> Option<S> {
    let middle = line.samples::<S>().nth(line.samples::<S>().count() / 2)?;
    let half = exposure_s * S::ratio(1, 2);
    let miss = |time_s: S| {
        let sample = Sample::point(middle.column_px, middle.row_px, time_s, middle.sigma_px);
        edge.miss_px(&Sight::new(setup.camera(), motion, &sample)?)
    };
    Some((miss(middle.time_s + half)? - miss(middle.time_s - half)?).abs())
}

/// Column at which the fitted edge crosses the row of `near`, by Newton's iteration along that row.
fn column_at<S: Scalar, M: Motion<S>>(setup: &Setup<S>, motion: &M, edge: &LineInSpace<S>, near: &Edge) -> S {
    let mut sample = Sample::point(near.column_px(), S::from_i32(i32::from(near.row)), near.time_s(), S::ONE);
    // Exact in one step without distortion.
    for _ in 0..3 {
        match Sight::new(setup.camera(), motion, &sample).and_then(|sight| edge.miss_px(&sight)) {
            Some(miss) => sample.column_px = sample.column_px - miss,
            None => break,
        }
    }
    sample.column_px
}
