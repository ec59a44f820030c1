//! What is near one in 32 bits: [`I4F28`] of the crate `fixed`, as the [`Near`] of [`Q32`].

use ::fixed::types::I4F28;

use super::fixed::Q32;
use super::near::{Arithmetic, Near, sealed};
use super::product::{product, product_over_28_bits};
use super::scalar::Scalar;

impl sealed::Sealed for I4F28 {}

/// Bits behind the point.
pub(super) const FRACTION: i32 = 28;

/// What a sum of products leaves out, so that 2⁸ of the largest fit.
pub(super) const SPARE: i32 = 8;

/// A number of any size, as a factor of numbers about one.
#[derive(Clone, Copy)]
pub struct Factor {
    pub(super) near: I4F28,
    /// Exponent of the power of two that it is to be multiplied with.
    pub(super) left: i32,
}

/// Exponent of what small numbers are magnified by: what is left of an observation after a first round.
const MAGNIFIED: i32 = 4;

#[cfg_attr(target_has_atomic = "32", inline(always))]
#[cfg_attr(not(target_has_atomic = "32"), inline(never))]
fn sum_and(sum: i64, a: i32, b: i32) -> i64 {
    let (high, low) = product(a, b);
    sum.wrapping_add(((i64::from(high) << 32) | i64::from(low)) >> SPARE)
}

/// Times a power of two above one; the largest number of its sign where it does not fit.
#[inline(never)]
fn enlarged(bits: i32, left: i32) -> i32 {
    // What has lost its sign or more is beyond.
    let left = left.min(31);
    let shifted = bits << left;
    if shifted >> left == bits { shifted } else { (bits >> 31) ^ i32::MAX }
}

impl Arithmetic for I4F28 {
    const ZERO: Self = Self::ZERO;

    /// Made when compiled where both numbers are constants.
    #[inline(always)]
    fn ratio(numerator: i32, denominator: i32) -> Self {
        Self::from_bits(((i64::from(numerator) << FRACTION).checked_div(i64::from(denominator)).unwrap_or(0)) as i32)
    }

    #[inline]
    fn half(self) -> Self {
        Self::from_bits(self.to_bits() >> 1)
    }

    #[inline]
    fn times(self, other: Self) -> Self {
        Self::from_bits(product_over_28_bits(self.to_bits(), other.to_bits()))
    }

    #[inline]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a.times(b)
    }

    #[inline]
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a.times(b)
    }

    /// ±2 where it is larger.
    #[inline(never)]
    fn over(self, other: Self) -> Self {
        (Q32::of_near(self, 0) / Q32::of_near(other, 0)).near(0)
    }
}

impl Near for I4F28 {
    type Sum = i64;
    type Factor = Factor;

    const NO_SUM: i64 = 0;
    const IS_WIDE: bool = false;

    #[inline]
    fn magnified(self) -> (Self, i32) {
        let bits = self.to_bits();
        let is_small = (bits >> (FRACTION - MAGNIFIED)) == (bits >> 31);
        if is_small { (Self::from_bits(bits << MAGNIFIED), MAGNIFIED) } else { (self, 0) }
    }

    #[inline]
    fn over_power_of_two(self, exponent: i32) -> Self {
        Self::from_bits(self.to_bits() >> exponent.min(31))
    }

    #[inline]
    fn scaled(self, by: Factor) -> Self {
        // As exact as the number itself allows.
        let product = self.times(by.near);
        if by.left == 0 { product } else { Self::from_bits(enlarged(product.to_bits(), by.left)) }
    }

    #[inline]
    fn minus_scaled(self, a: Self, by: Factor) -> Self {
        Self::from_bits(self.to_bits().saturating_sub(a.scaled(by).to_bits()))
    }

    #[inline]
    fn sum_and(sum: i64, a: Self, b: Self) -> i64 {
        sum_and(sum, a.to_bits(), b.to_bits())
    }
}

impl Q32 {
    /// Over a power of two; ±2 where it is larger.
    #[inline(never)]
    pub(super) fn bits_near(self, exponent: i32) -> i32 {
        let right = exponent.saturating_sub(self.exponent).saturating_sub(FRACTION);
        if right < 2 {
            return if self.mantissa < 0 { -2 << FRACTION } else { 2 << FRACTION };
        }
        let right = right.min(31);
        (self.mantissa >> right) + ((self.mantissa >> (right - 1)) & 1)
    }

    /// A sum of products times a power of two.
    #[inline(never)]
    pub(super) fn of_bits_of_sum(sum: i64, exponent: i32) -> Self {
        Self::of_size(sum < 0, sum.unsigned_abs(), exponent.saturating_add(SPARE - 2 * FRACTION))
    }
}
