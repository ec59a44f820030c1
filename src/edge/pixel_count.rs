//! One over a number of pixels: a table, since cores without division take more than a hundred instructions for each.

/// No plateau has more pixels (`edge::template::tests::plateaus_are_counted`).
const MOST: usize = 27;

static PER_PIXELS_Q20: [u32; MOST + 1] = {
    let (mut each, mut pixels) = ([0; MOST + 1], 1);
    while pixels <= MOST {
        each[pixels] = ((1 << 20) + pixels as u32 / 2) / pixels as u32;
        pixels += 1;
    }
    each
};

/// In 1/2²⁰, to the nearest; zero for none.
pub(super) const fn per_pixels_q20(pixels: usize) -> u32 {
    if pixels < PER_PIXELS_Q20.len() { PER_PIXELS_Q20[pixels] } else { 0 }
}

/// Mean of so many pixels of a plateau, in 1/256 level, to the nearest, from the sum of their grey levels.
#[inline(always)]
pub(super) const fn mean_q8(sum: u32, per_pixels_q20: u32) -> i32 {
    ((sum * per_pixels_q20 + (1 << 11)) >> 12) as i32
}
