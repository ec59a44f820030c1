//! Timing of a sensor, read from its registers and measured from stamps, without a way to panic: the boards' programs
//! of this example contain no panic routine, which `.ci/no-panic` checks in their symbols. It prints nothing; its
//! exit code tells how it went.
//!
//! Desktop: `cargo run --release --example no_panic_sensor --features embedded-hal`
//! Boards (emulated Cortex-M0 and M4F): the same with `--target thumbv6m-none-eabi` or `thumbv7em-none-eabihf`
#![cfg_attr(target_os = "none", no_std, no_main)]

use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
use shutter_range::ReadoutDirection;
use shutter_range::measure::{FrameStart, PeriodMeter, Timer};
use shutter_range::sensor::{Chip, Sensor, typical_modes};

/// An OV5640 as Linux sets it for 1080p, without what is zero.
const REGISTERS: [(u16, u8); 33] = [
    (0x300a, 0x56),
    (0x300b, 0x40),
    (0x3034, 0x18),
    (0x3035, 0x11),
    (0x3036, 0x54),
    (0x3037, 0x03),
    (0x3108, 0x16),
    (0x3800, 0x01),
    (0x3801, 0x50),
    (0x3802, 0x01),
    (0x3803, 0xb2),
    (0x3804, 0x08),
    (0x3805, 0xef),
    (0x3806, 0x05),
    (0x3807, 0xf1),
    (0x3808, 0x07),
    (0x3809, 0x80),
    (0x380a, 0x04),
    (0x380b, 0x38),
    (0x380c, 0x09),
    (0x380d, 0xc4),
    (0x380e, 0x04),
    (0x380f, 0x60),
    (0x3811, 0x10),
    (0x3813, 0x04),
    (0x3814, 0x11),
    (0x3815, 0x11),
    (0x3820, 0x40),
    (0x3821, 0x06),
    (0x5001, 0x83),
    (0x3500, 0x00),
    (0x3501, 0x3f),
    (0x3502, 0x00),
];

/// A bus with that sensor alone.
struct Bus {
    registers: [(u16, u8); REGISTERS.len()],
    pointer: u16,
}

impl ErrorType for Bus {
    type Error = ErrorKind;
}

impl I2c for Bus {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
        if address != 0x3c {
            return Err(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address));
        }
        for operation in operations {
            match operation {
                Operation::Write([high, low]) => self.pointer = u16::from_be_bytes([*high, *low]),
                Operation::Write([high, low, value]) => self.set(u16::from_be_bytes([*high, *low]), *value),
                Operation::Read([byte]) => *byte = self.get(),
                // What a chip with addresses of one byte would be asked.
                Operation::Write(_) => self.pointer = 0,
                Operation::Read(_) => return Err(ErrorKind::Other),
            }
        }
        Ok(())
    }
}

impl Bus {
    fn get(&self) -> u8 {
        self.registers.iter().find(|(address, _)| *address == self.pointer).map_or(0, |(_, value)| *value)
    }

    fn set(&mut self, address: u16, value: u8) {
        if let Some(register) = self.registers.iter_mut().find(|(known, _)| *known == address) {
            register.1 = value;
        }
    }
}

fn read() -> bool {
    let bus = Bus { registers: REGISTERS, pointer: 0 };
    let Ok(mut sensor) = Sensor::find(bus, 24_000_000) else { return false };
    let Ok(mode) = sensor.mode() else { return false };
    let is_set = sensor.set_frame_lines(mode.frame_lines + 10).is_ok() && sensor.set_exposure_lines(500).is_ok();
    let Ok(after) = sensor.mode() else { return false };
    let times = after.exposure_ns() == 14_880_953 && mode.sensor_line_time_ps == 29_761_905;
    is_set && times && sensor.chip() == Chip::Ov5640 && after.frame_lines == 1130 && mode.sigma_ppm == 1000
}

/// Every chip's formula, whatever the compiler can tell of the bus above.
fn compute() -> bool {
    typical_modes().iter().all(|typical| typical.mode().is_ok_and(|mode| mode.frame_time_ns() > 0))
}

fn measure() -> bool {
    let Ok(timer) = Timer::new(16, 48_000_000) else { return false };
    let Ok(mut meter) = PeriodMeter::new(timer).expecting_ps(65_000_000) else { return false };
    let mut stamp = 0_u32;
    for line in 0..300_u32 {
        stamp = stamp.wrapping_add(3136 + line % 3);
        // One in fifty is late, one is missed.
        meter.push(if line % 50 == 30 { stamp.wrapping_add(700) } else { stamp });
        stamp = stamp.wrapping_add(if line == 200 { 3137 } else { 0 });
    }
    meter.gap();
    let Some(period) = meter.period() else { return false };
    let Ok(readout) = period.readout(480, 480, ReadoutDirection::TopToBottom) else { return false };
    let Ok(start) = FrameStart::new(20, period.period_ps).and_then(|start| start.with_exposure_ns(4_000_000)) else {
        return false;
    };
    let is_near = readout.line_time_ps().abs_diff(65_354_167) < 5_000;
    is_near && period.outliers > 3 && period.missed > 0 && start.frame_start_ns(0) < 0
}

fn run() -> bool {
    read() && compute() && measure()
}

#[cfg(not(target_os = "none"))]
fn main() {
    std::process::exit(if run() { 0 } else { 1 });
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    semihosting::process::exit(if run() { 0 } else { 1 })
}
