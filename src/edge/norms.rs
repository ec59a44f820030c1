//! [`Norms`]: what turns inner products over a flank into estimates.

use super::factor::{Factor, shifted};
use super::pixel_count::per_pixels_q20;
use super::root::root;
use super::weight::Weight;

/// Sums of squares over the pixels of a flank.
#[derive(Clone, Copy)]
pub(super) struct Squares {
    pixels: u32,
    pub(super) slope: u32,
    pub(super) slope_slope: u32,
    pub(super) widening_widening: u32,
}

/// What turns inner products over a flank into estimates; made when the library is compiled, unless a neighbour or the
/// border cuts off a part of the window.
#[derive(Clone, Copy)]
pub(super) struct Norms {
    /// Of the slope with itself.
    pub(super) slope_slope: i32,
    /// One over the products of slope and widening with themselves.
    pub(super) per_slope: Factor,
    pub(super) per_widening: Factor,
    /// 2¹⁶ over the degrees of freedom of what remains, in sixteenths of a pixel.
    pub(super) per_freedom_q16: u16,
    /// Sigma of the shift for a unit of noise, in units of b per contrast.
    pub(super) sigma_q8: u16,
    /// Half of the slope's sum over [`Norms::slope_slope`], and what a unit of noise in the levels adds to the variance
    /// for its square.
    half_q8: u16,
    of_levels_q12: u16,
}

impl Norms {
    pub(super) const NONE: Self = Self {
        slope_slope: 0,
        per_slope: reciprocal(0),
        per_widening: reciprocal(0),
        per_freedom_q16: 0,
        sigma_q8: u16::MAX,
        half_q8: 0,
        of_levels_q12: 0,
    };

    /// Sigma of the shift as [`Norms::sigma_q8`], beside plateaus of so many pixels; one that is the flank's own tells half
    /// as much of the level.
    pub(super) const fn sigma_beside_q8(&self, [left, right]: [u32; 2], [is_left_own, is_right_own]: [bool; 2]) -> u16 {
        let of_left_q12 = of_level_q12(left) << is_left_own as u32;
        let of_right_q12 = of_level_q12(right) << is_right_own as u32;
        // One over a number of at least 2¹⁰, which has fifteen bits.
        let of_flank_q15 = (self.per_slope.times(1 << 30) as u32) >> (self.per_slope.lost() - 1);
        sigma_of(of_flank_q15, self.half_q8 as u32, of_left_q12 + of_right_q12)
    }

    /// Sigma of the shift as [`Norms::sigma_q8`], where of the product of the slope with itself only a part is left.
    pub(super) const fn sigma_of_part_q8(&self, slope_slope: i32) -> u16 {
        if slope_slope < LEAST_SLOPE_SLOPE as i32 {
            return u16::MAX;
        }
        let half_q8 = ratio(self.half_q8 as u32 * self.slope_slope as u32, slope_slope as u32);
        sigma_of(ratio(1 << 31, slope_slope as u32), half_q8, self.of_levels_q12 as u32)
    }

    /// Whether both flanks are in view.
    pub(super) const fn shows_edge(&self) -> bool {
        self.slope_slope >= LEAST_SLOPE_SLOPE as i32 && self.per_freedom_q16 > 0
    }
}

impl Squares {
    pub(super) const NONE: Self = Self { pixels: 0, slope: 0, slope_slope: 0, widening_widening: 0 };

    pub(super) const fn with(self, weight: &Weight) -> Self {
        let (slope, widening) = (weight.slope as u32, weight.widening.unsigned_abs() as u32);
        Self {
            pixels: self.pixels + 1,
            slope: self.slope + slope,
            slope_slope: self.slope_slope + slope * slope,
            widening_widening: self.widening_widening + widening * widening,
        }
    }

    /// With plateaus of so many pixels.
    pub(super) const fn norms(&self, [left, right]: [u32; 2]) -> Norms {
        if self.pixels < 3 || self.slope_slope < LEAST_SLOPE_SLOPE || left == 0 || right == 0 {
            return Norms::NONE;
        }
        let of_levels_q12 = of_levels_q12([left, right]);
        let half_q8 = half_q8(self.slope, self.slope_slope);
        Norms {
            slope_slope: self.slope_slope as i32,
            per_slope: reciprocal(self.slope_slope),
            per_widening: reciprocal(self.widening_widening),
            per_freedom_q16: per_freedom_q16(self.pixels, [left, right]),
            sigma_q8: sigma_q8(self.slope, self.slope_slope, of_levels_q12),
            half_q8: half_q8 as u16,
            of_levels_q12: of_levels_q12 as u16,
        }
    }
}

/// What a unit of noise in the levels, each from a plateau of so many pixels, adds to the variance of the shift.
pub(super) const fn of_levels_q12([left, right]: [u32; 2]) -> u32 {
    of_level_q12(left) + of_level_q12(right)
}

const fn of_level_q12(pixels: u32) -> u32 {
    per_pixels_q20(pixels as usize) >> 8
}

/// 2¹⁶ over the degrees of freedom of what remains of a flank, at least three pixels, beside plateaus of so many.
pub(super) const fn per_freedom_q16(pixels: u32, [left, right]: [u32; 2]) -> u16 {
    // In sixteenths of a pixel: the squares of the levels' shares are 3/8 in the mean, of which shift and width explain
    // a third.
    let per_pixel_q20 = per_pixels_q20(left as usize) + per_pixels_q20(right as usize);
    let freedom_q4 = 16 * (pixels - 2) + ((4 * pixels * per_pixel_q20) >> 20);
    ratio(1 << 16, freedom_q4) as u16
}

/// Least product of the slope with itself that shows an edge.
pub(super) const LEAST_SLOPE_SLOPE: u32 = 1 << 10;

/// Sigma of the shift in units of b per contrast for a unit of noise, from the noise on the flank and on the plateaus,
/// whose levels shift the edge when they are wrong: with S the slope and n pixels on a plateau, the root of 1/ΣS² +
/// (ΣS/ΣS²)²/4 (1/n + 1/n').
pub(super) const fn sigma_q8(slope: u32, slope_slope: u32, of_levels_q12: u32) -> u16 {
    sigma_of(ratio(1 << 31, slope_slope), half_q8(slope, slope_slope), of_levels_q12)
}

/// Half of the slope's sum over that of its square.
const fn half_q8(slope: u32, slope_slope: u32) -> u32 {
    let half_q8 = ratio(slope << 15, slope_slope);
    if half_q8 < MOST_HALF_Q8 { half_q8 } else { MOST_HALF_Q8 }
}

/// With what follows, 32 bits hold the variance.
const MOST_HALF_Q8: u32 = 511;

/// The same from the two parts of the variance.
const fn sigma_of(of_flank_q15: u32, half_q8: u32, of_levels_q12: u32) -> u16 {
    let half_q8 = if half_q8 < MOST_HALF_Q8 { half_q8 } else { MOST_HALF_Q8 };
    let variance_q15 = of_flank_q15 + ((half_q8 * half_q8 * of_levels_q12) >> 13);
    root(variance_q15 << 1) as u16
}

/// One sigma of a column, from that of the shift for a unit of noise, the noise in 1/256 grey level, and b over the
/// contrast.
#[inline(always)]
pub(super) fn sigma_q16(of_noise_q8: u16, noise_q8: u16, per_contrast: Factor) -> u32 {
    let sigma_q14 = (u32::from(of_noise_q8) * u32::from(noise_q8)) >> 2;
    shifted(per_contrast.times(sigma_q14 as i32), -16 - per_contrast.lost()).unsigned_abs()
}

/// One over a sum of squares; of one that is hardly there, over the least that shows an edge, so that at least nine
/// bits are lost.
pub(super) const fn reciprocal(squares: u32) -> Factor {
    let least = if squares > LEAST_SLOPE_SLOPE { squares } else { LEAST_SLOPE_SLOPE };
    Factor::of(ratio(u32::MAX, least), 32)
}

/// A quotient by what is never zero.
pub(super) const fn ratio(numerator: u32, denominator: u32) -> u32 {
    match numerator.checked_div(denominator) {
        Some(quotient) => quotient,
        None => u32::MAX,
    }
}
