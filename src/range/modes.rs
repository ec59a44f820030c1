//! [`Modes`]: the shapes of residuals along an edge, from slow to fast. docs/model.md, section 7.6.

use heapless::Vec;

use crate::scalar::{Scalar, over, product_over_32_bits as product};

/// Polynomials of the row, orthogonal over the samples with their weights: a constant, a slope, a bow, and so on, one
/// after the other. Each has one value for each sample, in units of its sigma and of the mode's own.
///
/// In integers: what tells chance from a wander needs no more, and cores without floating point take a third of the
/// time.
///
/// *Source*: the three-term recurrence of discrete orthogonal polynomials (Forsythe 1957), each one doubled: that
/// keeps their size.
pub(super) struct Modes<S, const N: usize> {
    /// Along the edge, −1 to 1 from the first sample to the last, in 1/2²⁸.
    places: Vec<i32, N>,
    /// The values of the current mode and of the one before, in 1/2²⁸.
    values: Vec<[i32; 2], N>,
    /// One over the sum of the squares of the current mode's values, which is below 8, in 2²⁷.
    per_sum: S,
    /// Mean place of the current mode, weighted with its squares, and its sum of squares over that of the mode before,
    /// which is at most 4, in 1/2²⁸.
    recurrence: [i32; 2],
}

/// One in 1/2²⁸.
const ONE: i32 = 1 << 28;

impl<S: Scalar, const N: usize> Modes<S, N> {
    /// Of the largest value of the constant. Whatever the weights, the squares of a doubled mode come to less than four
    /// times those of N such values (Chebyshev's polynomials do), which is less than 8.
    const LARGEST: i32 = ONE >> (N | 1).ilog2().div_ceil(2);

    /// The constant, from the place of each sample and the reciprocal of its sigma, in the order of readout. The first
    /// and the last place differ.
    pub(super) fn new(samples: impl Iterator<Item = (S, S)> + Clone) -> Self {
        let (none, mut values, mut places) = (S::ZERO, Vec::new(), Vec::new());
        let (mut first, mut last, mut most) = (None, none, none);
        for (place, per_sigma) in samples.clone() {
            (first, last, most) = (first.or(Some(place)), place, most.max(per_sigma));
        }
        let first = first.unwrap_or(none);
        let (middle, per_half) = ((first + last).half(), S::from_i32(ONE) / (last - first).half());
        let per_most = S::from_i32(Self::LARGEST) * over(most);
        for (place, per_sigma) in samples {
            let (place, value) = ((place - middle) * per_half, per_sigma * per_most);
            // There is room: as many as observations of a line.
            let _ = (places.push(place.to_i32()), values.push([value.to_i32(), 0]));
        }
        let mut modes = Self { places, values, per_sum: none, recurrence: [0; 2] };
        modes.measure();
        modes
    }

    /// The values of the current mode, in 1/2²⁸.
    pub(super) fn values(&self) -> impl Iterator<Item = S> + Clone {
        self.values.iter().map(|[value, _]| S::from_i32(*value))
    }

    /// One over the sum of their squares; zero where there are no more modes than samples at different places.
    pub(super) fn per_square(&self) -> S {
        self.per_sum * S::ratio(1, 2 * ONE)
    }

    /// What of the squares of the samples' deviations, each in 1/2²⁰ sigma, the current mode explains.
    pub(super) fn power(&self, deviations_q20: impl Iterator<Item = i32>) -> S {
        let parts = self.values.iter().zip(deviations_q20).map(|([value, _], deviation)| product(*value, deviation));
        let along_q16 = S::from_i32(parts.fold(0, i32::wrapping_add));
        along_q16 * along_q16 * self.per_sum * S::ratio(1, 32)
    }

    /// Goes on to the next mode.
    pub(super) fn advance(&mut self) {
        let [mean, growth] = self.recurrence;
        for ([value, before], place) in self.values.iter_mut().zip(&self.places) {
            let doubled = product(*value, place.wrapping_sub(mean)).wrapping_mul(2);
            (*value, *before) = (doubled.wrapping_sub(product(*before, growth)) << 4, *value);
        }
        self.measure();
    }

    fn measure(&mut self) {
        let (mut sum, mut moment) = (0_i32, 0_i32);
        for ([value, _], place) in self.values.iter().zip(&self.places) {
            let square = product(*value, *value) << 3;
            (sum, moment) = (sum.wrapping_add(square), moment.wrapping_add(product(square, *place)));
        }
        let (per_sum_before, one, whole) = (self.per_sum, S::from_i32(ONE), S::from_i32(sum));
        self.per_sum = over(whole);
        let (mean, growth) = (S::from_i32(moment) * self.per_sum, whole * per_sum_before);
        let [mean_q24, growth_q28] = [mean * one, growth * one].map(S::to_i32);
        self.recurrence = [mean_q24 << 4, growth_q28];
    }
}
