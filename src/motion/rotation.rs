//! [`Rotation`]: what a constant rotation rate does to directions and to paths.

use crate::scalar::{Scalar, add, cross, dot, scale};

/// A rotation by a rotation vector φ (axis times angle), with `A = sin φ / φ`, `B = (1 − cos φ) / φ²` and
/// `C = (φ − sin φ) / φ³`.
pub(super) struct Rotation<S> {
    vector: [S; 3],
    a: S,
    b: S,
    c: S,
}

impl<S: Scalar> Rotation<S> {
    /// Up to one radian by a series, because the angles within a frame are small and a back end's own trigonometry may be
    /// coarse. The series is good to 10⁻¹².
    pub(super) fn from_vector(vector: [S; 3]) -> Self {
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

    /// The rotation matrix, as rows: `v + A φ×v + B φ×(φ×v)`.
    ///
    /// *Source*: Rodrigues' formula.
    pub(super) fn matrix(&self) -> [[S; 3]; 3] {
        let column = |axis| self.second_order(axis, self.a, self.b);
        let [xx, yx, zx] = column([S::ONE, S::ZERO, S::ZERO]);
        let [xy, yy, zy] = column([S::ZERO, S::ONE, S::ZERO]);
        let [xz, yz, zz] = column([S::ZERO, S::ZERO, S::ONE]);
        [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]]
    }

    /// Displacement of a body that covers `path` in its own axes while it makes this rotation, both at constant rates:
    /// `v + B φ×v + C φ×(φ×v)`.
    ///
    /// *Source*: the left Jacobian of SO(3).
    pub(super) fn displacement(&self, path: [S; 3]) -> [S; 3] {
        self.second_order(path, self.b, self.c)
    }

    /// `v + p φ×v + q φ×(φ×v)`
    fn second_order(&self, v: [S; 3], p: S, q: S) -> [S; 3] {
        let across = cross(self.vector, v);
        add(add(v, scale(across, p)), scale(cross(self.vector, across), q))
    }
}
