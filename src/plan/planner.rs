//! [`Planner`]: what a camera mode on a moving platform will measure of a target.

use super::camera_mode::{CameraMode, EdgeLook};
use super::prediction::{Obstacle, Prediction};
use super::target::Target;
use super::tuning::{DEPTH_STEP, DEPTH_STEPS, HALVINGS, LEAST_SHOWN, LOST_ROWS, NEAREST_M};
use crate::edge::EdgePoint;
use crate::error::ParameterError;
use crate::line::Line;
use crate::motion::{Motion, Twist};
use crate::range::{Line3, Observer, Range, RangeStatus, RowPlane, Sample, column_at};
use crate::scalar::{NS_PER_S, Scalar, dot, scale};

/// As many knots as a board's ranger has.
const KNOTS: usize = 16;

/// Predicts what a camera mode will measure of a target while it moves.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Planner<'a, S> {
    mode: &'a CameraMode<S>,
    motion: &'a Twist<S>,
    target: Target<S>,
}

/// Between which depths a target's distance is known well enough.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Reach<S> {
    /// The smallest depth in metres.
    pub nearest_m: S,
    /// The largest depth in metres, 10 km at most.
    pub farthest_m: S,
    /// What is wrong just below the smallest depth; `None` where it is known too badly.
    pub nearest_because: Option<Obstacle>,
}

/// A target's edge in the image.
struct Drawn<S> {
    line: Line<KNOTS>,
    /// Rows of the target, in the image or beside it.
    covered: u32,
    shown: u32,
    look: EdgeLook<S>,
    path_px: S,
}

impl<'a, S: Scalar> Planner<'a, S> {
    /// *Errors*: a field of the target outside its limits.
    pub fn new(mode: &'a CameraMode<S>, motion: &'a Twist<S>, target: Target<S>) -> Result<Self, ParameterError> {
        target.check()?;
        Ok(Self { mode, motion, target })
    }

    /// What will be measured at a depth.
    ///
    /// *Errors*: a depth that is not 0.001 to 10⁵ m.
    ///
    /// *Cost*: a few rays and poses for each row of the image, and one fit.
    pub fn predict(&self, depth_m: S) -> Result<Prediction<S>, ParameterError> {
        if !(depth_m >= S::ratio(1, 1000) && depth_m <= S::from_i32(100_000)) {
            return Err(ParameterError::new("depth_m", depth_m.to_f64(), "0.001 to 100000 (m)"));
        }
        Ok(self.at(depth_m))
    }

    /// Between which depths the distance is known to a relative sigma, around the depth where it is known best; `None`
    /// where there is no such depth.
    ///
    /// *Cost*: some 150 predictions.
    #[must_use]
    pub fn reach(&self, relative_sigma: S) -> Option<Reach<S>> {
        let depths = || {
            let step = S::ratio(DEPTH_STEP.0, DEPTH_STEP.1);
            let first = S::ratio(NEAREST_M.0, NEAREST_M.1);
            core::iter::successors(Some(first), move |depth_m| Some(*depth_m * step)).take(DEPTH_STEPS as usize)
        };
        let is_good = |depth_m: S| self.at(depth_m).is_good(relative_sigma);
        let nearest = depths().find(|depth_m| is_good(*depth_m))?;
        let beyond = depths().find(|depth_m| *depth_m > nearest && !is_good(*depth_m));
        let step = S::ratio(DEPTH_STEP.0, DEPTH_STEP.1);
        let (below_m, nearest_m) = border(nearest / step, nearest, is_good);
        let farthest_m = beyond.map_or(S::from_i32(10_000), |bad| border(bad, bad / step, is_good).1);
        Some(Reach { nearest_m, farthest_m, nearest_because: self.at(below_m).obstacle })
    }

    /// The lowest speed in m/s, in the direction of the motion, at which the distance at a depth is known to a relative
    /// sigma; `None` where the motion's own speed does not suffice, or where it is zero.
    ///
    /// *Cost*: some twenty predictions.
    #[must_use]
    pub fn slowest_m_s(&self, depth_m: S, relative_sigma: S) -> Option<S> {
        let speed_m_s = dot(self.motion.velocity_m_s(), self.motion.velocity_m_s()).sqrt();
        let is_good = |part: S| {
            self.slowed(part).is_some_and(|motion| {
                let slowed = Planner { motion: &motion, ..*self };
                slowed.predict(depth_m).is_ok_and(|prediction| prediction.is_good(relative_sigma))
            })
        };
        if !(speed_m_s > S::ZERO && is_good(S::ONE)) {
            return None;
        }
        // Halved until it is too slow, then between the two.
        let half = S::ratio(1, 2);
        let mut slow = half;
        for _ in 0..HALVINGS {
            if !is_good(slow) {
                return Some(border(slow, slow + slow, is_good).1 * speed_m_s);
            }
            slow = slow * half;
        }
        Some((slow + slow) * speed_m_s)
    }

    fn slowed(&self, part: S) -> Option<Twist<S>> {
        Twist::new(scale(self.motion.velocity_m_s(), part), self.motion.rate_rad_s(), self.motion.gravity()).ok()
    }

    fn at(&self, depth_m: S) -> Prediction<S> {
        let setup = self.mode.setup();
        let line3 = Line3 {
            bearing: self.target.bearing,
            inverse_depth: S::ONE / depth_m,
            ..Line3::start(self.motion.gravity())
        };
        let drawn = self.draw(&line3, depth_m);
        let Some(Drawn { line, covered, shown, look, path_px }) = drawn else {
            return self.nothing();
        };
        let range = Range::predicted(setup, self.motion, &line);
        let skew_px = line.last().column_px::<S>() - line.first().column_px();
        let rows = S::from_i32(i32::from(line.last().row.abs_diff(line.first().row)).max(1));
        let most_slope = S::from_ratio(setup.limits().max_slope_q16.into(), 1 << 16);
        let obstacle = if shown * LEAST_SHOWN.1 < covered * LEAST_SHOWN.0 {
            Some(Obstacle::LeavesImage)
        } else if !look.is_seen {
            Some(Obstacle::Unseen)
        } else if skew_px.abs() > most_slope * rows {
            Some(Obstacle::Steep)
        } else if range.status != RangeStatus::Ok {
            Some(Obstacle::Status(range.status))
        } else {
            None
        };
        Prediction { range, path_px, skew_px, sigma_column_px: look.sigma_px, obstacle }
    }

    /// Of an edge that no row shows.
    fn nothing(&self) -> Prediction<S> {
        let line = Line::<KNOTS>::new(EdgePoint::new(0, 0, 0));
        Prediction {
            range: Range::from_line(self.mode.setup(), self.motion, &line),
            path_px: S::ZERO,
            skew_px: S::ZERO,
            sigma_column_px: S::UNKNOWN,
            obstacle: Some(Obstacle::LeavesImage),
        }
    }

    /// The edge as the rows show it, one after the other; `None` where none does.
    fn draw(&self, line3: &Line3<S>, depth_m: S) -> Option<Drawn<S>> {
        let setup = self.mode.setup();
        let readout = setup.readout();
        let (mut covered, mut shown) = (0_u32, 0_u32);
        let mut last = self.first_guess(line3);
        let (mut line, mut look, mut path_px) = (None::<Line<KNOTS>>, None, S::ZERO);
        for before in 0..readout.rows() {
            let row = readout.row_after(before);
            let point = self.point(line3, row, &last);
            if !self.covers(line3, &point, depth_m) {
                continue;
            }
            covered += 1;
            last = point;
            if !setup.camera().contains(point.column_q16, row) {
                continue;
            }
            shown += 1;
            if shown <= u32::from(LOST_ROWS) {
                continue;
            }
            // Blur and noise are alike in all rows, as long as the edge keeps its depth.
            let look = look.get_or_insert_with(|| {
                path_px = self.path_px(line3, &point);
                let object_px = setup.camera().intrinsics().fx * self.target.width_m / depth_m;
                self.mode.look(&self.target, path_px, object_px)
            });
            let point = with_look(point, look);
            match &mut line {
                // Rows come in their order.
                Some(line) => drop(line.push(point)),
                None => line = Some(Line::new(point)),
            }
        }
        Some(Drawn { line: line?, covered, shown, look: look?, path_px })
    }

    /// In the middle of the image at frame start.
    fn first_guess(&self, line3: &Line3<S>) -> EdgePoint {
        let camera = self.mode.setup().camera();
        let (column_px, _) = camera.pixel(line3.bearing, S::ZERO);
        EdgePoint::new(0, q16(column_px), 0)
    }

    /// The point of the edge in a row, which is looked for from another one.
    fn point(&self, line3: &Line3<S>, row: u16, near: &EdgePoint) -> EdgePoint {
        let setup = self.mode.setup();
        let guess = EdgePoint { row, time_ns: setup.readout().row_time_ns(row), ..*near };
        EdgePoint { column_q16: q16(column_at(setup, self.motion, line3, &guess)), ..guess }
    }

    /// Whether the row of a point shows the target between its ends.
    fn covers(&self, line3: &Line3<S>, point: &EdgePoint, depth_m: S) -> bool {
        let sample = Sample::point(point.column_px(), S::from_i32(point.row.into()), point.time_s(), S::ONE);
        let mut observer = Observer::new(self.mode.setup().camera(), self.motion, [line3.gravity, line3.lean]);
        let Some(observation) = observer.observe(&sample) else { return false };
        let along_m = line3.along(&RowPlane::new(self.motion, &observation)) * depth_m;
        line3.residual(&observation).is_in_front() && along_m >= self.target.top_m && along_m <= self.target.bottom_m
    }

    /// Along the row during the exposure.
    fn path_px(&self, line3: &Line3<S>, point: &EdgePoint) -> S {
        let half_ns = (self.mode.exposure_s().to_f64() * 0.5 * NS_PER_S as f64) as i64;
        let at = |time_ns: i64| column_at(self.mode.setup(), self.motion, line3, &EdgePoint { time_ns, ..*point });
        at(point.time_ns.saturating_add(half_ns)) - at(point.time_ns.saturating_sub(half_ns))
    }
}

/// The last place where something does not hold and the first one where it does, from a step between the two.
fn border<S: Scalar>(mut bad: S, mut good: S, is_good: impl Fn(S) -> bool) -> (S, S) {
    for _ in 0..HALVINGS {
        let middle = (bad + good) * S::ratio(1, 2);
        if is_good(middle) { good = middle } else { bad = middle }
    }
    (bad, good)
}

/// In 1/65536 px, at most 16384 px from zero.
fn q16<S: Scalar>(column_px: S) -> i32 {
    (column_px.to_f64() * 65536.0) as i32
}

fn with_look<S: Scalar>(point: EdgePoint, look: &EdgeLook<S>) -> EdgePoint {
    let sigma_q16 = (look.sigma_px.to_f64() * 65536.0) as u32;
    let width_q8 = (look.width_px.to_f64() * 256.0) as u16;
    EdgePoint { width_q8, ..point.with_sigma_q16(sigma_q16.clamp(1, EdgePoint::MAX_SIGMA_Q16)) }
}
