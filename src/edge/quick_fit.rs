//! [`EdgeModel::quick_fit`]: place and width in a row of grey bytes whose window may be cut off.

use super::factor::Factor;
use super::fit::{Contrast, alike};
use super::level_norms::{FreeLevels, LevelNorms, LevelSums};
use super::model::{EdgeModel, Fit};
use super::moments::Moments;
use super::norms::{LEAST_SLOPE_SLOPE, Squares, of_levels_q12, per_freedom_q16, reciprocal, sigma_q8, sigma_q16};
use super::phase::{Phase, Sampled};
use super::pixel_row::{Stretch, mean_q8};
use super::template::Template;
use super::weight::Weight;
use super::window::Parts;

/// What a flank tells without its pixels.
struct Flank {
    weights: &'static [Weight],
    slope: u32,
    slope_slope: u32,
    per_slope: Factor,
    per_widening: Factor,
    /// [`Template::per_width`].
    per_width: Factor,
    /// The phase, of which this is the whole flank.
    whole: Option<&'static Phase>,
}

/// Inner products of what is off the expected step, in 1/64 grey level, with slope and widening.
#[derive(Default)]
struct Sums {
    slope: i32,
    widening: i32,
}

/// What a row shows, given levels.
struct Seen {
    sums: Sums,
    /// Of the slope with itself, less what free levels explain.
    sure_slope: u32,
    contrast: Contrast,
    levels_q8: [i32; 2],
    /// These minus the mean ones.
    off_q8: [i32; 2],
}

impl Flank {
    /// So many pixels of a phase from one on. Made when the library is compiled, unless a part of them is cut off.
    #[inline(always)]
    fn new(phase: &'static Phase, template: &Template, skipped: usize, pixels: usize) -> Option<Self> {
        if pixels == phase.weights.len() {
            let (norms, quick) = (&phase.norms, phase.quick());
            return Some(Self {
                weights: phase.weights,
                slope: quick.slope.into(),
                slope_slope: norms.slope_slope as u32,
                per_slope: norms.per_slope,
                per_widening: norms.per_widening,
                per_width: quick.per_width,
                whole: Some(phase),
            });
        }
        let weights = phase.weights.get(skipped..skipped + pixels)?;
        let Squares { slope, slope_slope, widening_widening, .. } = weights.iter().fold(Squares::NONE, Squares::with);
        let per_widening = reciprocal(widening_widening);
        Some(Self {
            weights,
            slope,
            slope_slope,
            per_slope: reciprocal(slope_slope),
            per_widening,
            per_width: template.per_width_of(per_widening),
            whole: None,
        })
    }

    /// Each of its pixels minus what is expected there, in 1/64 of a level, with its weight.
    #[inline(always)]
    fn residuals(&self, pixels: &[u8], [left_q8, right_q8]: [i32; 2]) -> impl Iterator<Item = (i32, &'static Weight)> {
        let (left_q6, contrast_q6) = (left_q8 >> 2, (right_q8 >> 2) - (left_q8 >> 2));
        pixels
            .iter()
            .zip(self.weights)
            .map(move |(pixel, weight)| ((i32::from(*pixel) << 6) - weight.expected_q6(left_q6, contrast_q6), weight))
    }

    /// What it says of the levels.
    #[inline(always)]
    fn free(&self, sums: LevelSums, residuals: &Sums) -> Option<(FreeLevels, [i32; 2])> {
        let explain = |norms: &LevelNorms| {
            let free = norms.free(sums, residuals.slope)?;
            let explained_q6 = norms.explained_q6(free.off_q8);
            Some((free, explained_q6))
        };
        match self.whole.and_then(Phase::level_norms) {
            Some(norms) => explain(norms),
            None => explain(&LevelNorms::of(self.weights)),
        }
    }
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, residual_q6: i32, weight: &Weight) {
        self.slope += residual_q6 * i32::from(weight.slope);
        self.widening += residual_q6 * i32::from(weight.widening);
    }
}

impl EdgeModel {
    /// Column and width of the edge near the expected column, as [`EdgeModel::fit_in_window`] finds them, in a row of grey
    /// bytes. What remains of the row is measured only where that is asked for.
    #[inline(never)]
    pub(super) fn quick_fit(
        &self,
        row: &[u8],
        column_q8: i32,
        bounds_q8: (i32, i32),
        is_measured: bool,
    ) -> Option<Fit> {
        // What lies beyond 2¹⁶ is out of reach of columns in 1/65536 px.
        let (template, columns) = (self.template(), row.len().min(1 << 16) as i32);
        if !self.is_alone(column_q8, bounds_q8, columns) {
            return None;
        }
        let Sampled { first, centre_q8, phase } = template.at(column_q8);
        let parts = Parts::new(column_q8, first, phase.weights.len() as i32, template, bounds_q8, (columns, 1))?;
        let flank = Flank::new(phase, template, parts.skipped, parts.flank.pixels())?;
        let of = |stretch: Stretch| row.get(stretch.from..stretch.to);
        let ([left, right], pixels) = (parts.plateaus, of(parts.flank)?);
        let own_q8 = [mean_q8(of(left)?)?, mean_q8(of(right)?)?];
        if flank.slope_slope < LEAST_SLOPE_SLOPE || pixels.len() < 3 {
            return None;
        }
        let seen = if self.is_textured() {
            self.quick_free_levels(&flank, pixels, own_q8)?
        } else {
            self.quick_levels(&flank, pixels, own_q8)?
        };
        let Seen { sums, sure_slope, contrast, levels_q8, off_q8 } = seen;
        let Flank { weights, slope, per_slope, per_widening, per_width, .. } = flank;
        let plateaus = parts.plateaus.map(|plateau| plateau.pixels() as u32);
        let residual_q16 = if is_measured {
            let per_widening = (!self.is_textured()).then_some(per_widening);
            let per_freedom_q16 = per_freedom_q16(pixels.len() as u32, plateaus);
            Moments::of_bytes(pixels, weights, levels_q8).residual_q16(per_slope, per_widening, per_freedom_q16)
        } else {
            0
        };
        let of_noise_q8 = sigma_q8(slope, sure_slope, of_levels_q12(plateaus));
        let sign = if contrast.is_falling { -1 } else { 1 };
        let product = |per: Factor, of: i32| per.roughly_and(contrast.reciprocal).product(sign * of);
        let change_q12 = product(per_width, sums.widening);
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
    fn quick_levels(&self, flank: &Flank, pixels: &[u8], levels_q8: [i32; 2]) -> Option<Seen> {
        let (off_q8, contrast) = self.against_means(0, levels_q8)?;
        let mut sums = Sums::default();
        flank.residuals(pixels, levels_q8).for_each(|(residual_q6, weight)| sums.add(residual_q6, weight));
        Some(Seen { sums, sure_slope: flank.slope_slope, contrast, levels_q8, off_q8 })
    }

    /// Beside texture the edge's own pixels tell the levels, as in [`EdgeModel::with_free_levels`]: what these change in
    /// the inner products is known without another look at the pixels.
    #[inline(always)]
    fn quick_free_levels(&self, flank: &Flank, pixels: &[u8], own_q8: [i32; 2]) -> Option<Seen> {
        let (mut sums, mut of_levels) = (Sums::default(), LevelSums::default());
        flank.residuals(pixels, own_q8).for_each(|(residual_q6, weight)| {
            sums.add(residual_q6, weight);
            of_levels.add(residual_q6, weight);
        });
        let (FreeLevels { off_q8: free_q8, slope_slope }, [of_slope_q6, of_widening_q6]) =
            flank.free(of_levels, &sums)?;
        let ([left_q8, right_q8], [free_left_q8, free_right_q8], [own_left_q8, own_right_q8]) =
            (self.levels_q8(0), free_q8, own_q8);
        let levels_q8 = [own_left_q8 + free_left_q8, own_right_q8 + free_right_q8];
        let [found_left_q8, found_right_q8] = levels_q8;
        let off_q8 = [found_left_q8 - left_q8, found_right_q8 - right_q8];
        let [left_off_q8, right_off_q8] = off_q8;
        let contrast = Contrast::of(alike(right_q8 - left_q8, right_off_q8 - left_off_q8)?, self.template())?;
        let sums = Sums { slope: sums.slope - of_slope_q6, widening: sums.widening - of_widening_q6 };
        Some(Seen { sums, sure_slope: slope_slope as u32, contrast, levels_q8, off_q8 })
    }
}

#[cfg(test)]
mod tests {
    use super::super::window::Neighbours;
    use super::{EdgeModel, Fit};
    use crate::edge::{EdgePoint, PixelRow, Polarity};
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
        model.quick_fit(row.pixels, from_q16 >> 8, around.bounds_q8(), true).expect("the edge")
    }
}
