//! Statistics that a few wild values do not change.

/// Zero of none.
pub(crate) fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}

/// The value that this share of all lies below; zero of none.
pub(crate) fn quantile(values: impl IntoIterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let index = (values.len() as f64 * share) as usize;
    values.get(index.min(values.len().saturating_sub(1))).copied().unwrap_or(0.0)
}

/// Sigma of a normal distribution around zero by the median of its sizes.
pub(crate) fn sigma(values: impl IntoIterator<Item = f64>) -> f64 {
    1.4826 * median(values.into_iter().map(f64::abs))
}
