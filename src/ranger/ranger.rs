//! [`Ranger`]: rows of pixels or edge points in, ranges out, frame by frame.

use heapless::Vec;

use super::frame::Frame;
use crate::edge::{EdgePoint, Scanner};
use crate::line::{Counters, Line, Repair, Repaired, Strict, Tracker};
use crate::motion::Motion;
use crate::range::Range;
use crate::scalar::Scalar;
use crate::setup::Setup;

/// The whole way from rows to ranges: at most `LINES` lines of `KNOTS` knots, and `POINTS` edge points on one row.
///
/// A pipeline without mathematics of its own: it checks what comes in, finds the edge points of rows of pixels, tracks
/// them to lines and ranges the lines that end. It holds tables and no parameters.
///
/// An empty ranger is all zero bits. Make it a `static`: it then lies in memory that is zeroed at reset and takes no
/// flash. A safe `&'static mut` to it comes from `cortex-m-rt`, whose `#[entry]` function may have a `static mut` of
/// its own (`examples/no_panic.rs`), or from `ConstStaticCell` of the crate `static_cell`:
///
/// ```ignore
/// static RANGER: ConstStaticCell<BoardRanger> = ConstStaticCell::new(BoardRanger::new());
/// let ranger = RANGER.take();
/// ```
///
/// *Memory*: at most `LINES` × (176 + 40 `KNOTS`) + 24 `POINTS` + 256 bytes.
///
/// ```
/// # use shutter_range::{EdgePoint, Ranger, RangeStatus, Setup, Sigmas, Twist, Uncertainty};
/// # let setup = Setup::pinhole(640, 480, 600.0_f32, 33_300_000)?.with_uncertainty(Uncertainty::NONE)?;
/// let motion = Twist::level([-1.5, 0.0, 0.0])?;
/// let mut ranger: Ranger<16, 16, 32> = Ranger::new();
/// for row in 0..480 {
///     let time_ns = setup.readout().row_time_ns(row);
///     let column_px = 200.0 + 600.0 * 1.5 / 2.5 * time_ns as f64 * 1e-9; // a post 2.5 m away
///     ranger.edge_point(&setup, EdgePoint::new(row, (column_px * 65536.0) as i32, time_ns))?;
/// }
/// ranger.end_frame(&setup);
/// let range = ranger.next_range(&setup, &motion).expect("one line");
/// assert_eq!(range.status, RangeStatus::Ok);
/// let (depth_m, sigma_m) = range.depth(Sigmas(2.0)).estimate_m.expect("status is ok");
/// assert!((depth_m - 2.5).abs() < 0.001 && sigma_m < 0.01);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ranger<const LINES: usize, const KNOTS: usize, const POINTS: usize, R = Repaired> {
    pub(super) tracker: Tracker<LINES, KNOTS, R>,
    /// Edge points of the row under way, by column.
    pub(super) points: Vec<EdgePoint, POINTS>,
    pub(super) scanner: Scanner,
    pub(super) frame: Frame,
}

/// For a small board: 8 lines, 16 edge points a row. 4.6 kB.
pub type SmallRanger = Ranger<8, 8, 16>;

/// For a vision board: 16 lines, 32 edge points a row. 11.5 kB.
pub type BoardRanger = Ranger<16, 12, 32>;

/// For a desktop: 256 lines, 4096 edge points a row. 0.8 MB: make it in a `static`, or box it.
pub type DesktopRanger = Ranger<256, 64, 4096>;

impl<const LINES: usize, const KNOTS: usize, const POINTS: usize> Ranger<LINES, KNOTS, POINTS> {
    /// A ranger with empty tables: all zero bits, so that a `static` one takes no flash.
    #[must_use]
    pub const fn new() -> Self {
        Self::empty()
    }
}

impl<const LINES: usize, const KNOTS: usize, const POINTS: usize> Ranger<LINES, KNOTS, POINTS, Strict> {
    /// The same for a program that is to be small: see [`Strict`].
    #[must_use]
    pub const fn strict() -> Self {
        Self::empty()
    }
}

impl<const LINES: usize, const KNOTS: usize, const POINTS: usize, R: Repair> Ranger<LINES, KNOTS, POINTS, R> {
    const fn empty() -> Self {
        Self { tracker: Tracker::new(), points: Vec::new(), scanner: Scanner::new(), frame: Frame::Started }
    }

    /// Gives the frame up: the lines under way are forgotten, and rows and points are refused until
    /// [`Ranger::end_frame`]. For drivers that notice a lost line or an overrun themselves.
    pub fn tear(&mut self) {
        self.frame = Frame::Torn;
        self.tracker.counters_mut().count_points(self.points.len() as u32);
        self.tracker.counters_mut().count_stray(self.points.len() as u32);
        self.points.clear();
        self.tracker.abandon();
    }

    /// Whether the frame under way is torn.
    #[must_use]
    pub const fn is_torn(&self) -> bool {
        matches!(self.frame, Frame::Torn)
    }

    /// Ends the frame: every line under way is complete. What comes next begins a new frame. Where its last row of edge
    /// points shows that the frame is torn, it has no lines.
    pub fn end_frame<S: Scalar>(&mut self, setup: &Setup<S>) {
        // A frame that is found torn by its last row has no lines left.
        let _ = self.complete_row(setup);
        self.tracker.end_frame();
        self.frame = Frame::Started;
    }

    /// The next range of those that are ready, in no particular order. Ask until there is none
    /// after each row or frame: lines that nobody takes keep their places.
    ///
    /// *Cost*: that of [`Range::from_line`]; and, once for each line that has ended, some passes over its knots to see
    /// where it is to be split.
    pub fn next_range<S: Scalar, M: Motion<S>>(&mut self, setup: &Setup<S>, motion: &M) -> Option<Range<S>> {
        let range = self.placed_line().map(|(_, line)| Range::from_line(setup, motion, line));
        self.leave_line();
        range
    }

    /// The next line of those that are ready, for those who range it themselves.
    pub fn next_line(&mut self) -> Option<Line<KNOTS>> {
        self.tracker.split_ended();
        self.tracker.next_line()
    }

    /// The line that [`next_line`](Self::next_line) would take, in its place in the table: there it needs no other
    /// room.
    pub(crate) fn placed_line(&mut self) -> Option<(usize, &Line<KNOTS>)> {
        self.tracker.split_ended();
        let place = self.tracker.ended().next_back()?;
        Some((place, self.tracker.line_at(place)?))
    }

    /// Gives up that line.
    pub(crate) fn leave_line(&mut self) {
        let _ = self.tracker.next_line();
    }

    /// The places of the lines that are ready.
    pub(crate) fn places(&self) -> impl Iterator<Item = usize> + Clone {
        self.tracker.ended()
    }

    pub(crate) fn line_at(&self, place: usize) -> Option<&Line<KNOTS>> {
        self.tracker.line_at(place)
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

    /// What came in and what was lost since the ranger was made.
    #[must_use]
    pub const fn counters(&self) -> &Counters {
        self.tracker.counters()
    }
}

impl<const LINES: usize, const KNOTS: usize, const POINTS: usize> Default for Ranger<LINES, KNOTS, POINTS> {
    fn default() -> Self {
        Self::new()
    }
}
