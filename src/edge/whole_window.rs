//! [`WholeWindow`]: the pixels around an edge that stands alone, in a row of grey bytes: what most rows of most lines show.

use super::moments::Moments;
use super::pixel_row::{PixelRow, Stretch};
use super::template::{Phase, Sampled, Template};
use crate::format::Pixels;

/// What a [`Window`](super::window::Window) is where neither a neighbour nor the border cuts off a part, and the light is bytes.
pub(super) struct WholeWindow<'p> {
    pixels: &'p [u8],
    /// Pixels of a plateau.
    plateau: usize,
    pub(super) phase: &'static Phase,
    /// Where the step is expected: the phase that is nearest, in 1/256 px.
    pub(super) centre_q8: i32,
}

impl<'p> WholeWindow<'p> {
    // Inlined, as what follows, so that it stays in registers.
    #[inline(always)]
    pub(super) fn new<P: Pixels>(
        row: &'p PixelRow<'_, P>,
        column_q8: i32,
        template: &Template,
        (left_q8, right_q8): (i32, i32),
    ) -> Option<Self> {
        let far_q8 = template.far_q8();
        let is_alone =
            column_q8 - far_q8 >= left_q8.max(0) && column_q8 + far_q8 <= right_q8.min((row.columns() - 1) << 8);
        if !is_alone {
            return None;
        }
        let Sampled { first, centre_q8, phase } = template.at(column_q8);
        let plateau = template.plateau() as usize;
        // Within the row, since it is that far from the border.
        let from = (first as usize).checked_sub(plateau)?;
        let pixels = row.light_bytes(Stretch { from, to: from + 2 * plateau + phase.weights.len() })?;
        Some(Self { pixels, plateau, phase, centre_q8 })
    }

    /// Levels of the plateaus, in 1/256 of a grey level.
    #[inline(always)]
    pub(super) fn levels_q8(&self, template: &Template) -> [i32; 2] {
        let right = self.pixels.get(self.plateau + self.phase.weights.len()..).unwrap_or_default();
        let sums = sums(self.pixels, right);
        [sums & 0xFFFF, sums >> 16].map(|sum| template.mean_q8(sum))
    }

    /// Given the levels to expect.
    #[inline(always)]
    pub(super) fn moments(&self, levels_q8: [i32; 2]) -> Moments {
        let flank = self.pixels.get(self.plateau..).unwrap_or_default();
        Moments::of_bytes(flank, self.phase.weights, levels_q8)
    }
}

/// Sums of the first pixels of two stretches, as many as the second one has: the lower half is that of the left one. Either is below
/// 2¹⁶.
fn sums(left: &[u8], right: &[u8]) -> u32 {
    // Loops of the usual lengths are unrolled.
    match right.len() {
        6 => sums_of_chunks::<6>(left, right),
        7 => sums_of_chunks::<7>(left, right),
        _ => sums_of_long(left, right),
    }
}

#[inline(never)]
fn sums_of_chunks<const PIXELS: usize>(left: &[u8], right: &[u8]) -> u32 {
    match (left.first_chunk::<PIXELS>(), right.first_chunk::<PIXELS>()) {
        (Some(left), Some(right)) => sum_both(left, right),
        _ => 0,
    }
}

#[inline(never)]
fn sums_of_long(left: &[u8], right: &[u8]) -> u32 {
    sum_both(left, right)
}

#[inline(always)]
fn sum_both(left: &[u8], right: &[u8]) -> u32 {
    left.iter().zip(right).fold(0, |sums, (one, other)| sums + u32::from(*one) + (u32::from(*other) << 16))
}
