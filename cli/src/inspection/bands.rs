//! Bands of a light that flickers while the rows are read.

use super::grey::Grey;
use super::robust::median;

/// Rows over which brightness is compared.
const STEP: usize = 4;
const FEWEST_PERIODS: f64 = 1.5;

pub(crate) struct Bands {
    /// Half of the way from dark to bright, as a share of the brightness.
    pub(crate) amplitude: f64,
    /// In the frame.
    pub(crate) periods: f64,
    /// Share of what varies from row to row that is this one sine.
    pub(crate) purity: f64,
}

/// `None` in a frame of few rows, or a dark one.
pub(crate) fn of(grey: &Grey<'_>) -> Option<Bands> {
    let mut profile = profile(grey)?;
    without_trend(&mut profile);
    let variance = profile.iter().map(|value| value * value).sum::<f64>() / profile.len() as f64;
    let fastest = profile.len() as f64 / 6.0;
    let candidates =
        (0..).map(|step| FEWEST_PERIODS + 0.125 * f64::from(step)).take_while(|periods| *periods < fastest);
    let powers = candidates.map(|periods| (periods, power(&profile, periods)));
    let (periods, power) = powers.fold((0.0, 0.0), |best, next| if next.1 > best.1 { next } else { best });
    let purity = if variance > 0.0 { power / variance } else { 0.0 };
    Some(Bands { amplitude: (2.0 * power).sqrt(), periods, purity })
}

/// The logarithm of the brightness every few rows: from step to step by what most columns change.
fn profile(grey: &Grey<'_>) -> Option<Vec<f64>> {
    let mut sum = 0.0;
    let mut profile = vec![0.0];
    for top in (0..grey.rows.saturating_sub(2 * STEP)).step_by(STEP) {
        let mean = |column: usize, top: usize| (top..top + STEP).map(|row| grey.at(column, row)).sum::<i32>();
        let changes = (0..grey.columns).map(|column| (mean(column, top), mean(column, top + STEP)));
        let sound = changes
            .filter(|(above, below)| *above.min(below) > 10 * STEP as i32 && *above.max(below) < 254 * STEP as i32);
        let ratios: Vec<f64> = sound.map(|(above, below)| (f64::from(below) / f64::from(above)).ln()).collect();
        if ratios.len() * 4 < grey.columns {
            return None;
        }
        // Beside the median a mean of what is near it: ratios of whole levels are coarse.
        let middle = median(ratios.iter().copied());
        let near: Vec<f64> = ratios.into_iter().filter(|ratio| (ratio - middle).abs() < 0.1).collect();
        sum += near.iter().sum::<f64>() / near.len().max(1) as f64;
        profile.push(sum);
    }
    (profile.len() >= 24).then_some(profile)
}

/// Takes out the best parabola: light falls off towards the borders.
fn without_trend(profile: &mut [f64]) {
    let count = profile.len() as f64;
    let place = |index: usize| 2.0 * (index as f64 + 0.5) / count - 1.0;
    // Legendre's polynomials are nearly orthogonal over as many places.
    for shape in [|_: f64| 1.0, |x: f64| x, |x: f64| 1.5 * x * x - 0.5] {
        let size: f64 = (0..profile.len()).map(|index| shape(place(index)).powi(2)).sum();
        let part: f64 =
            profile.iter().enumerate().map(|(index, value)| value * shape(place(index))).sum::<f64>() / size;
        profile.iter_mut().enumerate().for_each(|(index, value)| *value -= part * shape(place(index)));
    }
}

/// Of the sine with so many periods.
fn power(profile: &[f64], periods: f64) -> f64 {
    let turn = std::f64::consts::TAU * periods / profile.len() as f64;
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (index, value) in profile.iter().enumerate() {
        let (s, c) = (turn * index as f64).sin_cos();
        cosine += value * c;
        sine += value * s;
    }
    2.0 * (cosine * cosine + sine * sine) / (profile.len() * profile.len()) as f64
}
