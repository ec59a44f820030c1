//! [`Map`]: the edges of a drive as seen from above, each once, in the axes of the first frame.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Result;
use shutter_range::{Pose, RangeStatus};

use super::birds_eye::{BirdsEye, Point, Position, STYLE};
use super::ground::{Ground, Rows, dot, sum, transposed, turned};
use super::report::RangeReport;
use super::safe_file;

/// A drive along a wall should not become a thread.
const TALLEST: f64 = 4.0;

pub(crate) struct Map {
    file: PathBuf,
    /// Rotation to the first frame's axes and position there; `None` once the motion is not known.
    place: Option<(Rows, [f64; 3])>,
    /// Of the first frame.
    ground: Option<Ground>,
    path: Vec<Point>,
    /// The last that was told of each edge, by its number, or of each range that has none.
    edges: BTreeMap<(Option<u32>, usize), Position>,
}

impl Map {
    pub(crate) fn new(path: &Path) -> Self {
        let level = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self {
            file: path.to_path_buf(),
            place: Some((level, [0.0; 3])),
            ground: None,
            path: Vec::new(),
            edges: BTreeMap::new(),
        }
    }

    /// Adds what a frame tells.
    pub(crate) fn add(&mut self, ranges: &[RangeReport], gravity: [f64; 3]) {
        let ground = *self.ground.get_or_insert_with(|| Ground::new(gravity));
        let Some((rotation, position)) = self.place else { return };
        let on_ground = |point: [f64; 3]| ground.place(sum(position, turned(&rotation, point)));
        self.path.push(on_ground([0.0; 3]));
        // What is only farther than something has no place yet.
        for (index, range) in ranges.iter().enumerate().filter(|(_, range)| range.status == RangeStatus::Ok) {
            let Some(position) = Position::of(range, on_ground) else { continue };
            let key = if range.line_id.is_some() { (range.line_id, 0) } else { (None, self.edges.len() + index) };
            self.edges.insert(key, position);
        }
    }

    /// The camera goes on to the next frame; `None` where its motion is not known: what comes then has no place on the
    /// map.
    pub(crate) fn advance(&mut self, pose: Option<&Pose<f64>>) {
        self.place = self.place.zip(pose).map(|((rotation, position), pose)| {
            let columns = transposed(&pose.rotation);
            let next = rotation.map(|row| columns.map(|column| dot(row, column)));
            (next, sum(position, turned(&rotation, pose.position_m)))
        });
    }

    pub(crate) fn write(self) -> Result<()> {
        let view = BirdsEye { positions: self.edges.values().collect(), path: &self.path, tallest: TALLEST };
        let style = format!("<style>\n{STYLE}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n");
        safe_file::write_text(&self.file, &view.svg(" xmlns=\"http://www.w3.org/2000/svg\"", &style))
    }
}
