//! Command `setup`: a commented setup file with every key.

use anyhow::{Result, anyhow, ensure};
use serde::Serialize;
use toml::Value;

use crate::arguments::SetupFileArgs;
use crate::input::camera_file;
use crate::input::sensor_mode;

/// Optional keys are behind a `#`, keys that replace others behind `# or:`.
const EVERY_KEY: &str = include_str!("../input/example_setup.toml");

#[derive(Serialize)]
pub(crate) struct SetupText {
    pub(crate) setup: String,
}

/// As a file to start from; with `example`, optional keys are set, too. What a sensor or a camera file tells is filled
/// in.
pub(crate) fn document(arguments: &SetupFileArgs) -> Result<SetupText> {
    let every_key = EVERY_KEY.lines().map(|line| if arguments.example { set(line) } else { line });
    let mut filled = Filled { lines: every_key.map(str::to_string).collect(), told: Vec::new(), remarks: Vec::new() };
    if let Some(sensor) = &arguments.sensor {
        filled.with_sensor(sensor, arguments.clock_mhz)?;
    }
    if let Some(source) = arguments.camera.source() {
        let keys = camera_file::load(source)?.keys;
        filled.with_keys(&source.path.display().to_string(), &keys)?;
    }
    Ok(SetupText { setup: filled.text() })
}

/// An optional key without its `#`; any other line as it is.
fn set(line: &str) -> &str {
    line.strip_prefix("# ").filter(|rest| key(rest).is_some()).unwrap_or(line)
}

fn key(assignment: &str) -> Option<&str> {
    let key = assignment.split_once(" = ").map_or("", |(key, _)| key);
    (!key.is_empty() && key.chars().all(|c| c.is_ascii_lowercase() || c == '_')).then_some(key)
}

/// The key of a line, set or not.
fn key_of_line(line: &str) -> Option<&str> {
    let commented = line.strip_prefix("# or: ").or(line.strip_prefix("# "));
    key(commented.unwrap_or(line))
}

/// The file with what is known.
struct Filled {
    lines: Vec<String>,
    /// Keys that have been filled in, their values, and by what.
    told: Vec<(&'static str, Value, String)>,
    remarks: Vec<String>,
}

/// Keys that must be given and that are an example until then.
const REQUIRED: [(&str, &str); 5] = [
    ("columns", "columns"),
    ("rows", "rows"),
    ("fx", "fx"),
    ("readout_s", "line_time_us"),
    ("velocity_m_s", "velocity_m_s"),
];

impl Filled {
    fn with_sensor(&mut self, sensor: &str, clock_mhz: Option<f64>) -> Result<()> {
        let typical = sensor_mode::find(sensor, clock_mhz)?;
        let clock_hz = clock_mhz.map_or(typical.clock_hz, |mhz| (mhz * 1e6).round() as u32);
        let mode = typical.mode_at(clock_hz).map_err(|error| anyhow!("--sensor {sensor}: {error}"))?;
        let name = format!("{} {} at {} MHz", typical.chip.name(), typical.name, f64::from(clock_hz) / 1e6);
        self.with_keys(&name, &sensor_mode::keys(&mode))?;
        self.remarks.push(format!("The line time is {}: {}.", typical.kind.name(), typical.source));
        if mode.mirrored {
            self.remarks
                .push("These frames are mirrored: undo that, or the sign of velocity_m_s is the other one.".into());
        }
        if mode.flipped {
            self.remarks.push("These frames are upside down: gravity points upwards in them.".into());
        }
        Ok(())
    }

    fn with_keys(&mut self, by: &str, keys: &[(&'static str, Value)]) -> Result<()> {
        for (key, value) in keys {
            let same =
                |told: &str| told == *key || [told, *key].iter().all(|key| ["readout_s", "line_time_us"].contains(key));
            if let Some((told, other, of)) = self.told.iter().find(|(told, _, _)| same(told)) {
                ensure!(told == key && other == value, "{of} has {told} = {other}, but {by} has {key} = {value}");
                continue;
            }
            self.fill(key, value);
            self.told.push((*key, value.clone(), by.to_string()));
        }
        Ok(())
    }

    fn fill(&mut self, key: &str, value: &Value) {
        for line in &mut self.lines {
            if key_of_line(line) == Some(key) {
                *line = format!("{key} = {value}");
            } else if key == "line_time_us" && key_of_line(line) == Some("readout_s") && !line.starts_with('#') {
                *line = format!("# or: {line}");
            }
        }
    }

    fn text(self) -> String {
        let mut head = Vec::new();
        let mut told = self.told.iter().peekable();
        while let Some((first, _, by)) = told.next() {
            let mut keys = vec![*first];
            while let Some((key, _, _)) = told.next_if(|(_, _, other)| other == by) {
                keys.push(key);
            }
            head.push(format!("# Filled in from {by}: {}.", keys.join(", ")));
        }
        head.extend(self.remarks.iter().map(|remark| format!("# {remark}")));
        if !head.is_empty() {
            let is_told = |name: &str| self.told.iter().any(|(key, _, _)| *key == name);
            let open = REQUIRED.iter().filter(|(key, other)| !is_told(key) && !is_told(other)).map(|(key, _)| *key);
            head.push(format!("# Still an example, to be replaced: {}.\n#", open.collect::<Vec<_>>().join(", ")));
        }
        head.into_iter().chain(self.lines).map(|line| line + "\n").collect()
    }
}
