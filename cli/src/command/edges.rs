//! Command `edges`: ranges from edge points, frame by frame.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Error, Result, anyhow, bail};
use shutter_range::Line;

use crate::input::bounded_read;
use crate::input::edge_file::{self, FilePoint, LIMIT};
use crate::input::frame_times::FrameName;
use crate::input::setup::SetupFile;
use crate::output::report::{Document, Frame};
use crate::ranging::camera_motion::{CameraMotion, MotionInFrame};
use crate::ranging::frame_sequence::FrameSequence;
use crate::ranging::stamps;
use crate::ranging::tracking::{self, KNOTS, Tracked};
use crate::setup_arguments::MotionArgs;

pub(crate) fn ranges(path: &Path, setup: &SetupFile, motion: &MotionArgs) -> Result<Document> {
    let name = path.display().to_string();
    let text = if path == Path::new("-") {
        bounded_read::read_standard_input(&LIMIT)?
    } else {
        bounded_read::read_text(path, &LIMIT)?
    };
    let groups = by_frame(&text, setup).with_context(|| name.clone())?;
    motion.check_frames(groups.len()).map_err(Error::msg)?;
    let names = groups.keys().map(|frame| (frame_number(*frame), frame_name(&name, *frame))).collect();
    let camera_motion = CameraMotion::new(motion, setup, names)?;
    let first = groups.keys().next().map_or(0, |frame| frame_number(*frame));
    let sequence = FrameSequence::new(setup, &camera_motion, first, motion.all)?;
    let frames = frames(&name, groups, sequence, camera_motion).with_context(|| name.clone())?;
    Ok(Document { frames })
}

/// The points of each frame; `None` is the only frame of a file that has no column for it.
type Frames = BTreeMap<Option<i64>, Vec<FilePoint>>;

fn by_frame(text: &str, setup: &SetupFile) -> Result<Frames> {
    let file = edge_file::parse(text, setup)?;
    let mut groups = Frames::new();
    if !file.has_frames {
        // A frame without points has a result as well.
        groups.insert(None, Vec::new());
    }
    for point in file.points {
        // A point that names no frame is of frame 0.
        let frame = file.has_frames.then(|| point.frame.unwrap_or(0));
        groups.entry(frame).or_default().push(point);
    }
    Ok(groups)
}

/// The only frame of a file is number 0.
fn frame_number(frame: Option<i64>) -> i64 {
    frame.unwrap_or(0)
}

fn frame_name(file: &str, frame: Option<i64>) -> FrameName {
    match frame {
        Some(number) => FrameName { long: format!("{file}#{number}"), short: number.to_string() },
        None => FrameName { long: file.to_string(), short: "0".to_string() },
    }
}

fn frames(name: &str, groups: Frames, mut sequence: FrameSequence, mut motion: CameraMotion) -> Result<Vec<Frame>> {
    let nexts: Vec<_> = groups.keys().skip(1).map(|frame| Some(frame_number(*frame))).chain([None]).collect();
    let mut frames = Vec::new();
    for ((key, points), next) in groups.into_iter().zip(nexts) {
        let number = frame_number(key);
        let (to_next_s, exposure_s) = (motion.to_next_s(number, next), motion.exposure_s(number));
        let motion = motion.in_frame(number, next)?;
        sequence.advance(&motion, to_next_s, exposure_s)?;
        frames.push(frame(frame_name(name, key).long, points, &mut sequence, &motion)?);
    }
    Ok(frames)
}

/// Points that name a line are that line; the tracker finds the lines of the others.
fn frame(
    name: String,
    mut points: Vec<FilePoint>,
    sequence: &mut FrameSequence,
    motion: &MotionInFrame<'_>,
) -> Result<Frame> {
    let hint = stamps::settle(&mut points, sequence.setup())?;
    let mut named: BTreeMap<i64, Vec<FilePoint>> = BTreeMap::new();
    let mut unnamed = Vec::new();
    for point in points {
        match point.line {
            Some(line) => named.entry(line).or_default().push(point),
            None => unnamed.push(point),
        }
    }
    let Tracked { mut lines, mut counters } = tracking::track(unnamed, sequence.setup())?;
    for (number, points) in named {
        let line = line_of(number, &points)?;
        counters.points += u32::from(line.points());
        lines.push(line);
    }
    let ranges = sequence.frame(motion, &lines)?;
    Ok(Frame::new(name, false, &ranges, &counters, hint.into_iter().collect()))
}

/// The line of points in the order of readout.
fn line_of(number: i64, points: &[FilePoint]) -> Result<Line<KNOTS>> {
    refuse_repeated_rows(number, points)?;
    let Some((first, others)) = points.split_first() else { bail!("line {number} has no edge points") };
    let mut line = Line::new(first.point);
    for point in others {
        let pushed = line.push(point.point);
        pushed.map_err(|_| anyhow!("line {}: `row` {} comes out of order", point.at, point.point.row))?;
    }
    Ok(line)
}

fn refuse_repeated_rows(number: i64, points: &[FilePoint]) -> Result<()> {
    let repeated = points.windows(2).find_map(|pair| match pair {
        [a, b] if a.point.row == b.point.row => Some((a, b)),
        _ => None,
    });
    match repeated {
        Some((a, b)) => bail!(
            "lines {} and {}: `line` {number} has two edge points on `row` {}, but must have one: number them as two lines",
            a.at.min(b.at),
            a.at.max(b.at),
            a.point.row
        ),
        None => Ok(()),
    }
}
