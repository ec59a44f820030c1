//! The camera's motion from CSV: one sample of velocity, rotation rate and perhaps gravity on each line.

use std::path::Path;

use anyhow::{Context, Result, ensure};

use super::bounded_read::{self, Limit, MEBIBYTE};
use super::bounds::Bounds;
use super::setup::{DIRECTION, RATE, SPEED};
use super::table_file::{Columns, Record, TableFile};
use super::usual::{self, Usual};

/// In the axes of the camera at this instant.
#[derive(Clone, Copy)]
pub(crate) struct Sample {
    /// Since the start of the first frame.
    pub(crate) time_ns: i64,
    pub(crate) velocity_m_s: [f64; 3],
    pub(crate) rate_rad_s: [f64; 3],
    /// `None` where the file has no columns for it.
    pub(crate) gravity: Option<[f64; 3]>,
}

/// More than two million samples: 40 minutes at 1 kHz.
const LIMIT: Limit<'_> = Limit { bytes: 256 * MEBIBYTE, rule: "a trajectory must have at most" };

const VELOCITY: [&str; 3] = ["vx", "vy", "vz"];
const ROTATION: [&str; 3] = ["wx", "wy", "wz"];
const GRAVITY: [&str; 3] = ["gx", "gy", "gz"];
const COLUMNS: Columns = Columns {
    known: &["time_s", "vx", "vy", "vz", "wx", "wy", "wz", "gx", "gy", "gz"],
    required: &["time_s", "vx", "vy", "vz", "wx", "wy", "wz"],
};
/// Eleven days, which excludes seconds since 1970: those are not on the clock of the frames.
const TIME: Bounds = Bounds::number(-1e6, 1e6, "seconds since the start of the first frame");

/// At least two samples, in the order of time.
pub(crate) fn load(path: &Path, usual: &Usual) -> Result<Vec<Sample>> {
    let text = bounded_read::read_text(path, &LIMIT)?;
    parse(&text, usual).with_context(|| path.display().to_string())
}

fn parse(text: &str, usual: &Usual) -> Result<Vec<Sample>> {
    let table = TableFile::parse(text, &COLUMNS)?;
    let given = GRAVITY.map(|name| table.has(name));
    ensure!(given == [given[0]; 3], "the header must name all of `gx`, `gy` and `gz`, or none");
    let mut samples: Vec<Sample> = Vec::new();
    for record in table.records() {
        let record = record?;
        let sample = sample(&record, given[0])?;
        if let Some(last) = samples.last().filter(|last| last.time_ns >= sample.time_ns) {
            let expected = format!("above {}, that of the line before", last.time_ns as f64 / 1e9);
            return Err(record.refuse("time_s", expected));
        }
        refuse_unusual(record.at, &sample, usual)?;
        samples.push(sample);
    }
    ensure!(samples.len() >= 2, "{} samples, but there must be at least 2", samples.len());
    Ok(samples)
}

fn sample(record: &Record<'_>, has_gravity: bool) -> Result<Sample> {
    Ok(Sample {
        time_ns: (record.required("time_s", TIME)? * 1e9).round() as i64,
        velocity_m_s: vector(record, VELOCITY, SPEED)?,
        rate_rad_s: vector(record, ROTATION, RATE)?,
        gravity: if has_gravity { Some(direction(record)?) } else { None },
    })
}

/// As in a setup, under the keys that the columns stand for.
fn refuse_unusual(at: usize, sample: &Sample, usual: &Usual) -> Result<()> {
    let columns = |names: [&str; 3], vector: [f64; 3]| {
        let [x, y, z] = names;
        format!("line {at}: `{x}`, `{y}`, `{z}` are {vector:?}")
    };
    let (velocity, rate) = (sample.velocity_m_s, sample.rate_rad_s);
    usual.check("velocity_m_s", usual::speed(velocity), || columns(VELOCITY, velocity))?;
    usual.check("rate_rad_s", usual::rate(rate), || columns(ROTATION, rate))?;
    match sample.gravity {
        Some(gravity) => usual.check("gravity", usual::gravity(gravity), || columns(GRAVITY, gravity)),
        None => Ok(()),
    }
}

fn vector(record: &Record<'_>, [x, y, z]: [&str; 3], bounds: Bounds) -> Result<[f64; 3]> {
    Ok([record.required(x, bounds)?, record.required(y, bounds)?, record.required(z, bounds)?])
}

fn direction(record: &Record<'_>) -> Result<[f64; 3]> {
    let gravity = vector(record, GRAVITY, DIRECTION)?;
    let length = gravity.iter().map(|component| component * component).sum::<f64>().sqrt();
    let at = record.at;
    ensure!(length >= 0.001, "line {at}: `gx`, `gy`, `gz` are {length} long, but must be a direction: 0.001 at least");
    Ok(gravity)
}
