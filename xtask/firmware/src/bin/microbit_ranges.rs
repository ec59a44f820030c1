//! QVGA rows to ranges, on a board with 16 KiB of RAM: both sides of two bars, in the smallest program for it.
#![no_std]
#![no_main]

use budget_firmware::Number;
use budget_firmware::small::{StrictTables, rows, setup, velocity_m_s};
use shutter_range::{Range, RangeStatus, Scalar, Translation};

budget_firmware::small_program!(run, StrictTables, strict);

fn run(ranger: &mut StrictTables) -> bool {
    let (Ok(setup), Ok(motion)) = (setup(), Translation::level(velocity_m_s())) else { return false };
    let mut near = 0;
    let mut take = |line| {
        let range = Range::strict(&setup, &motion, &line);
        // The bars are 1 and 2 m away.
        let is_near = range.estimate.inverse_depth_per_m > Number::ratio(2, 5);
        near += u8::from(is_near && range.status == RangeStatus::Ok);
    };
    let went_well = rows(|row, pixels| {
        let taken = ranger.scanned_row(&setup, row, pixels).is_ok();
        while let Some(line) = ranger.next_line() {
            take(line);
        }
        taken
    });
    ranger.end_frame(&setup);
    while let Some(line) = ranger.next_line() {
        take(line);
    }
    went_well && near == 4
}
