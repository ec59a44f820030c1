//! [`Rotation`]: what a constant rotation rate does to directions and to paths.

use crate::scalar::{Arithmetic, Scalar, Whole, add, cross, dot, near_dot, scale};

/// A rotation by a rotation vector φ (axis times angle), with `A = sin φ / φ` and `B = (1 − cos φ) / φ²`.
pub(super) struct Rotation<S> {
    vector: [S; 3],
    /// φ²
    square: S,
    a: S,
    b: S,
}

/// A, B and `C = (φ − sin φ) / φ³` from the square of an angle of up to one radian, good to 10⁻¹².
fn series<S: Scalar>(square: S) -> [S; 3] {
    let (mut a, mut b, mut c) = (S::ONE, S::ONE, S::ONE);
    for k in (1..=7).rev() {
        c = a;
        a = S::ONE - a * square * S::ratio(1, 2 * k * (2 * k + 1));
        b = S::ONE - b * square * S::ratio(1, (2 * k + 1) * (2 * k + 2));
    }
    [a, b.half(), c * S::ratio(1, 6)]
}

/// The same of an angle of up to a sixteenth of a radian, as most are within a frame, from the first terms: 1/n! with
/// every second n.
#[inline(always)] // so that no constant is divided at run time
fn short_series<N: Arithmetic>(square: N, [first, second, third, fourth]: [i32; 4]) -> N {
    let last = N::ratio(1, third).minus_product(square, N::ratio(1, fourth));
    N::ratio(1, first).minus_product(square, N::ratio(1, second).minus_product(square, last))
}

/// A and B, in the same way.
#[inline(always)]
fn of_small_angle<N: Arithmetic>(square: N) -> [N; 2] {
    [short_series(square, [1, 6, 120, 5_040]), short_series(square, [2, 24, 720, 40_320])]
}

/// Squares of angles below one over this are those of small angles.
const SMALL: i32 = 256;

/// An angle of so many radians, squared, is doubled to without losing more than its own rounding.
const MOST_SQUARE: i32 = 1024;

/// A and B of an angle of any size. Of many turns only the rest counts: by doublings alone a rotation would not keep
/// lengths.
#[inline(never)]
fn of_angle<S: Scalar>(square: S) -> [S; 2] {
    if square <= S::from_i32(MOST_SQUARE) {
        return doubled(square);
    }
    // To 10⁻¹⁹, as two quotients of whole numbers.
    let turn = S::ratio(208_696, 33_215) - S::ratio(1, 1_507_714_343);
    let angle = square.sqrt();
    // Of an angle that its type does not resolve, any.
    let rest = (angle - S::from_i64((angle / turn).to_i64()) * turn).max(S::ZERO).min(turn);
    let [a, b] = doubled(rest * rest);
    let part = rest / angle;
    [a * part, b * part * part]
}

/// A and B of such an angle: from the series of a half, a quarter and so on of it that is at most one radian, by
/// `A(2φ) = A cos φ` and `B(2φ) = A²/2`.
fn doubled<S: Scalar>(square: S) -> [S; 2] {
    let (mut part, mut halvings) = (square, 0);
    while part > S::ONE {
        (part, halvings) = (part.half().half(), halvings + 1);
    }
    let [mut a, mut b, _] = series(part);
    for _ in 0..halvings {
        (a, b) = (a * (S::ONE - b * part), (a * a).half());
        part = part * S::from_i32(4);
    }
    [a, b]
}

impl<S: Scalar> Rotation<S> {
    /// By series and not by a back end's own trigonometry, which may be coarse, and in single precision calculates with
    /// doubles.
    pub(super) fn from_vector(vector: [S; 3]) -> Self {
        let square = dot(vector, vector);
        let [a, b] = if square < S::ratio(1, SMALL) {
            of_small_angle(Whole(square)).map(|Whole(series)| series)
        } else {
            of_angle(square)
        };
        Self { vector, square, a, b }
    }

    fn c(&self) -> S {
        if self.square < S::ratio(1, SMALL) {
            short_series(Whole(self.square), [6, 120, 5_040, 362_880]).0
        } else if self.square > S::ONE {
            (S::ONE - self.a) / self.square
        } else {
            let [.., c] = series(self.square);
            c
        }
    }

    /// The rotation matrix, as rows.
    pub(super) fn matrix(&self) -> [[S; 3]; 3] {
        let RotationMatrix(rows) = RotationMatrix::of(self.vector.map(Whole), Whole(self.a), Whole(self.b));
        rows.map(|row| row.map(|Whole(part)| part))
    }

    /// Displacement of a body that covers `path` in its own axes while it makes this rotation, both at constant rates:
    /// `v + B φ×v + C φ×(φ×v)`.
    ///
    /// *Source*: the left Jacobian of SO(3).
    pub(super) fn displacement(&self, path: [S; 3]) -> [S; 3] {
        self.second_order(path, self.b, self.c())
    }

    /// `v + p φ×v + q φ×(φ×v)`
    fn second_order(&self, v: [S; 3], p: S, q: S) -> [S; 3] {
        let across = cross(self.vector, v);
        add(add(v, scale(across, p)), scale(cross(self.vector, across), q))
    }
}

/// A rotation matrix, as rows.
pub(crate) struct RotationMatrix<N>(pub(crate) [[N; 3]; 3]);

impl<N: Arithmetic> RotationMatrix<N> {
    /// Of a rotation vector of up to a sixteenth of a radian; `None` of a larger one.
    pub(crate) fn of_small(vector: [N; 3]) -> Option<Self> {
        let square = near_dot(vector, vector);
        let [a, b] = of_small_angle(square);
        (square < N::ratio(1, SMALL)).then(|| Self::of(vector, a, b))
    }

    /// `I + A [φ]× + B [φ]×²`, with `[φ]×² = φ φᵀ − φ² I`.
    ///
    /// *Source*: Rodrigues' formula.
    fn of([x, y, z]: [N; 3], a: N, b: N) -> Self {
        let [ax, ay, az] = [x, y, z].map(|part| part.times(a));
        let [bx, by, bz] = [x, y, z].map(|part| part.times(b));
        let (xy, xz, yz) = (bx.times(y), bx.times(z), by.times(z));
        let (xx, yy, zz) = (bx.times(x), by.times(y), bz.times(z));
        let one = N::ratio(1, 1);
        Self([
            [one - (yy + zz), xy - az, xz + ay],
            [xy + az, one - (xx + zz), yz - ax],
            [xz - ay, yz + ax, one - (xx + yy)],
        ])
    }

    /// The rotated direction along the x axis.
    pub(crate) fn right(&self, length: N) -> [N; 3] {
        self.0.map(|[x, ..]| x.times(length))
    }

    /// Along the z axis.
    pub(crate) fn ahead(&self, length: N) -> [N; 3] {
        self.0.map(|[.., z]| z.times(length))
    }

    /// Across the z axis.
    pub(crate) fn across(&self, [u, w]: [N; 2]) -> [N; 3] {
        self.0.map(|[x, y, _]| x.times(u).plus_product(y, w))
    }
}
