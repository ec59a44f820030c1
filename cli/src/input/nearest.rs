//! Which name someone may have meant.

/// From here on a name is taken for another one that was misspelt. `color` is not enough like `columns`, `cols` is.
const SIMILAR: f64 = 0.85;

/// How similar `name` is to `candidate`, from 0 to 1. A common beginning counts most: units are what people forget.
pub(crate) fn similarity(name: &str, candidate: &str) -> f64 {
    strsim::jaro_winkler(&name.to_lowercase().replace('-', "_"), candidate)
}

/// The candidate with the highest score, the first of equals; `None` if none is similar.
pub(crate) fn nearest_by<T: Copy>(candidates: impl IntoIterator<Item = T>, score: impl Fn(T) -> f64) -> Option<T> {
    let scored = candidates.into_iter().map(|candidate| (score(candidate), candidate));
    let best = scored.reduce(|best, next| if next.0 > best.0 { next } else { best });
    best.filter(|(score, _)| *score >= SIMILAR).map(|(_, candidate)| candidate)
}

/// The candidate most similar to `name`.
pub(crate) fn nearest<'a>(name: &str, candidates: &[&'a str]) -> Option<&'a str> {
    nearest_by(candidates.iter().copied(), |candidate| similarity(name, candidate))
}

/// "`row`, `column` and `line`"
pub(crate) fn list(names: &[&str]) -> String {
    let quoted: Vec<_> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
        None => String::new(),
    }
}
