//! [`Problem`]: the least squares of one edge, linearised again and again about the last estimate until it settles.

use heapless::Vec;

use super::equation::{Equation, EquationUnits, Equations};
use super::least_squares::{Solution, solve};
use super::observation::Observation;
use super::prior::Knowledge;
use super::tuning::{
    FULL_ROUNDS, MIRROR_COST, MIRROR_REACH, MOST_ROUNDS, MOST_SCATTER, NEARBY_PART, RIVAL_COST, SAME_SIGMA_PART,
    SETTLED_PART,
};
use super::unknowns::{NearUnknowns, Unknowns};
use crate::error::FitError;
use crate::scalar::{Arithmetic, Near, Scalar, over};
use crate::setup::Setup;

/// What is to be fitted, and the last round: its equations and what they have told.
pub(super) struct Problem<'a, S: Scalar, K, const N: usize> {
    pub(super) setup: &'a Setup<S>,
    pub(super) prior: &'a K,
    /// Down, in the axes of frame start.
    gravity: [S; 3],
    pub(super) observations: Vec<Observation<S>, N>,
    pub(super) equations: Equations<S, N>,
    pub(super) last: Solved<S>,
    /// What the blur tells about the place that was asked for last: mostly it is asked for there again.
    blur: Option<(Unknowns<S>, BlurEquation<S>)>,
}

/// The equation of the blur, and what a pixel of the lens's own blur takes from its y.
type BlurEquation<S> = (Equation<S>, S);

/// The outcome of a round.
#[derive(Clone, Copy)]
pub(super) struct Solved<S> {
    /// What it was linearised about.
    pub(super) at: Unknowns<S>,
    pub(super) found: Unknowns<S>,
    pub(super) solution: Solution<S>,
    /// Whether the camera has the line before it in all rows.
    pub(super) is_in_front: bool,
    /// Whether the rounds have come to rest there, to a sigma.
    pub(super) has_settled: bool,
}

impl<S: Scalar> Solved<S> {
    /// Of no round.
    pub(super) const NOTHING: Self = Self {
        at: Unknowns::NOTHING,
        found: Unknowns::NOTHING,
        solution: Solution::NOTHING,
        is_in_front: false,
        has_settled: false,
    };

    /// Half of the way that this round has gone.
    fn halfway(&self) -> Unknowns<S> {
        self.at.moved(self.solution.change().map(|change| change * S::ratio(1, 2)))
    }
}

/// Where rounds may start: near the better path, and where another place may fit better.
struct Candidates<S> {
    better: Unknowns<S>,
    rivals: [Option<Unknowns<S>>; 2],
}

#[derive(Clone, Copy, PartialEq)]
enum Round {
    /// Nothing is known yet: the equations are those of the noisy observations themselves, without the blur.
    First,
    /// They are moved from the observed columns to the predicted ones.
    Later,
}

/// The equation of an observation, or `None` where its row runs along upright edges; and whether it shows the line in
/// front of the camera.
fn observe<S: Scalar>(
    observation: &Observation<S>,
    at: &NearUnknowns<S::Near>,
    round: Round,
) -> Option<(Equation<S::Near>, EquationUnits, bool)> {
    let normals = &observation.normals;
    let residual = match round {
        Round::First => normals.residual_of_nothing(),
        Round::Later => at.residual(normals),
    };
    let none = S::Near::ZERO;
    if residual.runs_along() {
        return None;
    }
    if !observation.normals.is_inlier || residual.per_px == none {
        return Some((Equation::NEAR_NOTHING, EquationUnits::SMALLEST, residual.is_in_front()));
    }
    // A pixel along the row in units of the noise.
    let px_per_miss = residual.per_px().reciprocal();
    let per_miss = observation.per_sigma() * px_per_miss;
    // So small that no sum of products leaves the range.
    let scale = per_miss.size() + 1;
    let near_per_miss = per_miss.near(scale);
    let (miss, finer) = residual.miss.magnified();
    let y = -miss.times(near_per_miss);
    let units = EquationUnits { scale, finer, reach: normals.units.reach() };
    let [mut one, mut q] = [residual.per_bearing, residual.per_inverse_depth];
    let [one_per_px, q_per_px] = residual.change_along_row;
    if residual.change_along_row != [none; 2] {
        let off = (S::of_near(miss, -finer) * px_per_miss).near(-normals.units.per_px());
        (one, q) = (one.minus_product(one_per_px, off), q.minus_product(q_per_px, off));
    }
    let [one, q, w] = [one, q, residual.per_tilt].map(|part| part.times(near_per_miss));
    Some((Equation { one, q, w, y }, units, residual.is_in_front()))
}

/// That of all.
fn reach_of<S: Scalar>(observations: &[Observation<S>]) -> i32 {
    observations.first().map_or(0, |observation| observation.normals.units.reach())
}

impl<'a, S: Scalar, K: Knowledge<S>, const N: usize> Problem<'a, S, K, N> {
    /// Without observations.
    // Not inlined: what it is made of would stay on the stack beside it.
    #[inline(never)]
    pub(super) fn new(setup: &'a Setup<S>, gravity: [S; 3], prior: &'a K) -> Self {
        let (observations, equations) = (Vec::new(), Equations::new());
        Self { setup, prior, gravity, observations, equations, last: Solved::NOTHING, blur: None }
    }
}

impl<S: Scalar, K: Knowledge<S>, const N: usize> Problem<'_, S, K, N> {
    #[inline(never)]
    fn round(&mut self, at: &Unknowns<S>, round: Round) -> Result<(), FitError> {
        let equations = &mut self.equations;
        let reach = reach_of(&self.observations);
        let near = at.near(reach);
        equations.clear(reach);
        let mut is_in_front = true;
        for (index, observation) in self.observations.iter().enumerate() {
            let (equation, units, in_front) = observe(observation, &near, round).ok_or(FitError::Sideways(index))?;
            is_in_front &= in_front;
            equations.push_observed(equation, units);
        }
        self.prior.equations(self.setup, self.gravity, at, |equation| equations.push_prior(equation));
        // Far from the solution the blur leads astray.
        if round == Round::Later
            && let Some((equation, per_lens_px)) = self.blur_equation(at)
        {
            self.equations.push_prior(equation);
            self.equations.per_lens_px = per_lens_px;
        }
        // In place: a copy would take room.
        let last = &mut self.last;
        last.solution = solve(&mut self.equations, &Solution::NOTHING);
        (last.at, last.found) = (*at, at.moved(last.solution.change()));
        last.is_in_front = is_in_front && last.found.inverse_depth > S::ZERO;
        last.has_settled = true;
        Ok(())
    }

    /// The equation of the blur, linearised about `at`; `None` where nothing is known of it.
    fn blur_equation(&mut self, at: &Unknowns<S>) -> Option<BlurEquation<S>> {
        let blur = self.prior.blur()?;
        if let Some((about, equation)) = &self.blur
            && about == at
        {
            return Some(*equation);
        }
        let equation = blur.equation(at)?;
        self.blur = Some((*at, equation));
        Some(equation)
    }

    /// The first round, from nothing: the positions and the prior of the tilt alone.
    pub(super) fn first_round(&mut self) -> Result<(), FitError> {
        self.round(&Unknowns::NOTHING, Round::First)
    }

    /// A round once more: its equations are needed, and others have been made since.
    pub(super) fn repeat(&mut self, at: &Unknowns<S>, has_settled: bool) -> Result<(), FitError> {
        self.round(at, Round::Later)?;
        self.last.has_settled = has_settled;
        Ok(())
    }

    /// Iterates until another round would change next to nothing: mostly one is enough. Rounds that go to and fro
    /// between two places meet halfway. Whether they converge.
    pub(super) fn converge(&mut self, start: &Unknowns<S>) -> bool {
        let nearby = S::ratio(1, NEARBY_PART * NEARBY_PART);
        let mut next = *start;
        let mut before = S::ZERO;
        for round in 1..=MOST_ROUNDS {
            if self.round(&next, Round::Later).is_err() {
                return false;
            }
            let step = self.last.solution.step_squared();
            // These are squares. Rounds that converge do so much faster: what is left is rounding.
            if round > 1 && step < nearby && step > before.half() || round < MOST_ROUNDS && self.has_settled(step) {
                return true;
            }
            (before, next) = (step, if round < FULL_ROUNDS { self.last.found } else { self.last.halfway() });
        }
        false
    }

    /// Whether another round would change next to nothing: this one has not moved the estimate far, and neither the
    /// samples at both ends nor the blur have departed on the way from what their equations foretell. What scatters
    /// more than stated is known less well.
    fn has_settled(&mut self, step_squared: S) -> bool {
        let settled = S::ratio(1, SETTLED_PART * SETTLED_PART);
        if step_squared < settled {
            return true;
        }
        if step_squared < S::ONE && self.blur_moves() < settled && self.is_linear(settled) {
            return true;
        }
        // A straight edge does not scatter by as much as this.
        if !(step_squared < S::from_i32(MOST_SCATTER * MOST_SCATTER)) {
            return false;
        }
        // With more scatter than stated each of these limits is wider, and no other number is another one.
        let scatter = self.scatter();
        if !(scatter > S::ONE) {
            return false;
        }
        let settled = settled * scatter;
        step_squared < settled || step_squared < scatter && self.blur_moves() < settled && self.is_linear(settled)
    }

    /// Whether equations of the samples at both ends, linearised anew, would be the same: as if all others had changed
    /// by as much, what they tell by less than the square root of `settled` sigmas, and each sigma by less than a
    /// thousandth.
    fn is_linear(&self, settled: S) -> bool {
        let Solved { found, solution, .. } = &self.last;
        let [per_q, per_w] = [over(solution.information_of_inverse_depth()), solution.variance_of_tilt()];
        let count = S::from_i32(self.observations.len() as i32);
        let (mut of_y, mut of_sigmas) = (S::ZERO, S::ZERO);
        let units = self.equations.units;
        let (near, near_solution) = (found.near(units.reach), solution.near(units));
        let mut pairs =
            self.observations.iter().zip(&self.equations.observed).filter(|(seen, _)| seen.normals.is_inlier);
        for (observation, old) in [pairs.next(), pairs.next_back()].into_iter().flatten() {
            let Some((new, new_units, _)) = observe(observation, &near, Round::Later) else { return false };
            let new = new.whole::<S>(new_units);
            let [q, w] = near_solution.unsolved(old);
            let old = Equation { q, w, ..*old }.whole::<S>(units);
            let (of_q, of_w, off) = (new.q - old.q, new.w - old.w, new.y - old.y);
            of_sigmas = of_sigmas + of_q * of_q * per_q + of_w * of_w * per_w;
            of_y = of_y + off * off;
            // Squares: the other end takes nothing away.
            if !(of_y * count < settled && of_sigmas * count < S::ratio(1, SAME_SIGMA_PART * SAME_SIGMA_PART)) {
                return false;
            }
        }
        true
    }

    /// Equations of samples as they were before they were solved, but for y.
    pub(super) fn equations_of<const M: usize>(&self, samples: [usize; M]) -> [Option<Equation<S>>; M] {
        let units = self.equations.units;
        let near = self.last.solution.near(units);
        samples.map(|index| {
            let equation = self.equations.observed.get(index)?;
            let [q, w] = near.unsolved(equation);
            Some(Equation { q, w, ..*equation }.whole(units))
        })
    }

    /// The equation of a sample linearised about another place.
    pub(super) fn equation_at(&self, at: &Unknowns<S>, index: usize) -> Option<Equation<S>> {
        let observation = self.observations.get(index)?;
        let near = at.near(observation.normals.units.reach());
        let (equation, units, _) = observe(observation, &near, Round::Later)?;
        Some(equation.whole(units))
    }

    /// Mean square of all deviations.
    pub(super) fn scatter(&self) -> S {
        self.cost() / S::from_i32(self.observations.len().max(1) as i32)
    }

    /// Sum of the squares of all deviations.
    pub(super) fn cost(&self) -> S {
        self.equations.cost()
    }

    /// The square of how far the blur, linearised anew, would move the inverse depth, in sigmas: by the change of its
    /// part in the gradient.
    fn blur_moves(&mut self) -> S {
        let (true, Some(old)) = (self.prior.blur().is_some(), self.equations.prior.last()) else { return S::ZERO };
        let Solved { found, solution, .. } = self.last;
        let before = solution.unsolved_q(old) * old.y;
        let Some((new, _)) = self.blur_equation(&found) else { return S::ONE };
        let change = new.q * new.y - before;
        change * change * over(solution.information_of_inverse_depth())
    }

    /// Rounds from a start until they converge. What does not is no straight edge.
    pub(super) fn settle(&mut self, start: &Unknowns<S>) -> Result<(), FitError> {
        if self.converge(start) { Ok(()) } else { self.tell_roughly(start) }
    }

    /// One round, which tells roughly where something is.
    pub(super) fn tell_roughly(&mut self, start: &Unknowns<S>) -> Result<(), FitError> {
        self.round(start, Round::Later)?;
        // This round may have moved it far; rounding alone moves it by parts of a sigma.
        self.last.has_settled = self.last.solution.step_squared() < S::ONE;
        self.last.is_in_front = self.is_in_front(&self.last.found);
        Ok(())
    }

    /// Solves the equations of the last round once more, whose sigmas have changed since, and goes on from there only
    /// if that moves the estimate.
    #[inline(never)]
    pub(super) fn settle_again(&mut self) -> Result<(), FitError> {
        let last = &mut self.last;
        last.solution = solve(&mut self.equations, &last.solution);
        last.found = last.at.moved(last.solution.change());
        if !(last.solution.step_squared() < S::ratio(1, NEARBY_PART * NEARBY_PART)) {
            let found = last.found;
            return self.settle(&found);
        }
        last.is_in_front &= last.found.inverse_depth > S::ZERO;
        last.has_settled = true;
        Ok(())
    }

    fn is_in_front(&self, unknowns: &Unknowns<S>) -> bool {
        let near = unknowns.near(reach_of(&self.observations));
        let has_in_front = |observation: &Observation<S>| near.residual(&observation.normals).is_in_front();
        unknowns.inverse_depth > S::ZERO && self.observations.iter().all(has_in_front)
    }

    /// In forward motion tilt and depth differ by a curve that is quadratic in the inverse depth, so that one as far
    /// behind the camera may fit as well: the one in front is meant, unless it fits worse by three sigma.
    pub(super) fn settle_in_front(&mut self, start: &Unknowns<S>) -> Result<(), FitError> {
        self.settle(start)?;
        let Solved { at, found, has_settled, .. } = self.last;
        if found.tilt == S::ZERO || !(found.inverse_depth < S::ZERO) {
            return Ok(());
        }
        let least = self.cost() + S::from_i32(MIRROR_COST);
        let mirrored = Unknowns { inverse_depth: -found.inverse_depth, ..found };
        // An error in this trial says nothing of the solution at hand.
        if self.settle(&mirrored).is_ok() && self.is_mirror_image(&mirrored) && self.is_found_in_front(least) {
            return Ok(());
        }
        self.repeat(&at, has_settled)
    }

    fn is_mirror_image(&self, mirrored: &Unknowns<S>) -> bool {
        let farthest = mirrored.inverse_depth * S::from_i32(MIRROR_REACH);
        self.last.has_settled && self.last.found.inverse_depth < farthest
    }

    /// Whether something is known of a solution, in front of the camera, that costs less.
    fn is_found_in_front(&self, least: S) -> bool {
        let [_, sigma_per_m, _] = self.last.solution.covariance().sigma();
        self.last.is_in_front && sigma_per_m < S::UNKNOWN && self.cost() < least
    }

    /// With blur and tilt there are several minima: the sign of the path during the exposure does not show in its blur.
    /// The best of those near either path is meant; where neither agrees with the positions, also of the one near these
    /// alone.
    pub(super) fn settle_best(&mut self) -> Result<(), FitError> {
        // The rounds of one start leave the stack before those of the next.
        let (start, rival) = self.starts();
        self.settle_in_front(&start)?;
        match rival.filter(|(_, cost)| *cost < self.cost()) {
            Some((at, _)) => self.repeat(&at, true),
            None => Ok(()),
        }
    }

    /// Where to start from: mostly the better path wins, and its equations are to be the last; and the last round of
    /// the best of those near the others, with its cost.
    #[inline(never)]
    fn starts(&mut self) -> (Unknowns<S>, Option<(Unknowns<S>, S)>) {
        let Some(Candidates { better, rivals }) = self.candidates() else { return (self.last.found, None) };
        let mut best: Option<(Unknowns<S>, S)> = None;
        for rival in rivals.iter().flatten() {
            if self.converge(rival) && self.last.is_in_front {
                let cost = self.cost();
                best = best.filter(|(_, least)| *least <= cost).or(Some((self.last.at, cost)));
            }
        }
        (better, best)
    }

    /// The place near the better path, and those that may win over it; `None` where no path tells.
    #[inline(never)]
    fn candidates(&self) -> Option<Candidates<S>> {
        let Solved { found: start, solution: first, .. } = &self.last;
        let information = first.information_of_inverse_depth();
        let [better, other] = self.prior.blur()?.either_path(start, information)?;
        let near = |change_per_m| start.moved(first.change_with(change_per_m));
        let rival_cost = S::from_i32(RIVAL_COST);
        // Where the blur is that of a path next to nothing, both are the same place.
        let apart = other.change_per_m - better.change_per_m;
        let is_apart = apart * apart * information > S::ratio(1, NEARBY_PART * NEARBY_PART);
        let is_rival = is_apart && other.cost < better.cost + rival_cost;
        let rivals = [is_rival.then(|| near(other.change_per_m)), (better.cost > rival_cost).then_some(*start)];
        Some(Candidates { better: near(better.change_per_m), rivals })
    }
}
