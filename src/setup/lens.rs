//! [`Lens`]: the mapping of a lens model and its inverse, in numbers of any size or near one.

use crate::scalar::{Arithmetic, Near, Scalar, Whole};

/// The image of a point under the lens model or its inverse, with the Jacobian of the mapping there.
#[derive(Clone, Copy)]
pub(crate) struct Mapped<N> {
    pub(crate) point: [N; 2],
    /// `[[∂u/∂u, ∂u/∂w], [∂w/∂u, ∂w/∂w]]`
    pub(crate) jacobian: [[N; 2]; 2],
}

impl<N: Near> Mapped<N> {
    pub(super) fn whole<S: Scalar<Near = N>>(&self) -> Mapped<Whole<S>> {
        let whole = |pair: [N; 2]| pair.map(|part| Whole(S::of_near(part, 0)));
        Mapped { point: whole(self.point), jacobian: self.jacobian.map(whole) }
    }
}

impl<N: Arithmetic> Mapped<N> {
    /// Where a point so far off is mapped to, by the Jacobian here.
    pub(super) fn linear(&self, off: [N; 2]) -> [N; 2] {
        let ([u, w], [du, dw]) = (self.point, self.step(off));
        [u + du, w + dw]
    }

    /// What a point so far off is moved by.
    pub(super) fn step(&self, [u, w]: [N; 2]) -> [N; 2] {
        let [[uu, uw], [wu, ww]] = self.jacobian;
        [uu.times(u).plus_product(uw, w), wu.times(u).plus_product(ww, w)]
    }

    /// Scale of a small area under the mapping: zero at a fold.
    pub(crate) fn determinant(&self) -> N {
        let [[a, b], [c, d]] = self.jacobian;
        a.times(d) - b.times(c)
    }

    /// Inverse of the Jacobian; `None` at or beyond a fold.
    fn inverse_jacobian(&self, nearness: &Nearness<N>) -> Option<[[N; 2]; 2]> {
        let [[a, b], [c, d]] = self.jacobian;
        let least = match nearness.farthest {
            None => N::ratio(1, 64),
            Some(_) if [a, b, c, d].into_iter().all(|part| part.abs() < N::ratio(5, 2)) => N::ratio(5, 8),
            Some(_) => return None,
        };
        let determinant = self.determinant();
        (determinant > least).then(|| {
            let per_area = N::ratio(1, 1).over(determinant);
            [[d.times(per_area), -b.times(per_area)], [-c.times(per_area), a.times(per_area)]]
        })
    }
}

/// The coefficients of a [`Distortion`](super::Distortion).
#[derive(Clone, Copy)]
pub(super) struct Lens<N> {
    numerator: [N; 3],
    /// `None` but in the rational model.
    divisor: Option<[N; 3]>,
    p1: N,
    p2: N,
}

/// Where the inversion ends.
#[derive(Clone, Copy)]
pub(super) struct Nearness<N> {
    /// A step whose square is no more than this is the last.
    pub(super) step_squared: N,
    /// Rounding can keep the last digits from settling: a residual of this size counts as converged.
    pub(super) residual: N,
    /// For numbers near one: no point may lie beyond, along either axis.
    pub(super) farthest: Option<N>,
}

impl<N: Arithmetic> Nearness<N> {
    /// Whether numbers near one may not hold what becomes of a point.
    pub(super) fn excludes(&self, point: [N; 2]) -> bool {
        self.farthest.is_some_and(|farthest| point.into_iter().any(|part| part.abs() > farthest))
    }
}

impl<N: Arithmetic> Lens<N> {
    /// From the coefficients in OpenCV's order.
    pub(super) fn new([k1, k2, p1, p2, k3, k4, k5, k6]: [N; 8]) -> Self {
        let divisor = [k4, k5, k6];
        let divisor = (divisor != [N::ZERO; 3]).then_some(divisor);
        Self { numerator: [k1, k2, k3], divisor, p1, p2 }
    }

    /// From the ideal to the recorded point.
    pub(super) fn distort(&self, [u, w]: [N; 2]) -> Mapped<N> {
        let (uu, uw, ww) = (u.times(u), u.times(w), w.times(w));
        // Half the derivative of `radial` by u is u times its slope.
        let [radial, slope] = self.radial(uu + ww);
        let (p1u, p1w, p2u, p2w) = (self.p1.times(u), self.p1.times(w), self.p2.times(u), self.p2.times(w));
        let twice = |value: N| value + value;
        let along_u = radial + twice(uu.times(slope) + p1w + twice(p2u) + p2u);
        let along_w = radial + twice(ww.times(slope) + p2u + twice(p1w) + p1w);
        let cross = twice(uw.times(slope) + p1u + p2w);
        Mapped { point: self.with_radial([u, w], [uu, uw, ww], radial), jacobian: [[along_u, cross], [cross, along_w]] }
    }

    /// The mean of the ideal points at both ends of a stretch about one whose inverse mapping is known, `half` to
    /// either side: one step from there for each. What the Jacobian has changed by cancels in the mean, and its square
    /// is left of each step.
    ///
    /// *Cost*: about 60 operations.
    pub(super) fn mean_of_ends(&self, ideal: &Mapped<N>, [u, w]: [N; 2], [half_u, half_w]: [N; 2]) -> [N; 2] {
        let [middle_u, middle_w] = ideal.point;
        let [before_u, before_w] = self.distort_point([middle_u - half_u, middle_w - half_w]);
        let [after_u, after_w] = self.distort_point([middle_u + half_u, middle_w + half_w]);
        ideal.linear([u - (before_u + after_u).half(), w - (before_w + after_w).half()])
    }

    /// From the ideal to the recorded point.
    fn distort_point(&self, [u, w]: [N; 2]) -> [N; 2] {
        let (uu, uw, ww) = (u.times(u), u.times(w), w.times(w));
        let [radial, _] = self.radial(uu + ww);
        self.with_radial([u, w], [uu, uw, ww], radial)
    }

    /// The same from the products of u and w, and the radial factor.
    #[inline]
    fn with_radial(&self, [u, w]: [N; 2], [uu, uw, ww]: [N; 3], radial: N) -> [N; 2] {
        let (r2, both) = (uu + ww, uw + uw);
        let tangential_u = self.p1.times(both).plus_product(self.p2, r2 + (uu + uu));
        let tangential_w = self.p2.times(both).plus_product(self.p1, r2 + (ww + ww));
        [tangential_u.plus_product(u, radial), tangential_w.plus_product(w, radial)]
    }

    /// The radial factor at r², and its derivative by r².
    fn radial(&self, r2: N) -> [N; 2] {
        let [numerator, rise] = cubic(self.numerator, r2);
        let Some(divisor) = self.divisor else { return [numerator, rise] };
        let [denominator, fall] = cubic(divisor, r2);
        let radial = numerator.over(denominator);
        [radial, (rise - radial.times(fall)).over(denominator)]
    }

    /// From the recorded to the ideal point, by Newton's method from a start near it. The Jacobian is that of this
    /// *inverse* mapping. `None` where the model folds over, or where numbers near one do not hold it.
    ///
    /// *Cost*: two to five steps of about 60 operations for real lenses, one from where the last point had it.
    // Inlined into both its users: one of them once a sample, where a call takes a tenth as long as it.
    #[inline(always)]
    pub(super) fn undistort_from(&self, recorded: [N; 2], start: [N; 2], nearness: &Nearness<N>) -> Option<Mapped<N>> {
        if nearness.excludes(start) {
            return None;
        }
        let mut point = start;
        let mut mapped = self.distort(point);
        let mut residual = difference(recorded, mapped.point);
        for _ in 0..MAX_STEPS {
            let jacobian = mapped.inverse_jacobian(nearness)?;
            let [[iuu, iuw], [iwu, iww]] = jacobian;
            let (mut du, mut dw) =
                (iuu.times(residual[0]) + iuw.times(residual[1]), iwu.times(residual[0]) + iww.times(residual[1]));
            // The next step would be its square, or a few times that.
            let step = du.abs() + dw.abs();
            if !(step.times(step) > nearness.step_squared) {
                return Some(Mapped { point: [point[0] + du, point[1] + dw], jacobian });
            }
            // A step that overshoots is halved: near a fold the linear model holds for short steps only.
            for _ in 0..MAX_HALVINGS {
                let next = [point[0] + du, point[1] + dw];
                if nearness.excludes(next) {
                    return None;
                }
                let next_mapped = self.distort(next);
                let next_residual = difference(recorded, next_mapped.point);
                if size(next_residual) < size(residual) {
                    (point, mapped, residual) = (next, next_mapped, next_residual);
                    break;
                }
                (du, dw) = (du.half(), dw.half());
            }
        }
        let converged = size(residual) <= nearness.residual;
        mapped.inverse_jacobian(nearness).filter(|_| converged).map(|jacobian| Mapped { point, jacobian })
    }
}

/// `1 + a x + b x² + c x³` and its derivative.
fn cubic<N: Arithmetic>([a, b, c]: [N; 3], x: N) -> [N; 2] {
    let (xb, xxc) = (x.times(b), x.times(x.times(c)));
    [N::ratio(1, 1).plus_product(x, a + (xb + xxc)), a + (xb + xb) + (xxc + xxc + xxc)]
}

fn difference<N: Arithmetic>(a: [N; 2], b: [N; 2]) -> [N; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn size<N: Arithmetic>([u, w]: [N; 2]) -> N {
    u.abs() + w.abs()
}

const MAX_HALVINGS: usize = 6;

/// Each step doubles the number of correct digits; a point that has not converged by then lies at or beyond a fold.
const MAX_STEPS: usize = 24;
