//! [`Q32`]: a 32-bit integer with a scale of its own, for cores without floating point.

use ::fixed::types::I32F32;

use super::near::sealed;
use super::scalar::Scalar;

/// A number of 31 bits and a power of two, from 2⁻¹²⁶ to 2¹²⁷ in size, in integer arithmetic only: no product or
/// quotient has more than 64 bits, and none is made by a division. What leaves the range becomes the largest number,
/// which [`is_finite`](Scalar::is_finite) tells, or zero.
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
    pub(super) mantissa: i32,
    /// The value is mantissa · 2^exponent.
    pub(super) exponent: i32,
}

impl sealed::Sealed for Q32 {}

/// A larger exponent is that of a number that has left the range.
pub(super) const LARGEST: i32 = 96;
pub(super) const SMALLEST: i32 = -156;
/// Of what has left the range: so large that it stays outside in any product.
pub(super) const INFINITE: i32 = 1 << 24;
/// Of zero: so small that any other number swallows it in a sum, and that it stays zero in any product.
pub(super) const OF_ZERO: i32 = -(1 << 25);

impl Q32 {
    /// A mantissa whose size is from 2³⁰ to 2³¹ − 1.
    #[inline(always)]
    pub(super) const fn bounded(mantissa: i32, exponent: i32) -> Self {
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
    pub(super) const fn normalised(mantissa: i32, exponent: i32) -> Self {
        match mantissa.unsigned_abs().leading_zeros() as i32 {
            1 => Self { mantissa, exponent },
            32 => Self::ZERO,
            0 => Self::bounded(mantissa >> 1, exponent + 1),
            zeros => Self::bounded(mantissa << (zeros - 1), exponent - (zeros - 1)),
        }
    }

    /// A size of up to 64 bits, and a sign.
    #[inline(always)]
    pub(super) const fn of_size(is_negative: bool, size: u64, exponent: i32) -> Self {
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
    pub(super) fn floor(self) -> i64 {
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

    #[inline(never)]
    pub(super) fn times_power_of_two(self, power: i32) -> Self {
        if self.mantissa == 0 { self } else { Self::bounded(self.mantissa, self.exponent + power) }
    }

    pub(super) const fn is_infinite(self) -> bool {
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
