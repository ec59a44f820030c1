//! 197 upright edges of real street scenes, traced row by row: `data/README.md` says where they come from.

use std::collections::BTreeMap;

use serde::Deserialize;
use shutter_range::{
    Camera, Distortion, EdgePoint, Intrinsics, Line, Range, RangeStatus, Readout, Setup, Sigmas, Twist, Uncertainty,
};

use crate::scenes::{TENTH_DEGREE, line_of, q16};
use crate::score::rms;

/// What motion stereo says of an edge.
#[derive(Clone, Deserialize)]
struct Reference {
    line: usize,
    inverse_depth_per_m: f64,
    class_a: bool,
}

#[derive(Deserialize)]
struct Row {
    row: u16,
    column: f64,
    line: usize,
    sigma_px: f64,
}

/// What is known of all that is not the edge's own: the reference rests on the same speed, readout and focal length, so
/// that their errors cancel.
fn exactly() -> Uncertainty<f64> {
    let default = Uncertainty::<f64>::default();
    Uncertainty::NONE.with_sigma_tilt(TENTH_DEGREE).with_edge_roughness_px(default.edge_roughness_px)
}

/// 10 m/s to the left, 2400 rows a second, 600 px.
fn setup(uncertainty: Uncertainty<f64>) -> Setup<f64> {
    let camera = Camera::new(Intrinsics::centred(640, 480, 600.0), Distortion::NONE).expect("sound");
    let readout = Readout::from_line_time_ps(480, 416_666_667, Default::default()).expect("sound");
    Setup::new(camera, readout).expect("sound").with_uncertainty(uncertainty).expect("sound setup")
}

/// An edge's reference and its range.
struct Edge {
    reference: Reference,
    range: Range<f64>,
}

impl Edge {
    fn all(uncertainty: Uncertainty<f64>) -> Vec<Self> {
        let setup = setup(uncertainty);
        let motion = Twist::level([-10.0, 0.0, 0.0]).expect("sound");
        let references: Vec<Reference> = serde_json::from_str(include_str!("data/real_edges.json")).expect("JSON");
        let mut lines: BTreeMap<usize, Vec<EdgePoint>> = BTreeMap::new();
        let mut reader = csv::Reader::from_reader(include_str!("data/real_edges.csv").as_bytes());
        for row in reader.deserialize() {
            let Row { row, column, line, sigma_px } = row.expect("a sound row");
            let point = EdgePoint::new(row, q16(column), setup.readout().row_time_ns(row));
            lines.entry(line).or_default().push(point.with_sigma_q16(q16(sigma_px) as u32));
        }
        let edge = |reference: Reference| {
            let line: Line<16> = line_of(&lines[&reference.line]);
            Self { range: Range::from_line(&setup, &motion, &line), reference }
        };
        references.into_iter().map(edge).collect()
    }

    fn off_per_m(&self) -> f64 {
        self.range.estimate.inverse_depth_per_m - self.reference.inverse_depth_per_m
    }

    fn relative_error(&self) -> f64 {
        self.off_per_m() / self.reference.inverse_depth_per_m
    }

    fn normal_error(&self) -> f64 {
        self.off_per_m() / self.range.estimate.sigma_inverse_depth_per_m
    }

    /// `ok` or `far` with the truth between the bounds at two sigma, widened by the tenth that the reference may be
    /// off.
    fn is_right(&self) -> bool {
        let depth = self.range.depth(Sigmas(2.0));
        let truth_m = 1.0 / self.reference.inverse_depth_per_m;
        matches!(self.range.status, RangeStatus::Ok | RangeStatus::Far)
            && depth.nearest_m.is_some_and(|nearest_m| nearest_m / 1.1 <= truth_m)
            && depth.farthest_m.is_none_or(|farthest_m| farthest_m * 1.1 >= truth_m)
    }
}

/// Of an even count the mean of the two in the middle.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len().is_multiple_of(2) { 0.5 * (values[half - 1] + values[half]) } else { values[half] }
}

/// At least 80 rows, near the row where the reference holds.
fn class_a(uncertainty: Uncertainty<f64>) -> Vec<Edge> {
    let edges: Vec<_> = Edge::all(uncertainty).into_iter().filter(|edge| edge.reference.class_a).collect();
    assert_eq!(edges.len(), 14);
    for edge in &edges {
        let (range, relative, normal) = (&edge.range, edge.relative_error(), edge.normal_error());
        let Range { status, estimate, points, .. } = range;
        println!(
            "line {:3} {status:8} off by {:+5.1} %, {normal:+.2} sigma, misfit {:.1}, {points} points",
            edge.reference.line,
            100.0 * relative,
            estimate.misfit
        );
    }
    edges
}

#[test]
fn the_best_get_a_distance() {
    let edges = class_a(exactly());
    let ok = edges.iter().filter(|edge| edge.range.status == RangeStatus::Ok).count();
    assert!(ok >= 13, "{ok} of 14 are ok");
}

#[test]
fn the_best_are_right() {
    let edges = class_a(exactly());
    let error = median(edges.iter().map(|edge| edge.relative_error().abs()).collect());
    println!("median error {:.2} %", 100.0 * error);
    assert!(error <= 0.04, "{error}");
}

/// Neither too small a sigma nor one that is blown up.
fn assert_honest(uncertainty: Uncertainty<f64>) {
    let edges = class_a(uncertainty);
    let inside = edges.iter().filter(|edge| edge.normal_error().abs() <= 2.0).count();
    let rms = rms(edges.iter().map(Edge::normal_error));
    println!("{inside} of 14 inside two sigma, RMS of error/sigma {rms:.2}");
    assert!(inside >= 12, "{inside} of 14 are inside two sigma");
    assert!((0.6..=1.2).contains(&rms), "RMS of error/sigma {rms}");
}

/// With all else known as well as a careful amateur does.
#[test]
fn the_best_have_an_honest_sigma() {
    assert_honest(Uncertainty::default().with_sigma_tilt(TENTH_DEGREE));
}

/// With all else known exactly: then the reference's own error shows, too.
#[test]
fn the_best_have_an_honest_sigma_where_all_else_is_known() {
    assert_honest(exactly());
}

#[test]
fn most_of_all_are_right() {
    for uncertainty in [exactly(), Uncertainty::default().with_sigma_tilt(TENTH_DEGREE)] {
        let edges = Edge::all(uncertainty);
        let mut counts = BTreeMap::new();
        for edge in &edges {
            *counts.entry(edge.range.status.name()).or_insert(0) += 1;
        }
        let right = edges.iter().filter(|edge| edge.is_right()).count();
        println!("{counts:?}, {right} of {} right", edges.len());
        assert!(edges.len() == 197 && right >= 170, "{right} of {} are right", edges.len());
    }
}
