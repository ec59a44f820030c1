//! [`Factor`]: a number to multiply with, so that no product is longer than 32 bits.

/// A number above zero with fifteen significant bits: its mantissa over 2 to the power of its shift. A product with it
/// is taken in two steps: [`Factor::times`] for the digits, as often as there are factors, and [`shifted`] once for the
/// point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Factor {
    /// At least 2¹⁴.
    mantissa: i16,
    shift: i8,
}

impl Factor {
    pub(super) const ONE: Self = Self { mantissa: 1 << 14, shift: 14 };

    /// A number over 2 to this power; that of zero is that of one.
    pub(super) const fn of(number: u32, power: i8) -> Self {
        let number = if number > 0 { number } else { 1 };
        let bits = 32 - number.leading_zeros() as i8;
        let mantissa = if bits > 15 { number >> (bits - 15) } else { number << (15 - bits) };
        Self { mantissa: mantissa as i16, shift: power + 15 - bits }
    }

    /// The product of two.
    pub(super) const fn and(self, other: Self) -> Self {
        Self::of(self.mantissa as u32 * other.mantissa as u32, self.shift + other.shift)
    }

    /// The product of two, with thirteen significant bits at least.
    #[inline(always)]
    pub(super) const fn roughly_and(self, other: Self) -> Self {
        Self {
            mantissa: ((self.mantissa as i32 * other.mantissa as i32) >> 15) as i16,
            shift: self.shift + other.shift - 15,
        }
    }

    /// A product, times 2 to the power of [`Factor::lost`], rounded down.
    #[inline(always)]
    pub(super) const fn times(self, value: i32) -> i32 {
        upper(value, self.mantissa)
    }

    /// A whole product, rounded down, with a value as far as that has 28 bits; the factor is over 2 to the power of 12
    /// to 43.
    #[inline(always)]
    pub(super) fn product(self, value: i32) -> i32 {
        upper(value.clamp(-(1 << 27), (1 << 27) - 1) << 4, self.mantissa) >> ((self.shift - 12) & 31)
    }

    /// What [`Factor::times`] leaves out of the shift.
    pub(super) const fn lost(self) -> i32 {
        self.shift as i32 - 16
    }
}

/// Upper part of a product, without its lower sixteen bits.
#[inline(always)]
pub(super) const fn upper(value: i32, factor: i16) -> i32 {
    if cfg!(target_has_atomic = "32") {
        // One instruction on cores for signals.
        return ((value as i64 * factor as i64) >> 16) as i32;
    }
    // Where there is no atomic word there is no longer product either.
    (value >> 16) * factor as i32 + (((value & 0xFFFF) * factor as i32) >> 16)
}

/// Times 2 to this power, between −31 and 31, as far as it fits.
#[inline(always)]
pub(super) fn shifted(value: i32, power: i32) -> i32 {
    if power <= 0 {
        return value >> (-power).min(31);
    }
    let most = i32::MAX >> power.min(31);
    value.clamp(-most, most) << power.min(31)
}

#[cfg(test)]
mod tests {
    use super::{Factor, shifted, upper};

    #[test]
    fn it_is_the_upper_part_of_a_product() {
        for value in [i32::MIN, i32::MIN + 1, -65_537, -65_536, -1, 0, 1, 65_535, 1_234_567, i32::MAX] {
            for factor in [i16::MIN, -1, 0, 1, 1 << 14, 20_000, i16::MAX] {
                let product = (i64::from(value) * i64::from(factor)) >> 16;
                assert_eq!(i64::from(upper(value, factor)), product, "{value} times {factor}");
            }
        }
    }

    /// Within a part in 2¹⁴ for each factor, and saturated.
    #[test]
    fn it_multiplies() {
        for (number, power) in [(3_u32, 0_i8), (65_536, 7), (u32::MAX, 32), (1_000_003, 20), (1, -3)] {
            let factor = Factor::of(number, power);
            let exact = f64::from(number) / libm::exp2(f64::from(power));
            for value in [1_i32 << 20, -(1 << 20), 77_777_777] {
                let found = shifted(factor.times(value), -factor.lost());
                let expected = (f64::from(value) * exact).clamp(-2_147_483_647.0, 2_147_483_647.0);
                let off = (f64::from(found) - expected).abs();
                assert!(off <= 1.0 + expected.abs() / 16_384.0 + exact, "{value} times {exact}: {found}");
            }
        }
    }
}
