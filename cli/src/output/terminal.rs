//! Standard output: text or JSON, colours or none.

use std::io::{self, ErrorKind, IsTerminal, Write};

use anyhow::{Context, Error, Result};
use serde::Serialize;

/// Whether standard output is a terminal that shows colours and the user wants them (<https://no-color.org>).
pub(crate) fn colours() -> bool {
    let unwanted = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let dumb = std::env::var_os("TERM").is_some_and(|value| value == "dumb");
    io::stdout().is_terminal() && !unwanted && !dumb
}

pub(crate) fn json(document: &impl Serialize) -> Result<String> {
    let mut text = serde_json::to_string_pretty(document).context("writing JSON")?;
    text.push('\n');
    Ok(text)
}

/// A document on a line of its own.
pub(crate) fn json_line(document: &impl Serialize) -> Result<String> {
    Ok(serde_json::to_string(document).context("writing JSON")? + "\n")
}

/// Writes everything. Whether anybody still reads it: one who has seen enough (`| head`) is no error.
pub(crate) fn print(text: &str) -> Result<bool> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(error).context("standard output"),
    }
}

/// Writes one line to standard error.
pub(crate) fn error(error: &Error) {
    let message = format!("{error:#}").replace('\n', " ");
    // If standard error is closed, there is no other place to report that.
    let _ = writeln!(io::stderr(), "error: {message}");
}
