//! Rounding to the digits that mean something.

/// How many decimals it takes to show this number of significant digits of a value; 6 at most.
pub(crate) fn decimals(value: f64, digits: i32) -> usize {
    let before_point = if value > 0.0 { value.log10().floor() as i32 + 1 } else { 1 };
    (digits - before_point).clamp(0, 6) as usize
}

/// A value and its sigma, both with the decimals that this number of significant digits of sigma takes.
pub(crate) fn with_sigma(value: f64, sigma: f64, digits: i32) -> String {
    let decimals = decimals(sigma, digits);
    format!("{value:.decimals$} ± {sigma:.decimals$}")
}

/// A lower bound, rounded down so that it stays one.
pub(crate) fn at_least(value: f64, digits: i32) -> String {
    let decimals = decimals(value, digits);
    let scale = 10_f64.powi(decimals as i32);
    format!("{:.decimals$}", (value * scale).floor() / scale)
}
