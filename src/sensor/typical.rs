//! [`TypicalMode`]: modes that drivers set, by the registers that they set them with.

use core::convert::Infallible;

use super::chip::Chip;
use super::description::ReadRegister;
use super::error::SensorError;
use super::mode::Mode;
use super::register::Register;

/// How the line time of a mode is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Kind {
    /// Somebody measured a frame rate with these very settings, and the formula has it.
    Measured,
    /// The formula has the frame rate, or the clock, that a driver or a data sheet states for these settings.
    Computed,
    /// Nothing but the registers' descriptions says so.
    Documented,
}

impl Kind {
    /// In one word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::Computed => "computed",
            Self::Documented => "documented",
        }
    }
}

/// A mode that a driver sets: its registers, and what follows from them by the very formula that reads a sensor.
#[derive(Debug)]
#[non_exhaustive]
pub struct TypicalMode {
    /// The sensor.
    pub chip: Chip,
    /// What the mode is called, and who sets it.
    pub name: &'static str,
    /// The board's clock in hertz.
    pub clock_hz: u32,
    /// Whose settings, and whose frame rate.
    pub source: &'static str,
    /// How it is known.
    pub kind: Kind,
    /// Registers that are not zero.
    pub(super) values: &'static [(&'static Register, u32)],
}

impl TypicalMode {
    /// Its timing.
    ///
    /// *Errors*: none, for the modes of this crate; a test says so.
    pub fn mode(&self) -> Result<Mode, SensorError<Infallible>> {
        self.mode_at(self.clock_hz)
    }

    /// The timing of the same registers on a board with another clock.
    ///
    /// *Errors*: a clock outside 1 to 100 MHz, or one that makes a line last longer than a frame may.
    pub fn mode_at(&self, clock_hz: u32) -> Result<Mode, SensorError<Infallible>> {
        self.chip.mode(&mut Values(self.values), clock_hz)
    }
}

/// Registers of a table.
struct Values(&'static [(&'static Register, u32)]);

impl ReadRegister for Values {
    type BusError = Infallible;

    fn read(&mut self, register: &'static Register) -> Result<u32, SensorError<Infallible>> {
        let entry = self.0.iter().find(|(known, _)| core::ptr::eq(*known, register));
        Ok(entry.map_or(0, |(_, value)| *value))
    }
}
