//! Edge points that do not say which line they belong to: the library's tracker finds the lines.

use std::collections::HashSet;

use anyhow::{Error, Result, anyhow};
use shutter_range::{Counters, EdgeError, Line, Ranger, Readout, ReadoutDirection, Setup};

use crate::input::edge_file::FilePoint;

/// Knots of a line: many, since a desktop has the memory.
pub(crate) const KNOTS: usize = 64;

/// More lines than a scene has: of a photograph of 926 columns 256 were too few, counting those that wait behind
/// something.
pub(crate) const LINES: usize = 1024;

/// More points on one row than a scene has.
type LargeRanger = Ranger<LINES, KNOTS, 4096>;

#[derive(Default)]
pub(crate) struct Tracked {
    pub(crate) lines: Vec<Line<KNOTS>>,
    pub(crate) counters: Counters,
}

/// The lines of one frame, from its points in the order of readout.
pub(crate) fn track(points: Vec<FilePoint>, setup: &Setup<f64>) -> Result<Tracked> {
    if points.is_empty() {
        return Ok(Tracked::default());
    }
    let setup = with_limits_for_sparse_rows(setup, &points)?;
    let readout = setup.readout();
    let step = usual_step(&points, readout);
    let mut ranger = Box::new(LargeRanger::new());
    let mut lines = Vec::new();
    let mut previous: Option<u16> = None;
    for row_points in points.chunk_by(|a, b| a.point.row == b.point.row) {
        let Some(first) = row_points.first() else { continue };
        if let Some(previous) = previous {
            end_empty_rows(&mut ranger, &setup, previous, first.point.row, step)?;
        }
        for point in row_points {
            let taken = ranger.edge_point(&setup, point.point);
            taken.map_err(|error| refused(point, error))?;
        }
        lines.extend(std::iter::from_fn(|| ranger.next_line()));
        previous = Some(first.point.row);
    }
    ranger.end_frame(&setup);
    lines.extend(std::iter::from_fn(|| ranger.next_line()));
    Ok(Tracked { lines, counters: *ranger.counters() })
}

/// Where each row has points of only some of the lines, a line is missing from more rows, and must not end there. No
/// more than needed: over longer gaps it would also take points of its neighbours.
fn with_limits_for_sparse_rows(setup: &Setup<f64>, points: &[FilePoint]) -> Result<Setup<f64>> {
    let defaults = *setup.limits();
    let rows = points.iter().map(|point| point.point.row).collect::<HashSet<_>>().len();
    let gap_rows = usize::from(defaults.gap_rows) * rows / points.len();
    let tentative_gap_rows = u16::try_from(gap_rows)?.max(defaults.tentative_gap_rows);
    let gap_rows = (3 * tentative_gap_rows).max(defaults.gap_rows);
    let limits = defaults.with_tentative_gap_rows(tentative_gap_rows).with_gap_rows(gap_rows);
    Ok(setup.with_limits(limits)?)
}

/// Median distance between rows that have points: 1 for a full frame, more if only some rows were searched for edges.
fn usual_step(points: &[FilePoint], readout: &Readout) -> u16 {
    let mut steps: Vec<u16> = points
        .windows(2)
        .filter_map(|pair| match pair {
            [a, b] => Some(readout.rows_before(b.point.row) - readout.rows_before(a.point.row)),
            _ => None,
        })
        .filter(|step| *step > 0)
        .collect();
    steps.sort_unstable();
    steps.get(steps.len() / 2).copied().unwrap_or(1)
}

/// A file has no entry for a row without points, but the tracker must know of it: a line ends when it is missing from
/// enough rows. Otherwise points far below its end would continue it.
fn end_empty_rows(ranger: &mut LargeRanger, setup: &Setup<f64>, previous: u16, next: u16, step: u16) -> Result<()> {
    let readout = setup.readout();
    let gap = previous.abs_diff(next);
    for number in 1..gap / step {
        let row = match readout.direction() {
            ReadoutDirection::TopToBottom => previous + number * step,
            ReadoutDirection::BottomToTop => previous - number * step,
        };
        ranger.end_row(setup, row)?;
    }
    Ok(())
}

fn refused(point: &FilePoint, error: EdgeError) -> Error {
    let (at, row) = (point.at, point.point.row);
    match error {
        EdgeError::Duplicate { .. } => {
            let column = point.point.column_px::<f64>();
            anyhow!("line {at}: `row` {row}, `column` {column} comes twice, but must come once")
        }
        other => anyhow!("line {at}: {other}"),
    }
}
