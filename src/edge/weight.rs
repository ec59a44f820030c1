//! [`Weight`]: what one pixel of a flank should show.

use super::spread_function::Place;

/// What one pixel of a flank should show.
#[derive(Clone, Copy)]
pub(super) struct Weight {
    /// The step, in 1/32768.
    pub(super) step: u16,
    /// Its slope times b, in 1/256.
    pub(super) slope: u8,
    /// Its change with the width, whatever the lens, in 1/127 of the class's largest.
    pub(super) widening: i8,
}

impl Weight {
    /// The right level's share of the pixel, in 1/256; the left level has the rest.
    #[inline(always)]
    pub(super) const fn right_share(&self) -> i32 {
        (self.step >> 7) as i32
    }

    /// What the pixel should show between the left level and one so much higher, in 1/64 of a level.
    #[inline(always)]
    pub(super) fn expected_q6(&self, left_q6: i32, contrast_q6: i32) -> i32 {
        left_q6 + ((contrast_q6 * i32::from(self.step)) >> 15)
    }

    pub(super) const fn new(place: &Place, widening: i32, largest: i32) -> Self {
        let slope = (place.slope + 64) >> 7;
        let half = if widening < 0 { -largest / 2 } else { largest / 2 };
        Self {
            step: place.step as u16,
            slope: if slope > 255 { 255 } else { slope as u8 },
            widening: ((widening * 127 + half) / largest) as i8,
        }
    }
}
