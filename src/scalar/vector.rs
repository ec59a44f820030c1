//! Three-vectors as plain arrays `[x, y, z]`.

use super::scalar::Scalar;

pub(crate) fn dot<S: Scalar>(a: [S; 3], b: [S; 3]) -> S {
    let [ax, ay, az] = a;
    let [bx, by, bz] = b;
    (ax * bx).plus_product(ay, by).plus_product(az, bz)
}

pub(crate) fn cross<S: Scalar>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    let [ax, ay, az] = a;
    let [bx, by, bz] = b;
    let minor = |a: S, b: S, c: S, d: S| (a * b).minus_product(c, d);
    [minor(ay, bz, az, by), minor(az, bx, ax, bz), minor(ax, by, ay, bx)]
}

pub(crate) fn add<S: Scalar>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    let [ax, ay, az] = a;
    let [bx, by, bz] = b;
    [ax + bx, ay + by, az + bz]
}

pub(crate) fn sub<S: Scalar>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    let [ax, ay, az] = a;
    let [bx, by, bz] = b;
    [ax - bx, ay - by, az - bz]
}

pub(crate) fn scale<S: Scalar>(a: [S; 3], factor: S) -> [S; 3] {
    a.map(|component| component * factor)
}

/// A vector of a given length along one of the axes.
pub(crate) fn on_axis<S: Scalar>(axis: usize, length: S) -> [S; 3] {
    let mut vector = [S::ZERO; 3];
    if let Some(component) = vector.get_mut(axis) {
        *component = length;
    }
    vector
}
