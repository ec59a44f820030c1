//! Sums, products, quotients and order of [`Q32`].

use core::cmp::Ordering;
use core::ops::{Add, Div, Mul, Neg, Sub};

use super::fixed::{INFINITE, LARGEST, Q32, SMALLEST};
use super::mantissa::reciprocal;
use super::product::product;
use super::scalar::Scalar;

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
pub(super) fn product_plus(a: Q32, b: Q32, number: Q32) -> Q32 {
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
        if other.mantissa == 0 || self.is_infinite() {
            return Self::bounded(if self.mantissa < 0 { i32::MIN } else { i32::MAX }, INFINITE);
        }
        self * other.inverse()
    }
}

impl Q32 {
    /// One over a number that is not zero.
    #[inline(always)]
    pub(super) fn inverse(self) -> Self {
        let size = reciprocal(self.mantissa.unsigned_abs());
        Self { mantissa: if self.mantissa < 0 { -size } else { size }, exponent: -61 - self.exponent }
    }
}

impl PartialOrd for Q32 {
    #[inline(never)]
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
