//! [`Contour`]: how the edges of a bar depart from two straight parallel lines.

use super::checked::{FAR_M, check};
use super::random::{gaussian, hash, mix};
use crate::error::ParameterError;

/// How the two edges of a bar depart from straight parallel lines, as bark, masonry, bent rods and lamp posts do. It
/// belongs to the bar, so it is the same in every frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Contour {
    /// Each side leans outwards by this slope, downwards along the bar, −10 to 10: a post that is thicker at its foot
    /// has a positive one. The bar's `width_m` is that at the camera's y = 0.
    pub taper: f32,
    /// How far the middle of the bar stands to the right of the chord between its ends, in metres, −10⁶ to 10⁶: the
    /// sagitta of a parabola.
    pub bow_m: f32,
    /// How far each side wanders from its line, one sigma in metres, 0 to 10⁶.
    pub roughness_m: f32,
    /// Stretch of the edge over which the wander is alike, in metres, 10⁻⁴ to 10⁶: its correlation falls to a half over
    /// one and to 0.05 over two of them.
    pub roughness_length_m: f32,
    /// Picks the wander; each side has its own.
    pub seed: u32,
}

/// One of the two edges of a bar.
#[derive(Clone, Copy)]
pub(super) enum Side {
    Left,
    Right,
}

impl Side {
    pub(super) const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// −1 or 1: to the left or to the right.
    pub(super) const fn sign(self) -> f64 {
        match self {
            Self::Left => -1.0,
            Self::Right => 1.0,
        }
    }
}

impl Contour {
    /// Two straight parallel lines.
    pub const STRAIGHT: Self = Self { taper: 0.0, bow_m: 0.0, roughness_m: 0.0, roughness_length_m: 1.0, seed: 0 };

    pub(super) fn check(&self) -> Result<(), ParameterError> {
        check([
            ("taper", self.taper, [-10.0, 10.0], "-10 to 10 (slope)"),
            ("bow_m", self.bow_m, [-FAR_M, FAR_M], "-1000000 to 1000000 (m)"),
            ("roughness_m", self.roughness_m, [0.0, FAR_M], "0 to 1000000 (m)"),
            ("roughness_length_m", self.roughness_length_m, [1e-4, FAR_M], "0.0001 to 1000000 (m)"),
        ])
    }

    /// Whether a side is a straight line.
    pub(super) fn is_straight(&self) -> bool {
        self.bow_m == 0.0 && self.roughness_m == 0.0
    }

    /// How far a side lies to the right of its line in metres, so far downwards along a bar with these ends.
    pub(super) fn offset_m(&self, side: Side, along_m: f64, [top_m, bottom_m]: [f64; 2]) -> f64 {
        let half = 0.5 * (bottom_m - top_m);
        let part = if half > 0.0 { (along_m - top_m) / half - 1.0 } else { 0.0 };
        f64::from(self.bow_m) * (1.0 - part * part) + self.wander_m(side, along_m)
    }

    /// A cubic B-spline through a Gaussian number every `roughness_length_m`, scaled so that its variance is the same
    /// between them.
    fn wander_m(&self, side: Side, along_m: f64) -> f64 {
        if self.roughness_m == 0.0 {
            return 0.0;
        }
        let key = hash(mix(u64::from(self.seed)), side as u64);
        let position = along_m / f64::from(self.roughness_length_m);
        let first = libm::floor(position);
        let weights = spline(position - first);
        let (mut sum, mut squares) = (0.0, 0.0);
        for (index, weight) in (first as i64..).zip(weights) {
            sum += weight * f64::from(gaussian(hash(key, index as u64)));
            squares += weight * weight;
        }
        f64::from(self.roughness_m) * sum / libm::sqrt(squares)
    }
}

/// Weights of the four control values around a point, which lies so far between the middle two.
fn spline(part: f64) -> [f64; 4] {
    let (p, q) = (part, 1.0 - part);
    [q * q * q, 4.0 - 3.0 * p * p * (1.0 + q), 4.0 - 3.0 * q * q * (1.0 + p), p * p * p].map(|weight| weight / 6.0)
}

#[cfg(test)]
mod tests {
    use super::{Contour, Side};

    /// Mean, deviation, and correlation over one, two and three lengths.
    #[test]
    fn wander_is_as_large_and_as_long_as_stated() {
        let contour = Contour { roughness_m: 0.002, roughness_length_m: 0.03, seed: 7, ..Contour::STRAIGHT };
        let count = 200_000_u32;
        let at = |step: u32| contour.wander_m(Side::Left, -40.0 + f64::from(step) * 0.003) / 0.002;
        let mean_of = |product: &dyn Fn(u32) -> f64| (0..count).map(product).sum::<f64>() / f64::from(count);
        let mean = mean_of(&at);
        let square = mean_of(&|step| at(step) * at(step));
        assert!(mean.abs() < 0.03 && (square - 1.0).abs() < 0.03, "mean {mean}, square {square}");
        for (lag, expected) in [(10, 0.5), (20, 0.05), (30, 0.0)] {
            let correlation = mean_of(&|step| at(step) * at(step + lag));
            assert!((correlation - expected).abs() < 0.03, "lag {lag}: {correlation}");
        }
        let other = mean_of(&|step| at(step) * contour.wander_m(Side::Right, -40.0 + f64::from(step) * 0.003) / 0.002);
        assert!(other.abs() < 0.03, "the other side: {other}");
    }

    #[test]
    fn bow_is_a_sagitta() {
        let contour = Contour { bow_m: 0.01, ..Contour::STRAIGHT };
        for (along_m, expected) in [(-0.5, 0.0), (1.5, 0.0), (0.5, 0.01), (0.0, 0.0075)] {
            let offset = contour.offset_m(Side::Left, along_m, [-0.5, 1.5]);
            assert!((offset - expected).abs() < 1e-9, "{along_m}: {offset}");
        }
    }
}
