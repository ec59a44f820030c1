//! [`Range`]: what is told of one line.

use super::blur::{Blur, BlurMeasurement, LensBlurMeasurement};
use super::estimate::{Estimate, Interval, Sigmas};
use super::fit::{Fitted, fit_strictly, fit_with};
use super::goodness_of_fit::GoodnessOfFit;
use super::line_state::LineState;
use super::line3::Line3;
use super::observation::Observer;
use super::prior::{Knowledge, Nothing, Prior, SampleSet};
use super::sample::Sample;
use super::status::{Objection, RangeStatus};
use super::tuning::{MISFIT_PER_LENGTH, ROUGHNESS_ROWS, USUAL_MISFIT};
use super::unknowns::Unknowns;
use crate::edge::{EdgePoint, Polarity};
use crate::error::FitError;
use crate::line::Line;
use crate::motion::Motion;
use crate::scalar::Scalar;
use crate::setup::{Readout, Setup};

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
    pub lens_blur: Option<LensBlurMeasurement<S>>,
}

impl<S: Scalar> Range<S> {
    /// The range of a line.
    ///
    /// *Cost*: a [`fit`](crate::fit) over the line's knots and a few rays.
    #[must_use]
    pub fn from_line<M: Motion<S>, const KNOTS: usize>(setup: &Setup<S>, motion: &M, line: &Line<KNOTS>) -> Self {
        Self::with_its_blur(setup, motion, line, Prior::new(None, SampleSet::default()), None)
    }

    /// The range of a line from the places of its points alone, whatever is known of the exposure: that of
    /// [`from_line`](Self::from_line) where nothing is.
    ///
    /// A blur that contradicts the slope is no objection here: edges that lean are `Ok` or `Far` as without an exposure.
    /// A program that ranges no line otherwise, but takes them by [`Ranger::next_line`](crate::Ranger::next_line), does
    /// not hold what measures blur.
    ///
    /// *Cost*: as [`from_line`](Self::from_line) without an exposure.
    #[must_use]
    pub fn without_blur<M: Motion<S>, const KNOTS: usize>(setup: &Setup<S>, motion: &M, line: &Line<KNOTS>) -> Self {
        Self::fitted(setup, motion, line, Prior::new(None, SampleSet::default()), None, None)
    }

    /// The range of a line that a straight edge explains with noise and roughness as stated, as
    /// [`without_blur`](Self::without_blur); any other line is [`Bent`](RangeStatus::Bent).
    ///
    /// Where the usual range has a wider sigma for an edge that wanders, or leaves out what lies far off, this one refuses
    /// the line: of clean edges less than one in ten (`cargo test strict`). A program that ranges no line otherwise does
    /// not hold what repairs. Roughness counts as if it were twice as large, which covers how
    /// it is alike from knot to knot where these have four rows and more.
    ///
    /// *Cost*: at most that of [`without_blur`](Self::without_blur).
    #[must_use]
    pub fn strict<M: Motion<S>, const KNOTS: usize>(setup: &Setup<S>, motion: &M, line: &Line<KNOTS>) -> Self {
        let mut estimate = Estimate::nothing();
        let fitted = fit_strictly::<S, M, KNOTS, _>(setup, motion, || line.samples(), &mut estimate);
        let fitted = fitted.as_ref().map(|fitted| (fitted, &estimate)).map_err(|error| *error);
        Self::told(setup, motion, line, &Nothing, None, fitted)
    }

    /// The range of a line of which earlier frames may have told something. `known` becomes what is known of it now;
    /// nothing where nothing could be fitted.
    pub(crate) fn continued<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
        earlier: Option<&LineState<S>>,
        left_out: SampleSet,
        known: &mut Option<LineState<S>>,
    ) -> Self {
        let statements = earlier.map(LineState::statements);
        let prior = Prior::new(earlier.zip(statements.as_ref()), left_out);
        Self::with_its_blur(setup, motion, line, prior, Some(known))
    }

    /// The range that is to be expected of an edge, from a line that is drawn where it will be seen.
    pub(crate) fn predicted<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
    ) -> Self {
        let prior = Prior { is_drawn: true, ..Prior::new(None, SampleSet::default()) };
        Self::with_its_blur(setup, motion, line, prior, None)
    }

    /// The range of a line whose blur is measured, if that tells anything.
    fn with_its_blur<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
        prior: Prior<'_, S>,
        known: Option<&mut Option<LineState<S>>>,
    ) -> Self {
        let blur = BlurMeasurement::of_line(setup, motion, line);
        Self::fitted(setup, motion, line, prior, blur.as_ref().map(|blur| blur as &dyn Blur<S>), known)
    }

    // Not inlined, as its parts: what each of them needs then leaves the stack before the next one comes.
    #[inline(never)]
    fn fitted<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
        prior: Prior<'_, S>,
        blur: Option<&dyn Blur<S>>,
        mut known: Option<&mut Option<LineState<S>>>,
    ) -> Self {
        // Where the tilt is in question the blur decides, but only once: in later frames the lens's error would be the
        // same, and parallax tells far more.
        let is_in_question = setup.uncertainty().allows_tilt() && prior.state.is_none();
        let width_px = line.mean_width_px();
        let blur_enters = is_in_question && setup.widths_are_known() && width_px.is_some();
        let width_px = width_px.unwrap_or(S::ONE);
        let row_spacing = line.row_spacing();
        let prior = Prior { blur: blur.filter(|_| blur_enters), width_px, row_spacing, ..prior };
        let kept = known.as_deref_mut().map(|known| known.insert(LineState::NOTHING));
        let mut estimate = Estimate::nothing();
        let fitted = fit_with::<S, M, KNOTS, _>(setup, motion, || line.samples(), &prior, &mut estimate, kept);
        if let (Err(_), Some(known)) = (&fitted, known) {
            *known = None;
        }
        let fitted = fitted.as_ref().map(|fitted| (fitted, &estimate)).map_err(|error| *error);
        Self::told(setup, motion, line, &prior, blur, fitted)
    }

    /// What a fit with a prior has told, beside the blur, which need not have entered it.
    // A range has room on the stack when the fit has left it.
    #[inline(never)]
    fn told<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
        prior: &impl Knowledge<S>,
        blur: Option<&dyn Blur<S>>,
        fitted: Result<(&Fitted<S, KNOTS>, &Estimate<S>), FitError>,
    ) -> Self {
        let mut range = Self::unfitted(line);
        match fitted {
            Ok((fitted, estimate)) => {
                range.estimate = *estimate;
                range.fill(setup, motion, line, prior, fitted);
                if let Some(blur) = blur {
                    range.compare_with_blur(blur, &fitted.unknowns, prior.blur().is_some());
                }
            }
            Err(FitError::Sideways(_)) => range.status = RangeStatus::Sideways,
            Err(FitError::Diverged) => range.status = status_of(setup, line, &range.estimate),
            // A line of too few knots; the others cannot come from a line.
            Err(_) => {}
        }
        range
    }

    /// What was known of an edge before a line that tells nothing of it.
    pub(crate) fn remembered<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
        state: &LineState<S>,
    ) -> Self {
        let mut estimate = Estimate::nothing();
        estimate.set(state, setup, &GoodnessOfFit::NONE);
        let (top, bottom) = line.top_and_bottom();
        Self {
            // However short the line is that hides it.
            status: estimate.status(),
            estimate,
            column_at_first_row: column_at(setup, motion, &state.line3, top),
            column_at_last_row: column_at(setup, motion, &state.line3, bottom),
            ..Self::unfitted(line)
        }
    }

    /// A line of which nothing but its place in the image is known.
    #[inline(never)]
    fn unfitted<const KNOTS: usize>(line: &Line<KNOTS>) -> Self {
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
            lens_blur: None,
        }
    }

    #[inline(never)]
    fn fill<M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
        prior: &impl Knowledge<S>,
        fitted: &Fitted<S, KNOTS>,
    ) {
        let is_single = prior.state().is_none();
        let (top, bottom) = line.top_and_bottom();
        let line3 = &prior.axes(motion).with(fitted.unknowns);
        self.column_at_first_row = column_at(setup, motion, line3, top);
        self.column_at_last_row = column_at(setup, motion, line3, bottom);
        self.points_used = line.points_in(fitted.inliers.iter().copied());
        let leans = leans_too_much(setup, motion.gravity(), &self.estimate, is_single);
        // Frames that agree are evidence enough, however short or cluttered the line is in this one.
        let status = if is_single { status_of(setup, line, &self.estimate) } else { self.estimate.status() };
        self.status = status
            .unless(Objection::FittedLean, leans)
            .unless(Objection::Light, is_single && (line.is_cut_by_light() || line.is_piece()))
            .unless(Objection::Clutter, is_single && self.is_by_chance(line));
    }

    /// Whether it does not stand out of what is around; or is so short for how much it scatters that a wander of its edge
    /// and pieces of several edges look alike.
    fn is_by_chance<const N: usize>(&self, line: &Line<N>) -> bool {
        let lengths = S::ratio(i32::from(self.last_row.abs_diff(self.first_row)) + 1, ROUGHNESS_ROWS);
        let most = (S::ratio(MISFIT_PER_LENGTH.0, MISFIT_PER_LENGTH.1) * lengths)
            .max(S::ratio(USUAL_MISFIT.0, USUAL_MISFIT.1));
        !line.stands_out(1) || line.is_of_pixels() && self.estimate.misfit > most
    }

    /// Takes from the blur what it tells of the lens, and refuses an edge whose blur contradicts its slope.
    fn compare_with_blur(&mut self, blur: &dyn Blur<S>, found: &Unknowns<S>, blur_entered: bool) {
        let is_consistent;
        (is_consistent, self.lens_blur) = blur.compare(found, self.estimate.sigma_inverse_depth_per_m, blur_entered);
        self.status = self.status.unless(Objection::Blur, !is_consistent);
    }

    /// The same under the name that a sequence gives to its edge. `moves`: earlier frames show it where a static edge
    /// cannot be.
    pub(crate) fn named(self, line_id: u32, frames: u32, moves: bool, is_weak: bool) -> Self {
        let status = self.status.unless(Objection::Motion, moves).unless(Objection::FewFrames, is_weak);
        Self { line_id: Some(line_id), frames, status, ..self }
    }

    /// The same where nothing but this frame shows the edge, and that badly.
    pub(crate) fn tentative(self) -> Self {
        Self { status: self.status.unless(Objection::FewFrames, true), ..self }
    }

    /// Whether the line has points on so few of the frame's rows that other things around it count.
    pub(crate) fn is_short_part_of(&self, readout: &Readout) -> bool {
        self.points < readout.rows() / SHORT_PART
    }

    /// Depth and its bounds so many sigmas of inverse depth on either side, as [`Estimate::depth`]; no most likely
    /// value unless the status is [`Ok`](RangeStatus::Ok), and no bounds where it says that the slope is no depth.
    #[must_use]
    pub fn depth(&self, sigmas: Sigmas<S>) -> Interval<S> {
        self.as_status_allows(self.estimate.depth(sigmas))
    }

    /// Shortest distance to the edge's line, as [`Estimate::distance`]; no most likely value unless the status is
    /// [`Ok`](RangeStatus::Ok).
    #[must_use]
    pub fn distance(&self, sigmas: Sigmas<S>) -> Interval<S> {
        self.as_status_allows(self.estimate.distance(sigmas))
    }

    fn as_status_allows(&self, interval: Interval<S>) -> Interval<S> {
        match self.status {
            RangeStatus::Ok => interval,
            status if status.bounds_depth() => Interval { estimate_m: None, ..interval },
            _ => Interval::NONE,
        }
    }
}

/// Points on less than a fifth of the rows.
const SHORT_PART: u16 = 5;

/// What an estimate is worth, if the line has points enough.
fn status_of<S: Scalar, const KNOTS: usize>(
    setup: &Setup<S>,
    line: &Line<KNOTS>,
    estimate: &Estimate<S>,
) -> RangeStatus {
    if line.points() < setup.limits().min_points { RangeStatus::Short } else { estimate.status() }
}

/// A fitted lean of more prior sigmas than this contradicts the prior.
const MOST_PRIOR_SIGMAS: i32 = 4;

/// Whether the fitted lean contradicts the prior: the edge leans more than was stated, or its clock is wrong. Where the
/// parallax of several frames has measured the lean, only a large one speaks against the edge.
fn leans_too_much<S: Scalar>(setup: &Setup<S>, gravity: [S; 3], estimate: &Estimate<S>, is_single: bool) -> bool {
    let prior = setup.uncertainty().sigma_tilt_at(estimate.bearing, gravity);
    let is_measured = !is_single && estimate.sigma_tilt + estimate.sigma_tilt < prior;
    let most = if is_measured {
        S::from_ratio(setup.limits().max_lean_q16.into(), 1 << 16)
    } else {
        prior * S::from_i32(MOST_PRIOR_SIGMAS)
    };
    prior > S::ZERO && estimate.tilt.abs() > most
}

/// Column at which the fitted line crosses the row of `near`, by Newton's iteration along that row; that of `near`
/// itself where the line does not cross the row.
pub(crate) fn column_at<S: Scalar, M: Motion<S>>(
    setup: &Setup<S>,
    motion: &M,
    line3: &Line3<S>,
    near: &EdgePoint,
) -> S {
    let mut sample = Sample::point(near.column_px(), S::from_i32(i32::from(near.row)), near.time_s(), S::ONE);
    let mut observer = Observer::new(setup.camera(), motion, [line3.gravity, line3.lean]);
    // Exact in one step without distortion.
    let steps = if setup.camera().is_straight() { 1 } else { 3 };
    for _ in 0..steps {
        match observer.observe(&sample).and_then(|observation| line3.residual(&observation).px()) {
            Some(off_px) => {
                sample.column_px = sample.column_px - off_px;
                // The next step would be the square of this, in units of the focal length.
                if off_px.abs() < S::ratio(1, 256) {
                    break;
                }
            }
            None => break,
        }
    }
    if sample.column_px.is_finite() { sample.column_px } else { near.column_px() }
}
