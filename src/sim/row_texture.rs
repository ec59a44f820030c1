//! [`RowTexture`]: the background's texture along one row.

use super::random::{hash, mix};
use super::scene::Background;
use super::texture::Texture;
use super::view::{Lens, Vector, View};

/// The background along one row.
pub(super) struct RowTexture {
    level: f32,
    contrast: f32,
    key: u64,
    /// Direction of column 0 in the first frame's axes, x and y in cells.
    start: [f32; 3],
    /// Its change per column.
    step: [f32; 3],
    /// The cell of the previous pixel.
    cell: Option<[i32; 2]>,
    /// Values at the corners of that cell.
    corners: [[f32; 2]; 2],
}

impl RowTexture {
    pub(super) fn new(background: &Background, view: &View, lens: &Lens, row: f64) -> Self {
        let Texture { contrast, cell, seed } = background.texture;
        let (u, w) = lens.bearings(0.0, row);
        let (next, _) = lens.bearings(1.0, row);
        let in_cells = |[x, y, z]: Vector| {
            let cell = f64::from(cell);
            [(x / cell) as f32, (y / cell) as f32, z as f32]
        };
        Self {
            level: background.level,
            contrast,
            key: mix(u64::from(seed)),
            start: in_cells(view.in_first_frame([u, w, 1.0])),
            step: in_cells(view.in_first_frame([next - u, 0.0, 0.0])),
            cell: None,
            corners: [[0.0; 2]; 2],
        }
    }

    /// Level of the background at a column. Beside and behind the first frame's camera there is no texture.
    pub(super) fn level(&mut self, column: f32) -> f32 {
        if self.contrast == 0.0 {
            return self.level;
        }
        let [x0, y0, z0] = self.start;
        let [dx, dy, dz] = self.step;
        let z = z0 + dz * column;
        if !(z > 0.05) {
            return self.level;
        }
        let (x, y) = ((x0 + dx * column) / z, (y0 + dy * column) / z);
        let (left, top) = (libm::floorf(x), libm::floorf(y));
        let cell = [left as i32, top as i32];
        if self.cell != Some(cell) {
            self.cell = Some(cell);
            let [i, j] = cell;
            let [right, below] = [i.wrapping_add(1), j.wrapping_add(1)];
            let value = |i, j| corner(self.key, i, j);
            self.corners = [[value(i, j), value(right, j)], [value(i, below), value(right, below)]];
        }
        let (s, t) = (smooth(x - left), smooth(y - top));
        let [upper, lower] = self.corners.map(|[left, right]| left + (right - left) * s);
        self.level + self.contrast * (upper + (lower - upper) * t)
    }
}

/// Smoothstep: from 0 to 1 with a slope of zero at both ends.
fn smooth(part: f32) -> f32 {
    part * part * (3.0 - 2.0 * part)
}

/// The random value at a corner of the grid, −1 to 1.
fn corner(key: u64, i: i32, j: i32) -> f32 {
    let bits = hash(hash(key, i as u64), j as u64) >> 40;
    bits as f32 * (2.0 / 16_777_215.0) - 1.0
}
