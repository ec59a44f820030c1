//! [`GoodnessOfFit`]: the residuals of a line against the stated noise. docs/model.md, section 7.

use crate::scalar::Scalar;

/// How well a straight line fits, and by how much the stated noise falls short of what the residuals show.
pub(crate) struct GoodnessOfFit<S> {
    /// Root mean square of the residuals in units of the stated noise.
    pub(crate) misfit: S,
    /// Factor on the stated noise with which slope and bearing get the sigma that the residuals call for; one where the
    /// residuals are as white noise of the stated size has them.
    pub(crate) inflation: S,
    /// Largest residual in pixels.
    pub(crate) departure_px: S,
}

/// Sums over the residuals of neighbouring knots.
struct Sums<S> {
    count: i32,
    squares: S,
    /// Products of neighbours.
    products: S,
    largest_px: S,
    previous: S,
}

/// Larger deviations leave fixed point no room for their squares.
const MOST_SIGMAS: i32 = 1_000;

/// Two degrees of freedom are spent on bearing and inverse depth.
const SPENT: i32 = 2;

/// Fewer knots than this do not tell a correlation.
const FEW_KNOTS: i32 = 6;

/// Largest lag-one correlation, in percent: it enlarges the variance ninefold. A higher one is a bow, which fits no better
/// with a larger factor.
const MOST_CORRELATION_PERCENT: i32 = 80;

impl<S: Scalar> GoodnessOfFit<S> {
    /// Without residuals.
    pub(crate) const NONE: Self = Self { misfit: S::ZERO, inflation: S::ONE, departure_px: S::ZERO };

    /// From the residuals in the order of readout, each in units of its noise and in pixels.
    ///
    /// Residuals that are larger than chance allows scale the noise. Where neighbours are alike, with a lag-one correlation
    /// r, the variance of a slope through them is (1 + r)/(1 − r) times that of independent ones.
    pub(crate) fn of(residuals: impl Iterator<Item = (S, S)>) -> Self {
        let sums = Sums::of(residuals);
        if sums.count <= SPENT {
            return Self::NONE;
        }
        let spare = S::from_i32(sums.count - SPENT);
        let variance = sums.squares / spare;
        let is_large = variance > chance_limit(spare, S::from_i32(CHANCE_SIGMAS));
        let correlation = sums.correlation(is_large);
        let enlarged = variance * (S::ONE + correlation) / (S::ONE - correlation);
        let is_enlarged = is_large || correlation > S::ZERO;
        Self {
            misfit: variance.sqrt(),
            inflation: if is_enlarged { enlarged.max(S::ONE).sqrt() } else { S::ONE },
            departure_px: sums.largest_px,
        }
    }
}

impl<S: Scalar> Sums<S> {
    fn of(residuals: impl Iterator<Item = (S, S)>) -> Self {
        let none = S::ZERO;
        let mut sums = Self { count: 0, squares: none, products: none, largest_px: none, previous: none };
        let cap = S::from_i32(MOST_SIGMAS);
        for (residual, residual_px) in residuals {
            let residual = residual.min(cap).max(-cap);
            sums.squares = sums.squares + residual * residual;
            sums.products = sums.products + residual * sums.previous;
            sums.largest_px = sums.largest_px.max(residual_px.abs());
            sums.previous = residual;
            sums.count += 1;
        }
        sums
    }

    /// The lag-one correlation that enlarges sigma. White noise shows some, too, within ±1/√n, one sigma; where the
    /// residuals are no larger than stated, it counts beyond two of these.
    fn correlation(&self, is_large: bool) -> S {
        if self.count < FEW_KNOTS || !(self.squares > S::ZERO) {
            return S::ZERO;
        }
        let n = S::from_i32(self.count);
        let raw = self.products / self.squares;
        // Bearing, depth and tilt are fitted to the residuals: the correlation of what is left is low by this.
        let correlation = raw + (S::ONE + S::from_i32(4) * raw) / n;
        let chance = S::from_i32(2) / n.sqrt();
        if !(is_large || correlation > chance) {
            return S::ZERO;
        }
        correlation.max(S::ZERO).min(S::ratio(MOST_CORRELATION_PERCENT, 100))
    }
}

/// Four sigma: once in 30000 lines.
const CHANCE_SIGMAS: i32 = 4;

/// What the mean square of `count` unit variates exceeds as seldom as a normal variate so many sigmas (Wilson and Hilferty).
pub(crate) fn chance_limit<S: Scalar>(count: S, sigmas: S) -> S {
    let part = S::ratio(2, 9) / count;
    let root = S::ONE - part + sigmas * part.sqrt();
    root * root * root
}
