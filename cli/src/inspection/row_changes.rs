//! By how much the brightness of a whole picture changes from some rows to the next ones, as a flickering light changes
//! it.

use super::grey::Grey;
use super::robust::median;

/// Bands along the rows.
pub(crate) struct Bands {
    /// Half of the way from dark to bright, as a share of the brightness.
    pub(crate) amplitude: f64,
    /// In the frame.
    pub(crate) periods: f64,
    /// Share of what varies from row to row that repeats with this period.
    pub(crate) purity: f64,
}

/// In so few columns nothing can be told apart from what is in the scene.
const FEWEST_COLUMNS: f64 = 0.25;
const DARK: i32 = 10;
const WHITE: i32 = 254;

/// The logarithms of the ratios of brightness, from each group of `step` rows to the next one: what most columns show.
/// `None` where most rows say nothing.
pub(super) fn of(grey: &Grey<'_>, step: usize) -> Option<Vec<f64>> {
    let tops = (0..grey.rows.saturating_sub(2 * step)).step_by(step);
    let changes: Vec<Option<f64>> = tops.map(|top| change(grey, top, step)).collect();
    let told = changes.iter().flatten().count();
    // A light that is off, or too bright, stays as it is.
    (told * 4 > changes.len()).then(|| changes.into_iter().map(|change| change.unwrap_or(0.0)).collect())
}

fn change(grey: &Grey<'_>, top: usize, step: usize) -> Option<f64> {
    let sum = |column: usize, top: usize| (top..top + step).map(|row| grey.at(column, row)).sum::<i32>();
    let (darkest, whitest) = (DARK * step as i32, WHITE * step as i32);
    let pairs = (0..grey.columns).map(|column| (sum(column, top), sum(column, top + step)));
    let sound = pairs.filter(|(above, below)| *above.max(below) > darkest && *above.min(below) < whitest);
    // One level more: light that goes off leaves black.
    let log = |sum: i32| (f64::from(sum) / step as f64 + 1.0).ln();
    let ratios: Vec<f64> = sound.map(|(above, below)| log(below) - log(above)).collect();
    if (ratios.len() as f64) < FEWEST_COLUMNS * grey.columns as f64 {
        return None;
    }
    // Beside the median a mean of what is near it: ratios of whole levels are coarse.
    let middle = median(ratios.iter().copied());
    let near = ratios.iter().filter(|ratio| (*ratio - middle).abs() < 0.1);
    let (sum, count) = near.fold((0.0, 0.0), |(sum, count), ratio| (sum + ratio, count + 1.0));
    Some(sum / count)
}
