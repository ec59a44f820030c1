//! Command `frame`: ranges from whole frames.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use image::{DynamicImage, GrayImage};
use shutter_range::format::Pixels;
use shutter_range::{Counters, Line, Motion, Ranger, RowError, Setup};

use crate::arguments::FrameArgs;
use crate::input::frame_source::{self, FoundFrame, FrameSource};
use crate::input::frame_times::FrameName;
use crate::input::picture::{Picture, PictureFormat};
use crate::input::setup::SetupFile;
use crate::output::frame_writer::FrameWriter;
use crate::output::html_report::HtmlReport;
use crate::output::map::Map;
use crate::output::outputs::{self, Output};
use crate::output::overlay;
use crate::output::progress;
use crate::output::report::Frame;
use crate::output::terminal;
use crate::ranging::camera_motion::CameraMotion;
use crate::ranging::frame_sequence::FrameSequence;
use crate::ranging::hints;
use crate::ranging::tracking::{KNOTS, LINES};
use crate::ranging::workers::{self, Results};

/// More points on one row than a picture shows.
type LargeRanger = Ranger<LINES, KNOTS, 2048>;

/// How many frames have failed; standard error says why.
pub(crate) struct Failures(pub(crate) usize);

/// Refuses frames that need further arguments, or that some arguments do not go with.
pub(crate) fn check_inputs(arguments: &FrameArgs) -> Result<(), String> {
    let files = &arguments.files;
    let has_video = files.iter().any(|file| frame_source::is_video(file));
    if has_video && arguments.motion.frame_times.is_some() {
        return Err(
            "--frame-times: how many frames a video has is not known beforehand: give --frame-interval-s".to_string()
        );
    }
    if has_video && arguments.raw.is_some() {
        return Err("--raw: a y4m video has a header; give dumps as files".to_string());
    }
    // A video counts as several.
    let frames = files.len() + usize::from(has_video);
    if arguments.map.is_some() && frames > 1 && !arguments.motion.is_sequence() {
        return Err(
            "--map of several frames needs --frame-interval-s or --frame-times: how far apart are they?".to_string()
        );
    }
    arguments.motion.check_frames(frames)
}

/// Refuses outputs in place of what is read or of each other.
pub(crate) fn check_outputs(arguments: &FrameArgs, overlays: &[PathBuf]) -> Result<(), String> {
    let FrameArgs { files, setup, motion, report, map, .. } = arguments;
    let inputs = files.iter().map(PathBuf::as_path).chain(setup.files()).chain(motion.files());
    let others = Output::of_options(&[("--report", report.as_deref()), ("--map", map.as_deref())]);
    let all: Vec<Output> = overlay::outputs(files, overlays).chain(others).collect();
    outputs::check(inputs, &all)
}

/// Frames are read and searched for edges by many threads; their ranges follow in the order of the frames.
pub(crate) fn ranges(
    arguments: &FrameArgs,
    overlays: &[PathBuf],
    setup: &SetupFile,
    writer: &mut FrameWriter,
) -> Result<Failures> {
    let size = setup.size();
    if let Some(raw) = arguments.raw {
        let camera = "(`camera.columns` × `camera.rows` of the setup)";
        ensure!(raw.size == size, "--raw says {} pixels, but must say {size} {camera}", raw.size);
    }
    let format = PictureFormat { size: Some(size), raw: arguments.raw, bits: setup.bits };
    let motion = CameraMotion::new(&arguments.motion, setup, (0..).zip(names(&arguments.files)).collect())?;
    let ranging = Ranging {
        sequence: FrameSequence::new(setup, &motion, 0, arguments.motion.all)?,
        motion,
        number: 0,
        overlays,
        writer,
        map: arguments.map.as_deref().map(Map::new),
        report: arguments.report.as_deref().map(HtmlReport::new),
        failures: 0,
    };
    let keeps_pictures = !overlays.is_empty() || arguments.report.is_some();
    let search = |found: FoundFrame| Searched::new(found, &format, &setup.setup, keeps_pictures);
    let has_video = arguments.files.iter().any(|file| frame_source::is_video(file));
    let bar = progress::bar(if has_video { 0 } else { arguments.files.len() as u64 });
    let source = FrameSource::new(&arguments.files, format);
    let jobs = arguments.jobs.map_or_else(workers::cores, usize::from);
    workers::in_order(jobs, source, search, |results| ranging.all(results, &bar))
}

fn names(files: &[PathBuf]) -> impl Iterator<Item = FrameName> {
    files.iter().map(|file| FrameName {
        long: file.display().to_string(),
        short: file.file_name().unwrap_or_default().to_string_lossy().into_owned(),
    })
}

/// A frame whose edges have been searched for.
struct Searched {
    name: String,
    file: usize,
    number: Option<usize>,
    edges: Result<Edges>,
}

struct Edges {
    lines: FoundLines,
    hints: Vec<String>,
    /// Where it is to be shown.
    picture: Option<DynamicImage>,
}

impl Searched {
    fn new(found: FoundFrame, format: &PictureFormat, setup: &Setup<f64>, keeps_picture: bool) -> Self {
        let (name, file, number) = (found.name.clone(), found.file, found.number);
        let edges = found
            .load(format)
            .and_then(|picture| Edges::of(picture, format, setup, keeps_picture).context(name.clone()));
        Self { name, file, number, edges }
    }
}

impl Edges {
    fn of(picture: Picture, format: &PictureFormat, setup: &Setup<f64>, keeps_picture: bool) -> Result<Self> {
        let Picture { image, dump, unused_bits, is_torn } = picture;
        let pixels = image.to_luma8();
        let picture = keeps_picture.then_some(image);
        if is_torn {
            let lines = FoundLines::torn(Counters::default());
            return Ok(Self { lines, hints: vec![TORN.to_string()], picture });
        }
        let lines = match (format.raw, &dump) {
            (Some(raw), Some(dump)) => lines(setup, |row| Some(raw.format.row(raw.row(dump, row)?, row)))?,
            _ => lines_of_grey(&pixels, setup)?,
        };
        let mut hints = hints::of_pixels(&pixels, unused_bits);
        hints.extend(lines.jump.map(|jump| jump.to_string()));
        hints.extend(hints::of_crowded_rows(&lines.counters, setup.readout().rows()));
        Ok(Self { lines, hints, picture })
    }
}

const TORN: &str = "bytes of this JPEG were lost: its parts lie where they do not belong, and no edge of it is told";

/// What goes from frame to frame.
struct Ranging<'a> {
    sequence: FrameSequence,
    motion: CameraMotion,
    /// Of the next frame.
    number: i64,
    overlays: &'a [PathBuf],
    writer: &'a mut FrameWriter,
    map: Option<Map>,
    report: Option<HtmlReport>,
    failures: usize,
}

impl Ranging<'_> {
    fn all(mut self, mut results: Results<Searched>, bar: &indicatif::ProgressBar) -> Result<Failures> {
        let is_sequence = self.motion.is_sequence();
        self.writer.begin()?;
        let mut next = results.next();
        while let Some(searched) = next.take() {
            // A frame on its own need not wait for the next one.
            if is_sequence {
                next = results.next();
            }
            if let Err(error) = self.frame(searched, next.is_some())? {
                bar.suspend(|| terminal::error(&error));
                self.failures += 1;
            }
            bar.inc(1);
            if !self.is_wanted() {
                break;
            }
            if !is_sequence {
                next = results.next();
            }
        }
        bar.finish_and_clear();
        self.map.map_or(Ok(()), Map::write)?;
        self.report.map_or(Ok(()), HtmlReport::finish)?;
        Ok(Failures(self.failures))
    }

    /// Whether anybody reads on, or files are to be written.
    fn is_wanted(&self) -> bool {
        let writes_files = !self.overlays.is_empty() || self.map.is_some() || self.report.is_some();
        self.writer.is_read() || writes_files
    }

    /// The inner error is that of this frame alone.
    fn frame(&mut self, searched: Searched, has_next: bool) -> Result<Result<()>> {
        let Searched { name, file, number: in_video, edges } = searched;
        let (frame, picture) = match self.ranges(name, edges, has_next) {
            Ok(ranged) => ranged,
            Err(error) => return Ok(Err(error)),
        };
        self.writer.write(&frame)?;
        if let Some(report) = &mut self.report {
            report.add(&frame, picture.as_ref())?;
        }
        // The ranges of a frame are reported even if its overlay cannot be written.
        let overlay = self.overlays.get(file).map(|path| overlay::of_frame(path, in_video));
        let overlay = overlay.zip(picture);
        Ok(overlay.map_or(Ok(()), |(path, picture)| overlay::write(&path, picture.into_rgb8(), &frame.ranges)))
    }

    /// Also a frame that cannot be read is one of the sequence.
    fn ranges(&mut self, name: String, edges: Result<Edges>, has_next: bool) -> Result<(Frame, Option<DynamicImage>)> {
        let number = self.number;
        self.number += 1;
        let next = has_next.then_some(self.number);
        let (to_next_s, exposure_s) = (self.motion.to_next_s(number, next), self.motion.exposure_s(number));
        let motion = match self.motion.in_frame(number, next) {
            Ok(motion) => motion,
            Err(error) => {
                self.sequence.restart();
                self.map.iter_mut().for_each(|map| map.advance(None));
                return Err(error.context(name));
            }
        };
        let sequence = &mut self.sequence;
        let ranged = sequence.advance(&motion, to_next_s, exposure_s).and_then(|()| {
            let Edges { lines, hints, picture } = edges?;
            let ranges = sequence.frame(&motion, &lines.lines)?;
            Ok((Frame::new(name, lines.torn, &ranges, &lines.counters, hints), picture))
        });
        if let Some(map) = &mut self.map {
            if let Ok((frame, _)) = &ranged {
                map.add(&frame.ranges, frame.gravity);
            }
            map.advance(Some(&motion.pose(to_next_s)));
        }
        ranged
    }
}

pub(crate) struct FoundLines {
    pub(crate) lines: Vec<Line<KNOTS>>,
    torn: bool,
    /// What has torn it.
    jump: Option<RowError>,
    counters: Counters,
}

impl FoundLines {
    fn torn(counters: Counters) -> Self {
        Self { lines: Vec::new(), torn: true, jump: None, counters }
    }
}

pub(crate) fn lines_of_grey(pixels: &GrayImage, setup: &Setup<f64>) -> Result<FoundLines> {
    let columns = pixels.width() as usize;
    let start = |row: u16| usize::from(row) * columns;
    lines(setup, |row| pixels.as_raw().get(start(row)..start(row) + columns))
}

/// Each frame has a new ranger, whose counters are then those of this frame alone.
fn lines<P: Pixels>(setup: &Setup<f64>, pixels_of: impl Fn(u16) -> Option<P>) -> Result<FoundLines> {
    let mut ranger = Box::new(LargeRanger::new());
    let (mut lines, mut buffer) = (Vec::new(), Vec::new());
    for rows_before in 0..setup.readout().rows() {
        let row = setup.readout().row_after(rows_before);
        let pixels = pixels_of(row).context("the picture is too small")?;
        let taken = match whole_levels(pixels, &mut buffer) {
            Some(levels) => ranger.row(setup, row, levels),
            None => ranger.row(setup, row, pixels),
        };
        match taken {
            Err(jump @ RowError::Jump { .. }) => {
                return Ok(FoundLines { jump: Some(jump), ..FoundLines::torn(*ranger.counters()) });
            }
            taken => taken?,
        }
        lines.extend(std::iter::from_fn(|| ranger.next_line()));
    }
    ranger.end_frame(setup);
    lines.extend(std::iter::from_fn(|| ranger.next_line()));
    Ok(FoundLines { lines, torn: false, jump: None, counters: *ranger.counters() })
}

/// The levels of a row without fractions, so that the same levels are read alike in every format.
fn whole_levels<P: Pixels>(pixels: P, buffer: &mut Vec<u8>) -> Option<&[u8]> {
    if pixels.mosaic_row().is_some() {
        return None;
    }
    buffer.clear();
    for level_q8 in pixels.levels_q8(0..pixels.columns()) {
        let [level, fraction] = level_q8.to_be_bytes();
        if fraction != 0 {
            return None;
        }
        buffer.push(level);
    }
    Some(buffer)
}
