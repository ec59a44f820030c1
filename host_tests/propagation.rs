//! What a sequence knows of an edge at the next frame's start, against the exact geometry of the way there.
//!
//! The covariance of the first frame, from dense normal equations, is carried on by a Jacobian of finite differences.
//! The library's is read from the range of a line in the next frame that says next to nothing.

use proptest::prelude::*;
use shutter_range::{EdgePoint, Motion, Range, RangeStatus, Sample, Sequence, Setup};

use crate::least_squares::Dense;
use crate::projection::{Matrix, Scene, Vector, rotation, times, transposed};
use crate::scenes::{TENTH_DEGREE, line_of, seeded, tilt_of};
use crate::symmetries::scenes;

/// The way from one frame's start to the next one's.
struct Transition {
    position_m: Vector,
    /// From the earlier camera's axes to the later one's.
    to_later: Matrix,
    gravity: Vector,
}

impl Transition {
    /// A scene's motion goes on for a time.
    fn of(scene: &Scene, elapsed_s: f64) -> Self {
        let to_later = transposed(rotation(scene.rate_rad_s.map(|rate| rate * elapsed_s)));
        Self { position_m: scene.velocity_m_s.map(|v| v * elapsed_s), to_later, gravity: scene.gravity }
    }

    fn later_gravity(&self) -> Vector {
        times(self.to_later, self.gravity)
    }

    /// Bearing, inverse depth and tilt of the same edge in the later frame.
    fn apply(&self, [bearing, inverse_depth, tilt]: Vector) -> Vector {
        let foot = [bearing / inverse_depth, 0.0, 1.0 / inverse_depth];
        let from_camera = std::array::from_fn(|axis| foot[axis] - self.position_m[axis]);
        let (foot, down) = (times(self.to_later, from_camera), times(self.to_later, leaning(self.gravity, tilt)));
        let along = -foot[1] / down[1];
        let [x, z] = [foot[0] + along * down[0], foot[2] + along * down[2]];
        let gravity = self.later_gravity();
        let lean = across(gravity);
        [x / z, 1.0 / z, inner(down, lean) / inner(down, gravity)]
    }

    /// How much of a lean along the optical axis shows in the later image plane.
    fn shown_lean(&self) -> f64 {
        let ([gx, gy, gz], [ex, ey, _]) = (self.gravity, across(self.gravity));
        let towards = [-gz * ey, gz * ex, gx * ey - gy * ex];
        inner(times(self.to_later, towards), across(self.later_gravity()))
    }

    /// By central differences.
    fn jacobian(&self, at: Vector) -> Matrix {
        const STEP: f64 = 1e-6;
        let columns: Matrix = std::array::from_fn(|unknown| {
            let moved = |by: f64| {
                let mut at = at;
                at[unknown] += by;
                self.apply(at)
            };
            let (more, less) = (moved(STEP), moved(-STEP));
            std::array::from_fn(|component| (more[component] - less[component]) / (2.0 * STEP))
        });
        transposed(columns)
    }
}

/// The direction in the image plane across gravity.
fn across([gx, gy, _]: Vector) -> Vector {
    let length = gx.hypot(gy);
    [gy / length, -gx / length, 0.0]
}

fn leaning(gravity: Vector, tilt: f64) -> Vector {
    let lean = across(gravity);
    std::array::from_fn(|axis| gravity[axis] + tilt * lean[axis])
}

fn inner(a: Vector, b: Vector) -> f64 {
    a.into_iter().zip(b).map(|(a, b)| a * b).sum()
}

fn product(a: Matrix, b: Matrix) -> Matrix {
    let columns = transposed(b);
    a.map(|row| columns.map(|column| inner(row, column)))
}

/// The same edge as the later camera has it.
fn later(scene: &Scene, transition: &Transition, [bearing, inverse_depth, tilt]: Vector) -> Scene {
    Scene {
        velocity_m_s: times(transition.to_later, scene.velocity_m_s),
        rate_rad_s: scene.rate_rad_s,
        gravity: transition.later_gravity(),
        bearing,
        depth_m: 1.0 / inverse_depth,
        tilt,
        ..scene.clone()
    }
}

fn range_in(sequence: &mut Sequence<f64, 1>, setup: &Setup<f64>, scene: &Scene, points: &[EdgePoint]) -> Range<f64> {
    let mut found = None;
    sequence.lines(setup, &scene.motion(), &[line_of::<64>(points)], |range| found = Some(range));
    found.expect("a range for the line")
}

/// Most difference of the estimate from the exact geometry, in its sigma: what the later line of 256 px says against
/// it.
const ESTIMATE: f64 = 1e-6;
/// Most relative difference of a sigma, and of a correlation: what that line adds where the depth is hardly known, the
/// differences that stand for derivatives, and the rounds of the first frame.
const COVARIANCE: f64 = 3e-3;

proptest! {
    #![proptest_config(seeded(300))]

    /// Forwards and backwards in time, and with priors on tilt from next to exact to what is usual, so that each
    /// unknown counts.
    #[test]
    fn a_sequence_propagates_by_the_jacobian_of_the_exact_geometry(
        scene in scenes(),
        elapsed_s in -0.2..0.2_f64,
        sigma_tilt in prop::sample::select(vec![1e-7, 1e-5, TENTH_DEGREE]),
    ) {
        // 0.002 px, and as little as points can say.
        const SIGMA_Q16: u32 = 131;
        const LEAST_POINTS: usize = 8;
        let setup = scene.setup_with(tilt_of(sigma_tilt));
        let mut sequence: Sequence<f64, 1> = Sequence::new();
        // One row in ten, so that each of 64 knots has one point at most.
        let points: Vec<_> = scene.points().into_iter().step_by(10).map(|point| point.with_sigma_q16(SIGMA_Q16)).collect();
        let here = range_in(&mut sequence, &setup, &scene, &points);
        prop_assume!(here.status == RangeStatus::Ok);
        let transition = Transition::of(&scene, elapsed_s);
        let pose = scene.motion().pose(elapsed_s);
        sequence.advance(&setup, &pose, elapsed_s, transition.later_gravity()).expect("sound gravity");

        let state = [here.estimate.bearing, here.estimate.inverse_depth_per_m, here.estimate.tilt];
        let next = transition.apply(state);
        let there = later(&scene, &transition, next);
        let weak = there.points().into_iter().map(|point| point.with_sigma_q16(EdgePoint::MAX_SIGMA_Q16));
        // From the middle: what a rotation brings into view at the ends is another part of the edge.
        let weak: Vec<_> = weak.collect::<Vec<_>>().into_iter().skip(there.visible_rows().len().saturating_sub(LEAST_POINTS) / 2).take(LEAST_POINTS).collect();
        prop_assume!(weak.len() == LEAST_POINTS);
        let known = range_in(&mut sequence, &setup, &there, &weak);
        prop_assert_eq!(known.frames, 2);

        let sigma_px = f64::from(SIGMA_Q16) / 65536.0;
        let sample = |point: &EdgePoint| Sample::point(point.column_px(), f64::from(point.row), point.time_s(), sigma_px);
        let dense = Dense::fit(&scene, &points.iter().map(sample).collect::<Vec<_>>(), sigma_tilt);
        // Where a twin is in sigma as well, there is more to propagate than this.
        prop_assume!(here.estimate.sigma_inverse_depth_per_m < (1.0 + COVARIANCE) * dense.sigma(1));
        let jacobian = transition.jacobian(state);
        let covariance = product(product(jacobian, dense.covariance), transposed(jacobian));
        // A lean along the optical axis is as likely as one across it, and shows as the camera turns or the bearing
        // changes.
        let shown = transition.shown_lean().hypot(next[0] - state[0]) * sigma_tilt;
        let sigma_tilt = (covariance[2][2] + shown * shown).sqrt();
        let [sigma_bearing, sigma_inverse_depth] = [covariance[0][0].sqrt(), covariance[1][1].sqrt()];
        let correlation = covariance[0][1] / (sigma_bearing * sigma_inverse_depth);

        let estimate = known.estimate;
        prop_assert!((estimate.bearing - next[0]).abs() < ESTIMATE * sigma_bearing);
        prop_assert!((estimate.inverse_depth_per_m - next[1]).abs() < ESTIMATE * sigma_inverse_depth);
        prop_assert!((estimate.tilt - next[2]).abs() < ESTIMATE * sigma_tilt);
        prop_assert!((estimate.sigma_bearing / sigma_bearing - 1.0).abs() < COVARIANCE);
        prop_assert!((estimate.sigma_inverse_depth_per_m / sigma_inverse_depth - 1.0).abs() < COVARIANCE);
        prop_assert!((estimate.sigma_tilt - sigma_tilt).abs() < COVARIANCE * sigma_tilt);
        prop_assert!((estimate.correlation - correlation).abs() < COVARIANCE);
    }
}
