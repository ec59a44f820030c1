//! An independent projection of upright (or leaning) edges, row by row in double precision: it intersects the edge with
//! each row's plane, where the library's estimator never leaves the image.

pub(crate) type Vector = [f64; 3];
pub(crate) type Matrix = [Vector; 3];

/// A vertical edge before a moving camera; see `data/make_lines.py`, which does the same.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) columns: u16,
    pub(crate) rows: u16,
    pub(crate) focal_px: f64,
    pub(crate) cx: f64,
    pub(crate) cy: f64,
    pub(crate) readout_s: f64,
    pub(crate) velocity_m_s: Vector,
    pub(crate) rate_rad_s: Vector,
    pub(crate) gravity: Vector,
    pub(crate) bearing: f64,
    pub(crate) depth_m: f64,
    /// Lean in the image plane as a slope.
    pub(crate) tilt: f64,
}

impl Scene {
    /// VGA, 600 px, 1/30 s, moving left at 1.5 m/s past an edge 2 m ahead.
    pub(crate) fn vga() -> Self {
        Self {
            columns: 640,
            rows: 480,
            focal_px: 600.0,
            cx: 319.5,
            cy: 239.5,
            readout_s: 1.0 / 30.0,
            velocity_m_s: [-1.5, 0.0, 0.0],
            rate_rad_s: [0.0; 3],
            gravity: [0.0, 1.0, 0.0],
            bearing: 0.05,
            depth_m: 2.0,
            tilt: 0.0,
        }
    }

    /// Seconds since frame start at which a row is read, from the top.
    pub(crate) fn time_s(&self, row: u16) -> f64 {
        f64::from(row) * self.readout_s / f64::from(self.rows)
    }

    /// Column at which the edge crosses a row, read from the top.
    pub(crate) fn column(&self, row: u16) -> f64 {
        self.column_at(f64::from(row), self.time_s(row))
    }

    /// Column at which the edge crosses a row that is read at `time_s`.
    pub(crate) fn column_at(&self, row: f64, time_s: f64) -> f64 {
        let in_camera = transposed(rotation(self.rate_rad_s.map(|rate| rate * time_s)));
        let [gx, gy, _] = self.gravity;
        let across = (gx * gx + gy * gy).sqrt();
        let lean = [gy / across, -gx / across, 0.0].map(|component| component * self.tilt);
        let down = std::array::from_fn(|axis| self.gravity[axis] + lean[axis]);
        let foot = [self.bearing * self.depth_m, 0.0, self.depth_m];
        let from_camera = std::array::from_fn(|axis| foot[axis] - self.velocity_m_s[axis] * time_s);
        let a = times(in_camera, from_camera);
        let b = times(in_camera, down);
        let w = (row - self.cy) / self.focal_px;
        let along = (w * a[2] - a[1]) / (b[1] - w * b[2]);
        self.cx + self.focal_px * (a[0] + along * b[0]) / (a[2] + along * b[2])
    }

    /// Rows whose crossing lies inside the image.
    pub(crate) fn visible_rows(&self) -> Vec<u16> {
        let inside = |row: &u16| (0.0..f64::from(self.columns - 1)).contains(&self.column(*row));
        (0..self.rows).filter(inside).collect()
    }
}

pub(crate) fn times(matrix: Matrix, v: Vector) -> Vector {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

pub(crate) fn transposed(m: Matrix) -> Matrix {
    std::array::from_fn(|row| std::array::from_fn(|column| m[column][row]))
}

/// Rotation by an angle about a unit axis, written out component by component.
pub(crate) fn rotation(vector: Vector) -> Matrix {
    let angle = vector.iter().map(|c| c * c).sum::<f64>().sqrt();
    if angle < 1e-15 {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    let [x, y, z] = vector.map(|c| c / angle);
    let (s, c) = angle.sin_cos();
    let d = 1.0 - c;
    [
        [c + x * x * d, x * y * d - z * s, x * z * d + y * s],
        [y * x * d + z * s, c + y * y * d, y * z * d - x * s],
        [z * x * d - y * s, z * y * d + x * s, c + z * z * d],
    ]
}
