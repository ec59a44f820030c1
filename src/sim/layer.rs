//! [`Layer`]: one object on one row, and how much of each pixel it covers.

use super::bar::{Bar, EdgeInSpace, level_in_image};
use super::blur::{BlurredStep, Walk};
use super::contour::Side;
use super::exposure::Exposure;
use super::scene::{Object, Rail};
use super::shading::Cylinder;
use super::view::{Crossing, Lens, SeenLine, Vector, View, sum};

/// What all objects of a row have in common: the camera during the exposure, and the blur.
pub(super) struct RowView<'a> {
    pub(super) lens: &'a Lens,
    /// The camera at the start, in the middle and at the end of the exposure.
    pub(super) views: [View; 3],
    pub(super) gravity: Vector,
    pub(super) exposure: &'a Exposure,
    pub(super) softness: Option<Softness>,
    pub(super) columns: u16,
    pub(super) row: f64,
}

/// By how much the lens blurs more towards the corners: its variance grows with the square of the distance from the
/// principal point.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Softness {
    /// Column and row of the principal point.
    pub(super) centre: [f32; 2],
    /// In square pixels of blur per square pixel of distance.
    pub(super) variance_per_px2: f32,
}

impl Softness {
    fn variance(&self, column: f32, row: f32) -> f32 {
        let [cx, cy] = self.centre;
        let (x, y) = (column - cx, row - cy);
        self.variance_per_px2 * (x * x + y * y)
    }
}

/// Least blur of the lens: less makes no difference behind the pixel's own box.
const LEAST_SIGMA_PX: f32 = 0.05;

impl RowView<'_> {
    /// A step from its positions at the three instants of the exposure and the slope of the edge. Its position is
    /// Simpson's mean of the three, its motion the distance of the outer two. Along the row, a slanted edge is blurred
    /// more: the lens blurs across the edge, and the pixel has a height.
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

    /// The blurred edge of a bar where it crosses this row.
    fn edge(&self, bar: &Bar, side: Side, straight: &EdgeInSpace) -> Option<BlurredStep> {
        let [start, middle, end] = self.views.map(|view| self.crossing(bar, side, straight, &view));
        let (start, middle, end) = (start?, middle?, end?);
        let step = self.blurred([start.column, middle.column, end.column], middle.slope);
        Some(self.softness.as_ref().map_or(step, |softness| {
            let variance = softness.variance(step.position, self.row as f32);
            let sigma = libm::sqrtf((step.sigma * step.sigma + variance).max(LEAST_SIGMA_PX * LEAST_SIGMA_PX));
            BlurredStep { sigma, ..step }
        }))
    }

    /// Where the edge is that the bar's contour makes of its straight line.
    fn crossing(&self, bar: &Bar, side: Side, straight: &EdgeInSpace, view: &View) -> Option<Crossing> {
        let EdgeInSpace { foot_m, along, across } = *straight;
        let crossing = view.line(foot_m, along).cross_row(self.lens, self.row)?;
        if bar.contour.is_straight() {
            return Some(crossing);
        }
        let offset_m = bar.contour.offset_m(side, crossing.along_m, bar.ends_m());
        let beside_m = sum(foot_m, across.map(|component| component * offset_m));
        view.line(beside_m, along).cross_row(self.lens, self.row)
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

pub(super) struct Layer {
    level: f32,
    shape: Shape,
    shade: Option<Shade>,
}

/// The brightness of a cylinder along the row. It is blurred by a box as wide as the blur of its left edge.
struct Shade {
    cylinder: Cylinder,
    middle: f32,
    /// Half of its width in pixels, with a sign where it is seen upside down; not zero.
    radius: f32,
    box_px: f32,
}

impl Shade {
    fn new(cylinder: Cylinder, [left, right]: &[BlurredStep; 2]) -> Self {
        let radius = 0.5 * (right.position - left.position);
        // The variance of a box of width w is w²/12.
        let box_px = libm::sqrtf(12.0 * left.sigma * left.sigma + left.motion * left.motion + 1.0);
        let radius = if radius.abs() > LEAST_SIGMA_PX { radius } else { LEAST_SIGMA_PX };
        Self { cylinder, middle: 0.5 * (left.position + right.position), radius, box_px }
    }

    fn at(&self, column: f32) -> f32 {
        let (x, half) = ((column - self.middle) / self.radius, 0.5 * self.box_px / self.radius.abs());
        self.cylinder.mean(x - half, x + half)
    }
}

enum Shape {
    Bar { edges: [Walk; 2], height: f32 },
    Rail { edges: [Slant; 2], row: f32 },
    Even { cover: f32 },
}

impl Layer {
    /// `None` where the object covers nothing of the row.
    pub(super) fn new(object: &Object, view: &RowView<'_>) -> Option<Self> {
        let (shape, shade) = match object {
            Object::Bar(bar) => bar_shape(bar, view)?,
            Object::Rail(rail) => (rail_shape(rail, view)?, None),
        };
        Some(Self { level: object.level(), shape, shade })
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
        if cover > 0.0 {
            let level = self.shade.as_ref().map_or(self.level, |shade| self.level * shade.at(column));
            behind + (level - behind) * cover.min(1.0)
        } else {
            behind
        }
    }
}

fn bar_shape(bar: &Bar, view: &RowView<'_>) -> Option<(Shape, Option<Shade>)> {
    let [left, right] = Side::BOTH.map(|side| bar.edge_in_space(side, view.gravity));
    let [top_m, bottom_m] = bar.ends_m();
    let height = view.height(&view.lines(left.foot_m, left.along), top_m, bottom_m).filter(|height| *height > 0.0)?;
    let edges = [view.edge(bar, Side::Left, &left)?, view.edge(bar, Side::Right, &right)?];
    let last = f32::from(view.columns) - 1.0;
    let [from, to] = edges.map(|edge| (edge.position, edge.reach() + 0.5));
    let passes = from.0.min(to.0) - from.1.max(to.1) > last || from.0.max(to.0) + from.1.max(to.1) < 0.0;
    let shade = bar.shading.cylinder().map(|cylinder| Shade::new(cylinder, &edges));
    (!passes).then(|| (Shape::Bar { edges: edges.map(Walk::new), height }, shade))
}

/// A rail's edge along the row, as a step down each column: linear in the column, since a projection keeps lines
/// straight.
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
