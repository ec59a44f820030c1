//! How a frame uses its grey levels.

use super::grey::Grey;

pub(crate) struct Levels {
    /// Shares of the pixels that are black or white.
    pub(crate) clipped_dark: f64,
    pub(crate) clipped_bright: f64,
    /// Of the levels between the darkest and the brightest that a thousandth of the pixels reach.
    pub(crate) used: usize,
    pub(crate) span: usize,
    pub(crate) darkest: usize,
    pub(crate) brightest: usize,
}

pub(crate) fn of(grey: &Grey<'_>) -> Levels {
    let mut counts = [0_usize; 256];
    for level in grey.levels() {
        counts[usize::from(*level)] += 1;
    }
    let all = grey.levels().len().max(1);
    let few = all / 1000;
    let reaches = |count: &usize| *count > 0;
    let mut below = 0;
    let mut after_few = |count: &usize| {
        below += count;
        below > few
    };
    let darkest = counts.iter().position(&mut after_few).unwrap_or(0);
    below = 0;
    let mut after_few = |count: &usize| {
        below += count;
        below > few
    };
    let brightest = 255 - counts.iter().rev().position(&mut after_few).unwrap_or(0);
    let inner = counts.get(darkest..=brightest).unwrap_or_default();
    Levels {
        clipped_dark: counts[0] as f64 / all as f64,
        clipped_bright: counts[255] as f64 / all as f64,
        used: inner.iter().filter(|count| reaches(count)).count(),
        span: inner.len(),
        darkest,
        brightest,
    }
}
