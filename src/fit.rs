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

use crate::estimate::Estimate;
use crate::vector::{add, cross, dot, scale, sub};
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
    /// A sample's column, row, time or sigma is not finite, or sigma is not positive.
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
                write!(formatter, "sample {index}: column, row and time must be finite and sigma above zero")
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
    let sights = sight_all::<S, M, N>(setup.camera(), motion, samples)?;
    let least = if setup.uncertainty().sigma_tilt > S::ZERO { 3 } else { 2 };
    if sights.len() < least {
        return Err(FitError::TooFewSamples(sights.len()));
    }
    let edge = LineInSpace::start(motion.gravity());
    // The linear problem is exact in the first round but for tilt, weights and noise in q; those settle in two more.
    let edge = round::<S, N>(&sights, &edge, setup.uncertainty(), Round::First)?.0;
    let edge = round::<S, N>(&sights, &edge, setup.uncertainty(), Round::Later)?.0;
    let (edge, solution, rows) = round::<S, N>(&sights, &edge, setup.uncertainty(), Round::Later)?;
    let common = common_effects(&sights, &edge, &rows, &solution, setup.uncertainty());
    Ok((solution.estimate(&edge, &rows, &sights, &common), edge))
}

/// What one sample says, whatever the edge: a ray, where it starts, and how it moves along the row.
#[derive(Clone, Copy)]
pub(crate) struct Sight<S> {
    /// `R r`
    direction: [S; 3],
    /// `R (u, w, 0)`: what a relative change of focal length adds to the direction.
    off_axis: [S; 3],
    /// Change of the direction per pixel of column.
    along_row: [S; 3],
    position: [S; 3],
    /// By how much the mean of `m · p` over the sample's spread exceeds the `m · p` of the means.
    covariance: S,
    /// Rotation rate times time.
    turned: [S; 3],
    time_s: S,
    sigma_px: S,
}

impl<S: Scalar> Sight<S> {
    pub(crate) fn new<M: Motion<S>>(camera: &Camera<S>, motion: &M, sample: &Sample<S>) -> Self {
        let middle = Self::at(camera, motion, sample, S::ZERO);
        if sample.spread.row_px == S::ZERO {
            return middle;
        }
        // The mean over a stretch is, up to the third order, that of two points one standard deviation off its middle.
        let before = Self::at(camera, motion, sample, -S::ONE);
        let after = Self::at(camera, motion, sample, S::ONE);
        let half = S::ratio(1, 2);
        let mean = |a, b| scale(add(a, b), half);
        let half_change = |a, b| scale(sub(a, b), half);
        let m_change = cross(half_change(after.direction, before.direction), motion.gravity());
        Self {
            direction: mean(after.direction, before.direction),
            position: mean(after.position, before.position),
            covariance: dot(m_change, half_change(after.position, before.position)),
            ..middle
        }
    }

    /// The ray `spreads` standard deviations along the sample's stretch.
    fn at<M: Motion<S>>(camera: &Camera<S>, motion: &M, sample: &Sample<S>, spreads: S) -> Self {
        let spread = &sample.spread;
        let time_s = sample.time_s + spread.time_s * spreads;
        let ray = camera.ray(sample.column_px + spread.column_px * spreads, sample.row_px + spread.row_px * spreads);
        let pose = motion.pose(time_s);
        Self {
            direction: pose.turn([ray.u, ray.w, S::ONE]),
            off_axis: pose.turn([ray.u, ray.w, S::ZERO]),
            along_row: pose.turn([ray.du_dcolumn, ray.dw_dcolumn, S::ZERO]),
            position: pose.position_m,
            covariance: S::ZERO,
            turned: scale(pose.rate_rad_s, time_s),
            time_s,
            sigma_px: sample.sigma_px,
        }
    }
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
        sights.push(Sight::new(camera, motion, &sample)).map_err(|_| FitError::TooManySamples)?;
    }
    Ok(sights)
}

/// The unknowns `(a, ρ, β)` and the directions that they refer to.
#[derive(Clone, Copy)]
pub(crate) struct LineInSpace<S> {
    pub(crate) bearing: S,
    pub(crate) inverse_depth: S,
    pub(crate) tilt: S,
    pub(crate) gravity: [S; 3],
    /// Unit vector in the image plane, across gravity: `g + β e` is where a leaning edge points.
    lean: [S; 3],
}

impl<S: Scalar> LineInSpace<S> {
    fn start(gravity: [S; 3]) -> Self {
        let [gx, gy, _] = gravity;
        let length = (gx * gx + gy * gy).sqrt();
        // Looking straight down there is no such direction; every sample is refused as sideways then.
        let lean = if length > S::ZERO { [gy / length, -gx / length, S::ZERO] } else { [S::ONE, S::ZERO, S::ZERO] };
        Self { bearing: S::ZERO, inverse_depth: S::ZERO, tilt: S::ZERO, gravity, lean }
    }

    fn direction(&self) -> [S; 3] {
        add(self.gravity, scale(self.lean, self.tilt))
    }

    /// `m · P` with `P = (a, 0, 1) − ρ p`, added up so that what nearly cancels does so first: single precision then loses one rounding, not four.
    fn offset(&self, m: [S; 3], sight: &Sight<S>) -> S {
        let [mx, _, mz] = m;
        (mx * self.bearing + mz) - self.inverse_depth * dot(m, sight.position)
    }

    /// How far along the row, in pixels, a sight lies from the edge; `None` where rows run along the edge.
    pub(crate) fn miss_px(&self, sight: &Sight<S>) -> Option<S> {
        let miss = self.offset(cross(sight.direction, self.direction()), sight);
        let per_px = self.offset(cross(sight.along_row, self.direction()), sight);
        let pixels = miss / per_px;
        (per_px != S::ZERO && pixels.is_finite()).then_some(pixels)
    }
}

/// One linearised observation `y = δa + q δρ + w δβ` with its weight.
#[derive(Clone, Copy)]
struct Row<S> {
    q: S,
    w: S,
    y: S,
    /// One sigma of y, later that of the best row relative to it: a weight between 0 and 1, to be squared.
    root_weight: S,
}

impl<S: Scalar> Row<S> {
    fn weight(&self) -> S {
        self.root_weight * self.root_weight
    }
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
    Some(Row { q, w, y: -miss / mx, root_weight: (per_px / mx).abs() * sight.sigma_px })
}

/// What a round finds, in units that keep every number near one: y in sigmas of the best row, q in its own spread.
struct Solution<S> {
    /// One sigma of the best row.
    unit: S,
    /// Spread of q; zero where the motion says nothing.
    spread: S,
    mean_q: S,
    mean_w: S,
    weight: S,
    qq: S,
    /// ⟨q, w⟩/⟨q, q⟩
    c: S,
    /// ⟨w⊥, w⊥⟩ plus the prior; zero where tilt is not estimated.
    ww: S,
    /// In y: mean, along q and along w⊥.
    mean_y: S,
    rho: S,
    beta: S,
}

type Solved<S, const N: usize> = (LineInSpace<S>, Solution<S>, Vec<Row<S>, N>);

fn round<S: Scalar, const N: usize>(
    sights: &[Sight<S>],
    edge: &LineInSpace<S>,
    uncertainty: &Uncertainty<S>,
    round: Round,
) -> Result<Solved<S, N>, FitError> {
    let mut rows: Vec<Row<S>, N> = Vec::new();
    for (index, sight) in sights.iter().enumerate() {
        let row = observe(sight, edge, round).ok_or(FitError::Sideways(index))?;
        // As many rows as sights.
        let _ = rows.push(row);
    }
    let solution = solve(&mut rows, edge, uncertainty);
    let next = solution.apply(edge);
    Ok((next, solution, rows))
}

/// Weighted least squares by orthogonalisation: first q, then what w has beyond q.
fn solve<S: Scalar>(rows: &mut [Row<S>], edge: &LineInSpace<S>, uncertainty: &Uncertainty<S>) -> Solution<S> {
    let unit = normalise_weights(rows);
    let weight = sum(rows, |_| S::ONE);
    let mean_q = sum(rows, |row| row.q) / weight;
    let mean_w = sum(rows, |row| row.w) / weight;
    let mean_y = sum(rows, |row| row.y) / weight;
    let spread = rows.iter().fold(S::ZERO, |most, row| most.max((row.q - mean_q).abs()));
    for row in rows.iter_mut() {
        row.q = if spread > S::ZERO { (row.q - mean_q) / spread } else { S::ZERO };
        row.w = row.w - mean_w;
        row.y = row.y - mean_y;
    }
    let qq = sum(rows, |row| row.q * row.q);
    let over_qq = if qq > S::ZERO { S::ONE / qq } else { S::ZERO };
    let c = sum(rows, |row| row.q * row.w) * over_qq;
    let rho = sum(rows, |row| row.q * row.y) * over_qq;
    let mut solution =
        Solution { unit, spread, mean_q, mean_w, weight, qq, c, ww: S::ZERO, mean_y, rho, beta: S::ZERO };
    let sigma = prior_of_tilt(edge, uncertainty);
    if sigma > S::ZERO {
        let prior = unit / sigma * (unit / sigma);
        solution.ww = sum(rows, |row| solution.across(row) * solution.across(row)) + prior;
        let pull = sum(rows, |row| solution.across(row) * (row.y - rho * row.q)) - edge.tilt * prior;
        solution.beta = if solution.ww > S::ZERO { pull / solution.ww } else { S::ZERO };
    }
    solution
}

/// Turns each row's sigma into its weight relative to the best one, whose sigma is returned.
fn normalise_weights<S: Scalar>(rows: &mut [Row<S>]) -> S {
    let best = rows.iter().map(|row| row.root_weight).filter(|sigma| *sigma > S::ZERO).reduce(S::min);
    let unit = best.unwrap_or(S::EPSILON);
    for row in rows.iter_mut() {
        row.root_weight = if row.root_weight > unit { unit / row.root_weight } else { S::ONE };
    }
    unit
}

fn sum<S: Scalar>(rows: &[Row<S>], value: impl Fn(&Row<S>) -> S) -> S {
    rows.iter().fold(S::ZERO, |sum, row| sum + row.weight() * value(row))
}

/// Each edge's own lean, the camera's roll, and its pitch, which enters with the bearing.
fn prior_of_tilt<S: Scalar>(edge: &LineInSpace<S>, uncertainty: &Uncertainty<S>) -> S {
    let (lean, gravity) = (uncertainty.sigma_tilt, uncertainty.sigma_gravity);
    (lean * lean + gravity * gravity * (S::ONE + edge.bearing * edge.bearing)).sqrt()
}

impl<S: Scalar> Solution<S> {
    /// What w has beyond q: the part of tilt that does not look like depth.
    fn across(&self, row: &Row<S>) -> S {
        row.w - self.c * row.q
    }

    fn per_spread(&self) -> S {
        if self.spread > S::ZERO { S::ONE / self.spread } else { S::ZERO }
    }

    fn apply(&self, edge: &LineInSpace<S>) -> LineInSpace<S> {
        let delta = (self.rho - self.c * self.beta) * self.per_spread();
        LineInSpace {
            bearing: edge.bearing + self.mean_y - delta * self.mean_q - self.beta * self.mean_w,
            inverse_depth: edge.inverse_depth + delta,
            tilt: edge.tilt + self.beta,
            ..*edge
        }
    }

    fn residual(&self, row: &Row<S>) -> S {
        row.y - self.rho * row.q - self.beta * self.across(row)
    }

    /// How a small common error of `y` moves bearing and inverse depth.
    fn response(&self, rows: &[Row<S>], errors: impl Fn(usize) -> S) -> [S; 2] {
        let (mut mean, mut along, mut across) = (S::ZERO, S::ZERO, S::ZERO);
        for (index, row) in rows.iter().enumerate() {
            let error = row.weight() * errors(index);
            mean = mean + error;
            along = along + error * row.q;
            across = across + error * self.across(row);
        }
        if !(self.qq > S::ZERO && self.weight > S::ZERO) {
            return [S::ZERO; 2];
        }
        let beta = if self.ww > S::ZERO { across / self.ww } else { S::ZERO };
        let rho = (along / self.qq - self.c * beta) * self.per_spread();
        [mean / self.weight - rho * self.mean_q - beta * self.mean_w, rho]
    }

    fn estimate(&self, edge: &LineInSpace<S>, rows: &[Row<S>], sights: &[Sight<S>], common: &Common<S>) -> Estimate<S> {
        let across = cross([edge.bearing, S::ZERO, S::ONE], edge.gravity);
        let mut estimate = Estimate {
            bearing: edge.bearing,
            inverse_depth_per_m: edge.inverse_depth,
            tilt: edge.tilt,
            distance_per_depth: dot(across, across).sqrt(),
            ..Estimate::nothing()
        };
        self.fill_covariance(&mut estimate, common);
        self.judge_straightness(&mut estimate, rows, sights);
        estimate
    }

    /// Covariance of pixel noise and tilt's prior, then that of the common effects.
    fn fill_covariance(&self, estimate: &mut Estimate<S>, common: &Common<S>) {
        let beta = if self.ww > S::ZERO { S::ONE / self.ww } else { S::ZERO };
        estimate.sigma_tilt = self.unit * beta.sqrt();
        if !(self.qq > S::ZERO && self.spread > S::ZERO) {
            estimate.inverse_depth_per_m = S::ZERO;
            return;
        }
        let rho = S::ONE / self.qq + self.c * self.c * beta;
        let rho_beta = -self.c * beta;
        // Of a = mean y − q̄ ρ − w̄ β.
        let q = self.mean_q / self.spread;
        let w = self.mean_w;
        let bearing = S::ONE / self.weight + q * q * rho + w * w * beta + (q * w + q * w) * rho_beta;
        let bearing_rho = -q * rho - w * rho_beta;
        // Sigmas, not variances, leave the normalised units: fixed point has no room for their squares.
        let noise_rho = self.unit * rho.sqrt() / self.spread;
        let noise_bearing = self.unit * bearing.max(S::ZERO).sqrt();
        let noise_correlation = bearing_rho / (rho * bearing).sqrt().max(S::EPSILON);
        let sigma_rho = hypot(noise_rho, common.inverse_depth).min(S::UNKNOWN);
        let sigma_bearing = hypot(noise_bearing, common.bearing).min(S::UNKNOWN);
        let noise_part = noise_correlation * (noise_rho / sigma_rho) * (noise_bearing / sigma_bearing);
        let common_part = common.correlation * (common.inverse_depth / sigma_rho) * (common.bearing / sigma_bearing);
        let correlation = noise_part + common_part;
        estimate.correlation = if correlation.is_finite() { correlation.min(S::ONE).max(-S::ONE) } else { S::ZERO };
        estimate.sigma_inverse_depth_per_m = sigma_rho;
        estimate.sigma_bearing = sigma_bearing;
        estimate.sigma_common_per_m = common.inverse_depth;
    }

    /// Residuals against the stated noise: their size, and whether they follow each other, as those of a curve do.
    fn judge_straightness(&self, estimate: &mut Estimate<S>, rows: &[Row<S>], sights: &[Sight<S>]) {
        // Knots are means over curved arcs: what they may cost is no sign of a bend.
        let floor = S::ratio(1, 256);
        let (mut squares, mut steps, mut previous) = (S::ZERO, S::ZERO, None);
        for (row, sight) in rows.iter().zip(sights) {
            let sigma = sight.sigma_px / hypot(sight.sigma_px, floor);
            // Capped where fixed point would run out of room; a hundred sigma say no more than thirty.
            let cap = S::from_i32(1_000);
            let off = self.residual(row) / self.unit * row.root_weight * sigma;
            let off = off.min(cap).max(-cap);
            squares = squares + off * off;
            if let Some(previous) = previous {
                let step: S = off - previous;
                steps = steps + step * step;
            }
            previous = Some(off);
        }
        let unknowns = 2;
        let spare = rows.len().saturating_sub(unknowns);
        if spare == 0 {
            return;
        }
        let spare = S::from_i32(spare as i32);
        let variance = squares / spare;
        estimate.misfit = variance.sqrt();
        // Noise alone goes beyond four sigma of its own spread, sqrt(2/n), in no frame of a lifetime.
        let significant = S::ONE + S::from_i32(4) * (S::ratio(2, 1) / spare).sqrt();
        if variance > significant {
            // Durbin and Watson: 2 for noise, near 0 for a curve.
            let follows = steps < squares;
            estimate.bent = follows && variance > S::from_i32(4) || variance > S::from_i32(25);
            estimate.sigma_inverse_depth_per_m = (estimate.sigma_inverse_depth_per_m * estimate.misfit).min(S::UNKNOWN);
            estimate.sigma_bearing = (estimate.sigma_bearing * estimate.misfit).min(S::UNKNOWN);
        }
    }
}

fn hypot<S: Scalar>(a: S, b: S) -> S {
    let (large, small) = if a.abs() > b.abs() { (a.abs(), b.abs()) } else { (b.abs(), a.abs()) };
    if !(large > S::ZERO) {
        return S::ZERO;
    }
    let part = small / large;
    large * (S::ONE + part * part).sqrt()
}

/// One sigma each of what speed, rotation rate, readout and focal length do to all edges of a frame together.
struct Common<S> {
    bearing: S,
    inverse_depth: S,
    correlation: S,
}

fn common_effects<S: Scalar>(
    sights: &[Sight<S>],
    edge: &LineInSpace<S>,
    rows: &[Row<S>],
    solution: &Solution<S>,
    uncertainty: &Uncertainty<S>,
) -> Common<S> {
    let down = edge.direction();
    let zero = [S::ZERO; 3];
    // What a change of direction and of position does to y = −F/m_x.
    let effect = |sight: &Sight<S>, turn: [S; 3], shift: [S; 3]| {
        let m = cross(sight.direction, down);
        let [mx, _, _] = m;
        let change = edge.offset(cross(turn, down), sight) - edge.inverse_depth * dot(m, shift);
        -change / mx
    };
    let mut total = Common { bearing: S::ZERO, inverse_depth: S::ZERO, correlation: S::ZERO };
    let mut include = |sigma: S, change: &dyn Fn(&Sight<S>) -> ([S; 3], [S; 3])| {
        if !(sigma > S::ZERO) {
            return;
        }
        let [bearing, inverse_depth] = solution.response(rows, |index| {
            sights.get(index).map_or(S::ZERO, |sight| {
                let (turn, shift) = change(sight);
                effect(sight, turn, shift)
            })
        });
        total.accumulate(bearing * sigma, inverse_depth * sigma);
    };
    include(uncertainty.sigma_speed, &|sight| (zero, sight.position));
    for axis in [[S::ONE, S::ZERO, S::ZERO], [S::ZERO, S::ONE, S::ZERO], [S::ZERO, S::ZERO, S::ONE]] {
        include(uncertainty.sigma_rate_rad_s, &|sight| (cross(scale(axis, sight.time_s), sight.direction), zero));
    }
    include(uncertainty.sigma_readout, &|sight| (cross(sight.turned, sight.direction), sight.position));
    include(uncertainty.sigma_focal, &|sight| (sight.off_axis, zero));
    total
}

impl<S: Scalar> Common<S> {
    /// Adds one independent effect.
    fn accumulate(&mut self, bearing: S, inverse_depth: S) {
        let sigma_bearing = hypot(self.bearing, bearing);
        let sigma_inverse_depth = hypot(self.inverse_depth, inverse_depth);
        if sigma_bearing > S::ZERO && sigma_inverse_depth > S::ZERO {
            self.correlation =
                self.correlation * (self.bearing / sigma_bearing) * (self.inverse_depth / sigma_inverse_depth)
                    + (bearing / sigma_bearing) * (inverse_depth / sigma_inverse_depth);
        }
        self.bearing = sigma_bearing;
        self.inverse_depth = sigma_inverse_depth;
    }
}
