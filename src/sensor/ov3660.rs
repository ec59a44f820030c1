//! OV3660.
//!
//! The clock is that of esp32-camera's own calculation, which it states with the frame rates it gives: 4.44 a second
//! at 8 MHz and 17.77 at 32 MHz, both as the formula has it.

use super::description::{Description, ReadRegister};
use super::error::SensorError;
use super::mode::{Clock, Evidence, Timing};
use super::omnivision;
use super::register::registers;

registers! {
    PLL_BYPASS = "SC_PLLS_CTRL0[7]": 0x303a / 0x80 => "no PLL";
    MULTIPLIER = "SC_PLLS_CTRL1[4:0]": 0x303b / 0x1f => "PLL multiplier";
    SYSTEM_DIVIDER = "SC_PLLS_CTRL2[3:0]": 0x303c / 0x0f => "PLL divider; 0 is 1";
    ROOT = "SC_PLLS_CTRL3[6]": 0x303d / 0x40 => "PLL doubled";
    PRE_DIVIDER = "SC_PLLS_CTRL3[5:4]": 0x303d / 0x30 => "PLL input divided by 1, 1.5, 2, 3";
    LAST_DIVIDER = "SC_PLLS_CTRL3[1:0]": 0x303d / 0x03 => "PLL output divided by 1, 1, 2, 2.5";
}

pub(super) static DESCRIPTION: Description =
    Description { name: "OV3660", identity: &[(&omnivision::PRODUCT, 0x3660)], ..omnivision::DESCRIPTION };

/// The core runs at a quarter of the PLL.
const CORE_DIVIDER: u32 = 4;

pub(super) fn timing<R: ReadRegister>(r: &mut R, clock_hz: u32) -> Result<Timing, SensorError<R::BusError>> {
    let clock = Clock::external(clock_hz)?.times(1, CORE_DIVIDER);
    if r.is_set(&PLL_BYPASS)? {
        return omnivision::timing(r, clock, Evidence::Described);
    }
    // Twice the dividers, so that they are whole.
    let halves = |table: [u32; 4], index: u32| table.get(index as usize).copied().unwrap_or(2);
    let pre_divider = halves([2, 3, 4, 6], r.read(&PRE_DIVIDER)?);
    let last_divider = halves([2, 2, 4, 5], r.read(&LAST_DIVIDER)?);
    let root = if r.is_set(&ROOT)? { 2 } else { 1 };
    let multiplied = clock.times(r.read_above_zero(&MULTIPLIER)? * root * 2 * 2, pre_divider * last_divider);
    let divided = multiplied.times(1, r.read(&SYSTEM_DIVIDER)?.max(1));
    omnivision::timing(r, divided, Evidence::Confirmed)
}
