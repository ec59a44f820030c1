//! Command `edges`: ranges from edge points, frame by frame.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Error, Result, bail};
use shutter_range::{Line, Setup};

use crate::arguments::CourseArgs;
use crate::input::bounded_read;
use crate::input::edge_file::{self, EdgeRow, LIMIT};
use crate::input::setup::SetupFile;
use crate::output::report::{Document, Frame};
use crate::ranging::course::{CameraMotion, Course};
use crate::ranging::sequel::Sequel;
use crate::ranging::tracking::{self, KNOTS, Tracked, backwards};

pub(crate) fn ranges(path: &Path, setup: &SetupFile, course: &CourseArgs) -> Result<Document> {
    let name = path.display().to_string();
    let text = if path == Path::new("-") {
        bounded_read::read_standard_input(&LIMIT)?
    } else {
        bounded_read::read_text(path, &LIMIT)?
    };
    let groups = by_frame(&text, setup).with_context(|| name.clone())?;
    course.refuse_frames(groups.len()).map_err(Error::msg)?;
    let course = Course::new(course, setup)?;
    let frames = frames(&name, groups, setup, course).with_context(|| name.clone())?;
    Ok(Document { frames })
}

type Frames = BTreeMap<Option<i64>, Vec<EdgeRow>>;

fn by_frame(text: &str, setup: &SetupFile) -> Result<Frames> {
    let file = edge_file::parse(text, setup)?;
    let mut groups = Frames::new();
    if !file.has_frames {
        // Nothing found in the only frame is a result, too.
        groups.insert(None, Vec::new());
    }
    for row in file.rows {
        let frame = file.has_frames.then(|| row.frame.unwrap_or(0));
        groups.entry(frame).or_default().push(row);
    }
    Ok(groups)
}

/// Edges that name no frame are of frame 0.
fn frames(name: &str, groups: Frames, setup: &SetupFile, mut course: Course) -> Result<Vec<Frame>> {
    let number = |frame: &Option<i64>| frame.unwrap_or(0);
    let nexts: Vec<_> = groups.keys().skip(1).map(|frame| Some(number(frame))).chain([None]).collect();
    let mut sequel = Sequel::new(setup, &course);
    let mut frames = Vec::new();
    for ((key, rows), next) in groups.into_iter().zip(nexts) {
        let to_next_s = course.to_next_s(number(&key), next);
        let motion = course.motion(number(&key), next)?;
        sequel.advance(&motion, to_next_s)?;
        let named = key.map_or(name.to_string(), |number| format!("{name}#{number}"));
        frames.push(frame(named, rows, &mut sequel, &motion)?);
    }
    Ok(frames)
}

/// Edges that name their line make one; the tracker sorts out the others.
fn frame(name: String, rows: Vec<EdgeRow>, sequel: &mut Sequel, motion: &CameraMotion<'_>) -> Result<Frame> {
    let mut named: BTreeMap<i64, Vec<EdgeRow>> = BTreeMap::new();
    let mut unassigned = Vec::new();
    for row in rows {
        match row.line {
            Some(line) => named.entry(line).or_default().push(row),
            None => unassigned.push(row),
        }
    }
    let Tracked { mut lines, mut counters } = tracking::track(unassigned, sequel.setup())?;
    for (number, rows) in named {
        let line = line_of(number, rows, sequel.setup())?;
        counters.points += u32::from(line.points());
        lines.push(line);
    }
    Ok(Frame::new(name, &mut sequel.ranges(motion, &lines)?, counters))
}

fn line_of(number: i64, mut rows: Vec<EdgeRow>, setup: &Setup<f64>) -> Result<Line<KNOTS>> {
    let readout = setup.readout();
    rows.sort_by_key(|row| readout.rows_before(row.edge.row));
    refuse_twin_rows(number, &rows)?;
    let Some((first, others)) = rows.split_first() else { bail!("line {number} has no edges") };
    let mut line = Line::new(first.edge);
    for row in others {
        if line.push(row.edge).is_err() {
            bail!("line {}: {}", row.at, backwards(row, line.last().row));
        }
    }
    Ok(line)
}

fn refuse_twin_rows(number: i64, rows: &[EdgeRow]) -> Result<()> {
    let twins = rows.windows(2).find_map(|pair| match pair {
        [a, b] if a.edge.row == b.edge.row => Some((a, b)),
        _ => None,
    });
    match twins {
        Some((a, b)) => bail!(
            "lines {} and {}: `line` {number} has two edge points on `row` {}, but must have one: number them as two lines",
            a.at.min(b.at),
            a.at.max(b.at),
            a.edge.row
        ),
        None => Ok(()),
    }
}
