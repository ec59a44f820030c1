//! [`Steps`]: whether edges go on a step aside wherever the light changes, since then it is pulsed; and which lines begin or end
//! there.

use super::table::Table;
use super::track::{State, Track};
use super::tuning::{CUT_SHARE, LEAST_STEP_Q16, LEAST_STEPS, MOST_PULSE_Q16, STEP_ROWS, YOUNG_POINTS};
use crate::edge::Light;
use crate::format::Pixels;

/// The steps of a frame's edges.
///
/// A row sees an edge where it was during the pulses within its exposure. Rows that see the same pulses see it at rest,
/// and where a pulse comes or goes the light changes, and every edge makes a step in the direction in which it moves: a
/// line breaks off, and another one of its polarity begins beside it. In steady light, however it changes down the
/// frame, lines go on where they were; what begins beside one by chance does so on either side, or farther away.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Steps {
    light: Light,
    /// Lines that begin a step to the right of another one, or to the left, less those that begin elsewhere.
    right: i8,
    left: i8,
    /// Rows of the frame so far: what begins with it does not begin with the light.
    rows: u16,
}

impl Steps {
    /// Before a frame.
    pub(super) const NONE: Self = Self { light: Light::UNSEEN, right: 0, left: 0, rows: 0 };

    /// Takes the light of the next row of a frame.
    pub(super) fn see(&mut self, row: u16, pixels: &impl Pixels, noise_q8: impl FnOnce() -> u32) {
        self.rows = self.rows.saturating_add(1);
        self.light.take(row, pixels, noise_q8);
    }

    /// Marks the lines under way that begin or break off where the light has changed.
    #[inline(always)]
    pub(super) fn mark_cut<const LINES: usize, const KNOTS: usize>(&self, table: &mut Table<LINES, KNOTS>, row: u16) {
        if self.light.has_changed() && self.is_near_change(row) {
            self.mark_near_change(table, row);
        }
    }

    #[inline(never)] // seldom
    fn mark_near_change<const LINES: usize, const KNOTS: usize>(&self, table: &mut Table<LINES, KNOTS>, row: u16) {
        if !self.is_cut_by_light(table.tracks_under_way(), row) {
            return;
        }
        let (places, mut tracks) = table.places_and_tracks();
        for place in places {
            let Some(track) = tracks.get_mut(*place) else { continue };
            track.line.begins_with_light |= self.has_begun(track, row);
            if self.has_broken_off(track, row) {
                track.line.mark_left_by_light();
            }
        }
    }

    /// Whether the light has changed so lately that lines may tell it.
    fn is_near_change(&self, row: u16) -> bool {
        self.rows > 0 && row.abs_diff(self.light.changed_row()) <= STEP_ROWS
    }

    /// Whether lines that begin or break off there may do so because of it: where nearly all go on, the light is steady.
    fn is_cut_by_light<'t, const KNOTS: usize>(
        &self,
        tracks: impl Iterator<Item = &'t Track<KNOTS>>,
        row: u16,
    ) -> bool {
        let (mut cut, mut going_on) = (0_u32, 0_u32);
        for track in tracks.filter(|track| track.state != State::Tentative) {
            if self.is_with_light(track.line.first().row, row) || self.has_broken_off(track, row) {
                cut += 1;
            } else if goes_on(track, row) {
                going_on += 1;
            }
        }
        CUT_SHARE * cut >= going_on
    }

    /// Whether the light has cut the beginning of a line that `row` has made old enough to tell where that is.
    fn has_begun<const KNOTS: usize>(&self, track: &Track<KNOTS>, row: u16) -> bool {
        is_asked(track, row) && self.is_with_light(track.line.first().row, row)
    }

    /// Whether the light has cut the end of a line that has not been seen for some rows, however soon after the frame began.
    fn has_broken_off<const KNOTS: usize>(&self, track: &Track<KNOTS>, row: u16) -> bool {
        !goes_on(track, row) && self.is_near_light(track.line.last().row)
    }

    /// Whether the light has changed near an end of a line, and the frame did not begin there.
    fn is_with_light(&self, end_row: u16, row: u16) -> bool {
        let rows_before = self.rows.saturating_sub(row.abs_diff(end_row));
        rows_before > YOUNG_POINTS && self.is_near_light(end_row)
    }

    /// Whether the light has changed near an end of a line.
    fn is_near_light(&self, end_row: u16) -> bool {
        end_row.abs_diff(self.light.changed_row()) <= YOUNG_POINTS
    }

    /// Whether the light has gone, and edges with it.
    pub(super) const fn is_dark(&self) -> bool {
        self.light.is_dark()
    }

    /// Whether the frame may have a border, at which they end.
    pub(super) const fn may_be_border(&self) -> bool {
        self.light.may_be_border()
    }

    /// Counts the lines that have become old enough on `row` to tell where they began, where the light has changed
    /// there.
    pub(super) fn count<'t, const KNOTS: usize>(
        &mut self,
        tracks: impl Iterator<Item = &'t Track<KNOTS>> + Clone,
        row: u16,
    ) {
        if !self.is_near_change(row) {
            return;
        }
        for young in tracks.clone().filter(|track| is_asked(track, row)) {
            let older = tracks.clone().filter(|older| is_before(older, young, row));
            let Some(nearest) = older.min_by_key(|older| aside_q16(older, young, row).unsigned_abs()) else { continue };
            let aside_q16 = i64::from(aside_q16(nearest, young, row));
            let is_near = aside_q16.abs() <= MOST_PULSE_Q16;
            let is_aside = is_near && aside_q16.abs() >= LEAST_STEP_Q16;
            let is_step = is_aside && !is_of_fence(tracks.clone(), nearest, young, row);
            // What begins in a line that goes on is its own.
            if is_aside || !is_near || !goes_on(nearest, row) {
                self.right = self.right.saturating_add(if is_step && aside_q16 > 0 { 1 } else { -1 });
                self.left = self.left.saturating_add(if is_step && aside_q16 < 0 { 1 } else { -1 });
            }
        }
    }

    /// Whether so many make a step to the same side that it is no chance.
    pub(super) fn are_of_pulses(&self) -> bool {
        self.right.max(self.left) >= LEAST_STEPS
    }
}

/// Whether a line has shown in nearly every row since it began, and is just as old as to tell where.
fn is_asked<const KNOTS: usize>(track: &Track<KNOTS>, row: u16) -> bool {
    track.state == State::Confirmed
        && track.line.points() == YOUNG_POINTS
        && track.line.last().row == row
        && row.abs_diff(track.line.first().row) <= YOUNG_POINTS + 1
}

/// Whether a line of the same polarity was there before.
fn is_before<const KNOTS: usize>(older: &Track<KNOTS>, young: &Track<KNOTS>, row: u16) -> bool {
    let [since_older, since_young] = [older, young].map(|track| row.abs_diff(track.line.first().row));
    older.line.last().polarity == young.line.last().polarity
        && older.state != State::Tentative
        && older.line.points() >= YOUNG_POINTS
        && since_older >= since_young + YOUNG_POINTS
}

/// Whether the row goes on showing a line.
fn goes_on<const KNOTS: usize>(track: &Track<KNOTS>, row: u16) -> bool {
    row.abs_diff(track.line.last().row) <= YOUNG_POINTS / 2
}

/// Whether what begins beside a line may be another bar of a fence: there is one more line that goes on, no more than
/// twice as far away, and an edge of the other polarity between the two, where steps of one edge have none.
fn is_of_fence<'t, const KNOTS: usize>(
    mut tracks: impl Iterator<Item = &'t Track<KNOTS>> + Clone,
    line: &Track<KNOTS>,
    young: &Track<KNOTS>,
    row: u16,
) -> bool {
    let (own_q16, young_q16) = (line.column_only(row).column_q16, young.filter.column_q16);
    let near_q16 = own_q16.abs_diff(young_q16);
    let is_like = |other: &Track<KNOTS>| other.line.last().polarity == young.line.last().polarity;
    let is_between = |other: &Track<KNOTS>| {
        let other_q16 = other.column_only(row).column_q16;
        !is_like(other) && other_q16.abs_diff(own_q16).max(other_q16.abs_diff(young_q16)) < near_q16
    };
    tracks.clone().any(is_between)
        && tracks.any(|other| {
            let other_q16 = other.column_only(row).column_q16;
            let is_third = other_q16 != own_q16 && other_q16 != young_q16 && other.state != State::Tentative;
            is_third && is_like(other) && goes_on(other, row) && other_q16.abs_diff(own_q16) / 2 <= near_q16
        })
}

/// How far beside an older line a young one is, in 1/65536 px.
fn aside_q16<const KNOTS: usize>(older: &Track<KNOTS>, young: &Track<KNOTS>, row: u16) -> i32 {
    young.filter.column_q16.saturating_sub(older.column_only(row).column_q16)
}
