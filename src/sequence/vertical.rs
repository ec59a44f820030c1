//! [`Vertical`]: which way is down, learned from what all upright edges have in common. docs/model.md, section 8.8.

use heapless::Vec;

use super::tuning::{
    AGREE_MILLIRADIANS, DRIFT_MILLIRADIANS_PER_S, LEAST_EDGES, LEAST_SIGMA_E4, LEVEL_CENTIRADIANS, LONGEST,
    MOST_TILTED_PERCENT, ROUNDS, USUAL_DECI_PER_M,
};
use crate::line::Line;
use crate::motion::{Motion, Pose};
use crate::range::{Line3, Range, SampleSet};
use crate::scalar::{Scalar, add, cross, dot, hypot, scale};
use crate::setup::Setup;

/// The direction of down in the camera's axes, learned from edges.
///
/// Planes through the camera and an upright edge all contain the vertical. In one frame the lines that agree best on a
/// vertical tell it to a degree or so, but for what the motion adds to their slopes; parallax then tells the lean of
/// each edge apart from its distance, and what these leans have in common is the error of the vertical.
///
/// Take [`gravity`](Self::gravity) for the motion of the next frame, and [`sigma_rad`](Self::sigma_rad) for
/// [`Uncertainty::sigma_gravity`](crate::Uncertainty::sigma_gravity).
///
/// ```
/// use shutter_range::Vertical;
/// let vertical = Vertical::<f32>::level();
/// assert_eq!(vertical.gravity(), [0.0, 1.0, 0.0]);
/// assert!(vertical.sigma_rad() > 0.1 && !vertical.is_told());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Vertical<S> {
    gravity: [S; 3],
    sigma_rad: S,
    is_told: bool,
}

/// The plane through the camera and an edge.
#[derive(Clone, Copy)]
pub(super) struct EdgePlane<S> {
    /// Of unit length.
    normal: [S; 3],
    /// One sigma of the angle from the plane to the vertical.
    sigma: S,
    /// How much of the edge is seen, in any unit: short ones are upright more by chance than by purpose.
    length: S,
}

impl<S: Scalar> Vertical<S> {
    /// A level camera, within 15°.
    #[must_use]
    pub fn level() -> Self {
        let gravity = [S::ZERO, S::ONE, S::ZERO];
        Self { gravity, sigma_rad: S::ratio(LEVEL_CENTIRADIANS, 100), is_told: false }
    }

    /// Unit vector towards the ground in the camera's axes.
    #[must_use]
    pub const fn gravity(&self) -> [S; 3] {
        self.gravity
    }

    /// One standard deviation of roll, and of pitch, in radians.
    #[must_use]
    pub const fn sigma_rad(&self) -> S {
        self.sigma_rad
    }

    /// Whether edges have told it; otherwise it is what was assumed.
    #[must_use]
    pub const fn is_told(&self) -> bool {
        self.is_told
    }

    /// Takes the vertical on which most of the lines of a frame agree; at least five have to, else nothing changes and
    /// the answer is false. For the first frame, when nothing better is known.
    ///
    /// *Cost*: a ray for each line, and 50 000 scalar products.
    pub fn begin<'l, M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        lines: impl Iterator<Item = &'l Line<KNOTS>>,
    ) -> bool {
        let mut longest: Vec<(u16, EdgePlane<S>), LONGEST> = Vec::new();
        for line in lines {
            let Some(plane) = EdgePlane::of_line(setup, motion, line) else { continue };
            let at = longest.partition_point(|(points, _)| *points >= line.points());
            if longest.is_full() && at < LONGEST {
                longest.pop();
            }
            // No room: it is shorter than all others.
            let _ = longest.insert(at, (line.points(), plane));
        }
        let Some(vertical) = most_agreed(&longest) else { return false };
        let planes = || longest.iter().map(|(_, plane)| *plane);
        let fitted = Self { gravity: vertical, ..*self }.fitted(planes);
        let Some(fitted) = fitted else { return false };
        // What motion adds to the slopes is known no better than the depths.
        let skew = longest.iter().map(|(_, plane)| plane.sigma).fold(S::ZERO, S::max);
        *self = Self { sigma_rad: hypot(fitted.sigma_rad, skew), ..fitted };
        true
    }

    /// From the lines of a single frame: where their blur tells their leans apart from their distances. `None` where
    /// fewer than five lines tell, or where they tell it no better than to a degree.
    ///
    /// *Cost*: a fit for each line.
    #[must_use]
    pub fn fit<M: Motion<S>, const KNOTS: usize>(setup: &Setup<S>, motion: &M, lines: &[Line<KNOTS>]) -> Option<Self> {
        let mut planes: Vec<EdgePlane<S>, LONGEST> = Vec::new();
        let prior = setup.uncertainty().sigma_tilt_at(S::ZERO, motion.gravity());
        for line in lines {
            let mut state = None;
            let _ = Range::continued(setup, motion, line, None, SampleSet::default(), &mut state);
            let Some(state) = state else { continue };
            let [_, _, sigma] = state.covariance.sigma();
            if sigma + sigma < prior {
                // No room: enough are there.
                let (lean, length) = (setup.uncertainty().sigma_tilt, S::from_i32(i32::from(line.points())));
                let _ = planes.push(EdgePlane::of_edge(&state.line3, hypot(sigma, lean), length));
            }
        }
        let start = Self { gravity: motion.gravity(), sigma_rad: setup.uncertainty().sigma_gravity, is_told: false };
        let degree = S::ratio(1745, 100_000);
        start.fitted(|| planes.iter().copied()).filter(|fitted| fitted.sigma_rad < degree)
    }

    /// The same at the start of the next frame: the camera has turned, and what was known may no longer hold.
    pub fn advance(&mut self, pose: &Pose<S>, elapsed_s: S) {
        let [x, y, z] = pose.rotation;
        let [gx, gy, gz] = self.gravity;
        self.gravity = unit(add(add(scale(x, gx), scale(y, gy)), scale(z, gz))).unwrap_or(self.gravity);
        let drift = S::ratio(DRIFT_MILLIRADIANS_PER_S, 1000) * elapsed_s.abs();
        self.sigma_rad = hypot(self.sigma_rad, drift).min(S::ratio(LEVEL_CENTIRADIANS, 100));
    }

    /// Takes what the planes of edges tell, if they tell it better than it was known.
    pub(super) fn learn<I: Iterator<Item = EdgePlane<S>>>(&mut self, planes: impl Fn() -> I) {
        if let Some(fitted) = self.fitted(planes).filter(|fitted| fitted.sigma_rad <= self.sigma_rad) {
            *self = fitted;
        }
    }

    /// Roll and pitch by reweighted least squares, in which what does not agree loses its weight. `None` where fewer
    /// than five edges agree, or all have the same bearing.
    fn fitted<I: Iterator<Item = EdgePlane<S>>>(&self, planes: impl Fn() -> I) -> Option<Self> {
        let mut gravity = self.gravity;
        let mut sigma = S::UNKNOWN;
        // The longest counts once.
        let longest = planes().map(|plane| plane.length).fold(S::ZERO, S::max);
        for _ in 0..ROUNDS {
            let axes = Axes::of(gravity);
            let sums = planes().fold(Sums::new(), |sums, plane| sums.and(&axes, &plane, plane.length / longest));
            let (roll, pitch, sigma_rad) = sums.solve()?;
            gravity = unit(add(gravity, add(scale(axes.roll, roll), scale(axes.pitch, pitch))))?;
            sigma = sigma_rad;
        }
        let most = S::ratio(LEVEL_CENTIRADIANS, 100) * S::from_i32(2);
        let [_, down, _] = gravity;
        let agree = planes().filter(|plane| plane.deviation(gravity).abs() < S::from_i32(3)).count();
        let is_told =
            agree >= LEAST_EDGES && sigma < most && down * S::from_i32(100) > S::from_i32(MOST_TILTED_PERCENT);
        is_told.then_some(Self { gravity, sigma_rad: sigma.max(S::ratio(LEAST_SIGMA_E4, 10_000)), is_told })
    }
}

impl<S: Scalar> EdgePlane<S> {
    /// Of an edge whose lean is measured.
    pub(super) fn of_edge(line3: &Line3<S>, sigma: S, length: S) -> Self {
        let normal = cross([line3.bearing, S::ZERO, S::ONE], line3.direction());
        Self { normal: unit(normal).unwrap_or(normal), sigma, length }
    }

    /// Of a line at the usual depth. Its sigma is that of the depth: of the angle by which motion shears the edge.
    fn of_line<M: Motion<S>, const KNOTS: usize>(setup: &Setup<S>, motion: &M, line: &Line<KNOTS>) -> Option<Self> {
        let samples = || line.samples::<S>();
        let [first, last] = [samples().next()?, samples().last()?].map(|sample| {
            let (ray, pose) = (setup.camera().ray(sample.column_px, sample.row_px)?, motion.pose(sample.time_s));
            Some((pose.rotate([ray.u, ray.w, S::ONE]), pose.position_m))
        });
        let (first, last) = (first?, last?);
        let seen_from_start = |(direction, position), inverse_depth| add(direction, scale(position, inverse_depth));
        let normal_at =
            |inverse_depth| unit(cross(seen_from_start(first, inverse_depth), seen_from_start(last, inverse_depth)));
        let usual = S::ratio(USUAL_DECI_PER_M, 10);
        let (normal, nearer) = (normal_at(usual)?, normal_at(usual + usual)?);
        let shear = cross(normal, nearer);
        let sigma = dot(shear, shear).sqrt().max(S::ratio(AGREE_MILLIRADIANS, 1000));
        let [x, _, _] = normal;
        // Upright rather than level.
        (x.abs() > S::ratio(9, 10)).then_some(Self { normal, sigma, length: S::from_i32(i32::from(line.points())) })
    }

    /// How far a vertical is from this plane, in sigmas.
    fn deviation(&self, vertical: [S; 3]) -> S {
        dot(self.normal, vertical) / self.sigma
    }
}

/// The vertical through the planes of two lines on which most others agree.
fn most_agreed<S: Scalar>(longest: &[(u16, EdgePlane<S>)]) -> Option<[S; 3]> {
    let near = S::ratio(AGREE_MILLIRADIANS, 1000);
    let mut best = (0_u32, None);
    for (index, (_, one)) in longest.iter().enumerate() {
        for (_, other) in longest.iter().skip(index + 1) {
            let normal = cross(one.normal, other.normal);
            let Some(vertical) = unit(normal) else { continue };
            let [_, y, _] = vertical;
            // Two nearly equal planes tell no direction.
            let is_far_apart = dot(normal, normal).sqrt() > S::ratio(1, 20);
            if !is_far_apart || y.abs() * S::from_i32(100) < S::from_i32(MOST_TILTED_PERCENT) {
                continue;
            }
            let agreed = longest.iter().filter(|(_, plane)| dot(plane.normal, vertical).abs() < near);
            let points = agreed.map(|(points, _)| u32::from(*points)).sum();
            if points > best.0 {
                best = (points, Some(if y > S::ZERO { vertical } else { scale(vertical, -S::ONE) }));
            }
        }
    }
    best.1
}

/// Two directions perpendicular to a vertical: to the right in the image, and across.
struct Axes<S> {
    vertical: [S; 3],
    roll: [S; 3],
    pitch: [S; 3],
}

impl<S: Scalar> Axes<S> {
    fn of(vertical: [S; 3]) -> Self {
        let roll = Line3::start(vertical).lean;
        Self { vertical, roll, pitch: cross(vertical, roll) }
    }
}

/// Sums of least squares for roll and pitch, in units of a hundredth of a radian.
struct Sums<S> {
    rr: S,
    rp: S,
    pp: S,
    ry: S,
    py: S,
    /// Weighted squares of the deviations, and their weights.
    squares: S,
    weight: S,
}

impl<S: Scalar> Sums<S> {
    fn new() -> Self {
        let none = S::ZERO;
        Self { rr: none, rp: none, pp: none, ry: none, py: none, squares: none, weight: none }
    }

    fn and(self, axes: &Axes<S>, plane: &EdgePlane<S>, part: S) -> Self {
        let per_sigma = S::ratio(1, 100) / plane.sigma;
        let r = dot(plane.normal, axes.roll) * per_sigma;
        let p = dot(plane.normal, axes.pitch) * per_sigma;
        let y = -plane.deviation(axes.vertical);
        // Cauchy's weight: beyond some sigmas an edge loses its say.
        let square = y * y * S::ratio(1, 4);
        let weight = part / ((S::ONE + square) * (S::ONE + square));
        Self {
            rr: self.rr + weight * r * r,
            rp: self.rp + weight * r * p,
            pp: self.pp + weight * p * p,
            ry: self.ry + weight * r * y,
            py: self.py + weight * p * y,
            squares: self.squares + weight * y * y,
            weight: self.weight + weight,
        }
    }

    /// Roll, pitch, and one sigma of the less certain of the two, in radians.
    fn solve(&self) -> Option<(S, S, S)> {
        let spare = self.pp - self.rp * (self.rp / self.rr);
        if !(self.rr > S::ZERO && spare > S::ZERO) {
            return None;
        }
        let pitch = (self.py - self.rp * (self.ry / self.rr)) / spare;
        let roll = (self.ry - self.rp * pitch) / self.rr;
        let of_pitch = S::ONE / spare.sqrt();
        let of_roll = hypot(S::ONE / self.rr.sqrt(), self.rp / self.rr * of_pitch);
        let spread = (self.squares / self.weight).sqrt().max(S::ONE);
        let unit = S::ratio(1, 100);
        let found = (roll * unit, pitch * unit, of_pitch.max(of_roll) * spread * unit);
        (found.0.is_finite() && found.1.is_finite() && found.2.is_finite()).then_some(found)
    }
}

fn unit<S: Scalar>(vector: [S; 3]) -> Option<[S; 3]> {
    let length = dot(vector, vector).sqrt();
    (length > S::ratio(1, 1000)).then(|| scale(vector, S::ONE / length))
}
