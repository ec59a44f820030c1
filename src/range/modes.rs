//! [`Modes`]: the shapes of residuals along an edge, from slow to fast. docs/model.md, section 7.6.

use heapless::Vec;

use crate::scalar::{Scalar, over};

/// Polynomials of the row, orthogonal over the samples with their weights: a constant, a slope, a bow, and so on, one
/// after the other. Each has one value for each sample, in units of its sigma.
///
/// *Source*: the three-term recurrence of discrete orthogonal polynomials (Forsythe 1957).
pub(super) struct Modes<S: Scalar, const N: usize> {
    /// Along the edge, −1 to 1 from the first sample to the last.
    places: Vec<S::Kept, N>,
    /// The values of the current mode and of the one before.
    values: Vec<[S; 2], N>,
    /// One over the sum of the squares of the current mode's values.
    per_square: S,
    /// Mean place of the current mode, weighted with its squares, and its sum of squares over that of the mode before.
    recurrence: [S; 2],
}

impl<S: Scalar, const N: usize> Modes<S, N> {
    /// The constant, from the place of each sample and the reciprocal of its sigma, in the order of readout. The first
    /// and the last place differ.
    pub(super) fn new(samples: impl Iterator<Item = (S, S)>) -> Self {
        let mut modes = Self { places: Vec::new(), values: Vec::new(), per_square: S::ZERO, recurrence: [S::ZERO; 2] };
        for (place, per_sigma) in samples {
            // There is room: as many as observations of a line.
            let _ = (modes.places.push(place.kept()), modes.values.push([per_sigma, S::ZERO]));
        }
        let (first, last) = (modes.places.first().copied(), modes.places.last().copied());
        let [first, last] = [first, last].map(|place| place.map_or(S::ZERO, S::of_kept));
        let (middle, per_half) = ((first + last).half(), (last - first).half().reciprocal());
        modes.places.iter_mut().for_each(|place| *place = ((S::of_kept(*place) - middle) * per_half).kept());
        modes.measure();
        modes
    }

    /// The values of the current mode.
    pub(super) fn values(&self) -> impl Iterator<Item = S> + Clone {
        self.values.iter().map(|[value, _]| *value)
    }

    /// One over the sum of their squares; zero where there are no more modes than samples at different places.
    pub(super) fn per_square(&self) -> S {
        self.per_square
    }

    /// Goes on to the next mode.
    pub(super) fn advance(&mut self) {
        let [mean, growth] = self.recurrence;
        for ([value, before], place) in self.values.iter_mut().zip(&self.places) {
            (*value, *before) = ((*value * (S::of_kept(*place) - mean)).minus_product(*before, growth), *value);
        }
        self.measure();
    }

    fn measure(&mut self) {
        let (mut sum, mut moment) = (S::ZERO, S::ZERO);
        for ([value, _], place) in self.values.iter().zip(&self.places) {
            let square = *value * *value;
            (sum, moment) = (sum + square, moment.plus_product(square, S::of_kept(*place)));
        }
        let per_square_before = self.per_square;
        self.per_square = over(sum);
        self.recurrence = [moment * self.per_square, sum * per_square_before];
    }
}
