//! `Ranger::row` over frames of pixels: prints the instructions and the stack of each frame, and its dearest row.
#![no_std]
#![no_main]

use budget_firmware::Number;
use budget_firmware::counter::Counter;
use budget_firmware::file;
use budget_firmware::stack::Painted;
use semihosting::println;
use shutter_range::Ranger;

budget_firmware::program!(run);

fn run() {
    let counter = Counter::new();
    let mut job = file::open();
    let setup = job.setup::<Number>();
    let (columns, rows) = (setup.camera().intrinsics().columns, setup.readout().rows());
    let mut pixels = [0_u8; 2048];
    let pixels = pixels.get_mut(..columns.into()).expect("no wider image");
    for _ in 0..job.u16() {
        let mut ranger: Ranger<16, 16, 64> = Ranger::new();
        let painted = Painted::below(1 << 16);
        let (mut all, mut most, mut dearest, mut lines) = (0, 0, 0, 0_u32);
        for row in 0..rows {
            job.bytes(pixels);
            let (result, instructions) = counter.count(|| ranger.row(&setup, row, &*pixels));
            result.expect("rows in order");
            all += instructions;
            if instructions > most {
                (most, dearest) = (instructions, row);
            }
            while ranger.next_line().is_some() {
                lines += 1;
            }
        }
        let stack = painted.used();
        ranger.end_frame(&setup);
        while ranger.next_line().is_some() {
            lines += 1;
        }
        println!("frame {all} {most} {dearest} {lines} {stack}");
    }
}
