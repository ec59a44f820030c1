//! QVGA rows to lines, on a board with 16 KiB of RAM: both sides of two bars.
#![no_std]
#![no_main]

use budget_firmware::small::{Tables, rows, setup};

budget_firmware::small_program!(run);

fn run(ranger: &mut Tables) -> bool {
    let Ok(setup) = setup() else { return false };
    let mut lines = 0;
    let went_well = rows(|row, pixels| {
        let taken = ranger.row(&setup, row, pixels).is_ok();
        while ranger.next_line().is_some() {
            lines += 1;
        }
        taken
    });
    ranger.end_frame(&setup);
    while ranger.next_line().is_some() {
        lines += 1;
    }
    went_well && lines == 4
}
