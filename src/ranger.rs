//! [`Ranger`]: rows of pixels or edge points in, ranges out, frame by frame.

use heapless::Vec;

use crate::edge::{EdgeModel, EdgePoint, Neighbours, PixelRow, Scanner};
use crate::error::{EdgeError, RowError};
use crate::format::Pixels;
use crate::line::{
    Candidates, Counters, Flanks, Line, Repair, Repaired, RowClock, RowTime, Strict, Tracker, looks, looks_beside,
    looks_for_halo, looks_for_new,
};
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
/// *Memory*: at most `LINES` × (176 + 40 `KNOTS`) + 24 `POINTS` + 248 bytes.
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
    tracker: Tracker<LINES, KNOTS, R>,
    /// Edge points of the row under way, by column.
    row: Vec<EdgePoint, POINTS>,
    scanner: Scanner,
    frame: Frame,
}

/// For a small board: 8 lines, 16 edge points a row. 4.6 kB.
pub type SmallRanger = Ranger<8, 8, 16>;

/// For a vision board: 16 lines, 32 edge points a row. 11.4 kB.
pub type BoardRanger = Ranger<16, 12, 32>;

/// For a desktop: 256 lines, 4096 edge points a row. 0.8 MB: make it in a `static`, or box it.
pub type DesktopRanger = Ranger<256, 64, 4096>;

/// What the frame under way is made of. The tag is written out, and zero at first, as all else in an empty ranger.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
enum Frame {
    /// Nothing has come yet.
    Started = 0,
    /// Edge points; the row that came last.
    OfPoints(LastRow) = 1,
    /// Rows of pixels: how many of them, and whether the last one could not be read ([`Scanner::is_blinded`]).
    OfPixels { rows_read: u16, is_blinded: bool } = 2,
    /// Given up: nothing is taken until it ends.
    Torn = 3,
}

/// The row that came last, and its latest time.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct LastRow {
    row: u16,
    time_ns: i64,
    /// Its points have gone to the tracker.
    complete: bool,
    clock: RowClock,
}

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
        Self { tracker: Tracker::new(), row: Vec::new(), scanner: Scanner::new(), frame: Frame::Started }
    }

    /// Takes one edge point. Rows come in the order of readout, each row's points in any order; the row is complete
    /// when a point of another one comes.
    ///
    /// *Errors*: see [`EdgeError`]; a refused point changes nothing, but for [`EdgeError::Jump`], which tears the
    /// frame. A point for which the row's buffer has no room is no error: it is counted.
    ///
    /// *Cost*: a binary search in the row's points, and a move of those on the right of it.
    pub fn edge_point<S: Scalar>(&mut self, setup: &Setup<S>, point: EdgePoint) -> Result<(), EdgeError> {
        check_values(setup, &point)?;
        let (at, time_ns) = match &mut self.frame {
            Frame::OfPoints(last) if last.row == point.row && !last.complete => {
                let EdgePoint { row, column_q16, .. } = point;
                let at = match self.row.last() {
                    // Most come in the order of their columns.
                    Some(before) if before.column_q16 < column_q16 => None,
                    _ => match self.row.binary_search_by_key(&column_q16, |other| other.column_q16) {
                        Ok(_) => return Err(EdgeError::Duplicate { row, column_q16 }),
                        Err(at) => Some(at).filter(|at| *at < self.row.len()),
                    },
                };
                let was_irregular = last.clock.is_irregular;
                let time_ns = last.clock.time_ns(setup, row, point.time_ns)?;
                last.time_ns = last.time_ns.max(point.time_ns);
                if last.clock.is_irregular && !was_irregular {
                    self.tracker.retime(setup.readout());
                }
                (at, time_ns)
            }
            _ => (None, self.begin_row(setup, &point)?),
        };
        let point = EdgePoint { time_ns, ..point };
        let taken = match at {
            None => self.row.push(point),
            Some(at) => self.row.push(point).map(|()| {
                // `insert` may panic, for all the compiler sees.
                let mut moved = point;
                self.row.iter_mut().skip(at).for_each(|place| core::mem::swap(place, &mut moved));
            }),
        };
        if taken.is_err() {
            self.tracker.count_points(1);
            self.tracker.count_dropped_point();
        }
        Ok(())
    }

    /// Takes one row of pixels: bytes, dark 0 to bright 255, or any other [format](crate::format). Rows come in the
    /// order of readout, each once.
    ///
    /// *Errors*: [`RowError`]. A row that is missing, repeated or too short tears the frame: the lines under way are
    /// given up and further rows are refused until the next frame, since what looks like a sheared edge may be the
    /// tear. So do rows in which all edges have jumped ([`RowError::Jump`]), which is seen some rows later, or in which
    /// edges jump wherever the light changes. A row in a frame of edge points is refused and changes nothing.
    ///
    /// *Cost*: some three to six instructions a pixel and one to three thousand for each edge; docs/budget.md has
    /// them by board, and what texture and fences cost. A row does at most: one scan of each pixel; an association of
    /// each of `POINTS`; for each of `LINES` one look of its model; ten scanned points that are refined; three new
    /// models; and, where lines break off, comparisons with the square of `LINES`. What is left over has its turn in
    /// one of the next rows. Of more than 16 lines each may have one more point refined, of more than 48 each sixteenth
    /// a model.
    pub fn row<S: Scalar>(&mut self, setup: &Setup<S>, row: u16, pixels: impl Pixels) -> Result<(), RowError> {
        let was_blinded = self.begin_row_of_pixels(setup, row, pixels.columns())?;
        let looks_for_halo = looks_for_halo(row, setup.response());
        let at = RowTime { row, time_ns: setup.readout().row_time_ns(row), looks_for_halo };
        let (points, tracker) = (&mut self.row, &mut self.tracker);
        let dropped_points = tracker.counters().dropped_points;
        tracker.see_light(row, &pixels, || self.scanner.noise_q8());
        let pixel_row = PixelRow { pixels, response: setup.response() };
        let mut candidates = Candidates::new();
        let is_steady = tracker.locate(setup.limits(), at, pixel_row, &mut candidates);
        let (is_full, is_mosaic) = (tracker.is_full(), pixels.mosaic_row().is_some());
        let is_blinded = if is_steady && (is_full || !looks_for_new(row, is_mosaic)) {
            self.scanner.pass(pixels);
            // Asked only where it was so before: most rows can be read.
            was_blinded && self.scanner.is_blinded()
        } else {
            let (mut asked, mut flanks): (Vec<_, LINES>, _) = (Vec::new(), Flanks::new());
            tracker.add_flanks(row, &candidates, &mut flanks);
            if is_full {
                candidates.add_columns(&mut asked);
            }
            let asked = is_full.then_some(&asked[..]);
            self.scanner.scan_where(pixels, asked, &flanks, looks_beside(row, is_mosaic), |point| {
                if points.push(point.at(row, at.time_ns)).is_err() {
                    tracker.count_points(1);
                    tracker.count_dropped_point();
                }
            })
        };
        if let Frame::OfPixels { is_blinded: of_frame, .. } = &mut self.frame {
            *of_frame = is_blinded;
        }
        tracker.remove_explained(row, points);
        tracker.count_points(points.len() as u32);
        let scanner = &self.scanner;
        let refine =
            |point: &EdgePoint, looks: bool| refined(points, point, looks.then(|| (pixel_row, scanner.noise_q8())));
        let columns = setup.camera().intrinsics().columns;
        let is_as_before = is_steady && points.is_empty();
        let jump =
            if is_as_before { None } else { tracker.take(setup.limits(), columns, row, &candidates, points, &refine) };
        if is_full || is_blinded || tracker.counters().dropped_points != dropped_points {
            tracker.count_crowded_row();
        }
        if jump.is_none() && (!is_as_before || looks(row)) {
            tracker.look_at(row, pixel_row, scanner.noise_q8(), points);
        }
        points.clear();
        self.unless_torn(jump)
    }

    /// Takes one row of pixels as [`row`](Self::row), but finds edges by scanning alone: what no row shows on its own is
    /// not found, a point is as good as its row makes it, and edges within eight pixels draw each other aside.
    /// A program whose rows are all taken so holds no models of edges: 26 kB less flash on a Cortex-M0 (`scanned` beside `smallest` in docs/budget.md).
    ///
    /// What is around a line is not looked at, and so none is [`Cluttered`](crate::RangeStatus::Cluttered): in texture, lines
    /// may be there by chance. It is for edges before plain backgrounds.
    ///
    /// *Errors*: as [`row`](Self::row).
    pub fn scanned_row<S: Scalar>(&mut self, setup: &Setup<S>, row: u16, pixels: impl Pixels) -> Result<(), RowError> {
        self.begin_row_of_pixels(setup, row, pixels.columns())?;
        let time_ns = setup.readout().row_time_ns(row);
        let (points, tracker) = (&mut self.row, &mut self.tracker);
        let dropped_points = tracker.counters().dropped_points;
        tracker.see_light(row, &pixels, || self.scanner.noise_q8());
        let is_blinded = self.scanner.scan_where(pixels, None, &[], true, |point| {
            tracker.count_points(1);
            if points.push(point.at(row, time_ns)).is_err() {
                tracker.count_dropped_point();
            }
        });
        if is_blinded || tracker.counters().dropped_points != dropped_points {
            tracker.count_crowded_row();
        }
        let jump = tracker.row(setup.limits(), setup.camera().intrinsics().columns, row, points);
        points.clear();
        self.unless_torn(jump)
    }

    /// Tears the frame where all its lines jump at a row.
    fn unless_torn(&mut self, jump: Option<u16>) -> Result<(), RowError> {
        let Some(row) = jump else { return Ok(()) };
        self.tear();
        Err(RowError::Jump { row })
    }

    /// Checks that a row of so many pixels is the next one of the frame; what is not tears it. Whether the row before could
    /// not be read.
    fn begin_row_of_pixels<S: Scalar>(&mut self, setup: &Setup<S>, row: u16, pixels: usize) -> Result<bool, RowError> {
        let (rows_read, is_blinded) = match self.frame {
            Frame::Started => (0, false),
            Frame::OfPixels { rows_read, is_blinded } => (rows_read, is_blinded),
            Frame::OfPoints(_) => return Err(RowError::FrameOfPoints { row }),
            Frame::Torn => return Err(RowError::Torn),
        };
        if let Err(error) = check_pixels(setup, rows_read, row, pixels) {
            self.tear();
            return Err(error);
        }
        if rows_read == 0 {
            self.scanner.begin_frame();
        }
        self.frame = Frame::OfPixels { rows_read: rows_read + 1, is_blinded };
        Ok(is_blinded)
    }

    /// Gives the frame up: the lines under way are forgotten, and rows and points are refused until
    /// [`Ranger::end_frame`]. For drivers that notice a lost line or an overrun themselves.
    pub fn tear(&mut self) {
        self.frame = Frame::Torn;
        self.tracker.count_points(self.row.len() as u32);
        self.tracker.count_stray(self.row.len() as u32);
        self.row.clear();
        self.tracker.abandon();
    }

    /// Whether the frame under way is torn.
    #[must_use]
    pub const fn is_torn(&self) -> bool {
        matches!(self.frame, Frame::Torn)
    }

    /// Whether the stamps of the frame under way do not rise with its rows, so that the readout tells the time
    /// ([`StampPolicy::Checked`](crate::StampPolicy::Checked)).
    #[must_use]
    pub const fn has_irregular_stamps(&self) -> bool {
        matches!(self.frame, Frame::OfPoints(LastRow { clock: RowClock { is_irregular: true, .. }, .. }))
    }

    /// Takes a row that was looked at and has no edge points (more of them): lines that cross it have missed a row.
    ///
    /// *Errors*: [`EdgeError::RowOrder`] for a row that was read before the last one, and [`EdgeError::FrameOfPixels`]
    /// and [`EdgeError::Torn`] as for a point.
    pub fn end_row<S: Scalar>(&mut self, setup: &Setup<S>, row: u16) -> Result<(), EdgeError> {
        match self.last_row()? {
            Some(last) if last.row == row && !last.complete => {}
            last => {
                check_row_order(setup, last.map(|last| last.row), row)?;
                self.complete_row(setup)?;
                let begin = || RowClock::new(setup, row, setup.readout().row_time_ns(row));
                let (time_ns, clock) = last.map_or_else(|| (i64::MIN, begin()), |last| (last.time_ns, last.clock));
                self.frame = Frame::OfPoints(LastRow { row, time_ns, complete: false, clock });
            }
        }
        self.complete_row(setup)
    }

    /// Ends the frame: every line under way is complete. What comes next begins a new frame.
    pub fn end_frame<S: Scalar>(&mut self, setup: &Setup<S>) {
        // A frame that is found torn by its last row has no lines left.
        let _ = self.complete_row(setup);
        self.tracker.end_frame();
        self.frame = Frame::Started;
    }

    /// The next range of those that are ready, in the order of the lines' places in the table. Ask until there is none
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

    /// The last row of a frame of edge points, if one has come.
    fn last_row(&self) -> Result<Option<LastRow>, EdgeError> {
        match self.frame {
            Frame::Started => Ok(None),
            Frame::OfPoints(last) => Ok(Some(last)),
            Frame::OfPixels { .. } => Err(EdgeError::FrameOfPixels),
            Frame::Torn => Err(EdgeError::Torn),
        }
    }

    fn complete_row<S: Scalar>(&mut self, setup: &Setup<S>) -> Result<(), EdgeError> {
        if let Frame::OfPoints(last @ LastRow { complete: false, .. }) = &mut self.frame {
            last.complete = true;
            self.tracker.count_points(self.row.len() as u32);
            let jump = self.tracker.row(setup.limits(), setup.camera().intrinsics().columns, last.row, &self.row);
            self.row.clear();
            if let Some(row) = jump {
                self.tear();
                return Err(EdgeError::Jump { row });
            }
        }
        Ok(())
    }

    /// Completes the row before that of this point, and takes the point's time for that of a new row.
    #[inline(never)]
    fn begin_row<S: Scalar>(&mut self, setup: &Setup<S>, point: &EdgePoint) -> Result<i64, EdgeError> {
        let &EdgePoint { row, column_q16, time_ns: stamp_ns, .. } = point;
        if row >= setup.camera().intrinsics().rows {
            return Err(EdgeError::OutsideImage { row, column_q16 });
        }
        check_row_order(setup, self.last_row()?.map(|last| last.row), row)?;
        let Frame::OfPoints(last) = &mut self.frame else {
            let mut clock = RowClock::new(setup, row, stamp_ns);
            let time_ns = clock.begin_row(setup, row, stamp_ns)?;
            self.frame = Frame::OfPoints(LastRow { row, time_ns: stamp_ns, complete: false, clock });
            return Ok(time_ns);
        };
        if stamp_ns < last.time_ns {
            return Err(EdgeError::TimeOrder { time_ns: stamp_ns, previous_ns: last.time_ns });
        }
        let was_irregular = last.clock.is_irregular;
        let time_ns = last.clock.begin_row(setup, row, stamp_ns)?;
        let has_become_irregular = last.clock.is_irregular && !was_irregular;
        self.complete_row(setup)?;
        if has_become_irregular {
            self.tracker.retime(setup.readout());
        }
        if let Frame::OfPoints(last) = &mut self.frame {
            (last.row, last.time_ns, last.complete) = (row, stamp_ns, false);
        }
        Ok(time_ns)
    }
}

/// Whether a point can be one of this image, if its row is.
fn check_values<S: Scalar>(setup: &Setup<S>, point: &EdgePoint) -> Result<(), EdgeError> {
    let EdgePoint { row, column_q16, sigma_q16, .. } = *point;
    if !setup.camera().contains_column(column_q16) {
        return Err(EdgeError::OutsideImage { row, column_q16 });
    }
    if !(1..=EdgePoint::MAX_SIGMA_Q16).contains(&sigma_q16) {
        return Err(EdgeError::Sigma { row, sigma_q16 });
    }
    Ok(())
}

/// Whether a row of pixels is the next one of the frame, and whole.
fn check_pixels<S: Scalar>(setup: &Setup<S>, rows_read: u16, row: u16, pixels: usize) -> Result<(), RowError> {
    let (readout, columns) = (setup.readout(), setup.camera().intrinsics().columns);
    if row >= readout.rows() || readout.rows_before(row) != rows_read {
        return Err(RowError::Order { row, expected: readout.row_after(rows_read) });
    }
    if pixels != usize::from(columns) {
        return Err(RowError::Length { row, pixels, columns });
    }
    Ok(())
}

/// One of the scanned points of a row, refined as well as that row alone allows, where its pixels are given. Of two
/// points that share a window of the scanner and are not refined the width is not known.
fn refined<P: Pixels>(points: &[EdgePoint], point: &EdgePoint, from: Option<(PixelRow<'_, P>, u32)>) -> EdgePoint {
    let around = Neighbours::beside(points, point);
    if let Some(refined) = from.and_then(|(row, noise_q8)| EdgeModel::refine_alone(row, point, around, noise_q8)) {
        return refined;
    }
    if around.is_nearer_than(Scanner::SEES_ALONE_Q16, point.column_q16) {
        EdgePoint { width_q8: 0, ..*point }
    } else {
        *point
    }
}

/// A row of the image that is read after the last one.
fn check_row_order<S: Scalar>(setup: &Setup<S>, last: Option<u16>, row: u16) -> Result<(), EdgeError> {
    let readout = setup.readout();
    let follows = last.is_none_or(|last| readout.rows_before(row) > readout.rows_before(last));
    if row < readout.rows() && follows {
        Ok(())
    } else {
        Err(EdgeError::RowOrder { row, previous: last.unwrap_or(row) })
    }
}

impl<const LINES: usize, const KNOTS: usize, const POINTS: usize> Default for Ranger<LINES, KNOTS, POINTS> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::Ranger;
    use crate::setup::Setup;

    /// Of lines that begin in one row three get a model in one of the next, and all do.
    #[test]
    fn a_row_makes_three_models() {
        const EDGES: usize = 12;
        let setup: Setup<f32> = Setup::pinhole(320, 240, 300.0, 33_300_000).expect("a sound camera");
        let level = |column: usize| match column % 48 {
            0 | 24 => 120,
            1..24 => 180,
            _ => 60,
        };
        let pixels: [u8; 320] = core::array::from_fn(level);
        let mut ranger: Ranger<16, 8, 32> = Ranger::new();
        let mut before = 0;
        for row in 0..20 {
            ranger.row(&setup, row, &pixels).expect("rows in order");
            let models = ranger.tracker.models();
            assert!(models <= before + 3, "row {row}: {models} after {before}");
            before = models;
        }
        assert!(before >= EDGES, "{before} models");
    }
}
