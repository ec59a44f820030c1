//! [`Tracker`]: from edge points, row by row, to lines.

use core::marker::PhantomData;

use heapless::Vec;

use super::candidates::{Candidate, Candidates, Role};
use super::counters::Counters;
use super::explained::Explained;
use super::flanks::{Flanks, add_flank, flank, is_alone};
use super::jump::Jump;
use super::learning::look_at;
use super::line::Line;
use super::locating::RowTime;
use super::matching::match_points;
use super::pieces::Pieces;
use super::refinement::Refinement;
use super::repair::{Repair, Repaired};
use super::steady::{Located, Missed, locate_steady, take_steady};
use super::steps::Steps;
use super::stitch::stitch_all;
use super::table::Table;
use super::track::{State, Track};
use super::tuning::{SUCCESSOR_DELAY_ROWS, YOUNG_POINTS};
use super::turns::has_turn;
use crate::edge::{EdgePoint, PixelRow};
use crate::format::Pixels;
use crate::setup::{Limits, Readout};

/// The lines of a frame under way: at most `LINES` of `KNOTS` knots each.
///
/// The points of each row are associated with the lines' predicted columns: a point and a line of the same polarity
/// that are each other's nearest, within the gate, belong together. A point without a line starts a tentative one.
/// Lines that have missed too many rows end. A full table refuses new lines, counts them, and never loses a confirmed
/// line.
///
/// *Cost*: per row an insertion sort of the lines, whose order hardly changes, and for each polarity one pass over
/// points and lines together.
#[derive(Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Tracker<const LINES: usize, const KNOTS: usize, R = Repaired> {
    table: Table<LINES, KNOTS>,
    counters: Counters,
    steps: Steps,
    pieces: Pieces,
    repair: PhantomData<R>,
}

impl<const LINES: usize, const KNOTS: usize, R: Repair> Tracker<LINES, KNOTS, R> {
    /// An empty tracker.
    #[must_use]
    pub(crate) const fn new() -> Self {
        Self {
            table: Table::new(),
            counters: Counters::ZERO,
            steps: Steps::NONE,
            pieces: Pieces::NONE,
            repair: PhantomData,
        }
    }

    /// Takes the light of the next row of pixels, which have so much noise.
    pub(crate) fn see_light(&mut self, row: u16, pixels: &impl Pixels, noise_q8: impl FnOnce() -> u32) {
        if R::REPAIRS {
            self.steps.see(row, pixels, noise_q8);
        }
    }

    /// Takes all points of one row, sorted by column. Rows come in the order of readout. Rows that were not looked at
    /// may be left out; rows without points should be given, since lines end by missing rows.
    ///
    /// Returns a row at which all lines jump, if that is seen now.
    #[must_use]
    pub(crate) fn row(&mut self, limits: &Limits, columns: u16, row: u16, points: &[EdgePoint]) -> Option<u16> {
        // The quick way to the same lines, which small programs do without.
        if R::REPAIRS
            && let Some(has_young) = take_steady(&mut self.table, limits, row, points)
        {
            return self.stitch(limits, columns, row, has_young);
        }
        let mut candidates = Candidates::new();
        if !points.is_empty() {
            self.expect(limits, row, &mut candidates);
        }
        self.take(limits, columns, row, &candidates, points, &|point, _| *point)
    }

    /// Likewise for the points of a row of pixels, of which the lines that [`Tracker::locate`] has not seen may take
    /// some, as `refine` states them: with their pixels looked at where it is told so.
    #[must_use]
    pub(crate) fn take(
        &mut self,
        limits: &Limits,
        columns: u16,
        row: u16,
        candidates: &Candidates<LINES>,
        points: &[EdgePoint],
        refine: &dyn Fn(&EdgePoint, bool) -> EdgePoint,
    ) -> Option<u16> {
        self.table.look_for_places();
        if !points.is_empty() {
            let mut refinement = Refinement::new(refine, row, points.len(), candidates);
            match_points(&mut self.table, &mut self.counters, limits, candidates, points, &mut refinement);
        }
        self.finish_row(limits, columns, row)
    }

    /// Ends lines and stitches them after they have taken the points of a row; a row at which all of them jump.
    #[inline(never)] // what it needs is not on the stack while points are matched
    fn finish_row(&mut self, limits: &Limits, columns: u16, row: u16) -> Option<u16> {
        let has_young = self.end_lines(limits, row);
        self.stitch(limits, columns, row, has_young)
    }

    /// Stitches lines where this row has shown a young one; a row at which all of them jump.
    fn stitch(&mut self, limits: &Limits, columns: u16, row: u16, has_young: bool) -> Option<u16> {
        if R::REPAIRS {
            self.steps.mark_cut(&mut self.table, row);
        }
        if !(R::REPAIRS && has_young) {
            return None;
        }
        self.steps.count(self.table.tracks_under_way(), row);
        let jump = self.jump(columns, row).or_else(|| self.steps.are_of_pulses().then_some(row));
        stitch_all(&mut self.table, limits, row);
        jump
    }

    /// The row at which all lines jump, where one of those that began there is old enough on `row` to tell.
    #[inline(never)] // its lists take room on the stack only while it is asked
    fn jump(&self, columns: u16, row: u16) -> Option<u16> {
        let is_asked = |track: &&Track<KNOTS>| {
            track.state == State::Confirmed && track.line.points() == YOUNG_POINTS && track.line.last().row == row
        };
        let begun_in = self.table.tracks_under_way().find(is_asked)?.line.first().row;
        let mut jump: Jump<LINES> = Jump::new(columns);
        self.table.tracks_under_way().for_each(|track| jump.add(track, row, row.abs_diff(begun_in)));
        jump.is_common().then_some(begun_in)
    }

    /// Locates the confirmed lines in a row of pixels where they are predicted, and adds what the scan may leave out,
    /// and the lines that the row has not shown yet. To be called before the row is scanned. Whether the row shows each
    /// line as the rows before did, and none is young: without a point nothing begins, ends or goes on then.
    pub(crate) fn locate<P: Pixels>(
        &mut self,
        limits: &Limits,
        at: RowTime,
        pixels: PixelRow<'_, P>,
        candidates: &mut Candidates<LINES>,
    ) -> bool {
        let mut missed = Missed::new();
        let Located { lines, has_young } = locate_steady(&mut self.table, limits, &at, &pixels, &mut missed);
        self.counters.count_points(lines as u32);
        if lines == self.table.under_way().len() {
            return !has_young;
        }
        self.expect(limits, at.row, candidates);
        let mut located = 0;
        for index in 0..candidates.len() {
            let Some(Candidate { prediction, place, role, .. }) = candidates.get(index) else { continue };
            let is_sought = *role == Role::Confirmed && !prediction.coasting && !missed.contains(place);
            if is_sought
                && let Some(track) = self.table.track_mut(*place).filter(|track| track.model.is_some())
                && track.locate(prediction, at, pixels, candidates.around(index), limits)
            {
                candidates.see(index);
                located += 1;
            }
        }
        self.counters.count_points(located);
        candidates.keep_unseen();
        false
    }

    /// Adds the flanks of the lines that a row has shown so far and that stand alone: others may lie near them, also hidden
    /// ones, which another one may continue.
    pub(crate) fn add_flanks(&self, row: u16, candidates: &Candidates<LINES>, flanks: &mut Flanks<LINES>) {
        let others_q16 = candidates.iter().map(|candidate| candidate.prediction.column_q16);
        for last in self.table.tracks_under_way().map(|track| track.line.last()).filter(|last| last.row == row) {
            let flank = flank(last);
            if is_alone(&flank, others_q16.clone()) {
                add_flank(flanks, flank);
            }
        }
    }

    /// Removes the scanned points of a row that located lines explain. To be called before [`Tracker::row`] takes the
    /// others.
    pub(crate) fn remove_explained<const POINTS: usize>(&mut self, row: u16, points: &mut Vec<EdgePoint, POINTS>) {
        if points.is_empty() {
            return;
        }
        let last = self.table.tracks_under_way().map(|track| track.line.last());
        let strays = Explained::<LINES>::by(last.filter(|point| point.row == row)).remove_from(points);
        self.counters.count_points(strays);
        self.counters.count_stray(strays);
    }

    /// Whether no place is free for another line.
    pub(crate) fn is_full(&self) -> bool {
        self.table.is_full()
    }

    /// Lets the lines note what the pixels of their row show of them, and of what is beside them.
    pub(crate) fn look_at<P: Pixels>(
        &mut self,
        row: u16,
        pixels: PixelRow<'_, P>,
        noise_q8: u32,
        points: &[EdgePoint],
    ) {
        look_at(&mut self.table, row, pixels, noise_q8, points);
    }

    #[cfg(test)]
    pub(super) const fn table(&self) -> &Table<LINES, KNOTS> {
        &self.table
    }

    /// How many lines have a model.
    #[cfg(test)]
    pub(crate) fn models(&self) -> usize {
        self.table.tracks_under_way().filter(|track| track.model.is_some()).count()
    }

    /// Takes the times of all lines of this frame from the readout.
    #[inline(never)] // seldom
    pub(crate) fn retime(&mut self, readout: &Readout) {
        self.table.each_of_frame(|track| track.line.retime(readout));
    }

    /// Forgets all lines under way because the frame is torn. Their points are stray.
    pub(crate) fn abandon(&mut self) {
        while let Some(place) = self.table.leave_out_last() {
            let strays = self.table.forget(place);
            self.counters.count_stray(strays);
        }
    }

    /// Ends the confirmed lines and forgets the tentative ones.
    pub(crate) fn end_frame(&mut self) {
        let may_be_border = self.steps.may_be_border();
        self.steps = Steps::NONE;
        while let Some(place) = self.table.leave_out_last() {
            if may_be_border && let Some(track) = self.table.track_mut(place) {
                track.line.left_by_light = None;
            }
            self.finish(place);
        }
        self.pieces = Pieces::NONE;
        self.split_ended();
        self.table.end_frame();
    }

    /// Splits the lines that have ended into their straight parts: before they are asked for, since a row has no time for
    /// it.
    pub(crate) fn split_ended(&mut self) {
        if R::REPAIRS {
            let strays = self.table.split_ended();
            self.counters.count_stray(strays);
        }
    }

    /// A line that has ended, in no particular order. Take them after every row, or their places stay occupied.
    pub(crate) fn next_line(&mut self) -> Option<Line<KNOTS>> {
        self.table.next_line()
    }

    /// Places of the lines that have ended; [`Tracker::next_line`] takes the last one.
    pub(crate) fn ended(&self) -> impl DoubleEndedIterator<Item = usize> + Clone {
        self.table.ended()
    }

    pub(crate) fn line_at(&self, place: usize) -> Option<&Line<KNOTS>> {
        self.table.track(u16::try_from(place).ok()?).map(|track| &track.line)
    }

    /// What came in and what was lost since the tracker was made.
    #[must_use]
    pub(crate) const fn counters(&self) -> &Counters {
        &self.counters
    }

    pub(crate) const fn counters_mut(&mut self) -> &mut Counters {
        &mut self.counters
    }

    /// Adds the lines under way, also those that the row has shown: they are neighbours of the others. Where there is no
    /// room to stitch, hidden lines take part in the association themselves.
    pub(super) fn expect(&mut self, limits: &Limits, row: u16, candidates: &mut Candidates<LINES>) {
        let (has_room, mut has_moved) = (self.table.has_room_to_stitch(), false);
        for place in self.table.under_way() {
            if let Some(track) = self.table.track(*place) {
                let role = match track.state {
                    _ if track.line.last().row == row => Role::Seen,
                    State::Tentative => Role::Tentative,
                    State::Hidden if has_room || !has_turn(*place, row) => Role::Waiting,
                    _ => Role::Confirmed,
                };
                let prediction = match role {
                    Role::Waiting | Role::Seen => track.column_only(row),
                    _ => track.predict(row, limits),
                };
                has_moved |= candidates.add(Candidate {
                    prediction,
                    blur_q16: track.blur_q16(),
                    place: *place,
                    polarity: track.line.last().polarity,
                    role,
                });
            }
        }
        candidates.coast_beside_each_other();
        // On the next row they are sorted.
        if has_moved && candidates.len() == self.table.under_way().len() {
            self.table.set_order(candidates.iter().map(|candidate| candidate.place));
        }
    }

    /// Whether a row shows no line because the light has gone: confirmed ones wait for it, however long it takes.
    fn is_dark(&self, row: u16) -> bool {
        self.steps.is_dark() && self.table.tracks_under_way().all(|track| track.line.last().row != row)
    }

    /// Ends a line that has been left out of those under way.
    fn finish(&mut self, place: u16) {
        if R::REPAIRS
            && let Some(track) = self.table.track_mut(place)
        {
            track.line.asides = self.pieces.agreeing(track.line.asides);
        }
        let strays = self.table.finish(place);
        self.counters.count_stray(strays);
    }

    /// Ends lines that have missed too many rows. Whether this row has shown a young line, which may go on where others
    /// broke off.
    fn end_lines(&mut self, limits: &Limits, row: u16) -> bool {
        let (mut index, mut has_young) = (0, false);
        let is_dark = R::REPAIRS && self.is_dark(row);
        while let Some(place) = self.table.under_way().get(index).copied() {
            if let Some(track) = self.table.track_mut(place) {
                if track.line.last().row == row {
                    has_young |= track.is_young();
                } else if !(is_dark && track.state != State::Tentative) && track.misses_row(limits) {
                    self.table.leave_out(index);
                    self.finish(place);
                    continue;
                } else if R::REPAIRS && track.missed_rows == SUCCESSOR_DELAY_ROWS {
                    self.pieces.take(&mut self.table, place);
                }
            }
            index += 1;
        }
        has_young
    }
}
