//! [`LevelNorms`]: the levels of an edge from its own flank, where no plateau tells them.

use super::norms::LEAST_SLOPE_SLOPE;
use super::tuning::TEXTURED_PLATEAU;
use super::weight::Weight;

/// Inner products over a flank of the share that each level, left and right, has in a pixel, in 1/256: what does not
/// depend on the pixels. Each plateau counts as [`TEXTURED_PLATEAU`] pixels of the level to expect.
#[derive(Clone, Copy)]
pub(super) struct LevelNorms {
    /// With itself; of the right level less what the left one explains. In 1/256.
    own_q8: [u16; 2],
    /// Likewise with the slope.
    slope: [i32; 2],
    /// With the slope and with the widening, as they are.
    of_right: [i32; 2],
    of_left: [i32; 2],
    /// With each other, and the part of the left level in the right one.
    shared: i32,
    common_q12: i16,
    /// The part of the slope in each.
    of_slope_q12: [i16; 2],
    /// Of the slope with itself, less what the levels explain; zero where that is too little to tell the edge.
    slope_slope: i32,
}

/// What a row shows of its levels, given those to expect.
#[derive(Clone, Copy, Default)]
pub(super) struct LevelSums {
    /// Of what is off the expected step, in 1/64 grey level, and of that times the right level's share.
    residual: i32,
    right_residual: i32,
}

impl LevelSums {
    #[inline(always)]
    pub(super) fn add(&mut self, residual_q6: i32, weight: &Weight) {
        self.residual += residual_q6;
        self.right_residual += weight.right_share() * residual_q6;
    }
}

/// The levels that an edge's own pixels show.
pub(super) struct FreeLevels {
    /// Minus the expected ones, in 1/256 grey level.
    pub(super) off_q8: [i32; 2],
    /// Of the slope, less what the levels explain.
    pub(super) slope_slope: i32,
}

/// Nearest whole number to a quotient by one that is above zero.
const fn nearest(numerator: i32, denominator: i32) -> i32 {
    let half = denominator / 2;
    match (if numerator < 0 { numerator - half } else { numerator + half }).checked_div(denominator) {
        Some(quotient) => quotient,
        None => 0,
    }
}

const fn part(part_q12: i32, value: i32) -> i64 {
    (part_q12 as i64 * value as i64) >> 12
}

impl LevelNorms {
    /// Of this flank, by orthogonalisation.
    pub(super) const fn of(weights: &[Weight]) -> Self {
        let (mut of_left, mut of_right, mut own, mut shared, mut slope_slope) = ([0; 2], [0; 2], [0; 2], 0, 0);
        let mut rest = weights;
        while let [weight, others @ ..] = rest {
            let (right, slope, widening) = (weight.right_share(), weight.slope as i32, weight.widening as i32);
            let left = (1 << 8) - right;
            own = [own[0] + left * left, own[1] + right * right];
            shared += left * right;
            of_left = [of_left[0] + left * slope, of_left[1] + left * widening];
            of_right = [of_right[0] + right * slope, of_right[1] + right * widening];
            slope_slope += slope * slope;
            rest = others;
        }
        let [own_left, own_right] = [own[0] + (TEXTURED_PLATEAU << 16), own[1] + (TEXTURED_PLATEAU << 16)];
        let common_q12 = nearest((shared >> 8) << 12, own_left >> 8);
        let own_right = own_right - part(common_q12, shared) as i32;
        let own_q8 = [own_left >> 8, own_right >> 8];
        let slope = [of_left[0], of_right[0] - part(common_q12, of_left[0]) as i32];
        let of_slope_q12 = [nearest((slope[0] >> 8) << 12, own_q8[0]), nearest((slope[1] >> 8) << 12, own_q8[1])];
        let left = slope_slope as i64 - part(of_slope_q12[0], slope[0]) - part(of_slope_q12[1], slope[1]);
        Self {
            own_q8: [own_q8[0] as u16, own_q8[1] as u16],
            slope,
            of_right,
            of_left,
            shared,
            common_q12: common_q12 as i16,
            of_slope_q12: [of_slope_q12[0] as i16, of_slope_q12[1] as i16],
            slope_slope: if left >= LEAST_SLOPE_SLOPE as i64 { left as i32 } else { 0 },
        }
    }

    /// Leaves it to the edge's own pixels to tell the levels, given the product of their residuals with the slope. `None`
    /// where too little of the edge is in view.
    #[inline(always)]
    pub(super) fn free(&self, sums: LevelSums, residual_slope: i32) -> Option<FreeLevels> {
        if self.slope_slope == 0 {
            return None;
        }
        let left = (sums.residual << 8) - sums.right_residual;
        let right = sums.right_residual - part(self.common_q12.into(), left) as i32;
        let ([slope_left, slope_right], [of_left_q12, of_right_q12]) = (self.slope, self.of_slope_q12);
        let residual_slope =
            i64::from(residual_slope) - part(of_left_q12.into(), left) - part(of_right_q12.into(), right);
        let shift_q8 = nearest(residual_slope.clamp(-(1 << 30), 1 << 30) as i32, self.slope_slope >> 8);
        let saturate = |product: i64| product.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32;
        let rest = |residual: i32, slope: i32| {
            residual.saturating_sub(saturate((i64::from(shift_q8) * i64::from(slope)) >> 8))
        };
        // In 1/256 grey level.
        let level = |product: i32, own_q8: u16| nearest((product >> 8).clamp(-(1 << 20), 1 << 20) << 10, own_q8.into());
        let [own_left_q8, own_right_q8] = self.own_q8;
        let right_q8 = level(rest(right, slope_right), own_right_q8);
        let of_right = (i64::from(right_q8) * i64::from(self.shared)) >> 10;
        let left_q8 = level(rest(left, slope_left).saturating_sub(saturate(of_right)), own_left_q8);
        let off_q8 = [left_q8, right_q8];
        let is_sound = off_q8.into_iter().all(|off_q8| off_q8.abs() <= 255 << 8);
        is_sound.then_some(FreeLevels { off_q8, slope_slope: self.slope_slope })
    }

    /// What levels that are off, in 1/256 grey level, add to the inner products of residuals in 1/64 grey level with the
    /// slope and with the widening.
    #[inline(always)]
    pub(super) fn explained_q6(&self, [left_q8, right_q8]: [i32; 2]) -> [i32; 2] {
        // 32 bits hold both parts: a level is off by at most 255, and the weights of a flank add up to less than 2¹³.
        let part = |off_q8: i32, of: i32| (off_q8 >> 2) * ((of + (1 << 7)) >> 8);
        let ([left_slope, left_widening], [right_slope, right_widening]) = (self.of_left, self.of_right);
        [
            part(left_q8, left_slope) + part(right_q8, right_slope),
            part(left_q8, left_widening) + part(right_q8, right_widening),
        ]
    }
}
