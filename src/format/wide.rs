//! [`Wide`]: more than eight bits, in sixteen.

use super::pixels::Pixels;
use super::rgb565::pair;

/// Grey levels of `BITS` significant bits (8 to 16), each in the lower ones of two bytes, the lower byte first: what
/// 10- and 12-bit parallel cameras leave in memory. Upper bits that are set count as white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wide<'b, const BITS: u32>(&'b [u8]);

impl<'b, const BITS: u32> Wide<'b, BITS> {
    /// The pixels of `bytes`; an odd byte at the end is none.
    #[must_use]
    pub const fn new(bytes: &'b [u8]) -> Self {
        const { assert!(8 <= BITS && BITS <= 16, "8 to 16 bits") };
        Self(bytes)
    }
}

impl<const BITS: u32> Pixels for Wide<'_, BITS> {
    fn columns(&self) -> usize {
        self.0.len() / 2
    }

    fn level_q8(&self, column: usize) -> u16 {
        let Some(bytes) = pair(self.0, column) else { return 0 };
        let white = u16::MAX >> (16 - BITS);
        u16::from_le_bytes(bytes).min(white) << (16 - BITS)
    }
}
