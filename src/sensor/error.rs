//! [`SensorError`]: why a sensor did not tell its timing.

use core::error::Error;
use core::fmt::{self, Debug, Display, Formatter};

use super::register::Register;
use crate::error::ParameterError;

/// Why a sensor did not tell its timing, or did not take a setting. `E` is the bus's own error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SensorError<E> {
    /// The bus failed, or nothing answers at the chip's addresses.
    Bus(E),
    /// None of the known sensors answers.
    NotFound,
    /// Something answers, but it is another chip.
    WrongChip {
        /// The register that identifies the chip.
        register: &'static Register,
        /// What it holds.
        value: u32,
        /// What it would hold in the chip that was asked for.
        expected: u32,
    },
    /// A register holds what cannot be, or what is not understood.
    Register {
        /// The register.
        register: &'static Register,
        /// What it holds.
        value: u32,
        /// What it must hold.
        expected: &'static str,
    },
    /// An argument, or a time that follows from the registers, is out of range.
    Parameter(ParameterError),
}

impl<E> From<ParameterError> for SensorError<E> {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}

impl<E: Debug> Display for SensorError<E> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus(error) => write!(formatter, "bus: {error:?}"),
            Self::NotFound => write!(formatter, "no known sensor answers"),
            Self::WrongChip { register, value, expected } => {
                write!(formatter, "another chip: {register} is {value:#x}, but would be {expected:#x}")
            }
            Self::Register { register, value, expected } => {
                write!(formatter, "{register} is {value:#x}, but must be {expected}")
            }
            Self::Parameter(error) => Display::fmt(error, formatter),
        }
    }
}

impl<E: Debug> Error for SensorError<E> {}
