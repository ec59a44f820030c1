//! [`UprightEdge`]: where the edges of a shot really are, by plain projection.

use shutter_range::Polarity;
use shutter_range::sim::{Bar, Object, Rail};

use crate::Shot;

/// One edge of a bar, at `x_m` and `depth_m` in the axes of the frame's start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UprightEdge {
    x_m: f64,
    pub(crate) depth_m: f64,
    ends_m: [f64; 2],
    /// Grey levels left and right of it.
    pub(crate) levels: [f64; 2],
}

impl UprightEdge {
    /// All of a shot.
    pub(crate) fn all(shot: &Shot) -> Vec<Self> {
        let behind = f64::from(shot.scene.background().level);
        let upright = shot.scene.objects().iter().filter_map(|object| match object {
            Object::Bar(bar) if bar.lean == 0.0 => Some(bar),
            _ => None,
        });
        upright.flat_map(|bar| Self::both(bar, behind)).collect()
    }

    fn both(bar: &Bar, behind: f64) -> [Self; 2] {
        let level = f64::from(bar.level);
        let [left, right] = feet(bar);
        let edge = |x_m, levels| Self {
            x_m,
            depth_m: bar.depth_m.into(),
            ends_m: [bar.top_m.into(), bar.bottom_m.into()],
            levels,
        };
        [edge(left, [behind, level]), edge(right, [level, behind])]
    }

    pub(crate) fn polarity(&self) -> Polarity {
        let [left, right] = self.levels;
        if right < left { Polarity::Falling } else { Polarity::Rising }
    }

    /// x/z at the frame's start.
    pub(crate) fn bearing(&self) -> f64 {
        self.x_m / self.depth_m
    }

    /// Column at a row, some seconds from the middle of its exposure.
    pub(crate) fn column(&self, shot: &Shot, row: f64, offset_s: f64) -> f64 {
        column(shot, self.bearing(), 1.0 / self.depth_m, shot.position_m(row, offset_s))
    }

    /// The rows that show it, between its ends and not behind anything nearer.
    pub(crate) fn visible_rows(&self, shot: &Shot) -> Vec<u16> {
        (0..shot.rig.rows).filter(|row| self.is_visible(shot, f64::from(*row))).collect()
    }

    fn is_visible(&self, shot: &Shot, row: f64) -> bool {
        let position_m = shot.position_m(row, 0.0);
        let column = self.column(shot, row, 0.0);
        let nearer = shot.scene.objects().iter().filter(|object| f64::from(object.depth_m()) < self.depth_m);
        let [from, to] = self.ends_m.map(|y_m| row_of(shot, y_m, self.depth_m, position_m));
        (0.0..=f64::from(shot.rig.columns - 1)).contains(&column)
            && (from..=to).contains(&row)
            && !nearer.into_iter().any(|object| hides(shot, object, column, row))
    }
}

/// Where a vertical line with this bearing and inverse depth at the frame's start appears from elsewhere.
pub(crate) fn column(shot: &Shot, bearing: f64, inverse_depth: f64, [x_m, _, z_m]: [f64; 3]) -> f64 {
    let u = (bearing - inverse_depth * x_m) / (1.0 - inverse_depth * z_m);
    0.5 * f64::from(shot.rig.columns - 1) + f64::from(shot.rig.focal_px) * u
}

fn row_of(shot: &Shot, y_m: f64, depth_m: f64, [_, from_y, from_z]: [f64; 3]) -> f64 {
    middle_row(shot) + f64::from(shot.rig.focal_px) * (y_m - from_y) / (depth_m - from_z)
}

fn middle_row(shot: &Shot) -> f64 {
    0.5 * f64::from(shot.rig.rows - 1)
}

/// x of a bar's left and right edge at y = 0.
fn feet(bar: &Bar) -> [f64; 2] {
    let (middle, half) = (f64::from(bar.bearing) * f64::from(bar.depth_m), 0.5 * f64::from(bar.width_m));
    [middle - half, middle + half]
}

fn hides(shot: &Shot, object: &Object, column: f64, row: f64) -> bool {
    match object {
        Object::Bar(bar) => bar_hides(shot, bar, column, row),
        Object::Rail(rail) => rail_hides(shot, rail, row),
    }
}

fn bar_hides(shot: &Shot, bar: &Bar, at_column: f64, row: f64) -> bool {
    let position_m = shot.position_m(row, 0.0);
    let depth_m = f64::from(bar.depth_m);
    let [_, from_y, from_z] = position_m;
    let y_m = from_y + (row - middle_row(shot)) / f64::from(shot.rig.focal_px) * (depth_m - from_z);
    let [left, right] = feet(bar).map(|x_m| {
        let bearing = (x_m + f64::from(bar.lean) * y_m) / depth_m;
        column(shot, bearing, 1.0 / depth_m, position_m)
    });
    (f64::from(bar.top_m)..=f64::from(bar.bottom_m)).contains(&y_m) && (left..=right).contains(&at_column)
}

fn rail_hides(shot: &Shot, rail: &Rail, row: f64) -> bool {
    let position_m = shot.position_m(row, 0.0);
    let [top, bottom] =
        [rail.top_m, rail.bottom_m].map(|y_m| row_of(shot, f64::from(y_m), f64::from(rail.depth_m), position_m));
    // The rail's own blur: these rows show the edge hardly at all.
    let blur = 2.0 * f64::from(shot.rig.exposure.psf_sigma_px);
    (top - blur..=bottom + blur).contains(&row)
}
