//! Which name someone may have meant.

/// How much `name` looks like `candidate`, from 0 to 1. A common beginning counts most: units are what people forget.
pub(crate) fn likeness(name: &str, candidate: &str) -> f64 {
    strsim::jaro_winkler(&name.to_lowercase().replace('-', "_"), candidate)
}

/// The candidate with the highest score, the first of equals.
pub(crate) fn best<T: Copy>(candidates: impl IntoIterator<Item = T>, score: impl Fn(T) -> f64) -> Option<T> {
    let scored = candidates.into_iter().map(|candidate| (score(candidate), candidate));
    scored.reduce(|best, next| if next.0 > best.0 { next } else { best }).map(|(_, candidate)| candidate)
}

/// The candidate most like `name`.
pub(crate) fn nearest<'a>(name: &str, candidates: &[&'a str]) -> Option<&'a str> {
    best(candidates.iter().copied(), |candidate| likeness(name, candidate))
}
