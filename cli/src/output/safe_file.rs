//! Files that are complete or not there: a full disk or an interruption leaves nothing half-written under their name.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use std::process;

use anyhow::{Context, Result};

/// Writes a file in place of the one at `path`, if there is one. On failure that one is left as it was.
pub(crate) fn write(path: &Path, content: &[u8]) -> io::Result<()> {
    // A symbolic link stays: the file that it points to is replaced.
    let target = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    if fs::metadata(&target).is_ok_and(|metadata| !metadata.is_file()) {
        // Renaming a file to the name of a device or a pipe would only hide it.
        return OpenOptions::new().write(true).open(&target)?.write_all(content);
    }
    let partial = target.with_file_name(format!(".shutter-range-{}.partial", process::id()));
    let written = write_new(&partial, content).and_then(|()| fs::rename(&partial, &target));
    if written.is_err() {
        // The first error is the one to report.
        let _ = fs::remove_file(&partial);
    }
    written
}

/// The same, with an error that names the file.
pub(crate) fn write_text(path: &Path, content: &str) -> Result<()> {
    write(path, content.as_bytes()).with_context(|| format!("writing {}", path.display()))
}

/// Creates a file and waits until it is on the disk: some systems report only then that there is no space.
fn write_new(path: &Path, content: &[u8]) -> io::Result<()> {
    // An earlier process with the same number may have been killed before it removed its own.
    let _ = fs::remove_file(path);
    let mut file = File::create_new(path)?;
    file.write_all(content)?;
    file.sync_all()
}
