//! [`Halo`]: overshoot beside an edge, the mark of sharpening. docs/model.md, section 5.4.

use super::tuning::LEAST_HALO_PARTS;
use crate::edge::{EdgePoint, PixelRow, Polarity};
use crate::format::Pixels;

/// What the pixels next to the flank have beyond those farther off, away from the level on the other side: sums over
/// the rows that were looked at, in grey levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Halo {
    dark: i16,
    bright: i16,
}

impl Halo {
    /// Looks at the row of a point; at the border there is nothing to see.
    pub(super) fn look<P: Pixels>(&mut self, row: PixelRow<'_, P>, point: &EdgePoint) {
        // A flank reaches two sigma far.
        let reach = (i32::from(point.width_q8) + (1 << 6)) >> 7;
        let Some([left, right]) = row.fall_beside(point.boundary(), reach) else { return };
        let (dark, bright) = if point.polarity == Polarity::Rising { (left, right) } else { (right, left) };
        // From four pixels to one, to the nearest.
        let levels = |sum_of_4: i16| (sum_of_4 + 2) >> 2;
        self.dark = self.dark.saturating_add(levels(-dark));
        self.bright = self.bright.saturating_add(levels(bright));
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.dark = self.dark.saturating_add(other.dark);
        self.bright = self.bright.saturating_add(other.bright);
    }

    /// Whether both levels overshoot by a share of the contrast that sharpening leaves; `along` is the sum of the
    /// contrasts of the same rows, times four pixels.
    pub(super) fn is_part_of(&self, along: i32) -> bool {
        i32::from(self.dark.min(self.bright)) * 4 * LEAST_HALO_PARTS >= along
    }
}

#[cfg(test)]
mod tests {
    use super::Halo;
    use crate::edge::{EdgePoint, PixelRow, Polarity};
    use crate::setup::Response;

    const EDGE: [u8; 24] =
        [50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 50, 70, 130, 150, 150, 150, 150, 150, 150, 150, 150, 150, 150, 150];

    /// Whether a row with an edge in its middle, of a hundred levels, shows a halo.
    fn shows(pixels: [u8; 24], polarity: Polarity) -> bool {
        let row = PixelRow { pixels: &pixels, response: &Response::Linear };
        // Between columns 11 and 12; a sigma of 0.6 px.
        let point = EdgePoint { width_q8: 154, ..EdgePoint::new(0, (23 << 15) - 1, 0).with_polarity(polarity) };
        let mut halo = Halo::default();
        halo.look(row, &point);
        halo.is_part_of(400)
    }

    fn with(changes: &[(usize, u8)]) -> [u8; 24] {
        let mut pixels = EDGE;
        changes.iter().for_each(|(column, level)| pixels[*column] = *level);
        pixels
    }

    #[test]
    fn overshoot_on_both_sides_is_a_halo() {
        let sharpened = with(&[(10, 42), (9, 48), (13, 158), (14, 152)]);
        assert!(shows(sharpened, Polarity::Rising));
        let mut mirrored = sharpened;
        mirrored.reverse();
        assert!(shows(mirrored, Polarity::Falling));
    }

    /// A level that changes on one side is what stands there.
    #[test]
    fn one_side_alone_is_none() {
        assert!(!shows(EDGE, Polarity::Rising));
        assert!(!shows(with(&[(13, 158), (14, 152)]), Polarity::Rising));
        assert!(!shows(with(&[(10, 42), (9, 48)]), Polarity::Rising));
    }

    #[test]
    fn undershoot_is_none() {
        assert!(!shows(with(&[(10, 58), (13, 142)]), Polarity::Rising));
    }
}
