//! Blocks of JPEG and of most video codecs: steps at every eighth column and row.

use super::grey::Grey;

const BLOCK: usize = 8;

/// By how much neighbours differ more across the borders of blocks than elsewhere, relative to there; the smaller of
/// columns and rows, since a codec has both.
pub(crate) fn excess(grey: &Grey<'_>, noise_sigma: f64) -> f64 {
    let most = (6.0 * noise_sigma + 6.0) as i32;
    let across_columns = phases(grey.columns, grey.rows, most, |column, row| grey.at(column, row));
    let across_rows = phases(grey.rows, grey.columns, most, |row, column| grey.at(column, row));
    excess_of(&across_columns).min(excess_of(&across_rows))
}

/// Mean size of the second difference over the border between a line and the next one, by the line's place in its
/// block.
fn phases(lines: usize, pixels: usize, most: i32, at: impl Fn(usize, usize) -> i32) -> [f64; BLOCK] {
    let mut sums = [(0_i64, 0_i64); BLOCK];
    for line in 1..lines.saturating_sub(2) {
        for pixel in 0..pixels {
            // What is left of a step where both sides go on as they are.
            let [a, b, c, d] = [line - 1, line, line + 1, line + 2].map(|line| at(line, pixel));
            let step = (3 * (c - b) - (d - a)).abs();
            if step <= 3 * most {
                let (sum, count) = &mut sums[line % BLOCK];
                *sum += i64::from(step);
                *count += 1;
            }
        }
    }
    sums.map(|(sum, count)| sum as f64 / count.max(1) as f64)
}

/// At the last line of a block, over the mean of those that lie farther inside.
fn excess_of(phases: &[f64; BLOCK]) -> f64 {
    let inner = phases[1..6].iter().sum::<f64>() / 5.0;
    if inner > 0.0 { phases[BLOCK - 1] / inner - 1.0 } else { 0.0 }
}
