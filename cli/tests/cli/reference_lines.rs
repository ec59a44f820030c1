//! The 36 exact edges that the library is tested with, through files.

use std::fmt::Write;

use serde::Deserialize;

use crate::tool::{Folder, assert_near, number};

#[derive(Deserialize)]
struct ReferenceLine {
    camera: ReferenceCamera,
    velocity_m_s: [f64; 3],
    rate_rad_s: [f64; 3],
    gravity: [f64; 3],
    truth: Truth,
    rows: Vec<u16>,
    columns: Vec<f64>,
}

#[derive(Deserialize)]
struct ReferenceCamera {
    cols: u16,
    rows: u16,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    readout_s: f64,
}

#[derive(Deserialize)]
struct Truth {
    bearing: f64,
    depth_m: f64,
}

fn reference_lines() -> Vec<ReferenceLine> {
    let text = include_str!("../../../host_tests/data/lines.json");
    serde_json::from_str(text).expect("lines.json is as make_lines.py writes it")
}

impl ReferenceLine {
    /// The same scene in a mirror that lies on the floor, read out from the bottom: the same times, depths and columns.
    fn upside_down(self) -> Self {
        let last = self.camera.rows - 1;
        let [vx, vy, vz] = self.velocity_m_s;
        let [rx, ry, rz] = self.rate_rad_s;
        let [gx, gy, gz] = self.gravity;
        Self {
            camera: ReferenceCamera { cy: f64::from(last) - self.camera.cy, ..self.camera },
            velocity_m_s: [vx, -vy, vz],
            // A mirror turns what rotates the other way about the axes that it keeps.
            rate_rad_s: [-rx, ry, -rz],
            // An edge has no upper end: the opposite of what the mirror makes of down is as good.
            gravity: [-gx, gy, -gz],
            rows: self.rows.iter().map(|row| last - row).collect(),
            ..self
        }
    }

    fn setup(&self, direction: &str) -> String {
        let ReferenceCamera { cols, rows, fx, fy, cx, cy, readout_s } = self.camera;
        let (velocity, rate, gravity) = (self.velocity_m_s, self.rate_rad_s, self.gravity);
        format!(
            "[camera]\ncolumns = {cols}\nrows = {rows}\nfx = {fx}\nfy = {fy}\ncx = {cx}\ncy = {cy}\n\
             readout_s = {readout_s}\ndirection = \"{direction}\"\n\
             [motion]\nvelocity_m_s = {velocity:?}\nrate_rad_s = {rate:?}\n\
             [attitude]\ngravity = {gravity:?}\nsigma_tilt_deg = 0\n"
        )
    }

    fn edges(&self, header: &str, rest: &str) -> String {
        let mut text = format!("{header}\n");
        for (row, column) in self.rows.iter().zip(&self.columns) {
            let _ = writeln!(text, "{row},{column}{rest}");
        }
        text
    }

    fn check(&self, direction: &str, header: &str, rest: &str) {
        let ranges = Folder::of(&self.setup(direction), &self.edges(header, rest)).ranges();
        assert_eq!(ranges.len(), 1, "{ranges:?}");
        let range = &ranges[0];
        assert_near(number(range, "inverse_depth_per_m") * self.truth.depth_m, 1.0, 1e-3);
        assert_near(number(range, "bearing"), self.truth.bearing, 1e-4);
        assert_eq!(number(range, "edges"), self.rows.len() as f64);
        let top = self.rows.iter().min().expect("rows");
        assert_eq!(number(range, "first_row"), f64::from(*top));
        let index = self.rows.iter().position(|row| row == top).expect("it is one of them");
        assert_near(number(range, "column_at_first_row"), self.columns[index], 0.01);
    }
}

#[test]
fn lines_are_ranged() {
    let lines = reference_lines();
    assert_eq!(lines.len(), 36);
    lines.iter().for_each(|line| line.check("top-to-bottom", "row,column,line", ",7"));
}

#[test]
fn the_tracker_finds_them() {
    reference_lines().iter().for_each(|line| line.check("top-to-bottom", "row,column", ""));
}

#[test]
fn readout_from_the_bottom() {
    for line in reference_lines().into_iter().map(ReferenceLine::upside_down) {
        line.check("bottom-to-top", "row,column,line", ",7");
        line.check("bottom-to-top", "row,column", "");
    }
}
