//! [`fit`]: the exact estimator, from samples of one edge to its bearing and inverse depth.
//!
//! An upright edge is the line `P0 + λ g` with `P0 = Z (a, 0, 1)`. A pixel seen at time t looks along `d = R(t) r` from
//! `p(t)`, and line and ray meet where `m · (P0 − p) = 0` with `m = d × g`. With the inverse depth ρ = 1/Z this is
//! *linear* in (a, ρ) for any motion, rotation and attitude:
//!
//! ```text
//! F = m · P = 0,   P = (a, 0, 1) − ρ p;     −F/m_x = δa + q δρ + w δβ,   q = −(m · p)/m_x
//! ```
//!
//! β, the lean of the edge in the image plane, is the third unknown, with a prior. Every round linearises about the last
//! estimate, so that the sums hold small residuals (single precision suffices) and the regressor q does not share the
//! noise of the observation (no bias in forward motion). The rounds are solved by orthogonalisation: inverting the
//! 3 × 3 normal matrix, whose condition is 10⁴ to 10⁶, would return nonsense in single precision.

use heapless::Vec;

use crate::common::Common;
use crate::estimate::Estimate;
use crate::sight::{LineInSpace, Sight};
use crate::solve::{Row, Solution, solve};
use crate::vector::{cross, dot};
use crate::{Camera, Motion, Sample, Scalar, Setup, Spread, Uncertainty};

/// Why there is no estimate: a property of the scene or of the call, with its number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum FitError {
    /// Fewer than two samples (three with a tilt to be estimated).
    TooFewSamples(usize),
    /// More samples than the solver's table holds.
    TooManySamples,
    /// A sample's column, row, time or sigma is not finite, sigma is not positive, or the lens maps nothing there.
    InvalidSample(usize),
    /// The edges run along the rows at this sample: the camera lies on its side, or the edges' vanishing point is in view.
    Sideways(usize),
}

impl core::fmt::Display for FitError {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooFewSamples(count) => write!(formatter, "{count} samples: at least 3 are needed (2 without tilt)"),
            Self::TooManySamples => write!(formatter, "more samples than the solver's table holds"),
            Self::InvalidSample(index) => {
                write!(
                    formatter,
                    "sample {index}: column, row and time must be finite, sigma above zero, the pixel in the image"
                )
            }
            Self::Sideways(index) => write!(formatter, "sample {index}: upright edges run along the rows there"),
        }
    }
}

impl core::error::Error for FitError {}

/// Bearing, inverse depth and tilt of one edge with their covariance, from at most `N` samples.
///
/// The uncertainty of the setup is part of the covariance; its limits and readout are not used.
///
/// *Errors*: see [`FitError`]. A motion that says nothing is no error: sigma is then [`Scalar::UNKNOWN`].
///
/// *Cost*: a pose and a ray per sample, then three rounds of about 100 operations per sample; 20 `N` numbers of stack.
///
/// *Source*: `m · (P0 − p(t)) = 0`; for a level camera in translation along x this is the paper's equation (3).
///
/// ```
/// use shutter_range::{Camera, Distortion, Intrinsics, Limits, Readout, Sample, Setup, Twist, Uncertainty, fit};
/// let camera = Camera::new(Intrinsics::centred(640, 480, 600.0_f64), Distortion::NONE)?;
/// let readout = Readout::from_frame_readout_ns(480, 33_300_000, Default::default())?;
/// let setup = Setup::new(camera, readout, Uncertainty::NONE, Limits::DEFAULT)?;
/// let motion = Twist::level([-2.0, 0.0, 0.0])?; // to the left, so the edge wanders to the right
/// let samples = [0.0, 0.01, 0.02, 0.03]
///     .map(|time_s| Sample::point(300.0 + 600.0 * 2.0 * time_s / 4.0, 0.0, time_s, 0.1));
/// let estimate = fit::<_, _, 8>(&setup, &motion, samples)?;
/// assert!((estimate.inverse_depth_per_m - 1.0 / 4.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
pub fn fit<S: Scalar, M: Motion<S>, const N: usize>(
    setup: &Setup<S>,
    motion: &M,
    samples: impl IntoIterator<Item = Sample<S>>,
) -> Result<Estimate<S>, FitError> {
    fit_line::<S, M, N>(setup, motion, samples).map(|(estimate, _)| estimate)
}

/// [`fit`], and the edge itself.
pub(crate) fn fit_line<S: Scalar, M: Motion<S>, const N: usize>(
    setup: &Setup<S>,
    motion: &M,
    samples: impl IntoIterator<Item = Sample<S>>,
) -> Result<(Estimate<S>, LineInSpace<S>), FitError> {
    let mut sights = sight_all::<S, M, N>(setup.camera(), motion, samples)?;
    let Uncertainty { sigma_tilt, sigma_gravity, .. } = *setup.uncertainty();
    let least = if sigma_tilt > S::ZERO || sigma_gravity > S::ZERO { 3 } else { 2 };
    if sights.len() < least {
        return Err(FitError::TooFewSamples(sights.len()));
    }
    let edge = LineInSpace::start(motion.gravity());
    // The linear problem is exact in the first round but for tilt, weights and noise in q; those settle in two more.
    let edge = round::<S, N>(&sights, &edge, setup.uncertainty(), Round::First)?.edge;
    let edge = round::<S, N>(&sights, &edge, setup.uncertainty(), Round::Later)?.edge;
    let mut solved = round::<S, N>(&sights, &edge, setup.uncertainty(), Round::Later)?;
    for _ in 0..MAX_CLEANINGS {
        let Some(doubtful) = doubt_strangers(&mut sights, &solved, setup.uncertainty())? else { break };
        if !drop_strangers(&mut sights, &doubtful) {
            break;
        }
        let edge = round::<S, N>(&sights, &solved.edge, setup.uncertainty(), Round::Later)?.edge;
        solved = round::<S, N>(&sights, &edge, setup.uncertainty(), Round::Later)?;
    }
    let Solved { edge, solution, rows } = solved;
    let common = Common::of(&sights, &edge, &rows, &solution, setup.uncertainty());
    Ok((solution.estimate(&edge, &rows, &sights, &common), edge))
}

fn sight_all<S: Scalar, M: Motion<S>, const N: usize>(
    camera: &Camera<S>,
    motion: &M,
    samples: impl IntoIterator<Item = Sample<S>>,
) -> Result<Vec<Sight<S>, N>, FitError> {
    let mut sights = Vec::new();
    for (index, sample) in samples.into_iter().enumerate() {
        let Spread { column_px, row_px, time_s } = sample.spread;
        let numbers = [sample.column_px, sample.row_px, sample.time_s, sample.sigma_px, column_px, row_px, time_s];
        if !(numbers.into_iter().all(S::is_finite) && sample.sigma_px > S::ZERO) {
            return Err(FitError::InvalidSample(index));
        }
        let sight = Sight::new(camera, motion, &sample).ok_or(FitError::InvalidSample(index))?;
        sights.push(sight).map_err(|_| FitError::TooManySamples)?;
    }
    Ok(sights)
}

#[derive(Clone, Copy, PartialEq)]
enum Round {
    /// Nothing is known yet: q is computed from the noisy observation itself.
    First,
    /// q is moved from the observed column to the predicted one.
    Later,
}

fn observe<S: Scalar>(sight: &Sight<S>, edge: &LineInSpace<S>, round: Round) -> Option<Row<S>> {
    let down = edge.direction();
    let m = cross(sight.direction, down);
    let dm = cross(sight.along_row, down);
    let [mx, _, _] = m;
    let [dmx, _, _] = dm;
    // A tenth of its size for a level camera: below, one pixel of column is worth ten.
    if !(mx.abs() > S::ratio(1, 10)) {
        return None;
    }
    let miss = edge.offset(m, sight) - edge.inverse_depth * sight.covariance;
    let per_px = edge.offset(dm, sight);
    let mut q = -(dot(m, sight.position) + sight.covariance) / mx;
    if round == Round::Later && per_px != S::ZERO {
        q = q + (dot(dm, sight.position) + q * dmx) / mx * (miss / per_px);
    }
    let w = edge.offset(cross(sight.direction, edge.lean), sight) / mx;
    Some(Row { q, w, y: -miss / mx, root_weight: (per_px / mx).abs() * sight.sigma_px * sight.doubt })
}

const MAX_CLEANINGS: usize = 4;
const DOUBTING_ROUNDS: usize = 8;
/// Beyond so many times the usual deviation a sample is of something else.
const STRANGE: i32 = 6;

/// What the samples say without those that would draw the fit towards themselves: least absolute deviations, by weights.
/// `None` where none deviates enough.
fn doubt_strangers<S: Scalar, const N: usize>(
    sights: &mut [Sight<S>],
    solved: &Solved<S, N>,
    uncertainty: &Uncertainty<S>,
) -> Result<Option<Solved<S, N>>, FitError> {
    let worst = deviations(sights, solved).reduce(S::max);
    if !worst.is_some_and(|worst| worst > S::from_i32(STRANGE)) {
        return Ok(None);
    }
    let mut solved = solved.clone();
    for _ in 0..DOUBTING_ROUNDS {
        for (sight, row) in sights.iter_mut().zip(&solved.rows) {
            let deviation = solved.solution.deviation(row).abs() * sight.doubt;
            sight.doubt = deviation.max(S::ONE).min(S::from_i32(10_000)).sqrt();
        }
        solved = round::<S, N>(sights, &solved.edge, uncertainty, Round::Later)?;
    }
    Ok(Some(solved))
}

/// How far off the samples are that are still in, in units of their own noise.
fn deviations<S: Scalar, const N: usize>(sights: &[Sight<S>], solved: &Solved<S, N>) -> impl Iterator<Item = S> {
    let kept = solved.rows.iter().zip(sights).filter(|(_, sight)| sight.kept);
    kept.map(|(row, sight)| solved.solution.deviation(row).abs() * sight.doubt)
}

/// Leaves out the samples that lie much farther off than the others do, such as those of an object in between: beyond
/// six times the usual deviation, which is that of two thirds of them and one sigma at least. A third of them at most:
/// if more do not fit, then this is no straight edge. Doubt ends here.
fn drop_strangers<S: Scalar, const N: usize>(sights: &mut [Sight<S>], solved: &Solved<S, N>) -> bool {
    let mut sizes: Vec<S, N> = Vec::new();
    // As many as sights.
    for size in deviations(sights, solved) {
        let _ = sizes.push(size);
    }
    let count = sizes.len();
    // What two thirds of normal values stay below, one sigma, without a sort.
    let below = |limit: S| sizes.iter().filter(|size| **size < limit).count();
    let usual = sizes.iter().copied().filter(|size| 3 * below(*size) <= 2 * count).reduce(S::max).unwrap_or(S::ONE);
    let limit = usual.max(S::ONE) * S::from_i32(STRANGE);
    let strangers = sizes.iter().filter(|size| **size > limit).count();
    let leave_out = strangers > 0 && 3 * (sights.len() - count + strangers) <= sights.len();
    for (sight, row) in sights.iter_mut().zip(&solved.rows) {
        let strange = solved.solution.deviation(row).abs() * sight.doubt > limit;
        sight.kept &= !(leave_out && strange);
        sight.doubt = S::ONE;
    }
    leave_out
}

#[derive(Clone)]
struct Solved<S, const N: usize> {
    edge: LineInSpace<S>,
    solution: Solution<S>,
    rows: Vec<Row<S>, N>,
}

fn round<S: Scalar, const N: usize>(
    sights: &[Sight<S>],
    edge: &LineInSpace<S>,
    uncertainty: &Uncertainty<S>,
    round: Round,
) -> Result<Solved<S, N>, FitError> {
    let mut rows: Vec<Row<S>, N> = Vec::new();
    for (index, sight) in sights.iter().enumerate() {
        let mut row = observe(sight, edge, round).ok_or(FitError::Sideways(index))?;
        if !sight.kept {
            row.root_weight = S::ZERO;
        }
        // As many rows as sights.
        let _ = rows.push(row);
    }
    let solution = solve(&mut rows, edge, uncertainty);
    Ok(Solved { edge: solution.apply(edge), solution, rows })
}
