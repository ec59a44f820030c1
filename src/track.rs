//! [`Tracker`]: from a stream of edges in row order to lines.

use core::iter::Peekable;

use heapless::Vec;

use crate::profile::{Neighbours, Profile};
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
/// *Cost*: per row an insertion sort of the lines, which hardly change places, and for each polarity a sweep over edges and
/// lines together.
#[derive(Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tracker<const LINES: usize, const KNOTS: usize> {
    tracks: [Option<Track<KNOTS>>; LINES],
    counters: Counters,
    /// Places of the lines under way and of those that wait to be taken.
    under_way: Vec<u16, LINES>,
    ended: Vec<u16, LINES>,
    /// No place before this one is free.
    occupied: usize,
}

#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Track<const KNOTS: usize> {
    line: Line<KNOTS>,
    state: State,
    /// Filtered column at the last edge's row, in 1/65536 px.
    column_q16: i64,
    /// Filtered slope in 1/65536 px per row of readout.
    slope_q16: i32,
    /// What the edge looks like, once it is confirmed and there are pixels to tell.
    profile: Option<Profile>,
    missed_rows: u16,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
enum State {
    Tentative,
    Confirmed,
}

/// The filter's gain falls with the number of edges down to this one's, so that it can follow a curve.
const MEMORY_EDGES: i64 = 64;
/// No gate is wider.
const MAX_GATE_Q16: i64 = 48 << 16;

impl<const KNOTS: usize> Track<KNOTS> {
    fn new(edge: Edge) -> Self {
        Self {
            line: Line::new(edge),
            state: State::Tentative,
            column_q16: i64::from(edge.column_q16),
            slope_q16: 0,
            profile: None,
            missed_rows: 0,
        }
    }

    /// Where the line should cross `row`, and how far off an edge there may lie.
    fn predict(&self, row: u16, limits: &Limits) -> Prediction {
        let rows = i64::from(row.abs_diff(self.line.last().row));
        let edges = i64::from(self.line.edges()).clamp(1, MEMORY_EDGES);
        // What the slope may still be off: everything after one edge, ever less after.
        let slope_q16 = i64::from(limits.max_slope_q16) / (edges * edges);
        let noise_q16 = 4 * i64::from(self.line.last().sigma_q16.min(1 << 24));
        // The better a line is known, the less an edge may miss it.
        let base_q16 = i64::from(limits.gate_q16) * 8 / edges.max(8);
        let gate_q16 = base_q16 + noise_q16 + slope_q16 * rows;
        let column_q16 = self.column_q16 + i64::from(self.slope_q16) * rows;
        Prediction { column_q16, gate_q16: gate_q16.min(MAX_GATE_Q16), coasting: false }
    }

    /// Counts a row without an edge.
    fn has_missed_too_many(&mut self, limits: &Limits, row: u16) -> bool {
        if self.line.last().row == row {
            return false;
        }
        self.missed_rows = self.missed_rows.saturating_add(1);
        // The longer a line has been, the longer it may be hidden.
        let gap = match self.state {
            State::Tentative => limits.tentative_gap_rows,
            State::Confirmed => limits.gap_rows.saturating_add(self.line.edges() / 2),
        };
        self.missed_rows > gap
    }

    /// Four sigma of the noise, or two of the blur.
    fn blur_q16(&self) -> i64 {
        let last = self.line.last();
        (4 * i64::from(last.sigma_q16)).max(i64::from(last.width_q8) << 9)
    }

    /// Takes an edge that matches: a line fit with fading memory, updated edge by edge.
    fn take(&mut self, edge: Edge, limits: &Limits) -> bool {
        let rows = i64::from(edge.row.abs_diff(self.line.last().row));
        if self.line.push(edge).is_err() {
            return false;
        }
        let n = i64::from(self.line.edges()).min(MEMORY_EDGES);
        let predicted = self.column_q16 + i64::from(self.slope_q16) * rows;
        let off = i64::from(edge.column_q16) - predicted;
        let count = n * (n + 1);
        self.column_q16 = predicted + off * (4 * n - 2) / count.max(1);
        let slope = i64::from(self.slope_q16) + 6 * off / (count * rows).max(1);
        self.slope_q16 = slope.clamp(-(1 << 30), 1 << 30) as i32;
        self.missed_rows = 0;
        if self.line.edges() >= limits.confirm_edges {
            self.state = State::Confirmed;
        }
        true
    }
}

impl<const KNOTS: usize> Track<KNOTS> {
    /// The edge in a row of pixels, from its profile.
    fn locate(&mut self, prediction: &Prediction, at: RowTime, pixels: &[u8], around: Neighbours) -> Option<Edge> {
        let profile = self.profile.as_mut()?;
        let found = profile.locate(pixels, prediction.column_q16, prediction.gate_q16, around)?;
        Some(found.at(at.row, at.time_ns))
    }
}

/// A row and the middle of its exposure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowTime {
    pub(crate) row: u16,
    pub(crate) time_ns: i64,
}

/// Where a line has been found: edges of its polarity near there are its own.
struct Explained {
    column_q16: i64,
    reach_q16: i64,
    polarity: Polarity,
}

/// Most that [`Explained::reach_q16`] can be.
const MAX_REACH_Q16: i64 = 34 << 16;

#[derive(Clone, Copy)]
struct Prediction {
    column_q16: i64,
    gate_q16: i64,
    /// So near to another line of its kind that an edge there could be of either: it takes none.
    coasting: bool,
}

/// A line under way, as a row sees it.
struct Candidate {
    prediction: Prediction,
    slot: usize,
    state: State,
    polarity: Polarity,
    /// Within this distance two edges cannot be told apart: by their noise, or their blur.
    blur_q16: i64,
}

/// A line or an edge on the way from left to right.
#[derive(Clone, Copy)]
enum Item {
    Edge(Edge),
    Line { slot: usize, gate_q16: i64, coasting: bool },
}

/// An edge and a line that may belong together.
#[derive(Clone, Copy)]
struct Pair {
    edge: Edge,
    slot: usize,
    distance_q16: i64,
    coasting: bool,
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
            self.advance(Some(item_of(&line, slot)), settle);
        }
        self.advance(Some((column, Item::Edge(edge))), settle);
    }

    fn finish(mut self, settle: &mut impl FnMut(Settled)) {
        while let Some((line, slot)) = self.lines.next() {
            self.advance(Some(item_of(&line, slot)), settle);
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

fn item_of(line: &Prediction, slot: usize) -> (i64, Item) {
    (line.column_q16, Item::Line { slot, gate_q16: line.gate_q16, coasting: line.coasting })
}

/// An edge and a line within the line's gate.
fn pair_up(left: (i64, Item), right: (i64, Item)) -> Option<Pair> {
    let distance_q16 = right.0 - left.0;
    match (left.1, right.1) {
        (Item::Edge(edge), Item::Line { slot, gate_q16, coasting })
        | (Item::Line { slot, gate_q16, coasting }, Item::Edge(edge)) => {
            (distance_q16 <= gate_q16).then_some(Pair { edge, slot, distance_q16, coasting })
        }
        _ => None,
    }
}

impl<const LINES: usize, const KNOTS: usize> Tracker<LINES, KNOTS> {
    /// An empty tracker.
    #[must_use]
    pub const fn new() -> Self {
        let counters = Counters { dropped_edges: 0, dropped_lines: 0, stray_edges: 0 };
        const { assert!(LINES > 0 && LINES < u16::MAX as usize, "1 to 65534 lines") };
        let tracks = [const { None }; LINES];
        Self { tracks, counters, under_way: Vec::new(), ended: Vec::new(), occupied: 0 }
    }

    /// Takes all edges of one row, sorted by column. Rows come in the order of readout; rows that were not looked at may
    /// be left out, rows without edges should be given, since lines end by missing rows.
    pub fn row(&mut self, limits: &Limits, row: u16, edges: &[Edge]) {
        self.occupied = 0;
        let mut predictions = Vec::new();
        self.predict(limits, row, &mut predictions);
        for polarity in [Polarity::Rising, Polarity::Falling, Polarity::Unknown] {
            self.match_edges(limits, &predictions, edges.iter().filter(|edge| edge.polarity == polarity), polarity);
        }
        self.count_missed(limits, row);
    }

    /// Looks for the confirmed lines where they are expected in a row of pixels, and takes the edges that this explains out
    /// of those that the row shows on its own. To be called before [`Tracker::row`] takes the rest.
    pub(crate) fn refine<const EDGES: usize>(
        &mut self,
        limits: &Limits,
        at: RowTime,
        pixels: &[u8],
        edges: &mut Vec<Edge, EDGES>,
    ) {
        let mut explained: Vec<Explained, LINES> = Vec::new();
        // Tentative lines are noise as often as not: they must not narrow a confirmed line's view.
        let mut candidates: Vec<Candidate, LINES> = Vec::new();
        self.predict(limits, at.row, &mut candidates);
        candidates.retain(|candidate| candidate.state == State::Confirmed);
        for (index, candidate) in candidates.iter().enumerate() {
            let Some(Some(track)) = self.tracks.get_mut(candidate.slot).filter(|_| !candidate.prediction.coasting)
            else {
                continue;
            };
            let column = |other: Option<&Candidate>| other.map(|other| other.prediction.column_q16);
            let around = Neighbours {
                left_q16: column(index.checked_sub(1).and_then(|i| candidates.get(i)))
                    .unwrap_or(Neighbours::NONE.left_q16),
                right_q16: column(candidates.get(index + 1)).unwrap_or(Neighbours::NONE.right_q16),
            };
            if let Some(edge) = track.locate(&candidate.prediction, at, pixels, around) {
                let reach_q16 = (5 << 16) / 2 + i64::from(edge.width_q8) * 640;
                if track.take(edge, limits) {
                    let (column_q16, polarity) = (i64::from(edge.column_q16), edge.polarity);
                    // One per line at most.
                    let at = explained.partition_point(|other| other.column_q16 <= column_q16);
                    let _ = explained.insert(at, Explained { column_q16, reach_q16, polarity });
                }
            }
        }
        let mut nearby = 0;
        edges.retain(|edge| {
            let column = i64::from(edge.column_q16);
            nearby += explained.iter().skip(nearby).take_while(|e| e.column_q16 + MAX_REACH_Q16 < column).count();
            !explained
                .iter()
                .skip(nearby)
                .take_while(|e| e.column_q16 - MAX_REACH_Q16 <= column)
                .any(|e| e.polarity == edge.polarity && (e.column_q16 - column).abs() <= e.reach_q16)
        });
    }

    /// Learns what newly confirmed lines look like from the row that they were last seen in.
    pub(crate) fn learn(&mut self, row: u16, pixels: &[u8], noise_q8: u32) {
        for place in &self.under_way {
            let Some(Some(track)) = self.tracks.get_mut(usize::from(*place)) else { continue };
            if track.state == State::Confirmed && track.profile.is_none() && track.line.last().row == row {
                track.profile = Profile::new(pixels, track.line.last(), Neighbours::NONE, noise_q8);
            }
        }
    }

    /// Forgets all lines under way, counting their edges as stray: the frame is torn.
    pub(crate) fn abandon(&mut self) {
        for place in &self.under_way {
            if let Some(slot) = self.tracks.get_mut(usize::from(*place)) {
                let edges = slot.take().map_or(0, |track| track.line.edges());
                self.counters.stray_edges = self.counters.stray_edges.saturating_add(u32::from(edges));
            }
        }
        self.under_way.clear();
    }

    /// Ends all confirmed lines and forgets the tentative ones.
    pub fn end_frame(&mut self) {
        while let Some(place) = self.under_way.pop() {
            self.finish(place);
        }
    }

    /// A line that has ended, in no particular order. Take them after every row, or their places stay occupied.
    pub fn next_line(&mut self) -> Option<Line<KNOTS>> {
        let place = self.ended.pop()?;
        self.tracks.get_mut(usize::from(place))?.take().map(|track| track.line)
    }

    /// What was dropped since the tracker was made.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    pub(crate) fn count_dropped_edge(&mut self) {
        self.counters.dropped_edges = self.counters.dropped_edges.saturating_add(1);
    }

    /// Predictions of all lines under way that the row has not shown yet, from left to right.
    fn predict(&mut self, limits: &Limits, row: u16, predictions: &mut Vec<Candidate, LINES>) {
        for place in &self.under_way {
            let slot = usize::from(*place);
            let track = self.tracks.get(slot).and_then(Option::as_ref);
            // One per slot at most.
            if let Some(track) = track.filter(|track| track.line.last().row != row) {
                let (state, polarity) = (track.state, track.line.first().polarity);
                let (prediction, blur_q16) = (track.predict(row, limits), track.blur_q16());
                let at = predictions.partition_point(|other| other.prediction.column_q16 <= prediction.column_q16);
                let _ = predictions.insert(at, Candidate { prediction, slot, state, polarity, blur_q16 });
            }
        }
        // Lines hardly change places: the next row finds them almost in order.
        let order = predictions.iter().map(|candidate| candidate.slot as u16);
        if predictions.len() == self.under_way.len() {
            self.under_way.iter_mut().zip(order).for_each(|(place, slot)| *place = slot);
        }
        let mut rest: &mut [Candidate] = predictions;
        while let Some((first, others)) = rest.split_first_mut() {
            if let Some(second) =
                others.iter_mut().find(|other| other.state == first.state && other.polarity == first.polarity)
            {
                let near_q16 = first.blur_q16.max(second.blur_q16);
                let apart_q16 = second.prediction.column_q16 - first.prediction.column_q16;
                if first.state == State::Confirmed && apart_q16 < near_q16 {
                    first.prediction.coasting = true;
                    second.prediction.coasting = true;
                }
            }
            rest = others;
        }
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
        if pair.coasting {
            return;
        }
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
        let free = self.tracks.iter_mut().enumerate().skip(self.occupied).find(|(_, track)| track.is_none());
        match free {
            Some((slot, free)) => {
                *free = Some(Track::new(edge));
                self.occupied = slot + 1;
                // A place for each slot.
                let _ = self.under_way.push(slot as u16);
            }
            None => {
                self.occupied = LINES;
                self.counters.dropped_lines = self.counters.dropped_lines.saturating_add(1);
            }
        }
    }

    fn count_missed(&mut self, limits: &Limits, row: u16) {
        let mut index = 0;
        while let Some(place) = self.under_way.get(index).copied() {
            let track = self.tracks.get_mut(usize::from(place)).and_then(Option::as_mut);
            if track.is_some_and(|track| track.has_missed_too_many(limits, row)) {
                self.under_way.swap_remove(index);
                self.finish(place);
            } else {
                index += 1;
            }
        }
    }

    /// Ends a confirmed line and drops a tentative one.
    fn finish(&mut self, place: u16) {
        let Some(slot) = self.tracks.get_mut(usize::from(place)) else { return };
        if slot.as_ref().is_some_and(|track| track.state == State::Confirmed) {
            // A place for each slot.
            let _ = self.ended.push(place);
        } else {
            let edges = slot.take().map_or(0, |track| track.line.edges());
            self.counters.stray_edges = self.counters.stray_edges.saturating_add(u32::from(edges));
        }
    }
}

impl<const LINES: usize, const KNOTS: usize> Default for Tracker<LINES, KNOTS> {
    fn default() -> Self {
        Self::new()
    }
}
