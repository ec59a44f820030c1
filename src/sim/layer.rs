//! [`Layer`]: one object on one row, and how much of each pixel it covers.

use super::blur::{BlurredStep, Walk};
use super::exposure::Exposure;
use super::scene::{Bar, Object, Rail};
use super::view::{Lens, SeenLine, Vector, View};

/// What all objects of a row have in common: the camera during the exposure, and the blur.
pub(super) struct RowView<'a> {
    pub(super) lens: &'a Lens,
    /// The camera at the start, in the middle and at the end of the exposure.
    pub(super) views: [View; 3],
    pub(super) gravity: Vector,
    pub(super) exposure: &'a Exposure,
    pub(super) columns: u16,
    pub(super) row: f64,
}

/// Least blur of the lens: less makes no difference behind the pixel's own box.
const LEAST_SIGMA_PX: f32 = 0.05;

impl RowView<'_> {
    /// A step from its positions at the three instants of the exposure and the slope of the edge. Its position is Simpson's
    /// mean of the three, its motion the distance of the outer two. Along the row, a slanted edge is blurred more: the lens
    /// blurs across the edge, and the pixel has a height.
    fn blurred(&self, [start, middle, end]: [f64; 3], slope: f64) -> BlurredStep {
        let slope = slope as f32;
        let s2 = slope * slope;
        let psf = self.exposure.psf_sigma_px;
        let sigma = libm::sqrtf(psf * psf * (1.0 + s2) + s2 * (1.0 / 12.0));
        BlurredStep {
            position: ((start + 4.0 * middle + end) / 6.0) as f32,
            motion: (end - start).abs() as f32,
            sigma: sigma.max(LEAST_SIGMA_PX),
        }
    }

    fn lines(&self, foot_m: Vector, along: Vector) -> [SeenLine; 3] {
        self.views.map(|view| view.line(foot_m, along))
    }

    /// The blurred edge where a line crosses this row.
    fn crossing(&self, lines: &[SeenLine; 3]) -> Option<BlurredStep> {
        let [start, middle, end] = lines.map(|line| line.cross_row(self.lens, self.row));
        let (start, middle, end) = (start?, middle?, end?);
        Some(self.blurred([start.column, middle.column, end.column], middle.slope))
    }

    /// Share of this row's height that lies between the ends of a line.
    fn height(&self, lines: &[SeenLine; 3], from: f64, to: f64) -> Option<f32> {
        let [start, middle, end] = lines.map(|line| line.rows_of_ends(self.lens, from, to));
        let ([from0, to0], [from1, to1], [from2, to2]) = (start?, middle?, end?);
        let row = self.row as f32;
        let from = self.blurred([from0, from1, from2], 0.0).coverage(row);
        let to = self.blurred([to0, to1, to2], 0.0).coverage(row);
        Some((from - to).abs())
    }
}

/// Direction of a bar, and a point on each of its two edges.
pub(super) fn bar_in_space(bar: &Bar, gravity: Vector) -> (Vector, [Vector; 2]) {
    let [gx, gy, gz] = gravity;
    let [across, down] = level_in_image(gravity);
    let lean = f64::from(bar.lean);
    let along = [gx + lean * across, gy + lean * down, gz];
    let depth = f64::from(bar.depth_m);
    let (middle, half) = (f64::from(bar.bearing) * depth, 0.5 * f64::from(bar.width_m));
    (along, [[middle - half, 0.0, depth], [middle + half, 0.0, depth]])
}

/// The horizontal direction in the image plane; it points to the right for a level camera.
pub(super) fn level_in_image([gx, gy, _]: Vector) -> [f64; 2] {
    let length = libm::sqrt(gx * gx + gy * gy);
    if length > 0.0 { [gy / length, -gx / length] } else { [1.0, 0.0] }
}

pub(super) struct Layer {
    level: f32,
    shape: Shape,
}

enum Shape {
    Bar { edges: [Walk; 2], height: f32 },
    Rail { edges: [Slant; 2], row: f32 },
    Even { cover: f32 },
}

impl Layer {
    /// `None` where the object covers nothing of the row.
    pub(super) fn new(object: &Object, view: &RowView<'_>) -> Option<Self> {
        let shape = match object {
            Object::Bar(bar) => bar_shape(bar, view),
            Object::Rail(rail) => rail_shape(rail, view),
        };
        shape.map(|shape| Self { level: object.level(), shape })
    }

    /// Level of a pixel once the object has been laid over the level `behind` it. To be called for ascending columns.
    pub(super) fn cover(&mut self, column: f32, behind: f32) -> f32 {
        let cover = match &mut self.shape {
            Shape::Bar { edges: [left, right], height } => (left.next(column) - right.next(column)).abs() * *height,
            Shape::Rail { edges: [top, bottom], row } => {
                (top.at(column).coverage(*row) - bottom.at(column).coverage(*row)).abs()
            }
            Shape::Even { cover } => *cover,
        };
        if cover > 0.0 { behind + (self.level - behind) * cover.min(1.0) } else { behind }
    }
}

fn bar_shape(bar: &Bar, view: &RowView<'_>) -> Option<Shape> {
    let (along, feet) = bar_in_space(bar, view.gravity);
    let [left, right] = feet.map(|foot| view.lines(foot, along));
    let height = view.height(&left, f64::from(bar.top_m), f64::from(bar.bottom_m)).filter(|height| *height > 0.0)?;
    let edges = [view.crossing(&left)?, view.crossing(&right)?];
    let last = f32::from(view.columns) - 1.0;
    let [from, to] = edges.map(|edge| (edge.position, edge.reach() + 0.5));
    let passes = from.0.min(to.0) - from.1.max(to.1) > last || from.0.max(to.0) + from.1.max(to.1) < 0.0;
    (!passes).then(|| Shape::Bar { edges: edges.map(Walk::new), height })
}

/// A rail's edge along the row, as a step down each column: linear in the column, since a projection keeps lines straight.
struct Slant {
    /// The step in column 0.
    first: BlurredStep,
    position_per_column: f32,
    motion_per_column: f32,
    /// Motion in column 0 with its sign, which `first` does not have.
    motion: f32,
}

impl Slant {
    fn new(lines: &[SeenLine; 3], view: &RowView<'_>) -> Option<Self> {
        let last = f64::from(view.columns.max(2) - 1);
        let at = |column: f64| {
            let [start, middle, end] = lines.map(|line| line.cross_column(view.lens, column));
            Some([start?, middle?, end?])
        };
        let (here, there) = (at(0.0)?, at(last)?);
        let ([start, middle, end], [start_there, middle_there, end_there]) = (here, there);
        let slope = (middle_there - middle) / last;
        let first = view.blurred(here, slope);
        let motion = end - start;
        let grown = (end_there - start_there - motion) / last;
        let position = (start_there - start + 4.0 * (middle_there - middle) + end_there - end) / (6.0 * last);
        Some(Self {
            first,
            position_per_column: position as f32,
            motion_per_column: grown as f32,
            motion: motion as f32,
        })
    }

    fn at(&self, column: f32) -> BlurredStep {
        BlurredStep {
            position: self.first.position + self.position_per_column * column,
            motion: (self.motion + self.motion_per_column * column).abs(),
            sigma: self.first.sigma,
        }
    }

    /// Whether the edge moves by less than 1/1000 px from the first column to the last.
    fn is_level(&self, columns: u16) -> bool {
        let drift = self.position_per_column.abs() + self.motion_per_column.abs();
        drift * f32::from(columns) < 0.001
    }
}

fn rail_shape(rail: &Rail, view: &RowView<'_>) -> Option<Shape> {
    let [across, down] = level_in_image(view.gravity);
    let edge = |y: f32| {
        let lines = view.lines([0.0, f64::from(y), f64::from(rail.depth_m)], [across, down, 0.0]);
        Slant::new(&lines, view)
    };
    let edges = [edge(rail.top_m)?, edge(rail.bottom_m)?];
    let row = view.row as f32;
    if edges.iter().all(|edge| edge.is_level(view.columns)) {
        let [top, bottom] = edges.map(|edge| edge.first.coverage(row));
        let cover = (top - bottom).abs();
        return (cover > 0.0).then_some(Shape::Even { cover });
    }
    Some(Shape::Rail { edges, row })
}
