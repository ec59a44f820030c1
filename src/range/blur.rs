//! [`BlurMeasurement`]: the motion of an edge from its blur, whatever its lean. docs/model.md, section 5.

use super::equation::Equation;
use super::line3::Line3;
use super::observation::{Normals, Observer};
use super::sample::Sample;
use super::unknowns::Unknowns;
use crate::line::{Knot, Line};
use crate::motion::Motion;
use crate::scalar::{Scalar, hypot, ln, over};
use crate::setup::Setup;

/// The blur that motion has added to an edge, as a measurement of its path during the exposure.
///
/// The variance V of a blurred edge is lens² + 1/12 + B²/12. The path B comes from motion, whatever the lean. What is
/// measured is ln V: what an image pipeline does to widths is a factor, and as a share of the expected width it would excuse
/// any lean.
///
/// *Source*: blur = |slope caused by motion| · exposure / line time.
#[derive(Clone, Copy)]
pub(crate) struct BlurMeasurement<S> {
    /// The ray of the line's middle at the start and at the end of the exposure.
    ends: [Normals<S>; 2],
    /// Variance of the blurred edge.
    measured_px2: S,
    /// One sigma of its logarithm, from noise and from how far widths can be trusted.
    sigma_ln: S,
    lens_px: S,
    sigma_lens_px: S,
}

/// Steps towards the best compromise of positions and blur before the rounds: two leave less than a fiftieth of a sigma, and
/// save a round.
const PATH_STEPS: usize = 2;

/// A good edge may be so much more blurred than its slope implies, as a factor on the variance: the lens is softer in the
/// corners, and not everything is in focus.
const SOFTER: (i32, i32) = (3, 2);

/// Beyond so many sigmas the blur contradicts the slope.
const MOST_SIGMAS: i32 = 4;

impl<S: Scalar> BlurMeasurement<S> {
    /// From the widths of a line's points; `None` where the exposure is not known or too few widths were measured.
    // Not inlined, as other parts of a range: what each of them needs then leaves the stack before the next one comes.
    #[inline(never)]
    pub(super) fn of_line<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
    ) -> Option<Self> {
        let (blur, width_px) = (setup.motion_blur()?, line.mean_width_px::<S>()?);
        let axes = Line3::start(motion.gravity());
        let mut observer = Observer::new(setup.camera(), motion, [axes.gravity, axes.lean]);
        // No row's width is off by more than half of it, and at most nine rows in a row err alike.
        let most_px = width_px * S::ratio(3, 2) / S::from_i32(i32::from(line.points())).sqrt();
        let sigma_px = line.mean_width_sigma_px::<S>().min(most_px);
        let middle = line.middle_mean::<S>()?;
        let half = blur.exposure_s * S::ratio(1, 2);
        let mut at = |time_s: S| observer.observe(&Sample { time_s, ..middle }).map(|seen| seen.normals);
        // A variance is a square: its logarithm has twice the relative error of the width.
        let relative_sigma = hypot(sigma_px / width_px, setup.sigma_blur());
        Some(Self {
            ends: [at(middle.time_s - half)?, at(middle.time_s + half)?],
            measured_px2: width_px * width_px,
            sigma_ln: relative_sigma + relative_sigma,
            lens_px: blur.lens_blur_px,
            sigma_lens_px: blur.sigma_lens_blur_px,
        })
    }

    /// Variance of an edge that moves by a path during the exposure.
    fn expected_px2(&self, path_px: S) -> S {
        self.lens_px * self.lens_px + (S::ONE + path_px * path_px) * S::ratio(1, 12)
    }

    /// Logarithm of the measured variance over that of a path.
    fn excess_ln(&self, path_px: S) -> S {
        ln(self.measured_px2 / self.expected_px2(path_px))
    }

    /// Change of the logarithm of the expected variance with the lens's blur.
    fn per_lens_px(&self, path_px: S) -> S {
        (self.lens_px + self.lens_px) / self.expected_px2(path_px)
    }

    /// One sigma of the logarithm, the lens's own blur included.
    fn joint_sigma_ln(&self, path_px: S) -> S {
        let of_lens = self.per_lens_px(path_px) * self.sigma_lens_px;
        (self.sigma_ln * self.sigma_ln).plus_product(of_lens, of_lens).sqrt()
    }

    /// Path along the row during the exposure.
    fn path(&self, unknowns: &Unknowns<S>) -> Option<Path<S>> {
        let [start, end] = self.ends.each_ref().map(|end| unknowns.residual(end));
        Some(Path {
            px: start.px()? - end.px()?,
            per_inverse_depth: start.px_per_inverse_depth()? - end.px_per_inverse_depth()?,
        })
    }

    /// The same in pixels with its sign.
    pub(crate) fn path_px(&self, unknowns: &Unknowns<S>) -> Option<S> {
        self.path(unknowns).map(|path| path.px)
    }

    /// The two paths, one in either direction, that explain the blur: near each there may be a solution. Where they lie, given
    /// what the positions say of the inverse depth, as changes of it, each with what it costs; the better one first.
    pub(super) fn either_path(&self, unknowns: &Unknowns<S>, information: S) -> Option<[PathChoice<S>; 2]> {
        let path = self.path(unknowns)?;
        let blur_px = ((self.measured_px2 - self.expected_px2(S::ZERO)) * S::from_i32(12)).sqrt();
        // A sigma of the path is 6 V/B times that of the logarithm.
        let part = blur_px * S::ratio(1, 6) / (self.expected_px2(blur_px) * self.joint_sigma_ln(blur_px));
        let (of_path, of_blur) = (path.per_inverse_depth, part * part);
        let of_blur = of_blur * of_path * of_path;
        let share = of_blur * over(of_blur + information);
        let with_path = |wanted: S| {
            let off = (wanted - path.px) / of_path;
            PathChoice { change_per_m: off * share, cost: off * off * share * information }
        };
        let (along, against) = (with_path(blur_px), with_path(-blur_px));
        let [mut better, other] = if along.cost <= against.cost { [along, against] } else { [against, along] };
        for _ in 0..PATH_STEPS {
            better.change_per_m = self.compromise(&path, information, better.change_per_m);
        }
        let choices = [better, other];
        choices.iter().all(|choice| choice.change_per_m.is_finite() && choice.cost.is_finite()).then_some(choices)
    }

    /// Whether the measured blur is that of the path which the slope implies. The path is known no better than the slope:
    /// by two sigma. Sharper than that means that the slope is a lean; much more blurred, beside a known lens, that a lean
    /// hides a part of the slope.
    pub(super) fn is_consistent(&self, path_px: S, relative_sigma: S) -> bool {
        let two = relative_sigma * S::from_i32(2);
        let (longer, shorter) = (path_px * (S::ONE + two), path_px * (S::ONE - two).max(S::ZERO));
        let most = |path_px| self.joint_sigma_ln(path_px) * S::from_i32(MOST_SIGMAS);
        let softer = S::ratio(SOFTER.0, SOFTER.1);
        self.excess_ln(shorter) >= -most(shorter) && self.excess_ln(longer) <= ln(softer) + most(longer)
    }

    /// What is left of the measured variance for the lens, given the path and how well it is known.
    pub(super) fn of_lens(&self, path_px: S, relative_sigma: S) -> Option<LensBlurMeasurement<S>> {
        let sigma_of_path_px2 = path_px * path_px * S::ratio(1, 6) * relative_sigma.min(S::ONE);
        let variance_px2 = self.lens_px * self.lens_px + self.measured_px2 - self.expected_px2(path_px);
        let sigma_px2 = hypot(self.measured_px2 * self.sigma_ln, sigma_of_path_px2);
        (variance_px2.is_finite() && sigma_px2.is_finite()).then_some(LensBlurMeasurement { variance_px2, sigma_px2 })
    }

    /// Change of the inverse depth at which positions and blur agree best, linearised about a first guess of it.
    fn compromise(&self, path: &Path<S>, information: S, change_per_m: S) -> S {
        let path_px = path.px + change_per_m * path.per_inverse_depth;
        let per_sigma = over(self.joint_sigma_ln(path_px));
        let q = path_px * S::ratio(1, 6) * path.per_inverse_depth / self.expected_px2(path_px) * per_sigma;
        q * (q * change_per_m + self.excess_ln(path_px) * per_sigma) * over(q * q + information)
    }

    /// Linearised about `unknowns`, and what a pixel of the lens's own blur takes from its y.
    pub(super) fn equation(&self, unknowns: &Unknowns<S>) -> Option<(Equation<S>, S)> {
        let path = self.path(unknowns)?;
        let per_sigma = over(self.joint_sigma_ln(path.px));
        let q = path.px * S::ratio(1, 6) * path.per_inverse_depth / self.expected_px2(path.px);
        let equation = Equation { q, y: self.excess_ln(path.px), ..Equation::NOTHING };
        Some((equation.scaled(per_sigma), self.per_lens_px(path.px) * per_sigma))
    }
}

/// A path along the row in pixels, and its change with the inverse depth. Translation moves the ends in proportion to the
/// inverse depth; rotation does so at any depth.
struct Path<S> {
    px: S,
    per_inverse_depth: S,
}

/// A change of the inverse depth to where positions and one direction of the path agree best, and the squares of what both
/// deviate there.
pub(super) struct PathChoice<S> {
    pub(super) change_per_m: S,
    pub(super) cost: S,
}

/// The lens's own blur as one edge shows it: the variance that neither motion nor the pixel explains.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LensBlurMeasurement<S> {
    /// In square pixels; noise can make it negative.
    pub variance_px2: S,
    /// One standard deviation.
    pub sigma_px2: S,
}

impl<const KNOTS: usize> Line<KNOTS> {
    /// Mean of the measured widths (one sigma of blur) in pixels; `None` unless most points have one. The first knot, in
    /// which the width settles, counts only where there is no other.
    #[must_use]
    pub fn mean_width_px<S: Scalar>(&self) -> Option<S> {
        let sum = self.settled();
        (sum.widths > sum.points / 2).then(|| S::from_ratio(i64::from(sum.widths_q8), i64::from(sum.widths) << 8))
    }

    /// One standard deviation of the mean width: a width has one to two times the noise of its column.
    pub(crate) fn mean_width_sigma_px<S: Scalar>(&self) -> S {
        let sum = self.settled();
        // The mean variance, over the number of widths.
        let mean_q32 = (sum.variances_q32 / u64::from(sum.points.max(1))).saturating_mul(4);
        let of_mean_q32 = (mean_q32 / u64::from(sum.widths.max(1))).min(i64::MAX as u64);
        S::from_ratio(of_mean_q32.isqrt() as i64, 1 << 16)
    }

    /// All knots but the first, unless it is the only one.
    fn settled(&self) -> Knot {
        let mut sum = Knot::EMPTY;
        self.knots.iter().skip(usize::from(self.knots.len() > 1)).for_each(|knot| sum.add(knot));
        sum
    }
}
