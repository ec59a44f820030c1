//! Command `calibrate scale`: focal length times line time from passes at known distance and speed.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, Result, bail};
use serde::Serialize;
use shutter_range::calibrate::{Pass, Scale, ScaleRefusal, fit_scale};
use shutter_range::{Line, Setup};

use super::frame;
use crate::calibrate_arguments::ScaleArgs;
use crate::input::pass_file::{self, FilePass, Slope};
use crate::input::picture::{self, PictureFormat};
use crate::output::chart::{Axis, Chart};
use crate::output::rounding::with_sigma;
use crate::output::text_table::{Colour, TextTable};
use crate::ranging::tracking::KNOTS;

/// As many passes as a person drives in a day.
const PASSES: usize = 1024;

/// A hint.
const FOCAL_LENGTH: &str = "with --rows, the rows of a frame, kappa gives the focal length";

#[derive(Serialize)]
pub(crate) struct Document {
    /// `ok`, or why there is no scale.
    pub(crate) status: &'static str,
    /// Focal length in pixels times line time in seconds; null where the passes state their readouts.
    scale_px_s: Option<f64>,
    sigma_scale_px_s: Option<f64>,
    /// Focal length in pixels over the number of rows; null unless the passes or an option state the readout.
    kappa: Option<f64>,
    sigma_kappa: Option<f64>,
    tilt_deg: Option<f64>,
    sigma_tilt_deg: Option<f64>,
    misfit: Option<f64>,
    fx: Option<f64>,
    line_time_us: Option<f64>,
    /// Relative, of whichever was sought.
    relative_sigma: Option<f64>,
    passes: Vec<PassReport>,
    /// In words for a person.
    message: Option<String>,
    hints: Vec<String>,
}

#[derive(Serialize)]
struct PassReport {
    /// Line of the file.
    line: usize,
    speed_m_s: f64,
    distance_m: f64,
    /// In pixels per row.
    slope: f64,
    /// Measured less fitted.
    residual_deg: Option<f64>,
    outlier: bool,
}

pub(crate) fn measure(arguments: &ScaleArgs) -> Result<Document> {
    let file = pass_file::load(&arguments.file)?;
    let name = || arguments.file.display().to_string();
    check_readouts(arguments, &file).with_context(name)?;
    let slopes: Vec<f64> = file.iter().map(slope).collect::<Result<_>>().with_context(name)?;
    let passes = file.iter().zip(&slopes).map(|(pass, slope)| pass.pass(*slope));
    let passes: Vec<Pass<f64>> = passes.collect::<Result<_>>().with_context(name)?;
    let sigma_tilt = arguments.sigma_roll_deg.map(f64::to_radians);
    let found = fit_scale::<f64, PASSES>(&passes, sigma_tilt);
    Ok(Document::new(arguments, &file, &slopes, &found))
}

/// With stated readouts the scale is κ, else κ times the readout. All passes have one, or none has.
fn have_readouts(file: &[FilePass]) -> bool {
    file.first().is_some_and(|pass| pass.readout_s.is_some())
}

/// Refuses options that would say nothing, or something else, beside the passes.
fn check_readouts(arguments: &ScaleArgs, file: &[FilePass]) -> Result<()> {
    let stated = "the column `readout_s` states the readout of each pass";
    match (have_readouts(file), arguments) {
        (true, ScaleArgs { readout_s: Some(_), .. }) => bail!("{stated}: leave out --readout-s, or that column"),
        (true, ScaleArgs { focal_px: Some(_), .. }) => {
            bail!("{stated}, and --focal-px gives the line time where it is not known: leave out one of them")
        }
        (false, ScaleArgs { readout_s: None, rows: Some(_), .. }) => {
            bail!("--rows gives the focal length where the readout is known: give --readout-s, or a column `readout_s`")
        }
        _ => Ok(()),
    }
}

fn slope(pass: &FilePass) -> Result<f64> {
    match &pass.slope {
        Slope::Known(slope) => Ok(*slope),
        Slope::InPicture(path) => slope_in_picture(path).with_context(|| format!("line {}", pass.at)),
    }
}

/// Slope of the longest edge of a picture, in pixels per row.
fn slope_in_picture(path: &Path) -> Result<f64> {
    let pixels = picture::load_grey(path, &PictureFormat { size: None, raw: None, bits: None })?;
    let (columns, rows) = (u16::try_from(pixels.width())?, u16::try_from(pixels.height())?);
    // The tracker needs neither the focal length nor the readout.
    let setup = Setup::pinhole(columns, rows, f64::from(columns), 33_000_000)?;
    let lines = frame::lines_of_grey(&pixels, &setup)?.lines;
    let longest = lines.iter().max_by_key(|line| line.points());
    longest.and_then(slope_of_line).with_context(|| format!("{}: no edge is long enough", path.display()))
}

/// By least squares over the line's knots.
fn slope_of_line(line: &Line<KNOTS>) -> Option<f64> {
    let samples: Vec<_> = line.samples::<f64>().collect();
    let count = samples.len() as f64;
    let row = samples.iter().map(|sample| sample.row_px).sum::<f64>() / count;
    let squares: f64 = samples.iter().map(|sample| (sample.row_px - row).powi(2)).sum();
    let products: f64 = samples.iter().map(|sample| (sample.row_px - row) * sample.column_px).sum();
    (samples.len() > 2).then(|| products / squares)
}

impl Document {
    fn new(
        arguments: &ScaleArgs,
        file: &[FilePass],
        slopes: &[f64],
        found: &Result<Scale<f64, PASSES>, ScaleRefusal<f64>>,
    ) -> Self {
        let found_one = found.as_ref().ok();
        let of_kappa = have_readouts(file);
        let of_scale = |value: fn(&Scale<f64, PASSES>) -> f64| found_one.filter(|_| !of_kappa).map(value);
        let per_readout = if of_kappa { Some(1.0) } else { arguments.readout_s.map(|readout_s| 1.0 / readout_s) };
        let of_kappa_value = |value: f64| per_readout.map(|per_readout| value * per_readout);
        let kappa = found_one.and_then(|found| of_kappa_value(found.scale));
        let line_time_s =
            found_one.filter(|_| !of_kappa).zip(arguments.focal_px).map(|(found, fx)| found.line_time_s(fx));
        Self {
            status: found.as_ref().map_or_else(|refusal| refusal.name(), |_| "ok"),
            scale_px_s: of_scale(|found| found.scale),
            sigma_scale_px_s: of_scale(|found| found.sigma_scale),
            kappa,
            sigma_kappa: found_one.and_then(|found| of_kappa_value(found.sigma_scale)),
            tilt_deg: found_one.map(|found| found.tilt.atan().to_degrees()),
            sigma_tilt_deg: found_one.map(|found| found.sigma_tilt.to_degrees()),
            misfit: found_one.map(|found| found.misfit),
            fx: kappa.zip(arguments.rows).map(|(kappa, rows)| kappa * f64::from(rows)),
            line_time_us: line_time_s.map(|line_time_s| line_time_s * 1e6),
            relative_sigma: found_one.map(Scale::relative_sigma),
            passes: file.iter().zip(slopes).enumerate().map(|(index, pass)| report(index, pass, found_one)).collect(),
            message: found.as_ref().err().map(ToString::to_string),
            hints: kappa.filter(|_| arguments.rows.is_none()).map(|_| FOCAL_LENGTH.to_string()).into_iter().collect(),
        }
    }
}

fn report(index: usize, (pass, slope): (&FilePass, &f64), found: Option<&Scale<f64, PASSES>>) -> PassReport {
    // The slope for a scale of one, which the pass has checked.
    let fitted = found.and_then(|found| pass.per_scale().map(|per_scale| found.scale * per_scale + found.tilt));
    PassReport {
        line: pass.at,
        speed_m_s: pass.speed_m_s,
        distance_m: pass.distance_m,
        slope: *slope,
        residual_deg: fitted.map(|fitted| (slope.atan() - fitted.atan()).to_degrees()),
        outlier: found.and_then(|found| found.outliers.get(index).copied()).unwrap_or(false),
    }
}

pub(crate) fn text(document: &Document, colours: bool) -> String {
    let mut text = String::new();
    let mut table = TextTable::new(["line", "speed (m/s)", "distance (m)", "slope (px/row)", "off (deg)", ""], colours);
    for pass in &document.passes {
        let cells = [
            pass.line.to_string(),
            format!("{:+.3}", pass.speed_m_s),
            format!("{:.3}", pass.distance_m),
            format!("{:+.5}", pass.slope),
            pass.residual_deg.map_or("-".to_string(), |off| format!("{off:+.3}")),
            if pass.outlier { "outlier" } else { "" }.to_string(),
        ];
        table.row(cells, if pass.outlier { Colour::Yellow } else { Colour::Plain });
    }
    table.write_to(&mut text);
    text.push('\n');
    if let Some(message) = &document.message {
        let _ = writeln!(text, "no scale: {message}");
    }
    write_values(document, &mut text);
    for hint in &document.hints {
        let _ = writeln!(text, "hint: {hint}");
    }
    text
}

fn write_values(document: &Document, text: &mut String) {
    let values = [
        ("scale: focal length (px) x line time (s)", document.scale_px_s, document.sigma_scale_px_s),
        ("kappa: focal length (px) / rows", document.kappa, document.sigma_kappa),
        ("constant tilt (deg)", document.tilt_deg, document.sigma_tilt_deg),
    ];
    for (name, value, sigma) in values {
        if let Some((value, sigma)) = value.zip(sigma) {
            let _ = writeln!(text, "{name}: {}", with_sigma_of_two(value, sigma));
        }
    }
    if let Some(misfit) = document.misfit {
        let _ = writeln!(text, "misfit: {misfit:.2} times the stated sigmas");
    }
    let keys = [("line_time_us", document.line_time_us, "sigma_readout"), ("fx", document.fx, "sigma_focal")];
    for (key, value, sigma_key) in keys {
        if let Some((value, sigma)) = value.zip(document.relative_sigma) {
            let _ = writeln!(text, "\nFor the setup:\n[camera]\n{key} = {value:.4}\n{sigma_key} = {sigma:.5}");
        }
    }
}

/// Small scales would lose all their digits.
fn with_sigma_of_two(value: f64, sigma: f64) -> String {
    if value.abs() < 0.01 && sigma < 1e-4 { format!("{value:.3e} ± {sigma:.1e}") } else { with_sigma(value, sigma, 2) }
}

/// Slopes over what they are for a scale of one, and the line through them with its band of two sigma.
pub(crate) fn chart(document: &Document, passes: &Path) -> Result<String> {
    let file = pass_file::load(passes)?;
    let points: Vec<_> = file
        .iter()
        .zip(&document.passes)
        .filter_map(|(pass, report)| Some((pass.per_scale()?, report.slope)))
        .collect();
    let extent = |values: &mut dyn Iterator<Item = f64>| {
        let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
        (low - 0.05 * (high - low), high + 0.05 * (high - low) + f64::MIN_POSITIVE)
    };
    let (from, to) = extent(&mut points.iter().map(|(x, _)| *x));
    let (low, high) = extent(&mut points.iter().map(|(_, y)| *y));
    let axes = (
        Axis::new("speed / distance, times the readout where it is stated", from, to),
        Axis::new("slope (px/row)", low, high),
    );
    let mut chart = Chart::new("Passes: slope of the edge against speed over distance", axes.0, axes.1);
    let scale = document.scale_px_s.zip(document.sigma_scale_px_s).or(document.kappa.zip(document.sigma_kappa));
    if let Some(((scale, sigma), tilt_deg)) = scale.zip(document.tilt_deg) {
        let xs: Vec<f64> = (0..=50).map(|part| from + (to - from) * f64::from(part) / 50.0).collect();
        let fitted = |x: f64| scale * x + tilt_deg.to_radians().tan();
        let sigma_tilt = document.sigma_tilt_deg.unwrap_or(0.0).to_radians();
        let half = |x: f64| 2.0 * (sigma * x).hypot(sigma_tilt);
        chart =
            chart.band("two sigma", xs.iter().map(|x| (*x, fitted(*x) - half(*x), fitted(*x) + half(*x))).collect());
        chart = chart.curve("fit", xs.iter().map(|x| (*x, fitted(*x))).collect());
    }
    chart.points("passes", points).to_svg()
}
