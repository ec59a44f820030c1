//! The library's table of image sensors: modes that drivers set, with their line time and readout.

use std::fmt::Write;

use anyhow::{Result, anyhow};
use serde::Serialize;
use shutter_range::sensor::{Kind, TypicalMode, typical_modes};

use crate::output::text_table::{Colour, TextTable};

#[derive(Serialize)]
pub(crate) struct Document {
    modes: Vec<Mode>,
}

#[derive(Serialize)]
struct Mode {
    sensor: &'static str,
    mode: &'static str,
    /// From one row of the image to the next.
    line_time_us: f64,
    readout_s: f64,
    source: &'static str,
    kind: &'static str,
    #[serde(skip)]
    further: Further,
}

/// What the table has room for besides.
struct Further {
    clock_hz: u32,
    columns: u16,
    rows: u16,
    lines_per_row: f64,
    sigma: f64,
    colour: Colour,
}

pub(crate) fn modes() -> Result<Document> {
    let modes = typical_modes().iter().map(Mode::compute).collect::<Result<_>>()?;
    Ok(Document { modes })
}

impl Mode {
    fn compute(typical: &TypicalMode) -> Result<Self> {
        let (sensor, name) = (typical.chip.name(), typical.name);
        let mode = typical.mode().map_err(|error| anyhow!("{sensor}, {name}: {error}"))?;
        let (line_time_ps, rows) = (mode.readout.line_time_ps() as f64, f64::from(mode.rows()));
        Ok(Self {
            sensor,
            mode: name,
            line_time_us: line_time_ps / 1e6,
            readout_s: line_time_ps * rows / 1e12,
            source: typical.source,
            kind: typical.kind.name(),
            further: Further {
                clock_hz: typical.clock_hz,
                columns: mode.columns,
                rows: mode.rows(),
                lines_per_row: f64::from(mode.lines) / rows,
                sigma: mode.sigma(),
                colour: if typical.kind == Kind::Documented { Colour::Yellow } else { Colour::Plain },
            },
        })
    }
}

pub(crate) fn text(document: &Document, colours: bool) -> String {
    let headings = [
        "sensor",
        "mode",
        "clock (MHz)",
        "image",
        "line time (us)",
        "lines/row",
        "readout (ms)",
        "sigma (%)",
        "known",
        "by",
    ];
    let mut table = TextTable::new(headings, colours);
    for mode in &document.modes {
        let further = &mode.further;
        let cells = [
            mode.sensor.to_string(),
            mode.mode.to_string(),
            (further.clock_hz / 1_000_000).to_string(),
            format!("{}x{}", further.columns, further.rows),
            format!("{:.2}", mode.line_time_us),
            format!("{:.2}", further.lines_per_row),
            format!("{:.1}", mode.readout_s * 1e3),
            format!("{:.1}", further.sigma * 100.0),
            mode.kind.to_string(),
            mode.source.to_string(),
        ];
        table.row(cells, further.colour);
    }
    let mut text = String::from("Line time from row to row of the image, by the registers that drivers set\n\n");
    table.write_to(&mut text);
    let _ = writeln!(
        text,
        "\nA board's own clock and mode decide: measure yours, or read it from the sensor (feature `embedded-hal`)."
    );
    text
}
