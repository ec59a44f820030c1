//! [`View`]: where lines in space appear in the image at one instant. It is computed per row, never per pixel, so
//! double precision is affordable.

use crate::setup::Intrinsics;

pub(super) type Vector = [f64; 3];

/// Least depth, in metres, at which anything is drawn.
const NEAR_M: f64 = 0.01;

/// Steepest slope of a line that is drawn, in pixels per row: steeper ones lie along the rows.
const MAX_SLOPE: f64 = 20.0;

/// Intrinsics in double precision.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Lens {
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
}

impl Lens {
    pub(super) fn new(intrinsics: &Intrinsics<f32>) -> Self {
        let Intrinsics { fx, fy, cx, cy, .. } = *intrinsics;
        Self { fx: f64::from(fx), fy: f64::from(fy), cx: f64::from(cx), cy: f64::from(cy) }
    }

    /// Bearings (x/z, y/z) of a pixel.
    pub(super) fn bearings(&self, column: f64, row: f64) -> (f64, f64) {
        ((column - self.cx) / self.fx, (row - self.cy) / self.fy)
    }

    pub(super) const fn principal_point(&self) -> (f64, f64) {
        (self.cx, self.cy)
    }

    fn pixel(&self, x: f64, y: f64, z: f64) -> (f64, f64) {
        (self.cx + self.fx * x / z, self.cy + self.fy * y / z)
    }
}

/// The camera at one instant: its position and the directions of its axes, in the axes of the first frame's start.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    position_m: Vector,
    right: Vector,
    down: Vector,
    forward: Vector,
}

impl View {
    /// After moving at a constant velocity and turning at a constant rate for a time.
    pub(super) fn after(time_s: f64, velocity_m_s: Vector, rate_rad_s: Vector) -> Self {
        let angles = rate_rad_s.map(|rate| rate * time_s);
        let angle = libm::sqrt(inner(angles, angles));
        let (axis, sine, cosine) = if angle > 0.0 {
            (angles.map(|component| component / angle), libm::sin(angle), libm::cos(angle))
        } else {
            ([0.0; 3], 0.0, 1.0)
        };
        let turned = |vector| turned(vector, axis, sine, cosine);
        Self {
            position_m: velocity_m_s.map(|speed| speed * time_s),
            right: turned([1.0, 0.0, 0.0]),
            down: turned([0.0, 1.0, 0.0]),
            forward: turned([0.0, 0.0, 1.0]),
        }
    }

    /// Turned on the spot about an axis of length one, in the axes of the first frame's start.
    pub(super) fn turned(self, axis: Vector, angle: f64) -> Self {
        let [right, down, forward] = [self.right, self.down, self.forward]
            .map(|vector| turned(vector, axis, libm::sin(angle), libm::cos(angle)));
        Self { right, down, forward, ..self }
    }

    /// Rotates a direction from the axes of the first frame's start into the camera's.
    pub(super) fn in_camera(&self, vector: Vector) -> Vector {
        [inner(self.right, vector), inner(self.down, vector), inner(self.forward, vector)]
    }

    /// Rotates a direction from the camera's axes into those of the first frame's start.
    pub(super) fn in_first_frame(&self, [x, y, z]: Vector) -> Vector {
        let (right, down, forward) = (self.right.map(|c| c * x), self.down.map(|c| c * y), self.forward.map(|c| c * z));
        sum(sum(right, down), forward)
    }

    pub(super) fn line(&self, foot_m: Vector, along: Vector) -> SeenLine {
        let from_camera = sum(foot_m, self.position_m.map(|component| -component));
        SeenLine { foot: self.in_camera(from_camera), along: self.in_camera(along) }
    }
}

/// A line in space, in the camera's axes: its points are `foot + λ along`.
#[derive(Clone, Copy)]
pub(super) struct SeenLine {
    foot: Vector,
    along: Vector,
}

/// Where a line crosses a row of the image: the column, and its change from row to row at this instant.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    pub(super) column: f64,
    pub(super) slope: f64,
    /// Where on the line: its λ.
    pub(super) along_m: f64,
}

impl SeenLine {
    /// Where the line meets the plane of a row's rays, y = w z. `None` where it lies along the row or behind the
    /// camera.
    pub(super) fn cross_row(&self, lens: &Lens, row: f64) -> Option<Crossing> {
        let (_, w) = lens.bearings(lens.cx, row);
        let ([fx, fy, fz], [ax, ay, az]) = (self.foot, self.along);
        let across = ay - w * az;
        let lambda = (w * fz - fy) / across;
        let (x, z) = (fx + lambda * ax, fz + lambda * az);
        let (column, _) = lens.pixel(x, 0.0, z);
        let slope = (ax - x / z * az) * lens.fx / (across * lens.fy);
        (z > NEAR_M && slope.abs() < MAX_SLOPE && column.is_finite()).then_some(Crossing {
            column,
            slope,
            along_m: lambda,
        })
    }

    /// Row at which the line meets the plane of a column's rays, x = u z. `None` where it is behind the camera.
    pub(super) fn cross_column(&self, lens: &Lens, column: f64) -> Option<f64> {
        let (u, _) = lens.bearings(column, lens.cy);
        let ([fx, fy, fz], [ax, ay, az]) = (self.foot, self.along);
        let lambda = (u * fz - fx) / (ax - u * az);
        let (y, z) = (fy + lambda * ay, fz + lambda * az);
        let (_, row) = lens.pixel(0.0, y, z);
        (z > NEAR_M && row.is_finite()).then_some(row)
    }

    /// Rows of the two ends of the segment from one λ to another; for an end behind the camera, a row far outside the
    /// image on its side. `None` where the whole segment is behind the camera.
    pub(super) fn rows_of_ends(&self, lens: &Lens, from: f64, to: f64) -> Option<[f64; 2]> {
        const FAR: f64 = 1e6;
        let ([_, fy, fz], [_, ay, az]) = (self.foot, self.along);
        let depth = |lambda: f64| fz + lambda * az;
        let row = |lambda: f64| lens.pixel(0.0, fy + lambda * ay, depth(lambda)).1.clamp(-FAR, FAR);
        // The end that the line approaches as λ grows.
        let far_end = if ay * fz >= fy * az { FAR } else { -FAR };
        match (depth(from) > NEAR_M, depth(to) > NEAR_M) {
            (true, true) => Some([row(from), row(to)]),
            (true, false) => Some([row(from), far_end]),
            (false, true) => Some([-far_end, row(to)]),
            (false, false) => None,
        }
    }

    /// Bearing x/z and depth z of the point with y = 0. `None` where there is none before the camera.
    pub(super) fn at_eye_level(&self) -> Option<(f64, f64)> {
        let ([fx, fy, fz], [ax, ay, az]) = (self.foot, self.along);
        let lambda = -fy / ay;
        let (x, z) = (fx + lambda * ax, fz + lambda * az);
        let bearing = x / z;
        (z > NEAR_M && bearing.is_finite()).then_some((bearing, z))
    }
}

/// Rodrigues: v cos φ + (k × v) sin φ + k (k·v)(1 − cos φ).
fn turned([x, y, z]: Vector, [kx, ky, kz]: Vector, sine: f64, cosine: f64) -> Vector {
    let along = (kx * x + ky * y + kz * z) * (1.0 - cosine);
    [
        x * cosine + (ky * z - kz * y) * sine + kx * along,
        y * cosine + (kz * x - kx * z) * sine + ky * along,
        z * cosine + (kx * y - ky * x) * sine + kz * along,
    ]
}

fn inner(a: Vector, b: Vector) -> f64 {
    a.into_iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn sum([ax, ay, az]: Vector, [bx, by, bz]: Vector) -> Vector {
    [ax + bx, ay + by, az + bz]
}
