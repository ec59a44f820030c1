//! [`NormalEquations`]: least squares with three unknowns from equations that come one after the other.

use crate::scalar::{Scalar, dot, hypot, scale, sub};

/// Sums over weighted equations `x · unknowns = y`; priors are equations, too.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct NormalEquations<S> {
    products: [[S; 3]; 3],
    right: [S; 3],
    squares: S,
}

/// Weighted sums over the equations of a group.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Group<S> {
    weight: S,
    x: [S; 3],
    y: S,
}

impl<S: Scalar> Group<S> {
    pub(super) const EMPTY: Self = Self { weight: S::ZERO, x: [S::ZERO; 3], y: S::ZERO };

    pub(super) fn add(&mut self, x: [S; 3], y: S, sigma: S) {
        let weight = S::ONE / sigma / sigma;
        self.weight = self.weight + weight;
        self.x = sub(self.x, scale(x, -weight));
        self.y = self.y + weight * y;
    }
}

/// Unknowns with their standard deviations for equations of unit variance, and the sum of squares that they leave.
pub(super) struct Solution<S> {
    pub(super) unknowns: [S; 3],
    pub(super) sigmas: [S; 3],
    pub(super) squares: S,
}

impl<S: Scalar> NormalEquations<S> {
    pub(super) const EMPTY: Self = Self { products: [[S::ZERO; 3]; 3], right: [S::ZERO; 3], squares: S::ZERO };

    /// The same with the variances of all equations times a factor.
    pub(super) fn with_variances(&self, factor: S) -> Self {
        let per = S::ONE / factor;
        let products = self.products.map(|row| scale(row, per));
        Self { products, right: scale(self.right, per), squares: self.squares * per }
    }

    /// What is known beforehand: each unknown is zero but for a sigma.
    pub(super) fn add_priors(&mut self, [first, second, third]: [S; 3]) {
        let none = S::ZERO;
        self.add([S::ONE, none, none], none, first);
        self.add([none, S::ONE, none], none, second);
        self.add([none, none, S::ONE], none, third);
    }

    /// One more equation, whose right side has this sigma.
    pub(super) fn add(&mut self, x: [S; 3], y: S, sigma: S) {
        let (x, y) = (scale(x, S::ONE / sigma), y / sigma);
        for (row, factor) in self.products.iter_mut().zip(x) {
            *row = sub(*row, scale(x, -factor));
        }
        self.right = sub(self.right, scale(x, -y));
        self.squares = self.squares + y * y;
    }

    /// Takes out an unknown that a group of equations shares, of which nothing but a sigma is known: sums of their
    /// weights, of weight times x and of weight times y. The variances of its equations are those of the group times a
    /// factor.
    pub(super) fn take_out(&mut self, group: &Group<S>, factor: S, sigma: S) {
        let per = S::ONE / factor;
        let group = Group { weight: group.weight * per, x: scale(group.x, per), y: group.y * per };
        let whole = S::ONE / (group.weight + S::ONE / sigma / sigma);
        for (row, factor) in self.products.iter_mut().zip(group.x) {
            *row = sub(*row, scale(group.x, factor * whole));
        }
        self.right = sub(self.right, scale(group.x, group.y * whole));
        self.squares = self.squares - group.y * group.y * whole;
    }

    /// By elimination, which priors keep from failing; `None` where the numbers have left their range.
    pub(super) fn solve(&self) -> Option<Solution<S>> {
        let [[a, b, c], [_, d, e], [_, _, f]] = self.products;
        let [p, q, r] = self.right;
        // L D Lᵀ
        let (l21, l31) = (b / a, c / a);
        let d2 = d - l21 * b;
        let e2 = e - l31 * b;
        let l32 = e2 / d2;
        let d3 = f - l31 * c - l32 * e2;
        let q2 = q - l21 * p;
        let z = (r - l31 * p - l32 * q2) / d3;
        let y = q2 / d2 - l32 * z;
        let x = p / a - l21 * y - l31 * z;
        // Of the inverse: rows of L⁻¹ over the roots of D.
        let (root1, root2, root3) = (a.sqrt(), d2.sqrt(), d3.sqrt());
        let corner = l21 * l32 - l31;
        let sigma_x = hypot(hypot(S::ONE / root1, l21 / root2), corner / root3);
        let sigmas = [sigma_x, hypot(S::ONE / root2, l32 / root3), S::ONE / root3];
        let unknowns = [x, y, z];
        let squares = (self.squares - dot(unknowns, self.right)).max(S::ZERO);
        let is_sound = sigmas.into_iter().chain(unknowns).all(|number| number.is_finite());
        is_sound.then_some(Solution { unknowns, sigmas, squares })
    }
}
