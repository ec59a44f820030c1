//! [`Flanks`]: where the scanner need not look, since a located line explains what differs there.

use core::ops::Range;

use heapless::Vec;

use crate::edge::EdgePoint;

/// Where the scanner's differences are those of located lines that stand alone, from left to right but for some that
/// are near to each other: positions of the scanner, of which the one on the left of a pixel has its number.
pub(crate) type Flanks<const LINES: usize> = Vec<Range<u16>, LINES>;

/// Where the windows of the scanner reach into the blur of a located line.
pub(super) fn flank(point: &EdgePoint) -> Range<u16> {
    let half_q16 = reach_q16(point) - LEAST_REACH_Q16 + WINDOW_Q16;
    let position = |column_q16: i32| (column_q16 >> 16).clamp(0, i32::from(u16::MAX) - 2) as u16;
    position(point.column_q16 - half_q16)..position(point.column_q16.saturating_add(half_q16)) + 2
}

/// Adds a flank in its place; they come in order but for some.
pub(super) fn add_flank<const LINES: usize>(flanks: &mut Flanks<LINES>, flank: Range<u16>) {
    // There is room: one for each line.
    if flanks.last().is_none_or(|last| last.start <= flank.start) {
        let _ = flanks.push(flank);
        return;
    }
    // It is never beyond them, which the compiler sees only so.
    let at = flanks.partition_point(|other| other.start <= flank.start);
    let _ = flanks.insert(at.min(flanks.len()), flank);
}

/// Whether nothing else is expected near a flank, at these columns in 1/65536 px.
pub(super) fn is_alone(flank: &Range<u16>, mut others_q16: impl Iterator<Item = i32>) -> bool {
    let (middle, near) = ((i32::from(flank.start) + i32::from(flank.end)) / 2, flank.len() as u32 + NEAR_PX);
    others_q16.all(|other_q16| (other_q16 >> 16).abs_diff(middle) > near)
}

/// Upper bound of [`reach_q16`].
pub(super) const MAX_REACH_Q16: i32 = 34 << 16;

/// What an edge without blur reaches.
const LEAST_REACH_Q16: i32 = 5 << 15;

/// Half of the scanner's window, which sees an edge so much before its flank.
const WINDOW_Q16: i32 = 4 << 16;

/// The scanner leaves out whole spans of eight pixels: what is that near to a flank, on either side, may lie in one, or
/// its windows.
const NEAR_PX: u32 = 2 * 8 + 4;

/// How far from its column a scanned point of a line may lie, in 1/65536 px: a row of a long blur may be wider than the
/// blur itself can be.
pub(super) fn reach_q16(point: &EdgePoint) -> i32 {
    (LEAST_REACH_Q16 + i32::from(point.width_q8) * 640).min(MAX_REACH_Q16)
}
