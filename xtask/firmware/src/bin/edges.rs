//! The smallest program from edge points to ranges.
#![no_std]
#![no_main]

use budget_firmware::small::{ROWS, Tables, motion, point, setup};
use shutter_range::RangeStatus;

budget_firmware::small_program!(run);

fn run(ranger: &mut Tables) -> bool {
    let (Ok(setup), Ok(motion)) = (setup(), motion()) else { return false };
    for row in 0..ROWS {
        if ranger.edge_point(&setup, point(&setup, row)).is_err() {
            return false;
        }
    }
    ranger.end_frame(&setup);
    ranger.next_range(&setup, &motion).is_some_and(|range| range.status == RangeStatus::Ok)
}
