//! [`FlickerMeter`]: the line time from the bands of a lamp.

use super::lamp::Lamp;
use super::line_time::{FlickerRefusal, LineTime};
use super::phasor::Phasor;
use super::spectrum::{Peak, Spectrum};
use super::tuning::{HARMONICS, LEAST_PERIODS, MOST_SCATTER, NEAR_A_MULTIPLE};
use crate::error::ParameterError;
use crate::range::chance_limit;
use crate::scalar::{Scalar, hypot, ln};

/// Takes the brightness of one row after the other, of a scene that a flickering lamp lights, and says the line time.
///
/// Bands are ν = F ℓ periods of the lamp in a row. From one frame to the next the scene stays and the bands move: the
/// difference of the logarithms of two frames is free of the scene, whatever it shows. Frames are taken in pairs, which
/// do not share their noise. Exposure and gain may change from frame to frame, the camera must stand still.
///
/// A lamp that flickers more than half a period in a row looks like a slower one: below that the line time is taken to
/// be, and [`with_frame_interval_s`](Self::with_frame_interval_s) makes sure.
///
/// *Memory*: two numbers for each of `ROWS` rows. *Cost*: a logarithm a row, and about 4 · rows² operations for each
/// second frame.
///
/// *Source*: docs/model.md, section 11.1.
///
/// ```
/// use shutter_range::calibrate::{FlickerMeter, Lamp};
/// let mut meter = FlickerMeter::<f32, 240>::new(240, Lamp::new(1000.0)?)?;
/// for frame in 0..4 {
///     for row in 0..240 {
///         // Yours: the mean of the row's pixels. Here a line time of 64 µs and 25.3 frames in a second.
///         let time_s = f64::from(row) * 64e-6 + f64::from(frame) / 25.3;
///         meter.row((30_000.0 + 9_000.0 * (time_s * 1000.0 * std::f64::consts::TAU).cos()) as u16);
///     }
///     meter.end_frame();
/// }
/// let found = meter.line_time()?;
/// assert!((found.line_time_us() - 64.0).abs() < 0.03 && found.sigma < 5e-4);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FlickerMeter<S, const ROWS: usize> {
    lamp: Lamp<S>,
    rows: u16,
    exposure_s: Option<S>,
    frame_interval_s: Option<S>,
    /// Logarithms of the first frame of a pair; row by row they become differences to the second.
    logarithms: [S; ROWS],
    /// Rows of the frame under way.
    filled: usize,
    is_second: bool,
    spectrum: Spectrum<S, ROWS>,
    fits: Fits<S>,
}

/// What the pairs say of the frequency near a peak: sums weighted by power, in periods in a frame about a reference.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Fits<S> {
    #[cfg_attr(feature = "defmt", defmt(Debug2Format))]
    peak: Option<Peak<S>>,
    count: u16,
    weight: S,
    deviation: S,
    square: S,
}

/// The darkest row whose logarithm is taken, in 1/256 grey level: one level.
const DARKEST_Q8: u16 = 256;

/// Of the taper (Hann), with n rows and w its values: ¼ π⁻² Σw²y² (Σw)²/(2 Σw² (Σwy²)²) n² is the variance of the
/// frequency in squared periods in a frame, where power and noise of the peak are alike.
const VARIANCE: (i32, i32) = (2_374, 10_000);

/// Of the same taper: something else at a distance of d periods in a frame, with the same amplitude and any phase,
/// moves the frequency by 0.55/(d (d² − 1)), as a root mean square.
const LEAKAGE: (i32, i32) = (55, 100);

/// Pairs beyond which their own scatter is a better sigma than the floor of the spectrum, in which the many harmonics
/// of a pulsed lamp pass for noise (`two_sigma_hold_what_they_say`).
const ENOUGH_PAIRS: u16 = 4;

/// Steps of Newton's method; two suffice from within a tenth of a period.
const STEPS: usize = 4;

impl<S: Scalar, const ROWS: usize> FlickerMeter<S, ROWS> {
    /// For frames of so many rows.
    ///
    /// *Errors*: fewer than 32 rows, or more than there is room for.
    pub fn new(rows: u16, lamp: Lamp<S>) -> Result<Self, ParameterError> {
        if rows < 32 || usize::from(rows) > ROWS {
            return Err(ParameterError::new("rows", rows.into(), "at least 32, at most ROWS"));
        }
        Ok(Self {
            lamp,
            rows,
            exposure_s: None,
            frame_interval_s: None,
            logarithms: [S::ZERO; ROWS],
            filled: 0,
            is_second: false,
            spectrum: Spectrum::new(rows),
            fits: Fits::about(None),
        })
    }

    /// The same with a known exposure of a row, which may explain why there are no bands.
    ///
    /// *Errors*: an exposure that is not above zero and at most 60 s.
    pub fn with_exposure_s(self, exposure_s: S) -> Result<Self, ParameterError> {
        Ok(Self { exposure_s: Some(checked("exposure_s", exposure_s)?), ..self })
    }

    /// The same with the time from the start of a frame to that of the next, which its rows must fit into.
    ///
    /// *Errors*: an interval that is not above zero and at most 60 s.
    pub fn with_frame_interval_s(self, frame_interval_s: S) -> Result<Self, ParameterError> {
        Ok(Self { frame_interval_s: Some(checked("frame_interval_s", frame_interval_s)?), ..self })
    }

    /// The mean of the next row's pixels, in 1/256 grey level; rows in the order of readout. More rows than a frame has
    /// spoil the frame.
    pub fn row(&mut self, mean_q8: u16) {
        let logarithm = ln(S::from_ratio(mean_q8.max(DARKEST_Q8).into(), 256));
        if let Some(slot) = self.logarithms.get_mut(self.filled).filter(|_| self.filled < usize::from(self.rows)) {
            *slot = if self.is_second { logarithm - *slot } else { logarithm };
        }
        self.filled = self.filled.saturating_add(1);
    }

    /// The pixels of the next row.
    pub fn row_of_pixels(&mut self, pixels: &[u8]) {
        let sum: u64 = pixels.iter().map(|pixel| u64::from(*pixel)).sum();
        let mean_q8 = (sum * 256 + pixels.len() as u64 / 2).checked_div(pixels.len() as u64).unwrap_or(0);
        self.row(u16::try_from(mean_q8).unwrap_or(u16::MAX));
    }

    /// Ends the frame. One with rows missing or too many is left out.
    pub fn end_frame(&mut self) {
        let is_whole = self.filled == usize::from(self.rows);
        self.filled = 0;
        let is_pair = is_whole && self.is_second;
        self.is_second = is_whole && !self.is_second;
        if is_pair {
            self.take_pair();
        }
    }

    /// The line time from the frames so far.
    ///
    /// *Errors*: [`FlickerRefusal`] says why there is none.
    pub fn line_time(&self) -> Result<LineTime<S>, FlickerRefusal<S>> {
        if self.spectrum.pairs == 0 {
            return Err(FlickerRefusal::TooFewFrames);
        }
        let Some(peak) = self.fits.peak.filter(|peak| peak.is_significant && self.fits.count > 0) else {
            return Err(self.without_bands());
        };
        let (periods, sigma_periods, scatter) = self.periods(&peak);
        if !(periods >= S::from_i32(LEAST_PERIODS)) {
            return Err(FlickerRefusal::TooFewPeriods { periods });
        }
        if scatter > S::from_i32(MOST_SCATTER) {
            return Err(FlickerRefusal::Inconsistent { scatter });
        }
        let line_time_ps = self.line_time_ps(periods);
        let or_ps = self.line_time_ps(S::from_i32(self.rows.into()) - periods);
        if self.frame_interval_s.is_some_and(|interval_s| self.fits_into(or_ps, interval_s)) {
            return Err(FlickerRefusal::Ambiguous { line_time_ps, or_ps });
        }
        Ok(LineTime {
            line_time_ps,
            sigma: hypot(sigma_periods / periods, self.lamp.sigma()).min(S::ONE),
            periods,
            pairs: self.fits.count,
            scatter,
            rows: self.rows,
        })
    }

    fn without_bands(&self) -> FlickerRefusal<S> {
        let periods = self.exposure_s.map_or(S::ZERO, |exposure_s| exposure_s * self.lamp.frequency_hz());
        let whole = (periods.to_f64() + 0.5) as u32;
        let off = (periods - S::from_f64(whole.into())).abs();
        if whole > 0 && off < S::ratio(NEAR_A_MULTIPLE.0, NEAR_A_MULTIPLE.1) {
            FlickerRefusal::ExposureOfPeriods { periods: whole }
        } else {
            FlickerRefusal::NoBands
        }
    }

    fn line_time_ps(&self, periods: S) -> u64 {
        let line_time_s = periods.to_f64() / f64::from(self.rows) / self.lamp.frequency_hz().to_f64();
        (line_time_s * 1e12 + 0.5) as u64
    }

    fn fits_into(&self, line_time_ps: u64, interval_s: S) -> bool {
        line_time_ps as f64 * 1e-12 * f64::from(self.rows) <= interval_s.to_f64()
    }

    /// The differences of two whole frames: into the spectrum, and near its peak into the sums.
    fn take_pair(&mut self) {
        let rows = usize::from(self.rows);
        let Some(differences) = self.logarithms.get_mut(..rows) else { return };
        taper(differences);
        self.spectrum.add(differences);
        let peak = self.spectrum.peak();
        let is_same = match (&self.fits.peak, &peak) {
            (Some(before), Some(now)) => Spectrum::<S, ROWS>::is_same(before, now),
            _ => false,
        };
        // What the pairs so far said of another peak is of no use.
        let reference = if is_same { self.fits.peak } else { peak };
        if !is_same {
            self.fits = Fits::about(peak);
        }
        if let Some(about) = reference {
            if let Some((deviation, power)) = refined(differences, about.periods) {
                self.fits.add(deviation, power);
            }
            let is_significant = peak.is_some_and(|peak| peak.is_significant);
            self.fits.peak = Some(Peak { is_significant, ..about });
        }
    }

    /// Periods in a frame with their sigma, and how the pairs scatter.
    fn periods(&self, peak: &Peak<S>) -> (S, S, S) {
        let fits = &self.fits;
        let mean = fits.deviation / fits.weight;
        let pairs = S::from_i32(fits.count.into());
        let spare = pairs - S::ONE;
        let floor = self.spectrum.floor_at(peak) / S::from_i32(self.spectrum.pairs.max(1).into());
        let leakage = self.leakage(peak);
        // Variances of one pair: as noise and leakage have it, and as the pairs scatter.
        let expected = S::ratio(VARIANCE.0, VARIANCE.1) * floor * pairs / fits.weight + leakage * leakage;
        let squares = (fits.square - fits.deviation * mean).max(S::ZERO) * pairs / fits.weight;
        let seen = if spare > S::ZERO { squares / spare } else { expected };
        let of_pair = if fits.count > ENOUGH_PAIRS {
            // Student's law is wider than the normal one.
            squares / (spare - S::from_i32(2))
        } else if spare > S::ZERO && seen > expected * chance_limit(spare, S::from_i32(2)) {
            seen
        } else {
            expected
        };
        (peak.periods + mean, hypot((of_pair / pairs).sqrt(), leakage), (seen / expected).sqrt())
    }

    /// What the mirror image of the bands and their harmonics do to the frequency.
    fn leakage(&self, peak: &Peak<S>) -> S {
        let of = |ratio: S, distance: S| {
            let distance = distance.max(S::from_i32(2));
            S::ratio(LEAKAGE.0, LEAKAGE.1) * ratio / distance / (distance * distance - S::ONE)
        };
        let of_image = of(S::ONE, peak.periods + peak.periods);
        (2..=HARMONICS)
            .map(|h| self.spectrum.harmonic(peak, h))
            .fold(of_image, |sum, (ratio, distance)| hypot(sum, of(ratio, distance)))
    }
}

impl<S: Scalar> Fits<S> {
    fn about(peak: Option<Peak<S>>) -> Self {
        Self { peak, count: 0, weight: S::ZERO, deviation: S::ZERO, square: S::ZERO }
    }

    fn add(&mut self, deviation: S, power: S) {
        self.count = self.count.saturating_add(1);
        self.weight = self.weight + power;
        self.deviation = self.deviation + power * deviation;
        self.square = self.square + power * deviation * deviation;
    }
}

fn checked<S: Scalar>(name: &'static str, seconds: S) -> Result<S, ParameterError> {
    if seconds > S::ZERO && seconds <= S::from_i32(60) {
        Ok(seconds)
    } else {
        Err(ParameterError::new(name, seconds.to_f64(), "above 0, at most 60 (s)"))
    }
}

/// Takes out mean and slope, which are those of the light at large, and tapers both ends (Hann).
fn taper<S: Scalar>(values: &mut [S]) {
    let rows = S::from_i32(values.len() as i32);
    let weights = weights::<S>(values.len());
    let [mut w, mut wv, mut wyy, mut wyv] = [S::ZERO; 4];
    for ((weight, y), value) in weights.clone().zip(values.iter()) {
        let wy = weight * y;
        (w, wv, wyy, wyv) = (w + weight, wv + weight * *value, wyy + wy * y, wyv + wy * *value);
    }
    let (mean, slope) = (wv / w, wyv / wyy);
    // So that the power of a peak does not depend on the number of rows.
    let scale = S::from_i32(4) / rows;
    for ((weight, y), value) in weights.zip(values.iter_mut()) {
        *value = (*value - mean - slope * y) * weight * scale;
    }
}

/// Weight of each row and its place, −½ to ½.
fn weights<S: Scalar>(rows: usize) -> impl Iterator<Item = (S, S)> + Clone {
    let rows = (rows as i64).max(1);
    let half = S::ratio(1, 2);
    let step = Phasor::of_turns(S::from_ratio(1, rows));
    let first = Phasor::of_turns(S::from_ratio(1 - rows, 2 * rows));
    let turned = core::iter::successors(Some(first), move |turned| Some(turned.times(step)));
    let places = (0..rows).map(move |row| S::from_ratio(2 * row + 1 - rows, 2 * rows));
    turned.zip(places).map(move |(turned, place)| ((S::ONE + turned.re) * half, place))
}

/// The frequency near one at which tapered values have most power, as a deviation from it in periods in a frame, and
/// that power. `None` where it runs away: there is no peak in these values.
fn refined<S: Scalar>(tapered: &[S], periods: S) -> Option<(S, S)> {
    let rows = S::from_i32(tapered.len() as i32);
    let turn = S::from_ratio(6_283_185_307, 1_000_000_000);
    let (mut deviation, mut power) = (S::ZERO, S::ZERO);
    for _ in 0..STEPS {
        let step = Phasor::of_turns(-(periods + deviation) / rows);
        // Sums of the values, and of them times place and its square.
        let (mut x0, mut x1, mut x2) = (Phasor::ZERO, Phasor::ZERO, Phasor::ZERO);
        let mut turned = Phasor::ONE;
        for (value, (_, place)) in tapered.iter().zip(weights::<S>(tapered.len())) {
            let term = turned.scaled(*value);
            (x0, x1, x2) = (x0.plus(term), x1.plus(term.scaled(place)), x2.plus(term.scaled(place * place)));
            turned = turned.times(step);
        }
        // Half the first and, but for its sign, the second derivative of |X|² by the phase between the ends.
        let slope = x0.re * x1.im - x0.im * x1.re;
        let bend = x0.along(x2) - x1.power();
        deviation = deviation + slope / bend / turn;
        if !(bend > S::ZERO && deviation.abs() < S::ONE) {
            return None;
        }
        power = x0.power();
    }
    Some((deviation, power))
}
