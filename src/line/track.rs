//! [`Track`]: one line under way, with its prediction.

use super::association::Prediction;
use super::filter::{Filter, Memory};
use super::line::Line;
use super::prominence::Around;
use super::tuning::{
    GATE_POINTS, MAX_GATE_Q16, MOST_GUESSED_ROWS, MOST_STITCH_POINTS, MOST_UNEXPECTED_POINTS, SCATTER_POINTS,
    YOUNG_POINTS,
};
use crate::edge::{EdgeModel, EdgePoint, PixelRow, Untracked};
use crate::format::Pixels;
use crate::setup::Limits;

/// A line, and where it goes.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Track<const KNOTS: usize> {
    pub(crate) line: Line<KNOTS>,
    pub(crate) state: State,
    pub(super) filter: Filter,
    /// Levels, blur and noise of the edge, once the line is confirmed, where there are pixels.
    pub(crate) model: Option<EdgeModel>,
    pub(super) missed_rows: u16,
    /// Points since the last one that a model has located, and since it began.
    pub(super) unexpected_points: u8,
    around: Around,
}

/// What may become of a line next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) enum State {
    /// Too few points to be sure of it: it is confirmed, or forgotten.
    Tentative,
    /// It is handed out when it ends.
    Confirmed,
    /// A confirmed line of pixels that has not been seen for some rows: it ends, or goes on where another line begins.
    /// It is no longer located by its model, which would soon take texture for it.
    Hidden,
    /// It waits to be handed out.
    Ended,
}

impl<const KNOTS: usize> Track<KNOTS> {
    pub(crate) fn new(point: EdgePoint, limits: &Limits) -> Self {
        let mut track = Self {
            line: Line::new(point),
            state: State::Tentative,
            filter: Filter::new(point.column_q16),
            model: None,
            missed_rows: 0,
            unexpected_points: 0,
            around: Around::UNSEEN,
        };
        track.renew_gate(track.memory(), limits);
        track
    }

    /// Where the line should cross `row`, and how far off an edge there may lie.
    pub(crate) fn predict(&self, row: u16, limits: &Limits) -> Prediction {
        let rows = row.abs_diff(self.line.last().row);
        let gate_q16 = match rows {
            1 => self.next_gate_q16(),
            _ => self.gate_after(rows, self.memory(), limits),
        };
        Prediction { column_q16: self.filter.column_after(rows), gate_q16, coasting: false }
    }

    /// Where it should cross `row`, for a line that takes no point there.
    pub(super) fn column_only(&self, row: u16) -> Prediction {
        let rows = row.abs_diff(self.line.last().row);
        Prediction { column_q16: self.filter.column_after(rows), gate_q16: 0, coasting: false }
    }

    /// Whether its gate may have changed where its points are as sure as before.
    pub(super) const fn has_gate_to_renew(&self) -> bool {
        let points = self.line.points;
        points <= GATE_POINTS || points.is_multiple_of(GATE_POINTS)
    }

    /// Takes its gate anew where that may have changed.
    fn renew_gate(&mut self, memory: Memory, limits: &Limits) {
        if self.model.is_none() || self.has_gate_to_renew() {
            // It fits: the widest gate is 48 px.
            self.filter.gate_q8 = self.gate_after(1, memory, limits).div_ceil(256) as u16;
        }
    }

    /// How far off its prediction a point so many rows on may lie, in 1/65536 px.
    fn gate_after(&self, rows: u16, memory: Memory, limits: &Limits) -> u32 {
        let of_row_q16 = 4 * self.row_sigma_q16();
        let gate_q16 = memory.gate_q16(rows, limits).saturating_add(of_row_q16);
        let gate_q16 = if self.model.is_some() && self.line.points() >= SCATTER_POINTS {
            let of_scatter_q16 = self.filter.scatter_gate_q16(memory, rows, self.line.is_beside_texture);
            // What no model locates may be known worse than it scatters: to a pixel, and then it jumps by one.
            let least_q16 = if self.unexpected_points > 0 { of_row_q16 } else { 0 };
            gate_q16.min(of_scatter_q16.max(least_q16))
        } else {
            gate_q16
        };
        gate_q16.min(MAX_GATE_Q16)
    }

    /// Two edges nearer than this cannot be told apart, because of their noise or their blur, in 1/65536 px: four sigma
    /// of the noise, or two of the blur.
    pub(super) fn blur_q16(&self) -> u32 {
        (4 * self.row_sigma_q16()).max(u32::from(self.line.last().width_q8) << 9)
    }

    pub(super) fn memory(&self) -> Memory {
        let rows = self.line.last().row.abs_diff(self.line.first().row).saturating_add(1);
        Memory::of(self.line.points(), rows)
    }

    /// Counts a row without an edge, and hides the line. Whether there are too many of them.
    pub(crate) fn misses_row(&mut self, limits: &Limits) -> bool {
        self.missed_rows = self.missed_rows.saturating_add(1);
        if self.state == State::Confirmed && self.model.is_some() && self.missed_rows > MOST_GUESSED_ROWS {
            self.state = State::Hidden;
        }
        // The longer a line has been, the longer it may be hidden.
        let gap = match self.state {
            State::Tentative => limits.tentative_gap_rows,
            _ if self.model.is_some() => limits.gap_rows.saturating_add(self.line.points().saturating_mul(2)),
            _ => limits.gap_rows.saturating_add(self.line.points() / 2),
        };
        self.missed_rows > gap
    }

    /// Sigma of the last row by itself.
    fn row_sigma_q16(&self) -> u32 {
        self.line.last().sigma_q16.min(EdgePoint::MAX_SIGMA_Q16)
    }

    /// What sigma of an edge to state: beside texture no less than the edges scatter. What they have in common with the
    /// rows around them the residuals of the fit will show.
    pub(super) fn stated_sigma_q16(&self, sigma_q16: u32) -> u32 {
        if self.line.is_beside_texture { sigma_q16.max(self.scatter_sigma_q16()) } else { sigma_q16 }
    }

    /// One sigma of normal values is 5/4 of their mean size.
    pub(super) fn scatter_sigma_q16(&self) -> u32 {
        u32::from(self.filter.scatter_q16) * 5 / 4
    }

    /// Takes an edge that matches.
    pub(crate) fn take(&mut self, point: EdgePoint, limits: &Limits) -> bool {
        let rows = point.row.abs_diff(self.line.last().row);
        if self.line.push_checked(&point).is_err() {
            return false;
        }
        let memory = self.memory();
        self.filter.follow(point.column_q16, memory, rows, self.line.is_beside_texture);
        self.missed_rows = 0;
        self.renew_gate(memory, limits);
        // A line that leans more than one may begin with is none of ours, however well it is seen.
        let is_upright = self.filter.slope_q16.unsigned_abs() <= limits.max_slope_q16;
        if self.state != State::Tentative || self.line.points() >= limits.confirm_points && is_upright {
            self.state = State::Confirmed;
        }
        true
    }

    /// Takes a point that its row shows on its own. Where these go on and the model locates none, it was made from
    /// something else when the line was confirmed.
    pub(crate) fn take_scanned(&mut self, point: &EdgePoint, limits: &Limits) -> bool {
        let taken = self.take(EdgePoint { sigma_q16: self.stated_sigma_q16(point.sigma_q16), ..*point }, limits);
        self.unexpected_points = self.unexpected_points.saturating_add(u8::from(taken));
        if self.unexpected_points > MOST_UNEXPECTED_POINTS {
            self.unexpected_points = 0;
            self.model = None;
        }
        taken
    }

    /// Where the next row shows it, if it goes on.
    pub(super) fn next_column_q16(&self) -> i32 {
        self.filter.column_after(1)
    }

    /// How far off there.
    pub(super) fn next_gate_q16(&self) -> u32 {
        u32::from(self.filter.gate_q8) << 8
    }

    /// Whether a point of its kind in the next row, at the right place, would be its own. (It has no model, and so no texture
    /// beside it.)
    pub(super) fn may_take_next(&self, row: u16, point: &EdgePoint) -> bool {
        let (first, last) = (self.line.first(), self.line.last());
        let advance = i32::from(row) - i32::from(last.row);
        let goes_on = advance.unsigned_abs() == 1 && advance * (i32::from(last.row) - i32::from(first.row)) > 0;
        self.state == State::Confirmed && goes_on && point.time_ns >= last.time_ns && point.polarity == last.polarity
    }

    /// Takes such a point. There is no model, and so nobody asks how far its points scatter.
    #[inline(always)]
    pub(super) fn take_next_point(&mut self, point: &EdgePoint, limits: &Limits) {
        let predicted_q16 = self.next_column_q16();
        let is_as_sure = point.sigma_q16 == self.line.last.sigma_q16;
        self.line.push_next(point.row, point.time_ns, point.column_q16, point.sigma_q16, point.width_q8);
        self.filter.follow_next(point.column_q16 - predicted_q16, predicted_q16, self.memory());
        if !is_as_sure || self.has_gate_to_renew() {
            self.renew_gate_in_time(limits);
        }
    }

    #[inline(never)] // seldom
    pub(super) fn renew_gate_in_time(&mut self, limits: &Limits) {
        self.renew_gate(self.memory(), limits);
    }

    /// Whether this row has shown it, and it has no model yet.
    pub(super) fn is_to_learn(&self, row: u16) -> bool {
        self.state == State::Confirmed && self.model.is_none() && self.line.last().row == row
    }

    /// Whether it has never been looked at what is around it, which is then looked at as a whole.
    pub(super) fn is_unseen(&self) -> bool {
        self.line.prominence.is_unseen()
    }

    /// Looks at what is around its last point.
    pub(super) fn look_around<P: Pixels>(&mut self, row: PixelRow<'_, P>) {
        self.around.look(&mut self.line.prominence, row, &self.line.last);
    }

    /// Gives it a model of its edge, if there is one, and such edges beside it.
    pub(super) fn set_model(&mut self, model: Option<EdgeModel>, untracked: Untracked) {
        (self.model, self.line.untracked) = (model, untracked);
        self.line.mark_as_of_pixels();
    }

    /// Whether it has been confirmed so lately that it may go on where another one broke off.
    pub(super) fn is_young(&self) -> bool {
        const MOST: u16 = if YOUNG_POINTS > MOST_STITCH_POINTS { YOUNG_POINTS } else { MOST_STITCH_POINTS };
        self.state == State::Confirmed && self.line.points() <= MOST
    }
}
