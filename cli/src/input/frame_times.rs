//! When each frame starts, from CSV: one line for each frame, in their order or by their names.

use std::collections::HashMap;
use std::path::Path;

use anyhow::{Context, Result, anyhow, ensure};

use super::bounded_read::{self, Limit, MEBIBYTE};
use super::bounds::Bounds;
use super::table_file::{Columns, Record, TableFile};

/// Some hundred thousand frames: an hour at 30 Hz.
const LIMIT: Limit<'_> = Limit { bytes: 16 * MEBIBYTE, rule: "a file of frame times must have at most" };

const COLUMNS: Columns = Columns { known: &["name", "time_s"], required: &["time_s"] };

/// Seconds since 1970 are no problem: only differences count.
const TIME: Bounds = Bounds::number(-1e10, 1e10, "seconds");

/// What a frame may be called in the file.
pub(crate) struct FrameName {
    /// As it is reported.
    pub(crate) long: String,
    /// Without what all frames have in common, such as their folder.
    pub(crate) short: String,
}

/// Seconds from the start of the first frame to that of each, rising.
pub(crate) fn load(path: &Path, frames: &[FrameName]) -> Result<Vec<f64>> {
    let text = bounded_read::read_text(path, &LIMIT)?;
    parse(&text, frames).with_context(|| path.display().to_string())
}

fn parse(text: &str, frames: &[FrameName]) -> Result<Vec<f64>> {
    let table = TableFile::parse(text, &COLUMNS)?;
    let times = if table.has("name") { by_name(&table, frames)? } else { in_order(&table, frames)? };
    for (times, names) in times.windows(2).zip(frames.windows(2)) {
        if let ([before_s, after_s], [before, after]) = (times, names) {
            let (before, after) = (&before.long, &after.long);
            ensure!(
                after_s > before_s,
                "{after} starts at {after_s} s, but must start after {before}, which comes before it, at {before_s} s"
            );
        }
    }
    let first_s = times.first().copied().unwrap_or(0.0);
    Ok(times.into_iter().map(|time_s| time_s - first_s).collect())
}

fn in_order(table: &TableFile<'_>, frames: &[FrameName]) -> Result<Vec<f64>> {
    let times = table.records().map(|record| time(&record?)).collect::<Result<Vec<_>>>()?;
    let (found, expected) = (times.len(), frames.len());
    ensure!(found == expected, "{found} times, but must be {expected}, one for each frame (or give the column `name`)");
    Ok(times)
}

/// The file may have more frames than are asked for.
fn by_name(table: &TableFile<'_>, frames: &[FrameName]) -> Result<Vec<f64>> {
    let mut named = HashMap::new();
    for record in table.records() {
        let record = record?;
        let name = record.cell("name").ok_or_else(|| record.refuse("name", "the name of a frame"))?;
        if let Some((earlier, _)) = named.insert(name.to_string(), (record.at, time(&record)?)) {
            return Err(record.refuse("name", format_args!("another one than on line {earlier}")));
        }
    }
    let time =
        |frame: &FrameName| named.get(&frame.long).or_else(|| named.get(&frame.short)).map(|(_, time_s)| *time_s);
    frames.iter().map(|frame| time(frame).ok_or_else(|| anyhow!("no line has the `name` {}", frame.long))).collect()
}

fn time(record: &Record<'_>) -> Result<f64> {
    record.required("time_s", TIME)
}
