//! [`Post`]: two opposite edges that are the sides of one upright thing, and how far its middle is.

use super::budget::{Budget, ErrorSource};
use super::estimate::{Interval, Sigmas};
use super::range::Range;
use super::status::RangeStatus;
use crate::edge::Polarity;
use crate::scalar::{Scalar, hypot};

/// Two edges that are the sides of one post: the same rows and opposite polarities, nearer to each other than to any
/// other edge like that, and no further apart than a quarter of their height.
///
/// An edge of inverse depth ρ that leans by β looks like an upright one of inverse depth ρ + β/s, where s is the slope
/// that the camera's motion gives to an edge at 1 m. The sides of a tapered post lean by +t and −t, so that t cancels
/// in
///
/// ```text
/// ρ = (ρ₁ + ρ₂) / 2
/// σ² = (n₁² + n₂²) / 4 + ((l₁ + l₂) / 2)² + Σ ((c₁ + c₂) / 2)²
/// ```
///
/// with n the parts of their sigmas that come from noise, l from lean, and c from each source that all edges of a frame
/// share. Of the lean the taper is gone; what is left is that of the whole post, which is the same on both sides.
///
/// ```
/// use shutter_range::{BoardRanger, EdgePoint, Polarity, Post, Setup, Sigmas, Twist};
/// let (setup, motion) = (Setup::pinhole(640, 480, 600.0_f32, 33_300_000)?, Twist::level([-2.0, 0.0, 0.0])?);
/// let mut ranger = BoardRanger::new();
/// for row in 0..480 {
///     let time_ns = setup.readout().row_time_ns(row);
///     // 3 m away, and tapered by 0.2° on either side.
///     let taper_px = 0.0035 * (f64::from(row) - 239.5);
///     for (column_px, lean_px, polarity) in [(250.0, -taper_px, Polarity::Falling), (270.0, taper_px, Polarity::Rising)] {
///         let column_px = column_px + 600.0 * 2.0 / 3.0 * time_ns as f64 * 1e-9 + lean_px;
///         let point = EdgePoint::new(row, (column_px * 65536.0) as i32, time_ns);
///         ranger.edge_point(&setup, point.with_polarity(polarity))?;
///     }
/// }
/// ranger.end_frame(&setup);
/// let ranges: Vec<_> = std::iter::from_fn(|| ranger.next_range(&setup, &motion)).collect();
/// let post = Post::of(&ranges, 0).unwrap();
/// let (distance_m, _) = post.distance(Sigmas(2.0)).estimate_m.unwrap();
/// assert!(post.other == 1 && (distance_m - 3.0).abs() < 0.1);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Post<S> {
    /// The index of the range of the other side.
    pub other: usize,
    /// Of the line in the middle, in 1/m.
    pub inverse_depth_per_m: S,
    /// One standard deviation.
    pub sigma_inverse_depth_per_m: S,
    /// Shortest distance to the line in the middle, in units of its depth.
    pub distance_per_depth: S,
}

/// A post is at least so many times as high as wide.
const LEAST_HEIGHT_PER_WIDTH: i32 = 4;

/// Rows that both sides have, of those that one of them has, in percent.
const LEAST_COMMON_PERCENT: i32 = 80;

/// How much wider a post may become with each row, half of it on either side: half a degree each.
const MOST_TAPER: (i32, i32) = (175, 10_000);

/// So much less is still none, as far as sides that are alike can be told.
const SIGNIFICANT_SIGMAS: i32 = 3;

impl<S: Scalar> Post<S> {
    /// The post of which the edge of a range is a side; `None` where there is none. `ranges` are all of one frame.
    ///
    /// *Cost*: two passes over the ranges; no memory.
    #[must_use]
    pub fn of(ranges: &[Range<S>], index: usize) -> Option<Self> {
        let other = nearest_opposite(ranges, index)?;
        if nearest_opposite(ranges, other) != Some(index) {
            return None;
        }
        let [a, b] = [&ranges.get(index)?.estimate, &ranges.get(other)?.estimate];
        let half = S::ratio(1, 2);
        Some(Self {
            other,
            inverse_depth_per_m: (a.inverse_depth_per_m + b.inverse_depth_per_m) * half,
            sigma_inverse_depth_per_m: sigma_of_mean(&a.budget, &b.budget),
            distance_per_depth: (a.distance_per_depth + b.distance_per_depth) * half,
        })
    }

    /// `Ok`, or `Far` within three sigma of infinity; `Inconsistent` where both sides together are beyond it by more.
    #[must_use]
    pub fn status(&self) -> RangeStatus {
        RangeStatus::of_numbers(self.inverse_depth_per_m, self.sigma_inverse_depth_per_m, false)
    }

    /// Shortest distance to the line in the middle, and its bounds so many sigmas of inverse depth on either side; no
    /// most likely value unless the status is [`Ok`](RangeStatus::Ok).
    #[must_use]
    pub fn distance(&self, sigmas: Sigmas<S>) -> Interval<S> {
        let inverse = (self.inverse_depth_per_m, self.sigma_inverse_depth_per_m);
        Interval::of_inverse(inverse, self.status(), sigmas, self.distance_per_depth)
    }
}

/// The edge that would make the narrowest post with this one.
fn nearest_opposite<S: Scalar>(ranges: &[Range<S>], index: usize) -> Option<usize> {
    let side = ranges.get(index)?;
    let widths = ranges.iter().enumerate().filter_map(|(other, range)| Some((other, width_px(side, range)?)));
    let narrower = |least: (usize, S), next: (usize, S)| if next.1 < least.1 { next } else { least };
    widths.reduce(narrower).map(|(other, _)| other)
}

/// The width of the post that two edges would be the sides of, in the middle of the rows that they share.
fn width_px<S: Scalar>(a: &Range<S>, b: &Range<S>) -> Option<S> {
    let are_opposite = matches!(
        (a.polarity, b.polarity),
        (Polarity::Rising, Polarity::Falling) | (Polarity::Falling, Polarity::Rising)
    );
    let are_sound = [a, b].iter().all(|side| matches!(side.status, RangeStatus::Ok | RangeStatus::Far));
    let (top, bottom) = (a.first_row.max(b.first_row), a.last_row.min(b.last_row));
    if !(are_opposite && are_sound && top < bottom) {
        return None;
    }
    let all_rows = i32::from(a.last_row.max(b.last_row)) - i32::from(a.first_row.min(b.first_row));
    let common_rows = i32::from(bottom) - i32::from(top);
    let rows = S::from_i32(common_rows);
    // From the left side to the right one.
    let [above, below] = [top, bottom].map(|row| column_at(b, row) - column_at(a, row));
    let [above, below] = if above + below < S::ZERO { [-above, -below] } else { [above, below] };
    let width_px = (above + below) * S::ratio(1, 2);
    let taper = (below - above) / rows;
    let is_post = 100 * common_rows >= LEAST_COMMON_PERCENT * all_rows
        && rows >= width_px * S::from_i32(LEAST_HEIGHT_PER_WIDTH)
        && taper <= S::ratio(MOST_TAPER.0, MOST_TAPER.1)
        && (taper >= S::ZERO || are_alike(a, b));
    is_post.then_some(width_px)
}

fn column_at<S: Scalar>(side: &Range<S>, row: u16) -> S {
    let rows_from_top = |row: u16| i32::from(row) - i32::from(side.first_row);
    let part = S::from_i32(rows_from_top(row)) / S::from_i32(rows_from_top(side.last_row).max(1));
    side.column_at_first_row + (side.column_at_last_row - side.column_at_first_row) * part
}

/// Whether two inverse depths differ by no more than their independent errors.
fn are_alike<S: Scalar>(a: &Range<S>, b: &Range<S>) -> bool {
    let off = a.estimate.inverse_depth_per_m - b.estimate.inverse_depth_per_m;
    let sigma = hypot(a.estimate.budget.independent_per_m(), b.estimate.budget.independent_per_m());
    off.abs() <= sigma * S::from_i32(SIGNIFICANT_SIGMAS)
}

fn sigma_of_mean<S: Scalar>(a: &Budget<S>, b: &Budget<S>) -> S {
    let parts = a.parts().into_iter().zip(b.parts()).map(|((source, a), (_, b))| match source {
        ErrorSource::Noise => hypot(a, b),
        _ => a + b,
    });
    parts.fold(S::ZERO, hypot) * S::ratio(1, 2)
}
