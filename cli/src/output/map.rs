//! [`Map`]: a bird's-eye picture of the edges of a drive, in SVG.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::Result;
use shutter_range::{Pose, RangeStatus};

use super::report::RangeReport;
use super::rounding::with_sigma;
use super::safe_file;
use crate::input::file_identity::FileIdentity;

/// On the ground, in metres: to the right of the first frame's camera, and ahead of it.
type Point = [f64; 2];

/// Edges where they are on the ground, with the path of the camera, in the axes of the first frame.
pub(crate) struct Map {
    file: PathBuf,
    /// Rotation to the first frame's axes and position there; `None` once the motion is not known.
    place: Option<([[f64; 3]; 3], [f64; 3])>,
    /// Right and ahead in the first frame's axes, perpendicular to gravity.
    ground: Option<[[f64; 3]; 2]>,
    path: Vec<Point>,
    /// The last that was told of each edge, by its number, or of each range that has none.
    edges: BTreeMap<(Option<u32>, usize), Bar>,
}

struct Bar {
    at: Point,
    nearest: Point,
    farthest: Point,
    title: String,
}

const WIDTH_PX: f64 = 900.0;
const MARGIN_PX: f64 = 48.0;
/// A drive along a wall should not become a thread.
const MOST_ELONGATED: f64 = 4.0;

/// Refuses a map in place of an input or of another output.
pub(crate) fn check(map: Option<&Path>, inputs: &[PathBuf], outputs: &[PathBuf]) -> Result<(), String> {
    let Some(map) = map else { return Ok(()) };
    let identity = FileIdentity::of(map);
    match inputs.iter().chain(outputs).find(|path| FileIdentity::of(path) == identity) {
        Some(path) => Err(format!("--map would replace {}: {} is the same file", path.display(), map.display())),
        None => Ok(()),
    }
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
        let ground = *self.ground.get_or_insert_with(|| ground(gravity));
        let Some((rotation, position)) = self.place else { return };
        let on_ground = |point: [f64; 3]| ground.map(|axis| dot(axis, sum(position, turned(&rotation, point))));
        self.path.push(on_ground([0.0; 3]));
        for (index, range) in ranges.iter().enumerate().filter(|(_, range)| range.status == RangeStatus::Ok) {
            let values = range.depth_m.zip(range.sigma_depth_m).zip(range.nearest_m.zip(range.farthest_m));
            let Some(((depth, sigma), (nearest, farthest))) = values else { continue };
            let at = |depth: f64| on_ground([range.bearing * depth, 0.0, depth]);
            let frames = if range.frames == 1 { "frame" } else { "frames" };
            let title = format!("{} m, {} {frames}", with_sigma(depth, sigma, 1), range.frames);
            let bar = Bar { at: at(depth), nearest: at(nearest), farthest: at(farthest), title };
            let key = if range.line_id.is_some() { (range.line_id, 0) } else { (None, self.edges.len() + index) };
            self.edges.insert(key, bar);
        }
    }

    /// The camera goes on to the next frame; `None` where its motion is not known: what comes then has no place on the map.
    pub(crate) fn advance(&mut self, pose: Option<&Pose<f64>>) {
        self.place = self.place.zip(pose).map(|((rotation, position), pose)| {
            let columns = transposed(&pose.rotation);
            let next = rotation.map(|row| columns.map(|column| dot(row, column)));
            (next, sum(position, turned(&rotation, pose.position_m)))
        });
    }

    pub(crate) fn write(self) -> Result<()> {
        safe_file::write_text(&self.file, &self.svg())
    }

    fn svg(&self) -> String {
        let view = View::around(self.path.iter().chain(self.edges.values().map(|bar| &bar.at)));
        let mut svg = String::new();
        let (width, height) = (WIDTH_PX, view.height_px());
        // Writing to a string cannot fail.
        let _ = write!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"sans-serif\" \
             font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        view.grid(&mut svg);
        let path: Vec<String> = self.path.iter().map(|point| view.pair(*point)).collect();
        let _ =
            writeln!(svg, "<polyline points=\"{}\" fill=\"none\" stroke=\"#888\" stroke-width=\"2\"/>", path.join(" "));
        for point in &self.path {
            let [x, y] = view.pixel(*point);
            let _ = writeln!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"#888\"><title>camera</title></circle>"
            );
        }
        for bar in self.edges.values() {
            let ([x1, y1], [x2, y2], [x, y]) = (view.pixel(bar.nearest), view.pixel(bar.farthest), view.pixel(bar.at));
            let _ = writeln!(
                svg,
                "<g stroke=\"#080\" fill=\"#080\"><title>{}</title><line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" \
                 y2=\"{y2:.1}\"/><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.5\"/></g>",
                bar.title
            );
        }
        svg + "</svg>\n"
    }
}

/// What of the ground is drawn, and how large.
struct View {
    left_m: f64,
    far_m: f64,
    width_m: f64,
    depth_m: f64,
}

impl View {
    fn around<'a>(points: impl Iterator<Item = &'a Point> + Clone) -> Self {
        let bounds = |axis: usize| {
            let (low, high) = points
                .clone()
                .fold((f64::MAX, f64::MIN), |(low, high), point| (low.min(point[axis]), high.max(point[axis])));
            if low > high { (-1.0, 1.0) } else { (low, high) }
        };
        let ((left, right), (near, far)) = (bounds(0), bounds(1));
        let (width, depth) = ((right - left).max(1.0), (far - near).max(1.0));
        let (wide, deep) = (width.max(depth / MOST_ELONGATED), depth.max(width / MOST_ELONGATED));
        Self {
            left_m: f64::midpoint(left, right) - wide / 2.0,
            far_m: f64::midpoint(near, far) + deep / 2.0,
            width_m: wide,
            depth_m: deep,
        }
    }

    fn px_per_m(&self) -> f64 {
        (WIDTH_PX - 2.0 * MARGIN_PX) / self.width_m
    }

    fn height_px(&self) -> f64 {
        self.depth_m * self.px_per_m() + 2.0 * MARGIN_PX
    }

    fn pixel(&self, [right, ahead]: Point) -> Point {
        let scale = self.px_per_m();
        [MARGIN_PX + (right - self.left_m) * scale, MARGIN_PX + (self.far_m - ahead) * scale]
    }

    fn pair(&self, point: Point) -> String {
        let [x, y] = self.pixel(point);
        format!("{x:.1},{y:.1}")
    }

    /// A line every 1, 2 or 5 · 10ⁿ metres, about ten across.
    fn grid(&self, svg: &mut String) {
        let rough = self.width_m.max(self.depth_m) / 10.0;
        let power = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(rough);
        let (bottom, right) = (self.far_m - self.depth_m, self.left_m + self.width_m);
        let ticks =
            |from: f64, to: f64| ((from / step).ceil() as i64..=(to / step).floor() as i64).map(|k| k as f64 * step);
        for x_m in ticks(self.left_m, right) {
            let ([x, top], [_, base]) = (self.pixel([x_m, self.far_m]), self.pixel([x_m, bottom]));
            let _ = writeln!(
                svg,
                "<path d=\"M{x:.1} {top:.1}V{base:.1}\" stroke=\"#ddd\"/><text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{x_m} m</text>",
                base + 16.0
            );
        }
        for z_m in ticks(bottom, self.far_m) {
            let ([left, y], [end, _]) = (self.pixel([self.left_m, z_m]), self.pixel([right, z_m]));
            let _ = writeln!(
                svg,
                "<path d=\"M{left:.1} {y:.1}H{end:.1}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{y:.1}\" text-anchor=\"end\">{z_m} m</text>",
                left - 4.0
            );
        }
    }
}

/// Right and ahead, both perpendicular to gravity.
fn ground(gravity: [f64; 3]) -> [[f64; 3]; 2] {
    let [x, y, z] = gravity;
    let across = x.hypot(y);
    // A camera that looks straight down has its top ahead.
    let right = if across > 0.0 { [y / across, -x / across, 0.0] } else { [1.0, 0.0, 0.0] };
    let [rx, ry, rz] = right;
    [right, [ry * z - rz * y, rz * x - rx * z, rx * y - ry * x]]
}

fn dot([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> f64 {
    a * x + b * y + c * z
}

fn sum([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [a + x, b + y, c + z]
}

fn turned(rotation: &[[f64; 3]; 3], vector: [f64; 3]) -> [f64; 3] {
    rotation.map(|row| dot(row, vector))
}

fn transposed([[a, b, c], [d, e, f], [g, h, i]]: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [[*a, *d, *g], [*b, *e, *h], [*c, *f, *i]]
}
