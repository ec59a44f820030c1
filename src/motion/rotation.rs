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

/// A, 2 B and 6 C from the square of the angle.
fn series<S: Scalar>(square: S) -> (S, S, S) {
    let (mut a, mut b, mut c) = (S::ONE, S::ONE, S::ONE);
    for k in (1..=7).rev() {
        c = a;
        a = S::ONE - a * square * S::ratio(1, 2 * k * (2 * k + 1));
        b = S::ONE - b * square * S::ratio(1, (2 * k + 1) * (2 * k + 2));
    }
    (a, b, c)
}

/// The first three terms of the same, written out so that no constant is divided at run time.
fn short_series<S: Scalar>(square: S) -> (S, S, S) {
    let next = |rest: S, part: S| S::ONE - rest * square * part;
    let c = next(next(S::ONE, S::ratio(1, 42)), S::ratio(1, 20));
    let b = next(next(next(S::ONE, S::ratio(1, 56)), S::ratio(1, 30)), S::ratio(1, 12));
    (next(c, S::ratio(1, 6)), b, c)
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
        // Within a frame the angle is mostly below a sixteenth of a radian, where three terms are as good.
        let (a, b, c) = if square < S::ratio(1, 256) { short_series(square) } else { series(square) };
        Self { vector, a, b: b * S::ratio(1, 2), c: c * S::ratio(1, 6) }
    }

    /// The rotation matrix, as rows: `I + A [φ]× + B [φ]×²`, with `[φ]×² = φ φᵀ − φ² I`.
    ///
    /// *Source*: Rodrigues' formula.
    pub(super) fn matrix(&self) -> [[S; 3]; 3] {
        let [x, y, z] = self.vector;
        let [ax, ay, az] = scale(self.vector, self.a);
        let [bx, by, bz] = scale(self.vector, self.b);
        let (xy, xz, yz) = (bx * y, bx * z, by * z);
        let (xx, yy, zz) = (bx * x, by * y, bz * z);
        [
            [S::ONE - (yy + zz), xy - az, xz + ay],
            [xy + az, S::ONE - (xx + zz), yz - ax],
            [xz - ay, yz + ax, S::ONE - (xx + yy)],
        ]
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
