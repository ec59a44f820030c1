//! Random numbers without state: hashes, and normally distributed numbers from their bits.

/// Spreads every bit over all bits (the finaliser of SplitMix64).
pub(super) const fn mix(bits: u64) -> u64 {
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^ (bits >> 31)
}

/// Hash of a key and one more number. Chained calls hash any sequence.
pub(super) const fn hash(key: u64, number: u64) -> u64 {
    mix(key ^ number.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15))
}

/// A normally distributed number of variance one from 64 random bits: the sum of eight bytes, whose short tails a
/// fitted polynomial stretches. It agrees with the normal distribution to 0.01 % of its variance, 0.001 of its
/// kurtosis, 1 % of the share beyond 3 sigma and 8 % of that beyond 4 sigma; the largest value is 6.1.
pub(super) fn gaussian(bits: u64) -> f32 {
    const LOW: u64 = 0x00FF_00FF_00FF_00FF;
    const LANES: u64 = 0x0001_0001_0001_0001;
    let pairs = (bits & LOW) + ((bits >> 8) & LOW);
    let sum = (pairs.wrapping_mul(LANES) >> 48) as f32;
    // Eight bytes: mean 8 · 127.5, variance 8 · (2¹⁶ − 1)/12.
    let z = (sum - 1020.0) * (1.0 / 209.021_53);
    let z2 = z * z;
    z * (0.981_68 + z2 * (0.005_2 + z2 * 0.000_26))
}

#[cfg(test)]
mod tests {
    use super::{gaussian, mix};

    /// Each bound is about four sigma of the statistic over four million numbers (√(1/n), √(2/n), √(15/n), √(96/n) for
    /// the moments, √(1/np) for a share p), but for the shares beyond 1 and 2 sigma, which may be 1 % off as
    /// documented.
    #[test]
    fn gaussian_numbers_have_the_moments_and_tails_of_the_normal_distribution() {
        let count = 4_000_000_u64;
        let (mut sums, mut beyond) = ([0.0_f64; 4], [0_u32; 4]);
        for index in 0..count {
            let z = f64::from(gaussian(mix(index.wrapping_mul(0x9E37_79B9_7F4A_7C15))));
            for (sum, power) in sums.iter_mut().zip([z, z * z, z * z * z, z * z * z * z]) {
                *sum += power / count as f64;
            }
            for (share, limit) in beyond.iter_mut().zip([1.0, 2.0, 3.0, 4.0]) {
                *share += u32::from(z.abs() > limit);
            }
        }
        let [mean, variance, skew, fourth] = sums;
        assert!(mean.abs() < 0.002 && skew.abs() < 0.008, "mean {mean}, third moment {skew}");
        assert!((variance - 1.0).abs() < 0.003, "variance {variance}");
        assert!((fourth - 3.0).abs() < 0.02, "fourth moment {fourth}");
        for (share, (expected, tolerance)) in
            beyond.into_iter().zip([(0.317_31, 0.01), (0.045_50, 0.01), (0.002_700, 0.04), (0.000_063_34, 0.25)])
        {
            let ratio = f64::from(share) / count as f64 / expected;
            assert!((ratio - 1.0).abs() < tolerance, "{ratio} of the normal share {expected}");
        }
    }
}
