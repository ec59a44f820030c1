//! A mode of the library's table of sensors, by its name, as keys of a setup's [camera].

use anyhow::{Result, anyhow, bail};
use shutter_range::sensor::{Mode, TypicalMode, typical_modes};
use toml::Value;

use super::nearest::nearest;

/// "OV7725", "QVGA, OpenMV H7": `ov7725-qvga-openmv-h7`
pub(crate) fn name(typical: &TypicalMode) -> String {
    words(&format!("{} {}", typical.chip.name(), typical.name))
}

fn words(text: &str) -> String {
    let parts = text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|part| !part.is_empty());
    parts.map(str::to_ascii_lowercase).collect::<Vec<_>>().join("-")
}

/// The only mode whose name begins with these words or, of several, the only one with this clock.
pub(crate) fn find(asked: &str, clock_mhz: Option<f64>) -> Result<&'static TypicalMode> {
    let asked = words(asked);
    let begins = |typical: &&TypicalMode| {
        let name = name(typical);
        name.strip_prefix(&asked).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
    };
    let found: Vec<_> = typical_modes().iter().filter(begins).collect();
    let has_clock = |typical: &&&TypicalMode| clock_mhz.is_some_and(|mhz| f64::from(typical.clock_hz) == mhz * 1e6);
    let of_clock: Vec<_> = found.iter().filter(has_clock).copied().collect();
    match (&found[..], &of_clock[..]) {
        ([only], _) | (_, [only]) => Ok(only),
        ([], _) => Err(unknown(&asked)),
        _ => bail!("--sensor {asked} may be {}: say which, or the clock by --clock-mhz", listed(&found)),
    }
}

fn listed(modes: &[&TypicalMode]) -> String {
    let mode = |typical: &&TypicalMode| format!("{} ({} MHz)", name(typical), typical.clock_hz / 1_000_000);
    modes.iter().map(mode).collect::<Vec<_>>().join(" or ")
}

fn unknown(asked: &str) -> anyhow::Error {
    let chip = asked.split('-').next().unwrap_or_default();
    let of_chip: Vec<_> = typical_modes().iter().filter(|typical| words(typical.chip.name()) == chip).collect();
    if !of_chip.is_empty() {
        return anyhow!("--sensor {asked} is unknown; there is {}", listed(&of_chip));
    }
    let names: Vec<_> = typical_modes().iter().map(name).collect();
    let names: Vec<_> = names.iter().map(String::as_str).collect();
    match nearest(asked, &names) {
        Some(nearest) => {
            anyhow!("--sensor {asked} is unknown; the nearest is {nearest} (shutter-range sensors lists all)")
        }
        None => anyhow!("--sensor {asked} is unknown: shutter-range sensors lists all"),
    }
}

/// The keys of its [camera].
pub(crate) fn keys(mode: &Mode) -> Vec<(&'static str, Value)> {
    let sigma: f64 = mode.sigma();
    vec![
        ("columns", Value::Integer(mode.columns.into())),
        ("rows", Value::Integer(mode.rows().into())),
        ("line_time_us", Value::Float(mode.readout.line_time_ps() as f64 / 1e6)),
        ("sigma_readout", Value::Float(sigma)),
    ]
}
