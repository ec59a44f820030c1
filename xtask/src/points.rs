//! [`Edge`]: an upright edge and the points that a turning camera with a lens sees of it; shares no formula with the
//! library.

use rand::Rng;
use rand::rngs::StdRng;
use rand_distr::StandardNormal;
use shutter_range::{EdgePoint, Polarity};

use crate::job::{Motion, Rig};

type Vector = [f64; 3];

/// Noise of a column in pixels: of a clean edge of some contrast.
const SIGMA_PX: f64 = 0.08;
/// Noise of a width, as a share of it.
const SIGMA_WIDTH: f64 = 0.02;

/// An edge along gravity, in the axes of the first frame's start.
#[derive(Clone, Copy)]
pub(crate) struct Edge {
    pub(crate) bearing: f64,
    pub(crate) depth_m: f64,
    pub(crate) polarity: Polarity,
}

/// The camera's motion over several frames; the motion is that of the first.
#[derive(Clone, Copy)]
pub(crate) struct Drive {
    pub(crate) motion: Motion,
    pub(crate) frame_s: f64,
}

impl Drive {
    /// The motion in the axes of a frame's start.
    pub(crate) fn motion_of(&self, frame: u16) -> Motion {
        let time_s = f64::from(frame) * self.frame_s;
        let Motion { velocity_m_s, rate_rad_s, gravity } = self.motion;
        let turned = |vector| in_camera(vector, rate_rad_s, time_s);
        Motion { velocity_m_s: turned(velocity_m_s), rate_rad_s, gravity: turned(gravity) }
    }
}

impl Edge {
    /// Its points in a frame with their noise, row by row; where the edge is outside the image there is none.
    pub(crate) fn points(&self, rig: &Rig, drive: &Drive, frame: u16, random: &mut StdRng) -> Vec<EdgePoint> {
        (0..rig.rows).filter_map(|row| self.point(rig, drive, frame, row, random)).collect()
    }

    fn point(&self, rig: &Rig, drive: &Drive, frame: u16, row: u16, random: &mut StdRng) -> Option<EdgePoint> {
        let row_time_s = rig.row_time_s(row);
        let time_s = f64::from(frame) * drive.frame_s + row_time_s;
        let column = self.column(rig, &drive.motion, row, time_s)?;
        let half = 0.5 * rig.exposure_s;
        let ends = [time_s - half, time_s + half].map(|time_s| self.column(rig, &drive.motion, row, time_s));
        let path = ends[1]? - ends[0]?;
        let width = (rig.lens_px * rig.lens_px + (1.0 + path * path) / 12.0).sqrt();
        let noise: f64 = random.sample(StandardNormal);
        let width_noise: f64 = random.sample(StandardNormal);
        let column = column + SIGMA_PX * noise;
        if !(0.0..=f64::from(rig.columns) - 1.0).contains(&column) {
            return None;
        }
        let time_ns = (row_time_s * 1e9).round() as i64;
        let point = EdgePoint::new(row, (column * 65536.0).round() as i32, time_ns)
            .with_polarity(self.polarity)
            .with_sigma_q16((SIGMA_PX * 65536.0) as u32);
        Some(EdgePoint { width_q8: (width * (1.0 + SIGMA_WIDTH * width_noise) * 256.0).round() as u16, ..point })
    }

    /// Where a row crosses the edge: the place along the edge that the camera sees in that row, by the secant method.
    fn column(&self, rig: &Rig, motion: &Motion, row: u16, time_s: f64) -> Option<f64> {
        let foot = [self.bearing * self.depth_m, 0.0, self.depth_m];
        let seen = |along: f64| {
            let point = core::array::from_fn(|k| foot[k] + along * motion.gravity[k] - time_s * motion.velocity_m_s[k]);
            pixel(rig, in_camera(point, motion.rate_rad_s, time_s))
        };
        let (mut before, mut along) = (0.0, 0.1);
        let mut missed_before = seen(before)[1] - f64::from(row);
        for _ in 0..30 {
            let [column, at] = seen(along);
            let missed = at - f64::from(row);
            if missed.abs() < 1e-9 {
                return Some(column);
            }
            let next = along - missed * (along - before) / (missed - missed_before);
            (before, missed_before, along) = (along, missed, next);
        }
        None
    }
}

/// A vector in the axes of a camera that has turned for a time (Rodrigues, backwards).
fn in_camera(vector: Vector, rate_rad_s: Vector, time_s: f64) -> Vector {
    let angle = rate_rad_s.iter().map(|rate| rate * rate).sum::<f64>().sqrt() * time_s;
    if angle == 0.0 {
        return vector;
    }
    let [kx, ky, kz] = rate_rad_s.map(|rate| rate * time_s / angle);
    let ([x, y, z], (sine, cosine)) = (vector, (-angle).sin_cos());
    let along = (kx * x + ky * y + kz * z) * (1.0 - cosine);
    [
        x * cosine + (ky * z - kz * y) * sine + kx * along,
        y * cosine + (kz * x - kx * z) * sine + ky * along,
        z * cosine + (kx * y - ky * x) * sine + kz * along,
    ]
}

fn pixel(rig: &Rig, [x, y, z]: Vector) -> [f64; 2] {
    let (u, w) = (x / z, y / z);
    let [k1, k2, p1, p2, k3] = rig.distortion;
    let r2 = u * u + w * w;
    let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
    let column = u * radial + 2.0 * p1 * u * w + p2 * (r2 + 2.0 * u * u);
    let row = w * radial + 2.0 * p2 * u * w + p1 * (r2 + 2.0 * w * w);
    let [cx, cy] = rig.centre_px;
    [cx + rig.focal_px * column, cy + rig.focal_px * row]
}
