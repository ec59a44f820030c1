//! [`Ranger`]: edges in, ranges out, frame by frame.

use heapless::Vec;

use crate::{Counters, Edge, EdgeError, Motion, Range, Scalar, Setup, Tracker};

/// The whole way from edges to ranges: at most `LINES` lines of `KNOTS` knots under way and `EDGES` edges on one row.
///
/// Glue only: it checks the edges, collects those of a row in the order of their columns, hands them to the
/// [`Tracker`] and ranges the lines that end. It holds tables and no parameters, so that it can be a `static`.
///
/// *Memory*: at most `LINES` × (120 + 40 `KNOTS`) + 24 `EDGES` + 64 bytes.
///
/// ```
/// # use shutter_range::{Camera, Distortion, Edge, Intrinsics, Limits, Ranger, RangeStatus, Readout, Setup, Twist, Uncertainty};
/// # let camera = Camera::new(Intrinsics::centred(640, 480, 600.0_f32), Distortion::NONE)?;
/// # let readout = Readout::from_frame_readout_ns(480, 33_300_000, Default::default())?;
/// # let setup = Setup::new(camera, readout, Uncertainty::NONE, Limits::DEFAULT)?;
/// let motion = Twist::level([-1.5, 0.0, 0.0])?;
/// let mut ranger: Ranger<16, 16, 32> = Ranger::new();
/// for row in 0..480 {
///     let time_ns = setup.readout().row_time_ns(row);
///     let column_px = 200.0 + 600.0 * 1.5 / 2.5 * time_ns as f64 * 1e-9; // a post 2.5 m away
///     ranger.edge(&setup, Edge::new(row, (column_px * 65536.0) as i32, time_ns))?;
/// }
/// ranger.end_frame(&setup);
/// let range = ranger.next_range(&setup, &motion).expect("one line");
/// assert_eq!(range.status, RangeStatus::Ok);
/// let (depth_m, sigma_m) = range.depth(2.0).estimate_m.expect("status is ok");
/// assert!((depth_m - 2.5).abs() < 0.001 && sigma_m < 0.01);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Ranger<const LINES: usize, const KNOTS: usize, const EDGES: usize> {
    tracker: Tracker<LINES, KNOTS>,
    /// Edges of the row under way, by column.
    row: Vec<Edge, EDGES>,
    last: Option<LastRow>,
}

/// The row that came last, and its latest time.
#[derive(Clone, Copy, Debug)]
struct LastRow {
    row: u16,
    time_ns: i64,
}

impl<const LINES: usize, const KNOTS: usize, const EDGES: usize> Ranger<LINES, KNOTS, EDGES> {
    /// A ranger with empty tables.
    #[must_use]
    pub const fn new() -> Self {
        Self { tracker: Tracker::new(), row: Vec::new(), last: None }
    }

    /// Takes one edge. Rows come in the order of readout, each row's edges in any order; the row is complete when an
    /// edge of another one comes.
    ///
    /// *Errors*: see [`EdgeError`]; a refused edge changes nothing. An edge for which the row's buffer has no room is
    /// no error: it is counted.
    pub fn edge<S: Scalar>(&mut self, setup: &Setup<S>, edge: Edge) -> Result<(), EdgeError> {
        self.check(setup, &edge)?;
        if self.last.is_some_and(|last| last.row != edge.row) {
            self.complete_row(setup);
        }
        let time_ns = self.last.map_or(edge.time_ns, |last| last.time_ns.max(edge.time_ns));
        self.last = Some(LastRow { row: edge.row, time_ns });
        let at = self.row.iter().take_while(|other| other.column_q16 <= edge.column_q16).count();
        if self.row.insert(at, edge).is_err() {
            self.tracker.count_dropped_edge();
        }
        Ok(())
    }

    /// Takes a row that was looked at and has no edges (more of them): lines that cross it have missed a row.
    ///
    /// *Errors*: [`EdgeError::RowOrder`] for a row that was read before the last one.
    pub fn end_row<S: Scalar>(&mut self, setup: &Setup<S>, row: u16) -> Result<(), EdgeError> {
        let time_ns = match self.last {
            Some(last) if last.row == row => last.time_ns,
            Some(last) => {
                check_order(setup, last.row, row)?;
                self.complete_row(setup);
                last.time_ns
            }
            None => i64::MIN,
        };
        self.last = Some(LastRow { row, time_ns });
        Ok(())
    }

    /// Ends the frame: every line under way is complete. The next edge begins a new frame.
    pub fn end_frame<S: Scalar>(&mut self, setup: &Setup<S>) {
        if self.last.is_some() {
            self.complete_row(setup);
        }
        self.tracker.end_frame();
        self.last = None;
    }

    /// The next range of those that are ready, in the order of the lines' places in the table. Ask until there is none
    /// after each row or frame: lines that nobody takes keep their places.
    pub fn next_range<S: Scalar, M: Motion<S>>(&mut self, setup: &Setup<S>, motion: &M) -> Option<Range<S>> {
        self.tracker.next_line().map(|line| Range::of_line(setup, motion, &line))
    }

    /// All ranges that are ready, from left to right.
    #[cfg(feature = "std")]
    pub fn ranges<S: Scalar, M: Motion<S>>(&mut self, setup: &Setup<S>, motion: &M) -> std::vec::Vec<Range<S>> {
        let mut ranges: std::vec::Vec<_> = core::iter::from_fn(|| self.next_range(setup, motion)).collect();
        ranges.sort_by(|a, b| {
            a.column_at_first_row.partial_cmp(&b.column_at_first_row).unwrap_or(core::cmp::Ordering::Equal)
        });
        ranges
    }

    /// What was dropped since the ranger was made.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        self.tracker.counters()
    }

    fn complete_row<S: Scalar>(&mut self, setup: &Setup<S>) {
        if let Some(last) = self.last {
            self.tracker.row(setup.limits(), last.row, &self.row);
        }
        self.row.clear();
    }

    fn check<S: Scalar>(&self, setup: &Setup<S>, edge: &Edge) -> Result<(), EdgeError> {
        const HOUR_NS: i64 = 3_600_000_000_000;
        let Edge { row, column_q16, time_ns, .. } = *edge;
        if !setup.camera().contains(column_q16, row) {
            return Err(EdgeError::OutsideImage { row, column_q16 });
        }
        if edge.sigma_q16 == 0 {
            return Err(EdgeError::ZeroSigma { row });
        }
        if !(-HOUR_NS..=HOUR_NS).contains(&time_ns) {
            return Err(EdgeError::TimeRange { time_ns });
        }
        let Some(last) = self.last else {
            return Ok(());
        };
        if last.row == row {
            let twice = self.row.iter().any(|other| other.column_q16 == column_q16);
            return if twice { Err(EdgeError::Duplicate { row, column_q16 }) } else { Ok(()) };
        }
        check_order(setup, last.row, row)?;
        if time_ns < last.time_ns {
            return Err(EdgeError::TimeOrder { time_ns, previous_ns: last.time_ns });
        }
        Ok(())
    }
}

fn check_order<S: Scalar>(setup: &Setup<S>, previous: u16, row: u16) -> Result<(), EdgeError> {
    let readout = setup.readout();
    if row < readout.rows() && readout.rows_before(row) > readout.rows_before(previous) {
        Ok(())
    } else {
        Err(EdgeError::RowOrder { row, previous })
    }
}

impl<const LINES: usize, const KNOTS: usize, const EDGES: usize> Default for Ranger<LINES, KNOTS, EDGES> {
    fn default() -> Self {
        Self::new()
    }
}
