//! [`Line`]: the edges of one line, summed into a bounded list of knots.

use heapless::Vec;

use crate::edge::NS_PER_S;
use crate::{Edge, Scalar};

/// One observation for the solver: a point of an edge in real numbers, or the mean of a stretch of it.
///
/// A [`Line`] makes one of each knot; someone with few, exact points can feed them as they are ([`Sample::point`]).
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
    /// How column, row and time go together within the stretch that this is the mean of: one standard deviation of the
    /// row, and what column and time change meanwhile. Zero for a point. The solver corrects for the curve with it.
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

    /// Takes the spread of rows, and the direction of the edge from the neighbours on either side.
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

/// Sums over the edges of a span of rows, counted from the line's first edge. Sums are exact and know no order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Knot {
    columns_q16: i64,
    times_ns: i64,
    variances_q32: u64,
    rows: u32,
    widths_q8: u32,
    edges: u16,
    /// Number of edges whose width was measured.
    widths: u16,
}

impl Knot {
    const EMPTY: Self =
        Self { columns_q16: 0, times_ns: 0, variances_q32: 0, rows: 0, widths_q8: 0, edges: 0, widths: 0 };

    fn of(edge: &Edge, first: &Edge) -> Self {
        // A sum of 65535 squares fits; a sigma of zero would be an infinite weight.
        let sigma = u64::from(edge.sigma_q16.clamp(1, Edge::MAX_SIGMA_Q16));
        let variance = sigma * sigma;
        Self {
            columns_q16: i64::from(edge.column_q16) - i64::from(first.column_q16),
            times_ns: edge.time_ns.saturating_sub(first.time_ns),
            variances_q32: variance,
            rows: u32::from(edge.row.abs_diff(first.row)),
            widths_q8: u32::from(edge.width_q8),
            edges: 1,
            widths: u16::from(edge.width_q8 > 0),
        }
    }

    /// Only times can saturate, and not those of edges that a [`Ranger`](crate::Ranger) has checked.
    fn add(&mut self, other: &Self) {
        self.columns_q16 = self.columns_q16.saturating_add(other.columns_q16);
        self.times_ns = self.times_ns.saturating_add(other.times_ns);
        self.variances_q32 = self.variances_q32.saturating_add(other.variances_q32);
        self.rows = self.rows.saturating_add(other.rows);
        self.widths_q8 = self.widths_q8.saturating_add(other.widths_q8);
        self.edges = self.edges.saturating_add(other.edges);
        self.widths = self.widths.saturating_add(other.widths);
    }
}

/// An edge refused by a [`Line`]: its row does not come after the last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OutOfOrder(pub Edge);

/// The edges of one line: first, last, and at most `KNOTS` knots (40 bytes each).
///
/// A knot covers a span of rows: one row at first, twice as many whenever the list is full and neighbours are merged,
/// so that any number of edges fits at a known cost. Rows may rise or fall, as they are read, and may be sparse.
///
/// *Accuracy*: 16 knots of a full-row edge cost at most 3·10⁻⁵ of the depth (2·10⁻⁴ with tilt free).
///
/// ```
/// use shutter_range::{Edge, Line};
/// let mut line: Line<16> = Line::new(Edge::new(100, 320 << 16, 0));
/// for row in 101..400 {
///     line.push(Edge::new(row, 320 << 16, i64::from(row - 100) * 30_000)).unwrap();
/// }
/// assert_eq!(line.edges(), 300);
/// assert_eq!(line.samples::<f32>().count(), 10); // spans of 32 rows
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Line<const KNOTS: usize> {
    knots: Vec<Knot, KNOTS>,
    first: Edge,
    last: Edge,
    edges: u16,
    /// Rows with several edges of no line, wherever they are, or with texture beside this one.
    crowded_rows: u16,
    /// It was found in rows of pixels, where an edge is to be seen in nearly every row.
    of_pixels: bool,
    /// Rows per knot: 2 to this power.
    span_log2: u8,
}

impl<const KNOTS: usize> Line<KNOTS> {
    const AT_LEAST_FOUR: () = assert!(KNOTS >= 4, "a line needs at least 4 knots");

    /// A line of one edge.
    #[must_use]
    pub fn new(first: Edge) -> Self {
        let () = Self::AT_LEAST_FOUR;
        let mut line =
            Self { knots: Vec::new(), first, last: first, edges: 1, crowded_rows: 0, of_pixels: false, span_log2: 0 };
        line.add(&Knot::of(&first, &first), 0);
        line
    }

    /// Appends the edge of a later row: below the last one or above it, as the second edge decides.
    ///
    /// *Errors*: hands the edge back where its row repeats or goes back, or its time does.
    ///
    /// *Cost*: a few dozen instructions; a merge of all knots each time the line's length doubles.
    pub fn push(&mut self, edge: Edge) -> Result<(), OutOfOrder> {
        self.check_order(&edge)?;
        self.add(&Knot::of(&edge, &self.first), edge.row.abs_diff(self.first.row));
        self.last = edge;
        self.edges = self.edges.saturating_add(1);
        Ok(())
    }

    /// Whether an edge comes after the last one, and on the same side of the first.
    fn check_order(&self, edge: &Edge) -> Result<(), OutOfOrder> {
        let advance = i32::from(edge.row) - i32::from(self.last.row);
        let so_far = i32::from(self.last.row) - i32::from(self.first.row);
        let turned_back = advance.signum() * so_far.signum() < 0;
        if advance == 0 || turned_back || edge.time_ns < self.last.time_ns {
            return Err(OutOfOrder(*edge));
        }
        Ok(())
    }

    /// Appends a line that began and ended later, knot by knot: it may have begun before this one's last edge.
    ///
    /// *Errors*: as [`Line::push`] for its last edge, or where it began first; nothing has changed then.
    pub(crate) fn append(&mut self, later: &Self) -> Result<(), OutOfOrder> {
        self.check_order(&later.last)?;
        if later.first.time_ns <= self.first.time_ns || later.first.row == self.first.row {
            return Err(OutOfOrder(later.first));
        }
        let start = Knot::of(&later.first, &self.first);
        for knot in later.knots.iter().filter(|knot| knot.edges > 0) {
            let edges = knot.edges;
            let knot = Knot {
                columns_q16: knot.columns_q16.saturating_add(start.columns_q16 * i64::from(edges)),
                times_ns: knot.times_ns.saturating_add(start.times_ns.saturating_mul(i64::from(edges))),
                rows: knot.rows.saturating_add(start.rows * u32::from(edges)),
                ..*knot
            };
            self.add(&knot, knot.rows.checked_div(u32::from(edges)).unwrap_or(0) as u16);
        }
        self.last = later.last;
        self.edges = self.edges.saturating_add(later.edges);
        self.crowded_rows = self.crowded_rows.saturating_add(later.crowded_rows);
        Ok(())
    }

    /// Raises the sigmas of all edges so far to at least this.
    pub(crate) fn blunt(&mut self, sigma_q16: u32) {
        let square = u64::from(sigma_q16) * u64::from(sigma_q16);
        for knot in &mut self.knots {
            knot.variances_q32 = knot.variances_q32.max(square.saturating_mul(u64::from(knot.edges)));
        }
    }

    pub(crate) fn mark_as_of_pixels(&mut self) {
        self.of_pixels = true;
    }

    pub(crate) const fn is_of_pixels(&self) -> bool {
        self.of_pixels
    }

    pub(crate) fn count_crowded_row(&mut self) {
        self.crowded_rows = self.crowded_rows.saturating_add(1);
    }

    /// Whether most of its rows are crowded, as in texture or clutter.
    pub(crate) const fn is_crowded(&self) -> bool {
        self.crowded_rows > self.edges / 2
    }

    /// The edge that was read first.
    #[must_use]
    pub const fn first(&self) -> &Edge {
        &self.first
    }

    /// The edge that was read last.
    #[must_use]
    pub const fn last(&self) -> &Edge {
        &self.last
    }

    /// Number of edges.
    #[must_use]
    pub const fn edges(&self) -> u16 {
        self.edges
    }

    /// Mean of the measured widths of the edges (one sigma of blur) in pixels; `None` unless most were measured. The first knot,
    /// in which the width settles, counts only where there is no other.
    #[must_use]
    pub fn mean_width_px<S: Scalar>(&self) -> Option<S> {
        let sum = self.settled();
        (sum.widths > sum.edges / 2).then(|| S::from_ratio(i64::from(sum.widths_q8), i64::from(sum.widths) << 8))
    }

    /// One standard deviation of the mean width: each width has one to two times the noise of its column, the more the less
    /// its shape is known.
    pub(crate) fn mean_width_sigma_px<S: Scalar>(&self) -> S {
        let sum = self.settled();
        // The mean variance, over the number of widths.
        let mean_q32 = (sum.variances_q32 / u64::from(sum.edges.max(1))).saturating_mul(4);
        let of_mean_q32 = (mean_q32 / u64::from(sum.widths.max(1))).min(i64::MAX as u64);
        S::from_ratio(of_mean_q32.isqrt() as i64, 1 << 16)
    }

    /// All knots but the first, unless it is the only one.
    fn settled(&self) -> Knot {
        let mut sum = Knot::EMPTY;
        self.knots.iter().skip(usize::from(self.knots.len() > 1)).for_each(|knot| sum.add(knot));
        sum
    }

    /// The topmost and the lowest edge in the image.
    pub(crate) const fn top_and_bottom(&self) -> (&Edge, &Edge) {
        if self.first.row <= self.last.row { (&self.first, &self.last) } else { (&self.last, &self.first) }
    }

    /// Number of edges in those of the samples that are `kept`.
    pub(crate) fn edges_in(&self, kept: impl Iterator<Item = bool>) -> u16 {
        let filled = self.knots.iter().filter(|knot| knot.edges > 0);
        filled.zip(kept).fold(0, |sum, (knot, kept)| if kept { knot.edges.saturating_add(sum) } else { sum })
    }

    /// The mean of each knot that has edges, in the order of readout.
    pub fn samples<S: Scalar>(&self) -> impl Iterator<Item = Sample<S>> {
        let filled = || self.knots.iter().filter(|knot| knot.edges > 0);
        // Windows of three; at the ends the knot itself stands in for the neighbour it lacks.
        let before = filled().take(1).chain(filled());
        let after = filled().skip(1).chain(filled().next_back());
        filled().zip(before).zip(after).map(|((knot, before), after)| {
            self.mean::<S>(knot).with_spread(self.row_variance(knot), &self.mean(before), &self.mean(after))
        })
    }

    fn mean<S: Scalar>(&self, knot: &Knot) -> Sample<S> {
        let first = &self.first;
        let edges = i64::from(knot.edges);
        let rows = if self.last.row < first.row { -i64::from(knot.rows) } else { i64::from(knot.rows) };
        Sample::point(
            S::from_ratio(i64::from(first.column_q16) * edges + knot.columns_q16, edges << 16),
            S::from_ratio(i64::from(first.row) * edges + rows, edges),
            first.time_s::<S>() + S::from_ratio(knot.times_ns, edges * NS_PER_S),
            S::from_ratio(knot.variances_q32.isqrt() as i64, edges << 16),
        )
    }

    /// Variance of the rows in a knot, in square pixels: that of evenly spaced rows as the line has them on the whole,
    /// within the knot's span.
    fn row_variance<S: Scalar>(&self, knot: &Knot) -> S {
        let between = i64::from(self.edges.saturating_sub(1)).max(1);
        let spacing = S::from_ratio(i64::from(self.last.row.abs_diff(self.first.row)), between);
        let extent = spacing * S::from_i32(i32::from(knot.edges));
        let span = S::from_i32(1 << self.span_log2);
        let smallest = if extent < span { extent } else { span };
        // n points d apart have the variance (n² − 1) d²/12.
        ((smallest * smallest - spacing * spacing) * S::ratio(1, 12)).max(S::ZERO)
    }

    /// Adds a knot's sums to the knot that covers the row `offset` rows from the first.
    fn add(&mut self, sums: &Knot, offset: u16) {
        while usize::from(offset >> self.span_log2) >= KNOTS {
            self.merge();
        }
        let index = usize::from(offset >> self.span_log2);
        while self.knots.len() <= index {
            // There is room: the index is below the capacity.
            let _ = self.knots.push(Knot::EMPTY);
        }
        if let Some(knot) = self.knots.get_mut(index) {
            knot.add(sums);
        }
    }

    /// Doubles the span: every knot takes in its neighbour.
    fn merge(&mut self) {
        let mut merged: Vec<Knot, KNOTS> = Vec::new();
        for pair in self.knots.chunks(2) {
            let mut sum = Knot::EMPTY;
            pair.iter().for_each(|knot| sum.add(knot));
            let _ = merged.push(sum);
        }
        self.knots = merged;
        self.span_log2 += 1;
    }
}
