//! The smallest program that takes pixels: its rows are scanned one by one, and the points tracked as those of any
//! detector of edges, with what [`smallest`](./smallest.rs) leaves out left out as well.
#![no_std]
#![no_main]

use budget_firmware::small::{COLUMNS, ROWS, StrictTables, paint, setup, velocity_m_s};
use shutter_range::{Range, RangeStatus, Scanner, Translation};

budget_firmware::small_program!(run, StrictTables, strict);

fn run(ranger: &mut StrictTables) -> bool {
    let (Ok(setup), Ok(motion)) = (setup(), Translation::level(velocity_m_s())) else { return false };
    let (mut scanner, mut pixels) = (Scanner::new(), [0; COLUMNS as usize]);
    for row in 0..ROWS {
        paint(row, &mut pixels);
        let (time_ns, mut went_well) = (setup.readout().row_time_ns(row), true);
        scanner.scan(&pixels, |point| went_well &= ranger.edge_point(&setup, point.at(row, time_ns)).is_ok());
        if !went_well || ranger.end_row(&setup, row).is_err() {
            return false;
        }
    }
    ranger.end_frame(&setup);
    let range = ranger.next_line().map(|line| Range::strict(&setup, &motion, &line));
    range.is_some_and(|range| range.status == RangeStatus::Ok)
}
