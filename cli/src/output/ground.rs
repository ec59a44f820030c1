//! The ground that edges stand on: directions perpendicular to gravity, and vectors.

use super::birds_eye::Point;

pub(crate) type Rows = [[f64; 3]; 3];

/// Right and ahead, both perpendicular to gravity.
#[derive(Clone, Copy)]
pub(crate) struct Ground([[f64; 3]; 2]);

impl Ground {
    pub(crate) fn new([x, y, z]: [f64; 3]) -> Self {
        let across = x.hypot(y);
        // A camera that looks straight down has its top ahead.
        let right = if across > 0.0 { [y / across, -x / across, 0.0] } else { [1.0, 0.0, 0.0] };
        let [rx, ry, rz] = right;
        Self([right, [ry * z - rz * y, rz * x - rx * z, rx * y - ry * x]])
    }

    pub(crate) fn place(&self, point: [f64; 3]) -> Point {
        self.0.map(|axis| dot(axis, point))
    }
}

pub(crate) fn dot([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> f64 {
    a * x + b * y + c * z
}

pub(crate) fn sum([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [a + x, b + y, c + z]
}

pub(crate) fn turned(rotation: &Rows, vector: [f64; 3]) -> [f64; 3] {
    rotation.map(|row| dot(row, vector))
}

pub(crate) fn transposed([[a, b, c], [d, e, f], [g, h, i]]: &Rows) -> Rows {
    [[*a, *d, *g], [*b, *e, *h], [*c, *f, *i]]
}
