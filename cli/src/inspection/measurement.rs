//! [`Measurement`]: all that is measured of a frame, and of several together.

use serde::Serialize;

use super::grey::Grey;
use super::robust::median;
use super::row_changes::Bands;
use super::{bands, blocks, edge_profile, levels, noise, offsets};

/// In grey levels of 0 to 255 and in pixels.
#[derive(Clone, Serialize)]
pub(crate) struct Measurement {
    /// One sigma where the frame is this bright.
    pub(crate) noise: Vec<NoiseAt>,
    pub(crate) noise_sigma: f64,
    pub(crate) read_noise: f64,
    /// Variance per grey level; negative where bright parts are less noisy than dark ones.
    pub(crate) shot_gain: f64,
    /// How much neighbours share noise: 0 for none, above for smoothed, below for sharpened frames.
    pub(crate) noise_correlation: f64,
    /// Variance from pixel to pixel over that of every second one: 1 where noise is white, more where it is sharpened.
    pub(crate) noise_roughness: f64,
    /// Variance of the noise on even over odd columns, and rows.
    pub(crate) noise_parity_columns: f64,
    pub(crate) noise_parity_rows: f64,
    pub(crate) clipped_dark: f64,
    pub(crate) clipped_bright: f64,
    pub(crate) levels_used: f64,
    pub(crate) levels_between: f64,
    pub(crate) darkest: f64,
    pub(crate) brightest: f64,
    /// Sigmas of the offsets.
    pub(crate) column_offsets: f64,
    pub(crate) row_offsets: f64,
    /// How much more neighbours differ over the borders of blocks.
    pub(crate) block_excess: f64,
    /// Crossings of rows and isolated upright edges, which the following rests on.
    pub(crate) edge_crossings: f64,
    /// How far edges overshoot, as a share of their step.
    pub(crate) halo_dark: f64,
    pub(crate) halo_bright: f64,
    pub(crate) edge_blur_px: Option<f64>,
    pub(crate) band_amplitude: f64,
    pub(crate) band_periods: f64,
    pub(crate) band_purity: f64,
}

#[derive(Clone, Serialize)]
pub(crate) struct NoiseAt {
    pub(crate) level: f64,
    pub(crate) sigma: f64,
}

impl Measurement {
    pub(crate) fn of(grey: &Grey<'_>) -> Self {
        let noise = noise::of(grey);
        let levels = levels::of(grey);
        let profile = edge_profile::of(grey, noise.sigma);
        let [halo_dark, halo_bright] = profile.halos();
        let bands = bands::of(grey);
        let band = |value: fn(&Bands) -> f64| bands.as_ref().map_or(0.0, value);
        Self {
            noise: noise.bins.iter().map(|&(level, sigma)| NoiseAt { level, sigma }).collect(),
            noise_sigma: noise.sigma,
            read_noise: noise.read_variance.max(0.0).sqrt(),
            shot_gain: noise.shot_gain,
            noise_correlation: noise.correlation,
            noise_roughness: noise.roughness,
            noise_parity_columns: noise.parity[0],
            noise_parity_rows: noise.parity[1],
            clipped_dark: levels.clipped_dark,
            clipped_bright: levels.clipped_bright,
            levels_used: levels.used as f64,
            levels_between: levels.span as f64,
            darkest: levels.darkest as f64,
            brightest: levels.brightest as f64,
            column_offsets: offsets::of_columns(grey, noise.sigma),
            row_offsets: offsets::of_rows(grey, noise.sigma),
            block_excess: blocks::excess(grey, noise.sigma),
            edge_crossings: profile.crossings as f64,
            halo_dark,
            halo_bright,
            edge_blur_px: profile.blur_px(),
            band_amplitude: band(|bands| bands.amplitude),
            band_periods: band(|bands| bands.periods),
            band_purity: band(|bands| bands.purity),
        }
    }

    /// The median of each value; noise against brightness as in the frame in the middle of all by its noise.
    pub(crate) fn together(frames: &[Self]) -> Option<Self> {
        let of = |value: fn(&Self) -> f64| median(frames.iter().map(value));
        let mut by_noise: Vec<&Self> = frames.iter().collect();
        by_noise.sort_by(|a, b| a.noise_sigma.total_cmp(&b.noise_sigma));
        let middle = by_noise.get(by_noise.len() / 2)?;
        let blurs: Vec<f64> = frames.iter().filter_map(|frame| frame.edge_blur_px).collect();
        Some(Self {
            noise: middle.noise.clone(),
            noise_sigma: of(|frame| frame.noise_sigma),
            read_noise: middle.read_noise,
            shot_gain: middle.shot_gain,
            noise_correlation: of(|frame| frame.noise_correlation),
            noise_roughness: of(|frame| frame.noise_roughness),
            noise_parity_columns: of(|frame| frame.noise_parity_columns),
            noise_parity_rows: of(|frame| frame.noise_parity_rows),
            clipped_dark: of(|frame| frame.clipped_dark),
            clipped_bright: of(|frame| frame.clipped_bright),
            levels_used: of(|frame| frame.levels_used),
            levels_between: of(|frame| frame.levels_between),
            darkest: of(|frame| frame.darkest),
            brightest: of(|frame| frame.brightest),
            column_offsets: of(|frame| frame.column_offsets),
            row_offsets: of(|frame| frame.row_offsets),
            block_excess: of(|frame| frame.block_excess),
            edge_crossings: of(|frame| frame.edge_crossings),
            halo_dark: of(|frame| frame.halo_dark),
            halo_bright: of(|frame| frame.halo_bright),
            edge_blur_px: (!blurs.is_empty()).then(|| median(blurs)),
            band_amplitude: of(|frame| frame.band_amplitude),
            band_periods: of(|frame| frame.band_periods),
            band_purity: of(|frame| frame.band_purity),
        })
    }
}
