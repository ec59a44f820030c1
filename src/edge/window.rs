//! [`Window`]: the pixels around an edge, and what they say given an expected step.

use super::level_norms::{LevelNorms, LevelSums};
use super::moments::Moments;
use super::norms::{Norms, Squares};
use super::phase::Sampled;
use super::pixel_row::{PixelRow, Stretch};
use super::point::EdgePoint;
use super::template::Template;
use super::tuning::{APART, SAME_EDGE_Q16};
use super::weight::Weight;
use crate::format::Pixels;

/// How far apart two lines of one polarity are that are two edges, in 1/65536 px, given two sigma of their blur.
pub(crate) const fn apart_of_blur_q16(blur_q16: u32) -> u32 {
    let (times, parts) = APART;
    blur_q16 / parts * times
}

/// The edges on either side of the expected one, in 1/65536 px: their flanks must not be taken for this one's plateaus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Neighbours {
    pub(crate) left_q16: i32,
    pub(crate) right_q16: i32,
}

impl Neighbours {
    /// None near enough to matter.
    pub(crate) const NONE: Self = Self { left_q16: i32::MIN, right_q16: i32::MAX };

    /// Whether one of them is.
    pub(crate) const fn is_nearer_than(&self, distance_q16: u32, column_q16: i32) -> bool {
        column_q16.abs_diff(self.left_q16) < distance_q16 || self.right_q16.abs_diff(column_q16) < distance_q16
    }

    /// Whether each of them is on its own side and, unless it is known for an edge, so far away.
    pub(crate) fn are_far_but_for(&self, are_edges: [bool; 2], far_q16: u32, column_q16: i32) -> bool {
        let [left_is_edge, right_is_edge] = are_edges;
        let is_sound = |on_left_q16: i32, on_right_q16: i32, is_edge: bool| {
            on_left_q16 < on_right_q16 && (is_edge || on_left_q16.abs_diff(on_right_q16) > far_q16)
        };
        is_sound(self.left_q16, column_q16, left_is_edge) && is_sound(column_q16, self.right_q16, right_is_edge)
    }

    /// The nearest of the edges in its row that end an edge's plateaus. Of a point of its own polarity that is not
    /// known: it may be part of the same edge, since noise can break a long blur.
    pub(crate) fn among<'e>(edges: impl Iterator<Item = &'e EdgePoint>, edge: &EdgePoint) -> Self {
        let mut around = Self::NONE;
        edges.filter(|other| other.polarity != edge.polarity).for_each(|other| around.add(other, edge));
        around
    }

    /// Likewise of the points of lines: one of its own polarity is another edge's where it is beyond both blurs.
    pub(crate) fn among_lines<'e>(lines: impl Iterator<Item = &'e EdgePoint>, edge: &EdgePoint) -> Self {
        let mut around = Self::NONE;
        let is_other = |other: &&EdgePoint| {
            let blur_q16 = u32::from(other.width_q8.max(edge.width_q8)) << 9;
            other.polarity != edge.polarity || other.column_q16.abs_diff(edge.column_q16) > apart_of_blur_q16(blur_q16)
        };
        lines.filter(is_other).for_each(|other| around.add(other, edge));
        around
    }

    fn add(&mut self, other: &EdgePoint, edge: &EdgePoint) {
        let column_q16 = other.column_q16;
        if column_q16 < edge.column_q16 {
            self.left_q16 = self.left_q16.max(column_q16);
        } else if column_q16 > edge.column_q16 {
            self.right_q16 = self.right_q16.min(column_q16);
        }
    }

    /// Those of a point among the points of its row, which are in the order of their columns.
    pub(crate) fn beside(points: &[EdgePoint], point: &EdgePoint) -> Self {
        let at = points.partition_point(|other| other.column_q16 < point.column_q16);
        let column_q16 = |index: usize| points.get(index).map(|other| other.column_q16);
        Self {
            left_q16: at.checked_sub(1).and_then(column_q16).unwrap_or(Self::NONE.left_q16),
            right_q16: column_q16(at + 1).unwrap_or(Self::NONE.right_q16),
        }
    }

    /// Those that are nearer than these, by more than one edge may be found apart from itself.
    pub(crate) fn where_nearer_than(self, others: Self) -> Self {
        let is_nearer = |own_q16: i32, other_q16: i32| own_q16.abs_diff(other_q16) > SAME_EDGE_Q16;
        Self {
            left_q16: if self.left_q16 > others.left_q16 && is_nearer(self.left_q16, others.left_q16) {
                self.left_q16
            } else {
                Self::NONE.left_q16
            },
            right_q16: if self.right_q16 < others.right_q16 && is_nearer(self.right_q16, others.right_q16) {
                self.right_q16
            } else {
                Self::NONE.right_q16
            },
        }
    }

    /// The nearer ones of two pairs.
    pub(crate) fn or_nearer(self, other: Self) -> Self {
        Self { left_q16: self.left_q16.max(other.left_q16), right_q16: self.right_q16.min(other.right_q16) }
    }

    /// Their columns in 1/256 px.
    pub(super) const fn bounds_q8(&self) -> (i32, i32) {
        (self.left_q16 >> 8, self.right_q16 >> 8)
    }
}

/// How far away edges are that no line has, left and right, in quarters of a pixel: they end the plateaus of a line as
/// its neighbours with a line do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Untracked {
    away_q2: [u8; 2],
}

impl Untracked {
    /// None within 64 px.
    pub(crate) const NONE: Self = Self { away_q2: [u8::MAX; 2] };

    /// As these are beside an edge at this column.
    pub(crate) fn of(around: Neighbours, column_q16: i32) -> Self {
        let away_q2 = |other_q16: i32| (other_q16.abs_diff(column_q16) >> 14).min(u8::MAX.into()) as u8;
        Self { away_q2: [away_q2(around.left_q16), away_q2(around.right_q16)] }
    }

    /// The neighbours of the edge where it has moved to another column, if these are the others.
    #[inline(always)]
    pub(crate) fn among(self, around: Neighbours, column_q16: i32) -> Neighbours {
        if self == Self::NONE {
            return around;
        }
        let [left_q16, right_q16] =
            self.away_q2.map(|away_q2| if away_q2 == u8::MAX { 1 << 30 } else { i32::from(away_q2) << 14 });
        around.or_nearer(Neighbours {
            left_q16: column_q16.saturating_sub(left_q16),
            right_q16: column_q16.saturating_add(right_q16),
        })
    }
}

/// The pixels around an edge: its flank with what it should show, and a plateau on either side.
pub(super) struct Window<'p, P> {
    row: PixelRow<'p, P>,
    flank: Stretch,
    weights: &'static [Weight],
    plateaus: [Stretch; 2],
    /// Those of the whole window, where it is.
    whole: Option<&'static Norms>,
    /// Where the step is expected: the phase that is nearest, in 1/256 px.
    pub(super) centre_q8: i32,
}

impl<'p, P: Pixels> Window<'p, P> {
    pub(super) fn new(
        row: PixelRow<'p, P>,
        column_q8: i32,
        template: &Template,
        bounds_q8: (i32, i32),
    ) -> Option<Self> {
        let Sampled { first, centre_q8, phase } = template.at(column_q8);
        let pixels = phase.weights.len() as i32;
        let parts = Parts::new(column_q8, first, pixels, template, bounds_q8, (row.columns(), row.colours()))?;
        let Parts { plateaus, flank, skipped, .. } = parts;
        Some(Self {
            row,
            flank,
            weights: phase.weights.get(skipped..)?,
            plateaus,
            whole: parts.is_whole(first, pixels, template).then_some(&phase.norms),
            centre_q8,
        })
    }

    /// Which of its own levels the model of an edge has for this row.
    pub(super) fn kind(&self) -> usize {
        self.row.kind()
    }

    /// Made when the library is compiled, unless a neighbour or the border cuts off a part of the window.
    pub(super) fn norms(&self) -> Norms {
        if let Some(norms) = self.whole {
            return *norms;
        }
        let seen = self.weights.iter().take(self.flank.pixels());
        let plateaus = self.plateaus.map(|plateau| plateau.pixels() as u32);
        seen.fold(Squares::NONE, Squares::with).norms(plateaus)
    }

    /// Levels of the plateaus, in 1/256 of a grey level.
    pub(super) fn levels_q8(&self) -> Option<[i32; 2]> {
        let [left, right] = self.plateaus;
        Some([self.row.mean_q8(left)?, self.row.mean_q8(right)?])
    }

    /// Given the levels to expect.
    #[inline(never)] // three places ask for them
    pub(super) fn moments(&self, levels_q8: [i32; 2]) -> Moments {
        let mut moments = Moments::default();
        self.each(levels_q8, |residual_q6, weight| moments.add(residual_q6, weight));
        moments
    }

    /// What the flank says of the levels themselves, given those to expect.
    pub(super) fn level_sums(&self, levels_q8: [i32; 2]) -> LevelSums {
        let mut sums = LevelSums::default();
        self.each(levels_q8, |residual_q6, weight| sums.add(residual_q6, weight));
        sums
    }

    /// What becomes of that.
    pub(super) fn level_norms(&self) -> Option<LevelNorms> {
        self.weights.get(..self.flank.pixels()).map(LevelNorms::of)
    }

    /// Each pixel of the flank minus what is expected there, in 1/64 of a level.
    fn each(&self, levels_q8: [i32; 2], mut take: impl FnMut(i32, &'static Weight)) {
        let [left_q6, right_q6] = levels_q8.map(|level_q8| level_q8 >> 2);
        if self.row.pixels.mosaic_row().is_none() {
            self.row.each_light_q8(self.flank, self.weights.iter(), |light_q8, weight| {
                take((light_q8 >> 2) - weight.expected_q6(left_q6, right_q6 - left_q6), weight);
            });
            return;
        }
        // One colour is as much brighter than the mean of the two as the other is darker.
        let [left_colour_q6, right_colour_q6] = self.plateaus.map(|plateau| self.row.colour_q8(plateau) >> 2);
        let mut sign = if self.flank.from.is_multiple_of(2) { 1 } else { -1 };
        self.row.each_light_q8(self.flank, self.weights.iter(), |light_q8, weight| {
            let (left_q6, right_q6) = (left_q6 + sign * left_colour_q6, right_q6 + sign * right_colour_q6);
            sign = -sign;
            take((light_q8 >> 2) - weight.expected_q6(left_q6, right_q6 - left_q6), weight);
        });
    }
}

/// Which pixels of a row are an edge's own.
pub(super) struct Parts {
    /// On the left of its flank, and on the right.
    pub(super) plateaus: [Stretch; 2],
    pub(super) flank: Stretch,
    /// Pixels of the template before the flank's first.
    pub(super) skipped: usize,
    /// Whether the plateaus are the flank's own outermost pixels.
    pub(super) is_narrow: bool,
}

impl Parts {
    /// Of an edge whose template's flank has so many pixels from the first one on, between these bounds, in a row of so
    /// many columns and colours.
    #[inline(always)]
    pub(super) fn new(
        column_q8: i32,
        first: i32,
        pixels: i32,
        template: &Template,
        bounds_q8: (i32, i32),
        (columns, colours): (i32, i32),
    ) -> Option<Self> {
        let (left_q8, right_q8) = view(column_q8, i32::from(template.reach_q8), bounds_q8);
        let (plateau, end) = (template.plateau(), first + pixels);
        let from = ((left_q8 + 255) >> 8).max(first - plateau).max(0);
        let to = ((right_q8 >> 8) + 1).min(end + plateau).min(columns);
        // At least the outermost pixels tell the levels.
        let (flank_from, flank_to) = (first.max(from + colours), end.min(to - colours));
        if flank_from > flank_to {
            return None;
        }
        // Between two neighbours the outermost pixels belong to the flank as well: two alone would tell nothing.
        let is_narrow = flank_to - flank_from < LEAST_FLANK;
        let (left_to, right_from) = if is_narrow { (from + colours, to - colours) } else { (flank_from, flank_to) };
        let (flank_from, flank_to) = if is_narrow { (from.max(first), to.min(end)) } else { (flank_from, flank_to) };
        // Within the row, and each not before the one on its left.
        let stretch = |from: i32, to: i32| Stretch { from: from as usize, to: to as usize };
        Some(Self {
            plateaus: [stretch(from, left_to), stretch(right_from, to)],
            flank: stretch(flank_from, flank_to),
            skipped: (flank_from - first) as usize,
            is_narrow,
        })
    }

    /// Whether nothing is cut off.
    fn is_whole(&self, first: i32, pixels: i32, template: &Template) -> bool {
        let [left, right] = self.plateaus;
        let plateau = template.plateau();
        left.from as i32 == first - plateau && right.to as i32 == first + pixels + plateau
    }
}

/// Fewest pixels that tell place and width of an edge.
const LEAST_FLANK: i32 = 3;

/// From where to where the pixels are an edge's own: up to where a neighbour's blur begins, or half the way to it.
pub(super) fn view(column_q8: i32, reach_q8: i32, (left_q8, right_q8): (i32, i32)) -> (i32, i32) {
    let left = (left_q8 + reach_q8).min((column_q8 + left_q8) >> 1);
    let right = (right_q8 - reach_q8).max((column_q8 + right_q8) >> 1);
    (left, right)
}

#[cfg(test)]
mod tests {
    use super::Neighbours;

    /// What the scanner finds up to a pixel off a line's own column is that line's edge; what is farther is another one.
    #[test]
    fn an_edge_that_is_found_twice_is_one() {
        let beside = |away_px: f64| Neighbours {
            left_q16: ((100.0 - away_px) * 65536.0) as i32,
            right_q16: ((100.0 + away_px) * 65536.0) as i32,
        };
        for (off_px, is_other) in [(0.8, false), (1.2, true)] {
            let nearer = beside(10.0 - off_px).where_nearer_than(beside(10.0));
            assert_eq!(nearer.left_q16 != Neighbours::NONE.left_q16, is_other, "{off_px} px");
            assert_eq!(nearer.right_q16 != Neighbours::NONE.right_q16, is_other, "{off_px} px");
        }
    }
}
