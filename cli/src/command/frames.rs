//! Command `frame`: ranges from whole frames.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use image::GrayImage;
use shutter_range::{Counters, Line, Ranger, Setup};

use crate::arguments::FrameArgs;
use crate::input::picture;
use crate::input::setup::SetupFile;
use crate::input::size::Size;
use crate::output::overlay;
use crate::output::progress;
use crate::output::report::{Document, Frame};
use crate::output::terminal;
use crate::ranging::course::{CameraMotion, Course};
use crate::ranging::sequel::Sequel;
use crate::ranging::tracking::KNOTS;

/// Room for more than any picture shows.
type LargeRanger = Ranger<256, KNOTS, 2048>;

pub(crate) struct Outcome {
    pub(crate) document: Document,
    /// Files of which something failed, which standard error has been told.
    pub(crate) failures: usize,
}

pub(crate) fn ranges(arguments: &FrameArgs, overlays: &[PathBuf], setup: &SetupFile) -> Result<Outcome> {
    let size = setup.size();
    if let Some(raw) = arguments.raw {
        let camera = "(`camera.columns` × `camera.rows` of the setup)";
        anyhow::ensure!(raw == size, "--raw says {raw} pixels, but must say {size} {camera}");
    }
    let mut course = Course::new(&arguments.course, setup)?;
    let mut sequel = Sequel::new(setup, &course);
    let bar = progress::bar(arguments.files.len() as u64);
    let mut outcome = Outcome { document: Document { frames: Vec::new() }, failures: 0 };
    for (number, (index, file)) in (0..).zip(arguments.files.iter().enumerate()) {
        let next = (index + 1 < arguments.files.len()).then_some(number + 1);
        let frames = &mut outcome.document.frames;
        let mut job = Job { sequel: &mut sequel, size, raw: arguments.raw.is_some(), frames };
        let to_next_s = course.to_next_s(number, next);
        let done = match course.motion(number, next) {
            Ok(motion) => {
                let ready = job.sequel.advance(&motion, to_next_s);
                ready.and_then(|()| job.range(file, &motion, overlays.get(index)))
            }
            Err(error) => {
                job.sequel.restart();
                Err(error.context(file.display().to_string()))
            }
        };
        if let Err(error) = done {
            bar.suspend(|| terminal::error(&error));
            outcome.failures += 1;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(outcome)
}

struct Job<'a> {
    sequel: &'a mut Sequel,
    size: Size,
    raw: bool,
    frames: &'a mut Vec<Frame>,
}

impl Job<'_> {
    /// What was found in a frame counts even if its overlay cannot be written.
    fn range(&mut self, file: &Path, motion: &CameraMotion<'_>, overlay: Option<&PathBuf>) -> Result<()> {
        let picture = picture::load(file, self.size, self.raw)?;
        let name = file.display().to_string();
        let seen = lines(&picture.to_luma8(), self.sequel.setup()).with_context(|| name.clone())?;
        let mut ranges = self.sequel.ranges(motion, &seen.lines)?;
        let frame = Frame { torn: seen.torn, ..Frame::new(name, &mut ranges, seen.counters) };
        let drawn = overlay.map(|path| overlay::write(path, picture.into_rgb8(), &frame.ranges));
        self.frames.push(frame);
        drawn.unwrap_or(Ok(()))
    }
}

struct Seen {
    lines: Vec<Line<KNOTS>>,
    torn: bool,
    counters: Counters,
}

/// A new ranger for each frame, so that what one has dropped is told of it alone.
fn lines(pixels: &GrayImage, setup: &Setup<f64>) -> Result<Seen> {
    let mut ranger = Box::new(LargeRanger::new());
    let mut lines = Vec::new();
    let columns = usize::from(setup.camera().intrinsics().columns);
    for rows_before in 0..setup.readout().rows() {
        let row = setup.readout().row_after(rows_before);
        let start = usize::from(row) * columns;
        let of_row = pixels.as_raw().get(start..start + columns);
        ranger.row(setup, row, of_row.context("the picture is too small")?)?;
        lines.extend(std::iter::from_fn(|| ranger.next_line()));
    }
    let torn = ranger.is_torn();
    ranger.end_frame(setup);
    lines.extend(std::iter::from_fn(|| ranger.next_line()));
    Ok(Seen { lines, torn, counters: *ranger.counters() })
}
