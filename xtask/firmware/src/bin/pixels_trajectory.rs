//! Rows of pixels to ranges, with the motion from stamped samples of odometry, gyroscope and gravity.
#![no_std]
#![no_main]

use budget_firmware::Number;
use budget_firmware::small::{COLUMNS, ROWS, Tables, paint, setup};
use shutter_range::{RangeStatus, Scalar, SensorClock, StampConvention, Trajectory, TrajectoryConfig};

budget_firmware::small_program!(run);

/// Samples every 5 ms from before the frame to its end.
fn drive() -> Trajectory<Number, 10> {
    let clock = SensorClock { offset_ns: 0, max_gap_ns: 10_000_000 };
    let mut trajectory = Trajectory::new(TrajectoryConfig {
        velocity: StampConvention::MeanSincePrevious(clock),
        rate: Some(StampConvention::Instant(clock)),
        gravity: Some(clock),
    });
    let zero = Number::ZERO;
    for k in 0..10 {
        let stamp_ns = core::hint::black_box(k * 5_000_000);
        let _ = trajectory.push_velocity(stamp_ns, [Number::ratio(-3, 2), zero, zero]);
        let _ = trajectory.push_rate(stamp_ns, [zero, Number::ratio(1, 100), zero]);
        let _ = trajectory.push_gravity(stamp_ns, [zero, Number::ratio(981, 100), zero]);
    }
    trajectory
}

fn run(ranger: &mut Tables) -> bool {
    let Ok(setup) = setup() else { return false };
    let mut pixels = [0; COLUMNS as usize];
    for row in 0..ROWS {
        paint(row, &mut pixels);
        if ranger.row(&setup, row, &pixels).is_err() {
            return false;
        }
    }
    ranger.end_frame(&setup);
    let trajectory = drive();
    let Ok(motion) = trajectory.frame(6_000_000, 0..=setup.readout().row_time_ns(ROWS)) else { return false };
    ranger.next_range(&setup, &motion).is_some_and(|range| range.status == RangeStatus::Ok)
}
