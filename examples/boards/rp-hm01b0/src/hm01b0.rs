//! What the firmware sets in an HM01B0; its timing it reads back through the library.

use embedded_hal::i2c::I2c;
use shutter_range::sensor::SensorError;

const ADDRESS: u8 = 0x24;

/// Registers and values, in their order.
const QVGA_AT_2_HZ: [(u16, u8); 9] = [
    (0x3010, 1),    // 324 × 244 pixels
    (0x0383, 1),    // every column
    (0x0387, 1),    // every row
    (0x0390, 0),    // no binning
    (0x0340, 0x01), // 266 lines a frame
    (0x0341, 0x0A),
    (0x0342, 0x0B), // 3000 clocks a line
    (0x0343, 0xB8),
    (0x3067, 0), // the clock of the board
];
/// Its lower two bits divide the clock by 8 where they are zero: 1.56 MHz, 1.92 ms a line: time for a Cortex-M0+.
const CLOCK_DIVISOR: u16 = 0x3060;
const SOFTWARE_RESET: u16 = 0x0103;
const COMMIT: u16 = 0x0104;
const STREAM: u16 = 0x0100;

fn write<B: I2c>(bus: &mut B, register: u16, value: u8) -> Result<(), SensorError<B::Error>> {
    let [high, low] = register.to_be_bytes();
    bus.write(ADDRESS, &[high, low, value]).map_err(SensorError::Bus)
}

/// Resets the sensor, and sets its window and its timing.
pub(crate) fn initialise<B: I2c>(bus: &mut B, delay: &mut cortex_m::delay::Delay) -> Result<(), SensorError<B::Error>> {
    write(bus, SOFTWARE_RESET, 1)?;
    delay.delay_ms(2);
    for (register, value) in QVGA_AT_2_HZ {
        write(bus, register, value)?;
    }
    let mut divisor = [0];
    bus.write_read(ADDRESS, &CLOCK_DIVISOR.to_be_bytes(), &mut divisor).map_err(SensorError::Bus)?;
    let [divisor] = divisor;
    write(bus, CLOCK_DIVISOR, divisor & !3)?;
    write(bus, COMMIT, 1)
}

/// Begins to deliver frames.
pub(crate) fn stream<B: I2c>(bus: &mut B) -> Result<(), SensorError<B::Error>> {
    write(bus, STREAM, 1)
}
