//! [`EdgeModel::quick_fit`]: place and width in a row of grey bytes whose window may be cut off.

use super::factor::Factor;
use super::fit::{Contrast, alike};
use super::level_moments::{FreeLevels, LevelMoments, Shares};
use super::model::{EdgeModel, Fit};
use super::moments::Moments;
use super::norms::{LEAST_SLOPE_SLOPE, of_levels_q12, per_freedom_q16, reciprocal, sigma_q8, sigma_q16};
use super::pixel_row::{PixelRow, Stretch, mean_q8};
use super::template::Sampled;
use super::weight::Weight;
use super::window::Parts;
use crate::format::Pixels;

/// Inner products over a flank: of what is off the expected step, with slope and widening, and of these with
/// themselves.
#[derive(Default)]
struct Sums {
    slope: i32,
    widening: i32,
    slope_slope: u32,
    widening_widening: u32,
    /// Of the slope alone.
    whole_slope: u32,
}

/// Each pixel of a flank minus what is expected there, in 1/64 of a level, with its weight.
#[inline(always)]
fn residuals<'w>(
    flank: &[u8],
    weights: &'w [Weight],
    [left_q8, right_q8]: [i32; 2],
) -> impl Iterator<Item = (i32, &'w Weight)> {
    let (left_q6, contrast_q6) = (left_q8 >> 2, (right_q8 >> 2) - (left_q8 >> 2));
    flank.iter().zip(weights).map(move |(pixel, weight)| {
        let expected_q6 = left_q6 + ((contrast_q6 * i32::from(weight.step)) >> 15);
        ((i32::from(*pixel) << 6) - expected_q6, weight)
    })
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, residual_q6: i32, weight: &Weight) {
        let (slope, widening) = (i32::from(weight.slope), i32::from(weight.widening));
        self.slope += residual_q6 * slope;
        self.widening += residual_q6 * widening;
        self.slope_slope += (slope * slope) as u32;
        self.widening_widening += (widening * widening) as u32;
        self.whole_slope += slope as u32;
    }
}

/// What a flank shows, given levels.
struct Seen {
    sums: Sums,
    /// Of the slope with itself, less what free levels explain.
    sure_slope: u32,
    contrast: Contrast,
    levels_q8: [i32; 2],
    /// These minus the mean ones.
    off_q8: [i32; 2],
}

impl EdgeModel {
    /// Column and width of the edge near the expected column, as [`EdgeModel::fit_in_window`] finds them, in a row of grey
    /// bytes. No norms are needed but what the flank's own pixels sum up, and what remains of the row is measured only
    /// where that is asked for.
    #[inline(never)]
    pub(super) fn quick_fit<P: Pixels>(
        &self,
        row: PixelRow<'_, P>,
        column_q8: i32,
        bounds_q8: (i32, i32),
        is_measured: bool,
    ) -> Option<Fit> {
        let template = self.template();
        if !self.is_alone(column_q8, bounds_q8, row.columns()) {
            return None;
        }
        let Sampled { first, centre_q8, phase } = template.at(column_q8);
        let pixels = phase.weights.len() as i32;
        let parts = Parts::new(column_q8, first, pixels, template, bounds_q8, (row.columns(), row.colours()))?;
        let ([left, right], flank) = (parts.plateaus, parts.flank);
        let weights = phase.weights.get(parts.skipped..parts.skipped + flank.pixels())?;
        let window = row.quick_bytes()?.get(left.from..right.to)?;
        let of = |stretch: Stretch| window.get(stretch.from - left.from..stretch.to - left.from);
        let (own_q8, flank) = ([mean_q8(of(left)?)?, mean_q8(of(right)?)?], of(flank)?);
        let seen = if self.is_textured() {
            self.quick_free_levels(flank, weights, own_q8)?
        } else {
            self.quick_levels(flank, weights, own_q8)?
        };
        let Seen { sums, sure_slope, contrast, levels_q8, off_q8 } = seen;
        let plateaus = parts.plateaus.map(|plateau| plateau.pixels() as u32);
        if sums.slope_slope < LEAST_SLOPE_SLOPE || flank.len() < 3 {
            return None;
        }
        let (per_slope, per_widening) = (reciprocal(sums.slope_slope), reciprocal(sums.widening_widening));
        let residual_q16 = if is_measured {
            let per_widening = (!self.is_textured()).then_some(per_widening);
            let per_freedom_q16 = per_freedom_q16(flank.len() as u32, plateaus);
            Moments::of_bytes(flank, weights, levels_q8).residual_q16(per_slope, per_widening, per_freedom_q16)
        } else {
            0
        };
        let of_noise_q8 = sigma_q8(sums.whole_slope, sure_slope, of_levels_q12(plateaus));
        let sign = if contrast.is_falling { -1 } else { 1 };
        let product = |per: Factor, of: i32| per.roughly_and(contrast.reciprocal).product(sign * of);
        let change_q12 = product(template.per_width_of(per_widening), sums.widening);
        Some(Fit {
            column_q16: (centre_q8 << 8).saturating_sub(product(per_slope, sums.slope)),
            sigma_q16: sigma_q16(of_noise_q8, self.noise_q8, contrast.reciprocal),
            width_q12: (i32::from(template.width_q8) << 4) + change_q12.clamp(-(1 << 20), (1 << 20) - 1),
            residual_q16,
            off_q8,
            of_flank: [parts.is_narrow; 2],
        })
    }

    /// The plateaus tell the levels.
    #[inline(always)]
    fn quick_levels(&self, flank: &[u8], weights: &[Weight], levels_q8: [i32; 2]) -> Option<Seen> {
        let (off_q8, contrast) = self.against_means(0, levels_q8)?;
        let mut sums = Sums::default();
        residuals(flank, weights, levels_q8).for_each(|(residual_q6, weight)| sums.add(residual_q6, weight));
        let sure_slope = sums.slope_slope;
        Some(Seen { sums, sure_slope, contrast, levels_q8, off_q8 })
    }

    /// Beside texture the edge's own pixels tell the levels, as in [`EdgeModel::with_free_levels`]: what these change in
    /// the inner products is known without another look at the pixels.
    #[inline(always)]
    fn quick_free_levels(&self, flank: &[u8], weights: &[Weight], own_q8: [i32; 2]) -> Option<Seen> {
        let (mut sums, mut shares, mut right_widening, mut widening) = (Sums::default(), Shares::default(), 0, 0);
        for (residual_q6, weight) in residuals(flank, weights, own_q8) {
            sums.add(residual_q6, weight);
            let (right, slope) = (i32::from(weight.step >> 7), i32::from(weight.slope));
            shares.residual += residual_q6;
            shares.right += right;
            shares.right_right += right * right;
            shares.right_residual += right * residual_q6;
            shares.slope += slope;
            shares.right_slope += right * slope;
            widening += i32::from(weight.widening);
            right_widening += right * i32::from(weight.widening);
        }
        if sums.slope_slope < LEAST_SLOPE_SLOPE {
            return None;
        }
        let moments = LevelMoments::of_sums(flank.len() as i32, &shares);
        let FreeLevels { off_q8: free_q8, slope_slope } = moments.free(sums.slope, sums.slope_slope as i32)?;
        let ([left_q8, right_q8], [free_left_q8, free_right_q8], [own_left_q8, own_right_q8]) =
            (self.levels_q8(0), free_q8, own_q8);
        let levels_q8 = [own_left_q8 + free_left_q8, own_right_q8 + free_right_q8];
        let [found_left_q8, found_right_q8] = levels_q8;
        let off_q8 = [found_left_q8 - left_q8, found_right_q8 - right_q8];
        let [left_off_q8, right_off_q8] = off_q8;
        let contrast = Contrast::of(alike(right_q8 - left_q8, right_off_q8 - left_off_q8)?, self.template())?;
        sums.slope -= explained_q6(free_q8, moments.slopes());
        sums.widening -= explained_q6(free_q8, [(widening << 8) - right_widening, right_widening]);
        Some(Seen { sums, sure_slope: slope_slope as u32, contrast, levels_q8, off_q8 })
    }
}

/// What levels that are off, in 1/256 grey level, add to an inner product of residuals in 1/64 grey level, from their
/// own products with its weights, in 1/256.
#[inline(always)]
fn explained_q6([left_q8, right_q8]: [i32; 2], [of_left, of_right]: [i32; 2]) -> i32 {
    // 32 bits hold both parts: a level is off by at most 255, and the weights of a flank add up to less than 2¹³.
    let part = |off_q8: i32, of: i32| (off_q8 >> 2) * ((of + (1 << 7)) >> 8);
    part(left_q8, of_left) + part(right_q8, of_right)
}

#[cfg(test)]
mod tests {
    use super::super::window::Neighbours;
    use super::{EdgeModel, Fit, PixelRow};
    use crate::edge::{EdgePoint, Polarity};
    use crate::setup::Response;

    const MIDDLE_PX: f64 = 60.0;

    /// An edge in the middle with neighbours so far away, of the other polarity.
    fn row_of(apart_px: f64, off_px: f64, seed: u32) -> [u8; 120] {
        let mut mixed = seed;
        let mut noise = || {
            mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2c1b_3c6d).wrapping_add(0x9e37_79b9);
            f64::from(mixed >> 16) / 65536.0 * 8.0 - 4.0
        };
        let step = |px: f64| 0.5 * (1.0 + libm::erf(px / 1.13));
        core::array::from_fn(|column| {
            let px = column as f64 - MIDDLE_PX - off_px;
            let shown = step(px) - step(px - apart_px) + 1.0 - step(px + apart_px);
            (60.0 + 100.0 * shown + noise()) as u8
        })
    }

    /// It finds the column and the width that the whole fit finds, with the same sigma, also where neighbours cut its
    /// window off and where the flank tells the levels: to a tenth of a sigma of the column.
    #[test]
    fn it_is_a_fit() {
        for apart_px in [5.0, 6.5, 9.0, 40.0] {
            for (seed, off_px) in [(1, 0.0), (2, 0.2), (3, 0.45), (4, -0.3), (5, 0.7), (6, -0.1)] {
                let pixels = row_of(apart_px, off_px, seed);
                let row = PixelRow { pixels: &pixels[..], response: &Response::Linear };
                let q16 = |px: f64| (px * 65536.0) as i32;
                let column_q16 = q16(MIDDLE_PX + off_px);
                let around = Neighbours { left_q16: column_q16 - q16(apart_px), right_q16: column_q16 + q16(apart_px) };
                let edge = EdgePoint { width_q8: 210, ..EdgePoint::new(0, column_q16, 0) };
                let edge = edge.with_polarity(Polarity::Rising);
                let mut model = EdgeModel::settled(row, &edge, around, 600).expect("an edge");
                for is_textured in [false, true] {
                    if is_textured {
                        let far = |off_q8: i32| Fit { off_q8: [off_q8; 2], ..quick(&model, row, column_q16, around) };
                        let (up, down) = (far(4000), far(-4000));
                        [up, down].iter().cycle().take(40).for_each(|fit| model.learn(0, fit));
                        assert!(model.is_textured());
                    }
                    let from_q16 = column_q16 + 3000;
                    let whole = model.fit_in_window(row, from_q16 >> 8, around.bounds_q8()).expect("the edge");
                    let quick = quick(&model, row, from_q16, around);
                    let off_q16 = whole.column_q16.abs_diff(quick.column_q16);
                    let of = format_args!("{apart_px} px, {off_px} px, textured {is_textured}");
                    assert!(10 * off_q16 <= whole.sigma_q16, "{of}: {off_q16} of {}", whole.sigma_q16);
                    let ratio = f64::from(quick.sigma_q16) / f64::from(whole.sigma_q16);
                    assert!((0.97..1.03).contains(&ratio), "{of}: sigma {ratio}");
                    let wider = f64::from(quick.width_q12) / f64::from(whole.width_q12);
                    assert!((0.98..1.02).contains(&wider), "{of}: width {wider}");
                    let rest = f64::from(quick.residual_q16 + 256) / f64::from(whole.residual_q16 + 256);
                    assert!((0.9..1.1).contains(&rest), "{of}: residual {rest}");
                }
            }
        }
    }

    fn quick(model: &EdgeModel, row: PixelRow<'_, &[u8]>, from_q16: i32, around: Neighbours) -> Fit {
        model.quick_fit(row, from_q16 >> 8, around.bounds_q8(), true).expect("the edge")
    }
}
