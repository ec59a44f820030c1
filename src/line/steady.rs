//! Lines that go on as before, each in its place: they need not be weighed against each other. Of pixels they are located
//! one by one; of given points either all are such or none.

use heapless::Vec;

use super::locating::{Beside, RowTime, SeenRow};
use super::table::{Table, Tracks};
use crate::edge::{EdgePoint, PixelRow};
use crate::format::Pixels;
use crate::setup::Limits;

/// Places of lines that were looked for in vain.
pub(super) type Missed<const LINES: usize> = Vec<u16, LINES>;

/// What has been located of the lines under way.
pub(super) struct Located {
    pub(super) lines: usize,
    /// Whether one of them is young.
    pub(super) has_young: bool,
}

/// Locates the lines that the row before has shown and that need not be weighed against others, from left to right, and
/// notes the missed ones. What is left has to be looked at closely.
#[inline(never)] // all of it then fits into the registers
pub(super) fn locate_steady<P: Pixels, const LINES: usize, const KNOTS: usize>(
    table: &mut Table<LINES, KNOTS>,
    limits: &Limits,
    at: &RowTime,
    row: &PixelRow<'_, P>,
    missed: &mut Missed<LINES>,
) -> Located {
    let (places, mut tracks) = table.places_and_tracks();
    let row = SeenRow { at, pixels: *row, bytes: row.quick_bytes(), limits };
    let mut located = Located { lines: 0, has_young: false };
    let beside = |tracks: &Tracks<'_, KNOTS>, index: usize| {
        places.get(index).and_then(|place| tracks.get(*place)).map_or(Beside::END, Beside::of)
    };
    let (mut around, mut own) = ([Beside::BEGINNING; 2], beside(&tracks, 0));
    for (index, place) in places.iter().enumerate() {
        let [_, right] = &mut around;
        *right = beside(&tracks, index + 1);
        let passed = core::mem::replace(&mut own, *right);
        let Some(track) = tracks.get_mut(*place) else { continue };
        let found = if track.locate_steady(&row, &around) { Some(true) } else { track.locate_between(&row, &around) };
        match found {
            Some(true) => {
                located.lines += 1;
                located.has_young |= track.is_young();
            }
            Some(false) => {
                let _ = missed.push(*place);
            }
            None => {}
        }
        let [left, _] = &mut around;
        *left = passed.behind(left);
    }
    located
}

/// Gives each line its point, where a row shows each as the rows before did and nothing else. Whether one of the lines is
/// young then; `None` where it does not, and nothing has changed.
#[inline(never)] // all of it then fits into the registers
pub(super) fn take_steady<const LINES: usize, const KNOTS: usize>(
    table: &mut Table<LINES, KNOTS>,
    limits: &Limits,
    row: u16,
    points: &[EdgePoint],
) -> Option<bool> {
    if points.len() != table.under_way().len() || !are_steady(table, row, points) {
        return None;
    }
    let (places, mut tracks) = table.places_and_tracks();
    let mut has_young = false;
    for (place, point) in places.iter().zip(points) {
        if let Some(track) = tracks.get_mut(*place) {
            track.take_next_point(point, limits);
            has_young |= track.is_young();
        }
    }
    Some(has_young)
}

/// Whether points and lines, both from left to right, belong together one by one, and no two are so near to each other
/// that they could be exchanged.
fn are_steady<const LINES: usize, const KNOTS: usize>(
    table: &Table<LINES, KNOTS>,
    row: u16,
    points: &[EdgePoint],
) -> bool {
    // Of the line on the left: its column, and how far off the next one has to be.
    let (mut left_q16, mut apart_q16) = (None, 0);
    table.under_way().iter().zip(points).all(|(place, point)| {
        let Some(track) = table.track(*place).filter(|track| track.may_take_next(row, point)) else { return false };
        let column_q16 = track.next_column_q16();
        let off_q16 = column_q16.abs_diff(point.column_q16);
        let own_q16 = track.blur_q16().max(off_q16.saturating_mul(2));
        let is_apart = left_q16.is_none_or(|left_q16: i32| {
            left_q16 < column_q16 && left_q16.abs_diff(column_q16) > own_q16.max(apart_q16)
        });
        (left_q16, apart_q16) = (Some(column_q16), own_q16);
        is_apart && off_q16 <= track.next_gate_q16()
    })
}

#[cfg(test)]
mod tests {
    use super::super::tracker::Tracker;
    use crate::edge::{EdgePoint, Polarity};
    use crate::line::Candidates;
    use crate::setup::Limits;

    type Lines = Tracker<8, 8>;

    /// Points of six edges: some lean towards each other and cross, one is seen in some of the rows only, and a point
    /// now and then is of no edge.
    fn points_of(row: u16) -> heapless::Vec<EdgePoint, 16> {
        let mut mixed = u32::from(row) + 1;
        let mut any = || {
            mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2c1b_3c6d).wrapping_add(0x9e37_79b9);
            (mixed >> 16) as i32 & 0x1fff
        };
        let mut points = heapless::Vec::new();
        for (edge, lean_q16) in (0..6).zip([0, 900, 12_000, -12_000, 300, -700]) {
            let polarity = if edge % 2 == 0 { Polarity::Rising } else { Polarity::Falling };
            let column_q16 = ((20 + 40 * edge) << 16) + lean_q16 * i32::from(row) + any();
            if edge != 4 || row % 50 < 40 {
                let point = EdgePoint::new(row, column_q16, i64::from(row) * 1000).with_polarity(polarity);
                let _ = points.push(EdgePoint { width_q8: 200 + (any() >> 8) as u16, ..point });
            }
        }
        if row % 17 == 5 {
            let _ = points.push(EdgePoint::new(row, 300 << 16, i64::from(row) * 1000).with_polarity(Polarity::Rising));
        }
        points.sort_unstable_by_key(|point| point.column_q16);
        points
    }

    /// Lines are the same whether their points are weighed against each other or not.
    #[test]
    fn it_is_an_association() {
        let (mut quick, mut whole, mut steady) = (Lines::new(), Lines::new(), 0);
        for row in 0..400 {
            let points = points_of(row);
            steady += u16::from(super::are_steady(quick.table(), row, &points));
            let jump = quick.row(&Limits::DEFAULT, 320, row, &points);
            let mut candidates = Candidates::new();
            whole.expect(&Limits::DEFAULT, row, &mut candidates);
            let other = whole.take(&Limits::DEFAULT, 320, row, &candidates, &points, &|point, _| *point);
            assert_eq!(jump, other, "row {row}");
        }
        // Both ways are taken.
        assert!((100..300).contains(&steady), "{steady}");
        quick.end_frame();
        whole.end_frame();
        let lines = |mut tracker: Lines| core::iter::from_fn(move || tracker.next_line());
        assert!(lines(quick).eq(lines(whole)));
    }
}
