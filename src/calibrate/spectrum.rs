//! [`Spectrum`]: powers of the bands at all frequencies, summed over pairs of frames, and which of them is the
//! fundamental.

use heapless::Vec;

use super::phasor::Phasor;
use super::tuning::{CANDIDATES, FAMILY, HARMONICS, LEAST_PERIODS, LEAST_SHARE, PEAK_SIGMAS};
use crate::range::chance_limit;
use crate::scalar::Scalar;

/// Bins are half a period in a frame apart: the main lobe of the taper is eight of them wide.
const BINS_PER_PERIOD: i32 = 2;
/// The lobe's half width, beyond which a peak has ended.
const LOBE_BINS: usize = 4;
/// A peak's own floor is that of the bins from here to there on either side.
const FLOOR_BINS: (usize, usize) = (6, 16);

/// Power in bins of half a period in a frame, from zero to half a period in a row.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Spectrum<S, const ROWS: usize> {
    power: [S; ROWS],
    rows: u16,
    pub(super) pairs: u16,
}

/// The peak that is taken for the fundamental.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Peak<S> {
    pub(super) bin: usize,
    /// Periods in a frame, to about a tenth.
    pub(super) periods: S,
    /// Whether it exceeds the floor by more than chance allows.
    pub(super) is_significant: bool,
}

impl<S: Scalar, const ROWS: usize> Spectrum<S, ROWS> {
    pub(super) const fn new(rows: u16) -> Self {
        Self { power: [S::ZERO; ROWS], rows, pairs: 0 }
    }

    /// Adds that of one more pair: its tapered differences, in the order of rows.
    ///
    /// *Cost*: a complex product and a sum for each row and bin.
    pub(super) fn add(&mut self, tapered: &[S]) {
        let bins = i64::from(self.rows) * i64::from(BINS_PER_PERIOD);
        for (bin, power) in (0_i64..).zip(&mut self.power).take(self.rows.into()) {
            let step = Phasor::of_turns(S::from_ratio(bin, bins));
            let (sum, _) = tapered.iter().fold((Phasor::ZERO, Phasor::ONE), |(sum, turned), value| {
                (sum.plus(turned.scaled(*value)), turned.times(step))
            });
            *power = *power + sum.power();
        }
        self.pairs = self.pairs.saturating_add(1);
    }

    /// The fundamental of the strongest family of harmonics; that of bands too wide to tell only where there is none
    /// else.
    pub(super) fn peak(&self) -> Option<Peak<S>> {
        let floor = self.white_floor();
        let least = (LEAST_PERIODS * BINS_PER_PERIOD) as usize;
        let narrow = self.fundamental(least, floor).map(|bin| self.peak_at(bin, floor));
        narrow.filter(|peak| peak.is_significant).or_else(|| {
            let wide = self.fundamental(1, floor).map(|bin| self.peak_at(bin, floor));
            wide.filter(|peak| peak.is_significant).or(narrow)
        })
    }

    /// Power of noise at a peak: that of the whole spectrum, or that around it where it is clearly more.
    pub(super) fn floor_at(&self, peak: &Peak<S>) -> S {
        self.floor(peak.bin, self.white_floor())
    }

    /// Amplitude at the harmonic `h` of a frequency in periods in a frame, relative to that at the frequency itself,
    /// and the distance of the two in periods in a frame.
    pub(super) fn harmonic(&self, peak: &Peak<S>, h: i32) -> (S, S) {
        let bin = self.harmonic_bin(peak.bin, h);
        let distance = S::ratio(bin.abs_diff(peak.bin) as i32, BINS_PER_PERIOD);
        let own = self.lobe_power(peak.bin);
        let above = (self.lobe_power(bin) - self.floor_at(peak)).max(S::ZERO);
        let ratio = if own > S::ZERO { (above / own).sqrt().min(S::ONE) } else { S::ZERO };
        (ratio, distance)
    }

    fn used(&self) -> &[S] {
        self.power.get(..usize::from(self.rows)).unwrap_or_default()
    }

    fn power_at(&self, bin: usize) -> S {
        self.used().get(bin).copied().unwrap_or(S::ZERO)
    }

    /// The highest of the bins around one, within what rounding to bins and harmonics' multiples of it can move a peak.
    fn lobe_power(&self, bin: usize) -> S {
        (bin.saturating_sub(2)..=bin + 2).map(|near| self.power_at(near)).fold(S::ZERO, S::max)
    }

    /// Median, as a mean: of the sum of n exponential variates the median is n − 1/3 times their mean, nearly.
    fn white_floor(&self) -> S {
        let middle = self.used().len() / 2;
        let below = |limit: S| self.used().iter().filter(|power| **power < limit).count();
        let (mut low, mut high) = (S::ZERO, self.used().iter().copied().fold(S::ZERO, S::max));
        // To a part in 2²⁰ of the highest, and further while that is coarse: 40 halvings.
        for _ in 0..40 {
            let half = (low + high) * S::ratio(1, 2);
            if below(half) > middle { high = half } else { low = half }
        }
        let pairs = i32::from(self.pairs.max(1));
        high * S::from_i32(pairs) / (S::from_i32(pairs) - S::ratio(1, 3) + S::ratio(1, 50) / S::from_i32(pairs))
    }

    fn floor(&self, bin: usize, white: S) -> S {
        let (near, far) = FLOOR_BINS;
        let is_of_harmonic = |other: usize| {
            (0..=HARMONICS).any(|h| h != 1 && self.harmonic_bin(bin, h).abs_diff(other) <= LOBE_BINS + 1)
        };
        let (mut sum, mut count) = (S::ZERO, 0);
        for distance in near..=far {
            for other in [bin.checked_sub(distance), Some(bin + distance)].into_iter().flatten() {
                if other < self.used().len() && !is_of_harmonic(other) {
                    (sum, count) = (sum + self.power_at(other), count + 1);
                }
            }
        }
        let local = sum / S::from_i32(i32::max(count, 1));
        // The bins around tell the floor to about 1/√(count · pairs / 2), one sigma: two bins are hardly independent.
        let scatter = S::ONE / S::from_i32(i32::max(count * i32::from(self.pairs) / 2, 1)).sqrt();
        if local > white * (S::ONE + S::from_i32(4) * scatter) { local } else { white }
    }

    /// Where the harmonic `h` of a bin shows: beyond half a period in a row it is folded back.
    fn harmonic_bin(&self, bin: usize, h: i32) -> usize {
        let turn = 2 * usize::from(self.rows);
        let folded = (bin * h.unsigned_abs() as usize).checked_rem(turn).unwrap_or(0);
        folded.min(turn - folded)
    }

    /// Power of those of the peaks that are harmonics of one of them, each where it shows.
    fn family_power(&self, bin: usize, peaks: &[usize]) -> S {
        let turn_q8 = i64::from(self.rows) << (8 + BINS_PER_PERIOD.ilog2());
        let at_q8 = ((bin as i64) << 8) + (self.vertex(bin).to_f64() * 256.0) as i64;
        let is_harmonic = |other: usize| {
            (1..=i64::from(FAMILY)).any(|h| {
                let folded_q8 = (at_q8 * h).checked_rem(turn_q8).unwrap_or(0);
                let shown_q8 = folded_q8.min(turn_q8 - folded_q8);
                shown_q8.abs_diff((other as i64) << 8) <= (LOBE_BINS as u64) << 7
            })
        };
        let harmonics = peaks.iter().filter(|other| is_harmonic(**other));
        harmonics.fold(S::ZERO, |sum, other| sum + self.power_at(*other))
    }

    /// The highest local maxima from a bin on, the highest first.
    fn candidates(&self, from: usize) -> Vec<usize, CANDIDATES> {
        let mut peaks: Vec<usize, CANDIDATES> = Vec::new();
        for bin in from..self.used().len() {
            let power = self.power_at(bin);
            let around = bin.saturating_sub(LOBE_BINS)..=bin + LOBE_BINS;
            if around.filter(|other| *other >= from && *other != bin).any(|other| self.power_at(other) >= power) {
                continue;
            }
            if peaks.is_full() && peaks.last().is_some_and(|last| self.power_at(*last) < power) {
                peaks.pop();
            }
            let at = peaks.iter().position(|other| self.power_at(*other) < power).unwrap_or(peaks.len());
            let _ = peaks.insert(at, bin);
        }
        peaks
    }

    /// The candidate whose harmonics have most of the power; among equals, since folded harmonics may fall onto each
    /// other, the one with more power of its own. That must stand out of the floor.
    fn fundamental(&self, from: usize, floor: S) -> Option<usize> {
        let candidates = self.candidates(from);
        let share = S::ratio(LEAST_SHARE.0, LEAST_SHARE.1);
        let mut best: Option<(S, usize)> = None;
        for bin in candidates.iter().copied() {
            let family = self.family_power(bin, &candidates);
            let is_least = self.power_at(bin) < family * share || self.power_at(bin) < floor * self.significance();
            if is_least && best.is_some() {
                continue;
            }
            if best.is_none_or(|(most, _)| family > most + most * share) {
                best = Some((family, bin));
            }
        }
        best.map(|(_, bin)| bin)
    }

    /// How far above the floor a peak must be, as a factor.
    fn significance(&self) -> S {
        chance_limit(S::from_i32(2 * i32::from(self.pairs.max(1))), S::from_i32(PEAK_SIGMAS))
    }

    fn peak_at(&self, bin: usize, white: S) -> Peak<S> {
        let power = self.power_at(bin);
        let is_significant = power > self.floor(bin, white) * self.significance() && power > S::ZERO;
        let at = S::from_i32(bin as i32) + self.vertex(bin);
        Peak { bin, periods: at * S::ratio(1, BINS_PER_PERIOD), is_significant }
    }

    /// Where a parabola through a bin and its neighbours has its vertex, from the bin: half a bin off at most.
    fn vertex(&self, bin: usize) -> S {
        let [before, middle, after] = [bin.wrapping_sub(1), bin, bin + 1].map(|near| self.power_at(near));
        let bend = middle + middle - before - after;
        let half = S::ratio(1, 2);
        if bend > S::ZERO { ((after - before) * half / bend).max(-half).min(half) } else { S::ZERO }
    }

    /// Whether two peaks are the same one.
    pub(super) fn is_same(a: &Peak<S>, b: &Peak<S>) -> bool {
        a.bin.abs_diff(b.bin) <= LOBE_BINS / 2
    }
}
