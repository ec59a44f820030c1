//! [`Tracker`]: from a stream of edges in row order to lines.

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

/// A line or an edge on the way from left to right.
#[derive(Clone, Copy)]
enum Item {
    Edge(Edge),
    Line { slot: usize, gate_q16: i64 },
}

/// The sweep's memory for one polarity.
#[derive(Clone, Copy)]
struct Sweep {
    /// The item before, if it is not yet settled.
    previous: Option<(i64, Item)>,
    /// The pair that the item before forms with the one before it, if any: edge, slot and distance.
    pair: Option<(Edge, usize, i64)>,
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
        let mut sweeps = [Sweep { previous: None, pair: None }; 3];
        let mut lines = predictions.iter().peekable();
        for edge in edges {
            let column = i64::from(edge.column_q16);
            while let Some((prediction, slot)) = lines.next_if(|(line, _)| line.column_q16 <= column) {
                self.sweep_line(&mut sweeps, prediction, *slot, limits);
            }
            self.advance(&mut sweeps, edge.polarity, Some((column, Item::Edge(*edge))), limits);
        }
        for (prediction, slot) in lines {
            self.sweep_line(&mut sweeps, prediction, *slot, limits);
        }
        for polarity in [Polarity::Rising, Polarity::Falling, Polarity::Unknown] {
            self.advance(&mut sweeps, polarity, None, limits);
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
    fn predictions(&self, limits: &Limits, row: u16) -> Vec<(Prediction, usize), LINES> {
        let mut predictions: Vec<_, LINES> = Vec::new();
        for (slot, track) in self.tracks.iter().enumerate() {
            // One per slot at most.
            if let Some(track) = track.as_ref().filter(|track| track.state != State::Ended) {
                let _ = predictions.push((track.predict(row, limits), slot));
            }
        }
        predictions.sort_unstable_by_key(|(prediction, _)| prediction.column_q16);
        predictions
    }

    fn sweep_line(&mut self, sweeps: &mut [Sweep; 3], prediction: &Prediction, slot: usize, limits: &Limits) {
        if let Some(track) = self.tracks.get(slot).and_then(Option::as_ref) {
            let item = Item::Line { slot, gate_q16: prediction.gate_q16 };
            self.advance(sweeps, track.line.first().polarity, Some((prediction.column_q16, item)), limits);
        }
    }

    /// Moves the sweep of one polarity to the next item. Two neighbours of different kind are a pair unless one of them
    /// is nearer to its neighbour on the other side.
    fn advance(&mut self, sweeps: &mut [Sweep; 3], polarity: Polarity, next: Option<(i64, Item)>, limits: &Limits) {
        let [rising, falling, unknown] = sweeps;
        let sweep = match polarity {
            Polarity::Rising => rising,
            Polarity::Falling => falling,
            Polarity::Unknown => unknown,
        };
        let pair = match (sweep.previous, next) {
            (Some(left), Some(right)) => pair_up(left, right),
            _ => None,
        };
        let nearer = match (&sweep.pair, &pair) {
            (Some((_, _, before)), Some((_, _, now))) => now < before,
            (None, Some(_)) => true,
            (_, None) => false,
        };
        match (sweep.pair.take(), sweep.previous.take()) {
            // The item before leaves its partner for the nearer one; a partner that is an edge stays alone.
            (Some((edge, _, _)), Some((_, Item::Line { .. }))) if nearer => self.begin(edge),
            (Some(_), _) if nearer => {}
            (Some((edge, slot, _)), _) => self.join(edge, slot, limits),
            (None, Some((_, Item::Edge(edge)))) if !nearer => self.begin(edge),
            (None, _) => {}
        }
        sweep.pair = if nearer { pair } else { None };
        sweep.previous = next;
    }

    fn join(&mut self, edge: Edge, slot: usize, limits: &Limits) {
        let taken = match self.tracks.get_mut(slot) {
            Some(Some(track)) => track.take(edge, limits),
            _ => false,
        };
        if !taken {
            self.begin(edge);
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

/// An edge and a line within the line's gate.
fn pair_up(left: (i64, Item), right: (i64, Item)) -> Option<(Edge, usize, i64)> {
    let distance = right.0 - left.0;
    match (left.1, right.1) {
        (Item::Edge(edge), Item::Line { slot, gate_q16 }) | (Item::Line { slot, gate_q16 }, Item::Edge(edge)) => {
            (distance <= gate_q16).then_some((edge, slot, distance))
        }
        _ => None,
    }
}
