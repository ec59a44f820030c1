//! Values of arguments: what each must be.

use std::path::PathBuf;

use crate::input::bounds::Bounds;
use crate::input::camera_keys::FOCAL_PX;
use crate::input::pass_file::READOUT;

fn within(text: &str, least: f64, most: f64, expected: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| (least..=most).contains(number));
    number.ok_or_else(|| format!("it must be {expected}"))
}

/// As a file may have it.
fn as_in_files(text: &str, bounds: Bounds) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| bounds.contain(*number));
    number.ok_or_else(|| format!("it must be {bounds}"))
}

/// As a setup may have it.
pub(crate) fn focal_length(text: &str) -> Result<f64, String> {
    as_in_files(text, FOCAL_PX)
}

/// As passes may have it.
pub(crate) fn readout(text: &str) -> Result<f64, String> {
    as_in_files(text, READOUT)
}

pub(crate) fn above_zero(text: &str) -> Result<f64, String> {
    within(text, f64::MIN_POSITIVE, f64::MAX, "a finite number above 0")
}

pub(crate) fn frequency(text: &str) -> Result<f64, String> {
    within(text, 1.0, 100_000.0, "a number from 1 to 100000 (Hz)")
}

pub(crate) fn frequency_sigma(text: &str) -> Result<f64, String> {
    within(text, 0.0, 100_000.0, "a number from 0 to 100000 (Hz)")
}

/// Of targets that the library plans for.
pub(crate) fn depth(text: &str) -> Result<f64, String> {
    within(text, 0.001, 100_000.0, "a number from 0.001 to 100000 (m)")
}

pub(crate) fn wanted_sigma(text: &str) -> Result<f64, String> {
    within(text, 0.00001, 1.0, "a number from 0.00001 to 1 (relative: 0.1 is 10 %)")
}

/// Lowest and highest speed that the library plans for.
pub(crate) const SPEEDS_M_S: (f64, f64) = (0.001, 1000.0);

pub(crate) fn speed(text: &str) -> Result<f64, String> {
    let (least, most) = SPEEDS_M_S;
    within(text, least, most, &format!("a number from {least} to {most} (m/s)"))
}

pub(crate) fn height(text: &str) -> Result<f64, String> {
    within(text, 0.0001, 20_000.0, "a number from 0.0001 to 20000 (m)")
}

pub(crate) fn width(text: &str) -> Result<f64, String> {
    within(text, 0.0001, 10_000.0, "a number from 0.0001 to 10000 (m)")
}

pub(crate) fn bearing(text: &str) -> Result<f64, String> {
    within(text, -10.0, 10.0, "a number from -10 to 10 (x/z)")
}

pub(crate) fn pixel_noise(text: &str) -> Result<f64, String> {
    within(text, 0.0, 100.0, "a number from 0 to 100")
}

pub(crate) fn roll(text: &str) -> Result<f64, String> {
    within(text, 0.0, 45.0, "a number from 0 to 45 (degrees)")
}

pub(crate) fn contrast(text: &str) -> Result<f64, String> {
    within(text, 1.0, 230.0, "a number from 1 to 230 (grey levels)")
}

pub(crate) fn swing_angle(text: &str) -> Result<f64, String> {
    within(text, 0.0, 57.0, "a number from 0 to 57 (degrees)")
}

pub(crate) fn swing_frequency(text: &str) -> Result<f64, String> {
    within(text, 0.01, 10.0, "a number from 0.01 to 10 (Hz)")
}

pub(crate) fn clock_offset(text: &str) -> Result<f64, String> {
    within(text, -0.05, 0.05, "a number from -0.05 to 0.05 (seconds)")
}

pub(crate) fn svg_path(text: &str) -> Result<PathBuf, String> {
    path_ending_in("svg", text)
}

pub(crate) fn png_path(text: &str) -> Result<PathBuf, String> {
    path_ending_in("png", text)
}

pub(crate) fn html_path(text: &str) -> Result<PathBuf, String> {
    path_ending_in("html", text)
}

fn path_ending_in(ending: &str, text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let ends = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending));
    if ends { Ok(path) } else { Err(format!("it must end in .{ending}")) }
}

pub(crate) fn megahertz(text: &str) -> Result<f64, String> {
    let megahertz = text.parse().ok().filter(|megahertz| (1.0..=100.0).contains(megahertz));
    megahertz.ok_or_else(|| "it must be a number from 1 to 100 (MHz)".to_string())
}

pub(crate) fn interval(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.0..=3600.0).contains(seconds));
    seconds.ok_or_else(|| "it must be a number from 0 to 3600 (seconds)".to_string())
}

/// Unlike simulated frames, those of a sequence cannot be of the same instant.
pub(crate) fn interval_of_a_sequence(text: &str) -> Result<f64, String> {
    let seconds = interval(text).ok().filter(|seconds| *seconds > 0.0);
    seconds.ok_or_else(|| "it must be a number above 0, at most 3600 (seconds)".to_string())
}
