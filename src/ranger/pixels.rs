//! Rows of pixels.

use heapless::Vec;

use super::frame::Frame;
use super::ranger::Ranger;
use crate::edge::{EdgeModel, EdgePoint, Neighbours, PixelRow, Scanner};
use crate::error::RowError;
use crate::format::Pixels;
use crate::line::{Candidates, Flanks, Repair, RowTime, looks, looks_beside, looks_for_halo, looks_for_new};
use crate::scalar::Scalar;
use crate::setup::Setup;

impl<const LINES: usize, const KNOTS: usize, const POINTS: usize, R: Repair> Ranger<LINES, KNOTS, POINTS, R> {
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
        let (points, tracker) = (&mut self.points, &mut self.tracker);
        let dropped_points = tracker.counters().dropped_points;
        tracker.see_light(row, &pixels, || self.scanner.noise_q8());
        let pixel_row = PixelRow { pixels, response: setup.response() };
        let mut candidates = Candidates::new();
        let is_steady = tracker.locate(setup.limits(), at, pixel_row, &mut candidates);
        let (is_full, is_mosaic) = (tracker.is_full(), pixels.mosaic_row().is_some());
        // Where nothing new is looked for, lines that the row has not shown yet are.
        let is_asked = is_full || !looks_for_new(row, is_mosaic);
        let is_blinded = if is_steady && is_asked {
            self.scanner.pass(pixels);
            // Asked only where it was so before: most rows can be read.
            was_blinded && self.scanner.is_blinded()
        } else {
            let (mut asked, mut flanks): (Vec<_, LINES>, _) = (Vec::new(), Flanks::new());
            tracker.add_flanks(row, &candidates, &mut flanks);
            if is_asked {
                candidates.add_columns(&mut asked);
            }
            let asked = is_asked.then_some(&asked[..]);
            self.scanner.scan_where(pixels, asked, &flanks, looks_beside(row, is_mosaic), |point| {
                if points.push(point.at(row, at.time_ns)).is_err() {
                    tracker.counters_mut().count_points(1);
                    tracker.counters_mut().count_dropped_point();
                }
            })
        };
        if let Frame::OfPixels { is_blinded: of_frame, .. } = &mut self.frame {
            *of_frame = is_blinded;
        }
        tracker.remove_explained(row, points);
        tracker.counters_mut().count_points(points.len() as u32);
        let scanner = &self.scanner;
        let refine =
            |point: &EdgePoint, looks: bool| refined(points, point, looks.then(|| (pixel_row, scanner.noise_q8())));
        let columns = setup.camera().intrinsics().columns;
        let is_as_before = is_steady && points.is_empty();
        let jump =
            if is_as_before { None } else { tracker.take(setup.limits(), columns, row, &candidates, points, &refine) };
        if is_full || is_blinded || tracker.counters().dropped_points != dropped_points {
            tracker.counters_mut().count_crowded_row();
        }
        if jump.is_none() && (!is_as_before || looks(row)) {
            tracker.look_at(row, pixel_row, scanner.noise_q8(), points);
        }
        points.clear();
        self.unless_torn(jump)
    }

    /// Takes one row of pixels as [`row`](Self::row), but finds edges by scanning alone: what no row shows on its own is
    /// not found, a point is as good as its row makes it, and edges within eight pixels draw each other aside.
    /// A program whose rows are all taken so holds no models of edges: 27 kB less flash on a Cortex-M0 with
    /// `opt-level = "s"` (`scanned` beside `smallest` in docs/budget.md).
    ///
    /// What is around a line is not looked at, and so none is [`Cluttered`](crate::RangeStatus::Cluttered): in texture, lines
    /// may be there by chance. It is for edges before plain backgrounds.
    ///
    /// *Errors*: as [`row`](Self::row).
    pub fn scanned_row<S: Scalar>(&mut self, setup: &Setup<S>, row: u16, pixels: impl Pixels) -> Result<(), RowError> {
        self.begin_row_of_pixels(setup, row, pixels.columns())?;
        let time_ns = setup.readout().row_time_ns(row);
        let (points, tracker) = (&mut self.points, &mut self.tracker);
        let dropped_points = tracker.counters().dropped_points;
        tracker.see_light(row, &pixels, || self.scanner.noise_q8());
        let is_blinded = self.scanner.scan_where(pixels, None, &[], true, |point| {
            tracker.counters_mut().count_points(1);
            if points.push(point.at(row, time_ns)).is_err() {
                tracker.counters_mut().count_dropped_point();
            }
        });
        if is_blinded || tracker.counters().dropped_points != dropped_points {
            tracker.counters_mut().count_crowded_row();
        }
        let jump = tracker.row(setup.limits(), setup.camera().intrinsics().columns, row, points);
        points.clear();
        self.unless_torn(jump)
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

    /// Tears the frame where all its lines jump at a row.
    fn unless_torn(&mut self, jump: Option<u16>) -> Result<(), RowError> {
        let Some(row) = jump else { return Ok(()) };
        self.tear();
        Err(RowError::Jump { row })
    }
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

#[cfg(test)]
mod tests {
    use crate::ranger::Ranger;
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
