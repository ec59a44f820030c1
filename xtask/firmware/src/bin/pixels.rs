//! The smallest program from rows of pixels to ranges.
#![no_std]
#![no_main]

use budget_firmware::small::{COLUMNS, ROWS, Tables, motion, paint, setup};
use shutter_range::RangeStatus;

budget_firmware::small_program!(run);

fn run(ranger: &mut Tables) -> bool {
    let (Ok(setup), Ok(motion)) = (setup(), motion()) else { return false };
    let mut pixels = [0; COLUMNS as usize];
    for row in 0..ROWS {
        paint(row, &mut pixels);
        if ranger.row(&setup, row, &pixels).is_err() {
            return false;
        }
    }
    ranger.end_frame(&setup);
    ranger.next_range(&setup, &motion).is_some_and(|range| range.status == RangeStatus::Ok)
}
