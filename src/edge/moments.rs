//! [`Moments`]: inner products over the flank of an edge.

use super::factor::{Factor, upper};
use super::weight::Weight;

/// Inner products of the residual with the slope of the expected step and with its change by the width. 32 bits hold
/// the sums of the longest flank, 47 pixels, whatever its pixels.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Moments {
    /// Of residuals in 1/64 grey level, each at most 64 levels.
    residual_residual: i32,
    pub(super) residual_slope: i32,
    pub(super) residual_widening: i32,
}

/// A residual counts at most so much, in 1/64 grey level: what is off by more is no noise.
const MOST_RESIDUAL_Q6: i32 = 64 << 6;

/// What the best multiple of a weight explains of the residuals' sum of squares, in 1/256 square grey level: the square
/// of their product with it, over the weight's own. Less than there is where it is more than most pixels can show.
#[inline(always)]
fn explained_q8(product: i32, reciprocal: Factor) -> i32 {
    // So much less that the most fits sixteen bits: 64 grey levels at the largest weight.
    let part = (product >> (reciprocal.lost() - 9)).clamp(i16::MIN.into(), i16::MAX.into()) as i16;
    upper(reciprocal.times(product), part) << 3
}

impl Moments {
    /// Of grey bytes, as many as there are weights, given the levels to expect.
    pub(super) fn of_bytes(pixels: &[u8], weights: &[Weight], levels_q8: [i32; 2]) -> Self {
        // Loops of the usual lengths are unrolled.
        match weights.len() {
            5 => Self::of_flank::<5>(pixels, weights, levels_q8),
            7 => Self::of_flank::<7>(pixels, weights, levels_q8),
            _ => Self::of_long_flank(pixels, weights, levels_q8),
        }
    }

    #[inline(always)]
    fn of_flank<const PIXELS: usize>(pixels: &[u8], weights: &[Weight], levels_q8: [i32; 2]) -> Self {
        match (pixels.first_chunk::<PIXELS>(), weights.first_chunk::<PIXELS>()) {
            (Some(pixels), Some(weights)) => Self::of_each(pixels, weights, levels_q8),
            _ => Self::default(),
        }
    }

    #[inline(never)]
    fn of_long_flank(pixels: &[u8], weights: &[Weight], levels_q8: [i32; 2]) -> Self {
        Self::of_each(pixels, weights, levels_q8)
    }

    #[inline(always)]
    fn of_each(pixels: &[u8], weights: &[Weight], levels_q8: [i32; 2]) -> Self {
        let [left_q6, right_q6] = levels_q8.map(|level_q8| level_q8 >> 2);
        let (contrast_q6, mut moments) = (right_q6 - left_q6, Self::default());
        for (pixel, weight) in pixels.iter().zip(weights) {
            moments.add((i32::from(*pixel) << 6) - weight.expected_q6(left_q6, contrast_q6), weight);
        }
        moments
    }

    pub(super) fn add(&mut self, residual_q6: i32, weight: &Weight) {
        let size_q6 = residual_q6.clamp(-MOST_RESIDUAL_Q6, MOST_RESIDUAL_Q6 - 1);
        self.residual_residual += size_q6 * size_q6;
        self.residual_slope += residual_q6 * i32::from(weight.slope);
        self.residual_widening += residual_q6 * i32::from(weight.widening);
    }

    /// Residual variance of a pixel, in 1/65536 square grey level, less what shift and width explain, given one over the
    /// products of slope and widening with themselves; where the levels are free, too little would be left without the
    /// width's part, which is then not given.
    #[inline(always)]
    pub(super) fn residual_q16(&self, per_slope: Factor, per_widening: Option<Factor>, per_freedom_q16: u16) -> u32 {
        let of_shift_q8 = explained_q8(self.residual_slope, per_slope);
        let of_width_q8 = per_widening.map_or(0, |per_widening| explained_q8(self.residual_widening, per_widening));
        // It fits: either part is at most the sum of squares of 47 residuals of 255 levels.
        let rest_q8 = ((self.residual_residual >> 4).saturating_sub(of_shift_q8).saturating_sub(of_width_q8)).max(0);
        // It fits: no flank has more than three pixels for a degree of freedom.
        (((rest_q8 as u32 + 2) >> 2) * u32::from(per_freedom_q16)) >> 2
    }
}
