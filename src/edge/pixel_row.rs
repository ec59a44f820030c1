//! [`PixelRow`]: a row of pixels in any format, read as whole grey levels and as light.

use core::ops::Range;

use super::pixel_count::{self, per_pixels_q20};
use crate::format::{MosaicRow, Pixels};
use crate::setup::Response;

/// A row of pixels and how their grey levels follow the light.
#[derive(Clone, Copy)]
pub(crate) struct PixelRow<'p, P> {
    pub(crate) pixels: P,
    pub(crate) response: &'p Response,
}

/// Pixels `from` up to `to` of a row, which has them all.
#[derive(Clone, Copy)]
pub(super) struct Stretch {
    pub(super) from: usize,
    pub(super) to: usize,
}

impl Stretch {
    pub(super) const fn pixels(self) -> usize {
        self.to - self.from
    }

    const fn columns(self) -> Range<usize> {
        self.from..self.to
    }
}

impl<P: Pixels> PixelRow<'_, P> {
    /// Number of pixels; what lies beyond 2¹⁶ is out of reach of columns in 1/65536 px anyway.
    pub(super) fn columns(&self) -> i32 {
        self.pixels.columns().min(1 << 16) as i32
    }

    /// The light of a stretch, where that is its grey bytes.
    #[inline(always)]
    fn light_bytes(&self, stretch: Stretch) -> Option<&[u8]> {
        self.pixels.grey().filter(|_| self.response.is_identity())?.get(stretch.columns())
    }

    /// The light of the whole row, where edges are located in ways that are made for bytes of one colour.
    #[inline(always)]
    pub(crate) fn quick_bytes(&self) -> Option<&[u8]> {
        if P::HAS_QUICK_WAYS && self.pixels.mosaic_row().is_none() {
            self.pixels.grey().filter(|_| self.response.is_identity())
        } else {
            None
        }
    }

    /// Hands over the light of each pixel, in 1/256 of a level, with what belongs to it.
    pub(super) fn each_light_q8<T>(
        &self,
        stretch: Stretch,
        beside: impl Iterator<Item = T>,
        mut take: impl FnMut(i32, T),
    ) {
        let levels_q8 = self.pixels.levels_q8(stretch.columns());
        // Asked once, not for each pixel.
        if self.response.is_identity() {
            levels_q8.zip(beside).for_each(|(level_q8, other)| take(i32::from(level_q8), other));
        } else {
            let light_q8 = |level_q8| i32::from(self.response.light_q8(level_q8));
            levels_q8.zip(beside).for_each(|(level_q8, other)| take(light_q8(level_q8), other));
        }
    }

    /// Sum of the light, in 1/256 of a level, of up to 65 536 pixels.
    pub(super) fn sum_q8(&self, stretch: Stretch) -> u32 {
        match self.light_bytes(stretch) {
            Some(bytes) => sum(bytes) << 8,
            None => self.sum_of_light_q8(stretch),
        }
    }

    fn sum_of_light_q8(&self, stretch: Stretch) -> u32 {
        let levels_q8 = self.pixels.levels_q8(stretch.columns());
        levels_q8.map(|level_q8| u32::from(self.response.light_q8(level_q8))).sum()
    }

    /// Grey levels of the four pixels on the right of a boundary less those on its left, and likewise of the two that are
    /// nearest: boundary k lies between pixels k − 1 and k. `None` at the border.
    pub(crate) fn steps_at(&self, boundary: i32) -> Option<[i16; 2]> {
        const SIDE: usize = 4;
        let from = usize::try_from(boundary).ok()?.checked_sub(SIDE)?;
        if let Some(grey) = self.pixels.grey() {
            let [a, b, c, d, e, f, g, h] = grey.get(from..)?.first_chunk::<{ 2 * SIDE }>()?.map(i16::from);
            let near = e + f - (c + d);
            return Some([near + g + h - (a + b), near]);
        }
        let pixels = from..from + 2 * SIDE;
        if pixels.end > self.pixels.columns() {
            return None;
        }
        let step = |side: usize| {
            let middle = from + SIDE;
            let sum = |pixels| self.pixels.levels_q8(pixels).fold(0, |sum, level_q8| sum + i32::from(level_q8));
            ((sum(middle..middle + side) - sum(middle - side..middle)) >> 8) as i16
        };
        Some([step(SIDE), step(SIDE / 2)])
    }

    /// That of the four pixels on either side alone.
    pub(crate) fn step_at(&self, boundary: i32) -> Option<i16> {
        self.steps_at(boundary).map(|[step, _]| step)
    }

    /// Which of its own levels the model of an edge has for this row: the two kinds of rows of a mosaic differ.
    pub(super) fn kind(&self) -> usize {
        usize::from(self.pixels.mosaic_row() == Some(MosaicRow::Odd))
    }

    /// Fewest pixels that show a level: one of each colour.
    pub(super) fn colours(&self) -> i32 {
        if self.pixels.mosaic_row().is_some() { 2 } else { 1 }
    }

    /// Mean light in 1/256 of a level, to the nearest; of a mosaic, mean of the means of its two colours.
    pub(super) fn mean_q8(&self, stretch: Stretch) -> Option<i32> {
        if self.pixels.mosaic_row().is_some() {
            let [even_q8, odd_q8] = self.colour_means_q8(stretch)?;
            return Some((even_q8 + odd_q8) / 2);
        }
        mean(self.sum_q8(stretch), stretch.pixels() as u32)
    }

    /// How much brighter the even columns of a mosaic are than the mean of its two colours, in 1/256 of a level; zero
    /// for one colour.
    pub(super) fn colour_q8(&self, stretch: Stretch) -> i32 {
        let means = self.pixels.mosaic_row().and_then(|_| self.colour_means_q8(stretch));
        means.map_or(0, |[even_q8, odd_q8]| (even_q8 - odd_q8) / 2)
    }

    /// Those of the even and of the odd columns, where there are both.
    fn colour_means_q8(&self, stretch: Stretch) -> Option<[i32; 2]> {
        let (mut sums_q8, mut counts) = ([0_u32; 2], [0_u32; 2]);
        self.each_light_q8(stretch, stretch.columns(), |light_q8, column| {
            let [even, odd] = &mut sums_q8;
            let [evens, odds] = &mut counts;
            let (sum_q8, count) = if column % 2 == 0 { (even, evens) } else { (odd, odds) };
            *sum_q8 += light_q8 as u32;
            *count += 1;
        });
        let ([even, odd], [evens, odds]) = (sums_q8, counts);
        Some([mean(even, evens)?, mean(odd, odds)?])
    }

    /// Noise of the light at a column, from that of the grey levels, both in 1/256 of a level.
    pub(super) fn noise_of_light_q8(&self, column_q16: i32, noise_q8: u32) -> u32 {
        if self.response.is_identity() {
            return noise_q8;
        }
        // The curve is steep at one end of an edge and flat at the other: its middle stands for both.
        const STEP_Q8: u16 = 8 << 8;
        let middle = usize::try_from(column_q16 >> 16).ok().filter(|column| *column < self.pixels.columns());
        let Some(column) = middle else { return noise_q8 };
        let level_q8 = self.pixels.level_q8(column).clamp(STEP_Q8, (255 << 8) - STEP_Q8);
        let light_q8 = |level_q8| u32::from(self.response.light_q8(level_q8));
        let rise_q8 = light_q8(level_q8 + STEP_Q8).saturating_sub(light_q8(level_q8 - STEP_Q8));
        let slope_q8 = rise_q8 / (2 * u32::from(STEP_Q8 >> 8));
        noise_q8.saturating_mul(slope_q8.max(1)) >> 8
    }
}

/// Four at a time: a plateau has few more. At most 128 of them are as bright as can be.
#[inline(always)]
pub(super) fn sum(pixels: &[u8]) -> u32 {
    let fours = pixels.chunks_exact(4);
    let rest = fours.remainder().iter().fold(0, |sum, pixel| sum + u32::from(*pixel));
    let pairs = fours.fold(0, |sum, four| sum + pairs(four));
    (pairs & 0xFFFF) + (pairs >> 16) + rest
}

/// Mean of the bytes of a plateau in 1/256 grey level, to the nearest.
#[inline(never)] // it takes 200 bytes of flash
pub(super) fn mean_q8(bytes: &[u8]) -> Option<i32> {
    (!bytes.is_empty()).then(|| pixel_count::mean_q8(sum(bytes), per_pixels_q20(bytes.len())))
}

/// Sums of the four pixels of a word two by two, one in each half.
#[inline(always)]
pub(super) fn pairs(word: &[u8]) -> u32 {
    const EVEN: u32 = 0x00ff_00ff;
    let Some(word) = word.first_chunk::<4>() else { return 0 };
    if cfg!(target_has_atomic = "32") {
        let word = u32::from_le_bytes(*word);
        (word & EVEN) + ((word >> 8) & EVEN)
    } else {
        // Where there is no atomic word, none is loaded from any address either.
        let [a, b, c, d] = word.each_ref().map(|pixel| u32::from(*pixel));
        (a + b) + ((c + d) << 16)
    }
}

/// The sum of the second four pixels less that of the first four.
#[inline(always)]
pub(super) fn difference(pixels: &[u8]) -> i32 {
    let (left, right) = pixels.split_at(pixels.len().min(4));
    // The lower halves take a carry from the upper ones, and lose it again.
    let difference = pairs(right).wrapping_sub(pairs(left));
    i32::from(difference as i16) + ((difference.wrapping_add(0x8000) as i32) >> 16)
}

/// To the nearest.
fn mean(sum: u32, count: u32) -> Option<i32> {
    i32::try_from((sum + count / 2).checked_div(count)?).ok()
}

/// The whole grey levels of a stretch of a row: those bytes themselves where it is grey, else in the buffer. What lies
/// beyond the row is left out; the buffer is large enough.
// Inlined, so that a grey row has no buffer to clear.
#[inline(always)]
pub(super) fn grey<'b, P: Pixels, const N: usize>(
    pixels: &'b P,
    columns: Range<usize>,
    buffer: &'b mut [u8; N],
) -> &'b [u8] {
    if let Some(grey) = pixels.grey() {
        return grey.get(columns.start..columns.end.min(grey.len())).unwrap_or_default();
    }
    let levels_q8 = pixels.levels_q8(columns.start..columns.end.min(pixels.columns()));
    let mut count = 0;
    for (level, level_q8) in buffer.iter_mut().zip(levels_q8) {
        *level = (level_q8.saturating_add(128) >> 8) as u8;
        count += 1;
    }
    buffer.get(..count).unwrap_or_default()
}
