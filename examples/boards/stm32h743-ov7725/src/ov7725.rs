//! What the firmware sets in an OV7725; its timing it reads back through the library.

use embassy_time::Timer;
use embedded_hal::i2c::I2c;
use shutter_range::sensor::SensorError;

const ADDRESS: u8 = 0x21;
/// COM7: all registers as after power on.
const RESET: [u8; 2] = [0x12, 0x80];

/// Registers and values, in their order.
const QVGA_YUYV: [[u8; 2]; 10] = [
    [0x12, 0x40], // COM7: QVGA, YUV
    [0x0C, 0x10], // COM3: luma first
    [0x11, 0x01], // CLKRC: the clock divided by 4
    [0x0D, 0x41], // COM4: times 4
    [0x17, 0x3F], // the window: first column and width,
    [0x18, 0x50],
    [0x19, 0x03], // first row and height
    [0x1A, 0x78],
    [0x29, 0x50], // the image, 320 × 240
    [0x2C, 0x78],
];

/// Resets the sensor, and sets its window and its format. Automatic exposure is on.
pub(crate) async fn initialise<B: I2c>(bus: &mut B) -> Result<(), SensorError<B::Error>> {
    bus.write(ADDRESS, &RESET).map_err(SensorError::Bus)?;
    Timer::after_millis(5).await;
    for setting in QVGA_YUYV {
        bus.write(ADDRESS, &setting).map_err(SensorError::Bus)?;
    }
    Ok(())
}
