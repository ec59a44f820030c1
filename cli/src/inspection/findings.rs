//! What of a [`Measurement`] matters for ranging, and which keys of a setup follow.

use serde::Serialize;

use super::measurement::Measurement;
use crate::input::grey_levels::UnusedBits;

#[derive(Serialize)]
pub(crate) struct Finding {
    /// In one or two words: an interface, as statuses are.
    pub(crate) name: &'static str,
    /// What is seen, and what to do about it.
    pub(crate) text: String,
}

/// Keys of [camera] that the frames speak for.
#[derive(Serialize)]
pub(crate) struct Keys {
    pub(crate) response: &'static str,
    pub(crate) sigma_blur: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) bits: Option<u32>,
}

/// Beside the measurement.
pub(crate) struct Further {
    /// Share of the frames whose neighbouring columns alternate.
    pub(crate) alternating_frames: f64,
    pub(crate) unused_bits: Option<UnusedBits>,
}

/// Each is beyond what clean frames of the simulator show, and below the smallest effect that moves a distance by a
/// sigma.
const CLIPPED_SHARE: f64 = 0.01;
const HALO_SHARE: f64 = 0.005;
const SHARED_NOISE: f64 = 0.04;
const SHARPENED_NOISE: f64 = 1.14;
const SMOOTHED_NOISE: f64 = 0.8;
const FEWEST_NOISE: f64 = 0.4;
const NO_NOISE: f64 = 0.15;
const UNLIKE_COLUMNS: f64 = 1.12;
const BLOCK_EXCESS: f64 = 0.1;
const OFFSET_LEVELS: f64 = 0.25;
const USED_LEVELS: f64 = 0.7;
const BAND_AMPLITUDE: f64 = 0.01;
const BAND_PURITY: f64 = 0.6;
const SOFT_PX: f64 = 1.5;

type Check = fn(&Measurement, &Further) -> Option<String>;

/// From what makes frames useless to what makes distances a little worse.
const CHECKS: [(&str, Check); 11] = [
    ("alternating", alternating),
    ("unused bits", unused_bits),
    ("clipped", clipped),
    ("halos", halos),
    ("denoised", denoised),
    ("mosaic", mosaic),
    ("blocks", blocks),
    ("offsets", offsets),
    ("coarse levels", coarse_levels),
    ("bands", bands),
    ("soft", soft),
];

pub(crate) fn of(measured: &Measurement, further: &Further) -> Vec<Finding> {
    let found = |(name, check): &(&'static str, Check)| check(measured, further).map(|text| Finding { name, text });
    CHECKS.iter().filter_map(found).collect()
}

pub(crate) fn keys(measured: &Measurement, further: &Further, findings: &[Finding]) -> Keys {
    let has = |name: &str| findings.iter().any(|finding| finding.name == name);
    let is_processed = ["halos", "denoised", "mosaic", "blocks", "coarse levels"].into_iter().any(has);
    let is_linear = noise_rises_with_light(measured) && !is_processed;
    Keys {
        response: if is_linear { "linear" } else { "unknown" },
        sigma_blur: if is_linear { 0.02 } else { 0.25 },
        bits: further.unused_bits.map(|unused| unused.bits),
    }
}

/// As the photons of linear pixels do: a tone curve turns that around, since it flattens what is bright.
fn noise_rises_with_light(measured: &Measurement) -> bool {
    const LEAST_RANGE: f64 = 60.0;
    const LEAST_RISE: f64 = 1.2;
    let (Some(dark), Some(bright)) = (measured.noise.first(), measured.noise.last()) else { return false };
    bright.level - dark.level >= LEAST_RANGE && bright.sigma > LEAST_RISE * dark.sigma
}

fn percent(share: f64) -> f64 {
    share * 100.0
}

fn alternating(_: &Measurement, further: &Further) -> Option<String> {
    (further.alternating_frames > 0.5).then(|| {
        "neighbouring columns alternate: this is a Bayer mosaic or YUYV read as grey; convert it to grey first"
            .to_string()
    })
}

fn unused_bits(_: &Measurement, further: &Further) -> Option<String> {
    further.unused_bits.map(|UnusedBits { most, bits }| {
        format!("no level is above {most} of 65535: set bits = {bits}, or most of the grey levels are lost")
    })
}

fn clipped(measured: &Measurement, _: &Further) -> Option<String> {
    let (dark, bright) = (measured.clipped_dark, measured.clipped_bright);
    (dark.max(bright) >= CLIPPED_SHARE).then(|| {
        format!(
            "{:.0} % of the pixels are black and {:.0} % white: the blur of edges beside them is not measured; expose for \
             the brighter side, with exposure and gain fixed",
            percent(dark),
            percent(bright)
        )
    })
}

fn halos(measured: &Measurement, _: &Further) -> Option<String> {
    let halo = measured.halo_dark.max(measured.halo_bright);
    let is_rough = measured.noise_roughness > SHARPENED_NOISE && measured.noise_sigma >= FEWEST_NOISE;
    (halo >= HALO_SHARE || is_rough).then(|| {
        format!(
            "edges overshoot by {:.1} % of their step, and the fine part of the noise is {:.2} of what it should be: the \
             frames are sharpened. Switch sharpening off; if that cannot be done, leave exposure_s out",
            percent(halo),
            measured.noise_roughness
        )
    })
}

fn denoised(measured: &Measurement, _: &Further) -> Option<String> {
    let advice = "Switch denoising off, or expect errors beyond sigma";
    if measured.noise_sigma < NO_NOISE {
        return Some(format!(
            "there is no noise left, {:.2} levels: the frames are denoised or compressed. {advice}",
            measured.noise_sigma
        ));
    }
    let is_smooth = measured.noise_correlation > SHARED_NOISE || measured.noise_roughness < SMOOTHED_NOISE;
    let is_shared = measured.noise_sigma >= FEWEST_NOISE && is_smooth;
    is_shared.then(|| {
        format!(
            "neighbours share their noise (excess correlation {:.2}, fine part {:.2} of what it should be): the frames are \
             denoised, scaled, or interpolated from a colour mosaic. {advice}",
            measured.noise_correlation, measured.noise_roughness
        )
    })
}

fn mosaic(measured: &Measurement, _: &Further) -> Option<String> {
    let unlike = |ratio: f64| ratio.max(1.0 / ratio) > UNLIKE_COLUMNS;
    let is_unlike = unlike(measured.noise_parity_columns) || unlike(measured.noise_parity_rows);
    (is_unlike && measured.noise_sigma >= FEWEST_NOISE).then(|| {
        format!(
            "the noise of even and odd columns differs by a factor of {:.2}, that of rows by {:.2}: colours were interpolated \
             from a mosaic. Take raw green or a monochrome sensor for the best edges",
            measured.noise_parity_columns, measured.noise_parity_rows
        )
    })
}

fn blocks(measured: &Measurement, _: &Further) -> Option<String> {
    (measured.block_excess > BLOCK_EXCESS).then(|| {
        format!(
            "steps at every eighth row and column are {:.0} % larger than elsewhere: JPEG or a video codec at a low quality. \
             Raise the quality, or take uncompressed frames",
            percent(measured.block_excess)
        )
    })
}

fn offsets(measured: &Measurement, _: &Further) -> Option<String> {
    let (columns, rows) = (measured.column_offsets, measured.row_offsets);
    (columns.max(rows) > OFFSET_LEVELS).then(|| {
        format!(
            "columns are offset by {columns:.1} and rows by {rows:.1} levels (one sigma), alike in a whole line: sigma does \
             not know of it. Subtract a dark frame"
        )
    })
}

fn coarse_levels(measured: &Measurement, _: &Further) -> Option<String> {
    let (used, between) = (measured.levels_used, measured.levels_between);
    (between >= 24.0 && used < USED_LEVELS * between).then(|| {
        format!(
            "{used:.0} of the {between:.0} levels from {:.0} to {:.0} are used: fewer bits than the file has, or a curve after \
             rounding. Take the sensor's own bits",
            measured.darkest, measured.brightest
        )
    })
}

fn bands(measured: &Measurement, _: &Further) -> Option<String> {
    let is_periodic = measured.band_amplitude > BAND_AMPLITUDE && measured.band_purity > BAND_PURITY;
    is_periodic.then(|| {
        format!(
            "brightness goes up and down by {:.1} %, {:.1} times in the frame: a light flickers. Expose for a whole number of \
             its periods; or use it to measure the readout. Look again without: bands pass for noise and halos",
            percent(measured.band_amplitude),
            measured.band_periods
        )
    })
}

fn soft(measured: &Measurement, _: &Further) -> Option<String> {
    let blur_px = measured.edge_blur_px.filter(|blur_px| *blur_px > SOFT_PX)?;
    Some(format!("edges are blurred by {blur_px:.1} px (one sigma): focus the lens, or expose for a shorter time"))
}
