//! [`Line`]: the points of one edge in the image, summed into a bounded list of knots.

use core::num::NonZeroU16;

use heapless::Vec;

use super::asides::Asides;
use super::knot::Knot;
use super::prominence::Prominence;
use crate::edge::{EdgePoint, Untracked};
use crate::setup::Readout;

/// A point that a [`Line`] has refused because its row or its time does not follow the last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OutOfOrder(pub EdgePoint);

/// The points of one edge in the image: the first, the last, and the sums of all in at most `KNOTS` knots (40 bytes
/// each).
///
/// A knot covers a span of rows. The span is one row at first, and doubles whenever the list is full: neighbouring
/// knots are then merged. So any number of points fits in bounded memory. Rows may ascend or descend, as they are read,
/// and may be sparse.
///
/// *Accuracy*: 16 knots of a full-row edge cost at most 10⁻⁵ of the depth with the tilt known, 3·10⁻⁵ with a prior of 0.1°
/// and 2·10⁻⁴ with one of 1° (`cargo test reference_lines`).
///
/// ```
/// use shutter_range::{EdgePoint, Line};
/// let mut line: Line<16> = Line::new(EdgePoint::new(100, 320 << 16, 0));
/// for row in 101..400 {
///     line.push(EdgePoint::new(row, 320 << 16, i64::from(row - 100) * 30_000)).unwrap();
/// }
/// assert_eq!(line.points(), 300);
/// assert_eq!(line.samples::<f32>().count(), 10); // spans of 32 rows
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Line<const KNOTS: usize> {
    pub(crate) knots: Vec<Knot, KNOTS>,
    pub(crate) first: EdgePoint,
    pub(crate) last: EdgePoint,
    pub(crate) points: u16,
    /// Of a line of pixels: how it stands out of what is around.
    pub(super) prominence: Prominence,
    /// Whether it was found in rows of pixels, where nearly every row should show the edge.
    of_pixels: bool,
    /// It has been beside texture: its points are stated to be as noisy as they scatter.
    // Here, where it takes no room.
    pub(super) is_beside_texture: bool,
    /// It begins where the light of the rows has changed.
    pub(super) begins_with_light: bool,
    /// Other lines of its kind a step beside its ends; when it is handed out, only where most lines of the frame have them.
    pub(super) asides: Asides,
    /// One more than the row in which it was last seen before the light of the rows changed: where that is its last one, it
    /// has broken off with the light.
    pub(super) left_by_light: Option<NonZeroU16>,
    /// While it is under way: how far away an edge without a line is on either side.
    pub(super) untracked: Untracked,
    /// Rows per knot: 2 to this power.
    pub(crate) span_log2: u8,
}

impl<const KNOTS: usize> Line<KNOTS> {
    const AT_LEAST_FOUR: () = assert!(KNOTS >= 4, "a line needs at least 4 knots");

    /// A line of one point.
    #[must_use]
    pub fn new(first: EdgePoint) -> Self {
        let () = Self::AT_LEAST_FOUR;
        let mut line = Self {
            knots: Vec::new(),
            first,
            last: first,
            points: 1,
            prominence: Prominence::default(),
            of_pixels: false,
            is_beside_texture: false,
            begins_with_light: false,
            asides: Asides::NONE,
            left_by_light: None,
            untracked: Untracked::NONE,
            span_log2: 0,
        };
        // There is room.
        let _ = line.knots.push(Knot::of(&first, &first));
        line
    }

    /// Appends the point of a later row. The second point decides whether the line's rows ascend or descend.
    ///
    /// *Errors*: hands the point back where its row repeats or goes back, or its time goes back; the line is then
    /// unchanged.
    ///
    /// *Cost*: a few dozen instructions, and a merge of all knots each time the line's length doubles.
    pub fn push(&mut self, point: EdgePoint) -> Result<(), OutOfOrder> {
        self.check_order(&point)?;
        self.add(&point);
        self.last = point;
        self.points = self.points.saturating_add(1);
        Ok(())
    }

    /// As [`Line::push`], for a point of the same polarity that a [`Ranger`](crate::Ranger) has checked: no sum of times
    /// saturates.
    pub(super) fn push_checked(&mut self, point: &EdgePoint) -> Result<(), OutOfOrder> {
        self.check_order(point)?;
        let EdgePoint { row, time_ns, column_q16, sigma_q16, width_q8, .. } = *point;
        self.push_next(row, time_ns, column_q16, sigma_q16, width_q8);
        Ok(())
    }

    /// Appends the point of the next row, of the same polarity, which a [`Ranger`](crate::Ranger) has checked.
    #[inline(always)]
    pub(super) fn push_next(&mut self, row: u16, time_ns: i64, column_q16: i32, sigma_q16: u32, width_q8: u16) {
        let last = &mut self.last;
        (last.row, last.time_ns, last.column_q16, last.sigma_q16, last.width_q8) =
            (row, time_ns, column_q16, sigma_q16, width_q8);
        let index = usize::from(row.abs_diff(self.first.row) >> self.span_log2);
        match self.knots.get_mut(index) {
            Some(knot) => knot.add_checked(&self.last, &self.first),
            None => self.add_last(),
        }
        self.points = self.points.saturating_add(1);
    }

    /// Begins a knot with the last point.
    #[inline(never)]
    fn add_last(&mut self) {
        let last = self.last;
        self.add(&last);
    }

    /// Refuses a point that does not come after the last one, on the same side of the first.
    fn check_order(&self, point: &EdgePoint) -> Result<(), OutOfOrder> {
        let advance = i32::from(point.row) - i32::from(self.last.row);
        let so_far = i32::from(self.last.row) - i32::from(self.first.row);
        let turned_back = so_far != 0 && (advance ^ so_far) < 0;
        if advance == 0 || turned_back || point.time_ns < self.last.time_ns {
            return Err(OutOfOrder(*point));
        }
        Ok(())
    }

    /// Appends, knot by knot, a line that began later and ended later. The two may overlap.
    ///
    /// *Errors*: as [`Line::push`] for the last point of `later`, or where `later` began first; this line is then
    /// unchanged.
    pub(crate) fn append(&mut self, later: &Self) -> Result<(), OutOfOrder> {
        self.check_order(&later.last)?;
        if later.first.time_ns <= self.first.time_ns || later.first.row == self.first.row {
            return Err(OutOfOrder(later.first));
        }
        let start = Knot::of(&later.first, &self.first);
        for knot in later.knots.iter().filter(|knot| knot.points > 0) {
            let points = knot.points;
            let knot = Knot {
                columns_q16: knot.columns_q16.saturating_add(start.columns_q16 * i64::from(points)),
                times_ns: knot.times_ns.saturating_add(start.times_ns.saturating_mul(i64::from(points))),
                rows: knot.rows.saturating_add(start.rows * u32::from(points)),
                ..*knot
            };
            let index = self.index_of(knot.rows.checked_div(u32::from(points)).unwrap_or(0) as u16);
            match self.knots.get_mut(index) {
                Some(own) => own.add(&knot),
                None => self.push_knot(index, knot),
            }
        }
        self.last = later.last;
        self.points = self.points.saturating_add(later.points);
        self.prominence.add(&later.prominence);
        Ok(())
    }

    /// Takes the times of all points from the readout: they follow from the rows.
    pub(crate) fn retime(&mut self, readout: &Readout) {
        self.first.time_ns = readout.row_time_ns(self.first.row);
        self.last.time_ns = readout.row_time_ns(self.last.row);
        for knot in &mut self.knots {
            let times_ps = u128::from(knot.rows) * u128::from(readout.line_time_ps());
            knot.times_ns = i64::try_from(times_ps / 1000).unwrap_or(i64::MAX);
        }
    }

    /// Raises the sigmas of all points so far to at least this.
    pub(crate) fn raise_sigmas(&mut self, sigma_q16: u32) {
        let square = u64::from(sigma_q16) * u64::from(sigma_q16);
        for knot in &mut self.knots {
            knot.variances_q32 = knot.variances_q32.max(square.saturating_mul(u64::from(knot.points)));
        }
    }

    pub(crate) fn mark_as_of_pixels(&mut self) {
        self.of_pixels = true;
    }

    pub(crate) const fn is_of_pixels(&self) -> bool {
        self.of_pixels
    }

    /// The light has left it after its last point.
    pub(super) fn mark_left_by_light(&mut self) {
        self.left_by_light = NonZeroU16::MIN.checked_add(self.last.row);
    }

    /// Whether it begins or breaks off where the light of the rows changes: it may be a piece of an edge in pulsed light, all
    /// rows of which have seen it at the same time.
    pub(crate) fn is_cut_by_light(&self) -> bool {
        self.begins_with_light || self.left_by_light.is_some_and(|row| row.get() - 1 == self.last.row)
    }

    /// Whether it goes on a step aside, as most lines of its frame do: it may be a piece of an edge that advances in jumps.
    pub(crate) fn is_piece(&self) -> bool {
        self.asides.any()
    }

    /// Whether it stands out of what is around it by so many times what excludes chance; so does a line of points that
    /// were handed over.
    pub(crate) fn stands_out(&self, times: u64) -> bool {
        let rows = self.last.row.abs_diff(self.first.row).saturating_add(1);
        !(self.of_pixels && self.prominence.is_by_chance(times, self.points, rows, self.scatter_q32()))
    }

    /// Variance of the scatter of the points in 1/2³² px², where texture beside the line makes it that.
    fn scatter_q32(&self) -> Option<u64> {
        let sum_q32 = self.knots.iter().fold(0_u64, |sum, knot| sum.saturating_add(knot.variances_q32));
        self.is_beside_texture.then(|| sum_q32.checked_div(self.points.into()).unwrap_or(0))
    }

    /// How far the levels overshoot beside the flank in the mean, as a share of the contrast times a pixel, in 1/65536;
    /// zero for a line of points that were handed over.
    pub(crate) fn overshoot_q16(&self) -> u32 {
        self.prominence.overshoot_q16()
    }

    /// The most that the variance of its blur can be, in 1/65536 square pixel, as the pixels around it show it, where widths
    /// are no measure of it: beside texture, or where most of its points have none. `None` elsewhere, and for a line of
    /// points that were handed over.
    pub(crate) fn most_variance_q16(&self, has_widths: bool) -> Option<u32> {
        if has_widths && !self.is_beside_texture { None } else { self.prominence.most_variance_q16() }
    }

    /// Mean contrast in grey levels, whatever its polarity; zero for a line of points that were handed over.
    pub(crate) fn contrast(&self) -> u8 {
        self.prominence.contrast()
    }

    /// The point that was read first.
    #[must_use]
    pub const fn first(&self) -> &EdgePoint {
        &self.first
    }

    /// The point that was read last.
    #[must_use]
    pub const fn last(&self) -> &EdgePoint {
        &self.last
    }

    /// Number of points.
    #[must_use]
    pub const fn points(&self) -> u16 {
        self.points
    }

    /// The topmost and the lowest point in the image.
    pub(crate) const fn top_and_bottom(&self) -> (&EdgePoint, &EdgePoint) {
        if self.first.row <= self.last.row { (&self.first, &self.last) } else { (&self.last, &self.first) }
    }

    /// Number of points in the samples that are `kept`.
    pub(crate) fn points_in(&self, kept: impl Iterator<Item = bool>) -> u16 {
        let filled = self.knots.iter().filter(|knot| knot.points > 0);
        filled.zip(kept).fold(0, |sum, (knot, kept)| if kept { knot.points.saturating_add(sum) } else { sum })
    }

    /// Adds a point to its knot.
    fn add(&mut self, point: &EdgePoint) {
        let index = self.index_of(point.row.abs_diff(self.first.row));
        match self.knots.get_mut(index) {
            Some(knot) => knot.add_point(point, &self.first),
            None => self.push_knot(index, Knot::of(point, &self.first)),
        }
    }

    /// Which knot covers the row `offset` rows from the first.
    fn index_of(&mut self, offset: u16) -> usize {
        while usize::from(offset >> self.span_log2) >= KNOTS {
            self.merge();
        }
        usize::from(offset >> self.span_log2)
    }

    /// Adds a knot of this index, which is below the capacity, and empty ones before it.
    #[inline(never)]
    fn push_knot(&mut self, index: usize, knot: Knot) {
        while self.knots.len() < index {
            let _ = self.knots.push(Knot::EMPTY);
        }
        let _ = self.knots.push(knot);
    }

    /// Doubles the span: merges each knot with its neighbour.
    #[inline(never)]
    fn merge(&mut self) {
        let pairs = self.knots.len().div_ceil(2);
        for pair in 0..pairs {
            let first = self.knots.get(2 * pair).unwrap_or(&Knot::EMPTY);
            let second = self.knots.get(2 * pair + 1).unwrap_or(&Knot::EMPTY);
            let sum = first.and(second);
            if let Some(place) = self.knots.get_mut(pair) {
                *place = sum;
            }
        }
        self.knots.truncate(pairs);
        self.span_log2 += 1;
    }
}
