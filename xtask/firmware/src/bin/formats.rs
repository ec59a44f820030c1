//! `Ranger::row` over frames in a pixel format: prints the instructions and the stack of each frame, and its dearest row.
#![no_std]
#![no_main]

use budget_firmware::Number;
use budget_firmware::counter::Counter;
use budget_firmware::file;
use budget_firmware::stack::Painted;
use semihosting::println;
use shutter_range::format::{Bayer, ByteOrder, PixelFormat, Raw10, Rgb565, Strided};
use shutter_range::{Ranger, RowError, Setup};

budget_firmware::program!(run);

type Table = Ranger<16, 16, 64>;

/// With the type of its format, as firmware does that knows its sensor.
fn take(
    ranger: &mut Table,
    setup: &Setup<Number>,
    row: u16,
    format: PixelFormat,
    bytes: &[u8],
) -> Result<(), RowError> {
    match format {
        PixelFormat::Yuyv => ranger.row(setup, row, Strided::luma_first(bytes)),
        PixelFormat::Rgb565Le => ranger.row(setup, row, Rgb565::new(bytes, ByteOrder::LittleEndian)),
        PixelFormat::Grey10Packed => ranger.row(setup, row, Raw10::new(bytes)),
        PixelFormat::Bayer8 => ranger.row(setup, row, Bayer::new(bytes, row)),
        _ => ranger.row(setup, row, bytes),
    }
}

fn run() {
    let counter = Counter::new();
    let mut job = file::open();
    let setup = job.setup::<Number>();
    let (columns, rows) = (setup.camera().intrinsics().columns, setup.readout().rows());
    let format = PixelFormat::ALL.get(usize::from(job.u16())).copied().expect("a format");
    let mut bytes = [0_u8; 4096];
    let row_bytes = format.row_bytes(columns).expect("a row of this format");
    let bytes = bytes.get_mut(..row_bytes).expect("no wider image");
    for _ in 0..job.u16() {
        let mut ranger = Table::new();
        let painted = Painted::below(1 << 16);
        let (mut all, mut most, mut dearest, mut lines) = (0, 0, 0, 0_u32);
        for row in 0..rows {
            job.bytes(bytes);
            let (result, instructions) = counter.count(|| take(&mut ranger, &setup, row, format, bytes));
            result.expect("rows in order");
            all += instructions;
            if instructions > most {
                (most, dearest) = (instructions, row);
            }
            while ranger.next_line().is_some() {
                lines += 1;
            }
        }
        println!("frame {all} {most} {dearest} {lines} {}", painted.used());
    }
}
