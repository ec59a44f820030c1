//! Rows of pixels to the ranges of a sequence of frames.
#![no_std]
#![no_main]

use budget_firmware::Number;
use budget_firmware::small::{COLUMNS, ROWS, Tables, motion, paint, setup};
use shutter_range::{Motion, RangeStatus, Scalar, Sequence};

budget_firmware::small_program!(run);

fn run(ranger: &mut Tables) -> bool {
    let (Ok(setup), Ok(motion)) = (setup(), motion()) else { return false };
    let mut sequence: Sequence<Number, 8> = Sequence::new();
    let interval_s = Number::ratio(1, 30);
    let mut pixels = [0; COLUMNS as usize];
    let mut known = false;
    for _ in 0..2 {
        for row in 0..ROWS {
            paint(row, &mut pixels);
            if ranger.row(&setup, row, &pixels).is_err() {
                return false;
            }
        }
        ranger.end_frame(&setup);
        sequence.frame(&setup, &motion, ranger, |range| known = matches!(range.status, RangeStatus::Ok));
        if sequence.advance(&setup, &motion.pose(interval_s), interval_s, motion.gravity()).is_err() {
            return false;
        }
    }
    known
}
