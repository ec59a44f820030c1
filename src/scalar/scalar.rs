//! [`Scalar`]: what a number of a back end must be able to do.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A real number of one of the back ends.
///
/// *Range*: at least ±2·10⁹ with a resolution of 2.4·10⁻¹⁰ or 24 bits, whichever is coarser. What leaves the range
/// becomes infinite (floating point) or the largest number (fixed point), never a panic; so does a division by zero.
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
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The relative spacing of numbers near one: steps below it are rounding.
    const EPSILON: Self;
    /// 10⁶: where a sigma of inverse depth is cut off. Beyond it nothing is known.
    const UNKNOWN: Self;

    /// The whole number `value`, rounded where the type has fewer bits.
    fn from_i32(value: i32) -> Self;
    /// `numerator / denominator`, rounded once or twice; zero where the denominator is zero.
    fn from_ratio(numerator: i64, denominator: i64) -> Self;
    /// The nearest number; out of range saturates in fixed point, and NaN becomes zero there.
    fn from_f64(value: f64) -> Self;
    /// The value in double precision.
    fn to_f64(self) -> f64;
    /// Neither NaN nor infinite nor at the end of the range.
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

    /// `value`/`denominator` of two small whole numbers, for constants in formulas.
    fn ratio(numerator: i32, denominator: i32) -> Self {
        Self::from_i32(numerator) / Self::from_i32(denominator)
    }

    /// The absolute value.
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }

    /// The larger of two numbers; the other one where one is not a number.
    fn max(self, other: Self) -> Self {
        if self >= other || other.is_nan() { self } else { other }
    }

    /// The smaller of two numbers; the other one where one is not a number.
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

/// Natural logarithm of a positive number, good to 10⁻⁶ or what the type resolves; that of the nearest power of two within
/// 2⁻⁴⁰ to 2⁴⁰ beyond.
pub(crate) fn ln<S: Scalar>(x: S) -> S {
    let (half, two) = (S::ratio(1, 2), S::ONE + S::ONE);
    let (mut part, mut halvings) = (x, 0);
    // To 0.7 to 1.4, where the series below is short.
    for _ in 0..40 {
        if part > S::ratio(7, 5) {
            (part, halvings) = (part * half, halvings + 1);
        } else if part < S::ratio(7, 10) {
            (part, halvings) = (part * two, halvings - 1);
        }
    }
    // ln x = 2 artanh((x − 1)/(x + 1))
    let t = (part - S::ONE) / (part + S::ONE);
    let square = t * t;
    let series = [9, 7, 5, 3].into_iter().fold(S::ZERO, |sum, k| (sum + S::ratio(1, k)) * square);
    S::from_i32(halvings) * S::ratio(693_147, 1_000_000) + two * t * (S::ONE + series)
}

pub(super) mod sealed {
    pub trait Sealed {}
}
