//! Command `inspect`: what a camera does to its pixels, and what of it matters for ranging.

use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use serde::Serialize;

use crate::arguments::InspectArgs;
use crate::input::frame_source::{FoundFrame, FrameSource};
use crate::input::grey_levels::UnusedBits;
use crate::input::picture::PictureFormat;
use crate::input::size::{self, Size};
use crate::inspection::findings::{self, Finding, Further, Keys};
use crate::inspection::grey::Grey;
use crate::inspection::measurement::Measurement;
use crate::ranging::hints;
use crate::ranging::workers;

#[derive(Serialize)]
pub(crate) struct Inspection {
    files: Vec<PathBuf>,
    columns: u32,
    rows: u32,
    frames: usize,
    measured: Measurement,
    findings: Vec<Finding>,
    /// For [camera] of the setup.
    keys: Keys,
}

/// What one frame tells.
struct Seen {
    name: String,
    size: Size,
    measured: Measurement,
    has_alternating_columns: bool,
    unused_bits: Option<UnusedBits>,
}

/// Of several frames, the median of each value.
pub(crate) fn inspection(arguments: &InspectArgs) -> Result<Inspection> {
    let format = PictureFormat { size: arguments.raw.map(|raw| raw.size), raw: arguments.raw, bits: None };
    let source = FrameSource::new(&arguments.files, format);
    let seen: Vec<Seen> =
        workers::in_order(workers::cores(), source, |found| Seen::of(found, &format), |results| results.collect())?;
    let first = seen.first().context("the video has no frame")?;
    for other in &seen {
        size::refuse_unlike((&other.name, other.size), (&first.name, first.size))?;
    }
    let frames: Vec<Measurement> = seen.iter().map(|seen| seen.measured.clone()).collect();
    let measured = Measurement::together(&frames).context("no frame")?;
    let count = seen.len() as f64;
    let further = Further {
        alternating_frames: seen.iter().filter(|seen| seen.has_alternating_columns).count() as f64 / count,
        unused_bits: seen
            .iter()
            .map(|seen| seen.unused_bits)
            .max_by_key(|unused| unused.map_or(16, |unused| unused.bits))
            .flatten(),
    };
    let findings = findings::of(&measured, &further);
    let keys = findings::keys(&measured, &further, &findings);
    let Size { columns, rows } = first.size;
    Ok(Inspection { files: arguments.files.clone(), columns, rows, frames: seen.len(), measured, findings, keys })
}

impl Seen {
    fn of(found: FoundFrame, format: &PictureFormat) -> Result<Self> {
        /// What is measured looks at some pixels around each one.
        const LEAST_SIDE: u32 = 16;
        let name = found.name.clone();
        let picture = found.load(format)?;
        let unused_bits = picture.unused_bits;
        let pixels = picture.into_grey().with_context(|| name.clone())?;
        let size = Size::of(&pixels);
        ensure!(
            size.columns.min(size.rows) >= LEAST_SIDE,
            "{name}: {size} pixels, but must be at least {LEAST_SIDE} × {LEAST_SIDE}"
        );
        Ok(Self {
            measured: Measurement::of(&Grey::of(&pixels)),
            has_alternating_columns: hints::has_alternating_columns(&pixels),
            unused_bits,
            name,
            size,
        })
    }
}

pub(crate) fn text(inspection: &Inspection) -> String {
    let mut text = String::new();
    let Inspection { columns, rows, frames, measured, .. } = inspection;
    let of = if *frames == 1 { String::new() } else { format!(", median of {frames} frames") };
    let _ = writeln!(text, "{columns} × {rows} pixels{of}; grey levels of 0 to 255\n");
    for (what, value) in values(measured) {
        let _ = writeln!(text, "{what:<28}{value}");
    }
    text.push('\n');
    if inspection.findings.is_empty() {
        text.push_str("nothing in these frames is in the way of ranging\n");
    }
    for finding in &inspection.findings {
        let _ = writeln!(text, "{}: {}", finding.name, finding.text);
    }
    let Keys { response, sigma_blur, bits } = &inspection.keys;
    let _ = writeln!(text, "\nfor the setup:\n[camera]\nresponse = {response:?}\nsigma_blur = {sigma_blur}");
    if let Some(bits) = bits {
        let _ = writeln!(text, "bits = {bits}");
    }
    if let Some(blur_px) = measured.edge_blur_px {
        let _ = writeln!(text, "# if the camera stood still: lens_blur_px = {blur_px:.2}");
    }
    text
}

fn values(measured: &Measurement) -> Vec<(&'static str, String)> {
    let noise = measured.noise.iter().map(|bin| format!("{:.2} at {:.0}", bin.sigma, bin.level)).collect::<Vec<_>>();
    let percent = |share: f64| format!("{:.1} %", share * 100.0);
    let mut values = vec![
        ("noise, one sigma", if noise.is_empty() { format!("{:.2}", measured.noise_sigma) } else { noise.join(", ") }),
        (
            "shared by neighbours",
            format!(
                "{:+.2}, fine part {:.2} of what it should be",
                measured.noise_correlation, measured.noise_roughness
            ),
        ),
        (
            "even over odd, noise",
            format!("{:.2} columns, {:.2} rows", measured.noise_parity_columns, measured.noise_parity_rows),
        ),
        ("black, white", format!("{}, {}", percent(measured.clipped_dark), percent(measured.clipped_bright))),
        (
            "levels used",
            format!(
                "{:.0} of {:.0} from {:.0} to {:.0}",
                measured.levels_used, measured.levels_between, measured.darkest, measured.brightest
            ),
        ),
        ("offsets, one sigma", format!("{:.2} columns, {:.2} rows", measured.column_offsets, measured.row_offsets)),
        ("steps between blocks", format!("{:+.0} %", measured.block_excess * 100.0)),
        ("bands", format!("{}, {:.1} in the frame", percent(measured.band_amplitude), measured.band_periods)),
    ];
    values.push(("edges", edges(measured)));
    values
}

fn edges(measured: &Measurement) -> String {
    let Some(blur_px) = measured.edge_blur_px else {
        return "too few isolated upright ones to tell blur and halos".to_string();
    };
    let [dark, bright] = [measured.halo_dark, measured.halo_bright].map(|share| share * 100.0);
    format!(
        "{:.0} crossings, blur {blur_px:.2} px, overshoot {dark:.1} % dark, {bright:.1} % bright",
        measured.edge_crossings
    )
}
