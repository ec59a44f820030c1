//! [`Kept`]: a [`Q32`] in one word.

use super::fixed::{INFINITE, Q32};
use super::scalar::Scalar;

/// The upper 24 bits of a mantissa, cut off, and its exponent in the lowest byte.
#[derive(Clone, Copy, Debug)]
pub struct Kept(i32);

/// What that byte is more than the exponent, so that it has room for each; the largest stands for what has left the
/// range.
const BIAS: i32 = 30;
const OUTSIDE: i32 = i8::MAX as i32;

impl Kept {
    #[inline]
    pub(super) const fn new(number: Q32) -> Self {
        let exponent = number.exponent + BIAS;
        let exponent = if exponent < OUTSIDE { exponent } else { OUTSIDE };
        // Towards zero: a mantissa is never the smallest integer.
        Self((number.mantissa - number.mantissa % 256) | (exponent & 0xff))
    }

    #[inline]
    pub(super) const fn number(self) -> Q32 {
        let mantissa = self.0 & !0xff;
        match self.0 as i8 as i32 {
            _ if mantissa == 0 => <Q32 as Scalar>::ZERO,
            OUTSIDE => Q32 { mantissa, exponent: INFINITE },
            exponent => Q32 { mantissa, exponent: exponent - BIAS },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::fixed::{LARGEST, SMALLEST};

    #[test]
    fn all_but_the_lowest_bits_are_kept() {
        for mantissa in [1 << 30, (1 << 30) + 255, 1_234_567_890, i32::MAX] {
            for exponent in [SMALLEST, -60, -30, 0, LARGEST] {
                for mantissa in [mantissa, -mantissa] {
                    let number = Q32 { mantissa, exponent };
                    let kept = number.kept().number();
                    assert_eq!(kept.exponent, exponent);
                    let off = mantissa - kept.mantissa;
                    assert!(off.abs() < 256 && off.signum() * mantissa.signum() >= 0, "{number:?} became {kept:?}");
                }
            }
        }
    }

    #[test]
    fn nothing_and_what_has_left_the_range_stay_what_they_are() {
        assert_eq!(Q32::ZERO.kept().number(), Q32::ZERO);
        let infinite = Q32::from_f64(1e300);
        assert!(!infinite.is_finite() && !infinite.kept().number().is_finite());
        assert!((-infinite).kept().number() < Q32::ZERO && !(-infinite).kept().number().is_finite());
    }
}
