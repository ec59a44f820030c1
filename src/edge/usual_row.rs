//! A row that shows a tracked edge as the rows before did: most rows of most lines.

use super::fit::Contrast;
use super::model::{EdgeModel, Fit};
use super::moments::Moments;
use super::near_window::NearWindow;
use super::norms::{Norms, per_freedom_q16, sigma_q16};
use super::phase::Phase;
use super::pixel_row::mean_q8;
use super::products::Products;
use super::refine::LocatedPoint;
use super::whole_window::{Sums, WholeWindow};
use super::window::Neighbours;

impl EdgeModel {
    /// The edge near the expected column, within the gate, as [`EdgeModel::locate`] finds it; `None` where the row may
    /// show anything else than the rows before, which then has to be looked at closely.
    ///
    /// The levels are the usual ones, the column is a step or two off and the width is one that the edge may have: then
    /// what remains is measured only in the rows from which the model learns.
    #[inline(always)]
    pub(crate) fn locate_usual(
        &mut self,
        row: &[u8],
        expected: Expectation,
        around: &Neighbours,
    ) -> Option<UsualPoint> {
        if !self.is_usual {
            return None;
        }
        let step = self.usual_step(row, expected.column_q16, around)?;
        if step.column_q16.abs_diff(expected.column_q16) > self.one_step_q16(step.sigma_q16) {
            return self.locate_usual_in_two(row, step.column_q16, expected, around);
        }
        self.take_usual(step, expected)
    }

    /// Likewise with another step from where the first one has led, if that is no farther than the blur. What is found
    /// must not depend on what was expected, as in [`EdgeModel::approach`].
    #[inline(never)]
    fn locate_usual_in_two(
        &mut self,
        row: &[u8],
        from_q16: i32,
        expected: Expectation,
        around: &Neighbours,
    ) -> Option<UsualPoint> {
        if from_q16.abs_diff(expected.column_q16) > self.blur_q16() {
            return None;
        }
        let step = self.usual_step(row, from_q16, around)?;
        let is_there = step.column_q16.abs_diff(from_q16) <= self.one_step_q16(step.sigma_q16);
        if is_there { self.take_usual(step, expected) } else { None }
    }

    /// Likewise between neighbours that cut off its plateaus.
    #[inline(never)]
    pub(crate) fn locate_near(&mut self, row: &[u8], expected: Expectation, around: &Neighbours) -> Option<UsualPoint> {
        if !self.is_usual {
            return None;
        }
        let mut from_q16 = expected.column_q16;
        for _ in 0..2 {
            let step = self.near_step(row, from_q16, around)?;
            if step.column_q16.abs_diff(from_q16) <= self.one_step_q16(step.sigma_q16) {
                return self.take_usual(step, expected);
            }
            from_q16 = step.column_q16;
        }
        None
    }

    /// Takes what a step has found, if it is within the gate and what noise explains. Where the width is none that an edge
    /// may have, what remains of the row is measured.
    #[inline(always)]
    fn take_usual(&mut self, step: UsualStep<'_>, expected: Expectation) -> Option<UsualPoint> {
        let UsualStep { flank, phase, column_q16, sigma_q16, width_q12, levels } = step;
        let most_q16 = expected.gate_q16.min(self.most_moved_q16(sigma_q16));
        if column_q16.abs_diff(expected.column_q16) > most_q16 {
            return None;
        }
        let half_q12 = u32::from(self.blur_q12) / 2;
        let has_usual_width = width_q12.wrapping_sub(half_q12 as i32) as u32 <= 2 * half_q12;
        let width_q8 = if has_usual_width { (width_q12 >> 4) as u16 } else { self.width_near_q8(width_q12) };
        if !has_usual_width || self.learns_next() {
            // Made only here, so that most rows write it nowhere.
            self.measure_usual(&UsualStep { flank, phase, column_q16, sigma_q16, width_q12, levels })?;
        }
        self.count_row();
        let overshoot = if expected.looks_for_halo { self.overshoot_of_bytes(flank, phase, width_q8) } else { None };
        Some(UsualPoint { at: LocatedPoint { column_q16, sigma_q16: sigma_q16.max(1), width_q8 }, overshoot })
    }

    /// What the pixels around a column say, if both levels are the usual ones.
    #[inline(always)]
    fn usual_step<'p>(&self, row: &'p [u8], from_q16: i32, around: &Neighbours) -> Option<UsualStep<'p>> {
        let template = self.template();
        let window = WholeWindow::new(row, from_q16 >> 8, template, around.bounds_q8())?;
        let sums = window.sums();
        let own_q8 = sums.levels_q8(template);
        let ([left_q8, right_q8], [own_left_q8, own_right_q8]) = (self.levels_q8(0), own_q8);
        if [own_left_q8 - left_q8, own_right_q8 - right_q8].into_iter().any(|off_q8| self.departure(off_q8) != 0) {
            return None;
        }
        let contrast = Contrast { is_falling: left_q8 > right_q8, reciprocal: self.per_contrast };
        let (products, phase) = (sums.products(window.phase, own_q8), window.phase);
        let (column_q16, width_q12) = self.moved(phase, window.centre_q8, &products, &contrast);
        let sigma_q16 = sigma_q16(phase.norms.sigma_q8, self.noise_q8, self.per_contrast);
        Some(UsualStep {
            flank: window.flank(),
            phase,
            column_q16,
            sigma_q16,
            width_q12,
            levels: OwnLevels { own_q8, cut_off: None, of_flank: [false; 2] },
        })
    }

    /// Likewise between neighbours that cut off its plateaus: the fewer pixels tell the levels, the less they tell
    /// whether these are the usual ones.
    #[inline(always)]
    fn near_step<'p>(&self, row: &'p [u8], from_q16: i32, around: &Neighbours) -> Option<UsualStep<'p>> {
        let (column_q8, bounds_q8) = (from_q16 >> 8, around.bounds_q8());
        if !self.is_alone(column_q8, bounds_q8, row.len() as i32) {
            return None;
        }
        let NearWindow { flank, plateaus: [left, right], of_flank, phase, centre_q8 } =
            NearWindow::new(row, column_q8, self.template(), bounds_q8)?;
        let own_q8 = [mean_q8(left)?, mean_q8(right)?];
        let (_, contrast) = self.against_means(0, own_q8)?;
        let products = Sums::of_flank(flank, phase.weights).products(phase, own_q8);
        let (column_q16, width_q12) = self.moved(phase, centre_q8, &products, &contrast);
        let plateaus = [left.len() as u32, right.len() as u32];
        let sigma_q16 = sigma_q16(phase.norms.sigma_beside_q8(plateaus, of_flank), self.noise_q8, contrast.reciprocal);
        let levels = OwnLevels { own_q8, cut_off: Some(plateaus), of_flank };
        Some(UsualStep { flank, phase, column_q16, sigma_q16, width_q12, levels })
    }

    /// Column and width, from the inner products at a phase.
    #[inline(always)]
    fn moved(&self, phase: &Phase, centre_q8: i32, products: &Products, contrast: &Contrast) -> (i32, i32) {
        let (slope, widening) = (products.residual_slope, products.residual_widening);
        let (slope, widening) = if contrast.is_falling { (-slope, -widening) } else { (slope, widening) };
        let shift_q16 = phase.norms.per_slope.roughly_and(contrast.reciprocal).product(slope);
        let change_q12 = phase.quick().per_width.roughly_and(contrast.reciprocal).product(widening);
        let width_q12 = (i32::from(self.template().width_q8) << 4).saturating_add(change_q12);
        ((centre_q8 << 8).saturating_sub(shift_q16), width_q12)
    }

    /// Measures what remains of a row, and learns from it if it is time; `None` where too much remains.
    #[inline(never)]
    fn measure_usual(&mut self, step: &UsualStep<'_>) -> Option<()> {
        let &UsualStep { flank, phase, column_q16, sigma_q16, width_q12, levels } = step;
        let OwnLevels { own_q8, cut_off, of_flank } = levels;
        let Norms { per_slope, per_widening, .. } = phase.norms;
        let of_part = |plateaus| per_freedom_q16(phase.weights.len() as u32, plateaus);
        let per_freedom_q16 = cut_off.map_or(phase.norms.per_freedom_q16, of_part);
        let moments = Moments::of_bytes(flank, phase.weights, own_q8);
        let residual_q16 = moments.residual_q16(per_slope, Some(per_widening), per_freedom_q16);
        if residual_q16 > self.most_residual_q16() {
            return None;
        }
        if self.learns_next() {
            let ([left_q8, right_q8], [own_left_q8, own_right_q8]) = (self.levels_q8(0), own_q8);
            let off_q8 = [own_left_q8 - left_q8, own_right_q8 - right_q8];
            self.learn(0, &Fit { column_q16, sigma_q16, width_q12, residual_q16, off_q8, of_flank });
        }
        Some(())
    }
}

/// Where an edge should be in a row.
#[derive(Clone, Copy)]
pub(crate) struct Expectation {
    pub(crate) column_q16: i32,
    /// How far off it may lie.
    pub(crate) gate_q16: u32,
    /// Whether it is looked how far its levels overshoot.
    pub(crate) looks_for_halo: bool,
}

/// Where it is, and [`EdgeModel::overshoot`] where that is asked for.
pub(crate) struct UsualPoint {
    pub(crate) at: LocatedPoint,
    pub(crate) overshoot: Option<i16>,
}

/// One step towards an edge.
struct UsualStep<'p> {
    /// Pixels of the flank, and perhaps more behind it.
    flank: &'p [u8],
    phase: &'static Phase,
    column_q16: i32,
    sigma_q16: u32,
    width_q12: i32,
    levels: OwnLevels,
}

/// The levels that a row itself shows beside an edge.
#[derive(Clone, Copy)]
struct OwnLevels {
    own_q8: [i32; 2],
    /// Pixels of the plateaus, where neighbours cut these off.
    cut_off: Option<[u32; 2]>,
    of_flank: [bool; 2],
}

#[cfg(test)]
mod tests {
    use super::super::pixel_row::PixelRow;
    use super::super::window::Neighbours;
    use super::{EdgeModel, Expectation};
    use crate::edge::{EdgePoint, Polarity};
    use crate::setup::Response;

    const MIDDLE_PX: f64 = 60.0;

    /// An edge with neighbours so far away, of the other polarity.
    fn row_of(apart_px: f64, off_px: f64, seed: u32) -> [u8; 120] {
        let mut mixed = seed;
        let mut noise = || {
            mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2c1b_3c6d).wrapping_add(0x9e37_79b9);
            f64::from(mixed >> 16) / 65536.0 * 8.0 - 4.0
        };
        let step = |px: f64| 0.5 * (1.0 + libm::erf(px / 1.0));
        core::array::from_fn(|column| {
            let px = column as f64 - MIDDLE_PX - off_px;
            (60.0 + 100.0 * (step(px) - step(px - apart_px) + 1.0 - step(px + apart_px)) + noise()) as u8
        })
    }

    /// Between neighbours the whole flank tells where the edge is, as surely as it states, though their blur reaches its
    /// ends.
    #[test]
    fn a_flank_between_neighbours_tells_the_column() {
        const SEEDS: u32 = 24;
        for apart_px in [4.0, 4.5, 5.0, 6.5, 9.0] {
            let (mut sum, mut squares, mut found) = (0.0, 0.0, 0.0);
            for (index, off_px) in (0..).zip([0.0, 0.2, 0.45, -0.3, 0.7, -0.1, 0.6, -0.45]) {
                for seed in 1 + index * SEEDS..=(index + 1) * SEEDS {
                    let pixels = row_of(apart_px, off_px, seed);
                    let row = PixelRow { pixels: &pixels[..], response: &Response::Linear };
                    let q16 = |px: f64| (px * 65536.0) as i32;
                    let (column_q16, apart_q16) = (q16(MIDDLE_PX + off_px), q16(apart_px));
                    let (left_q16, right_q16) = (column_q16 - apart_q16, column_q16 + apart_q16);
                    let around = Neighbours { left_q16, right_q16 };
                    let edge = EdgePoint { width_q8: 195, ..EdgePoint::new(0, column_q16, 0) };
                    let edge = edge.with_polarity(Polarity::Rising);
                    let Some(mut model) = EdgeModel::settled(row, &edge, around, 600) else { continue };
                    let Some(fit) = model.quick_fit(row.pixels, column_q16 >> 8, around.bounds_q8(), true) else {
                        continue;
                    };
                    model.learn(0, &fit);
                    let expected = Expectation { column_q16, gate_q16: 1 << 17, looks_for_halo: false };
                    let Some(near) = model.locate_near(&pixels, expected, &around) else { continue };
                    let near = near.at;
                    let error = f64::from(near.column_q16 - column_q16) / f64::from(near.sigma_q16);
                    (sum, squares, found) = (sum + error, squares + error * error, found + 1.0);
                }
            }
            assert!(found >= 60.0, "{apart_px} px: {found}");
            let (mean, scatter) = (sum / found, libm::sqrt(squares / found));
            // Four sigma of a mean of so many rows, and of their scatter.
            assert!(mean.abs() < 4.0 / libm::sqrt(found), "{apart_px} px: {mean} sigma");
            assert!((scatter - 1.0).abs() < 4.0 / libm::sqrt(2.0 * found), "{apart_px} px: {scatter} of the stated");
        }
    }
}
