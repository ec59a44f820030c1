//! [`BlurMeasurement`]: the motion of an edge from its blur, whatever its lean. docs/model.md, section 5.

use super::equation::Equation;
use super::line3::Line3;
use super::observation::{Normals, Observer};
use super::unknowns::Unknowns;
use crate::line::{Knot, Line};
use crate::motion::Motion;
use crate::scalar::{Scalar, hypot, ln, over};
use crate::setup::{MotionBlur, Setup};

/// What the blur of an edge tells, for a fit and for what is told of it.
///
/// A program that asks no line for its blur never makes a [`BlurMeasurement`] one of these, so that the linker leaves
/// out what only that needs.
pub(super) trait Blur<S: Scalar> {
    /// The two paths, one in either direction, that explain the blur: near each there may be a solution. Where they
    /// lie, given what the positions say of the inverse depth, as changes of it, each with what it costs; the better
    /// one first.
    fn either_path(&self, unknowns: &Unknowns<S>, information: S) -> Option<[PathChoice<S>; 2]>;

    /// Linearised about `unknowns`, and what a pixel of the lens's own blur takes from its y.
    fn equation(&self, unknowns: &Unknowns<S>) -> Option<(Equation<S>, S)>;

    /// What errors of the path do to that equation.
    fn path_errors(&self, unknowns: &Unknowns<S>) -> Option<PathErrors<S>>;

    /// Whether it is that of the slope which a fit has found, and what it tells of the lens. `entered`: the fit has made
    /// use of it.
    fn compare(&self, found: &Unknowns<S>, sigma_per_m: S, entered: bool) -> (bool, Option<LensBlurMeasurement<S>>);
}

/// The blur that motion has added to an edge, as a measurement of its path during the exposure.
///
/// The variance V of a blurred edge is lens² + 1/12 + B²/12. The path B comes from motion, whatever the lean. What is
/// measured is ln V: what an image pipeline does to widths is a factor, and as a share of the expected width it would
/// excuse any lean.
///
/// *Source*: blur = |slope caused by motion| · exposure / line time.
#[derive(Clone, Copy)]
pub(crate) struct BlurMeasurement<'a, S: Scalar> {
    /// In two places of the line, what its ray at the start of the exposure differs by from that at the end.
    sweeps: [Normals<S>; 2],
    /// Mean variance of the blurred edge.
    measured_px2: S,
    /// One sigma of its logarithm, from noise and from how far widths can be trusted.
    sigma_ln: S,
    /// The same of an edge that is narrower than expected.
    sigma_narrow_ln: S,
    /// Likewise, but for noise: of what an image pipeline does to it.
    sigma_narrowed_ln: S,
    /// One sigma of what sharpening has taken from the variance, and its variance together with that of the lens's own
    /// blur.
    sigma_sharpened_px2: S,
    variance_px4: S,
    /// The variance is no more than that.
    most_px2: Option<S>,
    /// Whether widths were measured.
    is_measured: bool,
    stated: &'a MotionBlur<S>,
}

/// Where the two places are, from either end of the line: the mean square of a path that changes linearly along it is
/// that of these two (Gauss's rule).
const PLACE: (i32, i32) = (21_132, 100_000);

/// Steps towards the best compromise of positions and blur before the rounds: two leave less than a fiftieth of a
/// sigma, and save a round.
const PATH_STEPS: usize = 2;

/// A good edge may be so much more blurred than its slope implies, as the logarithm of a factor on the variance: of 3/2.
/// The lens is softer in the corners, and not everything is in focus.
const LN_SOFTER: (i32, i32) = (405_465, 1_000_000);

/// How far the width of an edge of pixels may be below the expected one but for sharpening, as a sigma of its
/// logarithm, where none is stated: tone curves, denoising and mosaics change it by less
/// (`false_distances::of_leaning_bars` with more, `real_cameras` with half of it).
const UNSHARPENED: (i32, i32) = (1, 8);

/// Sharpening that lets the levels overshoot by one contrast times a pixel takes at most so many square pixels from the
/// variance: 14 to 29 for unsharp masks of 3 to 5 pixels (docs/model.md, 5.4), the most where it matters least
/// (`real_cameras::sharpened_frames_said_to_be_linear` with a third).
const SHARPENED_PX: i32 = 24;

/// Beyond so many sigmas, and two of the slope's, the blur contradicts the slope: what leans is sharper, by less than
/// this in clutter (`false_distances::of_clutter` with four); a lens or a focus that is not what was stated makes edges
/// wider.
const MOST_SIGMAS_NARROWER: i32 = 3;
const MOST_SIGMAS_WIDER: i32 = 4;

impl<'a, S: Scalar> BlurMeasurement<'a, S> {
    /// From the widths of a line's points, and where texture or neighbours make them unsure, from how sharp its pixels are
    /// at least; `None` where the exposure is not known or neither tells anything.
    // Not inlined, as other parts of a range: what each of them needs then leaves the stack before the next one comes.
    #[inline(never)]
    pub(super) fn of_line<M: Motion<S>, const KNOTS: usize>(
        setup: &'a Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
    ) -> Option<Self> {
        let (blur, mean_px) = (setup.motion_blur()?, line.mean_width_px::<S>());
        let most_px2 = line.most_variance_q16(mean_px.is_some()).map(|q16| S::from_ratio(q16.into(), 1 << 16));
        let width_px = mean_px.or_else(|| most_px2.map(S::sqrt))?;
        let axes = Line3::start(motion.gravity());
        let mut observer = Observer::new(setup.camera(), motion, [axes.gravity, axes.lean]);
        // No row's width is off by more than half of it, and at most nine rows in a row err alike.
        let most_px = width_px * S::ratio(3, 2) / S::from_i32(i32::from(line.points())).sqrt();
        let width_sigma_px = line.mean_width_sigma_px::<S>();
        let sigma_px = if mean_px.is_some() { width_sigma_px.min(most_px) } else { S::ZERO };
        let half = blur.exposure_s * S::ratio(1, 2);
        let place = S::ratio(PLACE.0, PLACE.1);
        let [first, second] = [place, S::ONE - place].map(|part| observer.sweep(&line.point_between(part), half));
        // A variance is a square: its logarithm has twice the relative error of the width.
        let twice = |relative_sigma: S| relative_sigma + relative_sigma;
        let sigma_blur = setup.sigma_blur();
        let unsharpened = S::ratio(UNSHARPENED.0, UNSHARPENED.1);
        // What is stated holds as it is.
        let is_stated = blur.sigma_blur.is_some();
        let is_as_wide = is_stated || !line.is_of_pixels();
        let sigma_narrow = if is_as_wide { sigma_blur } else { sigma_blur.min(unsharpened) };
        let overshoot = if is_stated { 0 } else { line.overshoot_q16() };
        let sigma_sharpened_px2 = S::from_ratio(i64::from(overshoot) * i64::from(SHARPENED_PX), 1 << 16);
        let sigma_lens_px2 = (blur.lens_blur_px + blur.lens_blur_px) * blur.sigma_lens_blur_px;
        Some(Self {
            sweeps: [first?, second?],
            measured_px2: match mean_px {
                Some(mean_px) => line.mean_square_width_px2(mean_px, width_sigma_px),
                None => width_px * width_px,
            },
            most_px2,
            is_measured: mean_px.is_some(),
            sigma_ln: twice(hypot(sigma_px / width_px, sigma_blur)),
            sigma_narrow_ln: twice(hypot(sigma_px / width_px, sigma_narrow)),
            sigma_narrowed_ln: twice(sigma_narrow),
            sigma_sharpened_px2,
            variance_px4: sigma_lens_px2 * sigma_lens_px2 + sigma_sharpened_px2 * sigma_sharpened_px2,
            stated: blur,
        })
    }

    /// Mean variance of an edge that moves by a path during the exposure.
    fn expected_px2(&self, path: &Path<S>) -> S {
        let lens_px = self.stated.lens_blur_px;
        lens_px * lens_px + (S::ONE + path.mean_square_px2()) * S::ratio(1, 12)
    }

    /// One over it.
    fn per_px2(&self, path: &Path<S>) -> S {
        over(self.expected_px2(path))
    }

    /// Logarithm of the measured variance over the expected one.
    fn excess_ln(&self, per_px2: S) -> S {
        ln(self.measured_px2 * per_px2)
    }

    /// One sigma of the logarithm, with those of the lens's own blur and of sharpening.
    fn joint(&self, sigma_ln: S, per_px2: S) -> S {
        (sigma_ln * sigma_ln).plus_product(self.variance_px4 * per_px2, per_px2).sqrt()
    }

    /// In units of its sigma, the change of the expected logarithm with the inverse depth, and its excess; and one over
    /// that sigma.
    fn linearised(&self, path: &Path<S>, per_px2: S) -> ([S; 2], S) {
        let per_sigma = over(self.joint(self.sigma_ln, per_px2));
        let q = path.px * S::ratio(1, 6) * path.per_inverse_depth * per_px2;
        ([q, self.excess_ln(per_px2)].map(|part| part * per_sigma), per_sigma)
    }

    /// Path along the row during the exposure.
    fn path(&self, unknowns: &Unknowns<S>) -> Option<Path<S>> {
        let [first, second] = self.sweeps.each_ref().map(|sweep| unknowns.residual(sweep));
        let per_inverse_depth = [first.px_per_inverse_depth()?, second.px_per_inverse_depth()?];
        Some(Path::along([first.px()?, second.px()?], per_inverse_depth))
    }

    /// Whether the measured blur is that of the path which the slope implies. The path is known no better than the
    /// slope: by two sigma. Sharper than that means that the slope is a lean; much more blurred, beside a known lens,
    /// that a lean hides a part of the slope.
    fn is_consistent(&self, path: &Path<S>, sigma_per_m: S) -> bool {
        let sigma_px = path.per_inverse_depth * sigma_per_m;
        let longer = path.to(path.px.abs() + sigma_px + sigma_px);
        let shorter = path.to((path.px.abs() - sigma_px - sigma_px).max(S::ZERO));
        let [longer, shorter] = [longer, shorter].map(|path| self.per_px2(&path));
        let most = |sigmas, sigma_ln, per_px2| self.joint(sigma_ln, per_px2) * S::from_i32(sigmas);
        // Of most all of this is plain without a logarithm.
        let is_as_wide = |(variance_px2, sigma_ln): (S, S)| {
            let part = variance_px2 * shorter;
            part >= S::ONE || ln(part) >= -most(MOST_SIGMAS_NARROWER, sigma_ln, shorter)
        };
        let measured = (self.measured_px2, self.sigma_narrow_ln);
        let seen = self.most_px2.map_or(measured, |most_px2| (most_px2, self.sigma_narrowed_ln));
        let softer = || S::ratio(LN_SOFTER.0, LN_SOFTER.1) + most(MOST_SIGMAS_WIDER, self.sigma_ln, longer);
        let is_no_wider = || self.measured_px2 * longer <= S::ONE || self.excess_ln(longer) <= softer();
        [measured, seen].into_iter().all(is_as_wide) && (!self.is_measured || is_no_wider())
    }

    /// What is left of the measured variance for the lens, given the path and how well it is known.
    fn of_lens(&self, path: &Path<S>, sigma_per_m: S) -> Option<LensBlurMeasurement<S>> {
        let path_px = path.px.abs();
        let sigma_of_path_px2 = path_px * S::ratio(1, 6) * (path.per_inverse_depth * sigma_per_m).min(path_px);
        let lens_px = self.stated.lens_blur_px;
        let variance_px2 = lens_px * lens_px + self.measured_px2 - self.expected_px2(path);
        let sigma_px2 = hypot(self.measured_px2 * self.sigma_ln, hypot(self.sigma_sharpened_px2, sigma_of_path_px2));
        (variance_px2.is_finite() && sigma_px2.is_finite()).then_some(LensBlurMeasurement { variance_px2, sigma_px2 })
    }

    /// Change of the inverse depth at which positions and blur agree best, linearised about a first guess of it.
    fn compromise(&self, path: &Path<S>, information: S, change_per_m: S) -> S {
        let path = path.to(path.px + change_per_m * path.per_inverse_depth);
        let ([q, excess], _) = self.linearised(&path, self.per_px2(&path));
        q * (q * change_per_m + excess) * over(q * q + information)
    }
}

impl<S: Scalar> Blur<S> for BlurMeasurement<'_, S> {
    fn either_path(&self, unknowns: &Unknowns<S>, information: S) -> Option<[PathChoice<S>; 2]> {
        let path = self.path(unknowns)?;
        let blur_px = ((self.measured_px2 - self.expected_px2(&path.to(S::ZERO))) * S::from_i32(12)).sqrt();
        let blurred = path.to(blur_px);
        // A sigma of the path is 6 V/B times that of the logarithm.
        let per_px2 = self.per_px2(&blurred);
        let part = blur_px * S::ratio(1, 6) * per_px2 * over(self.joint(self.sigma_ln, per_px2));
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

    fn equation(&self, unknowns: &Unknowns<S>) -> Option<(Equation<S>, S)> {
        let path = self.path(unknowns)?;
        let per_px2 = self.per_px2(&path);
        let ([q, y], per_sigma) = self.linearised(&path, per_px2);
        let lens_px = self.stated.lens_blur_px;
        Some((Equation { q, y, ..Equation::NOTHING }, (lens_px + lens_px) * per_px2 * per_sigma))
    }

    fn path_errors(&self, unknowns: &Unknowns<S>) -> Option<PathErrors<S>> {
        let per_px2 = self.per_px2(&self.path(unknowns)?);
        let per_sigma = over(self.joint(self.sigma_ln, per_px2));
        let [first, second] = self.sweeps.each_ref().map(|sweep| unknowns.residual(sweep).px());
        let (first, second) = (first?, second?);
        // The variance has a twelfth of the mean of two squares.
        let per_px2 = per_px2 * per_sigma * S::ratio(1, 12);
        Some(PathErrors {
            exposure_s: self.stated.exposure_s,
            y_per_px: -((first + second) * per_px2),
            y_of_length: -((first * first).plus_product(second, second) * per_px2),
        })
    }

    fn compare(&self, found: &Unknowns<S>, sigma_per_m: S, entered: bool) -> (bool, Option<LensBlurMeasurement<S>>) {
        // Where the edge leaves the row within the exposure, there is no upright edge.
        let Some(path) = self.path(found) else { return (false, None) };
        // An edge whose depth comes from its blur tells nothing of the lens, unless it hardly moves.
        let tells = self.is_measured && (!entered || path.mean_square_px2() < S::ONE);
        let lens = if tells { self.of_lens(&path, sigma_per_m) } else { None };
        (self.is_consistent(&path, sigma_per_m), lens)
    }
}

/// The mean square of a path along the row, over the line, as a function of the inverse depth: translation moves a ray
/// in proportion to the inverse depth, rotation does so at any depth.
#[derive(Clone, Copy)]
struct Path<S> {
    /// What changes with the inverse depth, in pixels: zero where the path is shortest.
    px: S,
    /// Not negative.
    per_inverse_depth: S,
    /// Square of what is left where it is shortest: along the line the path changes, and is not zero everywhere.
    rest_px2: S,
}

impl<S: Scalar> Path<S> {
    /// From the paths in two places.
    fn along([first, second]: [S; 2], [per_first, per_second]: [S; 2]) -> Self {
        let mean = |one: S, other: S| (one + other).half();
        let per_inverse_depth = mean(per_first * per_first, per_second * per_second).sqrt();
        let px = mean(first * per_first, second * per_second) * over(per_inverse_depth);
        let rest_px2 = (mean(first * first, second * second) - px * px).max(S::ZERO);
        Self { px, per_inverse_depth, rest_px2 }
    }

    /// At another inverse depth.
    fn to(self, px: S) -> Self {
        Self { px, ..self }
    }

    fn mean_square_px2(&self) -> S {
        self.px * self.px + self.rest_px2
    }
}

/// What errors of the path along the row, which is how much further the line is off at the start of an exposure than at its
/// end, add to the y of an equation.
pub(super) struct PathErrors<S> {
    pub(super) exposure_s: S,
    /// A pixel more.
    pub(super) y_per_px: S,
    /// As much more as it is long.
    pub(super) y_of_length: S,
}

/// A change of the inverse depth to where positions and one direction of the path agree best, and the squares of what
/// both deviate there.
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
    /// Mean of the measured widths (one sigma of blur) in pixels; `None` unless most points have one. The first knot,
    /// in which the width settles, counts only where there is no other.
    #[must_use]
    pub fn mean_width_px<S: Scalar>(&self) -> Option<S> {
        let sum = self.settled();
        (sum.widths > sum.points / 2).then(|| S::from_ratio(i64::from(sum.widths_q8), i64::from(sum.widths) << 8))
    }

    /// Mean square of the measured widths in square pixels, less what noise adds to it, from their mean and its sigma.
    /// Within a knot the widths are averaged first.
    fn mean_square_width_px2<S: Scalar>(&self, mean_px: S, sigma_px: S) -> S {
        let (mut squares_q16, mut knots, mut widths) = (S::ZERO, 0, 0);
        for knot in self.settled_knots().filter(|knot| knot.widths > 0) {
            let (sum_q8, count) = (S::from_i64(knot.widths_q8.into()), S::from_i32(knot.widths.into()));
            squares_q16 = squares_q16 + sum_q8 * sum_q8 / count;
            (knots, widths) = (knots + 1, widths + i64::from(knot.widths));
        }
        let square_px2 = squares_q16 / S::from_i64(widths << 16);
        // The noise of a mean width is at most the stated one, whose half is meant, and that of a row at most half of
        // the width.
        let most_px2 = mean_px * mean_px / S::from_i64(4 * widths);
        square_px2 - (sigma_px * sigma_px).half().min(most_px2) * S::from_i32(knots)
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
    fn settled_knots(&self) -> impl Iterator<Item = &Knot> {
        self.knots.iter().skip(usize::from(self.knots.len() > 1))
    }

    fn settled(&self) -> Knot {
        let mut sum = Knot::EMPTY;
        self.settled_knots().for_each(|knot| sum.add(knot));
        sum
    }
}
