//! [`Modes`]: the shapes of residuals along an edge, from slow to fast. docs/model.md, section 7.6.

use heapless::Vec;

use crate::scalar::Scalar;

/// Polynomials of the row, orthonormal over the samples with their weights: a constant, a slope, a bow, and so on. Each
/// item has one value for each sample, in units of its sigma.
///
/// *Source*: the three-term recurrence of discrete orthogonal polynomials (Forsythe 1957).
pub(super) struct Modes<S, const N: usize> {
    /// Along the edge, −1 to 1 from the first sample to the last.
    places: Vec<S, N>,
    current: Vec<S, N>,
    before: Vec<S, N>,
    /// Length of the current one before it was normalised.
    length: S,
}

impl<S: Scalar, const N: usize> Modes<S, N> {
    /// From the place and sigma of each sample, in the order of readout. The first and the last place differ.
    pub(super) fn new(samples: impl Iterator<Item = (S, S)>) -> Self {
        let (mut places, mut sigmas): (Vec<S, N>, Vec<S, N>) = (Vec::new(), Vec::new());
        for (place, sigma) in samples {
            // There is room: as many as observations of a line.
            let _ = (places.push(place), sigmas.push(sigma));
        }
        let (first, last) = (places.first().copied(), places.last().copied());
        let [first, last] = [first, last].map(|place| place.unwrap_or(S::ZERO));
        let (middle, half) = ((first + last) * S::ratio(1, 2), (last - first) * S::ratio(1, 2));
        places.iter_mut().for_each(|place| *place = (*place - middle) / half);
        // Relative to the smallest sigma, so that fixed point has room.
        let least = sigmas.iter().copied().reduce(S::min).unwrap_or(S::ONE);
        sigmas.iter_mut().for_each(|sigma| *sigma = least / *sigma);
        let mut modes = Self { places, current: sigmas, before: Vec::new(), length: S::ZERO };
        modes.normalise();
        modes
    }

    fn normalise(&mut self) {
        self.length = self.current.iter().fold(S::ZERO, |sum, part| sum + *part * *part).sqrt();
        self.current.iter_mut().for_each(|part| *part = *part / self.length);
    }
}

impl<S: Scalar, const N: usize> Iterator for Modes<S, N> {
    type Item = Vec<S, N>;

    fn next(&mut self) -> Option<Vec<S, N>> {
        let mode = self.current.clone();
        let mean = mode.iter().zip(&self.places).fold(S::ZERO, |sum, (part, place)| sum + *part * *part * *place);
        for (index, (part, place)) in self.current.iter_mut().zip(&self.places).enumerate() {
            let before = self.before.get(index).copied().unwrap_or(S::ZERO);
            *part = *part * (*place - mean) - before * self.length;
        }
        self.normalise();
        self.before.clone_from(&mode);
        Some(mode)
    }
}
