//! [`Rgb565`]: red, green and blue in 16 bits.

use super::pixels::Pixels;

/// Which byte of a 16-bit pixel comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ByteOrder {
    /// The lower one: as a little-endian processor has it in memory.
    LittleEndian,
    /// The upper one, with the red: as most sensors put it on an 8-bit bus.
    BigEndian,
}

/// RGB 5:6:5, two bytes a pixel; its brightness is the luma of ITU-R BT.601.
///
/// Five and six bits are coarse: the luma has steps of 0.9 to 2.5 grey levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rgb565<'b> {
    bytes: &'b [u8],
    order: ByteOrder,
}

impl<'b> Rgb565<'b> {
    /// The pixels of `bytes`; an odd byte at the end is none.
    #[must_use]
    pub const fn new(bytes: &'b [u8], order: ByteOrder) -> Self {
        Self { bytes, order }
    }
}

/// 0.299, 0.587 and 0.114 of 65280, shared among 31, 63 and 31 steps.
const RED_STEP_Q8: u16 = 630;
const GREEN_STEP_Q8: u16 = 608;
const BLUE_STEP_Q8: u16 = 240;

impl Pixels for Rgb565<'_> {
    fn columns(&self) -> usize {
        self.bytes.len() / 2
    }

    fn level_q8(&self, column: usize) -> u16 {
        let Some([first, second]) = pair(self.bytes, column) else { return 0 };
        let pixel = match self.order {
            ByteOrder::LittleEndian => u16::from_le_bytes([first, second]),
            ByteOrder::BigEndian => u16::from_be_bytes([first, second]),
        };
        (pixel >> 11) * RED_STEP_Q8 + (pixel >> 5 & 63) * GREEN_STEP_Q8 + (pixel & 31) * BLUE_STEP_Q8
    }
}

/// The two bytes of a pixel.
pub(super) fn pair(bytes: &[u8], column: usize) -> Option<[u8; 2]> {
    bytes.get(column.checked_mul(2)?..)?.first_chunk().copied()
}
