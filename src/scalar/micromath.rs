//! [`Micro`]: native `f32` arithmetic with micromath's short trigonometry.

use core::ops::{Add, Div, Mul, Neg, Sub};

use ::micromath::F32Ext;

use super::near::{near_itself, scalar_near_itself, sealed};
use super::scalar::{Scalar, widened};

/// An `f32` whose trigonometry is micromath's: a few instructions, an error of a few 10⁻⁴ to 10⁻³.
///
/// Quotients are native and the root is refined to the last bit but one: micromath's own `sqrt` (off by up to 6 %) and
/// `inv` (up to 12 %) would end up in every distance.
///
/// By its root a frame of a sequence takes 11 % fewer instructions than in `f32` on a Cortex-M4F, and a line 5 to 6 %
/// (`cargo xtask budget --print --board M4F --backend f32 --backend micro`): worth it there where a sequence or much
/// trigonometry is what limits a frame. Without a floating-point unit it is slower, and its programs are no smaller.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Micro(pub f32);

impl sealed::Sealed for Micro {}

macro_rules! operator {
    ($trait:ident, $method:ident, $sign:tt) => {
        impl $trait for Micro {
            type Output = Self;

            fn $method(self, other: Self) -> Self {
                Self(self.0 $sign other.0)
            }
        }
    };
}

operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl Neg for Micro {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0)
    }
}

near_itself!(Micro);

impl Scalar for Micro {
    scalar_near_itself!();

    const ZERO: Self = Self(0.0);
    const ONE: Self = Self(1.0);
    const EPSILON: Self = Self(f32::EPSILON);
    const UNKNOWN: Self = Self(1e6);

    fn from_i32(value: i32) -> Self {
        Self(value as f32)
    }

    fn from_i64(value: i64) -> Self {
        // Not inlined: both would be converted, and one of them chosen.
        #[cold]
        #[inline(never)]
        fn of_wide(value: i64) -> f32 {
            value as f32
        }
        // Most fit into 32 bits, which the core converts by an instruction.
        Self(i32::try_from(value).map_or_else(|_| of_wide(value), |small| small as f32))
    }

    fn from_ratio(numerator: i64, denominator: i64) -> Self {
        if denominator == 0 {
            return Self(0.0);
        }
        Self::from_i64(numerator) / Self::from_i64(denominator)
    }

    fn from_f64(value: f64) -> Self {
        Self(value as f32)
    }

    fn to_f64(self) -> f64 {
        widened(self.0)
    }

    fn to_i64(self) -> i64 {
        self.0 as i64
    }

    fn to_i32(self) -> i32 {
        self.0 as i32
    }

    fn abs(self) -> Self {
        Self(f32::abs(self.0))
    }

    fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    fn sqrt(self) -> Self {
        // Zero for negative numbers; and below 1e-37 the refinement would meet subnormal numbers and not converge.
        if self.0 < 1e-37 {
            return Self(0.0);
        }
        if !self.0.is_finite() {
            return self; // NaN too
        }
        // Each of Newton's steps doubles the number of correct digits: errors of 6 %, 2e-3, 2e-6, 2e-12.
        let mut root = F32Ext::sqrt(self.0);
        for _ in 0..3 {
            root = 0.5 * (root + self.0 / root);
        }
        Self(root)
    }

    fn sin(self) -> Self {
        Self(F32Ext::sin(self.0))
    }

    fn cos(self) -> Self {
        Self(F32Ext::cos(self.0))
    }

    fn tan(self) -> Self {
        Self(F32Ext::tan(self.0))
    }

    fn atan(self) -> Self {
        Self(F32Ext::atan(self.0))
    }
}
