//! The smallest program that takes pixels: its rows are scanned and no more, and what [`smallest`](./smallest.rs) leaves
//! out is left out as well.
#![no_std]
#![no_main]

use budget_firmware::small::{COLUMNS, ROWS, StrictTables, paint, setup, velocity_m_s};
use shutter_range::{Range, RangeStatus, Translation};

budget_firmware::small_program!(run, StrictTables, strict);

fn run(ranger: &mut StrictTables) -> bool {
    let (Ok(setup), Ok(motion)) = (setup(), Translation::level(velocity_m_s())) else { return false };
    let mut pixels = [0; COLUMNS as usize];
    for row in 0..ROWS {
        paint(row, &mut pixels);
        if ranger.scanned_row(&setup, row, &pixels).is_err() {
            return false;
        }
    }
    ranger.end_frame(&setup);
    let range = ranger.next_line().map(|line| Range::strict(&setup, &motion, &line));
    range.is_some_and(|range| range.status == RangeStatus::Ok)
}
