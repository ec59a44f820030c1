//! Bands of a light that flickers while the rows are read.

use super::grey::Grey;
use super::pulses;
use super::row_changes::{self, Bands};

/// Rows over which brightness is compared.
const STEP: usize = 4;
/// Shading of a wall looks like fewer.
const FEWEST_PERIODS: f64 = 2.5;
/// A sine that explains so much need not be anything else.
const ENOUGH: f64 = 0.8;

/// A sine, as lamps on mains make it, or pulses where they explain more. `None` in a frame of few rows, or a dark one.
pub(crate) fn of(grey: &Grey<'_>) -> Option<Bands> {
    let (sine, pulses) = (sine(grey), pulses::of(grey));
    let purity = |bands: &Option<Bands>| bands.as_ref().map_or(0.0, |bands| bands.purity);
    // What is faster than the groups of rows looks slow in them.
    let is_fast = pulses.as_ref().is_some_and(|pulses| pulses.periods * (2 * STEP) as f64 > grey.rows as f64);
    if is_fast && purity(&pulses) > ENOUGH {
        return pulses;
    }
    if purity(&sine) > ENOUGH || purity(&sine) > purity(&pulses) { sine } else { pulses }
}

fn sine(grey: &Grey<'_>) -> Option<Bands> {
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

/// The logarithm of the brightness every few rows.
fn profile(grey: &Grey<'_>) -> Option<Vec<f64>> {
    let mut sum = 0.0;
    let mut profile = vec![0.0];
    for change in row_changes::of(grey, STEP)? {
        sum += change;
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
