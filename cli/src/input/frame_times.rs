//! When each frame starts and how long it was exposed, from CSV: one line for each frame, in their order or by their
//! names.

use std::collections::HashMap;
use std::path::Path;

use anyhow::{Context, Result, anyhow, ensure};

use super::bounded_read::{self, Limit, MEBIBYTE};
use super::bounds::Bounds;
use super::camera_keys::EXPOSURE;
use super::table_file::{Columns, Record, TableFile};

/// Some hundred thousand frames: an hour at 30 Hz.
const LIMIT: Limit<'_> = Limit { bytes: 16 * MEBIBYTE, rule: "a file of frame times must have at most" };

const COLUMNS: Columns = Columns { known: &["name", "time_s", "exposure_s"], required: &["time_s"] };

/// Seconds since 1970 are no problem: only differences count.
const TIME: Bounds = Bounds::number(-1e10, 1e10, "seconds");

/// What a frame may be called in the file.
pub(crate) struct FrameName {
    /// As it is reported.
    pub(crate) long: String,
    /// Without what all frames have in common, such as their folder.
    pub(crate) short: String,
}

#[derive(Clone, Copy)]
pub(crate) struct FrameTime {
    /// Since the start of the first frame.
    pub(crate) start_s: f64,
    /// Where the file has them; then of all frames.
    pub(crate) exposure_s: Option<f64>,
}

/// Of each frame; their starts rise.
pub(crate) fn load(path: &Path, frames: &[FrameName]) -> Result<Vec<FrameTime>> {
    let text = bounded_read::read_text(path, &LIMIT)?;
    parse(&text, frames).with_context(|| path.display().to_string())
}

fn parse(text: &str, frames: &[FrameName]) -> Result<Vec<FrameTime>> {
    let table = TableFile::parse(text, &COLUMNS)?;
    let times = if table.has("name") { by_name(&table, frames)? } else { in_order(&table, frames)? };
    for (times, names) in times.windows(2).zip(frames.windows(2)) {
        if let ([FrameTime { start_s: before_s, .. }, FrameTime { start_s: after_s, .. }], [before, after]) =
            (times, names)
        {
            let (before, after) = (&before.long, &after.long);
            ensure!(
                after_s > before_s,
                "{after} starts at {after_s} s, but must start after {before}, which comes before it, at {before_s} s"
            );
        }
    }
    let first_s = times.first().map_or(0.0, |first| first.start_s);
    Ok(times.into_iter().map(|time| FrameTime { start_s: time.start_s - first_s, ..time }).collect())
}

fn in_order(table: &TableFile<'_>, frames: &[FrameName]) -> Result<Vec<FrameTime>> {
    let times = table.records().map(|record| time(table, &record?)).collect::<Result<Vec<_>>>()?;
    let (found, expected) = (times.len(), frames.len());
    ensure!(found == expected, "{found} times, but must be {expected}, one for each frame (or give the column `name`)");
    Ok(times)
}

/// The file may have more frames than are asked for.
fn by_name(table: &TableFile<'_>, frames: &[FrameName]) -> Result<Vec<FrameTime>> {
    let mut named = HashMap::new();
    for record in table.records() {
        let record = record?;
        let name = record.cell("name").ok_or_else(|| record.refuse("name", "the name of a frame"))?;
        if let Some((earlier, _)) = named.insert(name.to_string(), (record.at, time(table, &record)?)) {
            return Err(record.refuse("name", format_args!("another one than on line {earlier}")));
        }
    }
    let time = |frame: &FrameName| named.get(&frame.long).or_else(|| named.get(&frame.short)).map(|(_, time)| *time);
    frames.iter().map(|frame| time(frame).ok_or_else(|| anyhow!("no line has the `name` {}", frame.long))).collect()
}

fn time(table: &TableFile<'_>, record: &Record<'_>) -> Result<FrameTime> {
    let exposure_s = table.has("exposure_s").then(|| record.required("exposure_s", EXPOSURE)).transpose()?;
    Ok(FrameTime { start_s: record.required("time_s", TIME)?, exposure_s })
}
