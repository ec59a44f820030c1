//! QVGA rows of the simulator to ranges, on a board with 16 KiB of RAM: both sides of two bars.
#![no_std]
#![no_main]

use budget_firmware::Number;
use budget_firmware::small::{Tables, motion, rows, setup};
use shutter_range::{Range, RangeStatus, Scalar};

budget_firmware::small_program!(run);

fn run(ranger: &mut Tables) -> bool {
    let (Ok(setup), Ok(motion)) = (setup(), motion()) else { return false };
    let mut near = 0;
    let mut take = |range: Range<Number>| {
        // The bars are 1 and 2 m away.
        let is_near = range.estimate.inverse_depth_per_m > Number::ratio(2, 5);
        near += u8::from(is_near && range.status == RangeStatus::Ok);
    };
    let went_well = rows(|row, pixels| {
        let taken = ranger.row(&setup, row, pixels).is_ok();
        while let Some(range) = ranger.next_range(&setup, &motion) {
            take(range);
        }
        taken
    });
    ranger.end_frame(&setup);
    while let Some(range) = ranger.next_range(&setup, &motion) {
        take(range);
    }
    went_well && near == 4
}
