//! Command `frame`: ranges from whole frames.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use image::GrayImage;
use shutter_range::{Counters, Line, Motion, Ranger, Setup};

use crate::arguments::FrameArgs;
use crate::input::frame_times::FrameName;
use crate::input::picture::{self, Picture, PictureFormat};
use crate::input::setup::SetupFile;
use crate::output::map::Map;
use crate::output::overlay;
use crate::output::progress;
use crate::output::report::{Document, Frame};
use crate::output::terminal;
use crate::ranging::camera_motion::{CameraMotion, MotionInFrame};
use crate::ranging::frame_sequence::FrameSequence;
use crate::ranging::hints;
use crate::ranging::tracking::KNOTS;

/// More lines, and more points on one row, than a picture shows.
type LargeRanger = Ranger<256, KNOTS, 2048>;

pub(crate) struct Outcome {
    pub(crate) document: Document,
    /// How many files have failed; standard error says why.
    pub(crate) failures: usize,
}

pub(crate) fn ranges(arguments: &FrameArgs, overlays: &[PathBuf], setup: &SetupFile) -> Result<Outcome> {
    let size = setup.size();
    if let Some(raw) = arguments.raw {
        let camera = "(`camera.columns` × `camera.rows` of the setup)";
        ensure!(raw == size, "--raw says {raw} pixels, but must say {size} {camera}");
    }
    let format = PictureFormat { size, raw: arguments.raw.is_some(), bits: setup.bits };
    let mut motion = CameraMotion::new(&arguments.motion, setup, (0..).zip(names(&arguments.files)).collect())?;
    let mut sequence = FrameSequence::new(setup, &motion, arguments.motion.all)?;
    let mut map = Map::new();
    let bar = progress::bar(arguments.files.len() as u64);
    let mut outcome = Outcome { document: Document { frames: Vec::new() }, failures: 0 };
    for (number, (index, file)) in (0..).zip(arguments.files.iter().enumerate()) {
        let next = (index + 1 < arguments.files.len()).then_some(number + 1);
        let frames = &mut outcome.document.frames;
        let mut job = Job { sequence: &mut sequence, format, frames };
        let to_next_s = motion.to_next_s(number, next);
        let result = match motion.in_frame(number, next) {
            Ok(motion) => {
                let advanced = job.sequence.advance(&motion, to_next_s);
                let result = advanced.and_then(|()| job.range(file, &motion, overlays.get(index)));
                if let Some(frame) = job.frames.last().filter(|_| result.is_ok()) {
                    map.add(&frame.ranges, frame.gravity);
                }
                map.advance(Some(&motion.pose(to_next_s)));
                result
            }
            Err(error) => {
                job.sequence.restart();
                map.advance(None);
                Err(error.context(file.display().to_string()))
            }
        };
        if let Err(error) = result {
            bar.suspend(|| terminal::error(&error));
            outcome.failures += 1;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if let Some(path) = &arguments.map {
        map.write(path)?;
    }
    Ok(outcome)
}

fn names(files: &[PathBuf]) -> impl Iterator<Item = FrameName> {
    files.iter().map(|file| FrameName {
        long: file.display().to_string(),
        short: file.file_name().unwrap_or_default().to_string_lossy().into_owned(),
    })
}

struct Job<'a> {
    sequence: &'a mut FrameSequence,
    format: PictureFormat,
    frames: &'a mut Vec<Frame>,
}

impl Job<'_> {
    /// The ranges of a frame are reported even if its overlay cannot be written.
    fn range(&mut self, file: &Path, motion: &MotionInFrame<'_>, overlay: Option<&PathBuf>) -> Result<()> {
        let Picture { image, unused_bits } = picture::load(file, &self.format)?;
        let name = file.display().to_string();
        let pixels = image.to_luma8();
        let found = lines(&pixels, self.sequence.setup()).with_context(|| name.clone())?;
        let ranges = self.sequence.frame(motion, &found.lines)?;
        let hints = hints::of_pixels(&pixels, unused_bits);
        let frame = Frame::new(name, found.torn, &ranges, &found.counters, hints);
        let written = overlay.map(|path| overlay::write(path, image.into_rgb8(), &frame.ranges));
        self.frames.push(frame);
        written.unwrap_or(Ok(()))
    }
}

struct FoundLines {
    lines: Vec<Line<KNOTS>>,
    torn: bool,
    counters: Counters,
}

/// Each frame has a new ranger, whose counters are then those of this frame alone.
fn lines(pixels: &GrayImage, setup: &Setup<f64>) -> Result<FoundLines> {
    let mut ranger = Box::new(LargeRanger::new());
    let mut lines = Vec::new();
    let columns = usize::from(setup.camera().intrinsics().columns);
    for rows_before in 0..setup.readout().rows() {
        let row = setup.readout().row_after(rows_before);
        let start = usize::from(row) * columns;
        let row_pixels = pixels.as_raw().get(start..start + columns);
        ranger.row(setup, row, row_pixels.context("the picture is too small")?)?;
        lines.extend(std::iter::from_fn(|| ranger.next_line()));
    }
    let torn = ranger.is_torn();
    ranger.end_frame(setup);
    lines.extend(std::iter::from_fn(|| ranger.next_line()));
    Ok(FoundLines { lines, torn, counters: *ranger.counters() })
}
