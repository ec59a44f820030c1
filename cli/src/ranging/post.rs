//! [`Post`]: two opposite edges that are the sides of one upright thing, and how far its middle is.
//!
//! An edge of inverse depth ρ that leans by β looks like an upright one of inverse depth ρ + β/s, where s is the slope that
//! the camera's motion gives to an edge at 1 m. The sides of a tapered post lean by +t and −t, so that t cancels in
//!
//! ```text
//! ρ = (ρ₁ + ρ₂) / 2
//! σ² = (n₁² + n₂²) / 4 + ((l₁ + l₂) / 2)² + Σ ((c₁ + c₂) / 2)²
//! ```
//!
//! with n the parts of their sigmas that come from noise, l from lean, and c from each source that all edges of a frame
//! share. Of the lean the taper is gone; what is left is that of the whole post, which is the same on both sides.

use shutter_range::{Budget, ErrorSource, Polarity, Range, RangeStatus};

/// A post is at least so many times as high as wide.
const LEAST_HEIGHT_PER_WIDTH: f64 = 4.0;

/// Rows that both sides have, of those that one of them has.
const LEAST_COMMON_ROWS: f64 = 0.8;

/// How much wider a post may become with each row, half of it on either side: half a degree each.
const MOST_TAPER: f64 = 0.0175;

/// So much less is still none, as far as sides that are alike can be told.
const SIGNIFICANT_SIGMAS: f64 = 3.0;

#[derive(Clone, Copy)]
pub(crate) struct Post {
    /// The index of the range of the other side.
    pub(crate) other: usize,
    /// Shortest distance to the line in the middle, and one sigma; `None` within three sigma of infinity.
    pub(crate) distance_m: Option<(f64, f64)>,
}

/// For each range the post that its edge is a side of, if there is one.
pub(crate) fn posts(ranges: &[Range<f64>]) -> Vec<Option<Post>> {
    let nearest: Vec<Option<usize>> = (0..ranges.len()).map(|index| nearest_opposite(ranges, index)).collect();
    let is_mutual = |index: usize, other: usize| nearest.get(other).copied().flatten() == Some(index);
    let post = |(index, other): (usize, Option<usize>)| {
        let other = other.filter(|other| is_mutual(index, *other))?;
        Some(Post { other, distance_m: distance_m(ranges.get(index)?, ranges.get(other)?) })
    };
    nearest.iter().copied().enumerate().map(post).collect()
}

/// The edge that would make the narrowest post with this one.
fn nearest_opposite(ranges: &[Range<f64>], index: usize) -> Option<usize> {
    let side = ranges.get(index)?;
    let widths = ranges.iter().enumerate().filter_map(|(other, range)| Some((other, width_px(side, range)?)));
    widths.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(other, _)| other)
}

/// The width of the post that two edges would be the sides of, in the middle of the rows that they share.
fn width_px(a: &Range<f64>, b: &Range<f64>) -> Option<f64> {
    let are_opposite = matches!(
        (a.polarity, b.polarity),
        (Polarity::Rising, Polarity::Falling) | (Polarity::Falling, Polarity::Rising)
    );
    let are_sound = [a, b].iter().all(|side| matches!(side.status, RangeStatus::Ok | RangeStatus::Far));
    let (top, bottom) = (a.first_row.max(b.first_row), a.last_row.min(b.last_row));
    if !(are_opposite && are_sound && top < bottom) {
        return None;
    }
    let all_rows = f64::from(a.last_row.max(b.last_row) - a.first_row.min(b.first_row));
    let rows = f64::from(bottom - top);
    // From the left side to the right one.
    let [above, below] = [top, bottom].map(|row| column_at(b, row) - column_at(a, row));
    let [above, below] = if above + below < 0.0 { [-above, -below] } else { [above, below] };
    let width_px = (above + below) / 2.0;
    let taper = (below - above) / rows;
    let is_post = rows >= LEAST_COMMON_ROWS * all_rows
        && rows >= LEAST_HEIGHT_PER_WIDTH * width_px
        && taper <= MOST_TAPER
        && (taper >= 0.0 || are_alike(a, b));
    is_post.then_some(width_px)
}

fn column_at(side: &Range<f64>, row: u16) -> f64 {
    let rows = f64::from(side.last_row - side.first_row);
    let part = (f64::from(row) - f64::from(side.first_row)) / rows.max(1.0);
    side.column_at_first_row + (side.column_at_last_row - side.column_at_first_row) * part
}

/// Whether two inverse depths differ by no more than their independent errors.
fn are_alike(a: &Range<f64>, b: &Range<f64>) -> bool {
    let off = a.estimate.inverse_depth_per_m - b.estimate.inverse_depth_per_m;
    let sigma = a.estimate.budget.independent_per_m().hypot(b.estimate.budget.independent_per_m());
    off.abs() <= SIGNIFICANT_SIGMAS * sigma
}

/// To the line in the middle, with one sigma.
fn distance_m(a: &Range<f64>, b: &Range<f64>) -> Option<(f64, f64)> {
    let (a, b) = (&a.estimate, &b.estimate);
    let inverse_depth = (a.inverse_depth_per_m + b.inverse_depth_per_m) / 2.0;
    let sigma = sigma_of_mean(&a.budget, &b.budget);
    let distance_m = (a.distance_per_depth + b.distance_per_depth) / 2.0 / inverse_depth;
    (inverse_depth > SIGNIFICANT_SIGMAS * sigma).then_some((distance_m, distance_m * sigma / inverse_depth))
}

fn sigma_of_mean(a: &Budget<f64>, b: &Budget<f64>) -> f64 {
    let parts = a.parts().into_iter().zip(b.parts()).map(|((source, a), (_, b))| match source {
        ErrorSource::Noise => a.hypot(b) / 2.0,
        _ => (a + b) / 2.0,
    });
    parts.fold(0.0, f64::hypot)
}
