//! [`Q32`]: a 32-bit integer with a scale of its own, for cores without floating point.

use core::cmp::Ordering;
use core::ops::{Add, Div, Mul, Neg, Sub};

use ::fixed::types::I32F32;

use super::mantissa::{product, reciprocal, root};
use super::scalar::{Scalar, sealed};

/// A number of 31 bits and a power of two, from 2⁻¹²⁶ to 2¹²⁷ in size, in integer arithmetic only: no product or quotient has
/// more than 64 bits, and none is made by a division. What leaves the range becomes the largest number, which
/// [`is_finite`](Scalar::is_finite) tells, or zero.
///
/// Sums, products, quotients and roots are good to 4·10⁻⁹ of the larger operand or of the result. The trigonometric
/// functions are good to 4·10⁻⁹ (tangent: relative to 1 + tan²) for angles up to 2π.
///
/// ```
/// use fixed::types::I32F32;
/// use shutter_range::Q32;
/// let focal_px = Q32::from(I32F32::lit("612.5"));
/// let sum = (focal_px / focal_px + focal_px).to_fixed();
/// assert!(sum.abs_diff(I32F32::lit("613.5")) < 613.5 * 4e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Q32 {
    /// Zero, or in size from 2³⁰ to 2³¹ − 1.
    mantissa: i32,
    /// The value is mantissa · 2^exponent.
    exponent: i32,
}

impl sealed::Sealed for Q32 {}

/// A larger exponent is that of a number that has left the range.
const LARGEST: i32 = 96;
const SMALLEST: i32 = -156;
/// Of what has left the range: so large that it stays outside in any product.
const INFINITE: i32 = 1 << 24;
/// Of zero: so small that any other number swallows it in a sum, and that it stays zero in any product.
const OF_ZERO: i32 = -(1 << 25);

impl Q32 {
    /// A mantissa whose size is from 2³⁰ to 2³¹ − 1.
    #[inline(always)]
    const fn bounded(mantissa: i32, exponent: i32) -> Self {
        if exponent > LARGEST {
            return Self { mantissa: if mantissa < 0 { -i32::MAX } else { i32::MAX }, exponent: INFINITE };
        }
        if exponent < SMALLEST {
            return Self::ZERO;
        }
        Self { mantissa, exponent }
    }

    /// Any mantissa.
    #[inline(always)]
    const fn normalised(mantissa: i32, exponent: i32) -> Self {
        match mantissa.unsigned_abs().leading_zeros() as i32 {
            1 => Self { mantissa, exponent },
            32 => Self::ZERO,
            0 => Self::bounded(mantissa >> 1, exponent + 1),
            zeros => Self::bounded(mantissa << (zeros - 1), exponent - (zeros - 1)),
        }
    }

    /// A size of up to 64 bits, and a sign.
    #[inline(always)]
    const fn of_size(is_negative: bool, size: u64, exponent: i32) -> Self {
        if size == 0 {
            return Self::ZERO;
        }
        let zeros = size.leading_zeros() as i32;
        let shifted = size << zeros;
        let rounded = (shifted >> 33) as u32 + ((shifted >> 32) & 1) as u32;
        // Rounding up can carry to 2³¹.
        let (mantissa, carry) = if rounded >> 31 == 0 { (rounded as i32, 0) } else { (1 << 30, 1) };
        Self::bounded(if is_negative { -mantissa } else { mantissa }, exponent + 33 - zeros + carry)
    }

    /// The whole part, rounded down; the largest number of its sign where it is larger.
    fn floor(self) -> i64 {
        let wide = i64::from(self.mantissa);
        match self.exponent {
            exponent @ 0..=32 => wide << exponent,
            exponent @ -63..0 => wide >> -exponent,
            exponent if exponent < 0 => wide >> 63,
            _ if wide < 0 => i64::MIN,
            _ => i64::MAX,
        }
    }

    /// As a number of the crate `fixed`, rounded down; the largest of its sign where it is larger.
    #[must_use]
    pub fn to_fixed(self) -> I32F32 {
        I32F32::from_bits(self.times_power_of_two(32).floor())
    }

    fn times_power_of_two(self, power: i32) -> Self {
        if self.mantissa == 0 { self } else { Self::bounded(self.mantissa, self.exponent + power) }
    }

    const fn is_infinite(self) -> bool {
        self.exponent > LARGEST
    }
}

impl From<I32F32> for Q32 {
    fn from(value: I32F32) -> Self {
        Self::from_i64(value.to_bits()).times_power_of_two(-32)
    }
}

impl Default for Q32 {
    fn default() -> Self {
        Self::ZERO
    }
}

impl Add for Q32 {
    type Output = Self;

    #[inline(never)]
    fn add(self, other: Self) -> Self {
        // Without overflow: exponents are far from those of the integers.
        let shift = self.exponent - other.exponent;
        if shift < 0 { other.add_smaller(self.mantissa, -shift) } else { self.add_smaller(other.mantissa, shift) }
    }
}

impl Q32 {
    /// The sum with a number whose exponent is lower by `shift`.
    // Inlined twice: choosing between the two numbers takes as long as adding them.
    #[inline(always)]
    const fn add_smaller(self, mantissa: i32, shift: i32) -> Self {
        if shift > 31 {
            return self;
        }
        self.add_aligned(mantissa >> shift)
    }

    /// The sum with a mantissa of the same exponent.
    #[inline(always)]
    const fn add_aligned(self, mantissa: i32) -> Self {
        let (sum, overflows) = self.mantissa.overflowing_add(mantissa);
        if overflows {
            // The sign bit is the one that was lost.
            return Self::bounded((sum >> 1) ^ i32::MIN, self.exponent + 1);
        }
        // Most sums need no shift: sign and leading bit differ. Not the smallest integer.
        let twice = sum << 1;
        if twice != 0 && (twice ^ sum) < 0 {
            return Self { mantissa: sum, exponent: self.exponent };
        }
        // Others need one, and not every core counts zeros.
        match sum.unsigned_abs() >> 29 {
            2 => Self { mantissa: sum, exponent: self.exponent },
            _ if self.is_infinite() => self,
            1 => Self::bounded(sum << 1, self.exponent - 1),
            _ => Self::normalised(sum, self.exponent),
        }
    }
}

impl Sub for Q32 {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Q32 {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        // A mantissa is never the smallest integer.
        Self { mantissa: self.mantissa.wrapping_neg(), ..self }
    }
}

impl Mul for Q32 {
    type Output = Self;

    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let exponent = self.exponent + other.exponent + 30;
        // Half of all factors are zero where the camera is level, and a zero has an exponent far below.
        if !(SMALLEST..LARGEST).contains(&exponent) {
            return self.mul_beyond(other);
        }
        let (mantissa, carry) = product_of_mantissas(self.mantissa, other.mantissa);
        Self { mantissa, exponent: exponent + carry }
    }
}

impl Q32 {
    /// A product that is zero, or that leaves the range or nearly does.
    #[inline(never)]
    fn mul_beyond(self, other: Self) -> Self {
        if self.mantissa == 0 || other.mantissa == 0 {
            return Self::ZERO;
        }
        let (mantissa, carry) = product_of_mantissas(self.mantissa, other.mantissa);
        Self::bounded(mantissa, self.exponent + other.exponent + 30 + carry)
    }
}

/// The product of two mantissas over 2³⁰, or over 2³¹ where that does not fit, and which of the two.
#[inline(always)]
fn product_of_mantissas(a: i32, b: i32) -> (i32, i32) {
    let (high, low) = product(a, b);
    // Below 2²⁹ in size the third bit from above is a sign as well.
    let fourfold = high << 2;
    if (fourfold ^ high) < 0 {
        ((high << 1) | (low >> 31) as i32, 1)
    } else if fourfold << 1 == 0 {
        (-1 << 30, 1)
    } else {
        (fourfold | (low >> 30) as i32, 0)
    }
}

/// The sum of a product and a number: normalises once, where a product and a sum do so twice.
// The number comes last, on the stack, and is needed last.
#[inline(never)]
fn product_plus(a: Q32, b: Q32, number: Q32) -> Q32 {
    let exponent = a.exponent + b.exponent + 31;
    if !(SMALLEST..LARGEST).contains(&exponent) {
        return product_plus_beyond(a, b, number);
    }
    let (high, low) = product(a.mantissa, b.mantissa);
    // From 2²⁹ to 2³¹ in size.
    let mantissa = (high << 1) | (low >> 31) as i32;
    let shift = number.exponent - exponent;
    if shift >= 0 {
        return number.add_smaller(mantissa, shift);
    }
    let smaller = if shift < -31 { 0 } else { number.mantissa >> -shift };
    Q32 { mantissa, exponent }.add_aligned(smaller)
}

/// A product that is zero, or that leaves the range or nearly does.
#[inline(never)]
fn product_plus_beyond(a: Q32, b: Q32, number: Q32) -> Q32 {
    if a.mantissa == 0 || b.mantissa == 0 { number } else { number + a * b }
}

impl Div for Q32 {
    type Output = Self;

    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let size = other.mantissa.unsigned_abs();
        if size == 0 || self.is_infinite() {
            return Self::bounded(if self.mantissa < 0 { i32::MIN } else { i32::MAX }, INFINITE);
        }
        let reciprocal = reciprocal(size);
        let mantissa = if other.mantissa < 0 { -reciprocal } else { reciprocal };
        self * Self { mantissa, exponent: -61 - other.exponent }
    }
}

impl PartialOrd for Q32 {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let signs = self.mantissa.signum().cmp(&other.mantissa.signum());
        let sizes = || (self.exponent, self.mantissa).cmp(&(other.exponent, other.mantissa));
        let by_size = || (other.exponent, self.mantissa).cmp(&(self.exponent, other.mantissa));
        Some(signs.then_with(|| if self.mantissa < 0 { by_size() } else { sizes() }))
    }

    #[inline]
    fn gt(&self, other: &Self) -> bool {
        other < self
    }

    #[inline(never)]
    fn lt(&self, other: &Self) -> bool {
        let (a, b) = (self.mantissa, other.mantissa);
        // A zero, or different signs: the mantissas tell.
        if (a ^ b) < 0 || a == 0 || b == 0 || self.exponent == other.exponent {
            return a < b;
        }
        (self.exponent < other.exponent) == (a > 0)
    }

    #[inline]
    fn ge(&self, other: &Self) -> bool {
        !(self < other)
    }

    #[inline]
    fn le(&self, other: &Self) -> bool {
        !(other < self)
    }
}

/// π/2 in two parts, of which the second continues the first.
const HALF_PI: [Q32; 2] = [Q32::normalised(1_686_629_713, -30), Q32::normalised(70064198, -60)];

/// Sum of `x^(2k) / ((start + 1)(start + 2)…)` with alternating signs: the series of sine (start 1) and cosine (0).
fn alternating_series(square: Q32, start: i32) -> Q32 {
    let mut sum = Q32::ONE;
    let mut order = start + 12;
    while order > start {
        sum = Q32::ONE - square * sum / Q32::from_i32(order * (order - 1));
        order -= 2;
    }
    sum
}

/// Reduces an angle by the nearest multiple of π/2: the rest, within ±π/4, and the multiple modulo 4.
fn quadrant(angle: Q32) -> (Q32, i64) {
    let [high, low] = HALF_PI;
    let turns = (angle / high + Q32::ratio(1, 2)).floor();
    let whole = Q32::from_i64(turns);
    (angle - whole * high - whole * low, turns & 3)
}

fn sine_of_quadrant(small: Q32, quarter: i64) -> Q32 {
    let square = small * small;
    let value = if quarter & 1 == 0 { small * alternating_series(square, 1) } else { alternating_series(square, 0) };
    if quarter & 2 == 0 { value } else { -value }
}

impl Scalar for Q32 {
    const ZERO: Self = Self { mantissa: 0, exponent: OF_ZERO };
    const ONE: Self = Self { mantissa: 1 << 30, exponent: -30 };
    const EPSILON: Self = Self { mantissa: 1 << 30, exponent: -60 };
    const UNKNOWN: Self = Self::normalised(1_000_000, 0);

    fn from_i32(value: i32) -> Self {
        Self::normalised(value, 0)
    }

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

    fn sin(self) -> Self {
        let (small, quarter) = quadrant(self);
        sine_of_quadrant(small, quarter)
    }

    fn cos(self) -> Self {
        let (small, quarter) = quadrant(self);
        sine_of_quadrant(small, (quarter + 1) & 3)
    }

    fn tan(self) -> Self {
        self.sin() / self.cos()
    }

    /// A rational approximation, refined by two Newton steps.
    fn atan(self) -> Self {
        let steep = self.abs() > Self::ONE;
        let slope = if steep { Self::ONE / self } else { self };
        // Within 0.005 rad for |slope| ≤ 1.
        let mut angle = slope / (Self::ONE + Self::ratio(9, 32) * slope * slope);
        for _ in 0..2 {
            let (sine, cosine) = (angle.sin(), angle.cos());
            angle = angle + (slope * cosine - sine) / (cosine + slope * sine);
        }
        let [half_pi, _] = HALF_PI;
        match steep {
            true if self < Self::ZERO => -half_pi - angle,
            true => half_pi - angle,
            false => angle,
        }
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Q32 {
    /// Writes mantissa and exponent, so that nothing is lost.
    fn serialize<T: serde::Serializer>(&self, serializer: T) -> Result<T::Ok, T::Error> {
        serde::Serialize::serialize(&(self.mantissa, self.exponent), serializer)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Q32 {
    fn deserialize<T: serde::Deserializer<'de>>(deserializer: T) -> Result<Self, T::Error> {
        let (mantissa, exponent) = <(i32, i32) as serde::Deserialize>::deserialize(deserializer)?;
        Ok(Self::normalised(mantissa, exponent.clamp(OF_ZERO, INFINITE)))
    }
}
