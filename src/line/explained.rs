//! [`Explained`]: the scanned points of a row that are those of its located lines.

use heapless::Vec;

use super::flanks::{MAX_REACH_Q16, reach_q16};
use super::tuning::LEAST_NEAR_Q16;
use crate::edge::{EdgePoint, Polarity};

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

    /// Removes the scanned points that are explained. Returns how many of them are of a line that has its own point
    /// already.
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
