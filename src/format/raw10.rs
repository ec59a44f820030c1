//! [`Raw10`]: four pixels in five bytes.

use super::pixels::Pixels;

/// RAW10 as MIPI CSI-2 packs it: the upper eight bits of four pixels, then a byte with their lower two, the first
/// pixel's in its lowest bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Raw10<'b>(&'b [u8]);

const PIXELS: usize = 4;
const BYTES: usize = 5;

impl<'b> Raw10<'b> {
    /// The pixels of `bytes`, four in each five; what is left at the end is none.
    #[must_use]
    pub const fn new(bytes: &'b [u8]) -> Self {
        Self(bytes)
    }
}

impl Pixels for Raw10<'_> {
    fn columns(&self) -> usize {
        self.0.len() / BYTES * PIXELS
    }

    fn level_q8(&self, column: usize) -> u16 {
        let group = self.0.get(column / PIXELS * BYTES..).and_then(|rest| rest.first_chunk::<BYTES>());
        let Some([upper @ .., lower]) = group else { return 0 };
        let place = column % PIXELS;
        let upper = upper.get(place).map_or(0, |upper| u16::from(*upper));
        // Four steps of ten bits are one of eight.
        upper << 8 | u16::from(lower >> (2 * place) & 3) << 6
    }
}
