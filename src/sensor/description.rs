//! What a chip is like: how it is spoken to, how it says who it is, and what may be set.

use super::error::SensorError;
use super::register::Register;

/// How a chip is spoken to.
#[derive(Debug)]
pub(super) struct Protocol {
    /// Register addresses of two bytes instead of one.
    pub(super) wide_address: bool,
    /// Registers of two bytes instead of one.
    pub(super) wide_data: bool,
    /// A read follows its address without a stop. SCCB has no repeated start: write, stop, read.
    pub(super) repeated_start: bool,
    /// Where the page is selected, in chips that have pages.
    pub(super) page: Option<&'static Register>,
}

/// OmniVision's SCCB with addresses of one byte; GalaxyCore's bus is spoken to alike.
pub(super) const SCCB: Protocol = Protocol { wide_address: false, wide_data: false, repeated_start: false, page: None };

/// A value that may be set.
#[derive(Debug)]
pub(super) struct Setting {
    pub(super) register: &'static Register,
    /// Units of the register for one line, as a shift.
    pub(super) shift: u32,
}

/// Where the length of a frame is set.
#[derive(Debug)]
pub(super) enum FrameSetting {
    /// All lines of the frame.
    Whole(&'static Register),
    /// Lines beside those that the chip reads anyway.
    Further(&'static Register),
}

/// What is known of a chip beside its formula.
#[derive(Debug)]
pub(super) struct Description {
    pub(super) name: &'static str,
    /// Addresses of seven bits on the bus, the usual one first.
    pub(super) addresses: &'static [u8],
    pub(super) protocol: Protocol,
    /// What it holds in which registers, so that it is this chip.
    pub(super) identity: &'static [(&'static Register, u32)],
    pub(super) registers: &'static [&'static Register],
    pub(super) exposure: Setting,
    /// What makes the exposure stay as it is set.
    pub(super) manual_exposure: (&'static Register, u32),
    /// An exposure must be so many lines shorter than the frame.
    pub(super) exposure_margin_lines: u32,
    pub(super) frame: FrameSetting,
    /// What makes new values count, in chips that wait for it.
    pub(super) commit: Option<(&'static Register, u32)>,
}

/// Where register values come from: a bus, or a table.
pub(super) trait ReadRegister {
    /// The error of the bus.
    type BusError;

    fn read(&mut self, register: &'static Register) -> Result<u32, SensorError<Self::BusError>>;

    /// The same where it must not be zero: rows, columns, a clock's multiplier.
    fn read_above_zero(&mut self, register: &'static Register) -> Result<u32, SensorError<Self::BusError>> {
        match self.read(register)? {
            0 => Err(SensorError::Register { register, value: 0, expected: "above zero" }),
            value => Ok(value),
        }
    }

    /// The same as a truth: any bit set.
    fn is_set(&mut self, register: &'static Register) -> Result<bool, SensorError<Self::BusError>> {
        Ok(self.read(register)? != 0)
    }
}
