//! [`Observation`]: a sample as a ray in the axes of the frame-start camera. docs/model.md, section 3.

use super::sample::Sample;
use crate::motion::Motion;
use crate::scalar::{Scalar, add, cross, dot, over, scale};
use crate::setup::{Camera, LensPoint, RaySpan};

/// A normal `n` of the plane through a ray and a direction, as far as a line through the plane y = 0 needs it.
#[derive(Clone, Copy)]
pub(crate) struct Normal<S> {
    pub(crate) x: S,
    pub(crate) z: S,
    /// n · p, with p where the ray starts.
    pub(crate) moved: S,
}

impl<S: Scalar> Normal<S> {
    fn of(ray: [S; 3], direction: [S; 3], position: [S; 3]) -> Self {
        let normal = cross(ray, direction);
        let [x, _, z] = normal;
        Self { x, z, moved: dot(normal, position) }
    }

    /// Of a direction in the image plane.
    fn of_flat([x, y, z]: [S; 3], [ex, ey, _]: [S; 3], position: [S; 3]) -> Self {
        let normal = [-(z * ey), z * ex, (x * ey).minus_product(y, ex)];
        let [x, _, z] = normal;
        Self { x, z, moved: dot(normal, position) }
    }

    fn less(&self, other: &Self) -> Self {
        Self { x: self.x - other.x, z: self.z - other.z, moved: self.moved - other.moved }
    }
}

/// A ray against the two directions that an edge is made of.
#[derive(Clone, Copy)]
pub(crate) struct Normals<S> {
    /// d × g: m of an upright edge.
    pub(crate) down: Normal<S>,
    /// d × e: what a unit of tilt adds.
    pub(crate) lean: Normal<S>,
    /// Their changes by a pixel along the row.
    pub(crate) down_per_px: Normal<S>,
    pub(crate) lean_per_px: Normal<S>,
}

/// A sample as a ray, and its noise.
#[derive(Clone, Copy)]
pub(crate) struct Observation<S> {
    pub(crate) normals: Normals<S>,
    /// Bearings to the right and downwards in the camera's axes at that time.
    pub(crate) bearings: [S; 2],
    pub(crate) time_s: S,
    pub(crate) sigma_px: S,
    pub(crate) per_sigma: S,
    /// False once the robust fit has rejected it.
    pub(crate) is_inlier: bool,
}

/// Directions of the rays at the ends of a span, as their mean and half their difference, the middle position and half
/// the difference of the positions at the ends.
struct Rays<S> {
    direction: [S; 3],
    half: [S; 3],
    along_row: [S; 3],
    position: [S; 3],
    half_position: [S; 3],
}

/// From sample to observation, one after the other along a line.
pub(crate) struct Observer<'a, S, M> {
    camera: &'a Camera<S>,
    motion: &'a M,
    /// Those of the line that the observations are held against.
    gravity: [S; 3],
    lean: [S; 3],
    /// Whether the camera does not turn.
    is_steady: bool,
    /// Where the lens has seen the last sample.
    last: Option<LensPoint<S>>,
}

impl<'a, S: Scalar, M: Motion<S>> Observer<'a, S, M> {
    pub(crate) fn new(camera: &'a Camera<S>, motion: &'a M, [gravity, lean]: [[S; 3]; 2]) -> Self {
        Self { camera, motion, gravity, lean, is_steady: motion.keeps_attitude(), last: None }
    }

    /// `None` where the lens model has no ray.
    pub(crate) fn observe(&mut self, sample: &Sample<S>) -> Option<Observation<S>> {
        let spread = &sample.spread;
        let (at, half) = ([sample.column_px, sample.row_px], [spread.column_px, spread.row_px]);
        let span = self.camera.rays(at, half, &mut self.last)?;
        let rays = self.rays(&span, sample.time_s, spread.time_s);
        let Rays { direction, along_row, position, .. } = rays;
        let [mut down, lean] = self.normals(direction, position);
        let [down_per_px, lean_per_px] = self.normals(along_row, position);
        // Up to the third order, the mean over a span is that of two points one standard deviation off its middle, and
        // that of a product the product of the means and this. What it would add to the lean is the product of two
        // small numbers.
        down.moved = down.moved + dot(cross(rays.half, self.gravity), rays.half_position);
        // No less than the rounding of the column itself.
        let sigma_px = sample.sigma_px.max((sample.column_px.abs() + S::ONE) * (S::EPSILON + S::EPSILON));
        Some(Observation {
            normals: Normals { down, lean, down_per_px, lean_per_px },
            bearings: span.middle,
            time_s: sample.time_s,
            sigma_px,
            per_sigma: over(sigma_px),
            is_inlier: true,
        })
    }

    /// What the ray of a point at the start of a time differs by from that at its end.
    pub(super) fn sweep(&mut self, point: &Sample<S>, half_s: S) -> Option<Normals<S>> {
        let span = self.camera.rays([point.column_px, point.row_px], [S::ZERO; 2], &mut self.last)?;
        let [start, end] = [-half_s, half_s].map(|off_s| self.rays(&span, point.time_s + off_s, S::ZERO));
        let [down, lean] = self.normals(start.direction, start.position);
        let [down_later, lean_later] = self.normals(end.direction, end.position);
        let [down_per_px, lean_per_px] = self.normals(start.along_row, start.position);
        Some(Normals { down: down.less(&down_later), lean: lean.less(&lean_later), down_per_px, lean_per_px })
    }

    /// Those through a ray and the two directions that an edge is made of.
    fn normals(&self, ray: [S; 3], position: [S; 3]) -> [Normal<S>; 2] {
        [Normal::of(ray, self.gravity, position), Normal::of_flat(ray, self.lean, position)]
    }

    /// The rays in the axes of frame start, where they look and where from.
    fn rays(&self, span: &RaySpan<S>, time_s: S, half_s: S) -> Rays<S> {
        let pose = self.motion.pose(time_s);
        let (position, half_position) = (pose.position_m, scale(pose.velocity_m_s, half_s));
        let ([u, w], [half_u, half_w], [du, dw]) = (span.middle, span.half, span.along_row);
        if self.is_steady {
            let (direction, half, along_row) = ([u, w, S::ONE], [half_u, half_w, S::ZERO], [du, dw, S::ZERO]);
            return Rays { direction, half, along_row, position, half_position };
        }
        let across = pose.rotate_across(span.middle);
        let is_straight = dw == S::ZERO;
        let along_row = if is_straight { scale(pose.right(), du) } else { pose.rotate_across([du, dw]) };
        if half_s == S::ZERO {
            return Rays {
                direction: add(pose.ahead(), across),
                half: [S::ZERO; 3],
                along_row,
                position,
                half_position,
            };
        }
        let half = pose.rotate_across(span.half);
        // By half of the span the camera turns on: exp(±θ) (d ± h), to the second order.
        let turn = scale(pose.rate_rad_s, half_s);
        let turned = cross(turn, add(pose.ahead(), across));
        // The smallest first: single precision has no digit to spare.
        let turned_twice = cross(turn, add(half, turned.map(S::half)));
        let direction = add(pose.ahead(), add(across, turned_twice));
        Rays { direction, half: add(half, turned), along_row, position, half_position }
    }
}

impl<S: Scalar> Observation<S> {
    pub(super) fn with_sigma(self, sigma_px: S) -> Self {
        Self { sigma_px, per_sigma: over(sigma_px), ..self }
    }
}

/// The plane of a row at its time: `y = slope · z` from where the camera is.
pub(crate) struct RowPlane<S> {
    pub(crate) slope: S,
    pub(crate) y: S,
    pub(crate) z: S,
}

impl<S: Scalar> RowPlane<S> {
    pub(crate) fn new<M: Motion<S>>(motion: &M, observation: &Observation<S>) -> Self {
        let pose = motion.pose(observation.time_s);
        let [u, w] = observation.bearings;
        let ([_, dy, dz], [_, y, z]) = (pose.rotate([u, w, S::ONE]), pose.position_m);
        Self { slope: dy / dz, y, z }
    }
}
