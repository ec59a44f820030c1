//! [`Products`]: inner products over the flank of an edge of which the expected part is known before the row is.

use super::weight::Weight;

/// Inner products of the two levels of a step with slope and widening: what a flank shows at its expected place.
#[derive(Clone, Copy)]
pub(super) struct Expected {
    slope: i32,
    widening: i32,
    /// Of the step from one level to the other, in sixteenths.
    step_slope_q4: i32,
    step_widening_q4: i32,
}

impl Expected {
    pub(super) const NONE: Self = Self { slope: 0, widening: 0, step_slope_q4: 0, step_widening_q4: 0 };

    /// Over the pixels of a flank.
    pub(super) const fn of(weights: &[Weight]) -> Self {
        let (mut expected, mut pixel) = (Self::NONE, 0);
        let (mut step_slope_q15, mut step_widening_q15) = (0_i64, 0_i64);
        while pixel < weights.len() {
            let weight = &weights[pixel];
            expected.slope += weight.slope as i32;
            expected.widening += weight.widening as i32;
            step_slope_q15 += weight.step as i64 * weight.slope as i64;
            step_widening_q15 += weight.step as i64 * weight.widening as i64;
            pixel += 1;
        }
        expected.step_slope_q4 = ((step_slope_q15 + (1 << 10)) >> 11) as i32;
        expected.step_widening_q4 = ((step_widening_q15 + (1 << 10)) >> 11) as i32;
        expected
    }

    /// From those of the pixels, and the levels to expect.
    #[inline(always)]
    pub(super) fn products(&self, slope: i32, widening: i32, levels_q8: [i32; 2]) -> Products {
        let [left_q6, right_q6] = levels_q8.map(|level_q8| level_q8 >> 2);
        let contrast_q6 = right_q6 - left_q6;
        // 32 bits hold each product for the longest flank, whatever its pixels.
        let residual =
            |product: i32, level: i32, step_q4: i32| (product << 6) - left_q6 * level - ((contrast_q6 * step_q4) >> 4);
        Products {
            residual_slope: residual(slope, self.slope, self.step_slope_q4),
            residual_widening: residual(widening, self.widening, self.step_widening_q4),
        }
    }
}

/// Inner products of the residuals, as [`Moments`](super::moments::Moments) has them but for their rounding: two
/// multiplications a pixel. What remains is not measured.
pub(super) struct Products {
    pub(super) residual_slope: i32,
    pub(super) residual_widening: i32,
}
