//! `--camera FILE`: a camera that was calibrated by another program, as keys of a setup's [camera].

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};
use toml::{Table, Value};

use super::bounded_read::{self, Limit, MEBIBYTE};
use super::camera_formats;
use super::document_tree;

/// Some hold the boards that they were calibrated with.
const LIMIT: Limit<'_> = Limit { bytes: 16 * MEBIBYTE, rule: "a camera file must have at most" };

/// Which camera of which file.
#[derive(Clone, Copy)]
pub(crate) struct CameraSource<'a> {
    pub(crate) path: &'a Path,
    /// Where the file has several.
    pub(crate) name: Option<&'a str>,
}

pub(crate) struct CameraFile {
    path: PathBuf,
    pub(crate) keys: Vec<(&'static str, Value)>,
}

/// Keys that say the same in other words.
const GROUPS: [&[&str]; 2] = [
    &["fx", "focal_length_mm", "pixel_pitch_um"],
    &["readout_s", "line_time_us", "line_length_clocks", "pixel_clock_hz"],
];

pub(crate) fn load(source: CameraSource<'_>) -> Result<CameraFile> {
    let path = source.path;
    let text = bounded_read::read_text(path, &LIMIT)?;
    let calibration = document_tree::parse(&text).and_then(|tree| camera_formats::calibration(&tree, source.name));
    let keys = calibration.with_context(|| path.display().to_string())?.keys();
    Ok(CameraFile { path: path.to_path_buf(), keys })
}

impl CameraFile {
    /// Adds the keys to those of a setup, which must not say anything else.
    pub(crate) fn add_to(&self, setup: &mut Table) -> Result<()> {
        let camera = setup.entry("camera").or_insert_with(|| Value::Table(Table::new()));
        let Some(camera) = camera.as_table_mut() else { bail!("`camera` must be a section: [camera]") };
        for (key, value) in &self.keys {
            let group = GROUPS.into_iter().find(|group| group.contains(key));
            let others = group.unwrap_or_default().iter().filter(|other| *other != key);
            let said = camera.get_key_value(*key).filter(|(_, said)| !equal(said, value));
            let said = said.or_else(|| others.filter_map(|other| camera.get_key_value(*other)).next());
            if let Some((other, said)) = said {
                let path = self.path.display();
                return Err(anyhow!(
                    "`camera.{other}` is {said}, but {path} has {key} = {value}: leave one of them out"
                ));
            }
            camera.insert((*key).to_string(), value.clone());
        }
        Ok(())
    }
}

fn equal(a: &Value, b: &Value) -> bool {
    let number = |value: &Value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
    match (number(a), number(b)) {
        (Some(a), Some(b)) => a == b,
        _ => a == b,
    }
}
