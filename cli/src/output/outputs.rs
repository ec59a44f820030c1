//! [`Output`]: a file that a command will write. None may replace what the command reads, or another one.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::input::file_identity::FileIdentity;

pub(crate) struct Output {
    /// The option that asks for it, and where there are several, of what: "--map", "--overlay of a.png".
    what: String,
    path: PathBuf,
    /// It stands for files of this name with numbers, one for each frame of a video.
    is_numbered: bool,
}

impl Output {
    pub(crate) fn new(what: impl Into<String>, path: &Path) -> Self {
        Self { what: what.into(), path: path.to_path_buf(), is_numbered: false }
    }

    pub(crate) fn numbered(self) -> Self {
        Self { is_numbered: true, ..self }
    }

    /// Of each option that is given.
    pub(crate) fn of_options(options: &[(&str, Option<&Path>)]) -> Vec<Self> {
        options.iter().filter_map(|(option, path)| Some(Self::new(*option, (*path)?))).collect()
    }

    /// The file, or all that there are of those with numbers: how many will be written is not known.
    fn files(&self) -> Vec<PathBuf> {
        if !self.is_numbered {
            return vec![self.path.clone()];
        }
        let folder = self.path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let names = entries.map(|entry| self.path.with_file_name(entry.file_name()));
        names.filter(|path| self.may_be(path)).collect()
    }

    /// Of one that stands for several: whether the file is one of them.
    fn may_be(&self, file: &Path) -> bool {
        // Its digits are the same whatever the bytes before them are.
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        let number = stem.rsplit('-').next().unwrap_or_default();
        let is_number = number.len() >= 4 && number.bytes().all(|digit| digit.is_ascii_digit());
        is_number && with_stem(&self.path, Path::new(number)) == file
    }

    /// The same of another output.
    fn meets(&self, other: &Self) -> bool {
        if other.is_numbered { self.path == other.path } else { self.may_be(&other.path) }
    }
}

/// The picture that stands for `out` where there are several frames.
pub(crate) fn with_stem(out: &Path, frame: &Path) -> PathBuf {
    let [mut name, stem] = [out, frame].map(|path| path.file_stem().unwrap_or_default().to_os_string());
    name.push("-");
    name.push(stem);
    name.push(".png");
    out.with_file_name(name)
}

/// Refuses outputs that would replace an input or each other, however their names are spelt.
pub(crate) fn check<'a>(inputs: impl IntoIterator<Item = &'a Path>, outputs: &[Output]) -> Result<(), String> {
    let inputs: HashMap<_, _> = inputs.into_iter().map(|input| (FileIdentity::of(input), input)).collect();
    let numbered: Vec<&Output> = outputs.iter().filter(|output| output.is_numbered).collect();
    let mut written: HashMap<FileIdentity, &Output> = HashMap::new();
    for output in outputs {
        let refuse = |other: &Output, file: &Path| {
            Err(format!("{} and {} would be written to one file, {}", other.what, output.what, file.display()))
        };
        if let Some(other) = numbered.iter().find(|other| !std::ptr::eq(**other, output) && other.meets(output)) {
            return refuse(other, &output.path);
        }
        for file in output.files() {
            let identity = FileIdentity::of(&file);
            if let Some(input) = inputs.get(&identity) {
                let (what, input, file) = (&output.what, input.display(), file.display());
                return Err(format!("{what} would replace {input}: {file} is the same file"));
            }
            if let Some(other) = written.insert(identity, output).filter(|other| !std::ptr::eq(*other, output)) {
                return refuse(other, &file);
            }
        }
    }
    Ok(())
}
