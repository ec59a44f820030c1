//! The smallest program from rows of pixels to ranges: compact rows, a camera that does not turn, and lines whose blur
//! is not measured and that are refused where they would have to be repaired.
#![no_std]
#![no_main]

use budget_firmware::small::{COLUMNS, ROWS, StrictTables, paint, setup, velocity_m_s};
use shutter_range::format::Compact;
use shutter_range::{Range, RangeStatus, Translation};

budget_firmware::small_program!(run, StrictTables, strict);

fn run(ranger: &mut StrictTables) -> bool {
    let (Ok(setup), Ok(motion)) = (setup(), Translation::level(velocity_m_s())) else { return false };
    let mut pixels = [0; COLUMNS as usize];
    for row in 0..ROWS {
        paint(row, &mut pixels);
        if ranger.row(&setup, row, Compact(&pixels)).is_err() {
            return false;
        }
    }
    ranger.end_frame(&setup);
    let range = ranger.next_line().map(|line| Range::strict(&setup, &motion, &line));
    range.is_some_and(|range| range.status == RangeStatus::Ok)
}
