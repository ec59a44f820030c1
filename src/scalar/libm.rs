//! `f32` and `f64` on `libm`: the same bits on every machine.

use super::near::{near_itself, scalar_near_itself, sealed};
use super::root::{root, root_of_single};
use super::scalar::{Scalar, widened};

/// The two types differ in nothing but their names; a back end's functions are called by full path, because the
/// inherent methods that std adds on a desktop would win silently and give other bits.
macro_rules! scalar_on_libm {
    ($float:ident, $widened:path, $sqrt:path, $sin:ident, $cos:ident, $tan:ident, $atan:ident) => {
        impl sealed::Sealed for $float {}

        near_itself!($float);

        impl Scalar for $float {
            scalar_near_itself!();

            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = $float::EPSILON;
            const UNKNOWN: Self = 1e6;

            fn from_i32(value: i32) -> Self {
                value as Self
            }

            fn from_i64(value: i64) -> Self {
                // Not inlined: both would be converted, and one of them chosen.
                #[cold]
                #[inline(never)]
                fn of_wide(value: i64) -> $float {
                    value as $float
                }
                // Most fit into 32 bits, which some cores convert by an instruction.
                match i32::try_from(value) {
                    Ok(small) => small as Self,
                    Err(_) => of_wide(value),
                }
            }

            fn from_ratio(numerator: i64, denominator: i64) -> Self {
                if denominator == 0 {
                    return 0.0;
                }
                Self::from_i64(numerator) / Self::from_i64(denominator)
            }

            fn from_f64(value: f64) -> Self {
                value as Self
            }

            fn to_f64(self) -> f64 {
                $widened(self)
            }

            fn to_i64(self) -> i64 {
                self as i64
            }

            fn to_i32(self) -> i32 {
                self as i32
            }

            fn abs(self) -> Self {
                $float::abs(self)
            }

            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }

            fn sqrt(self) -> Self {
                $sqrt(self)
            }

            fn sin(self) -> Self {
                ::libm::$sin(self)
            }

            fn cos(self) -> Self {
                ::libm::$cos(self)
            }

            fn tan(self) -> Self {
                ::libm::$tan(self)
            }

            fn atan(self) -> Self {
                ::libm::$atan(self)
            }
        }
    };
}

scalar_on_libm!(f32, widened, root_of_single, sinf, cosf, tanf, atanf);
scalar_on_libm!(f64, core::convert::identity, root, sin, cos, tan, atan);
