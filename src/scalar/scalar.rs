//! [`Scalar`]: what the solver needs of a number.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

use super::near::{Near, sealed};

/// A real number of one of the back ends.
///
/// *Range*: at least 10⁻³⁸ to 10³⁸ in size, with at least 24 bits. What leaves the range becomes infinite (floating
/// point) or the largest number (fixed point), never a panic; so does a division by zero.
///
/// This trait is sealed: the estimator's stated errors hold for the implementations of this crate.
pub trait Scalar:
    Copy
    + Debug
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + sealed::Sealed
{
    /// What is near one, such as parts of directions: itself, or a number of 32 bits of the crate `fixed` that shares a
    /// power of two with others.
    #[doc(hidden)]
    type Near: Near;
    /// What takes no more room than a number near one where many are kept: itself, or the upper 24 bits.
    #[doc(hidden)]
    type Kept: Copy + Debug;

    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The spacing of numbers near one: a smaller relative difference is rounding.
    const EPSILON: Self;
    /// 10⁶, the largest sigma that an estimate states: it means that nothing is known.
    const UNKNOWN: Self;

    /// The whole number `value`, rounded where the type has fewer bits.
    fn from_i32(value: i32) -> Self;
    /// The whole number `value`, rounded where the type has fewer bits.
    fn from_i64(value: i64) -> Self;
    /// `numerator / denominator`, rounded once or twice; zero where the denominator is zero.
    fn from_ratio(numerator: i64, denominator: i64) -> Self;
    /// The nearest number; out of range saturates in fixed point, and NaN becomes zero there.
    fn from_f64(value: f64) -> Self;
    /// The value in double precision.
    fn to_f64(self) -> f64;
    /// The whole part, cut off; the largest number of its sign where it is larger, and zero for what is not a number.
    fn to_i64(self) -> i64;
    /// Whether it is a number within the range: not NaN, not infinite and not saturated.
    fn is_finite(self) -> bool;
    /// Square root; zero for negative numbers, NaN for NaN.
    fn sqrt(self) -> Self;
    /// Sine of an angle in radians.
    fn sin(self) -> Self;
    /// Cosine of an angle in radians.
    fn cos(self) -> Self;
    /// Tangent of an angle in radians.
    fn tan(self) -> Self;
    /// Arc tangent in radians, within ±π/2.
    fn atan(self) -> Self;

    /// The whole part of what fits into 32 bits; the largest of them of its sign where it is larger.
    #[doc(hidden)]
    fn to_i32(self) -> i32 {
        self.to_i64().clamp(i32::MIN.into(), i32::MAX.into()) as i32
    }

    /// The exponent of a power of two that it is smaller than; zero where none is needed.
    #[doc(hidden)]
    fn size(self) -> i32;

    /// Over a power of two; ±2 where it is larger.
    #[doc(hidden)]
    fn near(self, exponent: i32) -> Self::Near;

    /// Times a power of two.
    #[doc(hidden)]
    fn of_near(near: Self::Near, exponent: i32) -> Self;

    /// A sum of products times a power of two.
    #[doc(hidden)]
    fn of_sum(sum: <Self::Near as Near>::Sum, exponent: i32) -> Self;

    /// As a factor of numbers near one, over a power of two.
    #[doc(hidden)]
    fn factor(self, exponent: i32) -> <Self::Near as Near>::Factor;

    /// To be kept.
    #[doc(hidden)]
    fn kept(self) -> Self::Kept;

    /// That has been kept.
    #[doc(hidden)]
    fn of_kept(kept: Self::Kept) -> Self;

    /// `numerator / denominator` of two small whole numbers, for constants in formulas.
    fn ratio(numerator: i32, denominator: i32) -> Self {
        Self::from_i32(numerator) / Self::from_i32(denominator)
    }

    /// One over it.
    fn reciprocal(self) -> Self {
        Self::ONE / self
    }

    /// `self + a * b`, where a back end has something better with the roundings of both.
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }

    /// `self - a * b`, likewise.
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }

    /// Half of it.
    fn half(self) -> Self {
        self * Self::ratio(1, 2)
    }

    /// The absolute value.
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }

    /// The larger of two numbers; the other one where one is not a number.
    // Where a comparison of floats is a call, so is this: the smallest cores.
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn max(self, other: Self) -> Self {
        if self >= other || other.is_nan() { self } else { other }
    }

    /// The smaller of two numbers; the other one where one is not a number.
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn min(self, other: Self) -> Self {
        if self <= other || other.is_nan() { self } else { other }
    }

    /// Not equal to itself.
    fn is_nan(self) -> bool {
        self.partial_cmp(&self).is_none()
    }
}

/// Nanoseconds in a second.
pub(crate) const NS_PER_S: i64 = 1_000_000_000;

/// √(a² + b²) without squares that leave the range; not a number where one of the two is none.
pub(crate) fn hypot<S: Scalar>(a: S, b: S) -> S {
    let (large, small) = if a.abs() > b.abs() { (a.abs(), b.abs()) } else { (b.abs(), a.abs()) };
    // Zero, infinite, or not a number: no quotient of the two is one.
    if !(large > S::ZERO && large.is_finite()) {
        return large + small;
    }
    let part = small / large;
    large * (S::ONE + part * part).sqrt()
}

/// The exponent of the smallest power of two above the sizes of all of these.
pub(crate) fn size_of_all<S: Scalar, const N: usize>(values: [S; N]) -> i32 {
    values.into_iter().fold(i32::MIN, |most, value| most.max(value.size()))
}

/// The reciprocal of a positive number; zero for any other.
#[cfg_attr(not(target_has_atomic = "32"), inline(never))]
pub(crate) fn over<S: Scalar>(value: S) -> S {
    if value > S::ZERO { value.reciprocal() } else { S::ZERO }
}

/// Natural logarithm of a positive number, good to 10⁻⁶ or what the type resolves; that of the nearest power of two
/// within 2⁻⁴⁰ to 2⁴⁰ beyond.
pub(crate) fn ln<S: Scalar>(x: S) -> S {
    let (half, two) = (S::ratio(1, 2), S::ONE + S::ONE);
    let (mut part, mut halvings) = (x, 0);
    // To 0.7 to 1.4, where the series below is short.
    while part > S::ratio(7, 5) && halvings < 40 {
        (part, halvings) = (part * half, halvings + 1);
    }
    while part < S::ratio(7, 10) && halvings > -40 {
        (part, halvings) = (part * two, halvings - 1);
    }
    // ln x = 2 artanh((x − 1)/(x + 1))
    let t = (part - S::ONE) / (part + S::ONE);
    let square = t * t;
    let parts = [S::ratio(1, 9), S::ratio(1, 7), S::ratio(1, 5), S::ratio(1, 3)];
    let series = parts.into_iter().fold(S::ZERO, |sum, part| (sum + part) * square);
    S::from_i32(halvings) * S::ratio(693_147, 1_000_000) + two * t * (S::ONE + series)
}

/// A single in double precision, from its bits: cores with a unit for single precision have routines for doubles, which
/// are not linked for the number in an error.
#[cfg(any(feature = "libm", feature = "micromath"))]
pub(super) const fn widened(value: f32) -> f64 {
    let bits = value.to_bits();
    let (sign, exponent, mantissa) = ((bits >> 31) as u64, (bits >> 23) & 0xff, (bits & 0x7f_ffff) as u64);
    let (exponent, mantissa) = match (exponent, mantissa) {
        (0, 0) => (0, 0),
        // Below the smallest normal number: 2⁻¹⁴⁹ times the mantissa.
        (0, mantissa) => {
            let zeros = mantissa.leading_zeros();
            (1023 - 149 + 63 - zeros as u64, (mantissa << (zeros - 11)) & ((1 << 52) - 1))
        }
        (0xff, mantissa) => (0x7ff, mantissa << 29),
        (exponent, mantissa) => (exponent as u64 + 1023 - 127, mantissa << 29),
    };
    f64::from_bits((sign << 63) | (exponent << 52) | mantissa)
}
