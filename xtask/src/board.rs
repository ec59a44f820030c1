//! [`Board`]: the emulated boards; [`BackEnd`]: the number types; [`Opt`]: how the compiler optimises.

use std::fmt;

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// A core, on a board that QEMU emulates with memory enough for whole frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize, Deserialize)]
pub(crate) enum Board {
    #[value(name = "M0")]
    M0,
    /// An M0 with the memory that it has: 256 KiB of flash and 16 KiB of RAM.
    #[value(skip)]
    #[serde(skip)]
    Microbit,
    #[value(name = "M3")]
    M3,
    #[value(name = "M4F")]
    M4F,
    #[value(name = "M7")]
    M7,
    #[value(name = "M33")]
    M33,
    #[value(name = "RV32")]
    #[serde(rename = "RV32")]
    Rv32,
}

impl Board {
    pub(crate) const fn target(self) -> &'static str {
        match self {
            Self::M0 | Self::Microbit => "thumbv6m-none-eabi",
            Self::M3 => "thumbv7m-none-eabi",
            Self::M4F | Self::M7 => "thumbv7em-none-eabihf",
            Self::M33 => "thumbv8m.main-none-eabihf",
            Self::Rv32 => "riscv32imac-unknown-none-elf",
        }
    }

    /// The core that the compiler knows beyond its target.
    pub(crate) const fn cpu(self) -> Option<&'static str> {
        match self {
            Self::M7 => Some("cortex-m7"), // it has double precision
            _ => None,
        }
    }

    /// The number types that one would choose there.
    pub(crate) const fn back_ends(self) -> &'static [BackEnd] {
        match self {
            Self::M0 | Self::Microbit | Self::M3 | Self::Rv32 => &[BackEnd::F32, BackEnd::Fixed],
            Self::M4F | Self::M7 | Self::M33 => &[BackEnd::F32, BackEnd::Micro, BackEnd::Fixed],
        }
    }

    /// The memory map, where it is not that of the target.
    pub(crate) const fn map(self) -> Option<&'static str> {
        match self {
            Self::Microbit => Some("microbit"),
            _ => None,
        }
    }

    /// QEMU with its machine, and its virtual clock bound to the instructions: 256 ns each make the timer of the Arm
    /// boards tick more than once an instruction.
    pub(crate) const fn qemu(self) -> &'static [&'static str] {
        match self {
            // The code is that of an M0; its own board has too little memory, and an M3 runs the same instructions.
            Self::M0 | Self::M3 => &["qemu-system-arm", "-machine", "mps2-an385", "-icount", "shift=8"],
            Self::Microbit => &["qemu-system-arm", "-machine", "microbit"],
            Self::M4F => &["qemu-system-arm", "-machine", "mps2-an386", "-icount", "shift=8"],
            Self::M7 => &["qemu-system-arm", "-machine", "mps2-an500", "-icount", "shift=8"],
            Self::M33 => &["qemu-system-arm", "-machine", "mps2-an505", "-icount", "shift=8"],
            Self::Rv32 => &["qemu-system-riscv32", "-machine", "virt", "-bios", "none", "-icount", "shift=0"],
        }
    }
}

/// A number type of the solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum BackEnd {
    F32,
    F64,
    Micro,
    Fixed,
}

/// Optimised for speed or for size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize, Deserialize)]
pub(crate) enum Opt {
    #[value(name = "3")]
    #[serde(rename = "3")]
    Speed,
    #[value(name = "s")]
    #[serde(rename = "s")]
    Size,
}

/// By the names that the command line and the table have.
macro_rules! display_by_value_name {
    ($($type:ty),*) => { $(
        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let name = self.to_possible_value().map(|value| value.get_name().to_owned());
                f.pad(name.as_deref().unwrap_or("microbit"))
            }
        }
    )* };
}

display_by_value_name!(Board, BackEnd, Opt);
