//! Offsets of columns and rows: fixed patterns of the sensor's amplifiers, and rows that are read with a noise of their
//! own.

use super::grey::Grey;
use super::robust;

/// Beyond so many sigma a difference is an edge.
const EDGE_SIGMAS: f64 = 4.0;

/// One sigma of the offsets in grey levels.
pub(crate) fn of_columns(grey: &Grey<'_>, noise_sigma: f64) -> f64 {
    offsets(grey.columns, grey.rows, noise_sigma, |column, row| grey.at(column, row))
}

pub(crate) fn of_rows(grey: &Grey<'_>, noise_sigma: f64) -> f64 {
    offsets(grey.rows, grey.columns, noise_sigma, |row, column| grey.at(column, row))
}

/// Of so many lines of so many pixels each: how far each is from the middle of its neighbours, alike in both of its
/// halves. Noise is not, nor is an edge, which lies elsewhere half a frame later.
fn offsets(lines: usize, pixels: usize, noise_sigma: f64, at: impl Fn(usize, usize) -> i32) -> f64 {
    let sigma = noise_sigma.max(0.3) * 1.5_f64.sqrt();
    let most = (2.0 * (EDGE_SIGMAS * sigma + 3.0)) as i32;
    let half = |line: usize, from: usize, to: usize| {
        let differences = (from..to).map(|pixel| 2 * at(line, pixel) - at(line - 1, pixel) - at(line + 1, pixel));
        let near = differences.filter(|difference| difference.abs() <= most);
        let (sum, count) = near.fold((0_i64, 0_usize), |(sum, count), next| (sum + i64::from(next), count + 1));
        // A line along an edge, or crossed by many, is left out.
        (count * 20 > (to - from) * 19).then(|| sum as f64 / (2 * count) as f64)
    };
    let beside_edge = lines_beside_edges(lines, pixels, &at);
    let halves = |line: usize| {
        let both = half(line, 0, pixels / 2).zip(half(line, pixels / 2, pixels));
        both.filter(|_| !beside_edge[line])
    };
    let found: Vec<(f64, f64)> = (1..lines.saturating_sub(1)).filter_map(halves).collect();
    if found.len() * 4 < lines {
        return 0.0;
    }
    let sums = robust::sigma(found.iter().map(|(first, second)| first + second));
    let differences = robust::sigma(found.iter().map(|(first, second)| first - second));
    // The covariance of the halves; the middle of two neighbours has offsets of its own.
    let variance = 0.25 * (sums * sums - differences * differences) / 1.5;
    variance.max(0.0).sqrt()
}

/// Those within a few lines of a step that is larger than offsets are.
fn lines_beside_edges(lines: usize, pixels: usize, at: &impl Fn(usize, usize) -> i32) -> Vec<bool> {
    const STEP_LEVELS: f64 = 15.0;
    const REACH: usize = 4;
    let mean = |line: usize, from: usize, to: usize| {
        (from..to).map(|pixel| f64::from(at(line, pixel))).sum::<f64>() / (to - from).max(1) as f64
    };
    let mut beside = vec![false; lines];
    for (from, to) in [(0, pixels / 2), (pixels / 2, pixels)] {
        let means: Vec<f64> = (0..lines).map(|line| mean(line, from, to)).collect();
        for (line, pair) in means.windows(2).enumerate() {
            if let [before, after] = pair
                && (after - before).abs() > STEP_LEVELS
            {
                beside[line.saturating_sub(REACH)..lines.min(line + REACH + 2)].fill(true);
            }
        }
    }
    beside
}
