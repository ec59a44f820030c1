//! Ranges as a table for people.

use std::fmt::Write;

use shutter_range::RangeStatus;

use super::report::{Document, Frame, RangeReport};
use super::rounding::{decimals, with_sigma};
use super::text_table::{Colour, TextTable};

const HEADINGS: [&str; 10] = [
    "column@row (px)",
    "bearing",
    "depth (m)",
    "2-sigma interval (m)",
    "sigma from",
    "line",
    "rows",
    "points",
    "polarity",
    "status",
];

pub(crate) fn text(document: &Document, colours: bool) -> String {
    if document.frames.is_empty() {
        return "no frames\n".to_string();
    }
    let mut text = String::new();
    for (index, frame) in document.frames.iter().enumerate() {
        if index > 0 {
            text.push('\n');
        }
        text += &self::frame(frame, colours);
    }
    text
}

pub(crate) fn frame(frame: &Frame, colours: bool) -> String {
    let mut text = String::new();
    write_frame(frame, colours, &mut text);
    text
}

fn write_frame(frame: &Frame, colours: bool, text: &mut String) {
    let _ = writeln!(text, "{}{}", frame.name, if frame.torn { " (torn)" } else { "" });
    if frame.ranges.is_empty() {
        text.push_str("no ranges\n");
    } else {
        let mut table = TextTable::new(HEADINGS, colours);
        for range in &frame.ranges {
            table.row(cells(range), colour(range.status));
        }
        table.write_to(text);
    }
    for (index, range) in frame.ranges.iter().enumerate() {
        write_post(frame, index, range, text);
    }
    if frame.stray_edges > 0 {
        let _ = writeln!(text, "{} stray edge points: they belong to no line", frame.stray_edges);
    }
    if frame.dropped_edges > 0 || frame.dropped_lines > 0 {
        let (edges, lines) = (frame.dropped_edges, frame.dropped_lines);
        let _ = writeln!(text, "dropped because the tables were full: {edges} edge points, {lines} lines");
    }
    for hint in &frame.hints {
        let _ = writeln!(text, "hint: {hint}");
    }
}

/// One line for each post, at its left side.
fn write_post(frame: &Frame, index: usize, range: &RangeReport, text: &mut String) {
    let other = range.post.filter(|other| *other > index).and_then(|other| frame.ranges.get(other));
    if let (Some(other), Some(distance), Some(sigma)) = (other, range.post_distance_m, range.post_sigma_m) {
        let [left, right] = [range, other].map(|side| format!("{:.2}@{}", side.column_at_first_row, side.first_row));
        let _ =
            writeln!(text, "post between {left} and {right}: its middle is {} m away", with_sigma(distance, sigma, 2));
    }
}

fn cells(range: &RangeReport) -> [String; 10] {
    let depth = range.depth_m.zip(range.sigma_depth_m);
    [
        format!("{:.2}@{}", range.column_at_first_row, range.first_row),
        format!("{:+.4}", range.bearing),
        depth.map_or_else(|| "-".to_string(), |(depth, sigma)| with_sigma(depth, sigma, 2)),
        interval(range),
        range.dominant.to_string(),
        range.line_id.map_or_else(|| "-".to_string(), |id| id.to_string()),
        format!("{}-{}", range.first_row, range.last_row),
        range.edges.to_string(),
        range.polarity.unwrap_or("-").to_string(),
        range.status.name().to_string(),
    ]
}

fn colour(status: RangeStatus) -> Colour {
    match status {
        RangeStatus::Ok => Colour::Green,
        RangeStatus::Far | RangeStatus::Slow => Colour::Yellow,
        RangeStatus::Short | RangeStatus::Tentative => Colour::Grey,
        _ => Colour::Red,
    }
}

fn interval(range: &RangeReport) -> String {
    match (range.nearest_m, range.farthest_m) {
        (Some(nearest), Some(farthest)) => {
            let decimals = decimals(farthest - nearest, 2);
            format!("[{nearest:.decimals$}, {farthest:.decimals$}]")
        }
        (Some(nearest), None) => format!("[{nearest:.*}, ∞)", decimals(nearest, 3)),
        (None, _) => "-".to_string(),
    }
}
