//! [`Wander`]: how far an edge wanders from its straight line, as the residuals show. docs/model.md, section 7.6.

use heapless::Vec;

use super::goodness_of_fit::chance_limit;
use super::modes::Modes;
use super::observation::Observation;
use super::tuning::{LONGEST_WANDER, MOST_SIGMAS, NOISY_SIGMAS, ROUGHNESS_ROWS, WANDER_MODES, WANDERING_SIGMAS};
use crate::scalar::{Scalar, over};
use crate::setup::Setup;

/// Bearing and inverse depth, which the residuals do not show.
const SPENT: usize = 2;

const PS_PER_S: i64 = 1_000_000_000_000;

/// The variance of a stretch of the edge, of a wander of 1 px that is alike over a number of rows. Within these
/// averaging does not reduce it, and shorter stretches share it with their neighbours.
fn variance_of_wander<S: Scalar>(stretch: &Observation<S>, alike_rows: S) -> S {
    (alike_rows / stretch.rows()).max(S::ONE)
}

/// With the roughness that is stated.
pub(super) fn rough_sigma_px<S: Scalar>(stretch: &Observation<S>, roughness_px: S) -> S {
    let of_roughness = variance_of_wander(stretch, S::from_i32(ROUGHNESS_ROWS)) * roughness_px * roughness_px;
    (stretch.sigma_px() * stretch.sigma_px() + of_roughness).sqrt()
}

/// The residual of a stretch of the edge.
pub(super) struct Residual<'a, S: Scalar> {
    stretch: &'a Observation<S>,
    /// In 1/2²⁰ of the sigma that the fit has used.
    deviation_q20: i32,
    noise: S::Kept,
}

impl<'a, S: Scalar> Residual<'a, S> {
    pub(super) fn new(stretch: &'a Observation<S>, deviation: S) -> Self {
        let cap_q20 = MOST_SIGMAS << 20;
        let deviation_q20 = (deviation * S::from_i32(1 << 20)).to_i32().clamp(-cap_q20, cap_q20);
        Self { stretch, deviation_q20, noise: (stretch.sigma_px() * stretch.per_sigma()).kept() }
    }

    /// The stated noise, in the same units.
    fn noise(&self) -> S {
        S::of_kept(self.noise)
    }
}

/// The errors of an edge's columns: white noise, and a wander whose correlation falls off exponentially along the edge
/// (a Gauss-Markov process).
pub(super) struct Wander<S> {
    /// Factor on the stated variance of the noise.
    noise: S,
    /// Variance in square pixels.
    wander_px2: S,
    /// Integral of the correlation over the rows on both sides.
    alike_rows: S,
    /// Factor on all variances that gives the slope through the stretches the sigma of correlated errors.
    inflation: S,
}

impl<S: Scalar> Wander<S> {
    /// From the residuals of one fit, in the order of readout; `None` where the errors are white noise as stated.
    /// `blur_px` is that of the edge, and points are `row_spacing` rows apart.
    ///
    /// Roughness belongs to the object and is alike over some rows. Offsets of the sensor's columns displace an edge
    /// alike until it has moved on by its own blur, which may take many rows. As little of so slow a wander is left in
    /// the residuals, their modes are compared with what such a process leaves in them.
    ///
    /// In a sequence each frame counts for itself: what of a wander is the object's is the same in all of them and does
    /// parallax no harm, but what neighbours and backgrounds do to it changes.
    pub(super) fn of<const N: usize>(
        residuals: &[Residual<'_, S>],
        setup: &Setup<S>,
        blur_px: S,
        row_spacing: S,
    ) -> Option<Self> {
        let roughness_px = setup.uncertainty().edge_roughness_px;
        let alike_rows = alike_rows(residuals, setup, blur_px)?;
        let (none, mut shown) = (S::ZERO, Shown::NOTHING);
        if roughness_px == none {
            if is_white(residuals) {
                return None;
            }
            shown.see::<N>(residuals, None);
            if shown.noise == S::ONE && shown.is_chance() {
                return None;
            }
        }
        let kernel = Kernel::<S, N>::new(residuals, setup, alike_rows);
        shown.see(residuals, Some(&kernel));
        let wander_px2 = shown.wander_px2(residuals, roughness_px, row_spacing);
        if shown.noise == S::ONE && wander_px2 == none {
            return None;
        }
        let mut wander = Self { noise: shown.noise, wander_px2, alike_rows, inflation: S::ONE };
        wander.inflation = wander.inflation_with(residuals, &kernel);
        Some(wander)
    }

    fn noise_px2(&self, stretch: &Observation<S>) -> S {
        stretch.sigma_px() * stretch.sigma_px() * self.noise
    }

    fn variance_px2(&self, stretch: &Observation<S>) -> S {
        self.noise_px2(stretch) + self.wander_px2 * variance_of_wander(stretch, self.alike_rows)
    }

    /// Sigma of a stretch such that a fit that takes it for white noise states the right one for the slope.
    pub(super) fn sigma_px(&self, stretch: &Observation<S>) -> S {
        (self.variance_px2(stretch) * self.inflation).sqrt()
    }

    /// Variance of the slope through the stretches over what a fit with their variances states.
    #[inline(never)]
    fn inflation_with<const N: usize>(&self, residuals: &[Residual<'_, S>], kernel: &Kernel<S, N>) -> S {
        let none = S::ZERO;
        let (mut weights, mut moment, mut leverages) = (none, none, Vec::<(S, S), N>::new());
        let middle = residuals.get(residuals.len() / 2).map_or(none, |residual| residual.stretch.time_s());
        for Residual { stretch, .. } in residuals {
            let (place, weight) = (stretch.time_s() - middle, over(self.variance_px2(stretch)));
            (weights, moment) = (weights + weight, moment + weight * place);
            // There is room: as many as residuals.
            let _ = leverages.push((place, weight));
        }
        let mean = moment * over(weights);
        let (mut stated, mut of_noise) = (none, none);
        for ((place, weight), residual) in leverages.iter_mut().zip(residuals) {
            let off = *place - mean;
            let leverage = *weight * off;
            (stated, of_noise) =
                (stated + leverage * off, of_noise + leverage * leverage * self.noise_px2(residual.stretch));
            *weight = leverage;
        }
        let of_wander = kernel.variance(leverages.iter().map(|(_, leverage)| *leverage)) * self.wander_px2;
        (of_noise + of_wander) * over(stated)
    }
}

/// Number of modes that are looked at, and how many values are left for noise beside them.
fn modes_and_spare(count: usize) -> [usize; 2] {
    let modes = count.saturating_sub(SPENT + SPENT).min(WANDER_MODES);
    [modes, count.saturating_sub(SPENT + modes)]
}

/// Whether even all squares together were neither beyond chance in the modes nor in the noise beside them: most edges
/// are straight, and need no modes. So few that none is looked at show noise alone, or nothing.
#[inline(never)]
pub(super) fn is_white<S: Scalar>(residuals: &[Residual<'_, S>]) -> bool {
    let squares = squares_of(residuals);
    let within = |count: usize, sigmas: i32| {
        let number = S::from_i32(count as i32);
        count == 0 || squares <= number * chance_limit(number, S::from_i32(sigmas))
    };
    let [modes, spare] = modes_and_spare(residuals.len());
    within(modes, WANDERING_SIGMAS) && within(spare, NOISY_SIGMAS)
}

/// Sum of the squares of all deviations.
#[inline(never)]
fn squares_of<S: Scalar>(residuals: &[Residual<'_, S>]) -> S {
    let square_q32 = |residual: &Residual<'_, S>| {
        let deviation_q16 = i64::from(residual.deviation_q20 >> 4);
        deviation_q16 * deviation_q16
    };
    let per_q16 = S::ratio(1, 1 << 16);
    // Of more samples than a line has these would still fit.
    S::from_i64(residuals.iter().map(square_q32).fold(0, i64::wrapping_add)) * per_q16 * per_q16
}

fn rows_per_s<S: Scalar>(setup: &Setup<S>) -> S {
    S::from_ratio(PS_PER_S, setup.readout().line_time_ps() as i64)
}

/// Over how many rows a wander is alike; `None` where there is nothing to be seen of one.
// Not inlined, as other parts: what each of them needs then leaves the stack before the next one comes.
#[inline(never)]
fn alike_rows<S: Scalar>(residuals: &[Residual<'_, S>], setup: &Setup<S>, blur_px: S) -> Option<S> {
    let (first, last) = (residuals.first()?.stretch, residuals.last()?.stretch);
    let extent = (last.time_s() - first.time_s()).abs() * rows_per_s(setup);
    if residuals.len() <= SPENT || extent == S::ZERO {
        return None;
    }
    let ([first_u, _], [last_u, _]) = (first.bearings(), last.bearings());
    let moved_px = (last_u - first_u).abs() * setup.camera().intrinsics().fx;
    // A Gaussian's correlation with itself has an integral of 2√π of its sigmas.
    let crossing_rows = S::ratio(3_545, 1_000) * blur_px * extent / moved_px;
    let longest = extent * S::ratio(LONGEST_WANDER.0, LONGEST_WANDER.1);
    Some(crossing_rows.min(longest).max(S::from_i32(ROUGHNESS_ROWS)))
}

/// Correlation of the wander from stretch to stretch.
struct Kernel<S: Scalar, const N: usize> {
    /// Correlation with the stretch before, and what averaging within the stretch leaves of the wander.
    links: Vec<[S::Kept; 2], N>,
}

impl<S: Scalar, const N: usize> Kernel<S, N> {
    #[inline(never)]
    fn new(residuals: &[Residual<'_, S>], setup: &Setup<S>, alike_rows: S) -> Self {
        let (length, mut kernel) = (alike_rows.half(), Self { links: Vec::new() });
        let (lengths_per_s, length_of_three) = (rows_per_s(setup) / length, length * S::from_i32(3));
        let mut before = residuals.first().map_or(S::ZERO, |residual| residual.stretch.time_s());
        let (mut rows, mut kept) = (S::ZERO, S::ZERO);
        for Residual { stretch, .. } in residuals {
            let lengths = (stretch.time_s() - before).abs() * lengths_per_s;
            before = stretch.time_s();
            // About e^−x, and never below zero.
            let correlation = (S::ONE + lengths + (lengths * lengths).half()).reciprocal();
            // Most stretches have as many rows as the one before.
            if stretch.rows() != rows {
                rows = stretch.rows();
                // The mean over n rows of such a process keeps 1/(1 + n/3) of its variance.
                let thirds = length_of_three / rows;
                kept = (thirds / (S::ONE + thirds)).sqrt();
            }
            // There is room: as many as residuals.
            let _ = kernel.links.push([correlation, kept].map(S::kept));
        }
        kernel
    }

    /// Variance of a weighted sum over the wander of all stretches, in units of the wander's own.
    fn variance(&self, weights: impl Iterator<Item = S>) -> S {
        let (mut sum, mut carried) = (S::ZERO, S::ZERO);
        for (weight, link) in weights.zip(&self.links) {
            let [correlation, kept] = link.map(S::of_kept);
            let part = weight * kept;
            carried = carried * correlation;
            sum = sum.plus_product(part, part + carried + carried);
            carried = carried + part;
        }
        sum.max(S::ZERO)
    }
}

/// What the residuals show.
struct Shown<S> {
    /// Factor on the stated variance of the noise.
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
    /// Before they are looked at.
    const NOTHING: Self =
        Self { noise: S::ONE, share: S::ONE, power: S::ZERO, of_noise: S::ZERO, of_wander: S::ZERO, modes: 0 };

    /// Without a kernel: of white noise that is all of the sigma, so that each mode has one square of it.
    // In place: a copy would need room.
    #[inline(never)]
    fn see<const N: usize>(&mut self, residuals: &[Residual<'_, S>], kernel: Option<&Kernel<S, N>>) {
        let none = S::ZERO;
        let [modes, _] = modes_and_spare(residuals.len());
        let of_noise = if kernel.is_none() { S::from_i32(modes as i32) } else { none };
        *self = Self { of_noise, modes, ..Self::NOTHING };
        let stated = residuals.iter().map(Residual::noise).fold(none, |sum, noise| sum.plus_product(noise, noise));
        let mut rest = squares_of(residuals);
        let places = residuals.iter().map(|residual| (residual.stretch.time_s(), residual.stretch.per_sigma()));
        let mut mode = Modes::<S, N>::new(places);
        for order in 0..SPENT + modes {
            if order > 0 {
                mode.advance();
            }
            let power = mode.power(residuals.iter().map(|residual| residual.deviation_q20));
            rest = rest - power;
            if order >= SPENT {
                self.power = self.power + power;
                if let Some(kernel) = kernel {
                    self.expect(residuals, kernel, &mode);
                }
            }
        }
        self.judge_noise(residuals.len(), rest, stated);
    }

    /// What noise and a wander of 1 px have in a mode.
    #[inline(never)]
    fn expect<const N: usize>(&mut self, residuals: &[Residual<'_, S>], kernel: &Kernel<S, N>, mode: &Modes<S, N>) {
        let of_noise = mode.values().zip(residuals).map(|(part, residual)| part * residual.noise());
        let of_noise = of_noise.fold(S::ZERO, |sum, part| sum.plus_product(part, part));
        let weights = mode.values().zip(residuals).map(|(part, residual)| part * residual.stretch.per_sigma());
        self.of_noise = self.of_noise + of_noise * mode.per_square();
        self.of_wander = self.of_wander + kernel.variance(weights) * mode.per_square();
    }

    /// What changes from stretch to stretch is noise. `rest` is left of the squares beside the modes, and `stated` the
    /// sum of the stated ones.
    fn judge_noise(&mut self, count: usize, rest: S, stated: S) {
        let [_, spare] = modes_and_spare(count);
        let spare = S::from_i32(spare as i32);
        let rest = rest.max(S::ZERO) / spare;
        self.share = rest * S::from_i32(count as i32) / stated;
        if rest > chance_limit(spare, S::from_i32(NOISY_SIGMAS)) {
            self.noise = self.share.max(S::ONE);
        }
    }

    /// Whether noise alone has modes as large as these.
    fn is_chance(&self) -> bool {
        let most = chance_limit(S::from_i32(self.modes as i32), S::from_i32(WANDERING_SIGMAS));
        self.power <= self.of_noise * self.noise * most
    }

    /// Variance of the wander.
    #[inline(never)]
    fn wander_px2(&self, residuals: &[Residual<'_, S>], roughness_px: S, row_spacing: S) -> S {
        let of_noise = self.of_noise * self.noise;
        let shown_px2 = (self.power - of_noise).max(S::ZERO) * over(self.of_wander);
        if roughness_px == S::ZERO {
            return if self.is_chance() { S::ZERO } else { shown_px2 };
        }
        // Noise is measured along the row. As far as it does not change from row to row it belongs to the columns.
        let of_row = |Residual { stretch, .. }: &Residual<'_, S>| {
            stretch.sigma_px() * stretch.sigma_px() * stretch.rows().max(row_spacing)
        };
        let squares = residuals.iter().map(of_row).fold(S::ZERO, |sum, square| sum + square);
        let points = S::from_i32(residuals.len() as i32) * row_spacing;
        let of_columns = squares / points * (S::ONE - self.share).max(S::ZERO);
        (roughness_px * roughness_px + of_columns).max(shown_px2)
    }
}
