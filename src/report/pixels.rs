//! [`PixelReport`]: what the pixels of a frame say of their format.

use super::suspicion::Suspicion;

/// Counts the grey levels of a frame row by row, and tells when they are no picture.
///
/// *Cost*: 1 KB; a few instructions a pixel, so look at one frame in a while.
///
/// ```
/// use shutter_range::{PixelReport, Suspicion};
/// let mut report = PixelReport::new();
/// for _ in 0..240 {
///     report.row(&[16; 320]);
/// }
/// assert_eq!(report.suspicions().next(), Some(Suspicion::FewLevels { darkest: 16, brightest: 16 }));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PixelReport {
    counts: [u32; 256],
    rows: u32,
    alternating_rows: u32,
}

/// Grey levels between the darkest and the brightest pixel of a picture, and between a pixel and its neighbours where
/// columns alternate.
const LEAST_LEVELS: u8 = 4;

/// One pixel in so many may be hot.
const HOT: u32 = 1000;

impl PixelReport {
    /// Of no row yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { counts: [0; 256], rows: 0, alternating_rows: 0 }
    }

    /// Counts a row of the frame.
    pub fn row(&mut self, pixels: &[u8]) {
        for level in pixels {
            if let Some(count) = self.counts.get_mut(usize::from(*level)) {
                *count = count.saturating_add(1);
            }
        }
        self.rows = self.rows.saturating_add(1);
        self.alternating_rows = self.alternating_rows.saturating_add(u32::from(alternates(pixels)));
    }

    /// What is wrong with the pixels.
    pub fn suspicions(&self) -> impl Iterator<Item = Suspicion> {
        let alternate = self.alternating_rows > self.rows / 2;
        self.few_levels().into_iter().chain(alternate.then_some(Suspicion::AlternatingColumns))
    }

    fn few_levels(&self) -> Option<Suspicion> {
        let few = self.counts.iter().fold(0_u32, |sum, count| sum.saturating_add(*count)) / HOT;
        let darkest = level_after(self.counts.iter(), few)?;
        let brightest = 255 - level_after(self.counts.iter().rev(), few)?;
        (brightest.saturating_sub(darkest) < LEAST_LEVELS).then_some(Suspicion::FewLevels { darkest, brightest })
    }
}

impl Default for PixelReport {
    fn default() -> Self {
        Self::new()
    }
}

/// The first level up to which there are more than `few` pixels.
fn level_after<'a>(counts: impl Iterator<Item = &'a u32>, few: u32) -> Option<u8> {
    let mut sum = 0_u32;
    for (level, count) in (0..=u8::MAX).zip(counts) {
        sum = sum.saturating_add(*count);
        if sum > few {
            return Some(level);
        }
    }
    None
}

/// Whether nearly all pixels of a row differ from both of their neighbours, with signs that alternate.
fn alternates(row: &[u8]) -> bool {
    let (mut even, mut odd) = (0_usize, 0_usize);
    for (index, pixels) in row.windows(3).enumerate() {
        if let [left, middle, right] = *pixels {
            let above = 2 * i32::from(middle) - i32::from(left) - i32::from(right);
            if above.abs() >= i32::from(LEAST_LEVELS) {
                // The higher one of each pair of columns.
                let higher = if (index % 2 == 0) == (above > 0) { &mut even } else { &mut odd };
                *higher += 1;
            }
        }
    }
    even.max(odd).saturating_mul(10) > row.len().saturating_mul(7)
}
