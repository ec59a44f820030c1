//! `Line`: what is summed, refused and kept.

use shutter_range::{BoardRanger, DesktopRanger, EdgePoint, Line, OutOfOrder, SmallRanger};

use crate::projection::Scene;
use crate::scenes::{line_of, q16};

fn points(rows: impl IntoIterator<Item = u16>) -> Vec<EdgePoint> {
    rows.into_iter().map(|row| EdgePoint::new(row, q16(300.25 + f64::from(row) / 8.0), i64::from(row) * 1000)).collect()
}

/// Room for the rounding of columns and rows, which are below 10⁴, in double precision.
const ROUNDING_PX: f64 = 1e-9;

#[test]
fn knots_lie_on_a_straight_edge() {
    for step in [1, 3, 10, 37] {
        let line = line_of::<16>(&points((5..1005).step_by(step)));
        for sample in line.samples::<f64>() {
            assert!((sample.column_px - 300.25 - sample.row_px / 8.0).abs() < ROUNDING_PX);
            assert!((sample.time_s - sample.row_px * 1e-6).abs() < 1e-15, "rounding of a thousandth of a second");
            assert!((sample.spread.column_px - sample.spread.row_px / 8.0).abs() < ROUNDING_PX);
        }
    }
}

#[test]
fn spread_is_the_standard_deviation_of_the_rows() {
    let line = line_of::<16>(&points(0..512));
    for sample in line.samples::<f64>() {
        // 32 rows each.
        let expected = ((32.0_f64 * 32.0 - 1.0) / 12.0).sqrt();
        assert!((sample.spread.row_px - expected).abs() < ROUNDING_PX);
    }
}

#[test]
fn a_full_list_doubles_its_span_and_loses_nothing() {
    let mut line: Line<8> = Line::new(points([0])[0]);
    for (count, point) in points(1..4096).into_iter().enumerate() {
        line.push(point).expect("rows in order");
        assert_eq!(usize::from(line.points()), count + 2);
        assert!(line.samples::<f64>().count() <= 8);
    }
    assert_eq!(line.samples::<f64>().count(), 8);
    let mean_row: f64 = line.samples::<f64>().map(|sample| sample.row_px).sum::<f64>() / 8.0;
    assert!((mean_row - 2047.5).abs() < ROUNDING_PX);
}

#[test]
fn noise_of_a_knot_falls_with_the_root_of_its_points() {
    let points: Vec<_> = points(0..64).into_iter().map(|point| point.with_sigma_q16(6554)).collect();
    let line = line_of::<8>(&points);
    for sample in line.samples::<f64>() {
        // The root is rounded down to 1/65536 px of a sum of 0.28 px.
        assert!((sample.sigma_px / (0.1 / 8.0_f64.sqrt()) - 1.0).abs() < 1e-3);
    }
}

#[test]
fn rows_from_below_give_the_same_means() {
    let down = line_of::<16>(&points(0..256));
    let mirrored: Vec<_> = (0..256)
        .map(|step| EdgePoint::new(255 - step, q16(300.25 + f64::from(255 - step) / 8.0), i64::from(step) * 1000))
        .collect();
    let up = line_of::<16>(&mirrored);
    let rows = |line: &Line<16>| line.samples::<f64>().map(|sample| sample.row_px).collect::<Vec<_>>();
    let mut reversed = rows(&up);
    reversed.reverse();
    assert_eq!(rows(&down), reversed);
    assert!(up.samples::<f64>().all(|sample| (sample.column_px - 300.25 - sample.row_px / 8.0).abs() < ROUNDING_PX));
}

#[test]
fn repeated_and_returning_rows_are_handed_back() {
    let [first, second, third] = [10, 20, 30].map(|row| points([row])[0]);
    let mut line: Line<4> = Line::new(second);
    assert_eq!(line.push(second), Err(OutOfOrder(second)));
    line.push(third).expect("downwards");
    let late = EdgePoint { time_ns: i64::from(second.row) * 2000, ..first };
    assert_eq!(line.push(late), Err(OutOfOrder(late)), "turned back");
    let early = EdgePoint { time_ns: 0, ..points([40])[0] };
    assert_eq!(line.push(early), Err(OutOfOrder(early)), "time runs backwards");
    assert_eq!(line.points(), 2);
    assert_eq!((line.first().row, line.last().row), (20, 30));
}

#[test]
fn the_largest_image_fits() {
    let rows = (0..u16::MAX).map(|row| EdgePoint {
        sigma_q16: u32::MAX,
        width_q8: u16::MAX,
        ..EdgePoint::new(row, if row % 2 == 0 { i32::MAX } else { i32::MIN }, 3_600_000_000_000)
    });
    let line = line_of::<4>(&rows.collect::<Vec<_>>());
    assert_eq!(line.points(), u16::MAX);
    // In the last knot of 16383 rows one column of 32768 px is not cancelled: 2 px. A sigma of 256 px over √16384 rows:
    // 2 px.
    assert!(line.samples::<f64>().all(|sample| sample.column_px.abs() < 3.0 && sample.sigma_px > 1.0));
    assert_eq!(line.mean_width_px::<f64>(), Some(f64::from(u16::MAX) / 256.0));
}

#[test]
fn widths_are_averaged() {
    let points: Vec<_> = points(0..100).into_iter().map(|point| EdgePoint { width_q8: 384, ..point }).collect();
    assert_eq!(line_of::<16>(&points).mean_width_px::<f32>(), Some(1.5));
    assert_eq!(line_of::<16>(&Scene::vga().points()).mean_width_px::<f32>(), None);
}

#[test]
fn sizes_in_memory_are_as_documented() {
    assert_eq!(size_of::<EdgePoint>(), 24);
    // Documentation of `Ranger`.
    type Small = shutter_range::Ranger<16, 12, 32>;
    assert!(size_of::<Small>() <= 16 * (176 + 40 * 12) + 24 * 32 + 256, "{}", size_of::<Small>());
    type Single = shutter_range::Ranger<1, 12, 32>;
    assert!(size_of::<Single>() <= 176 + 40 * 12 + 24 * 32 + 256, "{}", size_of::<Single>());
    // And those of the usual capacities, in bytes.
    let usual = [size_of::<SmallRanger>(), size_of::<BoardRanger>(), size_of::<DesktopRanger>()];
    println!("{usual:?}");
    assert!(usual.into_iter().zip([4_600, 11_456, 800_000]).all(|(size, promised)| size <= promised), "{usual:?}");
    // Documentation of `Sequence`.
    type Sequence = shutter_range::Sequence<f32, 16>;
    assert!(size_of::<Sequence>() <= 16 * 208 + 48, "{}", size_of::<Sequence>());
}
