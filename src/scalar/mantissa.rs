//! Products, reciprocals and roots of 31-bit mantissas, for [`Q32`](super::Q32): no division, and no more than 64 bits.

use super::product::product;

/// The product over 2 to the power of `32 - LEFT`; what does not fit is lost.
#[inline(always)]
fn product_shifted<const LEFT: u32>(a: i32, b: i32) -> i32 {
    let (high, low) = product(a, b);
    (high << LEFT) | (low >> (32 - LEFT)) as i32
}

/// 2⁶¹/x of an x from 2³⁰ to 2³¹, by Newton's method from a table: 15 bits after a short step, 29 after one more.
pub(super) fn reciprocal(x: u32) -> i32 {
    let start = i32::from(RECIPROCALS[(x >> 23) as usize & 127]);
    let off = (1 << 27) - (x >> 15) as i32 * start;
    let short = ((start << 4) + ((start * (off >> 4)) >> 19)).min(0xffff);
    let r = short << 15;
    // 2³¹ less what the product comes to: the smallest integer stands for it.
    let off = i32::MIN.wrapping_sub(product_shifted::<2>(x as i32, r));
    r.saturating_add(product_shifted::<1>(r, off))
}

/// √(x · 2³¹) of an x from 2²⁹ to 2³¹, by way of the reciprocal root: two short steps and one more.
pub(super) fn root(x: u32) -> i32 {
    let start = i32::from(RECIPROCAL_ROOTS[(x >> 24) as usize & 127]);
    let short_x = (x >> 15) as i32;
    let off = (1 << 30) - short_x * (start * start);
    let short = ((start << 8) + ((start * (off >> 8)) >> 15)).min(0xffff);
    let square = ((short as u32 * short as u32) >> 16) as i32;
    let off = (1 << 30) - short_x * square;
    let y = (short + ((short * (off >> 8)) >> 23)).min(0xffff) << 15;
    let square = product(y, y).0;
    let off = (1 << 30) - product_shifted::<3>(x as i32, square);
    let y = y.saturating_add(product_shifted::<1>(y, off));
    product_shifted::<2>(x as i32, y)
}

/// 2¹⁹/x for x from 128 to 256, at the middles of its steps.
const RECIPROCALS: [u16; 128] = {
    let mut table = [0; 128];
    let mut i = 0;
    while i < 128 {
        table[i] = ((1 << 20) / (257 + 2 * i as u32)) as u16;
        i += 1;
    }
    table
};

/// 128/√(x/128) for x from 32 to 128, at the middles of its steps.
const RECIPROCAL_ROOTS: [u8; 128] = {
    let mut table = [0; 128];
    let mut i = 32;
    while i < 128 {
        let sixteenfold = ((1_u32 << 30) / (2 * i as u32 + 1)).isqrt();
        table[i] = ((sixteenfold + 8) / 16) as u8;
        i += 1;
    }
    table
};
