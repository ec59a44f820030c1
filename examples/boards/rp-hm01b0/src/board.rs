//! The chip: clocks, pins, the bus, the camera's clock. Pico and Pico 2 differ in the crate and in how they boot.

#[cfg(feature = "rp235x")]
use rp235x_hal as hal;
#[cfg(feature = "rp2040")]
use rp2040_hal as hal;

pub(crate) use hal::{entry, i2c::Error as BusError};

use embedded_hal::pwm::SetDutyCycle;
use hal::dma::DMAExt;
use hal::fugit::RateExtU32;
use hal::gpio::bank0::{Gpio4, Gpio5};
use hal::gpio::{FunctionI2C, FunctionPio0, Pin, PullUp};
use hal::{Clock, pac};

use crate::rows::Rows;

#[cfg(feature = "rp2040")]
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT_LOADER: [u8; 256] = rp2040_boot2::BOOT_LOADER_GENERIC_03H;

#[cfg(feature = "rp235x")]
#[unsafe(link_section = ".start_block")]
#[used]
static IMAGE: hal::block::ImageDef = hal::block::ImageDef::secure_exe();

const CRYSTAL_HZ: u32 = 12_000_000;
/// What goes into the sensor: a divisor of the system clock, 125 or 150 MHz.
pub(crate) const MCLK_HZ: u32 = 12_500_000;

type I2cPin<P> = Pin<P, FunctionI2C, PullUp>;
pub(crate) type Bus = hal::I2C<pac::I2C0, (I2cPin<Gpio4>, I2cPin<Gpio5>)>;

pub(crate) struct Board {
    pub(crate) bus: Bus,
    pub(crate) rows: Rows,
    pub(crate) delay: cortex_m::delay::Delay,
}

/// Called once, after reset.
pub(crate) fn start() -> Board {
    let (Some(mut p), Some(core)) = (pac::Peripherals::take(), cortex_m::Peripherals::take()) else {
        defmt::panic!("peripherals taken twice");
    };
    let mut watchdog = hal::Watchdog::new(p.WATCHDOG);
    let (resets, crystal) = (&mut p.RESETS, p.XOSC);
    let clocks =
        hal::clocks::init_clocks_and_plls(CRYSTAL_HZ, crystal, p.CLOCKS, p.PLL_SYS, p.PLL_USB, resets, &mut watchdog);
    let Ok(clocks) = clocks else { defmt::panic!("no clock from the crystal") };
    let system_hz = clocks.system_clock.freq();
    let pins = hal::gpio::Pins::new(p.IO_BANK0, p.PADS_BANK0, hal::Sio::new(p.SIO).gpio_bank0, resets);

    let mut slice = hal::pwm::Slices::new(p.PWM, resets).pwm1;
    slice.set_top((system_hz.to_Hz() / MCLK_HZ - 1) as u16);
    slice.enable();
    slice.channel_a.output_to(pins.gpio18);
    let Ok(()) = slice.channel_a.set_duty_cycle_percent(50);

    // Pads of inputs are off until they are claimed: the Pico 2 reads nothing without.
    let data = pins.gpio6.into_function::<FunctionPio0>();
    let first = data.id().num;
    (pins.gpio7.into_function::<FunctionPio0>(), pins.gpio8.into_function::<FunctionPio0>());
    (pins.gpio9.into_function::<FunctionPio0>(), pins.gpio10.into_function::<FunctionPio0>());
    (pins.gpio11.into_function::<FunctionPio0>(), pins.gpio12.into_function::<FunctionPio0>());
    (pins.gpio13.into_function::<FunctionPio0>(), pins.gpio14.into_function::<FunctionPio0>());
    (pins.gpio15.into_function::<FunctionPio0>(), pins.gpio16.into_function::<FunctionPio0>());

    let (sda, scl) = (pins.gpio4.reconfigure(), pins.gpio5.reconfigure());
    let rows = Rows::new(p.PIO0, first, p.DMA.split(resets).ch0, resets);
    Board {
        bus: hal::I2C::i2c0(p.I2C0, sda, scl, 400.kHz(), resets, system_hz),
        rows,
        delay: cortex_m::delay::Delay::new(core.SYST, system_hz.to_Hz()),
    }
}

pub(crate) mod dma {
    pub(crate) use super::hal::dma::{CH0, Channel, single_buffer};
}

pub(crate) mod pio {
    pub(crate) use super::hal::pac::{PIO0, RESETS};
    pub(crate) use super::hal::pio::{Buffers, PIOBuilder, PIOExt, Running, Rx, SM0, ShiftDirection, StateMachine};
}
