//! [`fit_scale`]: from passes at known distance and speed to the scale of the camera, and to its constant tilt.

use core::error::Error;
use core::fmt::{self, Display, Formatter};

use heapless::Vec;

use super::pass::Pass;
use super::tuning::{MOST_MISFIT, OUTLIER_SIGMAS, REWEIGHTING_ROUNDS};
use crate::range::{chance_limit, robust_scale_of};
use crate::scalar::{Scalar, hypot};

/// What passes say of the camera: slope = scale · speed/depth + tilt.
///
/// The scale is f · ℓ = κ · s, focal length in pixels times line time; where the passes state their readout times it is
/// κ = f/n.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Scale<S, const N: usize> {
    /// In pixels times seconds per row, or per row where readout times were stated.
    pub scale: S,
    /// One standard deviation.
    pub sigma_scale: S,
    /// Tilt that all passes share, the roll of the camera or of the edge, as a slope.
    pub tilt: S,
    /// One standard deviation; zero where it was not fitted.
    pub sigma_tilt: S,
    /// Correlation of the two.
    pub correlation: S,
    /// Root mean square of the deviations in units of what was stated; where it is larger than chance allows, the
    /// sigmas have been enlarged.
    pub misfit: S,
    /// Which passes are outliers, in their order.
    pub outliers: Vec<bool, N>,
}

impl<S: Scalar, const N: usize> Scale<S, N> {
    /// Line time in seconds, where the focal length is known; the relative sigmas add up as squares.
    #[must_use]
    pub fn line_time_s(&self, focal_px: S) -> S {
        self.scale / focal_px
    }

    /// Focal length in pixels, where the line time is known in seconds; with stated readout times give 1/n.
    #[must_use]
    pub fn focal_px(&self, line_time_s: S) -> S {
        self.scale / line_time_s
    }

    /// Relative standard deviation of the scale.
    #[must_use]
    pub fn relative_sigma(&self) -> S {
        self.sigma_scale / self.scale
    }

    /// How many passes it rests on.
    #[must_use]
    pub fn passes_used(&self) -> usize {
        self.outliers.iter().filter(|is_outlier| !**is_outlier).count()
    }
}

/// Why passes say nothing of the scale.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ScaleRefusal<S> {
    /// Fewer passes than unknowns and one more.
    TooFewPasses {
        /// How many there must be.
        needed: usize,
    },
    /// More passes than there is room for.
    TooManyPasses,
    /// The passes are so alike in speed over depth that a tilt explains them as well as the scale.
    Alike {
        /// Relative sigma of the scale.
        relative_sigma: S,
    },
    /// The edges slope against the stated motion.
    Reversed,
    /// No scale fits two thirds of the passes.
    Contradictory {
        /// Root mean square of the deviations in units of what was stated.
        misfit: S,
    },
}

impl<S> ScaleRefusal<S> {
    /// Its name in lower case, as the command line has it.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::TooFewPasses { .. } => "too_few_passes",
            Self::TooManyPasses => "too_many_passes",
            Self::Alike { .. } => "alike",
            Self::Reversed => "reversed",
            Self::Contradictory { .. } => "contradictory",
        }
    }
}

impl<S: Scalar> Display for ScaleRefusal<S> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFewPasses { needed } => write!(formatter, "too few passes: there must be at least {needed}"),
            Self::TooManyPasses => write!(formatter, "more passes than there is room for"),
            Self::Alike { relative_sigma } => write!(
                formatter,
                "the passes are too alike to tell the scale from a tilt (sigma {:.1} times the scale): pass in both directions, or \
                 at other speeds and distances",
                relative_sigma.to_f64()
            ),
            Self::Reversed => write!(formatter, "the edges slope against the stated motion: a sign is wrong"),
            Self::Contradictory { misfit } => write!(
                formatter,
                "the passes contradict each other: they are off by {:.0} times their sigmas; is a sign or a unit wrong?",
                misfit.to_f64()
            ),
        }
    }
}

impl<S: Scalar> Error for ScaleRefusal<S> {}

/// Beyond this relative sigma passes tell nothing of the scale.
const MOST_RELATIVE_SIGMA: (i32, i32) = (1, 2);

/// The scale from at most `N` passes.
///
/// `sigma_tilt` says what is known of a tilt that all passes share, such as the roll of the camera, one standard
/// deviation as a slope: `None` fits it freely, zero takes it to be none.
///
/// *Errors*: [`ScaleRefusal`] says why there is no scale.
///
/// *Cost*: some twenty rounds of a dozen operations for each pass.
///
/// *Source*: eqs. (3), (10) and (13) of the paper, solved for κ s; docs/model.md, section 11.2.
///
/// ```
/// use shutter_range::calibrate::{Pass, fit_scale};
/// // Passed at 5, 7, 10 and 15 m and 11 m/s, to the left and to the right, in 1/50 s, by a camera that rolls by 0.5°.
/// let passes = [5.0, -7.0, 10.0, -15.0].map(|depth_m: f64| {
///     let slope = 2.36 * 0.02 * 11.0 / depth_m + 0.0087;
///     Pass::new(slope, 11.0 * depth_m.signum(), depth_m.abs()).expect("a pass")
/// });
/// let found = fit_scale::<f64, 8>(&passes, None)?;
/// assert!((found.scale / 0.02 - 2.36).abs() < 1e-9 && (found.tilt - 0.0087).abs() < 1e-9);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
pub fn fit_scale<S: Scalar, const N: usize>(
    passes: &[Pass<S>],
    sigma_tilt: Option<S>,
) -> Result<Scale<S, N>, ScaleRefusal<S>> {
    let needed = if sigma_tilt == Some(S::ZERO) { 2 } else { 3 };
    if passes.len() < needed {
        return Err(ScaleRefusal::TooFewPasses { needed });
    }
    let mut problem = Problem::<S, N> { passes, sigma_tilt, terms: Vec::new() };
    for pass in passes {
        let term = Term { is_outlier: false, robust_scale: S::ONE, sigma: pass.sigma(S::ZERO) };
        problem.terms.push(term).map_err(|_| ScaleRefusal::TooManyPasses)?;
    }
    let line = problem.without_outliers();
    problem.judge(&line)
}

/// What the fit knows of a pass beside what the pass says.
struct Term<S> {
    is_outlier: bool,
    /// Factor on its sigma while the fit is reweighted; one otherwise.
    robust_scale: S,
    sigma: S,
}

struct Problem<'a, S, const N: usize> {
    passes: &'a [Pass<S>],
    sigma_tilt: Option<S>,
    terms: Vec<Term<S>, N>,
}

/// A straight line through slopes over what they are for a scale of one.
struct Line<S> {
    scale: S,
    tilt: S,
    sigma_scale: S,
    sigma_tilt: S,
    correlation: S,
}

impl<S: Scalar, const N: usize> Problem<'_, S, N> {
    /// Passes with their terms, but the outliers.
    fn kept(&self) -> impl Iterator<Item = (&Pass<S>, &Term<S>)> {
        self.passes.iter().zip(&self.terms).filter(|(_, term)| !term.is_outlier)
    }

    /// Least squares about the means, by which nearly equal numbers are subtracted but once.
    fn solve(&self) -> Line<S> {
        let weight = |term: &Term<S>| {
            let root = S::ONE / (term.sigma * term.robust_scale);
            root * root
        };
        let (mut w, mut wx, mut wy) = match self.sigma_tilt {
            None => (S::ZERO, S::ZERO, S::ZERO),
            // As a pass without motion, whose slope is the tilt.
            Some(sigma) if sigma > S::ZERO => (S::ONE / (sigma * sigma), S::ZERO, S::ZERO),
            Some(_) => (S::ZERO, S::ZERO, S::ZERO),
        };
        let of_prior = w;
        for (pass, term) in self.kept() {
            let own = weight(term);
            (w, wx, wy) = (w + own, wx + own * pass.per_scale, wy + own * pass.slope);
        }
        let has_tilt = self.sigma_tilt != Some(S::ZERO);
        let (x, y) = if has_tilt { (wx / w, wy / w) } else { (S::ZERO, S::ZERO) };
        let (mut xx, mut xy) = (of_prior * x * x, of_prior * x * y);
        for (pass, term) in self.kept() {
            let (own, off) = (weight(term), pass.per_scale - x);
            (xx, xy) = (xx + own * off * off, xy + own * off * (pass.slope - y));
        }
        let scale = xy / xx;
        let sigma_scale = S::ONE / xx.sqrt();
        let sigma_tilt = if has_tilt { hypot(S::ONE / w.sqrt(), x * sigma_scale) } else { S::ZERO };
        let correlation = if has_tilt { -x * sigma_scale / sigma_tilt } else { S::ZERO };
        Line { scale, tilt: y - scale * x, sigma_scale, sigma_tilt, correlation }
    }

    /// Deviation of each pass in units of its own sigma.
    fn deviations(&self, line: &Line<S>) -> Vec<S, N> {
        let mut deviations = Vec::new();
        for (pass, term) in self.passes.iter().zip(&self.terms) {
            let off = pass.slope - line.scale * pass.per_scale - line.tilt;
            // There is room: as many as terms.
            let _ = deviations.push((off / term.sigma).abs());
        }
        deviations
    }

    /// The line once more with the sigmas that its scale gives the passes.
    fn settled(&mut self) -> Line<S> {
        let mut line = self.solve();
        for _ in 0..3 {
            for (pass, term) in self.passes.iter().zip(&mut self.terms) {
                term.sigma = pass.sigma(line.scale);
            }
            line = self.solve();
        }
        line
    }

    fn without_outliers(&mut self) -> Line<S> {
        let mut line = self.settled();
        for _ in 0..REWEIGHTING_ROUNDS {
            let deviations = self.deviations(&line);
            for (term, deviation) in self.terms.iter_mut().zip(&deviations) {
                term.robust_scale = deviation.max(S::ratio(1, 4)).min(S::from_i32(10_000)).sqrt();
            }
            line = self.solve();
        }
        let deviations = self.deviations(&line);
        let count = self.terms.len();
        let few = S::ratio(16, i32::try_from(count).unwrap_or(i32::MAX).max(1));
        let limit = robust_scale_of(&deviations) * (S::from_i32(OUTLIER_SIGMAS) + few);
        let outliers = deviations.iter().filter(|deviation| **deviation > limit).count();
        for (term, deviation) in self.terms.iter_mut().zip(&deviations) {
            term.robust_scale = S::ONE;
            // If more do not fit, it is not they that are wrong.
            term.is_outlier = 3 * outliers <= count && *deviation > limit;
        }
        self.settled()
    }

    fn judge(&self, line: &Line<S>) -> Result<Scale<S, N>, ScaleRefusal<S>> {
        if !line.sigma_scale.is_finite() {
            return Err(ScaleRefusal::Alike { relative_sigma: S::UNKNOWN });
        }
        let deviations = self.deviations(line);
        let kept = deviations.iter().zip(&self.terms).filter(|(_, term)| !term.is_outlier);
        let squares = kept.fold(S::ZERO, |sum, (deviation, _)| sum + *deviation * *deviation);
        let unknowns = if self.sigma_tilt.is_none() { 2 } else { 1 };
        let spare = i32::try_from(self.kept().count()).unwrap_or(i32::MAX) - unknowns;
        let spare = S::from_i32(spare.max(1));
        let variance = squares / spare;
        let misfit = variance.sqrt();
        if !(misfit <= S::from_i32(MOST_MISFIT)) {
            return Err(ScaleRefusal::Contradictory { misfit });
        }
        let inflation = if variance > chance_limit(spare, S::from_i32(2)) { misfit.max(S::ONE) } else { S::ONE };
        let sigma_scale = line.sigma_scale * inflation;
        let relative_sigma = sigma_scale / line.scale.abs();
        if !(relative_sigma <= S::ratio(MOST_RELATIVE_SIGMA.0, MOST_RELATIVE_SIGMA.1)) {
            return Err(ScaleRefusal::Alike { relative_sigma });
        }
        if line.scale < S::ZERO {
            return Err(ScaleRefusal::Reversed);
        }
        let mut outliers = Vec::new();
        for term in &self.terms {
            let _ = outliers.push(term.is_outlier);
        }
        Ok(Scale {
            scale: line.scale,
            sigma_scale,
            tilt: line.tilt,
            sigma_tilt: line.sigma_tilt * inflation,
            correlation: line.correlation,
            misfit,
            outliers,
        })
    }
}
