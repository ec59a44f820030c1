//! [`FileIdentity`]: which file a path leads to, whatever the spelling.

use std::path::{Path, PathBuf};

/// Equal for two paths that lead to the same file.
#[derive(PartialEq, Eq, Hash)]
pub(crate) enum FileIdentity {
    /// Where the system numbers its files: hard links of a file are equal, too.
    #[cfg(unix)]
    Numbered { device: u64, inode: u64 },
    /// Without links and `.`; the path as it is, if there is no such file yet.
    Path(PathBuf),
}

impl FileIdentity {
    pub(crate) fn of(path: &Path) -> Self {
        #[cfg(unix)]
        if let Ok(metadata) = std::fs::metadata(path) {
            use std::os::unix::fs::MetadataExt;
            return Self::Numbered { device: metadata.dev(), inode: metadata.ino() };
        }
        Self::Path(path.canonicalize().unwrap_or_else(|_| path.to_path_buf()))
    }
}
