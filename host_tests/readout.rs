//! `Readout`: constructors that agree, and times.

use proptest::prelude::*;
use shutter_range::{Readout, ReadoutDirection};

use crate::scenes::seeded;

const DOWN: ReadoutDirection = ReadoutDirection::TopToBottom;

#[test]
fn the_constructors_agree() {
    let by_frame = Readout::from_frame_readout_ns(1080, 20_000_000, DOWN).expect("sound");
    let by_line = Readout::from_line_time_ps(1080, 18_518_519, DOWN).expect("sound");
    assert_eq!(by_frame, by_line);
}

/// Rows, line length in clocks, clock in Hz, sensor rows for the rows of the image, and the line time in ps.
#[test]
fn line_lengths_of_real_sensors_give_their_line_times() {
    let cases = [
        ("OV7725 QVGA at 48 MHz, two clocks a pixel", 240, 2 * 576, 48_000_000, 240, 24_000_000),
        ("OV2640 UXGA at 36 MHz", 1200, 1922, 36_000_000, 1200, 53_388_889),
        ("OV5640 VGA: 960 sensor rows", 480, 1896, 61_440_000, 960, 61_718_750),
        ("GC2145 VGA: 1216 sensor rows", 480, 277, 10_000_000, 1216, 70_173_333),
    ];
    for (name, rows, clocks, hertz, sensor_rows, line_time_ps) in cases {
        let readout = Readout::from_line_length(rows, clocks, hertz, sensor_rows, DOWN).expect(name);
        assert_eq!(readout.line_time_ps(), line_time_ps, "{name}");
    }
}

#[test]
fn nonsense_is_refused_by_name() {
    let name = |result: Result<Readout, shutter_range::ParameterError>| result.expect_err("nonsense").parameter;
    assert_eq!(name(Readout::from_line_time_ps(0, 1000, DOWN)), "rows");
    assert_eq!(name(Readout::from_line_time_ps(480, 0, DOWN)), "line_time_ps");
    assert_eq!(name(Readout::from_line_time_ps(480, u64::MAX, DOWN)), "line_time_ps");
    assert_eq!(name(Readout::from_frame_readout_ns(0, 1000, DOWN)), "rows");
    assert_eq!(name(Readout::from_frame_readout_ns(480, 0, DOWN)), "frame_readout_ns");
    assert_eq!(name(Readout::from_frame_readout_ns(480, u64::MAX, DOWN)), "frame_readout_ns");
    assert_eq!(name(Readout::from_line_length(480, 0, 1000, 480, DOWN)), "line_time_ps");
    assert_eq!(name(Readout::from_line_length(480, 784, 0, 480, DOWN)), "clock_hz × rows");
    assert_eq!(name(Readout::from_line_length(480, 784, 1, 480, DOWN)), "line_time_ps");
    assert_eq!(name(Readout::from_line_length(480, 784, 1000, 0, DOWN)), "sensor_rows");
}

#[test]
fn rows_outside_count_as_the_nearest_inside() {
    let readout = Readout::from_line_time_ps(480, 1_000_000, DOWN).expect("sound");
    assert_eq!(readout.row_time_ns(u16::MAX), readout.row_time_ns(479));
}

proptest! {
    #![proptest_config(seeded(256))]

    /// Never an accumulated rounding: every row is within half a nanosecond, from either side.
    #[test]
    fn times_are_exact(rows in 1..3000_u16, line_time_ps in 1..1_000_000_000_u64, row in 0..3000_u16) {
        let row = row % rows;
        let down = Readout::from_line_time_ps(rows, line_time_ps, DOWN).expect("sound");
        let up = Readout::from_line_time_ps(rows, line_time_ps, ReadoutDirection::BottomToTop).expect("sound");
        let exact_ns = f64::from(row) * line_time_ps as f64 / 1000.0;
        // Half a nanosecond, and the rounding of `exact_ns`.
        prop_assert!((down.row_time_ns(row) as f64 - exact_ns).abs() <= 0.5001);
        prop_assert_eq!(up.row_time_ns(rows - 1 - row), down.row_time_ns(row));
    }
}
