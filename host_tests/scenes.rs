//! What tests share: the reference edges, and setups, motions, points and lines of a [`Scene`].

use proptest::test_runner::{Config, RngSeed};
use serde::Deserialize;
use shutter_range::{
    Camera, Distortion, EdgePoint, Intrinsics, Line, Range, Readout, ReadoutDirection, Sample, Scalar, Setup, Twist,
    Uncertainty,
};

use crate::projection::Scene;

/// One edge of `data/lines.json`, as `data/make_lines.py` writes it.
#[derive(Clone, Deserialize)]
pub(crate) struct ReferenceLine {
    pub(crate) kind: String,
    camera: ReferenceCamera,
    velocity_m_s: [f64; 3],
    rate_rad_s: [f64; 3],
    gravity: [f64; 3],
    pub(crate) truth: Truth,
    pub(crate) rows: Vec<u16>,
    pub(crate) columns: Vec<f64>,
}

#[derive(Clone, Deserialize)]
struct ReferenceCamera {
    cols: u16,
    rows: u16,
    fx: f64,
    cx: f64,
    cy: f64,
    readout_s: f64,
}

#[derive(Clone, Deserialize)]
pub(crate) struct Truth {
    pub(crate) bearing: f64,
    pub(crate) depth_m: f64,
    pub(crate) distance_m: f64,
}

pub(crate) fn reference_lines() -> Vec<ReferenceLine> {
    serde_json::from_str(include_str!("data/lines.json")).expect("lines.json is as make_lines.py writes it")
}

impl ReferenceLine {
    pub(crate) fn scene(&self) -> Scene {
        let camera = &self.camera;
        Scene {
            columns: camera.cols,
            rows: camera.rows,
            focal_px: camera.fx,
            cx: camera.cx,
            cy: camera.cy,
            readout_s: camera.readout_s,
            velocity_m_s: self.velocity_m_s,
            rate_rad_s: self.rate_rad_s,
            gravity: self.gravity,
            bearing: self.truth.bearing,
            depth_m: self.truth.depth_m,
            tilt: 0.0,
        }
    }

    /// A sample for each point, exact and with a noise of 0.1 px.
    pub(crate) fn samples<S: Scalar>(&self) -> Vec<Sample<S>> {
        let scene = self.scene();
        let sample = |(&row, &column): (&u16, &f64)| {
            let time_s = S::from_f64(scene.time_s(row));
            Sample::point(S::from_f64(column), S::from_i32(i32::from(row)), time_s, S::from_f64(0.1))
        };
        self.rows.iter().zip(&self.columns).map(sample).collect()
    }

    pub(crate) fn points(&self) -> Vec<EdgePoint> {
        let scene = self.scene();
        self.rows.iter().zip(&self.columns).map(|(&row, &column)| scene.point_at(row, column)).collect()
    }
}

impl Scene {
    pub(crate) fn setup<S: Scalar>(&self) -> Setup<S> {
        self.setup_with(Uncertainty::NONE)
    }

    pub(crate) fn setup_with<S: Scalar>(&self, uncertainty: Uncertainty<S>) -> Setup<S> {
        self.setup_read(uncertainty, ReadoutDirection::TopToBottom)
    }

    pub(crate) fn setup_read<S: Scalar>(&self, uncertainty: Uncertainty<S>, direction: ReadoutDirection) -> Setup<S> {
        let number = S::from_f64;
        let focal = number(self.focal_px);
        let (cx, cy) = (number(self.cx), number(self.cy));
        let intrinsics = Intrinsics { columns: self.columns, rows: self.rows, fx: focal, fy: focal, cx, cy };
        let camera = Camera::new(intrinsics, Distortion::NONE).expect("sound camera");
        let line_time_ps = (self.readout_s * 1e12 / f64::from(self.rows)).round() as u64;
        let readout = Readout::from_line_time_ps(self.rows, line_time_ps, direction).expect("sound readout");
        Setup::new(camera, readout).expect("sound").with_uncertainty(uncertainty).expect("sound setup")
    }

    pub(crate) fn motion<S: Scalar>(&self) -> Twist<S> {
        let vector = |v: [f64; 3]| v.map(S::from_f64);
        Twist::new(vector(self.velocity_m_s), vector(self.rate_rad_s), vector(self.gravity)).expect("sound motion")
    }

    pub(crate) fn point_at(&self, row: u16, column_px: f64) -> EdgePoint {
        EdgePoint::new(row, q16(column_px), (self.time_s(row) * 1e9).round() as i64)
    }

    /// The exact point of the edge on every row that shows it.
    pub(crate) fn points(&self) -> Vec<EdgePoint> {
        self.visible_rows().into_iter().map(|row| self.point_at(row, self.column(row))).collect()
    }
}

pub(crate) fn q16(column_px: f64) -> i32 {
    (column_px * 65536.0).round() as i32
}

pub(crate) fn line_of<const KNOTS: usize>(points: &[EdgePoint]) -> Line<KNOTS> {
    let (first, rest) = points.split_first().expect("at least one point");
    let mut line = Line::new(*first);
    for point in rest {
        line.push(*point).expect("rows in order");
    }
    line
}

/// The range of points of a scene through a line of 16 knots.
pub(crate) fn range_of<S: Scalar>(scene: &Scene, uncertainty: Uncertainty<S>, points: &[EdgePoint]) -> Range<S> {
    Range::from_line(&scene.setup_with(uncertainty), &scene.motion(), &line_of::<16>(points))
}

/// An uncertainty of nothing but tilt.
pub(crate) fn tilt_of<S: Scalar>(sigma_tilt: f64) -> Uncertainty<S> {
    Uncertainty::NONE.with_sigma_tilt(S::from_f64(sigma_tilt))
}

/// 0.1° as a slope.
pub(crate) const TENTH_DEGREE: f64 = 0.1 * std::f64::consts::PI / 180.0;
pub(crate) const HALF_DEGREE: f64 = 5.0 * TENTH_DEGREE;

/// Properties are tried on the same cases in every run.
pub(crate) fn seeded(cases: u32) -> Config {
    Config { cases, failure_persistence: None, rng_seed: RngSeed::Fixed(20_260_101), ..Config::default() }
}
