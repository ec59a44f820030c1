//! [`EdgeModel::quick_fit`]: place and width alone, for rows from which the model does not learn.

use super::factor::Factor;
use super::fit::{Contrast, alike};
use super::level_moments::{LevelMoments, Shares};
use super::model::{EdgeModel, Fit};
use super::norms::{LEAST_SLOPE_SLOPE, reciprocal, sigma_q16};
use super::pixel_row::{PixelRow, Stretch, sum};
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
    }
}

impl EdgeModel {
    /// Column and width of the edge near the expected column, as [`EdgeModel::fit`] finds them in a row of grey bytes.
    /// What remains of the row is not measured, and the sigma is that of the row from which the model learned last: so
    /// no norms are needed but what the flank's own pixels sum up.
    #[inline(never)]
    pub(super) fn quick_fit<P: Pixels>(
        &self,
        row: PixelRow<'_, P>,
        expected_q16: i32,
        bounds_q8: (i32, i32),
    ) -> Option<Fit> {
        let (column_q8, template) = (expected_q16 >> 8, self.template());
        if !self.is_alone(column_q8, bounds_q8, row.columns()) {
            return None;
        }
        let Sampled { first, centre_q8, phase } = template.at(column_q8);
        let pixels = phase.weights.len() as i32;
        let parts = Parts::new(column_q8, first, pixels, template, bounds_q8, (row.columns(), row.colours()))?;
        let ([left, right], weights) = (parts.plateaus, phase.weights.get(parts.skipped..)?);
        let window = row.light_bytes(Stretch { from: left.from, to: right.to })?;
        let of = |stretch: Stretch| window.get(stretch.from - left.from..stretch.to - left.from);
        let (own_q8, flank) = ([mean_q8(of(left)?)?, mean_q8(of(right)?)?], of(parts.flank)?);
        let (sums, contrast, off_q8) = if self.is_textured() {
            self.quick_free_levels(flank, weights, own_q8)?
        } else {
            let (off_q8, contrast) = self.against_means(0, own_q8)?;
            let mut sums = Sums::default();
            residuals(flank, weights, own_q8).for_each(|(residual_q6, weight)| sums.add(residual_q6, weight));
            (sums, contrast, off_q8)
        };
        if sums.slope_slope < LEAST_SLOPE_SLOPE {
            return None;
        }
        let sign = if contrast.is_falling { -1 } else { 1 };
        let product = |per: Factor, of: i32| per.roughly_and(contrast.reciprocal).product(sign * of);
        let change_q12 = product(template.per_width_of(reciprocal(sums.widening_widening)), sums.widening);
        Some(Fit {
            column_q16: (centre_q8 << 8).saturating_sub(product(reciprocal(sums.slope_slope), sums.slope)),
            sigma_q16: sigma_q16(self.of_noise_q8, self.noise_q8, contrast.reciprocal),
            of_noise_q8: self.of_noise_q8,
            width_q12: (i32::from(template.width_q8) << 4) + change_q12.clamp(-(1 << 20), (1 << 20) - 1),
            residual_q16: 0,
            off_q8,
        })
    }

    /// Beside texture the edge's own pixels tell the levels, as in [`EdgeModel::with_free_levels`]: what these change in
    /// the inner products is known without another look at the pixels.
    #[inline(always)]
    fn quick_free_levels(
        &self,
        flank: &[u8],
        weights: &[Weight],
        own_q8: [i32; 2],
    ) -> Option<(Sums, Contrast, [i32; 2])> {
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
        let free_q8 = moments.free(sums.slope, sums.slope_slope as i32)?.off_q8;
        let ([left_q8, right_q8], [free_left_q8, free_right_q8], [own_left_q8, own_right_q8]) =
            (self.levels_q8(0), free_q8, own_q8);
        let off_q8 = [own_left_q8 + free_left_q8 - left_q8, own_right_q8 + free_right_q8 - right_q8];
        let [left_off_q8, right_off_q8] = off_q8;
        let contrast = Contrast::of(alike(right_q8 - left_q8, right_off_q8 - left_off_q8)?, self.template())?;
        sums.slope -= explained_q6(free_q8, moments.slopes());
        sums.widening -= explained_q6(free_q8, [(widening << 8) - right_widening, right_widening]);
        Some((sums, contrast, off_q8))
    }
}

/// What levels that are off, in 1/256 grey level, add to an inner product of residuals in 1/64 grey level, from their
/// own products with its weights, in 1/256.
#[inline(always)]
fn explained_q6([left_q8, right_q8]: [i32; 2], [of_left, of_right]: [i32; 2]) -> i32 {
    // 32 bits hold both parts: a level is off by at most 255, and the weights of a flank add up to less than 2¹³.
    let part = |off_q8: i32, of: i32| (off_q8 >> 2) * (of >> 8);
    part(left_q8, of_left) + part(right_q8, of_right)
}

/// Mean of some bytes in 1/256 grey level, to the nearest.
#[inline(always)]
fn mean_q8(bytes: &[u8]) -> Option<i32> {
    let count = bytes.len() as u32;
    Some(((sum(bytes) << 8) + count / 2).checked_div(count)? as i32)
}
