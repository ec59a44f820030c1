//! [`Candidates`]: the lines that a row may show, from left to right.

use core::ops::Range;

use heapless::Vec;

use super::association::Prediction;
use super::tuning::BESIDE_Q16;
use crate::edge::{Neighbours, Polarity, apart_of_blur_q16};

/// A line under way, as predicted for a row.
#[derive(Clone, Copy)]
pub(super) struct Candidate {
    pub(super) prediction: Prediction,
    /// Two edges nearer than this cannot be told apart, because of their noise or their blur, in 1/65536 px.
    pub(super) blur_q16: u32,
    pub(super) place: u16,
    pub(super) polarity: Polarity,
    pub(super) role: Role,
}

/// What the row is to a line.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// The line is noise as often as not: it takes what the others leave.
    Tentative,
    /// The line is sure of its edge: where the row shows it is looked at first.
    Confirmed,
    /// The line has been hidden for so long that it waits for another one to continue it.
    Waiting,
    /// The row has shown the line.
    Seen,
}

impl Candidate {
    /// Whether the other one is another edge. A line of the same polarity within the blur may be a fragment of the same
    /// edge. Tentative lines must not narrow the window of a confirmed one.
    fn is_ended_by(&self, other: &Self) -> bool {
        let apart_q16 = other.prediction.column_q16.abs_diff(self.prediction.column_q16);
        matches!(other.role, Role::Confirmed | Role::Seen)
            && (other.polarity != self.polarity || apart_q16 > apart_of_blur_q16(self.blur_q16.max(other.blur_q16)))
    }
}

/// The lines that a row may show, from left to right.
pub(crate) struct Candidates<const LINES: usize> {
    lines: Vec<Candidate, LINES>,
}

impl<const LINES: usize> Candidates<LINES> {
    pub(crate) const fn new() -> Self {
        Self { lines: Vec::new() }
    }

    pub(super) fn len(&self) -> usize {
        self.lines.len()
    }

    pub(super) fn get(&self, index: usize) -> Option<&Candidate> {
        self.lines.get(index)
    }

    pub(super) fn iter(&self) -> core::slice::Iter<'_, Candidate> {
        self.lines.iter()
    }

    /// The row has shown one of the lines.
    pub(super) fn see(&mut self, index: usize) {
        if let Some(line) = self.lines.get_mut(index) {
            line.role = Role::Seen;
        }
    }

    /// Leaves those that the row has not shown yet.
    pub(super) fn keep_unseen(&mut self) {
        self.lines.retain(|line| line.role != Role::Seen);
    }

    /// Adds the columns where a row may show them, and what the scanner sees of an edge there, from left to right but
    /// for some.
    pub(crate) fn add_columns(&self, columns: &mut Vec<Range<u16>, LINES>) {
        let column = |column_q16: i32| (column_q16 >> 16).max(0) as u16;
        for Candidate { prediction: Prediction { column_q16, gate_q16, .. }, .. } in self.sought() {
            let reach_q16 = gate_q16.saturating_add(BESIDE_Q16);
            let from_q16 = column_q16.saturating_sub_unsigned(reach_q16);
            let to_q16 = column_q16.saturating_add_unsigned(reach_q16);
            let (from, to) = (column(from_q16), column(to_q16));
            match columns.last_mut() {
                Some(last) if from <= last.end && to >= last.start => *last = last.start.min(from)..last.end.max(to),
                // There is room: one for each line.
                _ => {
                    let _ = columns.push(from..to);
                }
            }
        }
    }

    /// Those that a point may belong to.
    pub(super) fn sought(&self) -> impl Iterator<Item = &Candidate> {
        self.iter().filter(|line| line.role != Role::Waiting)
    }

    /// Adds a line; whether it lies on the left of one before. Lines hardly ever change their order.
    pub(super) fn add(&mut self, candidate: Candidate) -> bool {
        let is_before =
            self.lines.last().is_some_and(|last| last.prediction.column_q16 > candidate.prediction.column_q16);
        // There is room: one for each line at most.
        let _ = self.lines.push(candidate);
        if is_before {
            self.sort_last();
        }
        is_before
    }

    #[inline(never)]
    fn sort_last(&mut self) {
        let mut lines: &mut [Candidate] = &mut self.lines;
        while let Some([left, right]) = lines.last_chunk_mut()
            && left.prediction.column_q16 > right.prediction.column_q16
        {
            core::mem::swap(left, right);
            let Some((_, before)) = lines.split_last_mut() else { break };
            lines = before;
        }
    }

    /// Two confirmed lines of one polarity that are so near to each other that a point could be of either take none.
    pub(super) fn coast_beside_each_other(&mut self) {
        let most_blur_q16 = self.iter().map(|line| line.blur_q16).max().unwrap_or(0);
        let mut before_q16 = None;
        let is_near = |line: &Candidate| {
            let column_q16 = line.prediction.column_q16;
            before_q16.replace(column_q16).is_some_and(|before_q16| column_q16.abs_diff(before_q16) < most_blur_q16)
        };
        if !self.iter().any(is_near) {
            return;
        }
        let mut rest: &mut [Candidate] = &mut self.lines;
        while let Some((first, others)) = rest.split_first_mut() {
            let is_like = |other: &&mut Candidate| other.role == first.role && other.polarity == first.polarity;
            if first.role == Role::Confirmed
                && let Some(second) = others.iter_mut().find(is_like)
            {
                let apart_q16 = second.prediction.column_q16.abs_diff(first.prediction.column_q16);
                if apart_q16 < first.blur_q16.max(second.blur_q16) {
                    first.prediction.coasting = true;
                    second.prediction.coasting = true;
                }
            }
            rest = others;
        }
    }

    /// The edges that end the plateaus of one of the lines.
    pub(super) fn around(&self, index: usize) -> Neighbours {
        let Some((before, [line, after @ ..])) = self.lines.split_at_checked(index) else { return Neighbours::NONE };
        let column_q16 = |other: &Candidate| other.prediction.column_q16;
        let left = before.iter().rev().find(|other| line.is_ended_by(other)).map(column_q16);
        let right = after.iter().find(|other| line.is_ended_by(other)).map(column_q16);
        Neighbours {
            left_q16: left.unwrap_or(Neighbours::NONE.left_q16),
            right_q16: right.unwrap_or(Neighbours::NONE.right_q16),
        }
    }
}
