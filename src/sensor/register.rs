//! [`Register`]: a quantity in a sensor's registers, as a line of a table.

use core::fmt::{self, Display, Formatter};

/// A quantity that a sensor keeps in one register, in some bits of it, or spread over several.
#[derive(Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Register {
    /// Its name in the data sheet.
    pub name: &'static str,
    /// What it says, with its unit.
    pub meaning: &'static str,
    /// Page or bank, in chips that have such; else 0.
    pub page: u8,
    /// Where its bits are, the most significant first.
    pub parts: &'static [Part],
}

/// Some bits at one address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Part {
    /// Address in the chip.
    pub address: u16,
    /// Its bits, next to each other.
    pub mask: u16,
}

impl Part {
    /// The bits as a number.
    pub(super) const fn extract(&self, raw: u16) -> u32 {
        match (raw & self.mask).checked_shr(self.mask.trailing_zeros()) {
            Some(value) => value as u32,
            None => 0,
        }
    }

    /// `raw` with the lowest bits of a number in place of its own.
    pub(super) const fn insert(&self, raw: u16, value: u32) -> u16 {
        match (value as u16).checked_shl(self.mask.trailing_zeros()) {
            Some(shifted) => (raw & !self.mask) | (shifted & self.mask),
            None => raw,
        }
    }

    pub(super) const fn bits(&self) -> u32 {
        self.mask.count_ones()
    }
}

impl Register {
    /// The largest number that it holds.
    #[must_use]
    pub fn max(&self) -> u32 {
        let bits: u32 = self.parts.iter().map(Part::bits).sum();
        1_u32.checked_shl(bits).map_or(u32::MAX, |next| next - 1)
    }
}

impl Display for Register {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} at", self.name)?;
        for part in self.parts {
            write!(formatter, " {:#04x}", part.address)?;
        }
        Ok(())
    }
}

/// A chip's table: `NAME = "data sheet's name" [page]: address / mask, … => "meaning";` with page 0 and a mask of
/// eight bits where none is given. It makes a `static` for each line, and `REGISTERS` of all of them.
macro_rules! registers {
    (@mask) => { 0xff };
    (@mask $mask:literal) => { $mask };
    (@page) => { 0 };
    (@page $page:literal) => { $page };
    ($(
        $name:ident = $label:literal $([$page:literal])? :
            $($address:literal $(/ $mask:literal)?),+ => $meaning:literal;
    )+) => {
        $(pub(super) static $name: $crate::sensor::register::Register = $crate::sensor::register::Register {
            name: $label,
            meaning: $meaning,
            page: registers!(@page $($page)?),
            parts: &[$($crate::sensor::register::Part { address: $address, mask: registers!(@mask $($mask)?) }),+],
        };)+
        pub(super) static REGISTERS: &[&$crate::sensor::register::Register] = &[$(&$name),+];
    };
}

pub(super) use registers;
