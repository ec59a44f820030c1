//! Offsets of columns and rows: fixed patterns of the sensor's amplifiers, and rows that are read with a noise of their own.

use super::grey::Grey;
use super::robust;

/// Beyond so many sigma a difference is an edge.
const EDGE_SIGMAS: f64 = 4.0;

/// One sigma of the offsets in grey levels, beyond what the noise of the pixels explains.
pub(crate) fn of_columns(grey: &Grey<'_>, noise_sigma: f64) -> f64 {
    let at = |column, row| grey.at(column, row);
    offsets(grey.columns, grey.rows, noise_sigma, at)
}

pub(crate) fn of_rows(grey: &Grey<'_>, noise_sigma: f64) -> f64 {
    let at = |row, column| grey.at(column, row);
    offsets(grey.rows, grey.columns, noise_sigma, at)
}

/// Of so many lines of so many pixels each: how far each is from the middle of its neighbours.
fn offsets(lines: usize, pixels: usize, noise_sigma: f64, at: impl Fn(usize, usize) -> i32) -> f64 {
    if lines < 16 || pixels < 16 {
        return 0.0;
    }
    // Of a middle of two, in units of half a level.
    let sigma = noise_sigma.max(0.3) * 1.5_f64.sqrt();
    let most = (2.0 * (EDGE_SIGMAS * sigma + 3.0)) as i32;
    let mut found = Vec::new();
    for line in 1..lines - 1 {
        let differences = (0..pixels).map(|pixel| 2 * at(line, pixel) - at(line - 1, pixel) - at(line + 1, pixel));
        let (sum, count) = differences
            .filter(|difference| difference.abs() <= most)
            .fold((0_i64, 0_i64), |(sum, count), next| (sum + i64::from(next), count + 1));
        // A line along an edge, or crossed by many, is left out.
        if count as usize * 20 > pixels * 19 {
            found.push(sum as f64 / (2 * count) as f64);
        }
    }
    if found.len() * 4 < lines {
        return 0.0;
    }
    let of_noise = sigma * sigma / pixels as f64;
    let variance = (robust::sigma(found).powi(2) - of_noise) / 1.5;
    variance.max(0.0).sqrt()
}
