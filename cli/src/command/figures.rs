//! Command `figures`: the figures of the paper, drawn by the library.

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use image::{GrayImage, ImageFormat};
use serde::Serialize;
use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator};
use shutter_range::{Camera, Distortion, Intrinsics, Readout, ReadoutDirection, Twist};

use super::figure_charts;
use crate::output::safe_file;

#[derive(Serialize)]
pub(crate) struct Document {
    files: Vec<PathBuf>,
}

/// The three motions before a wall of vertical lines: along the image plane, along the axis, and between the two.
const WALLS: [(&str, [f32; 3]); 3] = [("6b", [-2.0, 0.0, 0.0]), ("9b", [0.0, 0.0, 5.0]), ("11b", [-1.4, 0.0, 3.5])];
const COLUMNS: u16 = 480;
const ROWS: u16 = 320;
/// Lines on the wall.
const LINES: usize = 25;

pub(crate) fn draw(folder: &Path) -> Result<Document> {
    fs::create_dir_all(folder).with_context(|| format!("making {}", folder.display()))?;
    let mut files = Vec::new();
    for (name, chart) in figure_charts::all()? {
        let path = folder.join(format!("{name}.svg"));
        safe_file::write_text(&path, &chart.to_svg()?)?;
        files.push(path);
    }
    for (name, velocity_m_s) in WALLS {
        let path = folder.join(format!("{name}.png"));
        let written = safe_file::write(&path, &png(&wall(velocity_m_s)?)?);
        written.with_context(|| format!("writing {}", path.display()))?;
        files.push(path);
    }
    Ok(Document { files })
}

/// A wall of vertical lines, 1 m away, as a moving camera sees it in 33 ms.
fn wall(velocity_m_s: [f32; 3]) -> Result<GrayImage> {
    let mut scene = Scene::<LINES>::new(Background::plain(230.0))?;
    for line in 0..LINES {
        let bearing = 0.08 * (line as f32 - 0.5 * (LINES - 1) as f32);
        scene.push(Bar::upright(bearing, 1.0, 0.02, 40.0))?;
    }
    let camera = Camera::new(Intrinsics::centred(COLUMNS, ROWS, 350.0), Distortion::NONE)?;
    let readout = Readout::from_frame_readout_ns(ROWS, 33_000_000, ReadoutDirection::TopToBottom)?;
    let motion = Twist::level(velocity_m_s)?;
    let exposure = Exposure { time_s: 0.001, ..Exposure::IDEAL };
    let simulator = Simulator::new(&scene, &camera, &readout, &motion, exposure, 0)?;
    let mut pixels = vec![0; usize::from(COLUMNS) * usize::from(ROWS)];
    (0..).zip(pixels.chunks_exact_mut(COLUMNS.into())).for_each(|(row, pixels)| simulator.row(row, pixels));
    GrayImage::from_raw(COLUMNS.into(), ROWS.into(), pixels).context("a picture of this size")
}

fn png(picture: &GrayImage) -> Result<Vec<u8>> {
    let mut file = Cursor::new(Vec::new());
    picture.write_to(&mut file, ImageFormat::Png).context("encoding a PNG")?;
    Ok(file.into_inner())
}

pub(crate) fn text(document: &Document) -> String {
    document.files.iter().map(|file| format!("{}\n", file.display())).collect()
}
