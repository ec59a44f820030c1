//! Where a row of pixels shows a line that has a model of its edge.

use super::association::Prediction;
use super::track::Track;
use crate::edge::{EdgePoint, Expectation, LocatedPoint, Neighbours, PixelRow, UsualPoint};
use crate::format::Pixels;
use crate::setup::Limits;

/// A row and the middle of its exposure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowTime {
    pub(crate) row: u16,
    pub(crate) time_ns: i64,
    /// Whether lines look how far their levels overshoot there.
    pub(crate) looks_for_halo: bool,
}

/// A row in which steady lines are located.
pub(super) struct SeenRow<'p, P> {
    pub(super) at: &'p RowTime,
    pub(super) pixels: PixelRow<'p, P>,
    /// [`PixelRow::quick_bytes`].
    pub(super) bytes: Option<&'p [u8]>,
    pub(super) limits: &'p Limits,
}

impl<'p, P: Pixels> SeenRow<'p, P> {
    /// Its bytes, in a way that leaves out what is made for them where the format never has any.
    #[inline(always)]
    fn quick_bytes(&self) -> Option<&'p [u8]> {
        if P::HAS_QUICK_WAYS { self.bytes } else { None }
    }
}

impl<const KNOTS: usize> Track<KNOTS> {
    /// Whether its model may look for it in the row after the last one.
    pub(super) fn goes_on_in(&self, row: u16) -> bool {
        self.model.is_some() && row.abs_diff(self.line.last.row) == 1
    }

    /// Takes the edge's point in a row that shows it as the rows before did, alone between its neighbours. Else the row
    /// has to be looked at closely.
    #[inline(never)]
    pub(super) fn locate_steady<P: Pixels>(&mut self, row: &SeenRow<'_, P>, around: &Neighbours) -> bool {
        if !self.goes_on_in(row.at.row) || self.line.is_beside_texture {
            return false;
        }
        let expected = self.expected_next(row.at);
        let around = self.line.untracked.among(*around, expected.column_q16);
        let (Some(bytes), Some(model)) = (row.quick_bytes(), &mut self.model) else { return false };
        let Some(found) = model.locate_usual(bytes, expected, &around) else { return false };
        self.take_next(&found, expected.column_q16, row.at, row.limits);
        true
    }

    /// Takes the edge's point in the row after the last one, if its model finds it there between its neighbours. `None`
    /// where one of them is near and no edge for sure.
    pub(super) fn locate_between<P: Pixels>(
        &mut self,
        row: &SeenRow<'_, P>,
        around: &Neighbours,
        are_edges: [bool; 2],
    ) -> Option<bool> {
        let SeenRow { at, limits, .. } = row;
        let expected = self.expected_next(at);
        let Expectation { column_q16, gate_q16, .. } = expected;
        let model = self.model.as_mut()?;
        if !around.are_far_but_for(are_edges, model.far_q16(), column_q16) {
            return None;
        }
        if let Some(bytes) = row.quick_bytes().filter(|_| !self.line.is_beside_texture)
            && let Some(found) = model.locate_near(bytes, expected, &self.line.untracked.among(*around, column_q16))
        {
            self.take_next_apart(&found, column_q16, at, limits);
            return Some(true);
        }
        Some(self.locate(&Prediction { column_q16, gate_q16, coasting: false }, **at, row.pixels, *around, limits))
    }

    /// [`Self::take_next`] in code of its own: few rows come here.
    #[inline(never)]
    fn take_next_apart(&mut self, found: &UsualPoint, predicted_q16: i32, at: &RowTime, limits: &Limits) {
        self.take_next(found, predicted_q16, at, limits);
    }

    /// Takes what the next row shows as the rows before did.
    #[inline(always)]
    fn take_next(&mut self, found: &UsualPoint, predicted_q16: i32, at: &RowTime, limits: &Limits) {
        let UsualPoint { at: LocatedPoint { column_q16, sigma_q16, width_q8 }, overshoot } = *found;
        if let Some(overshoot) = overshoot {
            self.line.prominence.add_overshoot(overshoot);
        }
        // A row that disagrees with its line weighs less.
        let off_q16 = column_q16.abs_diff(predicted_q16);
        self.line.push_next(at.row, at.time_ns, column_q16, sigma_q16.max(off_q16 / 2), width_q8);
        self.unexpected_points = 0;
        let (off_q16, memory) = (column_q16 - predicted_q16, self.memory());
        self.filter.scatter(off_q16, memory);
        self.filter.follow_next(off_q16, predicted_q16, memory);
        if self.has_gate_to_renew() {
            self.renew_gate_in_time(limits);
        }
    }

    /// Where the next row should show it.
    fn expected_next(&self, at: &RowTime) -> Expectation {
        Expectation {
            column_q16: self.next_column_q16(),
            gate_q16: self.next_gate_q16(),
            looks_for_halo: at.looks_for_halo,
        }
    }

    /// Takes the edge's point in a row of pixels, if its model finds it there.
    #[inline(never)]
    pub(crate) fn locate<P: Pixels>(
        &mut self,
        prediction: &Prediction,
        at: RowTime,
        row: PixelRow<'_, P>,
        around: Neighbours,
        limits: &Limits,
    ) -> bool {
        let Some(model) = &mut self.model else { return false };
        let around = self.line.untracked.among(around, prediction.column_q16);
        let Some(found) = model.locate(row, prediction.column_q16, prediction.gate_q16, 0, around) else {
            return false;
        };
        if model.is_surely_beside_texture() && !self.line.is_beside_texture {
            // What holds from now on held for the rows before as well.
            self.line.is_beside_texture = true;
            self.line.raise_sigmas(self.stated_sigma_q16(0));
        }
        if at.looks_for_halo
            && let Some(overshoot) = self.model.as_ref().and_then(|model| model.overshoot(&row, &found))
        {
            self.line.prominence.add_overshoot(overshoot);
        }
        self.take_located(&found, prediction.column_q16, &at, limits)
    }

    /// Takes what its model has found.
    #[inline(never)]
    fn take_located(&mut self, found: &LocatedPoint, predicted_q16: i32, at: &RowTime, limits: &Limits) -> bool {
        self.unexpected_points = 0;
        // A row that disagrees with its line weighs less.
        let off_q16 = found.column_q16.abs_diff(predicted_q16);
        let point = EdgePoint {
            time_ns: at.time_ns,
            column_q16: found.column_q16,
            sigma_q16: self.stated_sigma_q16(found.sigma_q16.max(off_q16 / 2).min(EdgePoint::MAX_SIGMA_Q16)),
            row: at.row,
            width_q8: found.width_q8,
            polarity: self.line.last().polarity,
        };
        self.take(point, limits)
    }
}
