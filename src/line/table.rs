//! [`Table`]: the places for lines, and which of them are taken.

use heapless::Vec;

use super::line::Line;
use super::split::Cut;
use super::track::{State, Track};
use super::tuning::LEAST_PART_POINTS;
use crate::edge::EdgePoint;
use crate::setup::Limits;

/// At most `LINES` lines of `KNOTS` knots each: those under way, and those that have ended and wait to be taken.
#[derive(Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Table<const LINES: usize, const KNOTS: usize> {
    slots: [Slot<KNOTS>; LINES],
    /// Places of the lines under way, about from left to right, and of those that have ended.
    under_way: Vec<u16, LINES>,
    ended: Vec<u16, LINES, u16>,
    /// So many of the latter are split into their straight parts.
    split: u16,
    /// So many of them are of frames before.
    earlier: u16,
    /// No place before this one is free.
    occupied: usize,
}

/// A place for a line. The tag is written out, and zero where the place is free, so that an empty table is all zero
/// bits: a `static` one then takes no flash.
#[derive(Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
enum Slot<const KNOTS: usize> {
    Free = 0,
    Taken(Track<KNOTS>) = 1,
}

impl<const KNOTS: usize> Slot<KNOTS> {
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
}

/// The lines in a table, beside its lists of places.
pub(super) struct Tracks<'t, const KNOTS: usize>(&'t mut [Slot<KNOTS>]);

impl<const KNOTS: usize> Tracks<'_, KNOTS> {
    #[inline(always)]
    pub(super) fn get(&self, place: u16) -> Option<&Track<KNOTS>> {
        self.0.get(usize::from(place))?.track()
    }

    #[inline(always)]
    pub(super) fn get_mut(&mut self, place: u16) -> Option<&mut Track<KNOTS>> {
        self.0.get_mut(usize::from(place))?.track_mut()
    }
}

impl<const LINES: usize, const KNOTS: usize> Table<LINES, KNOTS> {
    pub(super) const fn new() -> Self {
        const { assert!(LINES > 0 && LINES < u16::MAX as usize, "1 to 65534 lines") };
        Self {
            slots: [const { Slot::Free }; LINES],
            under_way: Vec::new(),
            ended: Vec::new(),
            split: 0,
            earlier: 0,
            occupied: 0,
        }
    }

    pub(super) fn track(&self, place: u16) -> Option<&Track<KNOTS>> {
        self.slots.get(usize::from(place))?.track()
    }

    pub(super) fn track_mut(&mut self, place: u16) -> Option<&mut Track<KNOTS>> {
        self.slots.get_mut(usize::from(place))?.track_mut()
    }

    /// The places of the lines under way, and the lines in the table.
    pub(super) fn places_and_tracks(&mut self) -> (&[u16], Tracks<'_, KNOTS>) {
        (&self.under_way, Tracks(&mut self.slots))
    }

    /// Changes each line of the frame under way, also those that have ended.
    pub(super) fn each_of_frame(&mut self, change: impl Fn(&mut Track<KNOTS>)) {
        let ended = self.ended.iter().skip(self.earlier.into());
        for place in self.under_way.iter().chain(ended) {
            if let Some(track) = self.slots.get_mut(usize::from(*place)).and_then(Slot::track_mut) {
                change(track);
            }
        }
    }

    /// Lines that come from now on are of another frame.
    pub(super) fn end_frame(&mut self) {
        self.earlier = self.ended.len() as u16;
    }

    /// The places of the lines under way.
    pub(super) fn under_way(&self) -> &[u16] {
        &self.under_way
    }

    /// The lines under way.
    pub(super) fn tracks_under_way(&self) -> impl Iterator<Item = &Track<KNOTS>> + Clone {
        self.under_way.iter().filter_map(|place| self.track(*place))
    }

    /// Puts the lines under way into another order.
    pub(super) fn set_order(&mut self, places: impl Iterator<Item = u16>) {
        self.under_way.iter_mut().zip(places).for_each(|(place, other)| *place = other);
    }

    /// Whether no place is free.
    pub(super) fn is_full(&self) -> bool {
        self.under_way.len() + self.ended.len() >= LINES
    }

    /// Whether it has room for a continuation of each hidden line, which starts as a line of its own and is then
    /// stitched.
    pub(super) fn has_room_to_stitch(&self) -> bool {
        let taken = self.under_way.len() + self.ended.len();
        let hidden = || self.tracks_under_way().filter(|track| track.state == State::Hidden).count();
        taken + self.under_way.len() <= LINES || taken + hidden() <= LINES
    }

    /// Lines may have been taken since: free places are looked for from the first one on.
    pub(super) fn look_for_places(&mut self) {
        self.occupied = 0;
    }

    /// Starts a line at the first free place; `false` where there is none.
    pub(super) fn begin(&mut self, point: EdgePoint, limits: &Limits) -> bool {
        let mut slots = self.slots.iter_mut().enumerate().skip(self.occupied);
        let Some((place, slot)) = slots.find(|(_, slot)| slot.track().is_none()) else {
            self.occupied = LINES;
            return false;
        };
        *slot = Slot::Taken(Track::new(point, limits));
        self.occupied = place + 1;
        // There is room: one for each place.
        let _ = self.under_way.push(place as u16);
        true
    }

    /// Takes a line out of those under way; the others stay in their order. `remove` could panic where code is small.
    pub(super) fn leave_out(&mut self, index: usize) {
        let Some(mut last) = self.under_way.pop() else { return };
        self.under_way.iter_mut().skip(index).rev().for_each(|place| core::mem::swap(place, &mut last));
    }

    /// Takes the last of the lines under way out of them; its place.
    pub(super) fn leave_out_last(&mut self) -> Option<u16> {
        self.under_way.pop()
    }

    /// Ends a confirmed line that has been left out, and forgets a tentative one. Number of points that are stray.
    pub(super) fn finish(&mut self, place: u16) -> u32 {
        if let Some(track) = self.track_mut(place).filter(|track| track.state != State::Tentative) {
            track.state = State::Ended;
            // There is room: one for each place.
            let _ = self.ended.push(place);
            return 0;
        }
        self.forget(place)
    }

    /// Splits the lines that have ended since it was asked last into their straight parts. Number of points that are stray
    /// then: those of parts that are too short, and of the shorter one of two where no place is free for it.
    pub(super) fn split_ended(&mut self) -> u32 {
        let mut strays = 0;
        while let Some(place) = self.ended.get(usize::from(self.split)).copied() {
            match self.track(place).and_then(|track| track.line.cut()) {
                Some(cut) => strays += u32::from(self.part_at(place, &cut)),
                None => self.split += 1,
            }
        }
        strays
    }

    /// Parts a line at a cut. Number of points that are left out: of the knot in which it turns, and of a part without a
    /// place of its own.
    fn part_at(&mut self, place: u16, cut: &Cut) -> u16 {
        let shorter = cut.points_before.min(cut.points_after);
        let later = if shorter < LEAST_PART_POINTS { None } else { self.copy(place) };
        if let Some(later) = later.and_then(|later| self.track_mut(later)) {
            later.line.keep_after(cut);
        }
        let Some(track) = self.track_mut(place) else { return 0 };
        let whole = track.line.points;
        if later.is_some() || cut.points_before >= cut.points_after {
            track.line.keep_before(cut);
        } else {
            track.line.keep_after(cut);
        }
        let of_later = if later.is_some() { cut.points_after } else { 0 };
        whole.saturating_sub(track.line.points).saturating_sub(of_later)
    }

    /// Puts the same line that has ended into a free place, too; that place, if there is one.
    #[inline(never)] // the copy takes room on the stack only meanwhile
    fn copy(&mut self, place: u16) -> Option<u16> {
        let free = self.slots.iter().position(|slot| slot.track().is_none())?;
        let copy = Slot::Taken(self.track(place)?.clone());
        *self.slots.get_mut(free)? = copy;
        // There is room: one for each place.
        let _ = self.ended.push(free as u16);
        Some(free as u16)
    }

    /// Forgets a line that has been left out. Number of its points.
    pub(super) fn forget(&mut self, place: u16) -> u32 {
        self.take(place).map_or(0, |track| u32::from(track.line.points()))
    }

    /// Takes a line out of its place.
    fn take(&mut self, place: u16) -> Option<Track<KNOTS>> {
        match core::mem::replace(self.slots.get_mut(usize::from(place))?, Slot::Free) {
            Slot::Free => None,
            Slot::Taken(track) => Some(track),
        }
    }

    /// Takes the line that has ended last.
    pub(super) fn next_line(&mut self) -> Option<Line<KNOTS>> {
        let place = self.ended.pop()?;
        let left = self.ended.len() as u16;
        (self.split, self.earlier) = (self.split.min(left), self.earlier.min(left));
        self.take(place).map(|track| track.line)
    }

    /// Places of the lines that have ended.
    pub(super) fn ended(&self) -> impl DoubleEndedIterator<Item = usize> + Clone {
        self.ended.iter().map(|place| usize::from(*place))
    }

    /// Appends a young line to the one that it continues and frees its place, unless they do not fit together.
    pub(super) fn append(&mut self, older: u16, young: u16) -> Option<()> {
        let track = self.take(young)?;
        let is_joined = self.track_mut(older).is_some_and(|older| older.append_stitched(&track));
        if !is_joined {
            *self.slots.get_mut(usize::from(young))? = Slot::Taken(track);
            return None;
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::Table;
    use crate::edge::EdgePoint;
    use crate::setup::Limits;

    /// Points of the lines that are left of one that turns after 96 rows and ends so many rows later.
    fn parts_of_one_that_turns(rows_after: u16) -> std::vec::Vec<u16> {
        let point = |row: u16| {
            let column_q16 = (300 << 16) + i32::from(row.saturating_sub(96)) * (1 << 15);
            EdgePoint::new(row, column_q16, i64::from(row) * 30_000)
        };
        let mut table: Table<4, 16> = Table::new();
        assert!(table.begin(point(0), &Limits::DEFAULT));
        for row in 1..96 + rows_after {
            let track = table.track_mut(0).expect("the line");
            assert!(track.take(point(row), &Limits::DEFAULT));
        }
        let place = table.leave_out_last().expect("the line");
        let strays = table.finish(place) + table.split_ended();
        let parts: std::vec::Vec<u16> = core::iter::from_fn(|| table.next_line()).map(|line| line.points()).collect();
        assert_eq!(u32::from(96 + rows_after), strays + parts.iter().map(|points| u32::from(*points)).sum::<u32>());
        parts
    }

    /// But for the knot in which it turns: 22 points are none, 40 are one.
    #[test]
    fn short_parts_are_no_lines() {
        assert_eq!(parts_of_one_that_turns(30), [96]);
        assert_eq!(parts_of_one_that_turns(56), [40, 96]);
    }
}
