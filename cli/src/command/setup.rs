//! Command `setup`: a commented setup file with every key.

use serde::Serialize;

/// Optional keys are behind a `#`, keys that replace others behind `# or:`.
const EVERY_KEY: &str = include_str!("../input/example_setup.toml");

#[derive(Serialize)]
pub(crate) struct SetupText {
    setup: String,
}

/// As a file to start from; with `is_example`, optional keys are set, too.
pub(crate) fn text(is_example: bool) -> String {
    if is_example { EVERY_KEY.lines().map(|line| format!("{}\n", set(line))).collect() } else { EVERY_KEY.to_string() }
}

pub(crate) fn document(is_example: bool) -> SetupText {
    SetupText { setup: text(is_example) }
}

/// An optional key without its `#`; any other line as it is.
fn set(line: &str) -> &str {
    let assignment = line.strip_prefix("# ").filter(|rest| {
        let key = rest.split_once(" = ").map_or("", |(key, _)| key);
        !key.is_empty() && key.chars().all(|c| c.is_ascii_lowercase() || c == '_')
    });
    assignment.unwrap_or(line)
}
