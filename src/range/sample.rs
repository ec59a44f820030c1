//! [`Sample`]: one observation of an edge in real numbers, as the solver takes it.

use crate::line::{Knot, Line};
use crate::scalar::{NS_PER_S, Scalar};

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
    /// How column, row and time vary together over the span: one standard deviation of the row, and the change of column
    /// and time that goes with it. Zero for a point. The solver corrects for the curvature with it.
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

    /// With the spread of its rows, and the direction of the line from the neighbours on either side.
    fn with_spread(self, row_variance: S, before: &Self, after: &Self) -> Self {
        let rows = after.row_px - before.row_px;
        if rows == S::ZERO {
            return self;
        }
        let row_px = row_variance.sqrt();
        let part = row_px / rows;
        let column_px = (after.column_px - before.column_px) * part;
        Self { spread: Spread { column_px, row_px, time_s: (after.time_s - before.time_s) * part }, ..self }
    }
}

impl<const KNOTS: usize> Line<KNOTS> {
    /// The mean of each knot that has points, in the order of readout.
    pub fn samples<S: Scalar>(&self) -> impl Iterator<Item = Sample<S>> {
        let filled = || self.knots.iter().filter(|knot| knot.points > 0);
        // Windows of three; at the ends the knot itself stands in for the neighbour it lacks.
        let before = filled().take(1).chain(filled());
        let after = filled().skip(1).chain(filled().next_back());
        filled().zip(before).zip(after).map(|((knot, before), after)| {
            self.mean::<S>(knot).with_spread(self.row_variance(knot), &self.mean(before), &self.mean(after))
        })
    }

    fn mean<S: Scalar>(&self, knot: &Knot) -> Sample<S> {
        let first = &self.first;
        let points = i64::from(knot.points);
        let rows = if self.last.row < first.row { -i64::from(knot.rows) } else { i64::from(knot.rows) };
        Sample::point(
            S::from_ratio(i64::from(first.column_q16) * points + knot.columns_q16, points << 16),
            S::from_ratio(i64::from(first.row) * points + rows, points),
            first.time_s::<S>() + S::from_ratio(knot.times_ns, points * NS_PER_S),
            S::from_ratio(knot.variances_q32.isqrt() as i64, points << 16),
        )
    }

    /// Variance of the rows in a knot, in square pixels, if they are spaced as evenly as those of the whole line.
    fn row_variance<S: Scalar>(&self, knot: &Knot) -> S {
        let between = i64::from(self.points.saturating_sub(1)).max(1);
        let spacing = S::from_ratio(i64::from(self.last.row.abs_diff(self.first.row)), between);
        let extent = spacing * S::from_i32(i32::from(knot.points));
        let span = S::from_i32(1 << self.span_log2);
        let smallest = if extent < span { extent } else { span };
        // n points d apart have the variance (n² − 1) d²/12.
        ((smallest * smallest - spacing * spacing) * S::ratio(1, 12)).max(S::ZERO)
    }
}
