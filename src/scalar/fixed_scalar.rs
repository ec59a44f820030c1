//! [`Q32`] as a [`Scalar`].

use ::fixed::types::I4F28;

use super::fixed::{INFINITE, OF_ZERO, Q32};
use super::fixed_arithmetic::product_plus;
use super::fixed_kept::Kept;
use super::fixed_near::{FRACTION, Factor};
use super::fixed_trigonometry::{arc_tangent, cosine, sine};
use super::mantissa::root;
use super::scalar::Scalar;

impl Scalar for Q32 {
    type Near = I4F28;
    type Kept = Kept;

    const ZERO: Self = Self { mantissa: 0, exponent: OF_ZERO };
    const ONE: Self = Self { mantissa: 1 << 30, exponent: -30 };
    const EPSILON: Self = Self { mantissa: 1 << 30, exponent: -60 };
    const UNKNOWN: Self = Self::normalised(1_000_000, 0);

    fn from_i32(value: i32) -> Self {
        Self::normalised(value, 0)
    }

    #[inline(never)]
    fn from_i64(value: i64) -> Self {
        match i32::try_from(value) {
            Ok(small) => Self::from_i32(small),
            Err(_) => Self::of_size(value < 0, value.unsigned_abs(), 0),
        }
    }

    fn from_ratio(numerator: i64, denominator: i64) -> Self {
        if denominator == 0 { Self::ZERO } else { Self::from_i64(numerator) / Self::from_i64(denominator) }
    }

    /// Rounds once, and is made when compiled where both numbers are constants.
    #[inline(always)]
    fn ratio(numerator: i32, denominator: i32) -> Self {
        let (size, by) = (u64::from(numerator.unsigned_abs()), u64::from(denominator.unsigned_abs()));
        if size == 0 {
            return Self::ZERO;
        }
        // 63 bits over at most 32 leave at least 31.
        let zeros = size.leading_zeros() - 1;
        let quotient = (size << zeros).checked_div(by).unwrap_or(0);
        Self::of_size((numerator < 0) != (denominator < 0), quotient, -(zeros as i32))
    }

    fn from_f64(value: f64) -> Self {
        let bits = value.to_bits();
        let exponent = (bits >> 52) as i32 & 0x7ff;
        let mantissa = (bits & ((1 << 52) - 1)) | (1 << 52);
        let is_negative = bits >> 63 == 1;
        match exponent {
            // Zero, or too small for a number.
            0 => Self::ZERO,
            0x7ff if value.is_nan() => Self::ZERO,
            0x7ff => Self::bounded(if is_negative { -i32::MAX } else { i32::MAX }, INFINITE),
            _ => Self::of_size(is_negative, mantissa, exponent - 1075),
        }
    }

    fn to_f64(self) -> f64 {
        if self.mantissa == 0 {
            return 0.0;
        }
        let sign = u64::from(self.mantissa < 0) << 63;
        let size = u64::from(self.mantissa.unsigned_abs());
        // The leading bit is number 30.
        let exponent = (self.exponent + 30 + 1023) as u64;
        f64::from_bits(sign | (exponent << 52) | ((size << 22) & ((1 << 52) - 1)))
    }

    fn to_i64(self) -> i64 {
        let size = Self { mantissa: self.mantissa.wrapping_abs(), ..self }.floor();
        if self.mantissa < 0 { -size } else { size }
    }

    #[inline(never)]
    fn to_i32(self) -> i32 {
        let size = match self.exponent {
            right @ -31..=0 => self.mantissa.wrapping_abs() >> -right,
            right if right < 0 => 0,
            _ => i32::MAX,
        };
        if self.mantissa < 0 { -size } else { size }
    }

    #[inline(never)]
    fn reciprocal(self) -> Self {
        // Its exponent has yet to be seen to lie within the range.
        let Self { mantissa, exponent } = if self.mantissa == 0 { return Self::ONE / self } else { self.inverse() };
        Self::bounded(mantissa, exponent)
    }

    #[inline]
    fn plus_product(self, a: Self, b: Self) -> Self {
        product_plus(a, b, self)
    }

    #[inline]
    fn minus_product(self, a: Self, b: Self) -> Self {
        product_plus(-a, b, self)
    }

    fn half(self) -> Self {
        self.times_power_of_two(-1)
    }

    fn abs(self) -> Self {
        Self { mantissa: self.mantissa.wrapping_abs(), ..self }
    }

    fn is_nan(self) -> bool {
        false
    }

    fn is_finite(self) -> bool {
        !self.is_infinite()
    }

    fn sqrt(self) -> Self {
        if self.mantissa <= 0 || self.is_infinite() {
            return if self.mantissa > 0 { self } else { Self::ZERO };
        }
        // 2^(e + 31) has a whole root where e is odd.
        let is_even = self.exponent & 1 == 0;
        let (x, exponent) =
            if is_even { (self.mantissa >> 1, self.exponent + 1) } else { (self.mantissa, self.exponent) };
        Self::normalised(root(x as u32), (exponent + 31) / 2 - 31)
    }

    #[inline]
    fn size(self) -> i32 {
        self.exponent + 31
    }

    #[inline]
    fn near(self, exponent: i32) -> I4F28 {
        I4F28::from_bits(self.bits_near(exponent))
    }

    #[inline(never)]
    fn of_near(near: I4F28, exponent: i32) -> Self {
        Self::normalised(near.to_bits(), exponent.saturating_sub(FRACTION))
    }

    fn of_sum(sum: i64, exponent: i32) -> Self {
        Self::of_bits_of_sum(sum, exponent)
    }

    fn factor(self, exponent: i32) -> Factor {
        let left = self.size().saturating_sub(exponent).saturating_sub(1).clamp(0, 127);
        Factor { near: self.near(exponent.saturating_add(left)), left }
    }

    #[inline]
    fn kept(self) -> Kept {
        Kept::new(self)
    }

    #[inline]
    fn of_kept(kept: Kept) -> Self {
        kept.number()
    }

    fn sin(self) -> Self {
        sine(self)
    }

    fn cos(self) -> Self {
        cosine(self)
    }

    fn tan(self) -> Self {
        sine(self) / cosine(self)
    }

    fn atan(self) -> Self {
        arc_tangent(self)
    }
}
