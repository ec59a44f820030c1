//! Square roots of floating-point numbers, rounded to the nearest; zero for negative ones.

pub(super) fn root(value: f64) -> f64 {
    if value <= 0.0 { 0.0 } else { ::libm::sqrt(value) }
}

/// In the way that the core does best: the bits are the same.
pub(super) fn root_of_single(value: f32) -> f32 {
    // Where there is no atomic word there is no long product either, and six of them make a root in `libm`.
    if cfg!(target_has_atomic = "32") { by_libm(value) } else { by_digits(value) }
}

fn by_libm(value: f32) -> f32 {
    if value <= 0.0 { 0.0 } else { ::libm::sqrtf(value) }
}

/// Bits of a mantissa below its point, and the exponent of one.
const FRACTION: u32 = 23;
const BIAS: u32 = 127;

/// Digit by digit, from the first bit of the root to the last and one more, which rounds it.
#[inline(never)]
fn by_digits(value: f32) -> f32 {
    let bits = value.to_bits();
    let exponent = bits >> FRACTION;
    // Negative, infinite, not a number, or below the smallest normal number.
    if exponent == 0 || exponent > 2 * BIAS {
        return of_few(value);
    }
    let mantissa = (bits & ((1 << FRACTION) - 1)) | (1 << FRACTION);
    // Of an even power of two.
    let odd = (exponent + BIAS) & 1;
    let mut rest = mantissa << (1 + odd);
    let (mut twice, mut digit) = (0_u32, 1 << (FRACTION + 1));
    while digit > 0 {
        let tried = twice + digit;
        if tried <= rest {
            rest -= tried;
            twice = tried + digit;
        }
        rest <<= 1;
        digit >>= 1;
    }
    // No root is halfway between two numbers of 24 bits.
    let rounded = (twice + 2) >> 2;
    f32::from_bits(rounded + (((exponent + BIAS - odd) / 2 - 1) << FRACTION))
}

/// That of what is no normal positive number.
#[cold]
fn of_few(value: f32) -> f32 {
    if value <= 0.0 {
        0.0
    } else if value < f32::MIN_POSITIVE {
        by_digits(value * 16_777_216.0) / 4096.0
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    use super::{by_digits, by_libm};

    #[test]
    fn digits_make_the_same_bits() {
        // Mantissas of all kinds with all exponents; and where these change.
        let ends = [1, 0x7f_ffff, 0x80_0000, 0x80_0001, 0x3f7f_ffff, 0x3f80_0000, 0x3fff_ffff, 0x7f7f_ffff];
        for bits in (0..=u32::MAX).step_by(65_537).chain(ends) {
            let value = f32::from_bits(bits);
            let (root, expected) = (by_digits(value), by_libm(value));
            assert!(root == expected || root.is_nan() && expected.is_nan(), "{value}: {root}, not {expected}");
        }
    }
}
