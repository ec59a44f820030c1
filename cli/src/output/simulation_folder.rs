//! [`SimulationFolder`]: a folder with the files of one complete simulation.
//!
//! Files are first written to `.simulating`, a folder inside it. When all are there, that is renamed to `.simulated`,
//! the files of an earlier simulation are removed, and the new ones are moved out. An interruption therefore leaves one
//! of two states, which the next simulation recognises: `.simulating`, and nothing beside it has changed; or
//! `.simulated` with files in it, and the files beside it are incomplete.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};

use super::safe_file;

/// Holds the files of a simulation that is not complete.
const WRITING: &str = ".simulating";
/// Holds the files of a complete simulation until they are moved.
const COMPLETE: &str = ".simulated";

pub(crate) const SETUP: &str = "setup.toml";
pub(crate) const SCENE: &str = "scene.toml";
pub(crate) const TRUTH: &str = "truth.json";
pub(crate) const TRAJECTORY: &str = "trajectory.csv";
/// Files of these names tell a simulation from what somebody else recorded.
const OF_ALL: [&str; 3] = [TRUTH, SCENE, SETUP];
const FRAME: &str = "frame-";
pub(crate) const PNG: &str = ".png";
pub(crate) const RAW: &str = ".raw";

/// The name of a frame, of `frames` in all: alphabetical order is their order.
pub(crate) fn frame_name(number: u32, frames: u32, extension: &str) -> String {
    let digits = frames.saturating_sub(1).to_string().len().max(4);
    format!("{FRAME}{number:0digits$}{extension}")
}

pub(crate) struct SimulationFolder {
    path: PathBuf,
    is_new: bool,
    /// Names of the files, in the order in which they were written.
    files: Vec<String>,
}

impl SimulationFolder {
    /// Makes the folder if there is none. It must be empty, unless `overwrite` permits to replace an earlier
    /// simulation; what somebody else put there is never replaced.
    pub(crate) fn open(path: &Path, overwrite: bool) -> Result<Self> {
        let is_new = !path.exists();
        fs::create_dir_all(path).with_context(|| format!("making {}", path.display()))?;
        if is_incomplete(path) {
            remove_files(path)?;
        } else {
            refuse_files(path, overwrite)?;
        }
        for name in [WRITING, COMPLETE] {
            remove_folder(&path.join(name))?;
        }
        let writing = path.join(WRITING);
        fs::create_dir(&writing).with_context(|| format!("making {}", writing.display()))?;
        Ok(Self { path: path.to_path_buf(), is_new, files: Vec::new() })
    }

    pub(crate) fn write(&mut self, name: &str, content: &[u8]) -> Result<()> {
        let path = self.path.join(WRITING).join(name);
        safe_file::write(&path, content).with_context(|| format!("writing {}", path.display()))?;
        self.files.push(name.to_string());
        Ok(())
    }

    /// Puts the files in the place of those of an earlier simulation.
    pub(crate) fn finish(self) -> Result<()> {
        let complete = self.path.join(COMPLETE);
        rename(&self.path.join(WRITING), &complete)?;
        remove_files(&self.path)?;
        for name in &self.files {
            rename(&complete.join(name), &self.path.join(name))?;
        }
        remove_folder(&complete)
    }
}

/// Removes what was written, unless it was finished.
impl Drop for SimulationFolder {
    fn drop(&mut self) {
        // There may be an error already, which is the one to report.
        let _ = remove_folder(&self.path.join(WRITING));
        if self.is_new {
            // Only if it is empty.
            let _ = fs::remove_dir(&self.path);
        }
    }
}

/// The files of an earlier simulation in a folder.
pub(crate) fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let names = names(folder)?.into_iter().filter(|name| is_of_simulation(name));
    Ok(names.map(|name| folder.join(name)).collect())
}

fn is_of_simulation(name: &str) -> bool {
    let number = name.strip_prefix(FRAME).and_then(|rest| rest.strip_suffix(PNG).or(rest.strip_suffix(RAW)));
    let is_frame =
        number.is_some_and(|number| !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit()));
    is_frame || [SETUP, SCENE, TRUTH, TRAJECTORY].contains(&name)
}

/// Names of all that a folder holds, sorted.
fn names(folder: &Path) -> Result<Vec<String>> {
    let entries = fs::read_dir(folder).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let entries = entries.with_context(|| format!("reading the folder {}", folder.display()))?;
    let mut names: Vec<_> = entries.iter().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    Ok(names)
}

/// Whether an earlier simulation was interrupted while it moved its files.
fn is_incomplete(folder: &Path) -> bool {
    fs::read_dir(folder.join(COMPLETE)).is_ok_and(|mut entries| entries.next().is_some())
}

/// Refuses a folder whose files are not to be replaced.
fn refuse_files(folder: &Path, overwrite: bool) -> Result<()> {
    let names = names(folder)?;
    let folder = folder.display();
    if let Some(name) = names.iter().find(|name| is_of_simulation(name)) {
        return match OF_ALL.into_iter().find(|of_all| !names.iter().any(|name| name == of_all)) {
            Some(missing) => Err(anyhow!(
                "{folder} holds {name}, but no {missing}: it is no earlier simulation, and --out must be a new or an \
                 empty folder"
            )),
            None if overwrite => Ok(()),
            None => Err(anyhow!(
                "{folder} holds {name}: --overwrite replaces an earlier simulation, or choose another folder for --out"
            )),
        };
    }
    // Files of other names stay.
    match names.iter().find(|name| !overwrite && ![WRITING, COMPLETE].contains(&name.as_str())) {
        Some(name) => Err(anyhow!("{folder} holds {name}: --out must be a new or an empty folder")),
        None => Ok(()),
    }
}

fn remove_files(folder: &Path) -> Result<()> {
    for file in files(folder)? {
        fs::remove_file(&file).with_context(|| format!("removing {}", file.display()))?;
    }
    Ok(())
}

fn remove_folder(folder: &Path) -> Result<()> {
    if !folder.exists() {
        return Ok(());
    }
    fs::remove_dir_all(folder).with_context(|| format!("removing {}", folder.display()))
}

fn rename(from: &Path, to: &Path) -> Result<()> {
    fs::rename(from, to).with_context(|| format!("moving {} to {}", from.display(), to.display()))
}
