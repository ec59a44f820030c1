//! [`WholeWindow`]: the pixels around an edge that stands alone, in a row of grey bytes: what most rows of most lines
//! show.

use super::moments::Moments;
use super::phase::{Phase, Sampled};
use super::pixel_row::sum;
use super::products::Products;
use super::template::Template;
use super::weight::Weight;

/// What a [`Window`](super::window::Window) is where neither a neighbour nor the border cuts off a part, and the light
/// is bytes.
pub(super) struct WholeWindow<'p> {
    /// Of the plateau on the left, of the flank, and of the plateau on the right.
    pixels: &'p [u8],
    plateau: usize,
    pub(super) phase: &'static Phase,
    /// Where the step is expected: the phase that is nearest, in 1/256 px.
    pub(super) centre_q8: i32,
}

/// Sums over the pixels of a window.
pub(super) struct Sums {
    /// Of the plateaus: that on the left in the lower half, that on the right in the upper one. Either is below 2¹⁶.
    plateaus: u32,
    /// Of the flank, each pixel times what it should show.
    slope: i32,
    widening: i32,
}

impl<'p> WholeWindow<'p> {
    // Inlined, as what follows, so that it stays in registers.
    #[inline(always)]
    pub(super) fn new(
        row: &'p [u8],
        column_q8: i32,
        template: &Template,
        (left_q8, right_q8): (i32, i32),
    ) -> Option<Self> {
        let far_q8 = template.far_q8();
        if column_q8 - far_q8 < left_q8 || column_q8 + far_q8 > right_q8 {
            return None;
        }
        let Sampled { first, centre_q8, phase } = template.at(column_q8);
        let plateau = template.plateau() as usize;
        let from = usize::try_from(first - plateau as i32).ok()?;
        let pixels = row.get(from..from + template.window())?;
        Some(Self { pixels, plateau, phase, centre_q8 })
    }

    #[inline(always)]
    pub(super) fn sums(&self) -> Sums {
        let (pixels, weights) = (self.pixels, self.phase.weights);
        // Loops of the usual lengths are unrolled.
        match weights.len() {
            5 => sums_of::<5, 17>(pixels, weights),
            7 => sums_of::<7, 21>(pixels, weights),
            _ => sums_of_long(pixels, self.plateau, weights),
        }
    }

    /// Pixels of the flank, and those of the plateau on the right.
    #[inline(always)]
    pub(super) fn flank(&self) -> &'p [u8] {
        self.pixels.get(self.plateau..).unwrap_or_default()
    }

    /// Given the levels to expect.
    #[inline(always)]
    pub(super) fn moments(&self, levels_q8: [i32; 2]) -> Moments {
        Moments::of_bytes(self.flank(), self.phase.weights, levels_q8)
    }
}

#[inline(always)]
fn sums_of<const FLANK: usize, const WINDOW: usize>(pixels: &[u8], weights: &[Weight]) -> Sums {
    match (pixels.first_chunk::<WINDOW>(), weights.first_chunk::<FLANK>()) {
        (Some(pixels), Some(weights)) => sums_of_chunks(pixels, weights),
        _ => Sums { plateaus: 0, slope: 0, widening: 0 },
    }
}

#[inline(never)] // all of it then fits into the registers
fn sums_of_chunks<const FLANK: usize, const WINDOW: usize>(pixels: &[u8; WINDOW], weights: &[Weight; FLANK]) -> Sums {
    Sums::of(pixels, const { (WINDOW - FLANK) / 2 }, weights)
}

#[inline(never)]
fn sums_of_long(pixels: &[u8], plateau: usize, weights: &[Weight]) -> Sums {
    Sums::of(pixels, plateau, weights)
}

impl Sums {
    /// Of a flank alone.
    #[inline(always)]
    pub(super) fn of_flank(flank: &[u8], weights: &[Weight]) -> Self {
        match weights.len() {
            5 => sums_of::<5, 5>(flank, weights),
            7 => sums_of::<7, 7>(flank, weights),
            _ => sums_of_long(flank, 0, weights),
        }
    }

    #[inline(always)]
    fn of(pixels: &[u8], plateau: usize, weights: &[Weight]) -> Self {
        let (left, rest) = pixels.split_at(plateau.min(pixels.len()));
        let (flank, right) = rest.split_at(weights.len().min(rest.len()));
        let plateaus = sum(left) + (sum(right) << 16);
        let (slope, widening) = flank.iter().zip(weights).fold((0, 0), |(slope, widening), (pixel, weight)| {
            let pixel = i32::from(*pixel);
            (slope + pixel * i32::from(weight.slope), widening + pixel * i32::from(weight.widening))
        });
        Self { plateaus, slope, widening }
    }

    /// Levels of the plateaus, in 1/256 of a grey level.
    #[inline(always)]
    pub(super) fn levels_q8(&self, template: &Template) -> [i32; 2] {
        [template.mean_q8(self.plateaus & 0xFFFF), template.mean_q8(self.plateaus >> 16)]
    }

    /// Given the levels to expect.
    #[inline(always)]
    pub(super) fn products(&self, phase: &Phase, levels_q8: [i32; 2]) -> Products {
        phase.quick().expected.products(self.slope, self.widening, levels_q8)
    }
}

#[cfg(test)]
mod tests {
    use super::super::pixel_row::PixelRow;
    use super::super::weight::Weight;
    use super::super::window::Window;
    use super::{Template, WholeWindow};
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
                let whole = WholeWindow::new(&pixels, column_q8, template, bounds_q8).expect("far from the border");
                let window = Window::new(row, column_q8, template, bounds_q8).expect("in the row");
                assert_eq!(whole.centre_q8, window.centre_q8);
                let sums = whole.sums();
                let (levels_q8, own_q8) = (sums.levels_q8(template), window.levels_q8().expect("plateaus"));
                let off_q8 = levels_q8.iter().zip(own_q8).map(|(level_q8, own_q8)| level_q8.abs_diff(own_q8)).max();
                assert!(off_q8 <= Some(1), "class {class}: {levels_q8:?} for {own_q8:?}");
                let (moments, products) = (whole.moments(own_q8), sums.products(whole.phase, own_q8));
                assert_eq!(moments, window.moments(own_q8), "class {class}");
                // Each residual is rounded to 1/64 of a level, down: at most that times the sum of the weights.
                let weights = whole.phase.weights;
                let most = |weight: fn(&Weight) -> u32| weights.iter().map(weight).sum::<u32>() + 8;
                let off = moments.residual_slope.abs_diff(products.residual_slope);
                assert!(off <= most(|weight| weight.slope.into()), "class {class}: {off}");
                let off = moments.residual_widening.abs_diff(products.residual_widening);
                assert!(off <= most(|weight| weight.widening.unsigned_abs().into()), "class {class}: {off}");
            }
        }
    }

    /// Where a neighbour or the border is so near that a part of the window is not the edge's own there is none.
    #[test]
    fn it_is_whole() {
        let pixels = [100_u8; 64];
        let template = Template::of(0);
        let (middle_q8, far_q8) = (32 << 8, template.far_q8());
        let is_whole = |bounds_q8| WholeWindow::new(&pixels, middle_q8, template, bounds_q8).is_some();
        assert!(is_whole((middle_q8 - far_q8, middle_q8 + far_q8)));
        assert!(!is_whole((middle_q8 - far_q8 + 1, 1 << 20)) && !is_whole((-(1 << 20), middle_q8 + far_q8 - 1)));
        for column_q8 in (0..64 << 8).step_by(64) {
            let is_whole = WholeWindow::new(&pixels, column_q8, template, (-(1 << 20), 1 << 20)).is_some();
            let (first, last) = (template.at(column_q8).first - template.plateau(), template.window() as i32 - 1);
            assert_eq!(is_whole, first >= 0 && first + last < 64, "{column_q8}");
        }
    }
}
