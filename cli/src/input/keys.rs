//! [`Section`]: typed values of a section of a setup file. Every error names the key, its value and what would be
//! right.

use anyhow::{Error, Result, anyhow, bail};
use toml::{Table, Value};

use shutter_range::ParameterError;

use super::bounds::Bounds;
use super::camera_formats;
use super::nearest::{list, nearest, nearest_by, similarity};

/// The only key outside the sections: keys whose value lies outside the usual range and is meant.
pub(crate) const UNUSUAL: &str = "unusual";

/// All sections and their keys.
pub(crate) const KEYS: [(&str, &[&str]); 4] = [
    (
        "camera",
        &[
            "columns",
            "rows",
            "fx",
            "fy",
            "cx",
            "cy",
            "focal_length_mm",
            "pixel_pitch_um",
            "distortion",
            "readout_s",
            "line_time_us",
            "line_length_clocks",
            "pixel_clock_hz",
            "sensor_rows_per_row",
            "direction",
            "exposure_s",
            "lens_blur_px",
            "response",
            "sigma_blur",
            "bits",
            "edge_roughness_px",
            "sigma_column_px",
            "sigma_readout",
            "sigma_focal",
        ],
    ),
    ("motion", &["velocity_m_s", "rate_rad_s", "sigma_speed", "sigma_rate_rad_s", "sigma_time_s"]),
    ("attitude", &["gravity", "sigma_tilt_deg", "sigma_gravity_deg"]),
    ("mount", &["yaw_deg", "pitch_deg", "roll_deg", "position_m"]),
];

/// Refuses a name that is no section or key, with the nearest valid one, or with the list of valid ones where none is
/// near.
pub(crate) fn refuse_unknown(file: &Table) -> Result<()> {
    for (name, value) in file.iter().filter(|(name, _)| *name != UNUSUAL) {
        let Some((section, keys)) = KEYS.iter().find(|(section, _)| section == name) else {
            return Err(unknown_outside(name, value));
        };
        let Value::Table(table) = value else {
            bail!("`{section}` is {value}, but must be a section: [{section}]");
        };
        if let Some(key) = table.keys().find(|key| !keys.contains(&key.as_str())) {
            return Err(unknown_key(section, key, keys));
        }
    }
    Ok(())
}

/// A name that camera files of other programs have.
fn of_camera_file(what: &str) -> Error {
    anyhow!(
        "unknown {what}: it is a name of camera files of ROS, OpenCV, Kalibr or Gyroflow; give such a file by --camera FILE"
    )
}

fn unknown_outside(name: &str, value: &Value) -> Error {
    if camera_formats::is_name_of_camera_file(name) {
        return of_camera_file(&if value.is_table() { format!("section [{name}]") } else { format!("key `{name}`") });
    }
    let sections = KEYS.map(|(section, _)| section);
    let (what, nearest) = if value.is_table() {
        let section = nearest(name, &sections);
        (format!("section [{name}]"), section.map(|section| format!("[{section}]")))
    } else {
        (format!("key `{name}` outside the sections"), nearest_key("", name))
    };
    match nearest {
        Some(nearest) => anyhow!("unknown {what}; the nearest is {nearest}"),
        None => {
            anyhow!("unknown {what}; the sections are {}", sections.map(|section| format!("[{section}]")).join(", "))
        }
    }
}

/// A parameter that the library refuses, under its key in the file.
pub(crate) fn by_its_key(error: ParameterError) -> Error {
    let name = error.parameter;
    if name == "distortion" {
        return anyhow!("`camera.distortion` folds over at radius {:.3}: it must be {}", error.value, error.expected);
    }
    match KEYS.iter().find(|(_, keys)| keys.contains(&name)) {
        Some((section, _)) => anyhow!("`{section}.{name}` is {}, but must be {}", error.value, error.expected),
        None => error.into(),
    }
}

fn unknown_key(section: &str, key: &str, keys: &[&str]) -> Error {
    if camera_formats::is_name_of_camera_file(key) {
        return of_camera_file(&format!("key `{section}.{key}`"));
    }
    match nearest_key(section, key) {
        Some(nearest) => anyhow!("unknown key `{section}.{key}`; the nearest is {nearest}"),
        None => anyhow!("unknown key `{section}.{key}`; the keys of [{section}] are {}", list(keys)),
    }
}

/// The key most similar to `key`; that of the same section among equals.
fn nearest_key(section: &str, key: &str) -> Option<String> {
    let all = KEYS.iter().flat_map(|(section, keys)| keys.iter().map(move |key| (*section, *key)));
    let score = |(other, name): (&str, &str)| similarity(key, name) + if other == section { 0.05 } else { 0.0 };
    let (section, key) = nearest_by(all.chain([("", UNUSUAL)]), score)?;
    Some(if key == UNUSUAL { format!("`{key}` at the top of the file") } else { format!("`{section}.{key}`") })
}

/// One section of the file; empty where the file has none.
pub(crate) struct Section<'a> {
    name: &'static str,
    table: Option<&'a Table>,
}

impl<'a> Section<'a> {
    pub(crate) fn of(file: &'a Table, name: &'static str) -> Self {
        Self { name, table: file.get(name).and_then(Value::as_table) }
    }

    pub(crate) fn is_there(&self) -> bool {
        self.table.is_some()
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    fn value(&self, key: &str) -> Option<&'a Value> {
        self.table.and_then(|table| table.get(key))
    }

    /// An error for a key that is wrong or missing.
    pub(crate) fn refuse(&self, key: &str, expected: impl std::fmt::Display) -> Error {
        let name = self.name;
        if self.has(key) {
            anyhow!("{}, but must be {expected}", self.described(key))
        } else {
            anyhow!("`{name}.{key}` is missing: it must be {expected}")
        }
    }

    /// "`camera.fx` is 600"
    pub(crate) fn described(&self, key: &str) -> String {
        let value = self.value(key).map_or("left out".to_string(), Value::to_string);
        format!("`{}.{key}` is {value}", self.name)
    }

    pub(crate) fn number(&self, key: &str, bounds: Bounds) -> Result<Option<f64>> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match number(value).filter(|number| bounds.contain(*number)) {
            Some(number) => Ok(Some(number)),
            None => Err(self.refuse(key, bounds)),
        }
    }

    pub(crate) fn required(&self, key: &str, bounds: Bounds) -> Result<f64> {
        self.number(key, bounds)?.ok_or_else(|| self.refuse(key, bounds))
    }

    /// Exactly `N` numbers, which `what` describes.
    pub(crate) fn numbers<const N: usize>(&self, key: &str, bounds: Bounds, what: &str) -> Result<Option<[f64; N]>> {
        let list = self.list(key, &[N], bounds, &format!("{N} numbers: {what}"))?;
        Ok(list.and_then(|list| <[f64; N]>::try_from(list).ok()))
    }

    /// As many numbers as one of the lengths says, which `what` describes.
    pub(crate) fn list(&self, key: &str, lengths: &[usize], bounds: Bounds, what: &str) -> Result<Option<Vec<f64>>> {
        let Some(value) = self.value(key) else { return Ok(None) };
        let elements = value.as_array().filter(|elements| lengths.contains(&elements.len()));
        let elements = elements.ok_or_else(|| self.refuse(key, what))?;
        let numbers = elements.iter().enumerate().map(|(index, element)| {
            let number = number(element).filter(|number| bounds.contain(*number));
            number.ok_or_else(|| anyhow!("`{}.{key}[{index}]` is {element}, but must be {bounds}", self.name))
        });
        numbers.collect::<Result<_>>().map(Some)
    }

    /// A text, of which `expected` says what it must be.
    pub(crate) fn text(&self, key: &str, expected: &str) -> Result<Option<&'a str>> {
        let Some(value) = self.value(key) else { return Ok(None) };
        value.as_str().map(Some).ok_or_else(|| self.refuse(key, expected))
    }

    /// The index of the value among the words.
    pub(crate) fn choice<const N: usize>(&self, key: &str, words: [&str; N]) -> Result<Option<usize>> {
        let Some(value) = self.value(key) else { return Ok(None) };
        let index = value.as_str().and_then(|text| words.iter().position(|word| *word == text));
        let quoted = words.map(|word| format!("{word:?}")).join(" or ");
        index.map(Some).ok_or_else(|| self.refuse(key, quoted))
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}
