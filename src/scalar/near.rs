//! [`Near`]: numbers about one, which share a power of two that is kept beside them.

use core::fmt::Debug;
use core::ops::{Add, Neg, Sub};

/// A part of a vector, of an equation or of a whole problem whose other parts are of about the same size: its value is
/// itself times a power of two that all of them share. Floating point needs no such exponent, which is zero there;
/// fixed point needs no more than one word.
///
/// In size below 8. Products are cut off, in fixed point, at 2⁻²⁸; sums of products are not.
pub trait Near: Arithmetic + Debug + sealed::Sealed {
    /// A sum of products.
    type Sum: Copy;
    /// A number of any size, as a factor.
    type Factor: Copy;

    const NO_SUM: Self::Sum;
    /// Whether it holds numbers of any size.
    const IS_WIDE: bool;

    /// Times a power of two where that is below one in size; and its exponent, or zero where it is not.
    fn magnified(self) -> (Self, i32);

    /// Over a power of two, of zero or more.
    fn over_power_of_two(self, exponent: i32) -> Self;

    /// `self - a * b`; the largest number of its sign where that is larger.
    fn minus_scaled(self, a: Self, by: Self::Factor) -> Self;

    /// The product with a factor of any size; the largest number of its sign where it is larger.
    fn scaled(self, by: Self::Factor) -> Self;

    /// `sum + a * b`.
    fn sum_and(sum: Self::Sum, a: Self, b: Self) -> Self::Sum;
}

/// What formulas need that are meant for numbers near one and for [`Whole`](super::Whole) ones.
pub trait Arithmetic:
    Copy + PartialEq + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Neg<Output = Self>
{
    const ZERO: Self;

    /// `numerator / denominator`, for constants.
    fn ratio(numerator: i32, denominator: i32) -> Self;

    /// Half of it.
    fn half(self) -> Self;

    /// The product.
    fn times(self, other: Self) -> Self;

    /// `self + a * b`.
    fn plus_product(self, a: Self, b: Self) -> Self;

    /// `self - a * b`.
    fn minus_product(self, a: Self, b: Self) -> Self;

    /// The quotient.
    fn over(self, other: Self) -> Self;

    /// The absolute value.
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }
}

pub(crate) fn near_dot<N: Arithmetic>(a: [N; 3], b: [N; 3]) -> N {
    let [ax, ay, az] = a;
    let [bx, by, bz] = b;
    ax.times(bx).plus_product(ay, by).plus_product(az, bz)
}

pub(crate) fn near_cross<N: Arithmetic>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    let [ax, ay, az] = a;
    let [bx, by, bz] = b;
    let minor = |a: N, b: N, c: N, d: N| a.times(b).minus_product(c, d);
    [minor(ay, bz, az, by), minor(az, bx, ax, bz), minor(ax, by, ay, bx)]
}

pub(crate) fn near_add<N: Arithmetic>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    let [ax, ay, az] = a;
    let [bx, by, bz] = b;
    [ax + bx, ay + by, az + bz]
}

/// Floating point is near any number.
#[cfg(any(feature = "libm", feature = "micromath"))]
macro_rules! near_itself {
    ($float:ty) => {
        impl $crate::scalar::near::Near for $float {
            type Sum = Self;
            type Factor = Self;

            const NO_SUM: Self = <Self as Scalar>::ZERO;
            const IS_WIDE: bool = true;

            fn magnified(self) -> (Self, i32) {
                (self, 0)
            }

            fn over_power_of_two(self, _: i32) -> Self {
                self
            }

            fn minus_scaled(self, a: Self, by: Self) -> Self {
                self - a * by
            }

            fn scaled(self, by: Self) -> Self {
                self * by
            }

            fn sum_and(sum: Self, a: Self, b: Self) -> Self {
                sum + a * b
            }
        }

        impl $crate::scalar::near::Arithmetic for $float {
            const ZERO: Self = <Self as Scalar>::ZERO;

            #[inline(always)]
            fn ratio(numerator: i32, denominator: i32) -> Self {
                <Self as Scalar>::ratio(numerator, denominator)
            }

            fn half(self) -> Self {
                <Self as Scalar>::half(self)
            }

            fn times(self, other: Self) -> Self {
                self * other
            }

            fn plus_product(self, a: Self, b: Self) -> Self {
                self + a * b
            }

            fn minus_product(self, a: Self, b: Self) -> Self {
                self - a * b
            }

            fn over(self, other: Self) -> Self {
                self / other
            }

            fn abs(self) -> Self {
                Scalar::abs(self)
            }
        }
    };
}
#[cfg(any(feature = "libm", feature = "micromath"))]
pub(super) use near_itself;

/// The conversions of a [`Scalar`](super::Scalar) that is near any number itself.
#[cfg(any(feature = "libm", feature = "micromath"))]
macro_rules! scalar_near_itself {
    () => {
        type Near = Self;
        type Kept = Self;

        fn size(self) -> i32 {
            0
        }

        fn near(self, _: i32) -> Self {
            self
        }

        fn of_near(near: Self, _: i32) -> Self {
            near
        }

        fn of_sum(sum: Self, _: i32) -> Self {
            sum
        }

        fn factor(self, _: i32) -> Self {
            self
        }

        fn kept(self) -> Self {
            self
        }

        fn of_kept(kept: Self) -> Self {
            kept
        }
    };
}
#[cfg(any(feature = "libm", feature = "micromath"))]
pub(super) use scalar_near_itself;

pub(super) mod sealed {
    pub trait Sealed {}
}
