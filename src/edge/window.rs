//! [`Window`]: the pixels around an edge, and their moments against an expected spread function.

use super::moments::{LevelMoments, Moments};
use super::pixel_row::{PixelRow, Stretch};
use super::point::EdgePoint;
use super::spread_function::{Place, SpreadFunction};
use crate::format::Pixels;

/// The edges on either side of the expected one, in 1/65536 px: their flanks must not be taken for this one's plateaus.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbours {
    pub(crate) left_q16: i64,
    pub(crate) right_q16: i64,
}

impl Neighbours {
    /// None near enough to matter.
    pub(crate) const NONE: Self = Self { left_q16: -(1 << 40), right_q16: 1 << 40 };

    /// Whether one of them is.
    pub(crate) const fn is_nearer_than(&self, distance_q16: i64, column_q16: i64) -> bool {
        column_q16 - self.left_q16 < distance_q16 || self.right_q16 - column_q16 < distance_q16
    }

    /// The nearest of the edges in its row that end an edge's plateaus. One of its own polarity does not: it may be part of the
    /// same edge, since noise can break a long blur.
    pub(crate) fn among<'e>(edges: impl Iterator<Item = &'e EdgePoint>, edge: &EdgePoint) -> Self {
        let mut around = Self::NONE;
        for column_q16 in edges.filter(|other| other.polarity != edge.polarity).map(|other| other.column_q16) {
            if column_q16 < edge.column_q16 {
                around.left_q16 = around.left_q16.max(i64::from(column_q16));
            } else if column_q16 > edge.column_q16 {
                around.right_q16 = around.right_q16.min(i64::from(column_q16));
            }
        }
        around
    }
}

/// Pixels of plateau on either side that tell its level.
pub(crate) const PLATEAU: i64 = 4;

/// The pixels around an edge: its flank, and a plateau on either side.
pub(crate) struct Window<'p, P> {
    row: PixelRow<'p, P>,
    flank: Stretch,
    plateaus: [Stretch; 2],
    /// Of a mosaic: how much brighter its even columns are than the mean of its two colours, on either side.
    colours_q8: [i64; 2],
    /// Distance of the flank's first pixel from the expected column.
    off_q8: i32,
}

impl<'p, P: Pixels> Window<'p, P> {
    pub(crate) fn new(
        row: PixelRow<'p, P>,
        column_q16: i64,
        template: &SpreadFunction,
        around: Neighbours,
    ) -> Option<Self> {
        let reach_q16 = i64::from(template.reach_q8()) << 8;
        let (from_q16, to_q16) = view(column_q16, reach_q16, around);
        let (from, to) = (((from_q16 + 65535) >> 16).max(0), ((to_q16 >> 16) + 1).min(row.pixels.columns() as i64));
        // At least the outermost pixels tell the levels.
        let flank_from = ((column_q16 - reach_q16 + 65535) >> 16).max(from + row.colours());
        let flank_to = (((column_q16 + reach_q16) >> 16) + 1).min(to - row.colours());
        let plateaus = [row.stretch(from, flank_from)?, row.stretch(flank_to, to)?];
        Some(Self {
            row,
            flank: row.stretch(flank_from, flank_to)?,
            plateaus,
            colours_q8: plateaus.map(|plateau| row.colour_q8(plateau)),
            off_q8: i32::try_from((flank_from << 8) - (column_q16 >> 8)).ok()?,
        })
    }

    /// The light of each pixel of the flank less what is expected there.
    fn residuals_q8(&self, template: &SpreadFunction, levels_q8: [i64; 2]) -> impl Iterator<Item = (i64, Place)> {
        let [left_q8, right_q8] = levels_q8;
        let is_mosaic = self.row.pixels.mosaic_row().is_some();
        let [left_colour_q8, right_colour_q8] = if is_mosaic { self.colours_q8 } else { [0; 2] };
        // One colour is as much brighter than their mean as the other is darker.
        let mut sign = if self.flank.from.is_multiple_of(2) { 1 } else { -1 };
        self.row.light_q8(self.flank).zip(template.walk(self.off_q8)).map(move |(light_q8, place)| {
            let (left_q8, right_q8) = (left_q8 + sign * left_colour_q8, right_q8 + sign * right_colour_q8);
            sign = -sign;
            let expected_q8 = left_q8 + (((right_q8 - left_q8) * i64::from(place.step)) >> 15);
            (i64::from(light_q8) - expected_q8, place)
        })
    }

    /// What the flank says of the levels themselves, given those to expect.
    pub(crate) fn level_sums(&self, template: &SpreadFunction, levels_q8: [i64; 2]) -> LevelMoments {
        let mut sums = LevelMoments::default();
        self.residuals_q8(template, levels_q8).for_each(|(residual_q8, place)| sums.add(residual_q8, &place));
        sums
    }

    /// Given the levels to expect.
    pub(crate) fn sums(&self, template: &SpreadFunction, levels_q8: [i64; 2]) -> Moments {
        let mut sums = Moments::default();
        self.residuals_q8(template, levels_q8).for_each(|(residual_q8, place)| sums.add(residual_q8, &place));
        let ([left, right], [left_q8, right_q8]) = (self.plateaus, levels_q8);
        sums.plateau_pixels = [left.pixels() as i64, right.pixels() as i64];
        sums.off_q16 = [off_q16(self.row, left, left_q8), off_q16(self.row, right, right_q8)];
        sums
    }
}

/// Mean of a plateau minus what is expected.
fn off_q16<P: Pixels>(row: PixelRow<'_, P>, plateau: Stretch, level_q8: i64) -> i64 {
    i64::from(row.mean_q16(plateau).unwrap_or(0)) - (level_q8 << 8)
}

/// From where to where an edge's pixels reach: its blur and a plateau on either side, up to where a neighbour's blur begins or
/// half the way to it.
fn view(column_q16: i64, reach_q16: i64, around: Neighbours) -> (i64, i64) {
    // The longer the blur, the more a wrong level shifts the edge.
    let far_q16 = 2 * reach_q16 + (PLATEAU << 16);
    let left = (around.left_q16 + reach_q16).min((column_q16 + around.left_q16) / 2);
    let right = (around.right_q16 - reach_q16).max((column_q16 + around.right_q16) / 2);
    ((column_q16 - far_q16).max(left), (column_q16 + far_q16).min(right))
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Side {
    Left,
    Right,
}

/// Mean brightness beyond the blur on one side, in 1/65536 grey level; where neighbours leave no room, of the pixel half way
/// (and of its neighbour's, whose colour is another one in a mosaic).
pub(crate) fn plateau<P: Pixels>(
    row: PixelRow<'_, P>,
    column: i64,
    reach_q16: i64,
    side: Side,
    around: Neighbours,
) -> Option<u32> {
    let (left, right) = view(column, reach_q16, around);
    let (from, to) = match side {
        Side::Left => (left, (column - reach_q16).max(left)),
        Side::Right => ((column + reach_q16).min(right), right),
    };
    let last = row.pixels.columns() as i64 - 1;
    let from = ((from + (1 << 15)) >> 16).max(0).min(last + 1 - row.colours());
    let to = ((to + (1 << 15)) >> 16).min(last).max(from + row.colours() - 1);
    row.mean_q16(row.stretch(from, to + 1)?)
}
