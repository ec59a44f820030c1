//! `Ranger::row` over frames of grey pixels.
#![no_std]
#![no_main]

use budget_firmware::{Number, file, frames};

budget_firmware::program!(run);

fn run() {
    let mut job = file::open();
    let setup = job.setup::<Number>();
    let columns = setup.camera().intrinsics().columns;
    frames::count(&mut job, &setup, columns.into(), |ranger, row, pixels| ranger.row(&setup, row, pixels));
}
