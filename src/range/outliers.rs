//! Samples of something else within a line are found by a fit that they do not draw towards themselves, and left out.

use heapless::Vec;

use super::least_squares::{Solution, solve};
use super::prior::Knowledge;
use super::problem::{Problem, Solved};
use super::tuning::{
    FAR_SIGMAS, MOST_REJECTIONS, MOST_SCATTER, OUTLIER, REWEIGHTED_PART, REWEIGHTING_ROUNDS, SUSPICIOUS,
};
use crate::error::FitError;
use crate::scalar::Scalar;

impl<S: Scalar, K: Knowledge<S>, const N: usize> Problem<'_, S, K, N> {
    /// The first round, without the samples that are so far off that even its equations tell: with them the rounds
    /// would lead nowhere. Whether what is left may be a straight edge.
    #[inline(never)]
    pub(super) fn first_without_far_samples(&mut self) -> Result<bool, FitError> {
        self.first_round()?;
        let (part, stands_out) = self.largest_part();
        if !(part > S::from_i32(FAR_SIGMAS)) {
            return Ok(true);
        }
        if !stands_out {
            return Ok(self.may_be_straight());
        }
        // Some or none: its equations have been reweighted.
        let _ = self.reject_outliers();
        self.first_round()?;
        Ok(self.may_be_straight())
    }

    fn may_be_straight(&self) -> bool {
        self.scatter() < S::from_i32(MOST_SCATTER * MOST_SCATTER)
    }

    /// Rejects samples as long as there are outliers, and settles again without them.
    #[inline(never)]
    pub(super) fn settle_without_outliers(&mut self) -> Result<(), FitError> {
        for _ in 0..MOST_REJECTIONS {
            if !self.has_suspicious_samples() {
                break;
            }
            // Without the outliers the edge lies near where the others have it.
            let Solved { at, has_settled, .. } = self.last;
            match self.reject_outliers() {
                Some(change) => self.settle(&at.moved(change))?,
                None => return self.repeat(&at, has_settled),
            }
        }
        Ok(())
    }

    /// Whether a sample deviates so much that it may be an outlier: by more than three times the robust scale, which is
    /// to say that most samples deviate by less than a third of that.
    fn has_suspicious_samples(&self) -> bool {
        let (part, stands_out) = self.largest_part();
        part > least_scale() && stands_out
    }

    /// A third of the largest deviation, and whether that is beyond the robust scale.
    #[inline(never)]
    fn largest_part(&self) -> (S, bool) {
        let sizes = self.deviations(&[]);
        let part = largest(&sizes) * S::ratio(1, SUSPICIOUS);
        (part, is_beyond_robust_scale(part, &sizes))
    }

    /// Absolute deviations of the inliers, in units of their own noise, which each equation may have been scaled by.
    fn deviations(&self, scales: &[S]) -> Vec<S, N> {
        let mut sizes = Vec::new();
        for (index, (equation, observation)) in self.equations.observed.iter().zip(&self.observations).enumerate() {
            if observation.normals.is_inlier {
                let size = equation.deviation::<S>(self.equations.units).abs();
                // There is room: as many as observations.
                let _ = sizes.push(scales.get(index).map_or(size, |scale| size * *scale));
            }
        }
        sizes
    }

    /// Rejects the samples that deviate much more than the others, such as those of an object in between; at most a
    /// third of them: if more do not fit, this is no straight edge. Leaves the equations reweighted; what they come to,
    /// or `None` where none is rejected.
    #[inline(never)]
    fn reject_outliers(&mut self) -> Option<[S; 3]> {
        let mut scales = Vec::new();
        let solution = self.reweight(&mut scales);
        let sizes = self.deviations(&scales);
        let count = sizes.len();
        // From few samples the robust scale is not well known.
        let times = S::from_i32(OUTLIER) + S::ratio(16, count.max(1) as i32);
        let limit = robust_scale_of(&sizes) * times;
        let outliers = sizes.iter().filter(|size| **size > limit).count();
        let leave_out = outliers > 0 && 3 * (self.observations.len() - count + outliers) <= self.observations.len();
        let mut sizes = sizes.iter();
        for observation in self.observations.iter_mut().filter(|observation| observation.normals.is_inlier) {
            let is_outlier = sizes.next().is_some_and(|size| *size > limit);
            observation.normals.is_inlier = !(leave_out && is_outlier);
        }
        leave_out.then(|| solution.change())
    }

    /// Least absolute deviations of the equations as they stand, by iterative reweighting (IRLS): the solution; `scales`
    /// is by what the noise of each observation has been scaled.
    #[inline(never)]
    fn reweight(&mut self, scales: &mut Vec<S, N>) -> Solution<S> {
        let mut solution = self.last.solution;
        for _ in &self.observations {
            let _ = scales.push(S::ONE);
        }
        let least_change = S::ratio(1, REWEIGHTED_PART);
        for _ in 0..REWEIGHTING_ROUNDS {
            let mut has_settled = true;
            let units = self.equations.units;
            let kept = self.equations.observed.iter_mut().zip(scales.iter_mut()).zip(&self.observations);
            for ((equation, scale), _) in kept.filter(|(_, observation)| observation.normals.is_inlier) {
                let deviation = equation.deviation::<S>(units).abs() * *scale;
                // The root of the deviation, but of a quarter where that is smaller.
                let is_small = !(deviation > S::ratio(1, 4));
                let next = if is_small { S::ratio(1, 2) } else { deviation.min(S::from_i32(10_000)).sqrt() };
                let factor = *scale / next;
                has_settled = has_settled && (factor - S::ONE).abs() < least_change;
                *equation = equation.near_scaled(factor.factor(0));
                *scale = next;
            }
            if has_settled {
                break;
            }
            solution = solve(&mut self.equations, &solution);
        }
        solution
    }
}

fn largest<S: Scalar>(sizes: &[S]) -> S {
    sizes.iter().copied().fold(S::ZERO, S::max)
}

/// Where all deviations are tiny, none is an outlier: half a sigma.
fn least_scale<S: Scalar>() -> S {
    S::ratio(1, 2)
}

/// A robust scale of deviations: two thirds of them stay below it, as normal ones stay below one sigma. No sort is
/// needed, which could panic.
pub(crate) fn robust_scale_of<S: Scalar>(sizes: &[S]) -> S {
    let usual = sizes.iter().copied().fold(None, |usual: Option<S>, size| {
        // Only of what is larger than those before it is asked: that takes a comparison with each.
        let is_usual = !usual.is_some_and(|most| most >= size) && !is_beyond_robust_scale(size, sizes);
        if is_usual { Some(usual.map_or(size, |most| most.max(size))) } else { usual }
    });
    usual.unwrap_or(S::ONE).max(least_scale())
}

/// Whether more than two thirds of the deviations are smaller.
fn is_beyond_robust_scale<S: Scalar>(limit: S, sizes: &[S]) -> bool {
    3 * sizes.iter().filter(|size| **size < limit).count() > 2 * sizes.len()
}
