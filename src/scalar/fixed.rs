//! [`Q32`]: 32.32 fixed point, for cores without floating point.

use core::ops::{Add, Div, Mul, Neg, Sub};

use ::fixed::types::I32F32;

use super::scalar::{Scalar, sealed};

/// A fixed-point number of 32 whole and 32 fractional bits that saturates: ±2.1·10⁹ in steps of 2.3·10⁻¹⁰.
///
/// Everything is integer arithmetic; `from_f64` and `to_f64` are the only places where a float appears. The
/// trigonometric functions are good to 2·10⁻⁹ (tangent: relative to 1 + tan²) for angles up to 2π.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Q32(pub I32F32);

impl sealed::Sealed for Q32 {}

impl Add for Q32 {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl Sub for Q32 {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl Neg for Q32 {
    type Output = Self;

    fn neg(self) -> Self {
        Self(self.0.saturating_neg())
    }
}

impl Mul for Q32 {
    type Output = Self;

    /// Rounds to nearest: truncation would bias long sums.
    fn mul(self, other: Self) -> Self {
        let product = i128::from(self.0.to_bits()) * i128::from(other.0.to_bits());
        Self::saturate((product + (1 << 31)) >> 32)
    }
}

impl Div for Q32 {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let numerator = i128::from(self.0.to_bits()) << 32;
        match numerator.checked_div(i128::from(other.0.to_bits())) {
            Some(quotient) => Self::saturate(quotient),
            None if self < Self::ZERO => Self(I32F32::MIN),
            None => Self(I32F32::MAX),
        }
    }
}

impl Q32 {
    fn saturate(bits: i128) -> Self {
        let clamped = bits.clamp(i128::from(i64::MIN), i128::from(i64::MAX));
        Self(I32F32::from_bits(clamped as i64))
    }

    const fn constant(bits: i64) -> Self {
        Self(I32F32::from_bits(bits))
    }
}

/// π/2 in units of 2⁻³².
const HALF_PI: Q32 = Q32::constant(6_746_518_852);

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
    let turns = (angle / HALF_PI + Q32::ratio(1, 2)).0.to_bits() >> 32;
    let whole = HALF_PI.0.saturating_mul_int(turns);
    (angle - Q32(whole), turns & 3)
}

fn sine_of_quadrant(small: Q32, quarter: i64) -> Q32 {
    let square = small * small;
    let value = if quarter & 1 == 0 { small * alternating_series(square, 1) } else { alternating_series(square, 0) };
    if quarter & 2 == 0 { value } else { -value }
}

impl Scalar for Q32 {
    const ZERO: Self = Self::constant(0);
    const ONE: Self = Self::constant(1 << 32);
    const EPSILON: Self = Self::constant(1);
    const UNKNOWN: Self = Self::constant(1_000_000 << 32);

    fn from_i32(value: i32) -> Self {
        Self::constant(i64::from(value) << 32)
    }

    fn from_ratio(numerator: i64, denominator: i64) -> Self {
        let scaled = i128::from(numerator) << 32;
        scaled.checked_div(i128::from(denominator)).map_or(Self::ZERO, Self::saturate)
    }

    fn from_f64(value: f64) -> Self {
        if value.is_nan() { Self::ZERO } else { Self(I32F32::saturating_from_num(value)) }
    }

    fn to_f64(self) -> f64 {
        self.0.to_num()
    }

    fn is_finite(self) -> bool {
        self.0 != I32F32::MAX && self.0 != I32F32::MIN
    }

    fn sqrt(self) -> Self {
        let bits = self.0.to_bits();
        if bits <= 0 {
            return Self::ZERO;
        }
        Self::constant((bits.unsigned_abs() as u128).wrapping_shl(32).isqrt() as i64)
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
        match steep {
            true if self < Self::ZERO => -HALF_PI - angle,
            true => HALF_PI - angle,
            false => angle,
        }
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Q32 {
    /// Writes the bits, in units of 2⁻³², so that nothing is lost.
    fn serialize<T: serde::Serializer>(&self, serializer: T) -> Result<T::Ok, T::Error> {
        serializer.serialize_i64(self.0.to_bits())
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Q32 {
    fn deserialize<T: serde::Deserializer<'de>>(deserializer: T) -> Result<Self, T::Error> {
        <i64 as serde::Deserialize>::deserialize(deserializer).map(Self::constant)
    }
}
