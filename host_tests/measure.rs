//! `measure`: periods from stamps with jitter, late and missed interrupts and counters that turn over.

use proptest::prelude::*;
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, Normal};
use shutter_range::ReadoutDirection;
use shutter_range::measure::{FrameStart, Period, PeriodMeter, StampFate, Timer};

use crate::scenes::seeded;

/// An interrupt with all that can go wrong, seen by a counter.
#[derive(Clone, Copy)]
struct Interrupts {
    bits: u8,
    hz: u32,
    period_ticks: f64,
    /// One sigma of every stamp's delay.
    jitter_ticks: f64,
    /// Share of interrupts that are late, by up to so many sigma or half a period.
    late: f64,
    /// Share that never comes.
    missed: f64,
}

const LINES: Interrupts =
    Interrupts { bits: 16, hz: 48_000_000, period_ticks: 3136.37, jitter_ticks: 6.0, late: 0.0, missed: 0.0 };

impl Interrupts {
    fn timer(&self) -> Timer {
        Timer::new(self.bits, self.hz).expect("sound").with_tolerance_ppm(0)
    }

    fn meter(&self) -> PeriodMeter {
        PeriodMeter::new(self.timer())
    }

    fn period_ps(&self) -> f64 {
        self.period_ticks / f64::from(self.hz) * 1e12
    }

    /// The counter at interrupts `first` to `last`, the phase being that of the seed.
    fn stamps(&self, seed: u64, numbers: std::ops::Range<u32>) -> Vec<u32> {
        let mut rng = StdRng::seed_from_u64(seed);
        let phase = rng.random_range(0.0..1e6);
        let jitter = Normal::new(0.0, self.jitter_ticks).expect("sound");
        let mut stamps = Vec::new();
        for number in numbers {
            let mut ticks = phase + 1e5 + f64::from(number) * self.period_ticks + jitter.sample(&mut rng);
            if rng.random_bool(self.late) {
                let latest = (100.0 * self.jitter_ticks).min(self.period_ticks / 2.0);
                ticks += rng.random_range(12.0 * self.jitter_ticks..latest);
            }
            if !rng.random_bool(self.missed) {
                stamps.push((ticks.floor() as u64 & ((1 << self.bits) - 1)) as u32);
            }
        }
        stamps
    }

    fn measure(&self, mut meter: PeriodMeter, seed: u64, count: u32) -> Period {
        for stamp in self.stamps(seed, 0..count) {
            meter.push(stamp);
        }
        meter.period().expect("enough stamps")
    }

    /// Error in sigma.
    fn error(&self, period: &Period) -> f64 {
        (period.period_ps as f64 - self.period_ps()) / period.sigma_ps as f64
    }
}

/// Share of seeds whose error is within two sigma, and the root mean square of error / sigma.
fn coverage(interrupts: &Interrupts, meter: &PeriodMeter, count: u32, seeds: u64) -> (f64, f64) {
    let errors = (0..seeds).map(|seed| interrupts.error(&interrupts.measure(meter.clone(), seed, count)));
    let errors: Vec<f64> = errors.collect();
    let within = errors.iter().filter(|error| error.abs() <= 2.0).count() as f64 / seeds as f64;
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    (within, (squares / seeds as f64).sqrt())
}

const SEEDS: u64 = 4000;

#[test]
fn two_sigma_hold_what_they_say() {
    let cases = [
        ("half a frame of lines", LINES, 240),
        ("sixteen lines", LINES, 16),
        ("three frames of lines", LINES, 1440),
        ("with late and missed ones", Interrupts { late: 0.03, missed: 0.05, ..LINES }, 480),
        ("in whole ticks of a slow counter", Interrupts { period_ticks: 65.4, jitter_ticks: 0.6, ..LINES }, 480),
        ("frames", Interrupts { bits: 32, period_ticks: 1.6e6, jitter_ticks: 200.0, ..LINES }, 30),
    ];
    for (name, interrupts, count) in cases {
        let (within, rms) = coverage(&interrupts, &interrupts.meter(), count, SEEDS);
        assert!((0.93..=0.97).contains(&within), "{name}: {within}, rms {rms}");
        assert!((0.93..=1.07).contains(&rms), "{name}: {rms}");
    }
}

#[test]
fn a_few_stamps_rest_on_the_jitter_that_is_stated() {
    let meter = LINES.meter().with_jitter_ticks(6);
    for count in 2..=4 {
        let (within, rms) = coverage(&LINES, &meter, count, SEEDS);
        assert!((0.93..=0.97).contains(&within), "{count} stamps: {within}, rms {rms}");
    }
}

#[test]
fn scatter_that_few_stamps_show_widens_sigma() {
    for count in 6..=10 {
        let (within, rms) = coverage(&LINES, &LINES.meter(), count, SEEDS);
        assert!(within >= 0.93, "{count} stamps: {within}, rms {rms}");
    }
}

#[test]
fn two_stamps_are_enough_for_a_period_but_one_is_not() {
    let mut meter = LINES.meter();
    meter.push(65_000);
    assert_eq!(meter.period(), None);
    meter.push((65_000 + 3136) & 0xffff);
    let period = meter.period().expect("two");
    assert_eq!((period.period_ps, period.stamps, period.missed), (65_333_333, 2, 0));
    // Both are rounded to a tick of 20.8 ns.
    assert!((8000..9000).contains(&period.sigma_ps), "{}", period.sigma_ps);
}

#[test]
fn late_interrupts_and_missed_ones_do_no_harm() {
    let interrupts = Interrupts { late: 0.10, missed: 0.10, ..LINES };
    let mut lost = 0;
    for seed in 0..500 {
        let period = interrupts.measure(interrupts.meter(), seed, 480);
        let error = (period.period_ps as f64 / interrupts.period_ps() - 1.0).abs();
        assert!(error < 5e-5, "seed {seed}: {error}");
        assert!((20..90).contains(&period.outliers), "seed {seed}: {}", period.outliers);
        assert!((350..450).contains(&period.stamps) && period.missed > 50, "seed {seed}: {period:?}");
        lost += u32::from(interrupts.error(&period).abs() > 4.0);
    }
    // Three or more late ones among the first nine, 5 % of all seeds, may mislead it for a while.
    assert!(lost <= 12, "{lost} of 500 beyond four sigma");
}

#[test]
fn each_stamp_says_what_became_of_it() {
    let at = |ticks: u32| ticks & 0xffff;
    let mut meter = LINES.meter();
    for number in 0..9 {
        assert_eq!(meter.push(at(3136 * number)), StampFate::Waiting);
    }
    assert_eq!(meter.push(at(3136 * 9 + 1)), StampFate::Used { missed: 0 });
    assert_eq!(meter.push(at(3136 * 10 + 900)), StampFate::Outlier);
    assert_eq!(meter.push(at(3136 * 13)), StampFate::Used { missed: 3 });
    let period = meter.period().expect("settled");
    assert_eq!((period.stamps, period.missed, period.outliers), (11, 3, 1));
}

#[test]
fn blanking_within_a_turn_counts_as_missed_lines_and_beyond_it_needs_a_gap() {
    let interrupts = Interrupts { jitter_ticks: 1.0, bits: 24, ..LINES };
    let counted = {
        let mut meter = interrupts.meter();
        for frame in 0..4 {
            let first = frame * 510;
            for stamp in interrupts.stamps(7, first..first + 480) {
                meter.push(stamp);
            }
        }
        meter.period().expect("four frames")
    };
    assert_eq!((counted.stamps, counted.missed), (4 * 480, 3 * 30));
    let short = Interrupts { bits: 16, ..interrupts };
    let (mut told, mut silent) = (short.meter(), short.meter());
    for frame in 0..4 {
        for stamp in short.stamps(7, frame * 1200..frame * 1200 + 480) {
            told.push(stamp);
            silent.push(stamp);
        }
        told.gap();
    }
    for (name, meter) in [("told", told), ("silent", silent)] {
        let period = meter.period().expect("four frames");
        assert!(short.error(&period).abs() < 4.0, "{name}: {period:?}");
        assert!(period.stamps > 1850, "{name}: {period:?}");
    }
}

#[test]
fn a_frame_longer_than_a_turn_of_the_counter() {
    // 33.3 ms at 48 MHz: 24 turns of 16 bits.
    let frames = Interrupts { period_ticks: 1_599_360.4, jitter_ticks: 25.0, missed: 0.05, late: 0.05, ..LINES };
    let expected_ps = frames.period_ps() * 1.0005;
    let meter = frames.meter().expecting_ps(expected_ps as u64).expect("sound");
    let (within, rms) = coverage(&frames, &meter, 120, 1000);
    assert!((0.93..=0.975).contains(&within), "{within}, rms {rms}");
}

#[test]
fn another_mode_is_noticed() {
    let slow = Interrupts { period_ticks: 6272.2, ..LINES };
    let mut meter = LINES.meter();
    for stamp in LINES.stamps(1, 0..300) {
        meter.push(stamp);
    }
    for stamp in slow.stamps(2, 0..300) {
        meter.push(stamp);
    }
    let period = meter.period().expect("settled");
    assert!(slow.error(&period).abs() < 4.0, "{period:?}");
    assert!(period.stamps < 300);
}

#[test]
fn noise_is_no_period() {
    let mut rng = StdRng::seed_from_u64(5);
    let mut meter = LINES.meter();
    let mut settled = 0;
    for _ in 0..2000 {
        settled += u32::from(meter.push(rng.random_range(0..65536)) != StampFate::Waiting);
    }
    // What it takes for a period by chance is soon given up again.
    if let Some(period) = meter.period() {
        assert!(period.sigma_ppm() > 1000 || period.stamps < 20, "{period:?} after {settled}");
    }
}

#[test]
fn the_timer_is_part_of_sigma() {
    let exact = Interrupts { jitter_ticks: 0.1, ..LINES };
    let meter = PeriodMeter::new(exact.timer().with_tolerance_ppm(100));
    let period = exact.measure(meter, 1, 480);
    assert!((100..105).contains(&period.sigma_ppm()), "{}", period.sigma_ppm());
    assert!((period.sigma::<f64>() - 1e-4).abs() < 1e-5);
}

#[test]
fn the_readout_of_an_image_counts_the_sensor_s_lines() {
    let period = LINES.measure(LINES.meter(), 3, 480);
    let plain = period.readout(480, 480, ReadoutDirection::TopToBottom).expect("sound");
    assert_eq!(plain.line_time_ps(), period.period_ps);
    let skipping = period.readout(240, 480, ReadoutDirection::TopToBottom).expect("sound");
    assert_eq!(skipping.line_time_ps(), 2 * period.period_ps);
    let error = period.readout(0, 480, ReadoutDirection::TopToBottom).expect_err("no rows");
    assert_eq!(error.parameter, "rows");
}

#[test]
fn frame_start_lies_behind_the_blanking_rows_and_before_half_the_exposure() {
    let start = FrameStart::new(17, 31_777_777).expect("sound");
    assert_eq!(start.frame_start_ns(-5_000), -5_000 + 540_222);
    assert_eq!(start.blanking_rows(31_777_777), 17);
    let exposed = start.with_exposure_ns(8_000_001).expect("sound");
    assert_eq!(exposed.frame_start_ns(0), 540_222 - 4_000_000);
    let seen = FrameStart::from_stamps_ns(1_000_000, 1_540_300).expect("sound");
    assert_eq!((seen.blanking_rows(31_777_777), seen.frame_start_ns(0)), (17, 540_300));
    assert_eq!(FrameStart::from_stamps_ns(10, 9).expect_err("before").parameter, "first_line_ns");
    assert_eq!(FrameStart::new(u16::MAX, u64::MAX).expect_err("long").parameter, "line_time_ps");
    assert_eq!(start.with_exposure_ns(u64::MAX).expect_err("long").parameter, "exposure_ns");
}

#[test]
fn nonsense_is_refused_by_name() {
    assert_eq!(Timer::new(7, 1).expect_err("short").parameter, "bits");
    assert_eq!(Timer::new(33, 1).expect_err("long").parameter, "bits");
    assert_eq!(Timer::new(16, 0).expect_err("stopped").parameter, "hz");
    for period_ps in [0, u64::MAX] {
        assert_eq!(LINES.meter().expecting_ps(period_ps).expect_err("nonsense").parameter, "period_ps");
    }
}

#[test]
fn a_meter_is_as_large_as_it_says() {
    assert!(size_of::<PeriodMeter>() <= 384, "{}", size_of::<PeriodMeter>());
}

proptest! {
    #![proptest_config(seeded(256))]

    /// Wherever the counter begins, however wide it is: the same period and the same sigma.
    #[test]
    fn turns_of_the_counter_leave_no_trace(bits in 16..=32_u8, begin: u32, seed: u64, period in 200.0..30_000.0_f64) {
        let wide = Interrupts { bits: 32, period_ticks: period, jitter_ticks: period / 500.0, ..LINES };
        let (mut shifted, mut plain) = (Interrupts { bits, ..wide }.meter(), wide.meter());
        for stamp in wide.stamps(seed, 0..200) {
            plain.push(stamp);
            shifted.push(stamp.wrapping_add(begin));
        }
        prop_assert_eq!(shifted.period(), plain.period());
    }

    /// Whatever comes in, nothing overflows and no sigma is zero.
    #[test]
    fn any_stamps_at_all(
        bits in 8..=32_u8,
        stamps in prop::collection::vec(any::<u32>(), 0..200),
        expected: Option<u32>,
    ) {
        let mut meter = PeriodMeter::new(Timer::new(bits, 1_000_000).expect("sound"));
        if let Some(expected) = expected.filter(|expected| *expected > 0) {
            meter = meter.expecting_ps(u64::from(expected) * 1_000_000).expect("sound");
        }
        for (index, stamp) in stamps.into_iter().enumerate() {
            meter.push(stamp);
            if index % 40 == 39 {
                meter.gap();
            }
            if let Some(period) = meter.period() {
                prop_assert!(period.sigma_ps > 0 && period.period_ps > 0);
            }
        }
    }
}
