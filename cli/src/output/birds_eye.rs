//! [`BirdsEye`]: edges as seen from above, with bars of two sigma, in metres: those of a frame, or of a whole drive.

use std::fmt::Write;

use shutter_range::RangeStatus;

use super::report::RangeReport;
use super::rounding::{at_least, decimals, with_sigma};

/// On the ground, in metres: to the right, and ahead.
pub(crate) type Point = [f64; 2];

/// The rules that its classes go by.
pub(crate) const STYLE: &str = include_str!("birds_eye.css");

/// In the units of the picture.
const WIDTH: f64 = 720.0;
const MARGIN: f64 = 40.0;
/// A bar that has no end goes on to so many times its beginning: beyond the picture.
const ENDLESS: f64 = 100.0;

/// An edge.
pub(crate) struct Position {
    /// `None` where there is only a lower bound.
    at: Option<Point>,
    nearest: Point,
    farthest: Point,
    title: String,
}

/// What is drawn.
pub(crate) struct BirdsEye<'a> {
    pub(crate) positions: Vec<&'a Position>,
    /// Where the camera was, frame by frame.
    pub(crate) path: &'a [Point],
    /// Height over width, at most.
    pub(crate) tallest: f64,
}

impl Position {
    /// Of a range, whose points in the camera's axes are brought to the ground. `None` where it has no place there.
    pub(crate) fn of(range: &RangeReport, on_ground: impl Fn([f64; 3]) -> Point) -> Option<Self> {
        let at = |depth_m: f64| on_ground([range.bearing * depth_m, 0.0, depth_m]);
        let nearest_m = range.nearest_m?;
        let depth = range.depth_m.zip(range.sigma_depth_m);
        let what = match (range.status, depth) {
            (RangeStatus::Ok, Some((depth_m, sigma_m))) => format!("{} m", with_sigma(depth_m, sigma_m, 1)),
            (RangeStatus::Far, _) => format!("farther than {} m", at_least(nearest_m, 2)),
            _ => return None,
        };
        let frames = if range.frames == 1 { "1 frame".to_string() } else { format!("{} frames", range.frames) };
        Some(Self {
            at: range.depth_m.map(at),
            nearest: at(nearest_m),
            farthest: at(range.farthest_m.unwrap_or(f64::MAX).min(ENDLESS * nearest_m)),
            title: format!("{what}, bearing {:+.3}, {frames}", range.bearing),
        })
    }

    fn write(&self, view: &View, svg: &mut String) {
        let (near, far) = (view.pair(self.nearest), view.pair(self.farthest));
        let (class, dot) = match self.at.map(|at| view.pixel(at)) {
            Some([x, y]) => ("ok", format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/>")),
            None => ("far", String::new()),
        };
        let _ = writeln!(
            svg,
            "<g class=\"position {class}\"><title>{}</title><path class=\"bar\" d=\"M{near} L{far}\"/>{dot}</g>",
            self.title
        );
    }
}

impl BirdsEye<'_> {
    /// An element with attributes of its own.
    pub(crate) fn svg(&self, attributes: &str, style: &str) -> String {
        // Where there is no more than a lower bound, that.
        let places = self.positions.iter().map(|position| position.at.unwrap_or(position.nearest));
        let points: Vec<Point> = places.chain(self.path.iter().copied()).collect();
        let view = View::around(&points, self.tallest);
        let label = "bird's-eye view: positions with two sigma, in metres";
        let mut svg = format!(
            "<svg class=\"birds-eye\" viewBox=\"0 0 {WIDTH:.0} {:.0}\" role=\"img\" aria-label=\"{label}\"{attributes}>\n{style}",
            view.height()
        );
        view.write_grid(&mut svg);
        if let [_, _, ..] = self.path {
            let path: Vec<String> = self.path.iter().map(|point| view.pair(*point)).collect();
            let _ = writeln!(svg, "<polyline class=\"path\" points=\"{}\"/>", path.join(" "));
        }
        for point in self.path {
            let [x, y] = view.pixel(*point);
            let _ =
                writeln!(svg, "<path class=\"camera\" d=\"M{x:.1} {y:.1} l-4 8 h8 z\"><title>camera</title></path>");
        }
        self.positions.iter().for_each(|position| position.write(&view, &mut svg));
        svg + "</svg>\n"
    }
}

/// What of the ground is seen, and how large.
struct View {
    left_m: f64,
    far_m: f64,
    width_m: f64,
    depth_m: f64,
}

impl View {
    /// As narrow as it is flat at most.
    fn around(points: &[Point], tallest: f64) -> Self {
        const FLATTEST: f64 = 0.25;
        const LEAST_M: f64 = 1.0;
        let bounds = |axis: usize| {
            points
                .iter()
                .fold((0.0, 0.0), |(low, high): (f64, f64), point| (low.min(point[axis]), high.max(point[axis])))
        };
        let ((left, right), (near, far)) = (bounds(0), bounds(1));
        let (width, depth) = ((right - left).max(LEAST_M), (far - near).max(LEAST_M));
        let (wide, deep) = (width.max(depth / tallest), depth.max(width * FLATTEST));
        Self {
            left_m: f64::midpoint(left, right) - wide / 2.0,
            far_m: f64::midpoint(near, far) + deep / 2.0,
            width_m: wide,
            depth_m: deep,
        }
    }

    fn px_per_m(&self) -> f64 {
        (WIDTH - 2.0 * MARGIN) / self.width_m
    }

    fn height(&self) -> f64 {
        self.depth_m * self.px_per_m() + 2.0 * MARGIN
    }

    fn pixel(&self, [right, ahead]: Point) -> Point {
        let scale = self.px_per_m();
        [MARGIN + (right - self.left_m) * scale, MARGIN + (self.far_m - ahead) * scale]
    }

    fn pair(&self, point: Point) -> String {
        let [x, y] = self.pixel(point);
        format!("{x:.1},{y:.1}")
    }

    fn write_grid(&self, svg: &mut String) {
        let step_m = nice_step(self.width_m.max(self.depth_m));
        let decimals = decimals(step_m, 1);
        let (bottom_m, right_m) = (self.far_m - self.depth_m, self.left_m + self.width_m);
        let ticks = |from: f64, to: f64| {
            ((from / step_m).ceil() as i64..=(to / step_m).floor() as i64).map(move |k| k as f64 * step_m)
        };
        for x_m in ticks(self.left_m, right_m) {
            let ([x, top], [_, base]) = (self.pixel([x_m, self.far_m]), self.pixel([x_m, bottom_m]));
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{x:.1} {top:.1}V{base:.1}\"/><text x=\"{x:.1}\" y=\"{:.1}\" \
                 text-anchor=\"middle\">{x_m:.decimals$} m</text>",
                base + 16.0
            );
        }
        for z_m in ticks(bottom_m, self.far_m) {
            let ([left, y], [right, _]) = (self.pixel([self.left_m, z_m]), self.pixel([right_m, z_m]));
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{left:.1} {y:.1}H{right:.1}\"/><text x=\"{:.1}\" y=\"{y:.1}\" \
                 text-anchor=\"end\">{z_m:.decimals$} m</text>",
                left - 4.0
            );
        }
    }
}

/// 1, 2 or 5 times a power of ten, so that there are about ten of them.
fn nice_step(whole: f64) -> f64 {
    let rough = whole / 10.0;
    let power = 10_f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 5.0].map(|factor| factor * power);
    steps.into_iter().find(|step| *step >= rough).unwrap_or(10.0 * power)
}
