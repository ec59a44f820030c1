//! Each back end's stated error, two-sided, against double precision.

use shutter_range::{Micro, Q32, Scalar};

/// Largest absolute error of `function` over `steps` + 1 points from `from` to `to`, against `exact`.
fn worst<S: Scalar>(from: f64, to: f64, function: impl Fn(S) -> S, exact: impl Fn(f64) -> f64) -> f64 {
    const STEPS: i32 = 20_000;
    (0..=STEPS)
        .map(|step| S::from_f64(from + (to - from) * f64::from(step) / f64::from(STEPS)))
        .map(|x| (function(x).to_f64() - exact(x.to_f64())).abs())
        .fold(0.0, f64::max)
}

/// The documentation of [`Q32`] states 2·10⁻⁹, for the tangent times 1 + tan², which is 7.6 at 1.2 rad. Below 10⁻¹⁰, half of
/// the type's step, nothing would have been compared.
#[test]
fn fixed_point_trigonometry_is_good_to_two_billionths() {
    const TURN: f64 = std::f64::consts::TAU;
    let sine = worst::<Q32>(-TURN, TURN, Q32::sin, f64::sin);
    let cosine = worst::<Q32>(-TURN, TURN, Q32::cos, f64::cos);
    let tangent = worst::<Q32>(-1.2, 1.2, Q32::tan, f64::tan);
    let arc = worst::<Q32>(-50.0, 50.0, Q32::atan, f64::atan);
    println!("sin {sine:.1e}, cos {cosine:.1e}, tan {tangent:.1e}, atan {arc:.1e}");
    assert!((1e-10..2e-9).contains(&sine) && (1e-10..2e-9).contains(&cosine));
    assert!((1e-10..1e-8).contains(&tangent));
    assert!((1e-10..2e-9).contains(&arc));
}

#[test]
fn fixed_point_root_is_good_to_a_step() {
    let root = worst::<Q32>(0.0, 1e6, Q32::sqrt, f64::sqrt);
    // It is rounded down: up to one step of 2.3e-10.
    assert!((1e-11..3e-10).contains(&root), "{root}");
    assert_eq!(Q32::from_f64(-1.0).sqrt(), Q32::ZERO);
    assert_eq!(Q32::from_f64(4.0).sqrt().to_f64(), 2.0);
}

#[test]
fn fixed_point_saturates_and_never_wraps() {
    let large = Q32::from_f64(2e9);
    assert!(!(large + large).is_finite() && !(large * large).is_finite() && !(-large - large).is_finite());
    assert!(!(Q32::ONE / Q32::ZERO).is_finite() && (-Q32::ONE / Q32::ZERO) < Q32::ZERO);
    assert_eq!(Q32::from_f64(f64::NAN), Q32::ZERO);
    assert_eq!(Q32::from_ratio(1, 0), Q32::ZERO);
    assert!(Q32::from_f64(1e300) == Q32::from_f64(f64::INFINITY));
}

#[test]
fn fixed_point_rounds_products_to_nearest() {
    let bias: f64 = (1..1000)
        .map(|k| {
            let (a, b) = (1.0 / f64::from(k), 1e-5 * f64::from(k % 17));
            let (a, b) = (Q32::from_f64(a), Q32::from_f64(b));
            (a * b).to_f64() - a.to_f64() * b.to_f64()
        })
        .sum();
    // Rounding by up to half a step of 2.3e-10 leaves 2e-12 in the mean of 1000; truncation would leave half a step.
    assert!(bias.abs() / 1000.0 < 1e-11, "{bias}");
}

#[test]
fn micromath_root_is_refined_to_the_last_bit_but_one() {
    for exponent in -30..30 {
        let x = 1.37 * 10.0_f64.powi(exponent);
        let root = Micro::from_f64(x).sqrt().to_f64();
        // One step of single precision, 1.2e-7 of a number above one, and half a step for the last rounding.
        assert!((root / x.sqrt() - 1.0).abs() < 2e-7, "{x}: {root}");
    }
    assert_eq!(Micro(0.0).sqrt(), Micro(0.0));
    assert_eq!(Micro(-1.0).sqrt(), Micro(0.0));
    assert_eq!(Micro(f32::INFINITY).sqrt(), Micro(f32::INFINITY));
}

/// The documentation of [`Micro`] states a few 10⁻⁴ to 10⁻³, for the tangent times 1 + tan², which is 7.6 at 1.2 rad. Below
/// 10⁻⁴ it would no longer be micromath's.
#[test]
fn micromath_trigonometry_is_coarse_and_known() {
    let sine = worst::<Micro>(-3.0, 3.0, Micro::sin, f64::sin);
    let tangent = worst::<Micro>(-1.2, 1.2, Micro::tan, f64::tan);
    let arc = worst::<Micro>(-50.0, 50.0, Micro::atan, f64::atan);
    println!("sin {sine:.1e}, tan {tangent:.1e}, atan {arc:.1e}");
    assert!((1e-4..2e-3).contains(&sine));
    assert!((1e-4..2e-2).contains(&tangent));
    assert!((1e-4..3e-3).contains(&arc));
}

#[test]
fn maximum_and_minimum_pass_over_nan() {
    assert_eq!(Scalar::max(f32::NAN, 1.0_f32), 1.0);
    assert_eq!(Scalar::max(1.0_f32, f32::NAN), 1.0);
    assert_eq!(Scalar::min(f64::NAN, 1.0_f64), 1.0);
    assert_eq!(Scalar::min(1.0_f64, f64::NAN), 1.0);
}
