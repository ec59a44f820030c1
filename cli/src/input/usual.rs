//! [`Usual`]: refuses values that are possible but hardly ever meant, such as milliseconds for seconds, unless the
//! setup says that they are.

use std::fmt::{self, Display, Formatter};

use anyhow::{Result, anyhow};
use toml::{Table, Value};

use super::keys::UNUSUAL;
use super::nearest::{list, nearest};

/// Keys whose value has a usual range.
const KEYS: [&str; 10] = [
    "readout_s",
    "line_time_us",
    "line_length_clocks",
    "exposure_s",
    "fx",
    "fy",
    "focal_length_mm",
    "velocity_m_s",
    "rate_rad_s",
    "gravity",
];

/// Of a whole frame.
pub(crate) const READOUT_S: (f64, f64) = (0.001, 0.5);
const MOST_EXPOSURE_S: f64 = 0.1;
const MOST_VIEW_DEG: f64 = 170.0;
const MOST_SPEED_M_S: f64 = 150.0;
const MOST_RATE_RAD_S: f64 = 30.0;
const LEAST_OFF_AXIS_DEG: f64 = 15.0;

/// What the values of a setup may be: all that is usual, and what lies outside and is meant.
pub(crate) struct Usual {
    meant: Vec<&'static str>,
}

/// What is unusual about a value.
pub(crate) struct Objection {
    /// Such as "a readout of 33.3 s".
    meaning: String,
    /// Such as "0.001 to 0.5 s".
    expected: String,
}

impl Objection {
    fn unless(is_usual: bool, meaning: String, expected: String) -> Option<Self> {
        (!is_usual).then_some(Self { meaning, expected })
    }
}

impl Display for Objection {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}, but must be {}", self.meaning, self.expected)
    }
}

impl Usual {
    /// From the key `unusual` of a setup.
    pub(crate) fn of(file: &Table) -> Result<Self> {
        let Some(value) = file.get(UNUSUAL) else { return Ok(Self { meant: Vec::new() }) };
        let names = value.as_array().ok_or_else(|| refused(value))?;
        Ok(Self { meant: names.iter().map(known).collect::<Result<_>>()? })
    }

    /// Refuses the value of a key if there is an objection, unless the setup says that it is meant. `value` tells where
    /// the value is and what it is.
    pub(crate) fn check(&self, key: &str, objection: Option<Objection>, value: impl FnOnce() -> String) -> Result<()> {
        match objection.filter(|_| !self.meant.contains(&key)) {
            Some(objection) => Err(anyhow!(
                "{}, {objection}; if it is meant, say `{UNUSUAL} = [\"{key}\"]` at the top of the setup",
                value()
            )),
            None => Ok(()),
        }
    }
}

fn refused(value: &Value) -> anyhow::Error {
    anyhow!("`{UNUSUAL}` is {value}, but must be a list of keys such as [\"readout_s\"]")
}

fn known(value: &Value) -> Result<&'static str> {
    let name = value.as_str().ok_or_else(|| refused(value))?;
    let key = KEYS.into_iter().find(|key| *key == name);
    key.ok_or_else(|| match nearest(name, &KEYS) {
        Some(nearest) => anyhow!("`{UNUSUAL}` names `{name}`; the nearest key is `{nearest}`"),
        None => anyhow!("`{UNUSUAL}` names `{name}`; the keys with a usual range are {}", list(&KEYS)),
    })
}

pub(crate) fn readout(readout_s: f64) -> Option<Objection> {
    let (least, most) = READOUT_S;
    let is_usual = (least..=most).contains(&readout_s);
    Objection::unless(is_usual, in_words(readout_s), format!("{least} to {most} s for a frame"))
}

pub(crate) fn in_words(readout_s: f64) -> String {
    let to_a_microsecond = (readout_s * 1e6).round() / 1e6;
    format!("a readout of {to_a_microsecond} s")
}

/// The time from frame to frame bounds it, where that is known.
pub(crate) fn exposure(exposure_s: f64, interval_s: Option<f64>, readout_s: f64) -> Option<Objection> {
    let (most_s, why) = match interval_s {
        Some(interval_s) => (interval_s, ", the time from frame to frame"),
        None => (MOST_EXPOSURE_S.max(readout_s), ""),
    };
    let meaning = format!("an exposure of {exposure_s} s");
    Objection::unless(exposure_s <= most_s, meaning, format!("at most {most_s} s{why}"))
}

/// The angle that so many pixels see; the principal point may lie outside them.
pub(crate) fn view(pixels: u16, focal_px: f64, centre_px: f64) -> Option<Objection> {
    let angle = |pixel: f64| ((pixel - centre_px) / focal_px).atan().to_degrees();
    let view_deg = angle(f64::from(pixels) - 0.5) - angle(-0.5);
    let meaning = format!("a view of {view_deg:.1}° over {pixels} pixels");
    Objection::unless(view_deg <= MOST_VIEW_DEG, meaning, format!("at most {MOST_VIEW_DEG}°"))
}

pub(crate) fn speed(velocity_m_s: [f64; 3]) -> Option<Objection> {
    let speed = length(velocity_m_s);
    let expected = format!("at most {MOST_SPEED_M_S} m/s");
    Objection::unless(speed <= MOST_SPEED_M_S, format!("a speed of {speed:.1} m/s"), expected)
}

pub(crate) fn rate(rate_rad_s: [f64; 3]) -> Option<Objection> {
    let rate = length(rate_rad_s);
    let expected = format!("at most {MOST_RATE_RAD_S} rad/s, five turns a second");
    Objection::unless(rate <= MOST_RATE_RAD_S, format!("a rate of {rate:.1} rad/s"), expected)
}

/// A camera that looks straight up or down sees no upright edges. `axes` are those in which gravity was told.
pub(crate) fn gravity(gravity: [f64; 3], axes: &str) -> Option<Objection> {
    let [_, _, along] = gravity;
    let off_axis_deg = (along.abs() / length(gravity)).min(1.0).acos().to_degrees();
    let expected = format!("at least {LEAST_OFF_AXIS_DEG}° (axes: {axes})");
    let meaning = format!("{off_axis_deg:.1}° off the optical axis");
    Objection::unless(off_axis_deg >= LEAST_OFF_AXIS_DEG, meaning, expected)
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|component| component * component).sum::<f64>().sqrt()
}
