//! Where a row of pixels shows a line that has a model of its edge.

use super::association::Prediction;
use super::track::{State, Track};
use crate::edge::{EdgePoint, Expectation, LocatedPoint, Neighbours, PixelRow, Polarity, UsualPoint};
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

/// What is beside a line.
#[derive(Clone, Copy)]
pub(super) struct Beside {
    /// Where the row should show it.
    column_q16: i32,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Nothing,
    Edge(Polarity),
    /// A line that may be none, or a fragment of an edge.
    Doubtful,
}

impl Beside {
    /// On the left of all lines, and on the right.
    pub(super) const BEGINNING: Self = Self { column_q16: Neighbours::NONE.left_q16, kind: Kind::Nothing };
    pub(super) const END: Self = Self { column_q16: Neighbours::NONE.right_q16, kind: Kind::Nothing };

    #[inline(always)]
    pub(super) fn of<const KNOTS: usize>(track: &Track<KNOTS>) -> Self {
        let kind = if track.state == State::Confirmed { Kind::Edge(track.line.last.polarity) } else { Kind::Doubtful };
        Self { column_q16: track.next_column_q16(), kind }
    }

    fn columns([left, right]: &[Self; 2]) -> Neighbours {
        Neighbours { left_q16: left.column_q16, right_q16: right.column_q16 }
    }

    /// As what is beside the next line, where others before may lie farther to the right.
    #[inline(always)]
    pub(super) fn behind(self, others: &Self) -> Self {
        Self { column_q16: self.column_q16.max(others.column_q16), ..self }
    }

    /// Whether it is another edge than one of this polarity: one of the same may be a fragment of the same edge.
    fn is_edge_beside(self, polarity: Polarity) -> bool {
        match self.kind {
            Kind::Nothing => true,
            Kind::Edge(other) => other != polarity,
            Kind::Doubtful => false,
        }
    }
}

impl<const KNOTS: usize> Track<KNOTS> {
    /// Whether its model may look for it in the row after the last one.
    fn goes_on_in(&self, row: u16) -> bool {
        self.model.is_some() && row.abs_diff(self.line.last.row) == 1
    }

    /// Takes the edge's point in the row after the last one, if that shows it as the rows before did, alone between the
    /// lines beside it.
    #[inline(never)]
    pub(super) fn locate_steady<P: Pixels>(&mut self, row: &SeenRow<'_, P>, beside: &[Beside; 2]) -> bool {
        if !self.goes_on_in(row.at.row) || self.line.is_beside_texture {
            return false;
        }
        let expected = self.expected_next(row.at);
        let around = self.line.untracked.among(Beside::columns(beside), expected.column_q16);
        let (Some(bytes), Some(model)) = (row.quick_bytes(), &mut self.model) else { return false };
        let Some(found) = model.locate_usual(bytes, expected, &around) else { return false };
        self.take_next(&found, expected.column_q16, row.at, row.limits);
        true
    }

    /// Takes it where neighbours cut off its plateaus, or where the row may show anything else than the rows before. `None`
    /// where it has to be weighed against others: where one of them is near and not surely another edge.
    #[inline(never)] // few rows come here
    pub(super) fn locate_between<P: Pixels>(&mut self, row: &SeenRow<'_, P>, beside: &[Beside; 2]) -> Option<bool> {
        if !self.goes_on_in(row.at.row) {
            return None;
        }
        let expected = self.expected_next(row.at);
        let Expectation { column_q16, gate_q16, .. } = expected;
        let (around, polarity) = (Beside::columns(beside), self.line.last.polarity);
        let model = self.model.as_mut()?;
        if !around.are_far_but_for(beside.map(|line| line.is_edge_beside(polarity)), model.far_q16(), column_q16) {
            return None;
        }
        if let Some(bytes) = row.quick_bytes().filter(|_| !self.line.is_beside_texture)
            && let Some(found) = model.locate_near(bytes, expected, &self.line.untracked.among(around, column_q16))
        {
            self.take_next(&found, column_q16, row.at, row.limits);
            return Some(true);
        }
        let prediction = Prediction { column_q16, gate_q16, coasting: false };
        Some(self.locate(&prediction, *row.at, row.pixels, around, row.limits))
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
