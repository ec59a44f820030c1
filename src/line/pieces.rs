//! [`Pieces`]: whether the lines of a frame are pieces of edges that advance in jumps, in light that is pulsed but seems
//! steady.

use super::asides::Asides;
use super::table::Table;
use super::track::{State, Track};
use super::tuning::{
    LEAST_PIECES, LEAST_STEP_Q16, MOST_PULSE_Q16, PIECES_RATIO, PIECES_SHARE, SUCCESSOR_ROWS, YOUNG_POINTS,
};
use crate::edge::EdgePoint;

/// Where lines of a frame break off, and how many of them go on a step to the left, or to the right.
///
/// Where each row collects the light of as many pulses as any other, nothing but the edges tells that it is pulsed: they
/// stand still and go on a step aside, most of them of the frame, and to the side to which they move. Of edges in steady
/// light few have another one of their kind beside where they end, and those on either side.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Pieces {
    ended: u8,
    on_left: u8,
    on_right: u8,
}

impl Pieces {
    /// Before a frame.
    pub(super) const NONE: Self = Self { ended: 0, on_left: 0, on_right: 0 };

    /// Takes a line at a place that rows have not shown for so long that another one that goes on there has begun.
    #[inline(never)] // seldom
    pub(super) fn take<const LINES: usize, const KNOTS: usize>(&mut self, table: &mut Table<LINES, KNOTS>, place: u16) {
        let Some(track) = table.track(place).filter(|track| track.state != State::Tentative) else { return };
        let (first, last) = (track.line.first(), *track.line.last());
        let end = End { first_row: first.row, last, slope_q16: track.filter.slope_q16 };
        let mut found = Asides::NONE;
        let (places, mut tracks) = table.places_and_tracks();
        for place in places {
            let Some(other) = tracks.get_mut(*place) else { continue };
            let asides = end.asides_of(other);
            other.line.asides = other.line.asides.or(asides);
            found = found.or(asides);
        }
        if let Some(track) = tracks.get_mut(place) {
            track.line.asides = track.line.asides.or(found);
        }
        self.ended = self.ended.saturating_add(1);
        self.on_left = self.on_left.saturating_add(found.left.into());
        self.on_right = self.on_right.saturating_add(found.right.into());
    }

    /// What is beside a line of the frame, if most lines make steps to that side.
    pub(super) fn agreeing(self, asides: Asides) -> Asides {
        let (times, of) = PIECES_SHARE;
        let are_most = |count: u8, others: u8| {
            count >= LEAST_PIECES
                && of * u16::from(count) >= times * u16::from(self.ended)
                && u16::from(count) > PIECES_RATIO * u16::from(others)
        };
        Asides {
            left: asides.left && are_most(self.on_left, self.on_right),
            right: asides.right && are_most(self.on_right, self.on_left),
        }
    }
}

/// Where a line has broken off.
struct End {
    first_row: u16,
    last: EdgePoint,
    slope_q16: i32,
}

impl End {
    /// On which side another line of the same kind begins there.
    fn asides_of<const KNOTS: usize>(&self, other: &Track<KNOTS>) -> Asides {
        let (begins, ends) = (other.line.first(), other.line.last());
        let rows_to = |row: u16, from: u16| i32::from(row) - i32::from(from);
        // Rows may be read from the last one on.
        let sense = rows_to(self.last.row, self.first_row).signum();
        let gap = rows_to(begins.row, self.last.row);
        let is_later = |row: u16, than: u16| sense * rows_to(row, than) >= i32::from(YOUNG_POINTS);
        let goes_on = other.state != State::Tentative
            && begins.polarity == self.last.polarity
            && gap.unsigned_abs() <= u32::from(SUCCESSOR_ROWS)
            && is_later(begins.row, self.first_row)
            && is_later(ends.row, self.last.row);
        let there_q16 = self.last.column_q16.saturating_add(self.slope_q16.saturating_mul(sense * gap));
        let off_q16 = i64::from(begins.column_q16) - i64::from(there_q16);
        let is_step = goes_on && (LEAST_STEP_Q16..=MOST_PULSE_Q16).contains(&off_q16.abs());
        Asides { left: is_step && off_q16 < 0, right: is_step && off_q16 > 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::{Asides, Pieces};

    /// One line is no frame, two of four are not most, and where the others go to the other side it is chance.
    #[test]
    fn most_make_steps_to_one_side() {
        let both = Asides { left: true, right: true };
        let agreeing = |ended, on_left, on_right| Pieces { ended, on_left, on_right }.agreeing(both);
        assert_eq!(agreeing(1, 1, 0), Asides::NONE);
        assert_eq!(agreeing(3, 2, 0), Asides { left: true, right: false });
        assert_eq!(agreeing(3, 2, 1), Asides::NONE);
        assert_eq!(agreeing(4, 2, 0), Asides::NONE);
        assert_eq!(agreeing(9, 2, 6), Asides { left: false, right: true });
        assert!(!Pieces { ended: 2, on_left: 2, on_right: 0 }.agreeing(Asides { left: false, right: true }).any());
    }
}
