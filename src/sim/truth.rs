//! [`Truth`]: where an edge of the scene really is.

use super::bar::{Bar, level_in_image};
use super::contour::Side;
use super::scene::Object;
use super::simulator::Simulator;
use super::view::{SeenLine, Vector, View};
use crate::edge::Polarity;

/// One edge of a bar, as a range finder should find it in a frame: the straight line from which its contour departs.
///
/// Bearing and depth are those of the point where that line crosses y = 0 at the frame's start.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Truth {
    /// x/z of that point, positive to the right.
    pub bearing: f64,
    /// z of that point in metres.
    pub depth_m: f64,
    /// Polarity of the edge's limb before the plain background; [`Polarity::Unknown`] where both are equally bright.
    pub polarity: Polarity,
    /// Topmost row that shows the edge: inside the image, between the bar's ends and not behind a nearer object.
    pub first_row: u16,
    /// Lowest row that shows the edge.
    pub last_row: u16,
    /// How many rows show the edge; fewer than from first to last where a nearer object hides some.
    pub visible_rows: u16,
    /// The edge's lean as a slope, its bar's taper included. Zero is upright; only upright edges have a distance that
    /// can be measured.
    pub lean: f32,
}

impl Truth {
    /// Whether the edge stands upright.
    #[must_use]
    pub fn is_upright(&self) -> bool {
        self.lean == 0.0
    }
}

impl<const OBJECTS: usize> Simulator<'_, OBJECTS> {
    /// The edges of bars that at least one row of this frame shows: the farthest bar first, its left edge before its
    /// right one.
    ///
    /// *Cost*: for each edge and each row of the image one projection of every nearer object in double precision; up to
    /// a few milliseconds on a desktop.
    pub fn truth(&self) -> impl Iterator<Item = Truth> + '_ {
        edges(self)
    }
}

fn edges<'s, const OBJECTS: usize>(simulator: &'s Simulator<'_, OBJECTS>) -> impl Iterator<Item = Truth> + 's {
    simulator.scene().objects().iter().enumerate().flat_map(move |(index, object)| {
        Side::BOTH.into_iter().filter_map(move |side| match object {
            Object::Bar(bar) => edge(simulator, index, bar, side),
            Object::Rail(_) => None,
        })
    })
}

fn edge<const OBJECTS: usize>(
    simulator: &Simulator<'_, OBJECTS>,
    index: usize,
    bar: &Bar,
    side: Side,
) -> Option<Truth> {
    let line = |view: &View| bar_edge(simulator, view, bar, side);
    let (bearing, depth_m) = line(&simulator.view(0.0)).at_eye_level()?;
    let (mut first_row, mut last_row, mut visible_rows) = (None, 0, 0);
    for row in 0..simulator.rows() {
        let view = simulator.view(simulator.row_time_s(row));
        if shows(simulator, &view, &line(&view), index, bar, row) {
            first_row = first_row.or(Some(row));
            last_row = row;
            visible_rows += 1;
        }
    }
    let background = simulator.scene().background().level;
    let [left, right] = bar.shading.at_limbs();
    let brighter = match side {
        Side::Left => bar.level * left - background,
        Side::Right => background - bar.level * right,
    };
    let polarity = if brighter > 0.0 {
        Polarity::Rising
    } else if brighter < 0.0 {
        Polarity::Falling
    } else {
        Polarity::Unknown
    };
    Some(Truth {
        bearing,
        depth_m,
        polarity,
        first_row: first_row?,
        last_row,
        visible_rows,
        lean: bar.lean_of(side) as f32,
    })
}

fn bar_edge<const OBJECTS: usize>(simulator: &Simulator<'_, OBJECTS>, view: &View, bar: &Bar, side: Side) -> SeenLine {
    let edge = bar.edge_in_space(side, simulator.gravity());
    view.line(edge.foot_m, edge.along)
}

/// Whether a row shows the edge in the middle of its exposure.
fn shows<const OBJECTS: usize>(
    simulator: &Simulator<'_, OBJECTS>,
    view: &View,
    line: &SeenLine,
    index: usize,
    bar: &Bar,
    row: u16,
) -> bool {
    let row = f64::from(row);
    let Some(crossing) = line.cross_row(simulator.lens(), row) else {
        return false;
    };
    let column = crossing.column;
    let inside = column >= -0.5 && column <= f64::from(simulator.columns()) - 0.5;
    let nearer = || simulator.scene().objects().iter().skip(index + 1);
    inside && between(simulator, line, bar, row) && !nearer().any(|object| hides(simulator, view, object, column, row))
}

fn between<const OBJECTS: usize>(simulator: &Simulator<'_, OBJECTS>, line: &SeenLine, bar: &Bar, row: f64) -> bool {
    let ends = line.rows_of_ends(simulator.lens(), f64::from(bar.top_m), f64::from(bar.bottom_m));
    ends.is_some_and(|[from, to]| (row - from) * (row - to) <= 0.0)
}

/// Whether an object covers a point of the image.
fn hides<const OBJECTS: usize>(
    simulator: &Simulator<'_, OBJECTS>,
    view: &View,
    object: &Object,
    column: f64,
    row: f64,
) -> bool {
    match object {
        Object::Bar(bar) => {
            let [left, right] = Side::BOTH.map(|side| bar_edge(simulator, view, bar, side));
            let lens = simulator.lens();
            match (left.cross_row(lens, row), right.cross_row(lens, row)) {
                (Some(from), Some(to)) => {
                    (column - from.column) * (column - to.column) <= 0.0 && between(simulator, &left, bar, row)
                }
                _ => false,
            }
        }
        Object::Rail(rail) => {
            let [across, down] = level_in_image(simulator.gravity());
            let edge = |y: f32| -> Option<f64> {
                let foot: Vector = [0.0, f64::from(y), f64::from(rail.depth_m)];
                view.line(foot, [across, down, 0.0]).cross_column(simulator.lens(), column)
            };
            match (edge(rail.top_m), edge(rail.bottom_m)) {
                (Some(from), Some(to)) => (row - from) * (row - to) <= 0.0,
                _ => false,
            }
        }
    }
}
