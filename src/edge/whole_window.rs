//! [`WholeWindow`]: the pixels around an edge that stands alone, in a row of grey bytes: what most rows of most lines
//! show.

use super::moments::Moments;
use super::pixel_row::{PixelRow, Stretch};
use super::template::{Phase, Sampled, Template};
use crate::format::Pixels;

/// What a [`Window`](super::window::Window) is where neither a neighbour nor the border cuts off a part, and the light
/// is bytes.
pub(super) struct WholeWindow<'p> {
    /// Pixels of the plateau on the left, of the flank, and of the plateau on the right.
    left: &'p [u8],
    flank: &'p [u8],
    right: &'p [u8],
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
        let (left, rest) = pixels.split_at_checked(plateau)?;
        let (flank, right) = rest.split_at_checked(phase.weights.len())?;
        Some(Self { left, flank, right, phase, centre_q8 })
    }

    /// Levels of the plateaus, in 1/256 of a grey level.
    #[inline(always)]
    pub(super) fn levels_q8(&self, template: &Template) -> [i32; 2] {
        let sums = sums(self.left, self.right);
        [sums & 0xFFFF, sums >> 16].map(|sum| template.mean_q8(sum))
    }

    /// Given the levels to expect.
    #[inline(always)]
    pub(super) fn moments(&self, levels_q8: [i32; 2]) -> Moments {
        Moments::of_bytes(self.flank, self.phase.weights, levels_q8)
    }
}

/// Sums of the pixels of two plateaus: the lower half is that of the left one. Either is below 2¹⁶.
fn sums(left: &[u8], right: &[u8]) -> u32 {
    // Loops of the usual lengths are unrolled.
    match right.len() {
        6 => sums_of_chunks::<6>(left, right),
        7 => sums_of_chunks::<7>(left, right),
        _ => sums_of_long(left, right),
    }
}

#[inline(always)]
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

#[cfg(test)]
mod tests {
    use super::super::window::Window;
    use super::{PixelRow, Template, WholeWindow};
    use crate::setup::Response;

    /// It sees what a window sees that may have parts cut off: the same moments, and levels to 1/256 of a grey level,
    /// one rounding, for every blur and phase and any pixels, also the brightest.
    #[test]
    fn it_is_a_window() {
        const COLUMNS: usize = 240;
        let mut mixed = 7_u32;
        let mut any = || {
            mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2c1b_3c6d).wrapping_add(0x9e37_79b9);
            mixed
        };
        for class in 0..40 {
            let template = Template::of(class);
            for round in 0..20 {
                let least = if round == 0 { 255 } else { any() % 256 };
                let pixels: [u8; COLUMNS] = core::array::from_fn(|_| least.max(any() % 256) as u8);
                let row = PixelRow { pixels: &pixels, response: &Response::Linear };
                let column_q8 = 120 * 256 + (any() % 512) as i32;
                let bounds_q8 = (-(1 << 20), 1 << 20);
                let whole = WholeWindow::new(&row, column_q8, template, bounds_q8).expect("far from the border");
                let window = Window::new(row, column_q8, template, bounds_q8).expect("in the row");
                assert_eq!(whole.centre_q8, window.centre_q8);
                let (levels_q8, own_q8) = (whole.levels_q8(template), window.levels_q8().expect("plateaus"));
                let off_q8 = levels_q8.iter().zip(own_q8).map(|(level_q8, own_q8)| level_q8.abs_diff(own_q8)).max();
                assert!(off_q8 <= Some(1), "class {class}: {levels_q8:?} for {own_q8:?}");
                assert_eq!(whole.moments(own_q8), window.moments(own_q8), "class {class}");
            }
        }
    }

    /// Where a neighbour or the border is so near that a part of the window is not the edge's own there is none.
    #[test]
    fn it_is_whole() {
        let pixels = [100_u8; 64];
        let row = PixelRow { pixels: &pixels, response: &Response::Linear };
        let template = Template::of(0);
        let (middle_q8, far_q8) = (32 << 8, template.far_q8());
        let is_whole = |bounds_q8| WholeWindow::new(&row, middle_q8, template, bounds_q8).is_some();
        assert!(is_whole((middle_q8 - far_q8, middle_q8 + far_q8)));
        assert!(!is_whole((middle_q8 - far_q8 + 1, 1 << 20)) && !is_whole((-(1 << 20), middle_q8 + far_q8 - 1)));
        for column_q8 in (0..64 << 8).step_by(64) {
            let is_whole = WholeWindow::new(&row, column_q8, template, (-(1 << 20), 1 << 20)).is_some();
            let to_border_q8 = column_q8.min((63 << 8) - column_q8);
            assert_eq!(is_whole, to_border_q8 >= far_q8, "{column_q8}");
        }
    }
}
