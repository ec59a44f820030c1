//! The truth about simulated frames. Values have the names that they have in ranges, so that they can be compared.

use std::fmt::Write;
use std::path::Path;

use serde::Serialize;
use shutter_range::sim::Truth;
use shutter_range::{Motion, Twist};

use super::report::polarity;
use super::text_table::{Colour, TextTable};

#[derive(Serialize)]
pub(crate) struct TruthDocument {
    pub(crate) seed: u64,
    pub(crate) frames: Vec<TruthFrame>,
}

/// Motion and edges are in the axes of the camera at the start of this frame.
#[derive(Serialize)]
pub(crate) struct TruthFrame {
    name: String,
    start_s: f64,
    velocity_m_s: [f32; 3],
    rate_rad_s: [f32; 3],
    gravity: [f32; 3],
    edges: Vec<TruthEdge>,
}

#[derive(Serialize)]
struct TruthEdge {
    bearing: f64,
    inverse_depth_per_m: f64,
    depth_m: f64,
    first_row: u16,
    last_row: u16,
    /// Less than all rows from first to last, if a nearer object hides some.
    visible_rows: u16,
    polarity: Option<&'static str>,
    upright: bool,
    lean_deg: f32,
}

impl TruthFrame {
    /// With the edges from left to right.
    pub(crate) fn new(name: String, start_s: f64, motion: &Twist<f32>, truth: impl Iterator<Item = Truth>) -> Self {
        let mut edges: Vec<_> = truth.map(|edge| TruthEdge::new(&edge)).collect();
        edges.sort_by(|a, b| a.bearing.total_cmp(&b.bearing));
        let (velocity_m_s, rate_rad_s, gravity) = (motion.velocity_m_s(), motion.rate_rad_s(), motion.gravity());
        Self { name, start_s, velocity_m_s, rate_rad_s, gravity, edges }
    }
}

impl TruthEdge {
    fn new(truth: &Truth) -> Self {
        Self {
            bearing: truth.bearing,
            inverse_depth_per_m: 1.0 / truth.depth_m,
            depth_m: truth.depth_m,
            first_row: truth.first_row,
            last_row: truth.last_row,
            visible_rows: truth.visible_rows,
            polarity: polarity(truth.polarity),
            upright: truth.is_upright(),
            lean_deg: truth.lean.atan().to_degrees(),
        }
    }
}

pub(crate) fn text(document: &TruthDocument, folder: &Path, colours: bool) -> String {
    let mut text = String::new();
    for frame in &document.frames {
        let _ = writeln!(text, "{} at {:.4} s", frame.name, frame.start_s);
        if frame.edges.is_empty() {
            text.push_str("no edges\n\n");
            continue;
        }
        let mut table = TextTable::new(["bearing", "depth (m)", "rows", "visible", "polarity", "lean"], colours);
        for edge in &frame.edges {
            let lean = if edge.upright { "upright".to_string() } else { format!("leaning {:+.2} deg", edge.lean_deg) };
            let cells = [
                format!("{:+.4}", edge.bearing),
                format!("{:.3}", edge.depth_m),
                format!("{}-{}", edge.first_row, edge.last_row),
                edge.visible_rows.to_string(),
                edge.polarity.unwrap_or("-").to_string(),
                lean,
            ];
            table.row(cells, if edge.upright { Colour::Plain } else { Colour::Yellow });
        }
        table.write_to(&mut text);
        text.push('\n');
    }
    let (frames, folder) = (document.frames.len(), folder.display());
    let _ = writeln!(text, "{frames} frame{} with truth.json in {folder}", if frames == 1 { "" } else { "s" });
    text
}
