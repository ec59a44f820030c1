//! [`LensSpans`]: the rays of stretches of pixels along a line behind a lens that distorts, one after the other.

use super::distortion::Distortion;
use super::lens::{Lens, Mapped, Nearness};
use crate::scalar::{Arithmetic, Near, Scalar, Whole, size_of_all};

/// The rays of a stretch of pixels `(u, w, 1)`: the mean of those at its ends and half their difference, and the change
/// by a pixel along the row.
pub(crate) struct RaySpan<N> {
    pub(crate) middle: [N; 2],
    pub(crate) half: [N; 2],
    pub(crate) along_row: [N; 2],
    /// Exponent of the unit of the first two: that of the ray.
    pub(crate) ray: i32,
    /// That of the last.
    pub(crate) along: i32,
}

/// From stretch to stretch along a line.
pub(super) struct LensSpans<'a, S: Scalar> {
    distortion: &'a Distortion<S>,
    /// `None` where there is none that numbers near one hold.
    lens: Option<Lens<S::Near>>,
    nearness: Nearness<S::Near>,
    /// Where the lens has seen the last one.
    last: Option<LensPoint<S::Near>>,
}

/// The inversion of the distortion for a stretch of pixels is left with the square of its last step, times the
/// curvature of the lens: below 10⁻⁴ px for a focal length of 1000 px.
const NEAR_SQUARE: i32 = 1 << 23;

/// A recorded point and what the lens has seen there.
#[derive(Clone, Copy)]
struct LensPoint<N> {
    recorded: [N; 2],
    ideal: Mapped<N>,
    /// How far it lies from where the Jacobian of the one before would have it: the next one will, too.
    bend: [N; 2],
}

impl<N: Near> LensPoint<N> {
    /// The ideal point of another recorded one, to the first order.
    fn continued_to(&self, [u, w]: [N; 2]) -> [N; 2] {
        self.ideal.linear([u - self.recorded[0], w - self.recorded[1]])
    }
}

impl<'a, S: Scalar> LensSpans<'a, S> {
    /// Of a lens, and the largest bearings of any ideal or recorded point.
    // Not inlined, and made where it stays: what it needs leaves the stack before the first inversion comes.
    #[inline(never)]
    pub(super) fn begin(spans: &mut Option<Self>, distortion: &'a Distortion<S>, largest: [S; 2]) {
        let (is_wide, margin) = (S::Near::IS_WIDE, S::ratio(17, 16));
        let [u, w] = largest.map(|size| if is_wide { size } else { size * margin });
        let is_near = is_wide || distortion.is_near([u, w]);
        let nearness = Nearness {
            step_squared: S::Near::ratio(1, NEAR_SQUARE),
            residual: (S::EPSILON * S::from_i32(32)).near(0),
            farthest: (!is_wide).then(|| u.max(w).near(0)),
        };
        *spans = Some(Self { distortion, lens: is_near.then(|| distortion.near_lens()), nearness, last: None });
    }

    /// About a recorded point, so far to either side; `None` where the model of the lens folds over. The inversion
    /// starts from the last one.
    ///
    /// *Cost*: mostly one step of the inversion and a short one for each end.
    pub(super) fn span(&mut self, stretch: &[[S; 2]; 2], per_fx: S) -> Option<RaySpan<S::Near>> {
        match self.nearby(stretch, per_fx) {
            // The last one is forgotten: from nowhere.
            None if S::Near::IS_WIDE => self.nearby(stretch, per_fx),
            None => self.far_off(stretch, per_fx),
            span => span,
        }
    }

    /// From the last one; `None` where that leads nowhere.
    // Not inlined, as the other way: what each of them needs leaves the stack before the other one comes.
    #[inline(never)]
    fn nearby(&mut self, stretch: &[[S; 2]; 2], per_fx: S) -> Option<RaySpan<S::Near>> {
        let (lens, nearness) = (self.lens.as_ref()?, &self.nearness);
        let [recorded, half] = stretch.map(|pair| pair.map(|part| part.near(0)));
        let none = [S::Near::ZERO; 2];
        let (linear, bend) = self.last.map_or((recorded, none), |last| (last.continued_to(recorded), last.bend));
        self.last = None;
        let ideal = lens.undistort_from(recorded, [linear[0] + bend[0], linear[1] + bend[1]], nearness)?;
        let bend = [ideal.point[0] - linear[0], ideal.point[1] - linear[1]];
        let [u, w] = ideal.point;
        let (middle, half) = if half == none {
            (ideal.point, half)
        } else {
            let half = ideal.step(half);
            if nearness.excludes([u.abs() + half[0].abs(), w.abs() + half[1].abs()]) {
                return None;
            }
            (lens.mean_of_ends(&ideal, recorded, half), half)
        };
        self.last = Some(LensPoint { recorded, ideal, bend });
        let [[du, _], [dw, _]] = ideal.jacobian;
        // Below 5/2: the product is below one.
        let along = per_fx.size() + 2;
        let along_row = [du, dw].map(|part| part.times(per_fx.near(along)));
        let is_below_one = S::Near::IS_WIDE || middle.into_iter().all(|part| part.abs() < S::Near::ratio(1, 1));
        let ray = i32::from(!is_below_one);
        let [middle, half] = [middle, half].map(|pair| pair.map(|part| part.over_power_of_two(ray)));
        Some(RaySpan { middle, half, along_row, ray, along })
    }

    /// In numbers of any size, from nowhere.
    #[inline(never)]
    fn far_off(&self, stretch: &[[S; 2]; 2], per_fx: S) -> Option<RaySpan<S::Near>> {
        let [recorded, half] = *stretch;
        let ideal = self.distortion.undistort(recorded)?;
        Some(self.far_span(&ideal, recorded, half, per_fx))
    }

    #[inline(never)]
    fn far_span(&self, ideal: &Mapped<Whole<S>>, recorded: [S; 2], half: [S; 2], per_fx: S) -> RaySpan<S::Near> {
        let half = ideal.step(half.map(Whole));
        let middle = self.distortion.lens().mean_of_ends(ideal, recorded.map(Whole), half);
        let [[du, _], [dw, _]] = ideal.jacobian;
        let [middle, half, along_row] = [middle, half, [du, dw]].map(|pair| pair.map(|Whole(part)| part));
        RaySpan::of_whole(middle, half, along_row.map(|part| part * per_fx))
    }
}

impl<N: Near> RaySpan<N> {
    pub(super) fn of_whole<S: Scalar<Near = N>>(middle: [S; 2], half: [S; 2], along_row: [S; 2]) -> Self {
        // What is below one.
        let (ray, along) = (size_of_all(middle).max(0), size_of_all(along_row));
        let [middle, half] = [middle, half].map(|pair| pair.map(|part| part.near(ray)));
        Self { middle, half, along_row: along_row.map(|part| part.near(along)), ray, along }
    }
}
