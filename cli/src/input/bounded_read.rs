//! Reading of files up to a limit: devices and pipes may have no end, and a wrong file may be larger than the memory.

use std::fs::File;
use std::io::{Read, stdin};
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};

pub(crate) const MEBIBYTE: u64 = 1 << 20;

/// The most bytes that a file may have.
pub(crate) struct Limit<'a> {
    pub(crate) bytes: u64,
    /// Such as "a setup must have at most".
    pub(crate) rule: &'a str,
}

pub(crate) fn read(path: &Path, limit: &Limit<'_>) -> Result<Vec<u8>> {
    let name = path.display();
    let reading = || format!("reading {name}");
    let file = File::open(path).with_context(reading)?;
    // Devices and pipes have a size of zero.
    let size = file.metadata().with_context(reading)?.len();
    if size > limit.bytes {
        bail!("{name}: the file has {size} bytes, but {} {}", limit.rule, limit.bytes);
    }
    read_from(file, &name.to_string(), limit)
}

pub(crate) fn read_text(path: &Path, limit: &Limit<'_>) -> Result<String> {
    text(read(path, limit)?).with_context(|| path.display().to_string())
}

pub(crate) fn read_standard_input(limit: &Limit<'_>) -> Result<String> {
    text(read_from(stdin().lock(), "-", limit)?).context("-")
}

fn read_from(input: impl Read, name: &str, limit: &Limit<'_>) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input.take(limit.bytes + 1).read_to_end(&mut bytes).with_context(|| format!("reading {name}"))?;
    if bytes.len() as u64 > limit.bytes {
        bail!("{name}: the file has more than {0} bytes, but {1} {0}", limit.bytes, limit.rule);
    }
    Ok(bytes)
}

fn text(bytes: Vec<u8>) -> Result<String> {
    if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
        bail!("the file is UTF-16 text, but must be UTF-8: save it as UTF-8");
    }
    let text = String::from_utf8(bytes);
    text.map_err(|error| {
        let offset = error.utf8_error().valid_up_to();
        anyhow!("the file must be UTF-8 text, but is not from byte {offset} on")
    })
}
