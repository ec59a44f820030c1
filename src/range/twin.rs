//! Twins: in forward motion an edge may look like another one that leans. docs/model.md, section 3.

use super::equation::Equation;
use super::prior::Knowledge;
use super::problem::{Problem, Solved};
use super::tuning::{CURVE_PART, FARTHEST_TURN, LEAST_BARRIER, TWIN_COST};
use super::unknowns::Unknowns;
use crate::error::FitError;
use crate::scalar::Scalar;

impl<S: Scalar, K: Knowledge<S>, const N: usize> Problem<'_, S, K, N> {
    /// In forward motion tilt and depth differ in the second order alone, which is a parabola of the inverse depth: a
    /// twin as far beyond its turning point fits as well, but for its prior. The better of two in front of the camera is
    /// meant.
    ///
    /// Returns the change of bearing, inverse depth and tilt halfway to a twin that cannot be told from it, or to what
    /// lies between them where that fits nearly as well: it belongs into sigma.
    #[inline(never)]
    pub(super) fn tell_from_twin(&mut self) -> Result<Option<[S; 3]>, FitError> {
        if self.prior.state().is_some() || self.last.found.tilt == S::ZERO {
            return Ok(None);
        }
        let Some((turn, sigma_per_m)) = self.turning_point() else { return Ok(None) };
        let Solved { at, found, solution, has_settled, .. } = self.last;
        let halfway = solution.change_with(turn);
        let (turning_point, twin) = (found.moved(halfway), found.moved(halfway).moved(halfway));
        // The parabola rises by half as many sigmas as the turning point is away.
        if turn.abs() < sigma_per_m * S::from_i32(2 * LEAST_BARRIER) {
            let is_in_front = turning_point.inverse_depth.max(twin.inverse_depth) > S::ZERO;
            return Ok(is_in_front.then_some(halfway));
        }
        let own_cost = self.cost();
        let is_twin = self.settles_in_front(&twin);
        let twin_cost = self.cost();
        if !(is_twin && twin_cost < own_cost) {
            self.repeat(&at, has_settled)?;
        }
        let is_alike = is_twin && (twin_cost - own_cost).abs() < S::from_i32(TWIN_COST);
        Ok(is_alike.then_some(halfway))
    }

    /// The change of the inverse depth, from where the last round has found it, to the turning point of that parabola,
    /// where it is the curve of the line that tells the depth; and a sigma of it.
    fn turning_point(&self) -> Option<(S, S)> {
        let is_inlier =
            |index: &usize| self.observations.get(*index).is_some_and(|observation| observation.normals.is_inlier);
        let count = self.observations.len();
        let places =
            [(0..count).find(is_inlier)?, (count / 2..count).find(is_inlier)?, (0..count).rev().find(is_inlier)?];
        let height = curve(self.equations_of(places))?;
        // The values of a parabola differ from a straight line by a variance of 4/45 of its height.
        let variance = height * height * S::ratio(4, 45);
        let of_curve = variance * S::from_i32(count as i32);
        let Solved { found, solution, .. } = &self.last;
        let variance_per_m2 = solution.variance_of_inverse_depth();
        if !(of_curve * variance_per_m2 > S::ratio(CURVE_PART.0, CURVE_PART.1)) {
            return None;
        }
        let sigma_per_m = variance_per_m2.sqrt();
        let farther = found.moved(solution.change_with(sigma_per_m));
        let change = curve(places.map(|index| self.equation_at(&farther, index)))? - height;
        (change.abs() * S::from_i32(FARTHEST_TURN) > height.abs())
            .then(|| (-(height / change) * sigma_per_m, sigma_per_m))
    }

    fn settles_in_front(&mut self, start: &Unknowns<S>) -> bool {
        start.inverse_depth > S::ZERO && self.converge(start) && self.last.is_in_front
    }
}

/// How far, in sigmas, what the inverse depth does to a sample in the middle departs from what a tilt could explain,
/// given those at both ends.
fn curve<S: Scalar>(equations: [Option<Equation<S>>; 3]) -> Option<S> {
    let per_one = |equation: Equation<S>| {
        let per_one = equation.one.reciprocal();
        (equation.q * per_one, equation.w * per_one)
    };
    let [first, middle, last] = equations;
    let ((first_q, first_w), (q, w), (last_q, last_w)) = (per_one(first?), per_one(middle?), per_one(last?));
    let share = (w - first_w) / (last_w - first_w);
    Some((q - first_q - (last_q - first_q) * share) * middle?.one)
}
