//! [`root`]: a square root that is good enough for a sigma or a width, without a division.

/// To 0.11 %, and to the nearest; one for zero.
pub(crate) const fn root(value: u32) -> u32 {
    // Between a quarter and one: the cubic that is least off the root there, by as much to either side.
    let halvings = (value | 1).leading_zeros() / 2;
    let part_q16 = (value << (2 * halvings)) >> 16;
    let bend_q15 = 27_063 - ((9_416 * part_q16) >> 16);
    let slope_q15 = 43_338 - ((bend_q15 * part_q16) >> 16);
    let root_q16 = 14_223 + ((slope_q15 * part_q16) >> 15);
    (root_q16 + (1 << halvings >> 1)) >> halvings
}

#[cfg(test)]
mod tests {
    use super::root;

    #[test]
    fn it_is_a_root() {
        let powers = (0..32).flat_map(|power| (0..64).map(move |part: u32| ((64 + u64::from(part)) << power) >> 6));
        for value in (1..70_000).chain(powers).chain([u32::MAX.into()]) {
            let (found, exact) = (f64::from(root(value as u32)), libm::sqrt(value as f64));
            assert!((found - exact).abs() <= 0.0011 * exact + 0.51, "{value}: {found}");
        }
    }
}
