//! Edge points, row by row.

use super::frame::{Frame, LastRow};
use super::ranger::Ranger;
use crate::edge::EdgePoint;
use crate::error::EdgeError;
use crate::line::{Repair, RowClock};
use crate::scalar::Scalar;
use crate::setup::Setup;

impl<const LINES: usize, const KNOTS: usize, const POINTS: usize, R: Repair> Ranger<LINES, KNOTS, POINTS, R> {
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
            Frame::OfPoints(LastRow { row, complete: false, clock: Some(clock) }) if *row == point.row => {
                let EdgePoint { row, column_q16, .. } = point;
                let at = match self.points.last() {
                    // Most come in the order of their columns.
                    Some(before) if before.column_q16 < column_q16 => None,
                    _ => match self.points.binary_search_by_key(&column_q16, |other| other.column_q16) {
                        Ok(_) => return Err(EdgeError::Duplicate { row, column_q16 }),
                        Err(at) => Some(at).filter(|at| *at < self.points.len()),
                    },
                };
                if clock.takes(point.time_ns) {
                    (at, point.time_ns)
                } else {
                    let was_irregular = clock.is_irregular;
                    let time_ns = clock.time_ns(setup, row, point.time_ns)?;
                    if clock.is_irregular && !was_irregular {
                        self.points.iter_mut().for_each(|point| point.time_ns = time_ns);
                        self.tracker.retime(setup.readout());
                    }
                    (at, time_ns)
                }
            }
            _ => (None, self.begin_row(setup, &point)?),
        };
        let point = EdgePoint { time_ns, ..point };
        let taken = match at {
            None => self.points.push(point),
            Some(at) => self.points.push(point).map(|()| {
                // `insert` may panic, for all the compiler sees.
                let mut moved = point;
                self.points.iter_mut().skip(at).for_each(|place| core::mem::swap(place, &mut moved));
            }),
        };
        if taken.is_err() {
            self.tracker.counters_mut().count_points(1);
            self.tracker.counters_mut().count_dropped_point();
        }
        Ok(())
    }

    /// Takes a row that was looked at and has no edge points (more of them): lines that cross it have missed a row.
    ///
    /// *Errors*: [`EdgeError::RowOrder`] for a row that was read before the last one, [`EdgeError::FrameOfPixels`] and
    /// [`EdgeError::Torn`] as for a point, and [`EdgeError::Jump`], which tears the frame.
    pub fn end_row<S: Scalar>(&mut self, setup: &Setup<S>, row: u16) -> Result<(), EdgeError> {
        let last = self.last_row()?;
        if !last.is_some_and(|last| last.row == row && !last.complete) {
            check_row_order(setup, last.map(|last| last.row), row)?;
            let clock = last.and_then(|last| last.clock);
            self.complete_row(setup)?;
            self.frame = Frame::OfPoints(LastRow { row, complete: false, clock });
        }
        self.complete_row(setup)
    }

    /// Whether the stamps of the frame under way do not rise with its rows, so that the readout tells the time
    /// ([`StampPolicy::Checked`](crate::StampPolicy::Checked)).
    #[must_use]
    pub const fn has_irregular_stamps(&self) -> bool {
        matches!(self.frame, Frame::OfPoints(LastRow { clock: Some(RowClock { is_irregular: true, .. }), .. }))
    }

    /// Completes the row before that of this point, and takes the point's time for that of a new row.
    #[inline(never)]
    fn begin_row<S: Scalar>(&mut self, setup: &Setup<S>, point: &EdgePoint) -> Result<i64, EdgeError> {
        let &EdgePoint { row, column_q16, time_ns: stamp_ns, .. } = point;
        if row >= setup.camera().intrinsics().rows {
            return Err(EdgeError::OutsideImage { row, column_q16 });
        }
        check_row_order(setup, self.last_row()?.map(|last| last.row), row)?;
        let Frame::OfPoints(LastRow { clock: Some(clock), .. }) = &mut self.frame else {
            let mut clock = RowClock::new(setup, row, stamp_ns);
            let time_ns = clock.begin_row(setup, row, stamp_ns)?;
            self.frame = Frame::OfPoints(LastRow { row, complete: false, clock: Some(clock) });
            return Ok(time_ns);
        };
        let was_irregular = clock.is_irregular;
        let time_ns = clock.begin_row(setup, row, stamp_ns)?;
        let has_become_irregular = clock.is_irregular && !was_irregular;
        self.complete_row(setup)?;
        if has_become_irregular {
            self.tracker.retime(setup.readout());
        }
        if let Frame::OfPoints(last) = &mut self.frame {
            (last.row, last.complete) = (row, false);
        }
        Ok(time_ns)
    }

    pub(super) fn complete_row<S: Scalar>(&mut self, setup: &Setup<S>) -> Result<(), EdgeError> {
        if let Frame::OfPoints(last @ LastRow { complete: false, .. }) = &mut self.frame {
            last.complete = true;
            self.tracker.counters_mut().count_points(self.points.len() as u32);
            let jump = self.tracker.row(setup.limits(), setup.camera().intrinsics().columns, last.row, &self.points);
            self.points.clear();
            if let Some(row) = jump {
                self.tear();
                return Err(EdgeError::Jump { row });
            }
        }
        Ok(())
    }

    /// The last row of a frame of edge points, if one has come.
    fn last_row(&self) -> Result<Option<&LastRow>, EdgeError> {
        match &self.frame {
            Frame::Started => Ok(None),
            Frame::OfPoints(last) => Ok(Some(last)),
            Frame::OfPixels { .. } => Err(EdgeError::FrameOfPixels),
            Frame::Torn => Err(EdgeError::Torn),
        }
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
