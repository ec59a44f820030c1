//! [`Strided`]: 8-bit grey among other bytes.

use super::pixels::Pixels;

/// 8-bit grey, a pixel every so many bytes: the luma of YUV 4:2:2, one plane of an interleaved picture, every other
/// pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strided<'b> {
    /// From the first pixel on.
    bytes: &'b [u8],
    stride: usize,
}

impl<'b> Strided<'b> {
    /// The pixels of `bytes` from `offset` on, `stride` bytes from one to the next. As many as there are; a stride of
    /// zero counts as one.
    #[must_use]
    pub fn new(bytes: &'b [u8], offset: usize, stride: usize) -> Self {
        Self { bytes: bytes.get(offset..).unwrap_or_default(), stride: stride.max(1) }
    }

    /// The luma of YUYV or YVYU.
    #[must_use]
    pub fn luma_first(bytes: &'b [u8]) -> Self {
        Self::new(bytes, 0, 2)
    }

    /// The luma of UYVY or VYUY.
    #[must_use]
    pub fn luma_second(bytes: &'b [u8]) -> Self {
        Self::new(bytes, 1, 2)
    }
}

impl Pixels for Strided<'_> {
    fn columns(&self) -> usize {
        let last = self.bytes.len().checked_sub(1).and_then(|last_byte| last_byte.checked_div(self.stride));
        last.map_or(0, |last| last + 1)
    }

    fn level_q8(&self, column: usize) -> u16 {
        let byte = column.checked_mul(self.stride).and_then(|at| self.bytes.get(at));
        byte.map_or(0, |level| u16::from(*level) << 8)
    }
}
