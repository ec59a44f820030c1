//! Each back end's stated error, two-sided, against double precision.

use fixed::types::I32F32;
use rand::{Rng, SeedableRng, rngs::StdRng};
use shutter_range::{Micro, Motion, Q32, Readout, ReadoutDirection, Scalar, Twist};

use crate::projection;

/// Largest absolute error of `function` over `steps` + 1 points from `from` to `to`, against `exact`.
fn worst<S: Scalar>(from: f64, to: f64, function: impl Fn(S) -> S, exact: impl Fn(f64) -> f64) -> f64 {
    const STEPS: i32 = 20_000;
    (0..=STEPS)
        .map(|step| S::from_f64(from + (to - from) * f64::from(step) / f64::from(STEPS)))
        .map(|x| (function(x).to_f64() - exact(x.to_f64())).abs())
        .fold(0.0, f64::max)
}

/// The documentation of [`Q32`] states 4·10⁻⁹, for the tangent times 1 + tan², which is 7.6 at 1.2 rad. Below 10⁻¹⁰, a
/// tenth of the type's step near one, nothing would have been compared.
#[test]
fn fixed_point_trigonometry_is_good_to_four_billionths() {
    const TURN: f64 = std::f64::consts::TAU;
    let sine = worst::<Q32>(-TURN, TURN, Q32::sin, f64::sin);
    let cosine = worst::<Q32>(-TURN, TURN, Q32::cos, f64::cos);
    let tangent = worst::<Q32>(-1.2, 1.2, Q32::tan, f64::tan);
    let arc = worst::<Q32>(-50.0, 50.0, Q32::atan, f64::atan);
    println!("sin {sine:.1e}, cos {cosine:.1e}, tan {tangent:.1e}, atan {arc:.1e}");
    assert!((1e-10..4e-9).contains(&sine) && (1e-10..4e-9).contains(&cosine));
    assert!((1e-10..1e-8).contains(&tangent));
    assert!((1e-10..4e-9).contains(&arc));
}

/// Largest and mean error of an operation on numbers of all sizes, in units of the larger operand or of the result.
fn errors_of(operation: impl Fn(Q32, Q32) -> Q32, exact: impl Fn(f64, f64) -> f64, is_sum: bool) -> (f64, f64) {
    const COUNT: u32 = 200_000;
    let mut random = StdRng::seed_from_u64(11);
    let mut number = || {
        let size = random.random_range(1.0..2.0) * 2_f64.powi(random.random_range(-20..20));
        Q32::from_f64(if random.random::<bool>() { size } else { -size })
    };
    let (mut worst, mut mean) = (0.0_f64, 0.0);
    for _ in 0..COUNT {
        let (a, b) = (number(), number());
        let (wide_a, wide_b) = (a.to_f64(), b.to_f64());
        let expected = exact(wide_a, wide_b);
        let unit = if is_sum { wide_a.abs().max(wide_b.abs()) } else { expected };
        let error = (operation(a, b).to_f64() - expected) / unit;
        worst = worst.max(error.abs());
        mean += error / f64::from(COUNT);
    }
    (worst, mean)
}

/// As the documentation of [`Q32`] states; below 2·10⁻¹⁰ there are no more bits. What is cut off and not rounded biases
/// by a fraction of that.
#[test]
fn fixed_point_arithmetic_is_good_to_four_billionths() {
    for (name, (worst, mean)) in [
        ("sum", errors_of(|a, b| a + b, |a, b| a + b, true)),
        ("difference", errors_of(|a, b| a - b, |a, b| a - b, true)),
        ("product", errors_of(|a, b| a * b, |a, b| a * b, false)),
        ("quotient", errors_of(|a, b| a / b, |a, b| a / b, false)),
        ("root", errors_of(|a, _| a.abs().sqrt(), |a, _| a.abs().sqrt(), false)),
    ] {
        println!("{name}: {worst:.1e}, on average {mean:.1e}");
        assert!((2e-10..4e-9).contains(&worst), "{name}: {worst}");
        assert!(mean.abs() < 1e-9, "{name}: {mean}");
    }
    assert_eq!(Q32::from_f64(-1.0).sqrt(), Q32::ZERO);
}

#[test]
fn fixed_point_orders_numbers_as_they_are() {
    let sizes = [0.0, 1e-9, 0.5, 1.0, 1.0 + 1e-9, 2.0, 3e9, f64::INFINITY];
    let numbers: Vec<_> = sizes.iter().rev().map(|size| -size).chain(sizes).collect();
    for a in &numbers {
        for b in &numbers {
            let (x, y) = (Q32::from_f64(*a), Q32::from_f64(*b));
            assert_eq!(x.partial_cmp(&y), a.partial_cmp(b), "{a} {b}");
            assert_eq!((x < y, x > y, x <= y, x >= y), (a < b, a > b, a <= b, a >= b), "{a} {b}");
        }
    }
}

/// At the largest and smallest mantissas sums and products carry.
#[test]
fn fixed_point_carries_where_a_mantissa_is_full() {
    let edges = [i32::MAX, i32::MIN, i32::MIN + 1, 1 << 30, -(1 << 30), (1 << 30) - 1, 1 - (1 << 30), 1, -1];
    for a in edges {
        for b in edges {
            let (x, y, a, b) = (Q32::from_i32(a), Q32::from_i32(b), f64::from(a), f64::from(b));
            for (found, exact) in [(x + y, a + b), (x - y, a - b), (x * y, a * b), (x / y, a / b)] {
                let unit = a.abs().max(b.abs()).max(exact.abs());
                assert!((found.to_f64() - exact).abs() <= 4e-9 * unit, "{a} {b}: {found:?} for {exact}");
            }
            assert_eq!(Q32::from_f64(a), x);
        }
    }
}

#[test]
fn fixed_point_saturates_and_never_wraps() {
    let large = Q32::from_f64(1e38);
    assert!(large.is_finite());
    for beyond in [large + large, large * large, -large - large, large / Q32::from_f64(1e-37)] {
        assert!(!beyond.is_finite());
        // What has left the range stays outside.
        let still =
            [beyond - beyond, beyond * Q32::from_f64(1e-30), beyond / large, beyond / beyond, beyond.abs().sqrt()];
        assert!(!still.into_iter().any(Q32::is_finite), "{beyond:?}: {still:?}");
    }
    assert_eq!(Q32::ONE / (large * large), Q32::ZERO);
    assert!(!(Q32::ONE / Q32::ZERO).is_finite() && (-Q32::ONE / Q32::ZERO) < Q32::ZERO);
    assert_eq!(Q32::from_f64(f64::NAN), Q32::ZERO);
    assert_eq!(Q32::from_ratio(1, 0), Q32::ZERO);
    assert!(Q32::from_f64(1e300) == Q32::from_f64(f64::INFINITY));
}

/// In and out by the types of the crate `fixed`, exact or rounded down to its step.
#[test]
fn fixed_point_is_that_of_the_crate_fixed() {
    for value in [0.0, 1.0, -1.0, 612.5, -0.000_123, 2e9, -2e9] {
        let fixed = I32F32::from_num(value);
        let there_and_back = Q32::from(fixed).to_fixed();
        assert!((there_and_back - fixed).abs() <= I32F32::from_num(4e-9 * value.abs()), "{value}: {there_and_back}");
    }
    assert_eq!(Q32::from_f64(1e30).to_fixed(), I32F32::MAX);
    assert_eq!(Q32::from_f64(-1e30).to_fixed(), I32F32::MIN);
    assert_eq!(Q32::from_f64(1e-30).to_fixed(), I32F32::ZERO);
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

/// The documentation of [`Micro`] states a few 10⁻⁴ to 10⁻³, for the tangent times 1 + tan², which is 7.6 at 1.2 rad.
/// Below 10⁻⁴ it would no longer be micromath's.
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

/// By bits, and not by a routine that would be linked: the numbers of errors.
#[test]
fn numbers_are_widened_exactly() {
    let singles = [0.0, -0.0, 1.0, -1.5, 3.4e38, 1.2e-38, 1e-40, 1.4e-45, f32::INFINITY, f32::NEG_INFINITY];
    for single in singles {
        assert_eq!(Scalar::to_f64(single).to_bits(), f64::from(single).to_bits(), "{single}");
    }
    assert!(Scalar::to_f64(f32::NAN).is_nan());
    for frame_ns in [0, u64::MAX, 1 << 62, (1 << 62) + (1 << 12)] {
        let error = Readout::from_frame_readout_ns(480, frame_ns, ReadoutDirection::TopToBottom).expect_err("too long");
        // 53 bits of it.
        assert!((error.value - frame_ns as f64).abs() <= frame_ns as f64 * 2.0_f64.powi(-52), "{frame_ns}: {error}");
    }
}

#[test]
fn maximum_and_minimum_pass_over_nan() {
    assert_eq!(Scalar::max(f32::NAN, 1.0_f32), 1.0);
    assert_eq!(Scalar::max(1.0_f32, f32::NAN), 1.0);
    assert_eq!(Scalar::min(f64::NAN, 1.0_f64), 1.0);
    assert_eq!(Scalar::min(1.0_f64, f64::NAN), 1.0);
}

/// Largest error of the rotation of a camera that has turned about all its axes, by angles from `from` to `to`, in
/// radians.
fn worst_rotation<S: Scalar>(from: f64, to: f64) -> f64 {
    const STEPS: u32 = 500;
    let rate_rad_s = [0.6, -0.64, 0.48];
    let none = [S::ZERO; 3];
    let motion = Twist::new(none, rate_rad_s.map(S::from_f64), [S::ZERO, S::ONE, S::ZERO]).expect("a motion");
    let error = |step| {
        let time_s = S::from_f64(from + (to - from) * f64::from(step) / f64::from(STEPS));
        // What the type makes of the rate is no error of the rotation.
        let exact = projection::rotation(rate_rad_s.map(|rate| S::from_f64(rate).to_f64() * time_s.to_f64()));
        let pairs = motion.pose(time_s).rotation.into_iter().flatten().zip(exact.into_iter().flatten());
        pairs.map(|(entry, exact)| (entry.to_f64() - exact).abs()).fold(0.0, f64::max)
    };
    (0..=STEPS).map(error).fold(0.0, f64::max)
}

/// By series, and by doublings of the angle beyond one radian, each of which doubles the error at most; of many turns, by
/// the rest. An exact rotation would be one of double precision.
#[test]
fn any_angle_is_turned_to_the_last_bits() {
    for (from, to) in [(0.0, 0.06), (0.06, 1.0), (1.0, 3.2), (3.2, 30.0), (30.0, 1000.0)] {
        let scale = f64::max(1.0, to);
        let errors = [
            ("f32", worst_rotation::<f32>(from, to), 1.5e-7),
            ("micro", worst_rotation::<Micro>(from, to), 1.5e-7),
            ("fixed", worst_rotation::<Q32>(from, to), 4e-9),
            ("f64", worst_rotation::<f64>(from, to), 1e-12),
        ];
        for (name, worst, most) in errors {
            println!("{name} {from} to {to}: {worst:.1e}");
            assert!((most * 1e-4..most * scale).contains(&worst), "{name} {from} to {to}: {worst:e}");
        }
    }
}
