//! [`Whole`]: any [`Scalar`] where a formula is also meant for numbers near one.

use core::ops::{Add, Neg, Sub};

use super::near::Arithmetic;
use super::scalar::Scalar;

/// A number of any size.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
pub(crate) struct Whole<S>(pub(crate) S);

impl<S: Scalar> Add for Whole<S> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl<S: Scalar> Sub for Whole<S> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl<S: Scalar> Neg for Whole<S> {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<S: Scalar> Arithmetic for Whole<S> {
    const ZERO: Self = Self(S::ZERO);

    #[inline(always)]
    fn ratio(numerator: i32, denominator: i32) -> Self {
        Self(S::ratio(numerator, denominator))
    }

    fn half(self) -> Self {
        Self(self.0.half())
    }

    fn times(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }

    fn plus_product(self, a: Self, b: Self) -> Self {
        Self(self.0.plus_product(a.0, b.0))
    }

    fn minus_product(self, a: Self, b: Self) -> Self {
        Self(self.0.minus_product(a.0, b.0))
    }

    fn over(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}
