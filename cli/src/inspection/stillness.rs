//! [`share_moved`]: whether a scene stands still while its light changes.

use image::GrayImage;

use super::robust::median;

/// Pixels that are white say nothing of the light.
const WHITE: u8 = 250;

/// How far beyond the noise a pixel must change: so many times the median change, and levels. Of normal noise that is
/// more than five sigma.
const BEYOND: (f64, f64) = (8.0, 4.0);

/// Share of the pixels that change from one frame to the next by more than noise and light explain: light that flickers
/// changes each row as a whole.
pub(crate) fn share_moved(before: &GrayImage, after: &GrayImage) -> f64 {
    let columns = before.width().max(1) as usize;
    let rows = before.as_raw().chunks(columns).zip(after.as_raw().chunks(columns));
    let changes: Vec<f64> = rows.flat_map(|(before, after)| changes(before, after)).collect();
    if changes.is_empty() {
        return 0.0;
    }
    let (times, levels) = BEYOND;
    let most = times * median(changes.iter().copied()) + levels;
    changes.iter().filter(|change| **change > most).count() as f64 / changes.len() as f64
}

/// Of a row's pixels, beyond that of the row as a whole: half the difference where both frames are alike, and not more
/// of the noise where one of them is dark.
fn changes(before: &[u8], after: &[u8]) -> Vec<f64> {
    let sound = || before.iter().zip(after).filter(|(before, after)| **before < WHITE && **after < WHITE);
    let pairs = || sound().map(|(before, after)| (f64::from(*before), f64::from(*after)));
    // One level more, so that black divides.
    let (of_before, of_after) = pairs().fold((1.0, 1.0), |(a, b), (before, after)| (a + before, b + after));
    pairs().map(|(before, after)| (after * of_before - before * of_after).abs() / (of_before + of_after)).collect()
}
