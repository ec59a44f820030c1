//! [`StepSums`]: column, width and contrast of a step, from the difference of two windows that slides over it.

use super::root::root;
use super::scanned_point::ScannedPoint;

/// Two windows side by side whose difference slides over a row.
pub(super) struct Windows {
    /// Pixels of either, as a power of two.
    log2: u32,
    /// By how much they blur a step by themselves: a variance in 1/65536 px².
    variance_q16: u32,
}

impl Windows {
    /// Of two or four pixels each.
    pub(super) const fn of(pixels: u32) -> Self {
        Self { log2: pixels.ilog2(), variance_q16: ((pixels * pixels - 1) << 16) / 6 }
    }
}

/// Sums over differences of one sign, of which a step makes as many as two windows have pixels. In 32 bits for 128
/// differences of windows of four pixels.
#[derive(Clone, Copy)]
pub(super) struct StepSums {
    area: u32,
    moment: u32,
    second: u32,
}

impl StepSums {
    /// Of the first difference.
    pub(super) const fn first(size: i32) -> Self {
        Self { area: size as u32, moment: 0, second: 0 }
    }

    /// Adds the difference at so many positions after the first one.
    pub(super) const fn add(&mut self, size: i32, offset: u32) {
        let moment = size as u32 * offset;
        self.area += size as u32;
        self.moment += moment;
        self.second += moment * offset;
    }

    /// The step that `length` differences of windows show. Position k is the boundary between pixels k − 1 and k; `start`
    /// is the first one.
    #[inline(never)] // held once
    pub(super) fn point(
        &self,
        windows: &Windows,
        start: usize,
        length: u32,
        sign: i32,
        noise_q8: u32,
    ) -> Option<ScannedPoint> {
        // Each pixel of one window is once beside each of the other.
        let contrast = (self.area + (1 << (2 * windows.log2 - 1))) >> (2 * windows.log2);
        let off_q16 = ratio_q16(self.moment, self.area);
        let column_q16 = ((start as i64) << 16) + i64::from(off_q16) - (1 << 15);
        let square_q16 = (u64::from(off_q16) * u64::from(off_q16)) >> 16;
        let variance_q16 = ratio_q16(self.second, self.area).saturating_sub(square_q16 as u32);
        // Not below the blur of a pixel alone.
        let blur_q16 = variance_q16.saturating_sub(windows.variance_q16).max(1 << 13);
        let root_q4 = root(length << 8);
        let sigma_q16 = ((noise_q8 << 4).saturating_mul(root_q4)).checked_div(contrast.max(1)).unwrap_or(u32::MAX);
        Some(ScannedPoint {
            column_q16: i32::try_from(column_q16).ok()?,
            sigma_q16: sigma_q16.max(1),
            width_q8: u16::try_from(root(blur_q16)).ok()?,
            contrast: i16::try_from(contrast as i32 * sign).ok()?,
        })
    }
}

/// A quotient in 1/65536 whose whole part and divisor have at most 16 and 20 bits: what 64-bit division would cost ten
/// times on small cores.
fn ratio_q16(numerator: u32, denominator: u32) -> u32 {
    let split = |numerator: u32| Some((numerator.checked_div(denominator)?, numerator.checked_rem(denominator)?));
    let parts = |rest: u32| split(rest << 8);
    split(numerator)
        .and_then(|(whole, rest)| {
            let (upper, rest) = parts(rest)?;
            let (lower, _) = parts(rest)?;
            Some((whole << 16) + (upper << 8) + lower)
        })
        .unwrap_or(0)
}
