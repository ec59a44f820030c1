//! Products of integers of 32 bits, as each core makes them best.

/// The product of two integers: its upper and its lower half.
#[cfg(feature = "fixed")]
#[inline(always)]
pub(super) fn product(a: i32, b: i32) -> (i32, u32) {
    if cfg!(target_has_atomic = "32") {
        let product = i64::from(a) * i64::from(b);
        return ((product >> 32) as i32, product as u32);
    }
    // The smallest cores multiply to 32 bits only, and are the only ones that have no atomic exchange.
    let [high, next, low] = parts_of_product(a, b, 0);
    (high + (next >> 16), ((next as u32) << 16) | (low & LOW) as u32)
}

const LOW: i32 = 0xffff;

/// Parts of the sum of a product and a small number times 2¹⁶: of 2³², of 2¹⁶, and a word whose lower half is the rest.
#[inline(always)]
fn parts_of_product(a: i32, b: i32, more: i32) -> [i32; 3] {
    let (a_high, a_low, b_high, b_low) = (a >> 16, a & LOW, b >> 16, b & LOW);
    let low = (a_low as u32).wrapping_mul(b_low as u32);
    // No sum overflows: half a word leaves as much room below the largest product of an integer's halves.
    let middle = a_high * b_low + (low >> 16) as i32;
    let next = a_low * b_high + (middle & LOW) + more;
    [a_high * b_high + (middle >> 16), next, low as i32]
}

/// The product over 2²⁸, to the nearest number; what does not fit is lost.
#[cfg(feature = "fixed")]
// Where it takes some twenty instructions it is a call.
#[cfg_attr(target_has_atomic = "32", inline(always))]
#[cfg_attr(not(target_has_atomic = "32"), inline(never))]
pub(super) fn product_over_28_bits(a: i32, b: i32) -> i32 {
    if cfg!(target_has_atomic = "32") {
        return ((i64::from(a) * i64::from(b) + (1 << 27)) >> 28) as i32;
    }
    let [high, next, _] = parts_of_product(a, b, 1 << 11);
    (high << 4) + (next >> 12)
}

/// The product over 2³², cut off.
#[cfg_attr(target_has_atomic = "32", inline(always))]
#[cfg_attr(not(target_has_atomic = "32"), inline(never))]
pub(crate) fn product_over_32_bits(a: i32, b: i32) -> i32 {
    if cfg!(target_has_atomic = "32") {
        return ((i64::from(a) * i64::from(b)) >> 32) as i32;
    }
    let [high, next, _] = parts_of_product(a, b, 0);
    high + (next >> 16)
}
