//! Light that goes on and off: PWM, pulses and strobes, whose bands have sharp borders or are narrower than a few rows.

use super::grey::Grey;
use super::robust::quantile;
use super::row_changes::{self, Bands};

/// Fewer would not say that they repeat.
const FEWEST_PERIODS: f64 = 3.0;
/// Faster ones are no more than noise from row to row.
const FEWEST_ROWS: f64 = 2.2;
/// Of harmonics: borders of pulses are as sharp as the exposure is short.
const MOST_HARMONICS: usize = 24;
/// Twice the period has the same harmonics and some more, which only noise fills.
const AS_GOOD: f64 = 0.05;
/// Places in the spectrum for each period more in the frame.
const FINENESS: usize = 8;

/// The period whose harmonics explain the most of what changes from row to row, beyond what as many sines would by
/// chance.
pub(super) fn of(grey: &Grey<'_>) -> Option<Bands> {
    let changes = row_changes::of(grey, 1)?;
    let spectrum = Spectrum::of(&changes)?;
    let most = changes.len() as f64 / FEWEST_ROWS;
    let (mut best, mut periods) = ((0.0, 0.0), FEWEST_PERIODS);
    while periods < most {
        let purity = spectrum.purity(periods);
        if purity > best.0 {
            best = (purity, periods);
        }
        // The last harmonic moves by one place.
        periods += 1.0 / (FINENESS * spectrum.harmonics(periods)) as f64;
    }
    let (purity, periods) = best;
    let is_as_good = |times: &f64| times * periods < most && spectrum.purity(times * periods) > purity - AS_GOOD;
    let times = (2..=MOST_HARMONICS).rev().map(|times| times as f64).find(is_as_good);
    Some(Bands { amplitude: amplitude(&changes), periods: times.unwrap_or(1.0) * periods, purity })
}

/// Shares of the variance.
struct Spectrum {
    shares: Vec<f64>,
    rows: f64,
}

impl Spectrum {
    /// `None` where nothing changes, or there are too few rows.
    fn of(changes: &[f64]) -> Option<Self> {
        const FEWEST: usize = 64;
        let rows = changes.len() as f64;
        let mean = changes.iter().sum::<f64>() / rows;
        let all: f64 = changes.iter().map(|change| (change - mean).powi(2)).sum();
        if changes.len() < FEWEST || all <= 0.0 {
            return None;
        }
        let share = |place: usize| {
            let turn = std::f64::consts::TAU * place as f64 / (FINENESS as f64 * rows);
            let (mut cosine, mut sine) = (0.0, 0.0);
            for (row, change) in changes.iter().enumerate() {
                let (s, c) = (turn * row as f64).sin_cos();
                cosine += (change - mean) * c;
                sine += (change - mean) * s;
            }
            2.0 * (cosine * cosine + sine * sine) / (rows * all)
        };
        Some(Self { shares: (0..=changes.len() * FINENESS / 2).map(share).collect(), rows })
    }

    fn harmonics(&self, periods: f64) -> usize {
        ((0.5 * self.rows / periods) as usize).clamp(1, MOST_HARMONICS)
    }

    fn purity(&self, periods: f64) -> f64 {
        let harmonics = self.harmonics(periods);
        let share = |harmonic: usize| {
            let place = (harmonic as f64 * periods * FINENESS as f64).round() as usize;
            self.shares.get(place).copied().unwrap_or(0.0)
        };
        let found: f64 = (1..=harmonics).map(share).sum();
        let by_chance = 2.0 * harmonics as f64 / self.rows;
        (found - by_chance) / (1.0 - by_chance)
    }
}

/// Half of the way from dark to bright, as a share of the brightness in the middle of the two.
fn amplitude(changes: &[f64]) -> f64 {
    let mut sum = 0.0;
    let levels = changes.iter().map(|change| {
        sum += change;
        f64::exp(sum)
    });
    let levels: Vec<f64> = levels.collect();
    let [dark, bright] = [0.05, 0.95].map(|share| quantile(levels.iter().copied(), share));
    (bright - dark) / (bright + dark)
}
