//! Points of something else within a line: a few are left out, and many make a line that is no straight edge.

use shutter_range::{EdgePoint, Range, RangeStatus, Uncertainty};

use crate::projection::Scene;
use crate::scenes::{q16, range_of};

const ROWS_PER_KNOT: u16 = 32;

/// The range of an edge of 15 knots of 32 rows, some of which belong to something that is so many pixels to the right.
fn range_with(foreign_knots: &[(u16, f64)]) -> Range<f64> {
    let scene = Scene::vga();
    let mut points = scene.points();
    assert_eq!(points.len(), 480, "15 knots");
    for point in &mut points {
        let knot = point.row / ROWS_PER_KNOT;
        let off_px = foreign_knots.iter().find(|(foreign, _)| *foreign == knot).map_or(0.0, |(_, off_px)| *off_px);
        *point = EdgePoint { column_q16: point.column_q16 + q16(off_px), ..*point };
    }
    range_of(&scene, Uncertainty::NONE, &points)
}

#[test]
fn points_of_something_else_are_left_out_and_not_counted_as_used() {
    for foreign in [&[(3, 3.0)][..], &[(4, 3.0), (5, 3.0)], &[(2, -2.0), (7, 2.0), (12, 4.0), (13, -3.0)]] {
        let range = range_with(foreign);
        assert_eq!(range.status, RangeStatus::Ok, "{foreign:?}: {range:?}");
        assert_eq!(range.points, 480);
        assert_eq!(range.points_used, 480 - ROWS_PER_KNOT * foreign.len() as u16, "{foreign:?}");
        // What is left is exact but for 1/65536 px and the curve within a knot.
        let error = range.estimate.inverse_depth_per_m * 2.0 - 1.0;
        assert!(error.abs() < 1e-4, "{foreign:?}: {error}");
    }
}

/// A third is five of 15 knots. Three that are far off are left out first; the three that are then found would make
/// six.
#[test]
fn more_than_a_third_of_a_line_is_never_left_out() {
    let offsets_px = [40.0, -2.0, -50.0, 3.0, 60.0, -2.5];
    for foreign in [[0, 3, 6, 8, 11, 14], [1, 2, 5, 9, 10, 13]] {
        let foreign: Vec<_> = foreign.into_iter().zip(offsets_px).collect();
        let range = range_with(&foreign);
        assert!(range.points_used >= 480 / 3 * 2, "{foreign:?}: {}", range.points_used);
        assert_eq!(range.status, RangeStatus::Bent, "{foreign:?}: {range:?}");
    }
}
