//! [`Range`]: what is told of one line.

use super::blur::{BlurMeasurement, LensBlurMeasurement};
use super::estimate::{Estimate, Interval};
use super::fit::{Fitted, fit_with};
use super::goodness_of_fit::GoodnessOfFit;
use super::line_state::LineState;
use super::line3::Line3;
use super::observation::Observation;
use super::prior::Prior;
use super::sample::Sample;
use super::status::RangeStatus;
use crate::edge::{EdgePoint, Polarity};
use crate::error::FitError;
use crate::line::Line;
use crate::motion::Motion;
use crate::scalar::Scalar;
use crate::setup::Setup;

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
    pub points: u16,
    /// Number of edge points that the estimate rests on: without those of knots that lie far off all others.
    pub points_used: u16,
    /// Dark to bright or bright to dark, from left to right.
    pub polarity: Polarity,
    /// Which line of a [`Sequence`](crate::Sequence) this is; `None` outside one.
    pub line_id: Option<u32>,
    /// Number of frames that the estimate rests on.
    pub frames: u32,
    /// What the edge tells of the lens's own blur; `None` without a known exposure or without pixels.
    pub lens: Option<LensBlurMeasurement<S>>,
}

impl<S: Scalar> Range<S> {
    /// The range of a line.
    ///
    /// *Cost*: a [`fit`](crate::fit) over the line's knots and a few rays.
    #[must_use]
    pub fn from_line<M: Motion<S>, const KNOTS: usize>(setup: &Setup<S>, motion: &M, line: &Line<KNOTS>) -> Self {
        Self::continued(setup, motion, line, None).0
    }

    /// The range of a line of which earlier frames may have told something, and what is known of it now; nothing where
    /// nothing could be fitted.
    pub(crate) fn continued<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
        earlier: Option<LineState<S>>,
    ) -> (Self, Option<LineState<S>>) {
        let mut range = Self::unknown(line);
        let blur = blur_measurement(setup, motion, line);
        // Where tilt is in question the blur decides, but only once: in later frames the lens's error would be the same,
        // and parallax tells far more.
        let blur_enters = setup.uncertainty().sigma_tilt_at(S::ZERO) > S::ZERO && earlier.is_none();
        let prior = Prior { state: earlier, blur: blur.filter(|_| blur_enters) };
        match fit_with::<S, M, KNOTS>(setup, motion, line.samples(), &prior) {
            Ok(fitted) => {
                range.fill(setup, motion, line, &fitted);
                if let Some(blur) = &blur {
                    range.check_blur(blur, &fitted.state.edge, blur_enters);
                }
                (range, Some(fitted.state))
            }
            Err(FitError::Sideways(_)) => (Self { status: RangeStatus::Sideways, ..range }, None),
            // A line of too few knots; the others cannot come from a line.
            Err(_) => (range, None),
        }
    }

    /// What was known of an edge before a line that tells nothing of it.
    pub(crate) fn remembered<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
        state: &LineState<S>,
    ) -> Self {
        let estimate = Estimate::new(state, setup, &GoodnessOfFit::NONE);
        let (top, bottom) = line.top_and_bottom();
        Self {
            status: status_of(setup, line, &estimate),
            estimate,
            column_at_first_row: column_at(setup, motion, &state.edge, top),
            column_at_last_row: column_at(setup, motion, &state.edge, bottom),
            ..Self::unknown(line)
        }
    }

    /// A line of which nothing but its place is known.
    fn unknown<const KNOTS: usize>(line: &Line<KNOTS>) -> Self {
        let (top, bottom) = line.top_and_bottom();
        Self {
            status: RangeStatus::Short,
            estimate: Estimate::nothing(),
            first_row: top.row,
            last_row: bottom.row,
            column_at_first_row: top.column_px(),
            column_at_last_row: bottom.column_px(),
            points: line.points(),
            points_used: 0,
            polarity: top.polarity,
            line_id: None,
            frames: 1,
            lens: None,
        }
    }

    fn fill<M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
        fitted: &Fitted<S, KNOTS>,
    ) {
        let (top, bottom) = line.top_and_bottom();
        let edge = &fitted.state.edge;
        self.column_at_first_row = column_at(setup, motion, edge, top);
        self.column_at_last_row = column_at(setup, motion, edge, bottom);
        self.estimate = fitted.estimate;
        self.points_used = line.points_in(fitted.kept.iter().copied());
        self.status = status_of(setup, line, &fitted.estimate);
        if self.status == RangeStatus::Ok && is_fragment(setup, self, line) {
            self.status = RangeStatus::Bent;
        }
    }

    /// Hears what the blur has to say: of the lens, and whether it contradicts the motion that the slope implies. An edge
    /// that is sharper than its slope implies leans; one that is much more blurred, before a known lens, moves more than it shows.
    fn check_blur(&mut self, blur: &BlurMeasurement<S>, edge: &Line3<S>, blur_entered: bool) {
        let path = blur.path_px(edge);
        if let Some(path) = path {
            let relative = self.relative_sigma();
            let sigma_of_path = path * path * S::ratio(1, 6) * relative.min(S::ONE);
            // An edge whose depth comes from its blur says nothing of the lens, unless it hardly moves.
            if !blur_entered || path.abs() < S::ONE {
                self.lens = Some(LensBlurMeasurement::new(blur, path, sigma_of_path));
            }
        }
        // An edge that the row does not cross half an exposure earlier or later is none.
        let is_blur_consistent = path.is_some_and(|path| self.is_blur_consistent(blur, path.abs()));
        if self.status == RangeStatus::Ok && !is_blur_consistent {
            self.status = RangeStatus::Inconsistent;
        }
    }

    /// Whether the blur is that of a path. The path is only as sure as the slope: two sigma less and two more.
    fn is_blur_consistent(&self, blur: &BlurMeasurement<S>, path_px: S) -> bool {
        let two = self.relative_sigma() * S::from_i32(2);
        let four = blur.joint_sigma_px2() * S::from_i32(4);
        let least = blur.excess_px2(path_px * (S::ONE + two));
        let most_px = path_px * (S::ONE - two).max(S::ZERO);
        let most = blur.excess_px2(most_px);
        let expected = blur.lens_and_pixel_px2() + path_px * path_px * S::ratio(1, 12);
        most >= -four && least <= expected * S::ratio(1, 2) + four
    }

    fn relative_sigma(&self) -> S {
        let estimate = &self.estimate;
        (estimate.sigma_inverse_depth_per_m / estimate.inverse_depth_per_m).abs()
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

/// What an estimate is worth if the line has edges enough.
fn status_of<S: Scalar, const KNOTS: usize>(
    setup: &Setup<S>,
    line: &Line<KNOTS>,
    estimate: &Estimate<S>,
) -> RangeStatus {
    if line.points() < setup.limits().min_points { RangeStatus::Short } else { estimate.status() }
}

/// A line of pixels that fits badly and has gaps is a piece of something else, or of several; a short one if it fits badly, has gaps,
/// or is seen in a crowd: only a long one can be straight beside a restless background.
fn is_fragment<S: Scalar, const KNOTS: usize>(setup: &Setup<S>, range: &Range<S>, line: &Line<KNOTS>) -> bool {
    let is_short = range.points < setup.readout().rows() / 5;
    let rows = u32::from(range.last_row.abs_diff(range.first_row)) + 1;
    let has_gaps = u32::from(range.points) * 4 < rows * 3;
    let fits_badly = range.estimate.misfit > S::ratio(3, 2);
    line.is_of_pixels() && (has_gaps && fits_badly || is_short && (line.is_cluttered() || has_gaps || fits_badly))
}

/// What the blur of a line's pixels says, where the exposure is known.
fn blur_measurement<S: Scalar, M: Motion<S>, const KNOTS: usize>(
    setup: &Setup<S>,
    motion: &M,
    line: &Line<KNOTS>,
) -> Option<BlurMeasurement<S>> {
    let (blur, width_px) = (setup.motion_blur()?, line.mean_width_px::<S>()?);
    // A row's width is not taken to be off by more than a half, in nine rows alike at the most.
    let most_px = width_px * S::ratio(3, 2) / S::from_i32(i32::from(line.points())).sqrt();
    let width = (width_px, line.mean_width_sigma_px::<S>().min(most_px));
    let middle = line.samples::<S>().nth(line.samples::<S>().count() / 2)?;
    BlurMeasurement::new(setup.camera(), motion, blur, &middle, width)
}

/// Column at which the fitted edge crosses the row of `near`, by Newton's iteration along that row.
fn column_at<S: Scalar, M: Motion<S>>(setup: &Setup<S>, motion: &M, edge: &Line3<S>, near: &EdgePoint) -> S {
    let mut sample = Sample::point(near.column_px(), S::from_i32(i32::from(near.row)), near.time_s(), S::ONE);
    // Exact in one step without distortion.
    for _ in 0..3 {
        match Observation::new(setup.camera(), motion, &sample).and_then(|observation| edge.residual_px(&observation)) {
            Some(miss) => sample.column_px = sample.column_px - miss,
            None => break,
        }
    }
    sample.column_px
}
