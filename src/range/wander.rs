//! [`Wander`]: how far an edge wanders from its straight line, as the residuals show. docs/model.md, section 7.6.

use heapless::Vec;

use super::goodness_of_fit::chance_limit;
use super::modes::Modes;
use super::sample::Sample;
use super::tuning::{LONGEST_WANDER, MOST_SIGMAS, NOISY_SIGMAS, ROUGHNESS_ROWS, WANDER_MODES, WANDERING_SIGMAS};
use crate::scalar::{Scalar, hypot};
use crate::setup::Readout;

const PS_PER_S: i64 = 1_000_000_000_000;

/// Bearing and inverse depth, which the residuals do not show.
const SPENT: usize = 2;

/// The part of an edge that a sample is the mean of.
#[derive(Clone, Copy)]
pub(super) struct Stretch<S> {
    column_px: S,
    /// In rows, by its time.
    place: S,
    /// Number of rows, at least one.
    rows: S,
    /// Stated noise of the mean.
    noise_px: S,
}

impl<S: Scalar> Stretch<S> {
    pub(super) fn of(sample: &Sample<S>, noise_px: S, readout: &Readout) -> Self {
        let &Sample { column_px, time_s, spread, .. } = sample;
        let line_time_s = S::from_ratio(readout.line_time_ps() as i64, PS_PER_S);
        // n rows have a variance of n²/12.
        let rows = (spread.row_px * S::from_i32(12).sqrt()).max(S::ONE);
        Self { column_px, place: time_s / line_time_s, rows, noise_px }
    }

    /// Noise of the mean and wander that is alike over a number of rows. Within these averaging does not reduce it, and
    /// shorter stretches share it with their neighbours.
    fn sigma_px(&self, noise_px: S, wander_px: S, alike_rows: S) -> S {
        if wander_px == S::ZERO {
            return noise_px;
        }
        hypot(noise_px, wander_px * (alike_rows / self.rows).max(S::ONE).sqrt())
    }

    /// With the roughness that is stated.
    pub(super) fn rough_sigma_px(&self, roughness_px: S) -> S {
        self.sigma_px(self.noise_px, roughness_px, S::from_i32(ROUGHNESS_ROWS))
    }
}

/// The residual of a stretch in units of the sigma that the fit has used.
pub(super) struct Residual<S> {
    pub(super) stretch: Stretch<S>,
    pub(super) sigma_px: S,
    pub(super) deviation: S,
}

/// The errors of an edge's columns: white noise, and a wander whose correlation falls off exponentially along the edge (a
/// Gauss-Markov process).
pub(super) struct Wander<S> {
    /// Factor on the stated noise.
    noise: S,
    wander_px: S,
    /// Integral of the correlation over the rows on both sides.
    alike_rows: S,
    /// Factor on all sigmas that gives the slope through the stretches the sigma of correlated errors.
    inflation: S,
}

impl<S: Scalar> Wander<S> {
    /// From the residuals of one fit, in the order of readout. `blur_px` is that of the edge.
    ///
    /// Roughness belongs to the object and is alike over some rows. Offsets of the sensor's columns displace an edge alike
    /// until it has moved on by its own blur, which may take many rows. As little of so slow a wander is left in the
    /// residuals, their modes are compared with what such a process leaves in them.
    ///
    /// `is_known`: earlier frames have shown the same edge, with the same wander. It takes part in what they have told of its place
    /// and its lean, and parallax does not mind it: only roughness is left.
    pub(super) fn of<const N: usize>(
        residuals: &Vec<Residual<S>, N>,
        roughness_px: S,
        blur_px: S,
        is_known: bool,
    ) -> Option<Self> {
        let (first, last) = (residuals.first()?.stretch, residuals.last()?.stretch);
        let extent = (last.place - first.place).abs();
        if residuals.len() <= SPENT || extent == S::ZERO {
            return None;
        }
        let moved_px = (last.column_px - first.column_px).abs();
        // A Gaussian's correlation with itself has an integral of 2√π of its sigmas.
        let crossing_rows = S::ratio(3_545, 1_000) * blur_px * extent / moved_px;
        let longest = extent * S::ratio(LONGEST_WANDER.0, LONGEST_WANDER.1);
        let roughness_rows = S::from_i32(ROUGHNESS_ROWS);
        let alike_rows = if is_known { roughness_rows } else { crossing_rows.min(longest).max(roughness_rows) };
        let kernel = Kernel::new(residuals, alike_rows);
        let shown = Shown::of(residuals, &kernel);
        let wander_px = if is_known { roughness_px } else { shown.wander_px(residuals, roughness_px) };
        let wander = Self { noise: shown.noise, wander_px, alike_rows, inflation: S::ONE };
        Some(Self { inflation: wander.inflation_with(residuals, &kernel)?, ..wander })
    }

    /// Sigma of a stretch such that a fit that takes it for white noise states the right one for the slope.
    pub(super) fn sigma_px(&self, stretch: &Stretch<S>) -> S {
        stretch.sigma_px(stretch.noise_px * self.noise, self.wander_px, self.alike_rows) * self.inflation
    }

    /// Whether the errors are white noise as stated.
    pub(super) fn is_none(&self) -> bool {
        self.noise == S::ONE && self.wander_px == S::ZERO
    }

    fn inflation_with<const N: usize>(&self, residuals: &Vec<Residual<S>, N>, kernel: &Kernel<S, N>) -> Option<S> {
        let sigmas = residuals.iter().map(|residual| self.sigma_px(&residual.stretch));
        let slope = Modes::<S, N>::new(residuals.iter().map(|residual| residual.stretch.place).zip(sigmas)).nth(1)?;
        let weighted = slope.iter().zip(residuals).map(|(part, residual)| *part / self.sigma_px(&residual.stretch));
        let noise = residuals.iter().map(|residual| residual.stretch.noise_px * self.noise);
        let of_noise = weighted.clone().zip(noise).map(|(part, noise_px)| part * noise_px);
        let of_noise = of_noise.fold(S::ZERO, |sum, part| sum + part * part);
        let of_wander = kernel.variance(weighted.map(|part| part * self.wander_px));
        Some((of_noise + of_wander).sqrt())
    }
}

/// Correlation of the wander from stretch to stretch.
struct Kernel<S, const N: usize> {
    /// Correlation with the stretch before, and what averaging within the stretch leaves of the wander.
    links: Vec<(S, S), N>,
}

impl<S: Scalar, const N: usize> Kernel<S, N> {
    fn new(residuals: &Vec<Residual<S>, N>, alike_rows: S) -> Self {
        let length = alike_rows * S::ratio(1, 2);
        let mut links = Vec::new();
        let mut before = residuals.first().map_or(S::ZERO, |residual| residual.stretch.place);
        for Residual { stretch, .. } in residuals {
            let lengths = (stretch.place - before).abs() / length;
            before = stretch.place;
            // About e^−x, and never below zero. The mean over n rows of such a process keeps 1/(1 + n/3) of its variance.
            let correlation = S::ONE / (S::ONE + lengths + lengths * lengths * S::ratio(1, 2));
            let kept = S::ONE / (S::ONE + stretch.rows / (length * S::from_i32(3))).sqrt();
            // There is room: as many as residuals.
            let _ = links.push((correlation, kept));
        }
        Self { links }
    }

    /// Variance of a weighted sum over the wander of all stretches, in units of the wander's own.
    fn variance(&self, weights: impl Iterator<Item = S>) -> S {
        let (mut sum, mut carried) = (S::ZERO, S::ZERO);
        for (weight, (correlation, kept)) in weights.zip(&self.links) {
            let part = weight * *kept;
            carried = carried * *correlation;
            sum = sum + part * (part + carried + carried);
            carried = carried + part;
        }
        sum.max(S::ZERO)
    }
}

/// What the residuals show.
struct Shown<S> {
    /// Factor on the stated noise.
    noise: S,
    /// Share of the stated noise that changes from stretch to stretch.
    share: S,
    /// Squares of the modes, and what noise and a wander of 1 px have in them.
    power: S,
    of_noise: S,
    of_wander: S,
    modes: usize,
}

impl<S: Scalar> Shown<S> {
    fn of<const N: usize>(residuals: &Vec<Residual<S>, N>, kernel: &Kernel<S, N>) -> Self {
        let none = S::ZERO;
        let modes = residuals.len().saturating_sub(SPENT + SPENT).min(WANDER_MODES);
        let mut shown = Self { noise: S::ONE, share: S::ONE, power: none, of_noise: none, of_wander: none, modes };
        let cap = S::from_i32(MOST_SIGMAS);
        let deviations = || residuals.iter().map(|residual| residual.deviation.min(cap).max(-cap));
        let mut rest = deviations().fold(none, |sum, off| sum + off * off);
        let places = residuals.iter().map(|residual| (residual.stretch.place, residual.sigma_px));
        for (order, mode) in Modes::<S, N>::new(places).take(SPENT + modes).enumerate() {
            let along = mode.iter().zip(deviations()).fold(none, |sum, (part, off)| sum + *part * off);
            rest = rest - along * along;
            if order < SPENT {
                continue;
            }
            let parts = || mode.iter().zip(residuals);
            let of_noise = parts().map(|(part, residual)| *part * residual.relative_noise());
            shown.power = shown.power + along * along;
            shown.of_noise = shown.of_noise + of_noise.fold(none, |sum, part| sum + part * part);
            shown.of_wander =
                shown.of_wander + kernel.variance(parts().map(|(part, residual)| *part / residual.sigma_px));
        }
        shown.judge_noise(residuals, rest);
        shown
    }

    /// What changes from stretch to stretch is noise.
    fn judge_noise<const N: usize>(&mut self, residuals: &Vec<Residual<S>, N>, rest: S) {
        let count = residuals.len();
        let spare = S::from_i32(count.saturating_sub(SPENT + self.modes) as i32);
        let stated = residuals.iter().map(Residual::relative_noise).fold(S::ZERO, |sum, part| sum + part * part);
        let rest = rest.max(S::ZERO) / spare;
        self.share = rest * S::from_i32(count as i32) / stated;
        if rest > chance_limit(spare, S::from_i32(NOISY_SIGMAS)) {
            self.noise = self.share.max(S::ONE).sqrt();
        }
    }

    /// One sigma of the wander.
    fn wander_px<const N: usize>(&self, residuals: &Vec<Residual<S>, N>, roughness_px: S) -> S {
        let of_noise = self.of_noise * self.noise * self.noise;
        let shown_px = ((self.power - of_noise).max(S::ZERO) / self.of_wander).sqrt();
        let shown_px = if self.of_wander > S::ZERO { shown_px } else { S::ZERO };
        if roughness_px == S::ZERO {
            let is_chance =
                self.power <= of_noise * chance_limit(S::from_i32(self.modes as i32), S::from_i32(WANDERING_SIGMAS));
            return if is_chance { S::ZERO } else { shown_px };
        }
        // Noise is measured along the row. As far as it does not change from row to row it belongs to the columns.
        let of_row = |residual: &Residual<S>| residual.stretch.noise_px * residual.stretch.rows.sqrt();
        let squares = residuals.iter().map(of_row).fold(S::ZERO, |sum, noise| sum + noise * noise);
        let of_columns = squares / S::from_i32(residuals.len() as i32) * (S::ONE - self.share).max(S::ZERO);
        hypot(roughness_px, of_columns.sqrt()).max(shown_px)
    }
}

impl<S: Scalar> Residual<S> {
    /// Stated noise in units of the sigma that the fit has used.
    fn relative_noise(&self) -> S {
        self.stretch.noise_px / self.sigma_px
    }
}
