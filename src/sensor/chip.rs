//! [`Chip`]: the sensors that are known.

use super::description::{Description, ReadRegister};
use super::error::SensorError;
use super::mode::Mode;
use super::register::Register;
use super::{gc0308, gc2145, hm01b0, hm0360, mt9m114, ov2640, ov3660, ov5640, ov7670, ov7725};

/// A kind of sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Chip {
    /// OmniVision OV7670 and OV7675: [what is known and what is open](super::ov7670).
    Ov7670,
    /// OmniVision OV7725 and OV7720: [what is known and what is open](super::ov7725).
    Ov7725,
    /// OmniVision OV2640: [what is known and what is open](super::ov2640).
    Ov2640,
    /// OmniVision OV3660: [what is known and what is open](super::ov3660).
    Ov3660,
    /// OmniVision OV5640: [what is known and what is open](super::ov5640).
    Ov5640,
    /// Himax HM01B0: [what is known and what is open](super::hm01b0).
    Hm01b0,
    /// Himax HM0360: [what is known and what is open](super::hm0360).
    Hm0360,
    /// GalaxyCore GC0308: [what is known and what is open](super::gc0308).
    Gc0308,
    /// GalaxyCore GC2145: [what is known and what is open](super::gc2145).
    Gc2145,
    /// onsemi (Aptina) MT9M114: [what is known and what is open](super::mt9m114).
    Mt9m114,
}

impl Chip {
    /// All of them, in an order in which none that is asked in vain does harm to those that follow.
    ///
    /// GC2145 shares an address with chips whose register addresses have two bytes: asking those first would write into
    /// a GC2145. GC0308 has to be turned to its first page to be asked, so OmniVision's chips come before it.
    pub const ALL: [Self; 10] = [
        Self::Ov7670,
        Self::Ov7725,
        Self::Gc0308,
        Self::Ov2640,
        Self::Gc2145,
        Self::Ov3660,
        Self::Ov5640,
        Self::Hm01b0,
        Self::Hm0360,
        Self::Mt9m114,
    ];

    /// Its name, as printed on modules.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.description().name
    }

    /// Its addresses of seven bits on the bus, the usual one first.
    #[must_use]
    pub fn addresses(self) -> &'static [u8] {
        self.description().addresses
    }

    /// The registers that its timing follows from.
    pub fn registers(self) -> impl Iterator<Item = &'static Register> {
        // Two chips share all but their clock.
        let of_clock: &[&'static Register] = match self {
            Self::Ov3660 => ov3660::REGISTERS,
            Self::Ov5640 => ov5640::REGISTERS,
            _ => &[],
        };
        of_clock.iter().chain(self.description().registers).copied()
    }

    pub(super) fn description(self) -> &'static Description {
        match self {
            Self::Ov7670 => &ov7670::DESCRIPTION,
            Self::Ov7725 => &ov7725::DESCRIPTION,
            Self::Ov2640 => &ov2640::DESCRIPTION,
            Self::Ov3660 => &ov3660::DESCRIPTION,
            Self::Ov5640 => &ov5640::DESCRIPTION,
            Self::Hm01b0 => &hm01b0::DESCRIPTION,
            Self::Hm0360 => &hm0360::DESCRIPTION,
            Self::Gc0308 => &gc0308::DESCRIPTION,
            Self::Gc2145 => &gc2145::DESCRIPTION,
            Self::Mt9m114 => &mt9m114::DESCRIPTION,
        }
    }

    /// The mode that its registers say, wherever they come from.
    pub(super) fn mode<R: ReadRegister>(self, r: &mut R, clock_hz: u32) -> Result<Mode, SensorError<R::BusError>> {
        let timing = match self {
            Self::Ov7670 => ov7670::timing(r, clock_hz),
            Self::Ov7725 => ov7725::timing(r, clock_hz),
            Self::Ov2640 => ov2640::timing(r, clock_hz),
            Self::Ov3660 => ov3660::timing(r, clock_hz),
            Self::Ov5640 => ov5640::timing(r, clock_hz),
            Self::Hm01b0 => hm01b0::timing(r, clock_hz),
            Self::Hm0360 => hm0360::timing(r, clock_hz),
            Self::Gc0308 => gc0308::timing(r, clock_hz),
            Self::Gc2145 => gc2145::timing(r, clock_hz),
            Self::Mt9m114 => mt9m114::timing(r, clock_hz),
        }?;
        Mode::from_timing(&timing)
    }
}
