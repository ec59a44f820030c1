//! [`Tracker`]: from a stream of edges in row order to lines.

use core::iter::Peekable;

use heapless::Vec;

use crate::{Edge, Limits, Line, Polarity};

/// What did not become part of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counters {
    /// Edges refused because the row's buffer was full.
    pub dropped_edges: u32,
    /// Edges that would have begun a line while the table was full. A line that is refused in each of its rows counts
    /// each time.
    pub dropped_lines: u32,
    /// Edges of tentative lines that were never confirmed: noise and texture.
    pub stray_edges: u32,
}

/// Lines of a frame under way: at most `LINES` of `KNOTS` knots each.
///
/// Every row's edges are matched to the lines' predicted columns: an edge and a line of the same polarity that are each
/// other's nearest, within the gate, belong together. An edge that matches nothing begins a tentative line. Lines that
/// have missed too many rows end; a full table refuses the newcomer, counts it, and never loses a confirmed line.
///
/// *Cost*: per row a sort of the lines (which hardly change places) and one sweep over edges and lines together.
#[derive(Debug)]
pub struct Tracker<const LINES: usize, const KNOTS: usize> {
    tracks: [Option<Track<KNOTS>>; LINES],
    counters: Counters,
}

#[derive(Clone, Debug)]
struct Track<const KNOTS: usize> {
    line: Line<KNOTS>,
    state: State,
    /// Filtered column at the last edge's row, in 1/65536 px.
    column_q16: i64,
    /// Filtered slope in 1/65536 px per row of readout.
    slope_q16: i64,
    missed_rows: u16,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Tentative,
    Confirmed,
    /// Complete, waiting to be taken.
    Ended,
}

/// The filter's gain falls with the number of edges down to this one's, so that it can follow a curve.
const MEMORY_EDGES: i64 = 24;
/// No gate is wider.
const MAX_GATE_Q16: i64 = 48 << 16;

impl<const KNOTS: usize> Track<KNOTS> {
    fn new(edge: Edge) -> Self {
        Self {
            line: Line::new(edge),
            state: State::Tentative,
            column_q16: i64::from(edge.column_q16),
            slope_q16: 0,
            missed_rows: 0,
        }
    }

    /// Where the line should cross `row`, and how far off an edge there may lie.
    fn predict(&self, row: u16, limits: &Limits) -> Prediction {
        let rows = i64::from(row.abs_diff(self.line.last().row));
        let edges = i64::from(self.line.edges()).min(MEMORY_EDGES);
        // What the slope may still be off: everything after one edge, ever less after.
        let slope_q16 = i64::from(limits.max_slope_q16) / (edges * edges);
        let noise_q16 = 4 * i64::from(self.line.last().sigma_q16.min(1 << 24));
        let gate_q16 = i64::from(limits.gate_q16) + noise_q16 + slope_q16 * rows;
        Prediction { column_q16: self.column_q16 + self.slope_q16 * rows, gate_q16: gate_q16.min(MAX_GATE_Q16) }
    }

    /// Takes an edge that matches: a line fit with fading memory, updated edge by edge.
    fn take(&mut self, edge: Edge, limits: &Limits) -> bool {
        let rows = i64::from(edge.row.abs_diff(self.line.last().row));
        if self.line.push(edge).is_err() {
            return false;
        }
        let n = i64::from(self.line.edges()).min(MEMORY_EDGES);
        let predicted = self.column_q16 + self.slope_q16 * rows;
        let off = i64::from(edge.column_q16) - predicted;
        let count = n * (n + 1);
        self.column_q16 = predicted + off * (4 * n - 2) / count.max(1);
        self.slope_q16 += 6 * off / (count * rows).max(1);
        self.missed_rows = 0;
        if self.line.edges() >= limits.confirm_edges {
            self.state = State::Confirmed;
        }
        true
    }
}

#[derive(Clone, Copy)]
struct Prediction {
    column_q16: i64,
    gate_q16: i64,
}

/// A line under way, as a row sees it.
struct Candidate {
    prediction: Prediction,
    slot: usize,
    state: State,
    polarity: Polarity,
}

/// A line or an edge on the way from left to right.
#[derive(Clone, Copy)]
enum Item {
    Edge(Edge),
    Line { slot: usize, gate_q16: i64 },
}

/// An edge and a line that may belong together.
#[derive(Clone, Copy)]
struct Pair {
    edge: Edge,
    slot: usize,
    distance_q16: i64,
}

/// What has become of an edge.
enum Settled {
    Joined(Pair),
    Alone(Edge),
}

/// Matches edges to lines, both in the order of their columns: each other's nearest belong together.
struct Sweep<I: Iterator<Item = (Prediction, usize)>> {
    lines: Peekable<I>,
    /// The item before, if it is not yet settled.
    previous: Option<(i64, Item)>,
    /// The pair that the item before forms with the one before it.
    pair: Option<Pair>,
}

impl<I: Iterator<Item = (Prediction, usize)>> Sweep<I> {
    fn over(lines: I) -> Self {
        Self { lines: lines.peekable(), previous: None, pair: None }
    }

    /// Takes the next edge; `settle` hears of those whose fate is now known, in the order of columns.
    fn edge(&mut self, edge: Edge, settle: &mut impl FnMut(Settled)) {
        let column = i64::from(edge.column_q16);
        while let Some((line, slot)) = self.lines.next_if(|(line, _)| line.column_q16 <= column) {
            self.advance(Some((line.column_q16, Item::Line { slot, gate_q16: line.gate_q16 })), settle);
        }
        self.advance(Some((column, Item::Edge(edge))), settle);
    }

    fn finish(mut self, settle: &mut impl FnMut(Settled)) {
        while let Some((line, slot)) = self.lines.next() {
            self.advance(Some((line.column_q16, Item::Line { slot, gate_q16: line.gate_q16 })), settle);
        }
        self.advance(None, settle);
    }

    /// Two neighbours of different kind are a pair unless one of them is nearer to its neighbour on the other side.
    fn advance(&mut self, next: Option<(i64, Item)>, settle: &mut impl FnMut(Settled)) {
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
            (Some(left), Some((_, Item::Line { .. }))) if nearer => settle(Settled::Alone(left.edge)),
            (Some(_), _) if nearer => {}
            (Some(left), _) => settle(Settled::Joined(left)),
            (None, Some((_, Item::Edge(edge)))) if !nearer => settle(Settled::Alone(edge)),
            (None, _) => {}
        }
        self.pair = pair.filter(|_| nearer);
        self.previous = next;
    }
}

/// An edge and a line within the line's gate.
fn pair_up(left: (i64, Item), right: (i64, Item)) -> Option<Pair> {
    let distance_q16 = right.0 - left.0;
    match (left.1, right.1) {
        (Item::Edge(edge), Item::Line { slot, gate_q16 }) | (Item::Line { slot, gate_q16 }, Item::Edge(edge)) => {
            (distance_q16 <= gate_q16).then_some(Pair { edge, slot, distance_q16 })
        }
        _ => None,
    }
}

impl<const LINES: usize, const KNOTS: usize> Tracker<LINES, KNOTS> {
    /// An empty tracker.
    #[must_use]
    pub const fn new() -> Self {
        let counters = Counters { dropped_edges: 0, dropped_lines: 0, stray_edges: 0 };
        Self { tracks: [const { None }; LINES], counters }
    }

    /// Takes all edges of one row, sorted by column. Rows come in the order of readout; rows that were not looked at may
    /// be left out, rows without edges should be given, since lines end by missing rows.
    pub fn row(&mut self, limits: &Limits, row: u16, edges: &[Edge]) {
        let predictions = self.predictions(limits, row);
        for polarity in [Polarity::Rising, Polarity::Falling, Polarity::Unknown] {
            self.match_edges(limits, &predictions, edges.iter().filter(|edge| edge.polarity == polarity), polarity);
        }
        self.count_missed(limits, row);
    }

    /// Ends all confirmed lines and forgets the tentative ones.
    pub fn end_frame(&mut self) {
        for track in &mut self.tracks {
            finish(track, &mut self.counters);
        }
    }

    /// A line that has ended, in no particular order. Take them after every row, or their places stay occupied.
    pub fn next_line(&mut self) -> Option<Line<KNOTS>> {
        let ended = self.tracks.iter_mut().find(|track| is_in(track, State::Ended))?;
        ended.take().map(|track| track.line)
    }

    /// What was dropped since the tracker was made.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    pub(crate) fn count_dropped_edge(&mut self) {
        self.counters.dropped_edges = self.counters.dropped_edges.saturating_add(1);
    }

    /// Predictions of all lines under way, from left to right.
    fn predictions(&self, limits: &Limits, row: u16) -> Vec<Candidate, LINES> {
        let mut predictions: Vec<_, LINES> = Vec::new();
        for (slot, track) in self.tracks.iter().enumerate() {
            // One per slot at most.
            if let Some(track) = track.as_ref().filter(|track| track.state != State::Ended) {
                let (state, polarity) = (track.state, track.line.first().polarity);
                let _ = predictions.push(Candidate { prediction: track.predict(row, limits), slot, state, polarity });
            }
        }
        predictions.sort_unstable_by_key(|candidate| candidate.prediction.column_q16);
        predictions
    }

    /// Confirmed lines choose first, tentative ones among the edges that are left: clutter beside a confirmed line must
    /// not take its edges. What matches nothing begins a line.
    fn match_edges<'e>(
        &mut self,
        limits: &Limits,
        candidates: &[Candidate],
        edges: impl Iterator<Item = &'e Edge>,
        polarity: Polarity,
    ) {
        let lines = |state| {
            let among = move |candidate: &&Candidate| candidate.state == state && candidate.polarity == polarity;
            candidates.iter().filter(among).map(|candidate| (candidate.prediction, candidate.slot))
        };
        let mut confirmed = Sweep::over(lines(State::Confirmed));
        let mut tentative = Sweep::over(lines(State::Tentative));
        let last = |settled, tracker: &mut Self| match settled {
            Settled::Joined(pair) => tracker.join(&pair, limits),
            Settled::Alone(edge) => tracker.begin(edge),
        };
        let mut first = |settled, tracker: &mut Self| match settled {
            Settled::Joined(pair) => tracker.join(&pair, limits),
            Settled::Alone(edge) => tentative.edge(edge, &mut |settled| last(settled, tracker)),
        };
        for edge in edges {
            confirmed.edge(*edge, &mut |settled| first(settled, self));
        }
        confirmed.finish(&mut |settled| first(settled, self));
        tentative.finish(&mut |settled| last(settled, self));
    }

    fn join(&mut self, pair: &Pair, limits: &Limits) {
        let taken = match self.tracks.get_mut(pair.slot) {
            Some(Some(track)) => track.take(pair.edge, limits),
            _ => false,
        };
        if !taken {
            self.begin(pair.edge);
        }
    }

    /// Begins a tentative line, if there is room.
    fn begin(&mut self, edge: Edge) {
        match self.tracks.iter_mut().find(|track| track.is_none()) {
            Some(free) => *free = Some(Track::new(edge)),
            None => self.counters.dropped_lines = self.counters.dropped_lines.saturating_add(1),
        }
    }

    fn count_missed(&mut self, limits: &Limits, row: u16) {
        for slot in &mut self.tracks {
            let Some(track) = slot else { continue };
            if track.state == State::Ended || track.line.last().row == row {
                continue;
            }
            track.missed_rows = track.missed_rows.saturating_add(1);
            let gap = if track.state == State::Confirmed { limits.gap_rows } else { limits.tentative_gap_rows };
            if track.missed_rows > gap {
                finish(slot, &mut self.counters);
            }
        }
    }
}

impl<const LINES: usize, const KNOTS: usize> Default for Tracker<LINES, KNOTS> {
    fn default() -> Self {
        Self::new()
    }
}

fn is_in<const KNOTS: usize>(track: &Option<Track<KNOTS>>, state: State) -> bool {
    track.as_ref().is_some_and(|track| track.state == state)
}

/// Ends a confirmed line and drops a tentative one.
fn finish<const KNOTS: usize>(slot: &mut Option<Track<KNOTS>>, counters: &mut Counters) {
    match slot {
        Some(track) if track.state == State::Tentative => {
            counters.stray_edges = counters.stray_edges.saturating_add(u32::from(track.line.edges()));
            *slot = None;
        }
        Some(track) => track.state = State::Ended,
        None => {}
    }
}
