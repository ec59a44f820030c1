//! [`Row`]: one linearised observation; [`Rows`]: all of a round.

use heapless::Vec;

use super::shared_error::CAUSES;
use crate::scalar::Scalar;

/// One linearised observation `y = one δa + q δρ + w δβ` with its weight.
#[derive(Clone, Copy)]
pub(crate) struct Row<S> {
    /// 1 for a sample.
    pub(crate) one: S,
    pub(crate) q: S,
    pub(crate) w: S,
    pub(crate) y: S,
    /// One sigma of y, later that of the best row relative to it: a weight between 0 and 1, to be squared.
    pub(crate) root_weight: S,
}

impl<S: Scalar> Row<S> {
    pub(super) fn weight(&self) -> S {
        self.root_weight * self.root_weight
    }
}

/// What was believed before, as one more observation, and how an error of each cause has moved it.
#[derive(Clone, Copy)]
pub(crate) struct BelievedRow<S> {
    pub(crate) row: Row<S>,
    pub(crate) errors: [S; CAUSES],
}

/// All observations of a round.
pub(crate) struct Rows<S, const N: usize> {
    pub(crate) observed: Vec<Row<S>, N>,
    pub(crate) believed: Vec<BelievedRow<S>, MOST_BELIEFS>,
}

/// Bearing, inverse depth and tilt from earlier frames, and the blur.
pub(crate) const MOST_BELIEFS: usize = 4;

impl<S: Scalar, const N: usize> Rows<S, N> {
    pub(crate) fn new() -> Self {
        Self { observed: Vec::new(), believed: Vec::new() }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Row<S>> {
        self.observed.iter().chain(self.believed.iter().map(|believed| &believed.row))
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Row<S>> {
        self.observed.iter_mut().chain(self.believed.iter_mut().map(|believed| &mut believed.row))
    }

    pub(super) fn sum(&self, value: impl Fn(&Row<S>) -> S) -> S {
        self.iter().fold(S::ZERO, |sum, row| sum + row.weight() * value(row))
    }

    /// Turns each row's sigma into its weight relative to the best one, whose sigma is returned.
    pub(super) fn normalise_weights(&mut self) -> S {
        let best = self.iter().map(|row| row.root_weight).filter(|sigma| *sigma > S::ZERO).reduce(S::min);
        let unit = best.unwrap_or(S::EPSILON);
        for row in self.iter_mut().filter(|row| row.root_weight > S::ZERO) {
            row.root_weight = if row.root_weight > unit { unit / row.root_weight } else { S::ONE };
        }
        unit
    }

    /// Whether anything is believed of the tilt: without that it is taken to be zero, not free.
    pub(super) fn has_tilt(&self) -> bool {
        self.believed.iter().any(|believed| believed.row.w != S::ZERO)
    }
}
