//! The camera's motion from CSV: one sample of velocity, rotation rate and perhaps gravity on each line.

use std::path::Path;

use anyhow::{Context, Result, ensure};

use super::bounded_read::{self, Limit, MEBIBYTE};
use super::bounds::Bounds;
use super::mount::axes_told;
use super::nearest::list;
use super::repeated_stamps::{self, Sample};
use super::setup::{DIRECTION, RATE, SPEED, SetupFile};
use super::table_file::{Columns, Record, TableFile};
use super::usual;

/// More than two million samples: 40 minutes at 1 kHz.
const LIMIT: Limit<'_> = Limit { bytes: 256 * MEBIBYTE, rule: "a trajectory must have at most" };

const VELOCITY: [&str; 3] = ["vx", "vy", "vz"];
const ROTATION: [&str; 3] = ["wx", "wy", "wz"];
const GRAVITY: [&str; 3] = ["gx", "gy", "gz"];
const COLUMNS: Columns =
    Columns { known: &["time_s", "vx", "vy", "vz", "wx", "wy", "wz", "gx", "gy", "gz"], required: &["time_s"] };
/// Eleven days, which excludes seconds since 1970: those are not on the clock of the frames.
const TIME: Bounds = Bounds::number(-1e6, 1e6, "seconds since the start of the first frame");

/// At least two samples, in the order of time, in the camera's axes.
pub(crate) fn load(path: &Path, setup: &SetupFile) -> Result<Vec<Sample>> {
    let text = bounded_read::read_text(path, &LIMIT)?;
    parse(&text, setup).with_context(|| path.display().to_string())
}

fn parse(text: &str, setup: &SetupFile) -> Result<Vec<Sample>> {
    let table = TableFile::parse(text, &COLUMNS)?;
    let has_any = |names: [&str; 3]| names.iter().any(|name| table.has(name));
    let moves = has_any(VELOCITY) || has_any(ROTATION);
    ensure!(moves, "the header names no motion: it must name some of {}", list(&[VELOCITY, ROTATION].concat()));
    let mut samples: Vec<Sample> = Vec::new();
    for record in table.records() {
        let record = record?;
        let sample = Row { table: &table, record: &record }.sample(has_any(GRAVITY), setup)?;
        if let Some(last) = samples.last().filter(|last| last.time_ns > sample.time_ns) {
            let expected = format!("at least {}, that of the line before", last.time_ns as f64 / 1e9);
            return Err(record.refuse("time_s", expected));
        }
        samples.push(sample);
    }
    let samples = repeated_stamps::resolved(samples);
    ensure!(samples.len() >= 2, "{} samples, but there must be at least 2", samples.len());
    Ok(samples)
}

/// A line of the file. Columns that it has not are zero.
struct Row<'a> {
    table: &'a TableFile<'a>,
    record: &'a Record<'a>,
}

impl Row<'_> {
    fn sample(&self, has_gravity: bool, setup: &SetupFile) -> Result<Sample> {
        let (velocity, rate) = (self.vector(VELOCITY, SPEED)?, self.vector(ROTATION, RATE)?);
        let check = |key, objection, names, vector| setup.usual.check(key, objection, || self.described(names, vector));
        check("velocity_m_s", usual::speed(velocity), VELOCITY, velocity)?;
        check("rate_rad_s", usual::rate(rate), ROTATION, rate)?;
        let down = if has_gravity { Some(self.direction()?) } else { None };
        let in_camera = |vector| setup.mount.as_ref().map_or(vector, |mount| mount.in_camera(vector));
        let gravity = down.map(in_camera);
        if let (Some(down), Some(gravity)) = (down, gravity) {
            check("gravity", usual::gravity(gravity, axes_told(setup.mount.as_ref())), GRAVITY, down)?;
        }
        Ok(Sample {
            time_ns: (self.record.required("time_s", TIME)? * 1e9).round() as i64,
            velocity_m_s: setup.mount.as_ref().map_or(velocity, |mount| mount.velocity_in_camera(velocity, rate)),
            rate_rad_s: in_camera(rate),
            gravity,
        })
    }

    fn described(&self, [x, y, z]: [&str; 3], vector: [f64; 3]) -> String {
        format!("line {}: `{x}`, `{y}`, `{z}` are {vector:?}", self.record.at)
    }

    fn vector(&self, names: [&str; 3], bounds: Bounds) -> Result<[f64; 3]> {
        let mut vector = [0.0; 3];
        for (component, name) in vector.iter_mut().zip(names).filter(|(_, name)| self.table.has(name)) {
            *component = self.record.required(name, bounds)?;
        }
        Ok(vector)
    }

    fn direction(&self) -> Result<[f64; 3]> {
        let gravity = self.vector(GRAVITY, DIRECTION)?;
        let length = gravity.iter().map(|component| component * component).sum::<f64>().sqrt();
        let at = self.record.at;
        ensure!(
            length >= 0.001,
            "line {at}: `gx`, `gy`, `gz` are {length} long, but must be a direction: 0.001 at least"
        );
        Ok(gravity)
    }
}
