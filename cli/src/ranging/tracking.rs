//! Edges that say nothing of what they belong to: through the library's ranger, as firmware would.

use std::collections::HashSet;

use anyhow::{Error, Result, anyhow};
use shutter_range::{Counters, EdgeError, Line, Ranger, Readout, ReadoutDirection, Setup};

use crate::input::edge_file::EdgeRow;

/// Knots of a line whose edges are known to belong together: memory is no concern here.
pub(crate) const KNOTS: usize = 64;

/// Room for more edges than any row or frame of a scene has.
type LargeRanger = Ranger<256, KNOTS, 4096>;

#[derive(Default)]
pub(crate) struct Tracked {
    pub(crate) lines: Vec<Line<KNOTS>>,
    pub(crate) counters: Counters,
}

/// The lines of one frame.
pub(crate) fn track(mut rows: Vec<EdgeRow>, setup: &Setup<f64>) -> Result<Tracked> {
    if rows.is_empty() {
        return Ok(Tracked::default());
    }
    let setup = patient(setup, &rows)?;
    let readout = setup.readout();
    rows.sort_by_key(|row| (readout.rows_before(row.edge.row), row.edge.column_q16));
    let step = usual_step(&rows, readout);
    let mut ranger = Box::new(LargeRanger::new());
    let mut lines = Vec::new();
    let mut previous: Option<u16> = None;
    for of_row in rows.chunk_by(|a, b| a.edge.row == b.edge.row) {
        let Some(first) = of_row.first() else { continue };
        if let Some(previous) = previous {
            pass_empty_rows(&mut ranger, &setup, previous, first.edge.row, step)?;
        }
        for row in of_row {
            let taken = ranger.edge_point(&setup, row.edge);
            taken.map_err(|error| refused(row, previous, error))?;
        }
        lines.extend(std::iter::from_fn(|| ranger.next_line()));
        previous = Some(first.edge.row);
    }
    ranger.end_frame(&setup);
    lines.extend(std::iter::from_fn(|| ranger.next_line()));
    Ok(Tracked { lines, counters: *ranger.counters() })
}

/// The setup with limits for rows that may be sparse, or lines that have edges on different ones. The fewer edges a row
/// has, the longer a line may wait for its next one without taking that of another.
fn patient(setup: &Setup<f64>, rows: &[EdgeRow]) -> Result<Setup<f64>> {
    let defaults = *setup.limits();
    let looked_at = rows.iter().map(|row| row.edge.row).collect::<HashSet<_>>().len();
    let patience = usize::from(defaults.gap_rows) * looked_at / rows.len();
    let tentative_gap_rows = u16::try_from(patience)?.max(defaults.tentative_gap_rows);
    let gap_rows = (3 * tentative_gap_rows).max(defaults.gap_rows);
    let limits = defaults.with_tentative_gap_rows(tentative_gap_rows).with_gap_rows(gap_rows);
    Ok(setup.with_limits(limits)?)
}

/// Median distance between successive rows that have edges: 1 for a full frame, more where only some rows were looked at.
fn usual_step(rows: &[EdgeRow], readout: &Readout) -> u16 {
    let mut steps: Vec<u16> = rows
        .windows(2)
        .filter_map(|pair| match pair {
            [a, b] => Some(readout.rows_before(b.edge.row) - readout.rows_before(a.edge.row)),
            _ => None,
        })
        .filter(|step| *step > 0)
        .collect();
    steps.sort_unstable();
    steps.get(steps.len() / 2).copied().unwrap_or(1)
}

/// A file has no entry for a row without edges, but lines end by missing such rows: what lies above the end of one must
/// not be joined to what lies far below.
fn pass_empty_rows(ranger: &mut LargeRanger, setup: &Setup<f64>, previous: u16, next: u16, step: u16) -> Result<()> {
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

fn refused(row: &EdgeRow, previous: Option<u16>, error: EdgeError) -> Error {
    let (at, edge) = (row.at, &row.edge);
    match error {
        EdgeError::Duplicate { .. } => {
            let column = edge.column_px::<f64>();
            anyhow!("line {at}: `row` {}, `column` {column} comes twice, but must come once", edge.row)
        }
        EdgeError::TimeOrder { .. } => anyhow!("line {at}: {}", backwards(row, previous.unwrap_or(edge.row))),
        other => anyhow!("line {at}: {other}"),
    }
}

/// Stamps that contradict the order of readout.
pub(crate) fn backwards(row: &EdgeRow, previous_row: u16) -> String {
    format!(
        "`time_s` is {}, earlier than on row {previous_row}, which was read before row {}: \
         check the stamps and `camera.direction`",
        row.edge.time_ns as f64 * 1e-9,
        row.edge.row
    )
}
