//! Scene files: what the simulated camera sees, in TOML.

use anyhow::{Result, anyhow};
use serde::Deserialize;
use shutter_range::ParameterError;
use shutter_range::sim::{Background, Bar, Exposure, Flicker, Rail, Scene, Texture};
use toml::Table;

use super::bounded_read::{Limit, MEBIBYTE};
use super::bounds::Bounds;
use super::toml_file;

/// A scene has at most this many bars and rails.
pub(crate) const OBJECTS: usize = 64;

/// A scene of 64 objects takes about ten kilobytes.
pub(crate) const LIMIT: Limit<'_> = Limit { bytes: MEBIBYTE, rule: "a scene must have at most" };

/// The scene for those who give none.
pub(crate) const STREET: &str = include_str!("street.toml");

pub(crate) struct SceneFile {
    pub(crate) scene: Scene<OBJECTS>,
    /// One sigma in grey levels.
    pub(crate) read_noise: f32,
    /// Variance per grey level.
    pub(crate) shot_gain: f32,
    /// Light that is not steady.
    pub(crate) lamp: Option<Flicker>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneToml {
    background: BackgroundToml,
    #[serde(default)]
    bar: Vec<BarToml>,
    #[serde(default)]
    rail: Vec<RailToml>,
    #[serde(default)]
    sensor: SensorToml,
    lamp: Option<LampToml>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BackgroundToml {
    level: f32,
    #[serde(default)]
    contrast: f32,
    #[serde(default = "usual_cell")]
    cell: f32,
    #[serde(default)]
    seed: u32,
}

/// Size of a texture's cell as a bearing: some dozens of pixels.
fn usual_cell() -> f32 {
    0.1
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BarToml {
    bearing: f32,
    depth_m: f32,
    width_m: f32,
    level: f32,
    top_m: Option<f32>,
    bottom_m: Option<f32>,
    #[serde(default)]
    lean_deg: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RailToml {
    depth_m: f32,
    top_m: f32,
    bottom_m: f32,
    level: f32,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct SensorToml {
    read_noise: Option<f32>,
    shot_gain: Option<f32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LampToml {
    frequency_hz: f32,
    #[serde(default = "all_of_it")]
    depth: f32,
    duty: Option<f32>,
}

/// Of the light.
fn all_of_it() -> f32 {
    1.0
}

pub(crate) fn parse(text: &str) -> Result<SceneFile> {
    check_brackets(&toml_file::parse(text)?)?;
    let file: SceneToml = toml_file::parse(text)?;
    let count = file.bar.len() + file.rail.len();
    if count > OBJECTS {
        return Err(anyhow!("the scene has {count} bars and rails, but must have at most {OBJECTS}"));
    }
    let BackgroundToml { level, contrast, cell, seed } = file.background;
    let texture = Texture { contrast, cell, seed };
    let background = if contrast == 0.0 { Background::plain(level) } else { Background::textured(level, texture) };
    let mut scene = Scene::new(background).map_err(|error| anyhow!("[background]: {error}"))?;
    for (number, bar) in (1..).zip(&file.bar) {
        let pushed = scene.push(bar.as_bar());
        pushed.map_err(|error| anyhow!("[[bar]] number {number}: {}", bar.refuse(&error)))?;
    }
    for (number, &RailToml { depth_m, top_m, bottom_m, level }) in (1..).zip(&file.rail) {
        let pushed = scene.push(Rail { depth_m, top_m, bottom_m, level });
        pushed.map_err(|error| anyhow!("[[rail]] number {number}: {error}"))?;
    }
    let (sensor, usual) = (file.sensor, Exposure::default());
    let read_noise = noise("read_noise", sensor.read_noise.unwrap_or(usual.read_noise), "grey levels, one sigma")?;
    let shot_gain = noise("shot_gain", sensor.shot_gain.unwrap_or(usual.shot_gain), "variance per grey level")?;
    let lamp = file.lamp.map(|LampToml { frequency_hz, depth, duty }| Flicker { frequency_hz, depth, duty });
    Ok(SceneFile { scene, read_noise, shot_gain, lamp })
}

/// Single and double brackets are easily mistaken for each other.
fn check_brackets(file: &Table) -> Result<()> {
    for name in ["bar", "rail"] {
        if file.get(name).is_some_and(|value| !value.is_array()) {
            return Err(anyhow!("`{name}` must be written [[{name}]], in double brackets, before each {name}"));
        }
    }
    for name in ["background", "sensor", "lamp"] {
        if file.get(name).is_some_and(|value| !value.is_table()) {
            return Err(anyhow!("`{name}` must be written [{name}], in single brackets, and once"));
        }
    }
    Ok(())
}

/// Checks the simulator's limits here, where the key and the file are known.
fn noise(key: &str, value: f32, what: &'static str) -> Result<f32> {
    let bounds = Bounds::number(0.0, 100.0, what);
    if bounds.contain(value.into()) {
        Ok(value)
    } else {
        Err(anyhow!("`sensor.{key}` is {value}, but must be {bounds}"))
    }
}

impl BarToml {
    fn as_bar(&self) -> Bar {
        let unlimited = Bar::upright(self.bearing, self.depth_m, self.width_m, self.level);
        let bar = unlimited.between(self.top_m.unwrap_or(unlimited.top_m), self.bottom_m.unwrap_or(unlimited.bottom_m));
        bar.leaning(self.lean_deg.to_radians().tan() as f32)
    }

    fn refuse(&self, error: &ParameterError) -> String {
        match error.parameter {
            "lean" => format!("lean_deg is {}, but must be -84 to 84 (degrees)", self.lean_deg),
            _ => error.to_string(),
        }
    }
}
