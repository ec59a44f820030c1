//! The scale of a camera from passes at known distance and speed.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use serde::Deserialize;
use shutter_range::calibrate::{Pass, Scale, ScaleRefusal, fit_scale};
use shutter_range::{Micro, Q32, Scalar};

const N: usize = 64;

#[derive(Deserialize)]
struct Row {
    shutter_s: String,
    speed_m_s: f64,
    distance_m: f64,
    rse_deg: f64,
}

fn table2<S: Scalar>() -> Vec<Pass<S>> {
    let mut file = csv::Reader::from_reader(include_bytes!("data/table2.csv").as_slice());
    let rows = file.deserialize().map(|row| row.expect("table2.csv is well formed"));
    rows.map(|row: Row| {
        let number = S::from_f64;
        let shutter = row.shutter_s.strip_prefix("1/").and_then(|text| text.parse::<f64>().ok()).expect("a fraction");
        let slope = number(row.rse_deg.to_radians().tan());
        let pass = Pass::new(slope, number(row.speed_m_s), number(row.distance_m)).expect("a pass");
        pass.with_frame_readout_s(number(1.0 / shutter)).expect("a readout")
    })
    .collect()
}

/// A fit done elsewhere has κ 2.352 ± 0.014 with a tilt of 0.006 ± 0.034°, and 2.354 ± 0.006 without one; its sigmas
/// are those of the scatter, which is 1.07 times the 0.1° that is stated here.
#[test]
fn table_2() {
    fn of<S: Scalar>() -> [f64; 6] {
        let passes = table2::<S>();
        let free: Scale<S, N> = fit_scale(&passes, None).expect("a scale");
        let upright: Scale<S, N> = fit_scale(&passes, Some(S::ZERO)).expect("a scale");
        assert_eq!((free.passes_used(), upright.passes_used()), (40, 40), "Table 2 has no outliers");
        let numbers = [free.scale, free.sigma_scale, free.tilt, free.sigma_tilt, upright.scale, upright.sigma_scale]
            .map(S::to_f64);
        let [kappa, sigma, tilt, sigma_tilt, upright, sigma_upright] = numbers;
        [kappa, sigma, tilt.to_degrees(), sigma_tilt.to_degrees(), upright, sigma_upright]
    }
    let elsewhere = [2.352, 0.014, 0.006, 0.034, 2.354, 0.006];
    for numbers in [of::<f64>(), of::<f32>(), of::<Micro>(), of::<Q32>()] {
        println!("{numbers:.4?}");
        for (number, expected) in numbers.into_iter().zip(elsewhere) {
            assert!((number - expected).abs() < 0.001, "{number} for {expected}");
        }
    }
}

const SCALE: f64 = 0.04;
/// 0.1° as a slope, the default sigma of a pass.
const LEAN: f64 = 0.001_745;

/// Passes in both directions with leans and speeds drawn at random; the tilt is common.
fn drawn(random: &mut StdRng, count: usize, tilt: f64, sigma_relative: f64) -> Vec<Pass<f64>> {
    let mut passes = Vec::new();
    for _ in 0..count {
        let speed_m_s = random.random_range(1.0..3.0) * if random.random() { 1.0 } else { -1.0 };
        let depth_m = random.random_range(1.0..4.0);
        let [lean, off]: [f64; 2] = std::array::from_fn(|_| random.sample(StandardNormal));
        let slope = SCALE * speed_m_s / depth_m + tilt + LEAN * lean;
        let stated = speed_m_s * (1.0 + sigma_relative * off);
        let pass = Pass::new(slope, stated, depth_m).expect("a pass");
        passes.push(pass.with_sigmas(LEAN, sigma_relative).expect("sigmas"));
    }
    passes
}

/// 94 to 97 %, with three sigma of a share of 2000 on either side; the scatter of five passes is hardly known.
#[test]
fn two_sigma_hold_what_they_say() {
    for (count, sigma_relative, sigma_tilt) in
        [(5, 0.0, None), (12, 0.0, Some(0.01)), (12, 0.02, None), (40, 0.01, None), (8, 0.02, Some(0.0))]
    {
        let mut random = StdRng::seed_from_u64(2);
        let (mut within, mut found_of) = ([0; 2], 0);
        for _ in 0..2000 {
            let own: f64 = random.sample(StandardNormal);
            let tilt = own * sigma_tilt.unwrap_or(0.02);
            let passes = drawn(&mut random, count, tilt, sigma_relative);
            // Passes that are alike by chance are refused.
            let Ok(found): Result<Scale<f64, N>, _> = fit_scale(&passes, sigma_tilt) else { continue };
            found_of += 1;
            within[0] += u32::from((found.scale - SCALE).abs() <= 2.0 * found.sigma_scale);
            within[1] += u32::from((found.tilt - tilt).abs() <= 2.0 * found.sigma_tilt);
        }
        let shares = within.map(|within| f64::from(within) / f64::from(found_of));
        assert!(found_of > 1950, "{count}: {found_of}");
        println!("{count} passes, {sigma_relative}, {sigma_tilt:?}: {shares:?}");
        assert!((0.935..0.975).contains(&shares[0]), "{count}: {}", shares[0]);
        assert!(sigma_tilt == Some(0.0) || (0.935..0.975).contains(&shares[1]), "{count}: {}", shares[1]);
    }
}

/// Passes in one direction tell the scale from a tilt badly, in both well.
#[test]
fn both_directions_tell_tilt_from_scale() {
    let passes = |directions: [f64; 4]| {
        directions.map(|speed_m_s| Pass::new(SCALE * speed_m_s / 2.0 + 0.01, speed_m_s, 2.0).expect("a pass"))
    };
    let one: Scale<f64, N> = fit_scale(&passes([2.0, 2.5, 2.2, 2.8]), None).expect("a scale");
    let both: Scale<f64, N> = fit_scale(&passes([2.0, -2.5, 2.2, -2.8]), None).expect("a scale");
    assert!(one.sigma_scale > 5.0 * both.sigma_scale && one.correlation < -0.95 && both.correlation.abs() < 0.3);
    for found in [&one, &both] {
        assert!((found.scale - SCALE).abs() < 1e-9 && (found.tilt - 0.01).abs() < 1e-9, "{found:?}");
    }
    let same = fit_scale::<f64, N>(&passes([2.0; 4]), None);
    assert!(matches!(same, Err(ScaleRefusal::Alike { .. })), "{same:?}");
    let alike = fit_scale::<f64, N>(&passes([2.0, 2.001, 2.0, 2.001]), None);
    assert!(matches!(alike, Err(ScaleRefusal::Alike { .. })), "{alike:?}");
    // The same without a tilt to tell it from, which is then a part of the scale.
    let upright: Scale<f64, N> = fit_scale(&passes([2.0, 2.001, 2.0, 2.001]), Some(0.0)).expect("a scale");
    assert!((upright.scale - (SCALE + 0.01)).abs() < 1e-4, "{}", upright.scale);
}

#[test]
fn outliers_are_found() {
    for seed in 0..50 {
        let mut random = StdRng::seed_from_u64(seed);
        let mut passes = drawn(&mut random, 12, 0.0, 0.0);
        for wrong in [2, 7] {
            passes[wrong] = Pass::new(0.09, 2.0, 3.0).expect("a pass");
        }
        let found: Scale<f64, N> = fit_scale(&passes, None).expect("a scale");
        let outliers: Vec<_> = (0..12).filter(|index| found.outliers[*index]).collect();
        assert!(outliers.contains(&2) && outliers.contains(&7) && outliers.len() <= 3, "{seed}: {outliers:?}");
        assert!((found.scale - SCALE).abs() < 4.0 * found.sigma_scale, "{seed}: {}", found.scale);
    }
}

#[test]
fn contradictory_passes() {
    // Half of the signs are wrong.
    let passes = [1.0, -1.0, 1.0, -1.0, 1.0, -1.0].map(|sign| Pass::new(sign * 0.05, 2.0, 2.0).expect("a pass"));
    let refusal = fit_scale::<f64, N>(&passes, Some(0.0)).expect_err("signs");
    assert!(matches!(refusal, ScaleRefusal::Contradictory { .. }), "{refusal}");
    let reversed =
        [2.0, -2.0, 2.5, -1.5].map(|speed_m_s| Pass::new(-0.02 * speed_m_s, speed_m_s, 2.0).expect("a pass"));
    assert_eq!(fit_scale::<f64, N>(&reversed, None), Err(ScaleRefusal::Reversed));
    // Speeds that are worse known than stated give a larger sigma, no refusal.
    let mut random = StdRng::seed_from_u64(3);
    let rough: Vec<_> =
        drawn(&mut random, 12, 0.0, 0.2).iter().map(|pass| pass.with_sigmas(LEAN, 0.02).expect("sigmas")).collect();
    let found: Scale<f64, N> = fit_scale(&rough, None).expect("a scale");
    assert!(found.misfit > 2.0 && (found.scale - SCALE).abs() < 3.0 * found.sigma_scale, "{found:?}");
}

#[test]
fn parameters_are_checked() {
    let bad = [f64::NAN, f64::INFINITY, 1e9];
    for value in bad {
        assert!(Pass::new(value, 1.0, 1.0).is_err() && Pass::new(0.1, value, 1.0).is_err(), "{value}");
        assert!(Pass::new(0.1, 1.0, value).is_err() && Pass::oblique(0.1, 1.0, 1.0, 0.0, value).is_err(), "{value}");
    }
    assert!(
        Pass::new(0.1, 0.0, 1.0).is_err() && Pass::new(0.1, 1.0, 0.0).is_err() && Pass::new(0.1, 1.0, -1.0).is_err()
    );
    let pass = Pass::new(0.1, 1.0, 1.0).expect("a pass");
    assert!(pass.with_sigmas(0.0, 0.0).is_err() && pass.with_sigmas(0.1, -0.1).is_err());
    assert!(pass.with_frame_readout_s(0.0).is_err() && pass.with_frame_readout_s(f64::NAN).is_err());
    assert_eq!(fit_scale::<f64, N>(&[], Some(0.0)), Err(ScaleRefusal::TooFewPasses { needed: 2 }));
    assert_eq!(fit_scale::<f64, N>(&[pass; 2], None), Err(ScaleRefusal::TooFewPasses { needed: 3 }));
    assert_eq!(fit_scale::<f64, 4>(&[pass; 5], None), Err(ScaleRefusal::TooManyPasses));
}
