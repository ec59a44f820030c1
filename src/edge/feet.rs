//! [`Feet`]: the ends of a flank, where sharpening overshoots. docs/model.md, section 5.4.

use super::weight::Weight;

/// Pixels in which the step is less than a sixteenth off either level, in 1/32768: there sharpening shows most beside
/// what another column or width would do (`edge::overshoot::tests::sharpening_overshoots`).
const FOOT: u16 = 1 << 11;

/// How many pixels of a flank are hardly off either level, left and right, and what the step is off these levels in
/// all of them together, in 1/32768.
#[derive(Clone, Copy)]
pub(super) struct Feet {
    left: u8,
    right: u8,
    off: u16,
}

impl Feet {
    pub(super) const NONE: Self = Self { left: 0, right: 0, off: 0 };

    /// Of the flank with these weights.
    pub(super) const fn of(weights: &[Weight]) -> Self {
        let (mut feet, mut pixel) = (Self::NONE, 0);
        while pixel < weights.len() {
            let (off_left, off_right) = (weights[pixel].step, (1 << 15) - weights[pixel].step);
            if off_left < FOOT {
                (feet.left, feet.off) = (feet.left + 1, feet.off + off_left);
            } else if off_right < FOOT {
                (feet.right, feet.off) = (feet.right + 1, feet.off + off_right);
            }
            pixel += 1;
        }
        feet
    }

    pub(super) const fn left(self) -> usize {
        self.left as usize
    }

    pub(super) const fn right(self) -> usize {
        self.right as usize
    }

    /// How far the sums over the feet, left and right, lie beyond what a step between these levels shows there, towards
    /// the right one and both together.
    #[inline(always)]
    pub(super) const fn beyond(self, [left, right]: [i32; 2], [left_level, right_level]: [i32; 2]) -> i32 {
        let off = ((right_level - left_level) * self.off as i32) >> 15;
        right - self.right as i32 * right_level - (left - self.left as i32 * left_level) + off
    }
}
