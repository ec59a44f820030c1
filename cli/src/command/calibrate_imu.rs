//! Command `calibrate imu`: offset of the gyroscope's clock, and gravity, from frames of a camera that turns before
//! upright edges.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use serde::Serialize;
use shutter_range::calibrate::{ImuCalibration, ImuEstimate, ImuRefusal};
use shutter_range::{Line, Motion, Polarity, Setup, Uncertainty, fit};

use super::frame;
use crate::calibrate_arguments::ImuArgs;
use crate::input::frame_times::FrameName;
use crate::input::picture::{self, PictureFormat};
use crate::input::repeated_stamps::Sample;
use crate::input::setup::SetupFile;
use crate::input::trajectory_file;
use crate::output::chart::{Axis, Chart};
use crate::output::progress;
use crate::output::rounding::with_sigma;
use crate::ranging::camera_motion::CameraMotion;
use crate::ranging::tracking::KNOTS;
use crate::setup_arguments::MotionArgs;

/// The clock a step early and late: short against any swing, long against the rounding of stamps.
const STEP_S: f64 = 0.002;
/// Edges in sight during one swing.
const EDGES: usize = 512;
/// An edge that is seen again is expected this near to where it was, in radians: half a degree.
const SAME_EDGE_RAD: f64 = 0.009;
/// The estimate has settled after two or three rounds.
const ROUNDS: usize = 5;

#[derive(Serialize)]
pub(crate) struct Document {
    /// `ok`, or why nothing can be told.
    pub(crate) status: &'static str,
    /// Camera time is the stamp of the gyroscope plus this.
    time_offset_s: Option<f64>,
    sigma_time_offset_s: Option<f64>,
    roll_deg: Option<f64>,
    sigma_roll_deg: Option<f64>,
    pitch_deg: Option<f64>,
    sigma_pitch_deg: Option<f64>,
    gravity: Option<[f64; 3]>,
    misfit: Option<f64>,
    frames: usize,
    lines: u32,
    /// In words for a person.
    message: Option<String>,
    hints: Vec<String>,
}

/// A line of an upright edge, and which edge it is.
struct Seen {
    frame: usize,
    edge: u32,
    line: Line<KNOTS>,
}

/// What is assumed of clock and gravity in a round.
#[derive(Clone, Copy)]
struct Assumed {
    offset_s: f64,
    gravity: [f64; 3],
}

pub(crate) struct Outcome {
    pub(crate) document: Document,
    /// Time and lean in degrees of each line, as the file and the setup have clock and gravity, and as they were found.
    leans: [Vec<(f64, f64)>; 2],
}

struct Calibration<'a> {
    files: &'a [PathBuf],
    motion: &'a MotionArgs,
    setup: SetupFile,
    samples: Vec<Sample>,
    seen: Vec<Seen>,
}

pub(crate) fn measure(arguments: &ImuArgs) -> Result<Outcome> {
    let path = arguments.motion.trajectory.as_deref().context("--trajectory is missing")?;
    let setup = arguments.motion.load_setup(&arguments.setup)?;
    let samples = trajectory_file::load(path, &setup)?;
    let mut calibration =
        Calibration { files: &arguments.files, motion: &arguments.motion, setup, samples, seen: Vec::new() };
    calibration.look()?;
    calibration.solve()
}

impl Calibration<'_> {
    fn names(&self) -> Vec<(i64, FrameName)> {
        let name = |file: &PathBuf| FrameName {
            long: file.display().to_string(),
            short: file.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        };
        (0..).zip(self.files.iter().map(name)).collect()
    }

    /// Finds the lines of all frames, and the edges that they belong to by their azimuths.
    fn look(&mut self) -> Result<()> {
        let size = self.setup.size();
        let format = PictureFormat { size: Some(size), raw: None, bits: self.setup.bits };
        let starts = CameraMotion::of_samples(self.motion, &self.setup, self.names(), self.samples.clone())?;
        ensure!(starts.is_sequence(), "several frames need --frame-interval-s or --frame-times: when does each start?");
        let least_points = self.setup.setup.readout().rows() / 4;
        let bar = progress::bar(self.files.len() as u64);
        let mut known: Vec<(f64, Polarity)> = Vec::new();
        for (frame, file) in self.files.iter().enumerate() {
            let pixels = picture::load_grey(file, &format)?;
            let lines =
                frame::lines_of_grey(&pixels, &self.setup.setup).with_context(|| file.display().to_string())?.lines;
            let turned = self.turned(starts.start_s(frame as i64));
            for line in lines.into_iter().filter(|line| line.points() >= least_points) {
                let edge = edge_of(&mut known, self.bearing(&line).atan() + turned, line.first().polarity);
                self.seen.push(Seen { frame, edge, line });
            }
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(())
    }

    fn bearing(&self, line: &Line<KNOTS>) -> f64 {
        let (first, last) = (line.first(), line.last());
        let column_px = 0.5 * (first.column_px::<f64>() + last.column_px::<f64>());
        let row_px = 0.5 * (f64::from(first.row) + f64::from(last.row));
        self.setup.setup.camera().ray(column_px, row_px).map_or(0.0, |ray| ray.u)
    }

    /// How far the camera has turned about gravity since the first frame, in radians.
    fn turned(&self, time_s: f64) -> f64 {
        let down = self.setup.motion.gravity();
        let about = |sample: &Sample| (0..3).map(|axis| sample.rate_rad_s[axis] * down[axis]).sum::<f64>();
        let pairs = self.samples.iter().zip(self.samples.iter().skip(1));
        pairs.fold(0.0, |sum, (a, b)| {
            let (from, to) = (a.time_ns as f64 * 1e-9, b.time_ns as f64 * 1e-9);
            let within = (to.min(time_s) - from.max(0.0)).max(0.0);
            sum + within * 0.5 * (about(a) + about(b))
        })
    }

    /// The samples on the camera's clock, as it is assumed.
    fn motion(&self, assumed: &Assumed, step_s: f64) -> Result<CameraMotion> {
        let offset_ns = ((assumed.offset_s + step_s) * 1e9).round() as i64;
        let change = |axis: usize| assumed.gravity[axis] - self.setup.motion.gravity()[axis];
        let at = |sample: &Sample| {
            // One that was measured is off by the same as that of the setup.
            let measured = sample.gravity.map(|[x, y, z]| {
                let length = (x * x + y * y + z * z).sqrt();
                [x / length + change(0), y / length + change(1), z / length + change(2)]
            });
            Sample {
                time_ns: sample.time_ns + offset_ns,
                velocity_m_s: [0.0; 3],
                gravity: Some(measured.unwrap_or(assumed.gravity)),
                ..*sample
            }
        };
        CameraMotion::of_samples(self.motion, &self.setup, self.names(), self.samples.iter().map(at).collect())
    }

    fn round(&self, assumed: &Assumed) -> Result<Result<ImuEstimate<f64>, ImuRefusal<f64>>> {
        let lean = self.setup.setup.uncertainty().sigma_tilt.clamp(1e-4, 0.1);
        let mut calibration = ImuCalibration::<f64, EDGES>::new(assumed.gravity, STEP_S, lean)?;
        let mut motions = [self.motion(assumed, -STEP_S)?, self.motion(assumed, 0.0)?, self.motion(assumed, STEP_S)?];
        for seen in &self.seen {
            let number = seen.frame as i64;
            let [early, now, late] = motions.each_mut().map(|motion| motion.in_frame(number, None));
            let (early, now, late) = (early?, now?, late?);
            // A line that cannot be fitted tells nothing.
            let _ = calibration.line(&self.setup.setup, [&early, &now, &late], seen.edge, &seen.line);
        }
        Ok(calibration.estimate())
    }

    fn solve(&self) -> Result<Outcome> {
        let start = Assumed { offset_s: 0.0, gravity: self.setup.motion.gravity() };
        let mut assumed = start;
        let mut last = self.round(&assumed)?;
        for _ in 1..ROUNDS {
            let Ok(found) = &last else { break };
            let is_settled = found.time_offset_s.abs() < 0.1 * found.sigma_time_offset_s;
            assumed = Assumed { offset_s: assumed.offset_s + found.time_offset_s, gravity: found.gravity };
            if is_settled {
                break;
            }
            last = self.round(&assumed)?;
        }
        let leans = [self.leans(&start)?, self.leans(&assumed)?];
        Ok(Outcome { document: Document::new(&start, &assumed, &last, self.files.len()), leans })
    }

    /// Time since the first frame and lean of each line.
    fn leans(&self, assumed: &Assumed) -> Result<Vec<(f64, f64)>> {
        let setup: Setup<f64> = self.setup.setup.with_uncertainty(Uncertainty::NONE.with_sigma_tilt(1.0))?;
        let mut motion = self.motion(assumed, 0.0)?;
        let mut leans = Vec::new();
        for seen in &self.seen {
            let start_s = motion.start_s(seen.frame as i64);
            let in_frame = motion.in_frame(seen.frame as i64, None)?;
            if let Ok(fitted) = fit::<f64, _, KNOTS>(&setup, &in_frame, seen.line.samples()) {
                leans.push((start_s, fitted.tilt.atan().to_degrees()));
            }
        }
        Ok(leans)
    }
}

/// The number of the edge at an azimuth: one that is known, or another one.
fn edge_of(known: &mut Vec<(f64, Polarity)>, azimuth: f64, polarity: Polarity) -> u32 {
    let off = |(other, _): &(f64, Polarity)| (other - azimuth).abs();
    let alike = known.iter().enumerate().filter(|(_, edge)| edge.1 == polarity && off(edge) < SAME_EDGE_RAD);
    let nearest = alike.min_by(|(_, a), (_, b)| off(a).total_cmp(&off(b))).map(|(index, _)| index);
    let index = nearest.unwrap_or(known.len());
    match known.get_mut(index) {
        // The azimuth of the gyroscope drifts, and the edge with it.
        Some(edge) => edge.0 = azimuth,
        None => known.push((azimuth, polarity)),
    }
    index as u32
}

impl Document {
    fn new(
        start: &Assumed,
        assumed: &Assumed,
        found: &Result<ImuEstimate<f64>, ImuRefusal<f64>>,
        frames: usize,
    ) -> Self {
        let found_one = found.as_ref().ok();
        let value = |value: fn(&ImuEstimate<f64>) -> f64| found_one.map(value);
        // Roll and pitch are those of gravity: how far down leans to the right and towards the scene.
        let angle = |axis: usize| (assumed.gravity[axis] / assumed.gravity[1]).atan().to_degrees();
        let is_unknown = found_one.is_some_and(|found| found.sigma_time_offset_s > 0.05);
        let hint = "the rotation hardly changes: turn back and forth to tell the offset of the clock";
        Self {
            status: found.as_ref().map_or_else(|refusal| refusal.name(), |_| "ok"),
            time_offset_s: found_one.map(|_| assumed.offset_s - start.offset_s),
            sigma_time_offset_s: value(|found| found.sigma_time_offset_s),
            roll_deg: found_one.map(|_| angle(0)),
            sigma_roll_deg: value(|found| found.sigma_roll_rad.to_degrees()),
            pitch_deg: found_one.map(|_| angle(2)),
            sigma_pitch_deg: value(|found| found.sigma_pitch_rad.to_degrees()),
            gravity: found_one.map(|_| assumed.gravity),
            misfit: value(|found| found.misfit),
            frames,
            lines: found_one.map_or(0, |found| found.lines),
            message: found.as_ref().err().map(ToString::to_string),
            hints: is_unknown.then(|| hint.to_string()).into_iter().collect(),
        }
    }
}

pub(crate) fn text(document: &Document) -> String {
    let mut text = String::new();
    let values = [
        (
            "time offset (s), to be added to the gyroscope's stamps",
            document.time_offset_s,
            document.sigma_time_offset_s,
        ),
        ("roll (deg), down leans to the right of the image", document.roll_deg, document.sigma_roll_deg),
        ("pitch (deg), down leans towards the scene", document.pitch_deg, document.sigma_pitch_deg),
    ];
    for (name, value, sigma) in values {
        if let Some((value, sigma)) = value.zip(sigma) {
            let _ = writeln!(text, "{name}: {}", with_sigma(value, sigma, 2));
        }
    }
    if let Some(([x, y, z], sigma_deg)) = document.gravity.zip(document.sigma_roll_deg) {
        let _ = writeln!(text, "({} lines of {} frames)\n", document.lines, document.frames);
        let sigma_deg = document.sigma_pitch_deg.map_or(sigma_deg, |pitch| sigma_deg.max(pitch));
        let _ = writeln!(text, "For the setup:\n[attitude]\ngravity = [{x:.5}, {y:.5}, {z:.5}]");
        let _ = writeln!(text, "sigma_gravity_deg = {sigma_deg:.3}");
    }
    if let Some(message) = &document.message {
        let _ = writeln!(text, "nothing can be told: {message}");
    }
    for hint in &document.hints {
        let _ = writeln!(text, "hint: {hint}");
    }
    text
}

/// The lean of each line over time, before and after.
pub(crate) fn chart(outcome: &Outcome, name: &Path) -> Result<String> {
    let [before, after] = &outcome.leans;
    let until = before.iter().map(|(time_s, _)| *time_s).fold(0.0, f64::max);
    ensure!(until > 0.0, "{}: a chart needs lines of several frames", name.display());
    let most = before.iter().chain(after).map(|(_, lean)| lean.abs()).fold(0.05, f64::max).min(15.0) * 1.1;
    Chart::new("Leans of upright edges", Axis::new("time (s)", 0.0, until), Axis::new("lean (deg)", -most, most))
        .points("as given", before.clone())
        .points("with the offset and the gravity found", after.clone())
        .to_svg()
        .map_err(|error| anyhow!("{}: {error}", name.display()))
}
