//! TOML with errors of one line.

use anyhow::{Result, anyhow};
use serde::de::DeserializeOwned;

use super::text_kind::TextKind;

pub(crate) fn parse<T: DeserializeOwned>(text: &str) -> Result<T> {
    // Some editors begin a file with a byte order mark.
    let text = text.trim_start_matches('\u{feff}');
    toml::from_str(text).map_err(|error| {
        if let Some(kind) = TextKind::of(text) {
            return anyhow!(
                "the file is {}, but must be TOML; a camera file of another program goes to --camera",
                kind.name()
            );
        }
        let before = error.span().and_then(|span| text.get(..span.start));
        let line = before.map_or(1, |before| before.matches('\n').count() + 1);
        // The only message that is about a name and leaves it out.
        let twice = error.span().filter(|_| error.message() == "duplicate key").and_then(|span| text.get(span));
        match twice {
            Some(name) => anyhow!("line {line}: `{name}` is there a second time, but must be there once"),
            None => anyhow!("line {line}: {}", error.message()),
        }
    })
}
