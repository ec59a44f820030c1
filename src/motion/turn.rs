//! [`Turn`]: a rotation at a constant rate.

use crate::scalar::{Scalar, add, cross, dot, scale};

/// A turn at a constant rate: its rotation vector φ with `sin φ / φ`, `(1 − cos φ) / φ²` and `(φ − sin φ) / φ³`.
pub(super) struct Turn<S> {
    vector: [S; 3],
    a: S,
    b: S,
    c: S,
}

impl<S: Scalar> Turn<S> {
    /// The angles of a frame are small, so a short series does, without trigonometry of the back end; its error is below
    /// 10⁻¹² up to one radian.
    pub(super) fn by(vector: [S; 3]) -> Self {
        let square = dot(vector, vector);
        if square > S::ONE {
            let angle = square.sqrt();
            let a = angle.sin() / angle;
            return Self { vector, a, b: (S::ONE - angle.cos()) / square, c: (S::ONE - a) / square };
        }
        let (mut a, mut b, mut c) = (S::ONE, S::ONE, S::ONE);
        for k in (1..=7).rev() {
            c = a;
            a = S::ONE - a * square * S::ratio(1, 2 * k * (2 * k + 1));
            b = S::ONE - b * square * S::ratio(1, (2 * k + 1) * (2 * k + 2));
        }
        Self { vector, a, b: b * S::ratio(1, 2), c: c * S::ratio(1, 6) }
    }

    /// Its rotation matrix (Rodrigues): `v + A φ×v + B φ×(φ×v)`.
    pub(super) fn rotation(&self) -> [[S; 3]; 3] {
        let column = |axis| self.bend(axis, self.a, self.b);
        let [xx, yx, zx] = column([S::ONE, S::ZERO, S::ZERO]);
        let [xy, yy, zy] = column([S::ZERO, S::ONE, S::ZERO]);
        let [xz, yz, zz] = column([S::ZERO, S::ZERO, S::ONE]);
        [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]]
    }

    /// Where one gets to who goes `way`, always straight ahead, while turning: `v + B φ×v + C φ×(φ×v)`.
    pub(super) fn arc(&self, way: [S; 3]) -> [S; 3] {
        self.bend(way, self.b, self.c)
    }

    fn bend(&self, v: [S; 3], once: S, twice: S) -> [S; 3] {
        let across = cross(self.vector, v);
        add(add(v, scale(across, once)), scale(cross(self.vector, across), twice))
    }
}
