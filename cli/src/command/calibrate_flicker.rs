//! Command `calibrate flicker`: the line time from frames of what a flickering lamp lights.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Result, bail, ensure};
use image::GrayImage;
use serde::Serialize;
use shutter_range::calibrate::{FlickerMeter, Lamp, LineTime};

use crate::calibrate_arguments::FlickerArgs;
use crate::input::picture::{self, PictureFormat};
use crate::input::size::{self, Size};
use crate::inspection::stillness::share_moved;
use crate::output::chart::{Axis, Chart};
use crate::output::rounding::with_sigma;

/// Where more of the pixels than this move from frame to frame, what looks like bands may be the scene: in a street at
/// 1.5 m/s 14 % do, at rest before a lamp, however deep its bands, hardly any
/// (`a_camera_that_moves_tells_no_line_time`).
const MOST_MOVED: f64 = 0.05;

/// Rows of the largest sensors.
const ROWS: usize = 8192;
type Meter = FlickerMeter<f64, ROWS>;

#[derive(Serialize)]
pub(crate) struct Document {
    /// `ok`, or why there is no line time.
    pub(crate) status: &'static str,
    line_time_us: Option<f64>,
    sigma_line_time_us: Option<f64>,
    /// Of all rows of the frame.
    readout_s: Option<f64>,
    /// Relative.
    sigma_readout: Option<f64>,
    rows: u32,
    frames: usize,
    frequency_hz: f64,
    /// Periods of the lamp in a frame.
    periods: Option<f64>,
    /// The same in words for a person.
    message: Option<String>,
    hints: Vec<String>,
}

/// The brightness of each row of the frames, in 1/256 grey level, and what follows from it.
pub(crate) struct Outcome {
    pub(crate) document: Document,
    means_q8: Vec<Vec<u16>>,
}

pub(crate) fn measure(arguments: &FlickerArgs) -> Result<Outcome> {
    let Some(first) = arguments.files.first() else { bail!("there is no frame") };
    let format = PictureFormat { size: arguments.raw.map(|raw| raw.size), raw: arguments.raw, bits: None };
    let size = match arguments.raw {
        Some(raw) => raw.size,
        None => Size::of(&picture::load_grey(first, &format)?),
    };
    ensure!(size.rows as usize <= ROWS, "the frames have {} rows, but must have at most {ROWS}", size.rows);
    let mut meter = Box::new(meter(arguments, size)?);
    let (mut means_q8, mut moved) = (Vec::new(), 0.0);
    let mut before: Option<GrayImage> = None;
    for file in &arguments.files {
        let picture = picture::load_grey(file, &format)?;
        let [name, first_name] = [file, first].map(|path| path.display().to_string());
        size::refuse_unlike((&name, Size::of(&picture)), (&first_name, size))?;
        let means = row_means_q8(&picture);
        means.iter().for_each(|mean_q8| meter.row(*mean_q8));
        meter.end_frame();
        means_q8.push(means);
        moved += before.as_ref().map_or(0.0, |before| share_moved(before, &picture));
        before = Some(picture);
    }
    let moved = moved / (arguments.files.len() as f64 - 1.0).max(1.0);
    let found = if moved > MOST_MOVED {
        Err(("moving", is_moving(moved)))
    } else {
        meter.line_time().map_err(|refusal| (refusal.name(), refusal.to_string()))
    };
    let document = Document::new(arguments, size, found, hints(arguments, &means_q8));
    Ok(Outcome { document, means_q8 })
}

fn is_moving(share: f64) -> String {
    format!(
        "{:.0} % of the pixels change by more than the light of their row: hold the camera still before a scene at rest",
        share * 100.0
    )
}

fn meter(arguments: &FlickerArgs, size: Size) -> Result<Meter> {
    let lamp = match arguments.frequency_hz {
        // Mains, whose grid wanders.
        100.0 => Lamp::on_50_hz_mains(),
        120.0 => Lamp::on_60_hz_mains(),
        frequency_hz => Lamp::new(frequency_hz)?,
    };
    let lamp = arguments.sigma_hz.map_or(Ok(lamp), |sigma_hz| lamp.with_sigma(sigma_hz / arguments.frequency_hz))?;
    let rows = u16::try_from(size.rows)?;
    let meter = Meter::new(rows, lamp)?;
    let meter = arguments.exposure_s.map_or(Ok(meter.clone()), |exposure_s| meter.with_exposure_s(exposure_s))?;
    let interval_s = arguments.frame_rate_hz.map(|frame_rate_hz| 1.0 / frame_rate_hz);
    Ok(interval_s.map_or(Ok(meter.clone()), |interval_s| meter.with_frame_interval_s(interval_s))?)
}

fn row_means_q8(picture: &GrayImage) -> Vec<u16> {
    let mean_q8 = |row: &[u8]| {
        let sum: u64 = row.iter().map(|pixel| u64::from(*pixel)).sum();
        (sum * 256 / (row.len() as u64).max(1)) as u16
    };
    picture.as_raw().chunks(picture.width() as usize).map(mean_q8).collect()
}

fn hints(arguments: &FlickerArgs, means_q8: &[Vec<u16>]) -> Vec<String> {
    let mut hints = Vec::new();
    let frequency_hz = arguments.frequency_hz;
    if frequency_hz == 50.0 || frequency_hz == 60.0 {
        hints.push(format!(
            "a lamp on mains of {frequency_hz} Hz flickers at {} Hz: give that as --frequency-hz",
            2.0 * frequency_hz
        ));
    }
    let rows: Vec<_> = means_q8.iter().flatten().copied().collect();
    let share = |is: fn(&u16) -> bool| rows.iter().filter(|mean| is(mean)).count() as f64 / rows.len().max(1) as f64;
    for (what, part) in [("white", share(|mean_q8| *mean_q8 > 250 << 8)), ("black", share(|mean_q8| *mean_q8 < 4 << 8))]
    {
        if part > 0.05 {
            hints.push(format!("{:.0} % of the rows are {what}: change the exposure or the light", part * 100.0));
        }
    }
    hints
}

impl Document {
    fn new(
        arguments: &FlickerArgs,
        size: Size,
        found: Result<LineTime<f64>, (&'static str, String)>,
        hints: Vec<String>,
    ) -> Self {
        let found_one = found.as_ref().ok();
        let line_time_us = found_one.map(LineTime::line_time_us);
        let sigma_readout = found_one.map(|found| found.sigma);
        Self {
            status: found.as_ref().map_or_else(|(name, _)| *name, |_| "ok"),
            line_time_us,
            sigma_line_time_us: line_time_us.zip(sigma_readout).map(|(us, sigma)| us * sigma),
            readout_s: line_time_us.map(|us| us * 1e-6 * f64::from(size.rows)),
            sigma_readout,
            rows: size.rows,
            frames: arguments.files.len(),
            frequency_hz: arguments.frequency_hz,
            periods: found_one.map(|found| found.periods),
            message: found.err().map(|(_, message)| message),
            hints,
        }
    }
}

pub(crate) fn text(document: &Document) -> String {
    let mut text = String::new();
    let values = document.line_time_us.zip(document.sigma_line_time_us).zip(document.readout_s.zip(document.periods));
    if let Some(((line_time_us, sigma_us), (readout_s, periods))) = values {
        let line_time = with_sigma(line_time_us, sigma_us, 2);
        let (rows, frames) = (document.rows, document.frames);
        let _ = writeln!(text, "line time {line_time} us, readout {:.3} ms of {rows} rows", readout_s * 1e3);
        let _ = writeln!(text, "({periods:.2} periods of the lamp in each of {frames} frames)\n");
        let _ = writeln!(text, "For the setup:\n[camera]\nline_time_us = {line_time_us:.5}");
        let _ = writeln!(text, "sigma_readout = {:.6}", line_time_sigma(sigma_us / line_time_us));
    } else if let Some(message) = &document.message {
        let _ = writeln!(text, "no line time: {message}");
    }
    for hint in &document.hints {
        let _ = writeln!(text, "hint: {hint}");
    }
    text
}

/// Rounded up, to parts per million.
fn line_time_sigma(relative: f64) -> f64 {
    (relative * 1e6).ceil() / 1e6
}

/// The logarithm of two frames' ratio, row by row, and the bands that were found in it.
pub(crate) fn chart(outcome: &Outcome, name: &Path) -> Result<String> {
    let [first, second, ..] = &outcome.means_q8[..] else { bail!("{}: a chart needs two frames", name.display()) };
    let ratios: Vec<f64> =
        first.iter().zip(second).map(|(a, b)| (f64::from((*b).max(256)) / f64::from((*a).max(256))).ln()).collect();
    let points: Vec<_> = (0..).map(f64::from).zip(ratios.iter().copied()).collect();
    let most = ratios.iter().map(|ratio| ratio.abs()).fold(0.01, f64::max) * 1.2;
    let title = "Bands of the lamp: logarithm of the ratio of two frames";
    let chart = Chart::new(title, Axis::new("row", 0.0, ratios.len() as f64), Axis::new("ln", -most, most));
    let chart = chart.points("rows", points);
    let chart = match outcome.document.periods {
        Some(periods) => chart.curve(&format!("{periods:.2} periods in a frame"), fundamental(&ratios, periods)),
        None => chart,
    };
    chart.to_svg()
}

/// Mean and fundamental of the bands, by least squares over whole rows.
fn fundamental(ratios: &[f64], periods: f64) -> Vec<(f64, f64)> {
    let rows = ratios.len() as f64;
    let mean = ratios.iter().sum::<f64>() / rows;
    let angle = |row: usize| std::f64::consts::TAU * periods * row as f64 / rows;
    let part = |wave: fn(f64) -> f64| {
        ratios.iter().enumerate().map(|(row, ratio)| 2.0 / rows * (ratio - mean) * wave(angle(row))).sum::<f64>()
    };
    let (cosine, sine) = (part(f64::cos), part(f64::sin));
    let value = |row: usize| mean + cosine * angle(row).cos() + sine * angle(row).sin();
    (0..ratios.len()).map(|row| (row as f64, value(row))).collect()
}
