//! The fit and its covariance against an independent one: dense normal equations over exact projections, inverted by
//! Gaussian elimination. The library never forms a normal matrix, and solves by orthogonalisation.

use proptest::prelude::*;
use shutter_range::{RangeStatus, Sample, fit};

use crate::projection::{Matrix, Scene, Vector, times};
use crate::scenes::{seeded, tilt_of};
use crate::symmetries::scenes;

/// Bearing, inverse depth and tilt with their covariance.
pub(crate) struct Dense {
    pub(crate) estimate: Vector,
    pub(crate) covariance: Matrix,
    /// Whether the last step was next to nothing.
    pub(crate) has_converged: bool,
}

impl Dense {
    /// The least-squares estimate from points on rows, and an edge that is upright but for `sigma_tilt`. It starts from
    /// the edge of the scene itself.
    pub(crate) fn fit(scene: &Scene, samples: &[Sample<f64>], sigma_tilt: f64) -> Self {
        let mut estimate = [scene.bearing, 1.0 / scene.depth_m, scene.tilt];
        let (mut covariance, mut step) = (Matrix::default(), Vector::default());
        for _ in 0..STEPS {
            let (normal, right) = normal_equations(scene, samples, sigma_tilt, estimate);
            covariance = inverse(normal);
            step = times(covariance, right);
            estimate = std::array::from_fn(|unknown| estimate[unknown] + step[unknown]);
        }
        if sigma_tilt == 0.0 {
            covariance[2][2] = 0.0;
        }
        let has_converged = step[1].abs() < 1e-4 * covariance[1][1].sqrt();
        Self { estimate, covariance, has_converged }
    }

    pub(crate) fn sigma(&self, unknown: usize) -> f64 {
        self.covariance[unknown][unknown].sqrt()
    }

    /// Correlation of bearing and inverse depth.
    pub(crate) fn correlation(&self) -> f64 {
        self.covariance[0][1] / (self.sigma(0) * self.sigma(1))
    }
}

/// The problem is next to linear: mostly the third step is next to nothing.
const STEPS: usize = 12;

fn column(scene: &Scene, sample: &Sample<f64>, [bearing, inverse_depth, tilt]: Vector) -> f64 {
    let scene = Scene { bearing, depth_m: 1.0 / inverse_depth, tilt, ..scene.clone() };
    scene.column_at(sample.row_px, sample.time_s)
}

/// Change of the column with each unknown, by central differences.
fn derivatives(scene: &Scene, sample: &Sample<f64>, at: Vector) -> Vector {
    const STEP: f64 = 1e-6;
    std::array::from_fn(|unknown| {
        let moved = |by: f64| {
            let mut at = at;
            at[unknown] += by;
            column(scene, sample, at)
        };
        (moved(STEP) - moved(-STEP)) / (2.0 * STEP)
    })
}

fn normal_equations(scene: &Scene, samples: &[Sample<f64>], sigma_tilt: f64, at: Vector) -> (Matrix, Vector) {
    let (mut normal, mut right) = (Matrix::default(), Vector::default());
    let mut add = |coefficients: Vector, residual: f64, sigma: f64| {
        for (row, a) in coefficients.into_iter().enumerate() {
            for (column, b) in coefficients.into_iter().enumerate() {
                normal[row][column] += a * b / (sigma * sigma);
            }
            right[row] += a * residual / (sigma * sigma);
        }
    };
    for sample in samples {
        let mut coefficients = derivatives(scene, sample, at);
        if sigma_tilt == 0.0 {
            coefficients[2] = 0.0;
        }
        add(coefficients, sample.column_px - column(scene, sample, at), sample.sigma_px);
    }
    // Without a tilt to be estimated, an equation of its own keeps the matrix regular.
    add([0.0, 0.0, 1.0], -at[2], if sigma_tilt > 0.0 { sigma_tilt } else { 1.0 });
    (normal, right)
}

/// By elimination with pivots, on the matrix beside the identity.
fn inverse(matrix: Matrix) -> Matrix {
    let mut rows: [[f64; 6]; 3] = std::array::from_fn(|row| {
        std::array::from_fn(
            |column| if column < 3 { matrix[row][column] } else { f64::from(u8::from(column - 3 == row)) },
        )
    });
    for pivot in 0..3 {
        let largest = (pivot..3).max_by(|a, b| rows[*a][pivot].abs().total_cmp(&rows[*b][pivot].abs()));
        rows.swap(pivot, largest.expect("a row"));
        let scale = rows[pivot][pivot];
        rows[pivot] = rows[pivot].map(|value| value / scale);
        for row in (0..3).filter(|row| *row != pivot) {
            let factor = rows[row][pivot];
            rows[row] = std::array::from_fn(|column| rows[row][column] - factor * rows[pivot][column]);
        }
    }
    rows.map(|[_, _, _, a, b, c]| [a, b, c])
}

/// Most difference of an estimate, in its sigma. The library ends its rounds where the last one has moved it by less
/// than a fiftieth of that, and takes the coefficients of a sample at its noisy column: both are of second order.
const ESTIMATE: f64 = 0.01;
/// Most relative difference of a sigma, likewise.
const SIGMA: f64 = 1e-3;
/// The same where tilt is known: rounding, and the differences that stand for derivatives.
const WITHOUT_TILT: f64 = 1e-5;
/// Likewise of what a twin adds, which is another difference of sigmas.
const TWIN: f64 = 0.05;

proptest! {
    #![proptest_config(seeded(400))]

    /// With tilt known and with priors on tilt from far below to far above what the samples tell.
    #[test]
    fn estimate_and_covariance_are_those_of_a_dense_inverse(
        scene in scenes(),
        // Half a sigma at most, so that no sample is an outlier and nothing that wanders by chance enlarges sigma.
        noise in prop::collection::vec(-0.5..0.5_f64, 48),
        sigma_px in 0.001..0.01_f64,
        sigma_tilt in prop::sample::select(vec![0.0, 1e-5, 1e-4, 1e-3, 1e-2]),
    ) {
        let rows = scene.visible_rows().into_iter().step_by(10);
        let sample = |(row, noise)| {
            Sample::point(scene.column(row) + noise * sigma_px, f64::from(row), scene.time_s(row), sigma_px)
        };
        let samples: Vec<_> = rows.zip(noise).map(sample).collect();
        let found = fit::<f64, _, 48>(&scene.setup_with(tilt_of(sigma_tilt)), &scene.motion(), samples.iter().copied());
        let found = found.expect("sound samples");
        let dense = Dense::fit(&scene, &samples, sigma_tilt);
        // In forward motion a valley of tilt and depth can be so flat and so curved that no iteration of this kind
        // settles.
        prop_assume!(found.status() == RangeStatus::Ok && dense.has_converged);
        let [bearing, inverse_depth, tilt] = dense.estimate;
        let (of_estimate, of_sigma) = if sigma_tilt > 0.0 { (ESTIMATE, SIGMA) } else { (WITHOUT_TILT, WITHOUT_TILT) };
        prop_assert!((found.bearing - bearing).abs() < of_estimate * dense.sigma(0));
        prop_assert!((found.inverse_depth_per_m - inverse_depth).abs() < of_estimate * dense.sigma(1));
        prop_assert!((found.tilt - tilt).abs() <= of_estimate * dense.sigma(2));
        if found.sigma_inverse_depth_per_m > (1.0 + of_sigma) * dense.sigma(1) {
            // A twin: an error along the change of bearing and tilt with the inverse depth, in forward motion alone.
            prop_assert!(sigma_tilt > 0.0 && scene.velocity_m_s[2].abs() > 0.1 * scene.velocity_m_s[0].abs());
            let along = |unknown: usize| dense.covariance[1][unknown] / dense.covariance[1][1];
            let added = |sigma: f64, unknown: usize| sigma.powi(2) - dense.covariance[unknown][unknown];
            let of_depth = added(found.sigma_inverse_depth_per_m, 1);
            prop_assert!((added(found.sigma_bearing, 0) / (of_depth * along(0).powi(2)) - 1.0).abs() < TWIN);
            prop_assert!((added(found.sigma_tilt, 2) / (of_depth * along(2).powi(2)) - 1.0).abs() < TWIN);
            return Ok(());
        }
        prop_assert!((found.sigma_bearing / dense.sigma(0) - 1.0).abs() < of_sigma);
        prop_assert!((found.sigma_inverse_depth_per_m / dense.sigma(1) - 1.0).abs() < of_sigma);
        prop_assert!((found.sigma_tilt - dense.sigma(2)).abs() <= of_sigma * dense.sigma(2));
        prop_assert!((found.correlation - dense.correlation()).abs() < of_sigma);
    }
}
