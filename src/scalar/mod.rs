//! The numbers that the solver runs on.
//!
//! A back end is a type, never a switch: each feature *adds* implementations and no feature changes what another type
//! computes. Generic code calls nothing but this trait, so a result has the same bits on a desktop and on a board.
//!
//! | type | feature | arithmetic | trigonometry |
//! | --- | --- | --- | --- |
//! | `f32`, `f64` | `libm` | native | `libm` |
//! | [`Micro`] | `micromath` | native `f32` | `micromath`, coarse |
//! | [`Q32`] | `fixed` | 31 bits and a power of two, integers only | the same |
//!
//! What is near one and shares a power of two with others (rays, equations) is a [`Near`]: the floating-point number
//! itself, or 32 bits beside [`Q32`], which cost half as much.

mod product;
mod near;
mod scalar;
mod whole;
mod vector;
#[cfg(feature = "fixed")]
mod mantissa;
#[cfg(feature = "fixed")]
mod fixed;
#[cfg(feature = "fixed")]
mod fixed_arithmetic;
#[cfg(feature = "fixed")]
mod fixed_trigonometry;
#[cfg(feature = "fixed")]
mod fixed_near;
#[cfg(feature = "fixed")]
mod fixed_kept;
#[cfg(feature = "fixed")]
mod fixed_scalar;
#[cfg(feature = "libm")]
mod root;
#[cfg(feature = "libm")]
mod libm;
#[cfg(feature = "micromath")]
mod micromath;

#[cfg(feature = "micromath")]
pub use self::micromath::Micro;
#[cfg(feature = "fixed")]
pub use fixed::Q32;
pub(crate) use near::{Arithmetic, Near, near_add, near_cross, near_dot};
pub(crate) use product::product_over_32_bits;
pub use scalar::Scalar;
pub(crate) use scalar::{NS_PER_S, hypot, ln, over, size_of_all};
pub(crate) use vector::{add, cross, dot, on_axis, scale, sub};
pub(crate) use whole::Whole;
