//! [`Timer`]: a counter that stamps interrupts.

use crate::error::ParameterError;

/// A free-running counter that counts up and starts again at zero after its last value.
///
/// A counter that counts down (SysTick) is used as its complement: `mask - counter`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Timer {
    bits: u8,
    hz: u32,
    tolerance_ppm: u32,
}

/// A usual crystal with its temperature.
const USUAL_TOLERANCE_PPM: u32 = 100;

/// Fractions of a tick are in 1/65536.
pub(super) const FRACTION_BITS: u32 = 16;

impl Timer {
    /// A counter of so many bits, at a frequency in hertz, with a crystal good to 100 ppm.
    ///
    /// *Errors*: fewer than 8 or more than 32 bits; a frequency of zero.
    pub const fn new(bits: u8, hz: u32) -> Result<Self, ParameterError> {
        if bits < 8 || bits > 32 {
            return Err(ParameterError::new("bits", bits as f64, "8 to 32"));
        }
        if hz == 0 {
            return Err(ParameterError::new("hz", 0.0, "above zero"));
        }
        Ok(Self { bits, hz, tolerance_ppm: USUAL_TOLERANCE_PPM })
    }

    /// The same with another tolerance of its frequency, one standard deviation in parts per million: 10 000 for an RC
    /// oscillator, 0 where speeds are measured by the very same clock.
    #[must_use]
    pub const fn with_tolerance_ppm(mut self, tolerance_ppm: u32) -> Self {
        self.tolerance_ppm = tolerance_ppm;
        self
    }

    /// Counts per second.
    #[must_use]
    pub const fn hz(&self) -> u32 {
        self.hz
    }

    /// How well that is known, one standard deviation in parts per million.
    #[must_use]
    pub const fn tolerance_ppm(&self) -> u32 {
        self.tolerance_ppm
    }

    /// Ticks from one stamp to a later one that is less than a turn after it.
    #[must_use]
    pub const fn ticks_between(&self, earlier: u32, later: u32) -> u32 {
        later.wrapping_sub(earlier) & self.mask()
    }

    /// Nanoseconds from one stamp to a later one that is less than a turn after it, rounded.
    #[must_use]
    pub const fn ns_between(&self, earlier: u32, later: u32) -> u64 {
        let scaled = self.ticks_between(earlier, later) as u64 * 1_000_000_000 + self.hz as u64 / 2;
        match scaled.checked_div(self.hz as u64) {
            Some(ns) => ns,
            None => 0,
        }
    }

    /// Ticks in a turn.
    pub(super) const fn turn(&self) -> i64 {
        1 << self.bits
    }

    const fn mask(&self) -> u32 {
        (self.turn() - 1) as u32
    }

    /// A difference in 1/65536 tick, taken into half a turn around zero.
    pub(super) const fn wrapped(&self, difference_q16: i64) -> i64 {
        let turn_q16 = self.turn() << FRACTION_BITS;
        let positive = difference_q16 & (turn_q16 - 1);
        if positive >= turn_q16 / 2 { positive - turn_q16 } else { positive }
    }

    /// Picoseconds of a time in 1/2³² tick, rounded; the largest number where it does not fit.
    pub(super) fn ps(&self, ticks_q32: u128) -> u64 {
        const PS_PER_S: u128 = 1_000_000_000_000;
        let scaled = ticks_q32.checked_mul(PS_PER_S).and_then(|scaled| scaled.checked_div(u128::from(self.hz)));
        let rounded = scaled.map(|scaled| scaled.saturating_add(1 << 31) >> 32);
        rounded.and_then(|ps| u64::try_from(ps).ok()).unwrap_or(u64::MAX)
    }
}
