//! `Ranger::row` over frames in a pixel format.
#![no_std]
#![no_main]

use budget_firmware::frames::Table;
use budget_firmware::{Number, file, frames};
use shutter_range::format::{Bayer, ByteOrder, PixelFormat, Raw10, Rgb565, Strided};
use shutter_range::{RowError, Setup};

budget_firmware::program!(run);

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
    let mut job = file::open();
    let setup = job.setup::<Number>();
    let format = PixelFormat::ALL.get(usize::from(job.u16())).copied().expect("a format");
    let row_bytes = format.row_bytes(setup.camera().intrinsics().columns).expect("a row of this format");
    frames::count(&mut job, &setup, row_bytes, |ranger, row, bytes| take(ranger, &setup, row, format, bytes));
}
