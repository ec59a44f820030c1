//! [`Tracker`]: from edge points, row by row, to lines.

use heapless::Vec;

use super::association::{Association, Outcome, Pair, Prediction};
use super::counters::Counters;
use super::demand::Demand;
use super::explained::Explained;
use super::jump::Jump;
use super::line::Line;
use super::track::{RowTime, State, Track};
use super::tuning::YOUNG_POINTS;
use crate::edge::{EdgeModel, EdgePoint, Neighbours, PixelRow, Polarity};
use crate::format::Pixels;
use crate::setup::{Limits, Readout};

/// The lines of a frame under way: at most `LINES` of `KNOTS` knots each.
///
/// The points of each row are associated with the lines' predicted columns: a point and a line of the same polarity that
/// are each other's nearest, within the gate, belong together. A point without a line starts a tentative one. Lines that
/// have missed too many rows end. A full table refuses new lines, counts them, and never loses a confirmed line.
///
/// *Cost*: per row an insertion sort of the lines, whose order hardly changes, and for each polarity one pass over points
/// and lines together.
#[derive(Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Tracker<const LINES: usize, const KNOTS: usize> {
    tracks: [Slot<KNOTS>; LINES],
    counters: Counters,
    /// Places of the lines under way, and of those that have ended and wait to be taken.
    under_way: Vec<u16, LINES>,
    ended: Vec<u16, LINES>,
    /// No place before this one is free.
    occupied: usize,
}

/// A place for a line. The tag is written out, and zero where the place is free, so that an empty table is all zero bits:
/// a `static` one then takes no flash.
#[derive(Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
enum Slot<const KNOTS: usize> {
    Free = 0,
    Taken(Track<KNOTS>) = 1,
}

impl<const KNOTS: usize> Slot<KNOTS> {
    const fn is_free(&self) -> bool {
        matches!(self, Self::Free)
    }

    const fn track(&self) -> Option<&Track<KNOTS>> {
        match self {
            Self::Free => None,
            Self::Taken(track) => Some(track),
        }
    }

    const fn track_mut(&mut self) -> Option<&mut Track<KNOTS>> {
        match self {
            Self::Free => None,
            Self::Taken(track) => Some(track),
        }
    }

    fn take(&mut self) -> Option<Track<KNOTS>> {
        match core::mem::replace(self, Self::Free) {
            Self::Free => None,
            Self::Taken(track) => Some(track),
        }
    }
}

/// A line under way, as predicted for a row.
struct Candidate {
    prediction: Prediction,
    slot: usize,
    /// Or hidden.
    is_confirmed: bool,
    polarity: Polarity,
    /// Two edges nearer than this cannot be told apart, because of their noise or their blur.
    blur_q16: i64,
}

impl Candidate {
    /// Whether the other one is another edge. A line of the same polarity within the blur is a fragment of the same edge.
    fn is_ended_by(&self, other: &Self) -> bool {
        let apart_q16 = (other.prediction.column_q16 - self.prediction.column_q16).abs();
        other.polarity != self.polarity || apart_q16 > 2 * self.blur_q16
    }
}

impl<const LINES: usize, const KNOTS: usize> Tracker<LINES, KNOTS> {
    /// An empty tracker.
    #[must_use]
    pub(crate) const fn new() -> Self {
        const { assert!(LINES > 0 && LINES < u16::MAX as usize, "1 to 65534 lines") };
        let tracks = [const { Slot::Free }; LINES];
        Self { tracks, counters: Counters::ZERO, under_way: Vec::new(), ended: Vec::new(), occupied: 0 }
    }

    /// Takes all points of one row, sorted by column. Rows come in the order of readout. Rows that were not looked at may
    /// be left out; rows without points should be given, since lines end by missing rows.
    ///
    /// Returns a row at which all lines jump, if that is seen now.
    #[must_use]
    pub(crate) fn row(&mut self, limits: &Limits, columns: u16, row: u16, points: &[EdgePoint]) -> Option<u16> {
        self.occupied = 0;
        if !points.is_empty() {
            let mut predictions = Vec::new();
            self.predict(limits, row, &mut predictions);
            for polarity in [Polarity::Rising, Polarity::Falling, Polarity::Unknown] {
                self.match_points(
                    limits,
                    &predictions,
                    points.iter().filter(|point| point.polarity == polarity),
                    polarity,
                );
            }
        }
        self.count_missed(limits, row);
        let jump = self.jump(columns, row);
        self.stitch_all(limits, row);
        jump
    }

    /// The row at which all lines jump, where one of those that began there is old enough on `row` to tell.
    #[inline(never)] // its lists take room on the stack only while it is asked
    fn jump(&self, columns: u16, row: u16) -> Option<u16> {
        let is_asked = |track: &&Track<KNOTS>| {
            track.state == State::Confirmed && track.line.points() == YOUNG_POINTS && track.line.last().row == row
        };
        let begun_in = self.tracks_under_way().find(is_asked)?.line.first().row;
        let mut jump: Jump<LINES> = Jump::new(columns);
        self.tracks_under_way().for_each(|track| jump.add(track, row, row.abs_diff(begun_in)));
        jump.is_common().then_some(begun_in)
    }

    fn tracks_under_way(&self) -> impl Iterator<Item = &Track<KNOTS>> {
        self.under_way.iter().filter_map(|place| self.tracks.get(usize::from(*place))?.track())
    }

    /// Locates the confirmed lines in a row of pixels where they are predicted, and adds what they explain. To be called before
    /// the row is scanned.
    pub(crate) fn locate<P: Pixels>(
        &mut self,
        limits: &Limits,
        at: RowTime,
        pixels: PixelRow<'_, P>,
        explained: &mut Explained<LINES>,
    ) {
        let mut located: Vec<EdgePoint, LINES> = Vec::new();
        let mut all: Vec<Candidate, LINES> = Vec::new();
        self.predict(limits, at.row, &mut all);
        // Tentative lines are noise as often as not: they must not narrow the window of a confirmed one.
        let candidates = || all.iter().filter(|candidate| candidate.is_confirmed);
        for (index, candidate) in candidates().enumerate() {
            let slot = self.tracks.get_mut(candidate.slot).filter(|_| !candidate.prediction.coasting);
            let Some(track) = slot.and_then(Slot::track_mut) else { continue };
            let ends = |other: &&Candidate| candidate.is_ended_by(other);
            let column = |other: Option<&Candidate>| other.map(|other| other.prediction.column_q16);
            let around = Neighbours {
                left_q16: column(candidates().take(index).filter(ends).last()).unwrap_or(Neighbours::NONE.left_q16),
                right_q16: column(candidates().skip(index + 1).find(ends)).unwrap_or(Neighbours::NONE.right_q16),
            };
            if let Some(point) = track.locate(&candidate.prediction, at, pixels, around)
                && track.take(point, limits)
            {
                // There is room: one per line at most.
                let _ = located.push(point);
            }
        }
        // Also hidden lines, which another one may continue.
        let tracks = || self.under_way.iter().filter_map(|place| self.tracks.get(usize::from(*place))?.track());
        let others = || tracks().filter(|track| track.line.last().row != at.row);
        for point in &located {
            explained.add(point, others().map(|other| other.predict(at.row, limits).column_q16));
        }
        self.count_points(located.len() as u32);
    }

    /// Removes the scanned points that located lines explain. To be called before [`Tracker::row`] takes the others.
    pub(crate) fn remove_explained<const POINTS: usize>(
        &mut self,
        explained: &mut Explained<LINES>,
        points: &mut Vec<EdgePoint, POINTS>,
    ) {
        let strays = explained.remove_from(points);
        self.count_points(strays);
        self.count_stray(strays);
    }

    /// Restricts what is asked for where no place is free: to be called before the points that are left are refined.
    pub(crate) fn demand(&mut self, limits: &Limits, row: u16, demand: &mut Demand<LINES>) {
        if self.under_way.len() + self.ended.len() >= LINES {
            let mut candidates = Vec::new();
            self.predict(limits, row, &mut candidates);
            demand.restrict(candidates.iter().map(|candidate| (candidate.prediction, candidate.polarity)));
        }
    }

    /// Gives newly confirmed lines a model of their edge, from the row in which they were last seen.
    pub(crate) fn learn<P: Pixels>(&mut self, row: u16, pixels: PixelRow<'_, P>, noise_q8: u32) {
        for place in &self.under_way {
            let track = |place: &u16| self.tracks.get(usize::from(*place)).and_then(Slot::track);
            let is_new = |track: &&Track<KNOTS>| track.state == State::Confirmed && track.model.is_none();
            let Some(point) = track(place).filter(is_new).map(|track| *track.line.last()) else { continue };
            if point.row == row {
                let others = self.under_way.iter().filter_map(track).map(|track| track.line.last());
                let around = Neighbours::among(others.filter(|other| other.row == row), &point);
                let model = EdgeModel::settled(pixels, &point, around, noise_q8);
                if let Some(track) = self.tracks.get_mut(usize::from(*place)).and_then(Slot::track_mut) {
                    track.model = model;
                    track.line.mark_as_of_pixels();
                }
            }
        }
    }

    /// Looks at what is around the confirmed lines that this row has shown.
    pub(crate) fn look_around<P: Pixels>(&mut self, row: u16, pixels: PixelRow<'_, P>) {
        for place in &self.under_way {
            let track = self.tracks.get_mut(usize::from(*place)).and_then(Slot::track_mut);
            let is_seen = |track: &&mut Track<KNOTS>| track.state == State::Confirmed && track.line.last().row == row;
            if let Some(track) = track.filter(is_seen) {
                track.look_around(pixels);
            }
        }
    }

    /// Takes the times of all lines of this frame from the readout.
    pub(crate) fn retime(&mut self, readout: &Readout) {
        for track in self.tracks.iter_mut().filter_map(Slot::track_mut) {
            track.line.retime(readout);
        }
    }

    /// Forgets all lines under way because the frame is torn. Their points are stray.
    pub(crate) fn abandon(&mut self) {
        while let Some(place) = self.under_way.pop() {
            self.forget(place);
        }
    }

    /// Ends the confirmed lines and forgets the tentative ones.
    pub(crate) fn end_frame(&mut self) {
        while let Some(place) = self.under_way.pop() {
            self.finish(place);
        }
    }

    /// A line that has ended, in no particular order. Take them after every row, or their places stay occupied.
    pub(crate) fn next_line(&mut self) -> Option<Line<KNOTS>> {
        let place = self.ended.pop()?;
        self.tracks.get_mut(usize::from(place))?.take().map(|track| track.line)
    }

    /// Places of the lines that have ended; [`Tracker::next_line`] takes the last one.
    pub(crate) fn ended(&self) -> impl DoubleEndedIterator<Item = usize> + Clone {
        self.ended.iter().map(|place| usize::from(*place))
    }

    pub(crate) fn line_at(&self, place: usize) -> Option<&Line<KNOTS>> {
        self.tracks.get(place)?.track().map(|track| &track.line)
    }

    /// What came in and what was lost since the tracker was made.
    #[must_use]
    pub(crate) const fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Counts points that were taken.
    pub(crate) fn count_points(&mut self, points: u32) {
        self.counters.points = self.counters.points.saturating_add(points);
    }

    /// Counts points that belong to no line.
    pub(crate) fn count_stray(&mut self, points: u32) {
        self.counters.stray_points = self.counters.stray_points.saturating_add(points);
    }

    /// Counts a point for which there was no room.
    pub(crate) fn count_dropped_point(&mut self) {
        self.counters.dropped_points = self.counters.dropped_points.saturating_add(1);
    }

    /// Whether the table has room for a continuation of each hidden line, which starts as a line of its own and is then
    /// stitched. Without room, hidden lines take part in the association themselves.
    fn has_room_to_stitch(&self) -> bool {
        let hidden = self.tracks_under_way().filter(|track| track.state == State::Hidden).count();
        self.under_way.len() + self.ended.len() + hidden <= LINES
    }

    /// Predictions of the lines under way that have no point on this row yet, from left to right. Hidden lines are left out:
    /// they wait to be stitched.
    fn predict(&mut self, limits: &Limits, row: u16, predictions: &mut Vec<Candidate, LINES>) {
        let room = self.has_room_to_stitch();
        for place in &self.under_way {
            let slot = usize::from(*place);
            let track = self.tracks.get(slot).and_then(Slot::track);
            // There is room: one per slot at most.
            if let Some(track) =
                track.filter(|track| track.line.last().row != row && !(room && track.state == State::Hidden))
            {
                let (is_confirmed, polarity) = (track.state != State::Tentative, track.line.first().polarity);
                let (prediction, blur_q16) = (track.predict(row, limits), track.blur_q16());
                let at = predictions.partition_point(|other| other.prediction.column_q16 <= prediction.column_q16);
                let _ = predictions.insert(at, Candidate { prediction, slot, is_confirmed, polarity, blur_q16 });
            }
        }
        // Lines hardly ever change their order: on the next row they are almost sorted.
        let order = predictions.iter().map(|candidate| candidate.slot as u16);
        if predictions.len() == self.under_way.len() {
            self.under_way.iter_mut().zip(order).for_each(|(place, slot)| *place = slot);
        }
        let mut rest: &mut [Candidate] = predictions;
        while let Some((first, others)) = rest.split_first_mut() {
            if let Some(second) = others
                .iter_mut()
                .find(|other| other.is_confirmed == first.is_confirmed && other.polarity == first.polarity)
            {
                let near_q16 = first.blur_q16.max(second.blur_q16);
                let apart_q16 = second.prediction.column_q16 - first.prediction.column_q16;
                if first.is_confirmed && apart_q16 < near_q16 {
                    first.prediction.coasting = true;
                    second.prediction.coasting = true;
                }
            }
            rest = others;
        }
    }

    /// Confirmed lines are associated first and tentative ones with the points that are left, so that clutter beside a
    /// confirmed line does not take its points. A point without a line starts one.
    fn match_points<'e>(
        &mut self,
        limits: &Limits,
        candidates: &[Candidate],
        points: impl Iterator<Item = &'e EdgePoint>,
        polarity: Polarity,
    ) {
        let lines = |is_confirmed| {
            let among =
                move |candidate: &&Candidate| candidate.is_confirmed == is_confirmed && candidate.polarity == polarity;
            candidates.iter().filter(among).map(|candidate| (candidate.prediction, candidate.slot))
        };
        let mut confirmed = Association::over(lines(true));
        let mut tentative = Association::over(lines(false));
        let last = |settled, tracker: &mut Self| match settled {
            Outcome::Matched(pair) => tracker.join(&pair, limits),
            Outcome::Unmatched(point) => tracker.begin(point),
        };
        let mut first = |settled, tracker: &mut Self| match settled {
            Outcome::Matched(pair) => tracker.join(&pair, limits),
            Outcome::Unmatched(point) => tentative.point(point, &mut |settled| last(settled, tracker)),
        };
        for point in points {
            confirmed.point(*point, &mut |settled| first(settled, self));
        }
        confirmed.finish(&mut |settled| first(settled, self));
        tentative.finish(&mut |settled| last(settled, self));
    }

    fn join(&mut self, pair: &Pair, limits: &Limits) {
        if pair.coasting {
            self.count_stray(1);
            return;
        }
        let track = self.tracks.get_mut(pair.slot).and_then(Slot::track_mut);
        if !track.is_some_and(|track| track.take_scanned(pair.point, limits)) {
            self.begin(pair.point);
        }
    }

    /// Stitches confirmed lines that have just started to hidden ones that they continue.
    fn stitch_all(&mut self, limits: &Limits, row: u16) {
        let mut index = 0;
        while let Some(place) = self.under_way.get(index).copied() {
            if self.stitch(limits, row, place).is_some() && index < self.under_way.len() {
                self.leave_out(index);
            } else {
                index += 1;
            }
        }
    }

    fn stitch(&mut self, limits: &Limits, row: u16, place: u16) -> Option<()> {
        let slot = usize::from(place);
        let young =
            self.tracks.get(slot)?.track().filter(|young| young.is_stitchable() && young.line.last().row == row)?;
        let others = self.under_way.iter().filter_map(|other| {
            let older = self.tracks.get(usize::from(*other))?.track()?;
            Some((older.stitch_distance(young, limits)?, *other))
        });
        let (_, nearest) = others.min()?;
        let young = self.tracks.get_mut(slot)?.take()?;
        let joined = self.tracks.get_mut(usize::from(nearest))?.track_mut()?.append_stitched(&young);
        if !joined {
            *self.tracks.get_mut(slot)? = Slot::Taken(young);
            return None;
        }
        Some(())
    }

    /// Starts a tentative line, if there is room.
    fn begin(&mut self, point: EdgePoint) {
        let free = self.tracks.iter_mut().enumerate().skip(self.occupied).find(|(_, slot)| slot.is_free());
        match free {
            Some((slot, free)) => {
                *free = Slot::Taken(Track::new(point));
                self.occupied = slot + 1;
                // There is room: one place for each slot.
                let _ = self.under_way.push(slot as u16);
            }
            None => {
                self.occupied = LINES;
                self.counters.dropped_lines = self.counters.dropped_lines.saturating_add(1);
                self.count_dropped_point();
            }
        }
    }

    /// Takes a place out of those under way; the last one takes its room. `swap_remove` could panic where code is small.
    fn leave_out(&mut self, index: usize) {
        let last = self.under_way.pop();
        if let (Some(room), Some(last)) = (self.under_way.get_mut(index), last) {
            *room = last;
        }
    }

    fn count_missed(&mut self, limits: &Limits, row: u16) {
        let mut index = 0;
        while let Some(place) = self.under_way.get(index).copied() {
            let track = self.tracks.get_mut(usize::from(place)).and_then(Slot::track_mut);
            if track.is_some_and(|track| track.has_missed_too_many(limits, row)) {
                self.leave_out(index);
                self.finish(place);
            } else {
                index += 1;
            }
        }
    }

    /// Ends a confirmed line and forgets a tentative one.
    fn finish(&mut self, place: u16) {
        let track = self.tracks.get_mut(usize::from(place)).and_then(Slot::track_mut);
        if let Some(track) = track.filter(|track| track.state != State::Tentative) {
            track.state = State::Ended;
            // There is room: one place for each slot.
            let _ = self.ended.push(place);
        } else {
            self.forget(place);
        }
    }

    fn forget(&mut self, place: u16) {
        let track = self.tracks.get_mut(usize::from(place)).and_then(Slot::take);
        self.count_stray(track.map_or(0, |track| u32::from(track.line.points())));
    }
}
