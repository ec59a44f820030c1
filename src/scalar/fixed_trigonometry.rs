//! Trigonometry of [`Q32`], by series.

use super::fixed::Q32;
use super::scalar::Scalar;

/// π/2 in two parts, of which the second continues the first.
const HALF_PI: [Q32; 2] = [Q32::normalised(1_686_629_713, -30), Q32::normalised(70064198, -60)];

/// Sum of `x^(2k) / ((start + 1)(start + 2)…)` with alternating signs: the series of sine (start 1) and cosine (0).
fn alternating_series(square: Q32, start: i32) -> Q32 {
    let mut sum = Q32::ONE;
    let mut order = start + 12;
    while order > start {
        sum = Q32::ONE - square * sum / Q32::from_i32(order * (order - 1));
        order -= 2;
    }
    sum
}

/// Reduces an angle by the nearest multiple of π/2: the rest, within ±π/4, and the multiple modulo 4.
fn quadrant(angle: Q32) -> (Q32, i64) {
    let [high, low] = HALF_PI;
    let turns = (angle / high + Q32::ratio(1, 2)).floor();
    let whole = Q32::from_i64(turns);
    (angle - whole * high - whole * low, turns & 3)
}

pub(super) fn sine(angle: Q32) -> Q32 {
    let (small, quarter) = quadrant(angle);
    sine_of_quadrant(small, quarter)
}

pub(super) fn cosine(angle: Q32) -> Q32 {
    let (small, quarter) = quadrant(angle);
    sine_of_quadrant(small, (quarter + 1) & 3)
}

fn sine_of_quadrant(small: Q32, quarter: i64) -> Q32 {
    let square = small * small;
    let value = if quarter & 1 == 0 { small * alternating_series(square, 1) } else { alternating_series(square, 0) };
    if quarter & 2 == 0 { value } else { -value }
}

/// A rational approximation, refined by two Newton steps.
pub(super) fn arc_tangent(tangent: Q32) -> Q32 {
    let steep = tangent.abs() > Q32::ONE;
    let slope = if steep { Q32::ONE / tangent } else { tangent };
    // Within 0.005 rad for |slope| ≤ 1.
    let mut angle = slope / (Q32::ONE + Q32::ratio(9, 32) * slope * slope);
    for _ in 0..2 {
        let (sine, cosine) = (sine(angle), cosine(angle));
        angle = angle + (slope * cosine - sine) / (cosine + slope * sine);
    }
    let [half_pi, _] = HALF_PI;
    match steep {
        true if tangent < Q32::ZERO => -half_pi - angle,
        true => half_pi - angle,
        false => angle,
    }
}
