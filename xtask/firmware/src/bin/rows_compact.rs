//! `Ranger::row` over frames of grey pixels, for a program that is to be small.
#![no_std]
#![no_main]

use budget_firmware::{Number, file, frames};
use shutter_range::format::Compact;

budget_firmware::program!(run);

fn run() {
    let mut job = file::open();
    let setup = job.setup::<Number>();
    let columns = setup.camera().intrinsics().columns;
    frames::count(&mut job, &setup, columns.into(), |ranger, row, pixels| ranger.row(&setup, row, Compact(pixels)));
}
