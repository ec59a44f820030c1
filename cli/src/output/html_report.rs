//! [`HtmlReport`]: a page to look at, in one file that needs no other.

use std::fmt::Write;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::{DynamicImage, ImageFormat};
use shutter_range::RangeStatus;

use super::birds_eye::{self, BirdsEye, Position};
use super::ground::Ground;
use super::markup::escaped;
use super::report::{Frame, RangeReport};
use super::rounding::{at_least, decimals, with_sigma};
use super::safe_file;

/// A browser shows some dozen pictures with ease. Beyond, frames are counted.
const MOST_FRAMES: usize = 100;

const STYLE: &str = include_str!("report.css");

pub(crate) struct HtmlReport {
    path: PathBuf,
    sections: String,
    frames: usize,
}

impl HtmlReport {
    pub(crate) fn new(path: &Path) -> Self {
        Self { path: path.to_path_buf(), sections: String::new(), frames: 0 }
    }

    pub(crate) fn add(&mut self, frame: &Frame, picture: Option<&DynamicImage>) -> Result<()> {
        self.frames += 1;
        if self.frames > MOST_FRAMES {
            return Ok(());
        }
        let torn = if frame.torn { " <strong class=\"torn\">torn</strong>" } else { "" };
        let _ = writeln!(self.sections, "<section class=\"frame\">\n<h2>{}{torn}</h2>", escaped(&frame.name));
        self.sections.push_str("<div class=\"views\">\n");
        if let Some(picture) = picture {
            self.sections += &picture_with_edges(picture, frame)?;
        }
        self.sections += &birds_eye_view(frame);
        self.sections.push_str("</div>\n");
        self.sections += &table(frame);
        self.sections += &hints(frame);
        self.sections.push_str("</section>\n");
        Ok(())
    }

    pub(crate) fn finish(self) -> Result<()> {
        let further = self.frames.saturating_sub(MOST_FRAMES);
        let more =
            if further > 0 { format!("<p>{further} further frames are not shown.</p>\n") } else { String::new() };
        let page = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src \
             'unsafe-inline'\">\n<meta name=\"viewport\" content=\"width=device-width\">\n<title>Ranges of {} frames</title>\n\
             <style>\n{STYLE}{}</style>\n</head>\n<body>\n<h1>Ranges by rolling shutter</h1>\n{LEGEND}{}{}{more}</body>\n</html>\n",
            self.frames,
            birds_eye::STYLE,
            key(),
            self.sections
        );
        safe_file::write(&self.path, page.as_bytes()).with_context(|| format!("writing {}", self.path.display()))
    }
}

/// Neighbours have their labels at different heights, as parts of the way down.
const LABEL_PLACES: [f64; 4] = [0.3, 0.45, 0.6, 0.75];

const LEGEND: &str = "\
<p class=\"legend\"><span class=\"ok\">ok</span>: distance with one sigma; <span class=\"far\">far</span>: lower bound; \
<span class=\"other\">other statuses</span> have no distance. Bars in the bird's-eye view are two sigma.</p>\n";

/// What the colours of the error budgets mean.
fn key() -> String {
    const SOURCES: [&str; 8] = ["noise", "lean", "gravity", "lens", "speed", "rate", "readout", "focal"];
    let one = |source: &str| {
        format!(
            "<svg class=\"key\" viewBox=\"0 0 10 10\"><rect class=\"{source}\" width=\"10\" height=\"10\"/></svg> {source}"
        )
    };
    format!("<p class=\"legend\">Sigma comes from {}.</p>\n", SOURCES.map(one).join(", "))
}

/// As a class of the style.
fn class(status: RangeStatus) -> &'static str {
    match status {
        RangeStatus::Ok => "ok",
        RangeStatus::Far => "far",
        _ => "other",
    }
}

fn picture_with_edges(picture: &DynamicImage, frame: &Frame) -> Result<String> {
    let mut file = Cursor::new(Vec::new());
    // Eight bits are what a browser shows.
    let shown =
        if picture.color().has_color() { picture.to_rgb8().into() } else { DynamicImage::from(picture.to_luma8()) };
    shown.write_to(&mut file, ImageFormat::Png).context("encoding a PNG")?;
    let (columns, rows) = (picture.width(), picture.height());
    let mut svg = format!(
        "<svg class=\"picture\" viewBox=\"-0.5 -0.5 {columns} {rows}\" role=\"img\" aria-label=\"the frame with its edges\">\n\
         <image x=\"-0.5\" y=\"-0.5\" width=\"{columns}\" height=\"{rows}\" href=\"data:image/png;base64,{}\"/>\n",
        STANDARD.encode(file.get_ref())
    );
    for (index, range) in frame.ranges.iter().enumerate() {
        let RangeReport { first_row, last_row, column_at_first_row: from, column_at_last_row: to, .. } = range;
        let label = label(range);
        let _ = writeln!(
            svg,
            "<path class=\"edge {}\" d=\"M{from:.2} {first_row} L{to:.2} {last_row}\"><title>{label}</title></path>",
            class(range.status)
        );
        if matches!(range.status, RangeStatus::Ok | RangeStatus::Far) {
            let part = LABEL_PLACES[index % LABEL_PLACES.len()];
            let y = f64::from(*first_row) + part * f64::from(last_row - first_row);
            let x = from + part * (to - from);
            // Within the picture.
            let (x, anchor) = if x < 0.8 * f64::from(columns) { (x + 4.0, "start") } else { (x - 4.0, "end") };
            let _ = writeln!(
                svg,
                "<text class=\"{}\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{label}</text>",
                class(range.status)
            );
        }
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}

/// From where the camera is at the frame's start.
fn birds_eye_view(frame: &Frame) -> String {
    /// Beside the picture, not below it.
    const TALLEST: f64 = 0.7;
    let ground = Ground::new(frame.gravity);
    let positions: Vec<Position> =
        frame.ranges.iter().filter_map(|range| Position::of(range, |point| ground.place(point))).collect();
    BirdsEye { positions: positions.iter().collect(), path: &[[0.0; 2]], tallest: TALLEST }.svg("", "")
}

fn label(range: &RangeReport) -> String {
    match (range.status, range.distance_m, range.sigma_distance_m, range.nearest_distance_m) {
        (RangeStatus::Ok, Some(distance_m), Some(sigma_m), _) => format!("{} m", with_sigma(distance_m, sigma_m, 1)),
        (RangeStatus::Far, _, _, Some(nearest_m)) => format!("&gt; {} m", at_least(nearest_m, 2)),
        (status, ..) => status.name().to_string(),
    }
}

fn table(frame: &Frame) -> String {
    let mut html = String::from(
        "<table class=\"ranges\">\n<thead><tr><th>column</th><th>bearing</th><th>depth (m)</th><th>two-sigma interval (m)</th>\
         <th>edge points</th><th>status</th><th>where sigma comes from</th></tr></thead>\n<tbody>\n",
    );
    for range in &frame.ranges {
        let depth = range.depth_m.zip(range.sigma_depth_m);
        let depth = depth.map_or_else(|| "–".to_string(), |(depth_m, sigma_m)| with_sigma(depth_m, sigma_m, 2));
        let _ = writeln!(
            html,
            "<tr class=\"{}\"><td>{:.1}</td><td>{:+.4}</td><td>{depth}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            class(range.status),
            range.column_at_first_row,
            range.bearing,
            interval(range),
            range.edges,
            range.status.name(),
            budget(range)
        );
    }
    html.push_str("</tbody>\n</table>\n");
    html
}

fn interval(range: &RangeReport) -> String {
    match (range.nearest_m, range.farthest_m) {
        (Some(nearest), Some(farthest)) => {
            let decimals = decimals(farthest - nearest, 2);
            format!("{nearest:.decimals$} to {farthest:.decimals$}")
        }
        (Some(nearest), None) => format!("{} and more", at_least(nearest, 2)),
        (None, _) => "–".to_string(),
    }
}

/// Each source's share of the variance as a part of one bar.
fn budget(range: &RangeReport) -> String {
    const WIDTH: f64 = 160.0;
    let all: f64 = range.budget.iter().map(|(_, sigma)| sigma * sigma).sum();
    let is_known = all.is_finite() && all > 0.0;
    if !is_known {
        return "–".to_string();
    }
    let mut svg = format!("<svg class=\"budget\" viewBox=\"0 0 {WIDTH} 14\" role=\"img\" aria-label=\"error budget\">");
    let mut x = 0.0;
    for (source, sigma) in &range.budget {
        let share = sigma * sigma / all;
        if share >= 0.005 {
            let width = WIDTH * share;
            let _ = write!(
                svg,
                "<rect class=\"{source}\" x=\"{x:.1}\" y=\"0\" width=\"{width:.1}\" height=\"14\"><title>{source}: {:.0} % of the \
                 variance, one sigma {sigma:.2e} per metre</title></rect>",
                share * 100.0
            );
            x += width;
        }
    }
    let _ = write!(svg, "</svg> {}", range.dominant);
    svg
}

fn hints(frame: &Frame) -> String {
    let mut html = format!(
        "<p>{} edge points, {} of them in no line, {} dropped.</p>\n",
        frame.edges, frame.stray_edges, frame.dropped_edges
    );
    if !frame.hints.is_empty() {
        let items: String = frame.hints.iter().map(|hint| format!("<li>{}</li>\n", escaped(hint))).collect();
        let _ = write!(html, "<ul class=\"hints\">\n{items}</ul>\n");
    }
    html
}
