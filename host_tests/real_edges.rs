//! 197 upright edges of real street scenes, traced row by row: `data/README.md` says where they come from.

use std::collections::BTreeMap;

use serde::Deserialize;
use shutter_range::{
    Camera, Distortion, EdgePoint, Intrinsics, Line, Range, RangeStatus, Readout, Setup, Sigmas, Twist, Uncertainty,
};

use crate::scenes::{TENTH_DEGREE, line_of, q16};

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

/// 10 m/s to the left, 2400 rows a second, 600 px.
fn setup() -> Setup<f64> {
    let camera = Camera::new(Intrinsics::centred(640, 480, 600.0), Distortion::NONE).expect("sound");
    let readout = Readout::from_line_time_ps(480, 416_666_667, Default::default()).expect("sound");
    let uncertainty = Uncertainty::default().with_sigma_tilt(TENTH_DEGREE);
    Setup::new(camera, readout).expect("sound").with_uncertainty(uncertainty).expect("sound")
}

/// Each edge's reference and its range.
fn ranges() -> Vec<(Reference, Range<f64>)> {
    let setup = setup();
    let motion = Twist::level([-10.0, 0.0, 0.0]).expect("sound");
    let references: Vec<Reference> = serde_json::from_str(include_str!("data/real_edges.json")).expect("JSON");
    let mut lines: BTreeMap<usize, Vec<EdgePoint>> = BTreeMap::new();
    let mut reader = csv::Reader::from_reader(include_str!("data/real_edges.csv").as_bytes());
    for row in reader.deserialize() {
        let Row { row, column, line, sigma_px } = row.expect("a sound row");
        let point = EdgePoint::new(row, q16(column), setup.readout().row_time_ns(row));
        lines.entry(line).or_default().push(point.with_sigma_q16(q16(sigma_px) as u32));
    }
    let range = |reference: Reference| {
        let line: Line<16> = line_of(&lines[&reference.line]);
        let range = Range::from_line(&setup, &motion, &line);
        (reference, range)
    };
    references.into_iter().map(range).collect()
}

#[test]
fn report() {
    let ranges = ranges();
    let mut counts = BTreeMap::new();
    for (_, range) in &ranges {
        *counts.entry(range.status.name()).or_insert(0) += 1;
    }
    println!("{counts:?}");
    let class_a: Vec<_> = ranges.iter().filter(|(reference, _)| reference.class_a).collect();
    let mut errors = vec![];
    let mut z2 = 0.0;
    for (reference, range) in &class_a {
        let e = &range.estimate;
        let rel = e.inverse_depth_per_m / reference.inverse_depth_per_m - 1.0;
        let z = (e.inverse_depth_per_m - reference.inverse_depth_per_m) / e.sigma_inverse_depth_per_m;
        errors.push(rel.abs());
        z2 += z * z;
        println!(
            "{:3} {:8} err {:+.3} z {:+.2} sig {:.3} misfit {:.2} tilt {:.2} points {}",
            reference.line,
            range.status,
            rel,
            z,
            e.sigma_inverse_depth_per_m / e.inverse_depth_per_m,
            e.misfit,
            e.tilt / TENTH_DEGREE,
            range.points
        );
    }
    errors.sort_by(f64::total_cmp);
    println!("class A median {:.3} rms z {:.2}", errors[errors.len() / 2], (z2 / class_a.len() as f64).sqrt());
    let fine = ranges
        .iter()
        .filter(|(r, range)| {
            let d = range.depth(Sigmas(2.0));
            matches!(range.status, RangeStatus::Ok | RangeStatus::Far) && {
                let z = 1.0 / r.inverse_depth_per_m;
                d.nearest_m.is_some_and(|n| n / 1.1 <= z) && d.farthest_m.is_none_or(|f| f * 1.1 >= z)
            }
        })
        .count();
    println!("fine {fine} of {}", ranges.len());
}
