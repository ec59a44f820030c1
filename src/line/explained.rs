//! [`Explained`]: where a row's located lines are, so that nothing of them is taken for another edge.

use core::ops::Range;

use heapless::Vec;

use super::tuning::{LEAST_NEAR_Q16, LOOK_BESIDE_ROWS, LOOK_FOR_NEW_ROWS};
use crate::edge::{EdgePoint, Polarity};

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

/// Whether a row that shows each line as the row before did is scanned for new ones: some are, of a mosaic of each kind.
pub(crate) const fn looks_for_new(row: u16, is_mosaic: bool) -> bool {
    turn(row, is_mosaic).is_multiple_of(LOOK_FOR_NEW_ROWS as u32)
}

/// Whether such a row is looked at beside its located lines as well: some of them are, or an edge that begins there would
/// never be seen.
pub(crate) const fn looks_beside(row: u16, is_mosaic: bool) -> bool {
    const { assert!(LOOK_BESIDE_ROWS.is_multiple_of(LOOK_FOR_NEW_ROWS), "the others are not scanned") };
    turn(row, is_mosaic).is_multiple_of(LOOK_BESIDE_ROWS as u32)
}

/// Counts the rows of either kind of a mosaic.
const fn turn(row: u16, is_mosaic: bool) -> u32 {
    // As long as a register: what is a multiple is then told without a division.
    (if is_mosaic { row / 2 } else { row }) as u32
}

/// What the located lines of a row explain, from left to right.
pub(super) struct Explained<const LINES: usize> {
    edges: Vec<Edge, LINES>,
}

/// A located line: scanned points of its polarity near there are its own.
struct Edge {
    column_q16: i32,
    reach_q16: i32,
    /// How far a point may lie that is its own whatever else there is.
    near_q16: i32,
    polarity: Polarity,
    /// The scanner has found this very point, too.
    is_seen: bool,
}

/// Upper bound of [`Edge::reach_q16`].
const MAX_REACH_Q16: i32 = 34 << 16;

/// What an edge without blur reaches.
const LEAST_REACH_Q16: i32 = 5 << 15;

/// Half of the scanner's window, which sees an edge so much before its flank.
const WINDOW_Q16: i32 = 4 << 16;

/// The scanner leaves out whole spans of eight pixels: what is that near to a flank, on either side, may lie in one, or
/// its windows.
const NEAR_PX: u32 = 2 * 8 + 4;

/// How far from its column a scanned point of a line may lie, in 1/65536 px: a row of a long blur may be wider than the
/// blur itself can be.
fn reach_q16(point: &EdgePoint) -> i32 {
    (LEAST_REACH_Q16 + i32::from(point.width_q8) * 640).min(MAX_REACH_Q16)
}

impl<const LINES: usize> Explained<LINES> {
    /// Of the points of located lines.
    pub(super) fn by<'e>(points: impl Iterator<Item = &'e EdgePoint>) -> Self {
        let mut explained = Self { edges: Vec::new() };
        points.for_each(|point| explained.add(point));
        explained
    }

    fn add(&mut self, point: &EdgePoint) {
        let EdgePoint { column_q16, polarity, .. } = *point;
        let near_q16 = LEAST_NEAR_Q16 + (i32::from(point.width_q8) << 9);
        let edge = Edge { column_q16, reach_q16: reach_q16(point), near_q16, polarity, is_seen: false };
        // There is room: one per line at most. They come in order but for a few.
        if self.edges.last().is_none_or(|last| last.column_q16 <= column_q16) {
            let _ = self.edges.push(edge);
        } else {
            let _ = self.edges.insert(self.edges.partition_point(|other| other.column_q16 <= column_q16), edge);
        }
    }

    /// Removes the scanned points that are explained. Returns how many of them are no line's own point once more.
    ///
    /// The near ones first: what lies farther off is the line's own where it is the only one, else another edge's.
    pub(super) fn remove_from<const POINTS: usize>(&mut self, points: &mut Vec<EdgePoint, POINTS>) -> u32 {
        let (mut nearby, mut strays) = (0, 0);
        points.retain(|point| {
            let edge = self.edge_of(point, &mut nearby, |edge| edge.near_q16);
            if let Some(edge) = &edge {
                strays += u32::from(edge.is_seen);
            }
            edge.map(|edge| edge.is_seen = true).is_none()
        });
        nearby = 0;
        points.retain(|point| {
            let edge = self.edge_of(point, &mut nearby, |edge| edge.reach_q16);
            edge.filter(|edge| !edge.is_seen).map(|edge| edge.is_seen = true).is_none()
        });
        strays
    }

    /// The edge that explains a point: the first that has not been seen yet, else the last. Those before `nearby` are
    /// too far to the left for this and all later points.
    #[inline(never)] // from the two loops of `retain`
    fn edge_of(
        &mut self,
        point: &EdgePoint,
        nearby: &mut usize,
        reach_q16: impl Fn(&Edge) -> i32,
    ) -> Option<&mut Edge> {
        let mut found = None;
        for (index, edge) in self.edges.iter().enumerate().skip(*nearby) {
            let apart_q16 = edge.column_q16.saturating_sub(point.column_q16);
            if apart_q16 > MAX_REACH_Q16 {
                break;
            }
            if apart_q16 < -MAX_REACH_Q16 && index == *nearby {
                *nearby += 1;
            } else if edge.polarity == point.polarity && apart_q16.unsigned_abs() <= reach_q16(edge).unsigned_abs() {
                found = Some(index);
                if !edge.is_seen {
                    break;
                }
            }
        }
        self.edges.get_mut(found?)
    }
}
