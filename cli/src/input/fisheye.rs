//! Fisheye lenses (OpenCV's `fisheye`, Kalibr's `equi`, ROS's `equidistant`) as the rational model of the library,
//! which follows them closely up to 60° off the axis.

use anyhow::{Result, ensure};

use super::size::Size;

/// A lens whose points lie, at the angle θ off the axis, at the radius θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸) × f.
pub(crate) struct Fisheye {
    pub(crate) k: [f64; 4],
    pub(crate) focal_px: [f64; 2],
    pub(crate) centre_px: [f64; 2],
    pub(crate) size: Size,
}

/// Beyond, the library takes the lens for one that folds over: an area there is hardly seen.
const MOST_OFF_AXIS_DEG: f64 = 60.0;
/// A tenth of what the best edges are known to.
const MOST_ERROR_PX: f64 = 0.005;
/// Points of the fit, and rounds in which it is weighted by its own divisor.
const POINTS: usize = 240;
const ROUNDS: usize = 6;

impl Fisheye {
    /// `[k1, k2, p1, p2, k3, k4, k5, k6]`, OpenCV's order.
    pub(crate) fn rational(&self) -> Result<[f64; 8]> {
        let limit = MOST_OFF_AXIS_DEG.to_radians();
        let (farthest, most) = (self.farthest(), self.radius(limit));
        let rises = (1..=POINTS).all(|step| {
            let at = |step: usize| self.radius(limit * step as f64 / POINTS as f64);
            at(step) > at(step - 1)
        });
        ensure!(
            rises && farthest < most,
            "a fisheye lens whose corners look farther than {MOST_OFF_AXIS_DEG}° off the axis: more than the rational model \
             carries. Crop the frames (columns, rows, cx, cy), or undistort nothing and use the inner part"
        );
        let steepest = self.angle(farthest).tan();
        let samples: Vec<Sample> =
            (1..=POINTS).map(|step| self.sample(steepest * step as f64 / POINTS as f64)).collect();
        let k = fitted(&samples, steepest * steepest);
        let focal_px = self.focal_px[0].max(self.focal_px[1]);
        let error = |sample: &Sample| (rational(&k, sample.r2) - sample.factor).abs() * sample.r2.sqrt() * focal_px;
        let worst = samples.iter().map(error).fold(0.0, f64::max);
        ensure!(worst <= MOST_ERROR_PX, "a fisheye lens that the rational model follows to {worst:.3} px only");
        let [k1, k2, k3, k4, k5, k6] = k;
        Ok([k1, k2, 0.0, 0.0, k3, k4, k5, k6])
    }

    fn radius(&self, angle: f64) -> f64 {
        let a2 = angle * angle;
        let [k1, k2, k3, k4] = self.k;
        angle * (1.0 + a2 * (k1 + a2 * (k2 + a2 * (k3 + a2 * k4))))
    }

    /// By bisection: the radius has been seen to rise.
    fn angle(&self, radius: f64) -> f64 {
        let (mut low, mut high) = (0.0, MOST_OFF_AXIS_DEG.to_radians());
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.radius(middle) < radius { low = middle } else { high = middle }
        }
        low
    }

    /// The radius of the farthest corner, in focal lengths, with the two pixels beyond the border that the library asks
    /// for.
    fn farthest(&self) -> f64 {
        let sides = [self.size.columns, self.size.rows];
        let side = |axis: usize| {
            let centre = self.centre_px[axis];
            (centre + 2.0).max(f64::from(sides[axis]) + 1.0 - centre).abs() / self.focal_px[axis]
        };
        side(0).hypot(side(1))
    }

    fn sample(&self, tangent: f64) -> Sample {
        Sample { r2: tangent * tangent, factor: self.radius(tangent.atan()) / tangent }
    }
}

/// What the radial factor of the rational model must be at r².
struct Sample {
    r2: f64,
    factor: f64,
}

fn rational(&[k1, k2, k3, k4, k5, k6]: &[f64; 6], r2: f64) -> f64 {
    let cubic = |a: f64, b: f64, c: f64| 1.0 + r2 * (a + r2 * (b + r2 * c));
    cubic(k1, k2, k3) / cubic(k4, k5, k6)
}

/// Least squares of numerator − factor × divisor, each time over the divisor of the round before (Sanathanan, Koerner
/// 1963). In r² over its largest value, so that the columns are of one size.
fn fitted(samples: &[Sample], largest_r2: f64) -> [f64; 6] {
    let mut scaled = [0.0; 6];
    for _ in 0..ROUNDS {
        let rows = samples.iter().map(|&Sample { r2, factor }| {
            let x = r2 / largest_r2;
            let [_, _, _, k4, k5, k6] = scaled;
            let weight = r2.sqrt() / (1.0 + x * (k4 + x * (k5 + x * k6)));
            let row = [x, x * x, x * x * x, -factor * x, -factor * x * x, -factor * x * x * x];
            (row.map(|entry| entry * weight), (factor - 1.0) * weight)
        });
        scaled = least_squares(rows.collect());
    }
    let powers = [1, 2, 3, 1, 2, 3].map(|power| largest_r2.powi(power));
    std::array::from_fn(|index| scaled[index] / powers[index])
}

/// By the modified Gram–Schmidt process, the right-hand side as a further column; a column that the others have is left
/// out.
fn least_squares<const N: usize>(mut rows: Vec<([f64; N], f64)>) -> [f64; N] {
    const NEGLIGIBLE: f64 = 1e-13;
    let mut triangle = [[0.0; N]; N];
    let mut right = [0.0; N];
    let sizes: [f64; N] =
        std::array::from_fn(|column| rows.iter().map(|(row, _)| row[column].powi(2)).sum::<f64>().sqrt());
    for column in 0..N {
        let size = rows.iter().map(|(row, _)| row[column].powi(2)).sum::<f64>().sqrt();
        if size <= NEGLIGIBLE * sizes[column] {
            continue;
        }
        rows.iter_mut().for_each(|(row, _)| row[column] /= size);
        triangle[column][column] = size;
        for other in column + 1..N {
            let product: f64 = rows.iter().map(|(row, _)| row[column] * row[other]).sum();
            rows.iter_mut().for_each(|(row, _)| row[other] -= product * row[column]);
            triangle[column][other] = product;
        }
        right[column] = rows.iter().map(|(row, value)| row[column] * value).sum();
        rows.iter_mut().for_each(|(row, value)| *value -= right[column] * row[column]);
    }
    let mut solution = [0.0; N];
    for column in (0..N).rev().filter(|column| triangle[*column][*column] > 0.0) {
        let known: f64 = (column + 1..N).map(|other| triangle[column][other] * solution[other]).sum();
        solution[column] = (right[column] - known) / triangle[column][column];
    }
    solution
}
