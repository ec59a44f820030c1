//! OV5640.
//!
//! The clock is that of Linux, OpenMV and esp32-camera, which agree. Linux's frame rates follow from it, and a
//! measurement at Adafruit's driver (7.6 frames a second where it gives 7.9).
//!
//! *Open*: without the PLL, where the root divider stands: [`Evidence::Disputed`].

use super::description::{Description, ReadRegister};
use super::error::SensorError;
use super::mode::{Clock, Evidence, Timing};
use super::omnivision;
use super::register::registers;

registers! {
    PLL_BYPASS = "SC_PLL_CTRL5[7]": 0x3039 / 0x80 => "no PLL";
    BIT_MODE = "SC_PLL_CTRL0[3:0]": 0x3034 / 0x0f => "8 or 10 bits: PLL output divided by 2 or 2.5";
    SYSTEM_DIVIDER = "SC_PLL_CTRL1[7:4]": 0x3035 / 0xf0 => "PLL divider";
    MULTIPLIER = "SC_PLL_CTRL2": 0x3036 => "PLL multiplier, 4 to 252";
    ROOT = "SC_PLL_CTRL3[4]": 0x3037 / 0x10 => "PLL divided by 2";
    PRE_DIVIDER = "SC_PLL_CTRL3[3:0]": 0x3037 / 0x0f => "PLL input divided by 1, 2, 3, 4, 1.5, 6, 2.5, 8";
    CORE_DIVIDER = "SYSTEM_ROOT_DIVIDER[1:0]": 0x3108 / 0x03 => "core clock divided by 2 to this";
}

pub(super) static DESCRIPTION: Description =
    Description { name: "OV5640", identity: &[(&omnivision::PRODUCT, 0x5640)], ..omnivision::DESCRIPTION };

pub(super) fn timing<R: ReadRegister>(r: &mut R, clock_hz: u32) -> Result<Timing, SensorError<R::BusError>> {
    let clock = Clock::external(clock_hz)?.times(1, 1 << r.read(&CORE_DIVIDER)?);
    if r.is_set(&PLL_BYPASS)? {
        return omnivision::timing(r, clock, Evidence::Disputed);
    }
    let multiplier = r.read(&MULTIPLIER)?;
    if !(4..=252).contains(&multiplier) {
        return Err(SensorError::Register { register: &MULTIPLIER, value: multiplier, expected: "4 to 252" });
    }
    let root = if r.is_set(&ROOT)? { 2 } else { 1 };
    let half_bits = half_bits(r)?;
    let pre_halves = pre_divider_halves(r)?;
    // Drivers differ in what zero means.
    let system_divider = r.read_above_zero(&SYSTEM_DIVIDER)?;
    let clock = clock.times(multiplier * 2 * 2, pre_halves * half_bits).times(1, root * system_divider);
    omnivision::timing(r, clock, Evidence::Confirmed)
}

/// Twice the divider of the bit mode.
fn half_bits<R: ReadRegister>(r: &mut R) -> Result<u32, SensorError<R::BusError>> {
    match r.read(&BIT_MODE)? {
        8 => Ok(4),
        10 => Ok(5),
        value => Err(SensorError::Register { register: &BIT_MODE, value, expected: "8 or 10" }),
    }
}

/// Twice the divider before the PLL.
fn pre_divider_halves<R: ReadRegister>(r: &mut R) -> Result<u32, SensorError<R::BusError>> {
    match r.read(&PRE_DIVIDER)? {
        0 | 1 => Ok(2),
        5 => Ok(3),
        7 => Ok(5),
        value @ (2 | 3 | 4 | 6 | 8) => Ok(2 * value),
        value => Err(SensorError::Register { register: &PRE_DIVIDER, value, expected: "0 to 8" }),
    }
}
