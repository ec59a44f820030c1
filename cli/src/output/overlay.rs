//! Overlays: each edge with its distance over the picture that shows it.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use image::{ImageFormat, Rgb, RgbImage};
use shutter_range::RangeStatus;

use super::canvas::{Canvas, Rectangle};
use super::outputs::{Output, with_stem};
use super::report::RangeReport;
use super::rounding::{at_least, with_sigma};
use super::safe_file;
use crate::input::frame_source::is_video;

/// Where the overlays of frames go: for one frame to `out`, for several to `out` with the stem of the frame's name.
pub(crate) fn paths(frames: &[PathBuf], out: Option<&Path>) -> Vec<PathBuf> {
    match (frames, out) {
        (_, None) => Vec::new(),
        ([_], Some(out)) => vec![out.to_path_buf()],
        (_, Some(out)) => frames.iter().map(|frame| with_stem(out, frame)).collect(),
    }
}

/// Those paths as files that will be written.
pub(crate) fn outputs<'a>(frames: &'a [PathBuf], paths: &'a [PathBuf]) -> impl Iterator<Item = Output> + 'a {
    let is_single = frames.len() == 1;
    frames.iter().zip(paths).map(move |(frame, path)| {
        let what = if is_single { "--overlay".to_string() } else { format!("--overlay of {}", frame.display()) };
        let output = Output::new(what, path);
        if is_video(frame) { output.numbered() } else { output }
    })
}

/// The overlay of a frame of a video has its number.
pub(crate) fn of_frame(path: &Path, in_video: Option<usize>) -> PathBuf {
    in_video.map_or_else(|| path.to_path_buf(), |number| with_stem(path, Path::new(&format!("{number:04}"))))
}

pub(crate) fn write(path: &Path, picture: RgbImage, ranges: &[RangeReport]) -> Result<()> {
    let mut file = Cursor::new(Vec::new());
    draw(picture, ranges).write_to(&mut file, ImageFormat::Png).context("encoding a PNG")?;
    safe_file::write(path, file.get_ref()).with_context(|| format!("writing {}", path.display()))
}

fn draw(picture: RgbImage, ranges: &[RangeReport]) -> RgbImage {
    let mut canvas = Canvas::new(picture);
    for range in ranges {
        let (from, to) = ends(range);
        let width = if is_thin(range.status) { 1 } else { 2 } * canvas.scale();
        canvas.line(from, to, width, colour(range.status));
    }
    // Labels after all lines, so that no line crosses one.
    let mut labels = Vec::new();
    for range in ranges {
        let Some(text) = label(range) else { continue };
        let area = label_area(&canvas, range, &text, &Obstacles { ranges, labels: &labels });
        canvas.label(&text, &area, colour(range.status));
        labels.push(area);
    }
    canvas.into_picture()
}

fn ends(range: &RangeReport) -> ((f64, u16), (f64, u16)) {
    ((range.column_at_first_row, range.first_row), (range.column_at_last_row, range.last_row))
}

fn is_thin(status: RangeStatus) -> bool {
    !matches!(status, RangeStatus::Ok | RangeStatus::Far)
}

/// Light enough to be read on the dark box.
fn colour(status: RangeStatus) -> Rgb<u8> {
    match status {
        RangeStatus::Ok => Rgb([64, 255, 64]),
        RangeStatus::Far => Rgb([96, 176, 255]),
        RangeStatus::Slow | RangeStatus::Short | RangeStatus::Tentative => Rgb([160, 160, 160]),
        _ => Rgb([255, 144, 0]),
    }
}

fn label(range: &RangeReport) -> Option<String> {
    let distance = match range.status {
        RangeStatus::Ok => with_sigma(range.distance_m?, range.sigma_distance_m?, 1) + " m",
        RangeStatus::Far => format!(">{} m", at_least(range.nearest_distance_m?, 2)),
        _ => return None,
    };
    Some(if range.frames > 1 { format!("{distance} ({})", range.frames) } else { distance })
}

/// What a label should not cover.
struct Obstacles<'a> {
    ranges: &'a [RangeReport],
    labels: &'a [Rectangle],
}

impl Obstacles<'_> {
    fn labels_overlap(&self, area: &Rectangle) -> bool {
        self.labels.iter().any(|label| label.overlaps(area))
    }

    fn edges_cross(&self, area: &Rectangle) -> bool {
        self.ranges.iter().any(|range| {
            let rows = i64::from(range.first_row).max(area.top)..=i64::from(range.last_row).min(area.bottom);
            [*rows.start(), *rows.end()]
                .iter()
                .any(|row| !rows.is_empty() && (area.left..=area.right).contains(&column_at(range, *row)))
        })
    }
}

fn column_at(range: &RangeReport, row: i64) -> i64 {
    let ((from, first_row), (to, last_row)) = ends(range);
    let (first_row, last_row) = (i64::from(first_row), i64::from(last_row));
    let part = (row - first_row) as f64 / (last_row - first_row).max(1) as f64;
    (from + (to - from) * part).round() as i64
}

/// The nearest area to the middle of the edge that is in the picture and covers no other label and, if possible, no
/// other edge. If there is none, it is beside the middle.
fn label_area(canvas: &Canvas, range: &RangeReport, label: &str, obstacles: &Obstacles<'_>) -> Rectangle {
    let (width, height) = canvas.label_size(label);
    let (first_row, last_row) = (i64::from(range.first_row), i64::from(range.last_row));
    let middle = (first_row + last_row) / 2;
    let gap = 3 * canvas.scale();
    let beside = |row: i64, is_right: bool| {
        let column = column_at(range, row);
        let left = if is_right { column + gap } else { column - gap - width };
        let top = row - height / 2;
        Rectangle { left, top, right: left + width, bottom: top + height }
    };
    let steps = (last_row - first_row) / (2 * height);
    let rows = (0..=steps).flat_map(|step| [middle - step * height, middle + step * height]);
    let areas = rows.flat_map(|row| [beside(row, true), beside(row, false)]);
    let free = areas.filter(|area| area.is_within(&canvas.bounds()) && !obstacles.labels_overlap(area));
    let mut clear = free.clone().filter(|area| !obstacles.edges_cross(area));
    clear.next().or_else(|| free.clone().next()).unwrap_or_else(|| beside(middle, true))
}
