//! The straight part of a line that turns.
//!
//! A line that curves as a whole, as lenses and turning cameras make it, is a parabola but for a small part of what it
//! departs; one that turns at the end of its edge is not. docs/model.md, section 7.9.

use core::ops::Range;

use super::knot::Knot;
use super::tuning::{
    CURVE_PARTS, CURVE_SIGMAS, KINK_SIGMAS, LEAST_SHARE, LEAST_STRAIGHT_KNOTS, STRAIGHT_PARTS, STRAIGHT_Q16,
};

/// Where a knot lies, relative to the line's first point.
#[derive(Clone, Copy)]
pub(super) struct Mean {
    pub(super) row_q8: i32,
    pub(super) column_q16: i32,
    pub(super) knot: u16,
    pub(super) points: u16,
}

impl Mean {
    pub(super) fn of((index, knot): (usize, &Knot)) -> Option<Self> {
        let points = i64::from(knot.points);
        let row_q8 = (i64::from(knot.rows) << 8).checked_div(points)?;
        let column_q16 = knot.columns_q16.checked_div(points)?;
        // A line has fewer than 2¹⁶ rows, and fewer columns.
        let fits = |value: i64| value.clamp(i32::MIN.into(), i32::MAX.into()) as i32;
        Some(Self { row_q8: fits(row_q8), column_q16: fits(column_q16), knot: index as u16, points: knot.points })
    }

    /// Rows from another one on, in 1/256.
    fn rows_q8(&self, from: &Self) -> i64 {
        i64::from(self.row_q8) - i64::from(from.row_q8)
    }

    /// The first and the last row of its knot, if none is missing between them.
    pub(super) const fn start_row(&self) -> i32 {
        (self.row_q8 - ((self.points as i32 - 1) << 7) + (1 << 7)) >> 8
    }

    pub(super) const fn end_row(&self) -> i32 {
        (self.row_q8 + ((self.points as i32 - 1) << 7) + (1 << 7)) >> 8
    }

    fn columns_q16(&self, from: &Self) -> i64 {
        i64::from(self.column_q16) - i64::from(from.column_q16)
    }

    /// Slope of the way there that ends so much to the side, in 1/65536 px per row.
    fn slope_q16(&self, from: &Self, aside_q16: i64) -> i64 {
        ((self.columns_q16(from) + aside_q16) << 8).checked_div(self.rows_q8(from)).unwrap_or(0)
    }
}

/// The straight way between two of them.
struct Chord {
    from: Mean,
    /// In 1/65536 px per row.
    slope_q16: i64,
}

impl Chord {
    fn between(from: &Mean, to: &Mean) -> Self {
        Self { from: *from, slope_q16: to.slope_q16(from, 0) }
    }

    /// How far off it one lies, in 1/65536 px.
    fn off_q16(&self, mean: &Mean) -> i64 {
        mean.columns_q16(&self.from) - (self.slope_q16.saturating_mul(mean.rows_q8(&self.from)) >> 8)
    }
}

/// The one that is farthest from the straight way between the ends, and how far, in 1/65536 px.
fn farthest(means: &[Mean]) -> Option<(usize, u64)> {
    let chord = Chord::between(means.first()?, means.last()?);
    let off_q16 = means.iter().map(|mean| chord.off_q16(mean).unsigned_abs());
    off_q16.enumerate().max_by_key(|(_, off_q16)| *off_q16)
}

/// How many of the means lie within a distance of one straight line through the first.
fn within(means: &[Mean], distance_q16: i64) -> usize {
    let Some((first, others)) = means.split_first() else { return 0 };
    let (mut least, mut most) = (i64::MIN, i64::MAX);
    let lies_within = |mean: &&Mean| {
        least = least.max(mean.slope_q16(first, -distance_q16));
        most = most.min(mean.slope_q16(first, distance_q16));
        least <= most
    };
    1 + others.iter().take_while(lies_within).count()
}

pub(super) fn points(means: &[Mean]) -> u32 {
    means.iter().fold(0, |sum, mean| sum + u32::from(mean.points))
}

/// The longest straight part of a line that is neither straight as a whole nor a curve, if it is a good part of it. It is
/// not straight where it departs by more than `least_q16` from the way between its ends.
pub(super) fn straight_part(knots: &[Knot], means: &[Mean], least_q16: u64) -> Option<Range<usize>> {
    let (at, off_q16) = farthest(means)?;
    let sigma_q16 = sigma_q16(knots, means.get(at)?);
    let is_straight = off_q16 <= least_q16 + KINK_SIGMAS * sigma_q16;
    if is_straight || is_curve(means, at, off_q16 / CURVE_PARTS + CURVE_SIGMAS * sigma_q16) {
        return None;
    }
    // A departure is less than 2⁴⁰.
    let distance_q16 = STRAIGHT_Q16.max(off_q16 / STRAIGHT_PARTS) as i64;
    let parts = (0..means.len()).filter_map(|from| {
        let rest = means.get(from..)?;
        let count = within(rest, distance_q16);
        Some((points(rest.get(..count)?), from..from + count))
    });
    let (most, part) = parts.max_by_key(|(points, _)| *points)?;
    let is_good = LEAST_SHARE.1 * most >= LEAST_SHARE.0 * points(means) && part.len() >= LEAST_STRAIGHT_KNOTS;
    is_good.then_some(part)
}

/// The one in which a line turns before or after a straight part: it, or its last one, which may lie as near as what is
/// straight. Without it both sides are the straightest.
pub(super) fn turn_beside(means: &[Mean], part: &Range<usize>) -> Option<usize> {
    let turns = if part.start > 0 { [part.start - 1, part.start] } else { [part.end, part.end.checked_sub(1)?] };
    let off_q16 = |side: Option<&[Mean]>| side.and_then(farthest).map_or(0, |(_, off_q16)| off_q16);
    let without = |turn: usize| off_q16(means.get(..turn)) + off_q16(means.get(turn + 1..));
    turns.into_iter().min_by_key(|turn| without(*turn))
}

/// Whether all lie within a distance of the parabola through both ends and one of them.
fn is_curve(means: &[Mean], at: usize, most_q16: u64) -> bool {
    let [Some(first), Some(top), Some(last)] = [means.first(), means.get(at), means.last()] else { return true };
    let chord = Chord::between(first, last);
    let height_q16 = chord.off_q16(top);
    let product = |mean: &Mean| mean.rows_q8(first) * last.rows_q8(mean);
    let per_height = (product(top) >> 8).max(1);
    means.iter().all(|mean| {
        let part_q8 = product(mean).checked_div(per_height).unwrap_or(0);
        let curve_q16 = height_q16.saturating_mul(part_q8) >> 8;
        chord.off_q16(mean).abs_diff(curve_q16) <= most_q16
    })
}

/// One sigma of a knot's mean.
fn sigma_q16(knots: &[Knot], mean: &Mean) -> u64 {
    let variances_q32 = knots.get(usize::from(mean.knot)).map_or(0, |knot| knot.variances_q32);
    variances_q32.isqrt().checked_div(mean.points.into()).unwrap_or(0)
}
