//! [`Association`]: which point of a row belongs to which line.

use core::iter::Peekable;

use crate::edge::EdgePoint;

/// Where a line should cross a row, and how far from there its point may lie.
#[derive(Clone, Copy)]
pub(crate) struct Prediction {
    pub(crate) column_q16: i32,
    pub(crate) gate_q16: u32,
    /// Whether it is so near to another line of its kind that a point there could be of either: it then takes none.
    pub(crate) coasting: bool,
}

/// A line or an edge on the way from left to right.
#[derive(Clone, Copy)]
enum Item<'e> {
    Point(&'e EdgePoint),
    Line { place: u16, gate_q16: u32, coasting: bool },
}

/// An edge and a line that may belong together.
#[derive(Clone, Copy)]
pub(crate) struct Pair<'e> {
    pub(crate) point: &'e EdgePoint,
    pub(crate) place: u16,
    distance_q16: u32,
    pub(crate) coasting: bool,
}

/// What has become of an edge.
pub(crate) enum Outcome<'e> {
    Matched(Pair<'e>),
    Unmatched(&'e EdgePoint),
}

/// Matches edges to lines, both in the order of their columns: each other's nearest belong together.
pub(crate) struct Association<'e, I: Iterator<Item = (Prediction, u16)>> {
    lines: Peekable<I>,
    /// The item before, if it is not yet settled.
    previous: Option<(i32, Item<'e>)>,
    /// The pair that the item before forms with the one before it.
    pair: Option<Pair<'e>>,
}

impl<'e, I: Iterator<Item = (Prediction, u16)>> Association<'e, I> {
    pub(crate) fn over(lines: I) -> Self {
        Self { lines: lines.peekable(), previous: None, pair: None }
    }

    /// Takes the next point and hands to `settle` those that are now decided, in the order of columns.
    pub(crate) fn point(&mut self, point: &'e EdgePoint, settle: &mut impl FnMut(Outcome<'e>)) {
        let column = point.column_q16;
        while let Some((line, place)) = self.lines.next_if(|(line, _)| line.column_q16 <= column) {
            self.advance(Some(item_of(&line, place)), settle);
        }
        self.advance(Some((column, Item::Point(point))), settle);
    }

    /// What is left is a point, which the next line may still take, if there is any.
    pub(crate) fn finish(mut self, settle: &mut impl FnMut(Outcome<'e>)) {
        if self.previous.is_some()
            && let Some((line, place)) = self.lines.next()
        {
            self.advance(Some(item_of(&line, place)), settle);
        }
        self.advance(None, settle);
    }

    /// Two neighbours of different kind are a pair unless one of them is nearer to its neighbour on the other side.
    fn advance(&mut self, next: Option<(i32, Item<'e>)>, settle: &mut impl FnMut(Outcome<'e>)) {
        let pair = match (self.previous, next) {
            (Some(left), Some(right)) => pair_up(left, right),
            _ => None,
        };
        let nearer = match (&self.pair, &pair) {
            (Some(before), Some(now)) => now.distance_q16 < before.distance_q16,
            (None, Some(_)) => true,
            (_, None) => false,
        };
        match (self.pair.take(), self.previous.take()) {
            // The line before leaves its edge for a nearer one.
            (Some(left), Some((_, Item::Line { .. }))) if nearer => settle(Outcome::Unmatched(left.point)),
            (Some(_), _) if nearer => {}
            (Some(left), _) => settle(Outcome::Matched(left)),
            (None, Some((_, Item::Point(point)))) if !nearer => settle(Outcome::Unmatched(point)),
            (None, _) => {}
        }
        self.pair = pair.filter(|_| nearer);
        self.previous = next;
    }
}

fn item_of<'e>(line: &Prediction, place: u16) -> (i32, Item<'e>) {
    (line.column_q16, Item::Line { place, gate_q16: line.gate_q16, coasting: line.coasting })
}

/// An edge and a line within the line's gate.
fn pair_up<'e>(left: (i32, Item<'e>), right: (i32, Item<'e>)) -> Option<Pair<'e>> {
    let distance_q16 = right.0.abs_diff(left.0);
    match (left.1, right.1) {
        (Item::Point(point), Item::Line { place, gate_q16, coasting })
        | (Item::Line { place, gate_q16, coasting }, Item::Point(point)) => {
            (distance_q16 <= gate_q16).then_some(Pair { point, place, distance_q16, coasting })
        }
        _ => None,
    }
}
