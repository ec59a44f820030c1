//! Command `table2`: the field test of the paper (its Table 2), recomputed from the published angles.

use std::fmt::Write;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use shutter_range::rse::{PAPER_KAPPA, Shear};

use crate::output::text_table::{Colour, TextTable};

const PUBLISHED: &str = include_str!("../../../host_tests/data/table2.csv");

/// Relative. The published angles and speeds are rounded: a distance that is this close does follow from its angle.
const TOLERANCE: f64 = 0.005;

/// A row of the published table.
#[derive(Deserialize)]
struct Published {
    case: u32,
    /// A fraction such as `1/60`.
    shutter_s: String,
    speed_m_s: f64,
    distance_m: f64,
    rse_deg: f64,
    estimated_m: f64,
}

#[derive(Serialize)]
pub(crate) struct Row {
    pub(crate) case: u32,
    pub(crate) readout_s: f64,
    pub(crate) speed_m_s: f64,
    pub(crate) rse_deg: f64,
    pub(crate) gps_m: f64,
    published_m: f64,
    pub(crate) computed_m: f64,
    follows: bool,
}

#[derive(Serialize)]
pub(crate) struct Summary {
    pub(crate) rows: Vec<Row>,
    rms_error_m: f64,
    published_rms_error_m: f64,
    kappa: f64,
}

pub(crate) fn summary() -> Result<Summary> {
    let shear = Shear::parallel(PAPER_KAPPA, 0.0);
    let mut rows = Vec::new();
    for record in csv::Reader::from_reader(PUBLISHED.as_bytes()).deserialize() {
        rows.push(Row::compute(&record.context("Table 2")?, &shear)?);
    }
    let rms_error_m = rms(rows.iter().map(|row| row.computed_m - row.gps_m));
    let published_rms_error_m = rms(rows.iter().map(|row| row.published_m - row.gps_m));
    Ok(Summary { rows, rms_error_m, published_rms_error_m, kappa: PAPER_KAPPA })
}

impl Row {
    fn compute(published: &Published, shear: &Shear<f64>) -> Result<Self> {
        let &Published { case, ref shutter_s, speed_m_s, distance_m, rse_deg, estimated_m } = published;
        let readout_s = fraction(shutter_s).with_context(|| format!("Table 2: shutter_s is `{shutter_s}`"))?;
        let computed_m = shear.depth_m(rse_deg.to_radians(), speed_m_s, readout_s);
        Ok(Self {
            case,
            readout_s,
            speed_m_s,
            rse_deg,
            gps_m: distance_m,
            published_m: estimated_m,
            computed_m,
            follows: (computed_m / estimated_m - 1.0).abs() <= TOLERANCE,
        })
    }

    /// The angle that the published distance would follow from.
    fn explaining_angle_deg(&self) -> f64 {
        let shear = Shear::parallel(PAPER_KAPPA, 0.0);
        shear.angle_rad(self.published_m, self.speed_m_s, self.readout_s).to_degrees()
    }
}

fn fraction(text: &str) -> Option<f64> {
    let (numerator, denominator) = text.split_once('/')?;
    Some(numerator.parse::<f64>().ok()? / denominator.parse::<f64>().ok()?)
}

fn rms(errors: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = errors.len() as f64;
    (errors.map(|error| error * error).sum::<f64>() / count).sqrt()
}

pub(crate) fn text(summary: &Summary, colours: bool) -> String {
    let mut text = format!("Table 2 of the paper: distance from the RSE angle, kappa = {}\n\n", summary.kappa);
    measurements(summary, colours).write_to(&mut text);
    text.push('\n');
    write_unexplained(summary, &mut text);
    let _ = writeln!(
        text,
        "RMS error against GPS: computed {:.3} m, published {:.3} m ({} measurements)",
        summary.rms_error_m,
        summary.published_rms_error_m,
        summary.rows.len()
    );
    text
}

fn measurements(summary: &Summary, colours: bool) -> TextTable {
    let headings = [
        "case",
        "row",
        "readout (s)",
        "speed (m/s)",
        "RSE (deg)",
        "GPS (m)",
        "published (m)",
        "error (m)",
        "computed (m)",
        "error (m)",
        "follows",
    ];
    let mut table = TextTable::new(headings, colours);
    for (number, row) in numbered(&summary.rows) {
        let cells = [
            row.case.to_string(),
            number.to_string(),
            format!("{:.4}", row.readout_s),
            format!("{:.4}", row.speed_m_s),
            format!("{:.2}", row.rse_deg),
            format!("{:.4}", row.gps_m),
            format!("{:.4}", row.published_m),
            format!("{:+.4}", row.published_m - row.gps_m),
            format!("{:.4}", row.computed_m),
            format!("{:+.4}", row.computed_m - row.gps_m),
            if row.follows { "yes" } else { "no *" }.to_string(),
        ];
        table.row(cells, if row.follows { Colour::Plain } else { Colour::Yellow });
    }
    table
}

fn write_unexplained(summary: &Summary, text: &mut String) {
    let count = summary.rows.iter().filter(|row| !row.follows).count();
    let _ = writeln!(
        text,
        "* {count} of {} published distances do not follow from the published angle within {} %; this angle would give them:",
        summary.rows.len(),
        TOLERANCE * 100.0
    );
    for (number, row) in numbered(&summary.rows).filter(|(_, row)| !row.follows) {
        let (case, printed, explaining) = (row.case, row.rse_deg, row.explaining_angle_deg());
        let _ = writeln!(text, "  case {case}, row {number}: {explaining:.2} deg (printed {printed:.2})");
    }
    text.push('\n');
}

/// Rows with their number within their case.
fn numbered(rows: &[Row]) -> impl Iterator<Item = (usize, &Row)> {
    rows.chunk_by(|a, b| a.case == b.case).flat_map(|case| (1..).zip(case))
}
