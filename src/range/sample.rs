//! [`Sample`]: one observation of an edge in real numbers, as the solver takes it.

use crate::edge::EdgePoint;
use crate::line::{Knot, Line};
use crate::scalar::{NS_PER_S, Scalar, over};

/// One observation of an edge in real numbers: a point of it, or the mean over a span of rows.
///
/// Each knot of a [`Line`] gives one; with few, exact points, use them as they are ([`Sample::point`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sample<S> {
    /// Column in pixels.
    pub column_px: S,
    /// Row in pixels; between rows where it is a mean.
    pub row_px: S,
    /// Middle of the exposure in seconds since frame start.
    pub time_s: S,
    /// One standard deviation of the column's noise in pixels.
    pub sigma_px: S,
    /// How column, row and time vary together over the span: one standard deviation of the row, and the change of
    /// column and time that goes with it. Zero for a point. The solver corrects for the curvature with it.
    pub spread: Spread<S>,
}

/// See [`Sample::spread`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Spread<S> {
    /// In pixels.
    pub column_px: S,
    /// In pixels.
    pub row_px: S,
    /// In seconds.
    pub time_s: S,
}

impl<S: Scalar> Sample<S> {
    /// A point without extent.
    #[must_use]
    pub fn point(column_px: S, row_px: S, time_s: S, sigma_px: S) -> Self {
        let spread = Spread { column_px: S::ZERO, row_px: S::ZERO, time_s: S::ZERO };
        Self { column_px, row_px, time_s, sigma_px, spread }
    }
}

/// The mean of a knot, without its spread.
#[derive(Clone, Copy)]
struct Mean<S> {
    column_px: S,
    row_px: S,
    time_s: S,
    sigma_px: S,
}

/// What turns a sum over the points of a knot into their mean: a whole number, in 1/65536 px, or in nanoseconds.
struct PerPoint<S> {
    of_one: S,
    of_q16: S,
    of_ns: S,
}

impl<S: Scalar> PerPoint<S> {
    fn of(points: u16) -> Self {
        let of_one = over(S::from_i32(i32::from(points)));
        Self { of_one, of_q16: of_one * S::ratio(1, 1 << 16), of_ns: of_one * S::ratio(1, NS_PER_S as i32) }
    }
}

impl<S: Scalar> Mean<S> {
    /// With the spread of its rows, and the direction of the line from the neighbours on either side.
    fn with_spread(self, row_px: S, before: &Self, after: &Self) -> Sample<S> {
        let sample = Sample::point(self.column_px, self.row_px, self.time_s, self.sigma_px);
        let rows = after.row_px - before.row_px;
        if rows == S::ZERO {
            return sample;
        }
        let part = row_px / rows;
        let column_px = (after.column_px - before.column_px) * part;
        Sample { spread: Spread { column_px, row_px, time_s: (after.time_s - before.time_s) * part }, ..sample }
    }
}

impl<const KNOTS: usize> Line<KNOTS> {
    /// The mean of each knot that has points, in the order of readout.
    pub fn samples<S: Scalar>(&self) -> impl Iterator<Item = Sample<S>> {
        let spacing = self.row_spacing::<S>();
        let first = Self::point_of::<S>(&self.first);
        // Most knots have as many points as the one before.
        let (mut points, mut per_point, mut row_sigma) = (0, PerPoint::of(0), S::ZERO);
        let mut means = self.filled().map(move |knot| {
            if knot.points != points {
                points = knot.points;
                per_point = PerPoint::of(points);
                row_sigma = self.row_sigma(points, spacing);
            }
            (row_sigma, self.mean(knot, &first, &per_point))
        });
        // Windows of three; at the ends the knot itself stands in for the neighbour it lacks.
        let (mut before, mut next) = (None, means.next());
        core::iter::from_fn(move || {
            let (row_sigma, sample) = next?;
            next = means.next();
            let after = next.map_or(sample, |(_, after)| after);
            let with_spread = sample.with_spread(row_sigma, &before.unwrap_or(sample), &after);
            before = Some(sample);
            Some(with_spread)
        })
    }

    /// The samples at both ends and in the middle; one of them may stand for another. Only their knots are looked at.
    pub(crate) fn first_middle_and_last<S: Scalar>(&self) -> Option<[Sample<S>; 3]> {
        let count = self.filled().count();
        let (spacing, first) = (self.row_spacing::<S>(), Self::point_of::<S>(&self.first));
        let at = |place: usize| {
            let mean = |place| {
                let knot = self.filled().nth(place)?;
                Some((knot.points, self.mean(knot, &first, &PerPoint::of(knot.points))))
            };
            let (points, sample) = mean(place)?;
            let [before, after] = [place.checked_sub(1), Some(place + 1)].map(|place| place.and_then(mean));
            let [before, after] = [before, after].map(|neighbour| neighbour.map_or(sample, |(_, mean)| mean));
            Some(sample.with_spread(self.row_sigma(points, spacing), &before, &after))
        };
        Some([at(0)?, at(count / 2)?, at(count.checked_sub(1)?)?])
    }

    /// A point on the way from the first point to the last, without noise.
    pub(super) fn point_between<S: Scalar>(&self, part: S) -> Sample<S> {
        let [first, last] = [&self.first, &self.last].map(Self::point_of::<S>);
        let between = |first: S, last: S| first + (last - first) * part;
        Sample::point(
            between(first.column_px, last.column_px),
            between(first.row_px, last.row_px),
            between(first.time_s, last.time_s),
            S::ZERO,
        )
    }

    fn filled(&self) -> impl Iterator<Item = &Knot> {
        self.knots.iter().filter(|knot| knot.points > 0)
    }

    fn point_of<S: Scalar>(point: &EdgePoint) -> Mean<S> {
        let row_px = S::from_i32(i32::from(point.row));
        Mean { column_px: point.column_px(), row_px, time_s: point.time_s(), sigma_px: S::ZERO }
    }

    fn mean<S: Scalar>(&self, knot: &Knot, first: &Mean<S>, per: &PerPoint<S>) -> Mean<S> {
        let rows = if self.last.row < self.first.row { -i64::from(knot.rows) } else { i64::from(knot.rows) };
        let variances = knot.variances_q32.min(i64::MAX as u64) as i64;
        Mean {
            column_px: first.column_px + S::from_i64(knot.columns_q16) * per.of_q16,
            row_px: first.row_px + S::from_i64(rows) * per.of_one,
            time_s: first.time_s + S::from_i64(knot.times_ns) * per.of_ns,
            // The root of their sum, over their number.
            sigma_px: S::from_i64(variances).sqrt() * per.of_q16,
        }
    }

    /// Rows from one point to the next, if they are evenly spaced.
    pub(super) fn row_spacing<S: Scalar>(&self) -> S {
        let between = i32::from(self.points.saturating_sub(1)).max(1);
        S::from_i32(i32::from(self.last.row.abs_diff(self.first.row))) / S::from_i32(between)
    }

    /// One standard deviation of the rows in a knot, if they are spaced as evenly as those of the whole line.
    fn row_sigma<S: Scalar>(&self, points: u16, spacing: S) -> S {
        let span = S::from_i32(1 << self.span_log2);
        let extent = (spacing * S::from_i32(i32::from(points))).min(span);
        // n points d apart have the variance (n² − 1) d²/12.
        ((extent * extent - spacing * spacing) * S::ratio(1, 12)).max(S::ZERO).sqrt()
    }
}
