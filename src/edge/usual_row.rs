//! A row that shows a tracked edge as the rows before did: most rows of most lines.

use super::model::{EdgeModel, Fit};
use super::norms::sigma_q16;
use super::pixel_row::PixelRow;
use super::refine::LocatedPoint;
use super::template::Phase;
use super::whole_window::WholeWindow;
use super::window::Neighbours;
use crate::format::Pixels;

impl EdgeModel {
    /// The edge near the expected column, within the gate, as [`EdgeModel::locate`] finds it; `None` where the row may
    /// show anything else than the rows before, which then has to be looked at closely.
    ///
    /// The levels are the usual ones, the column is one step off and the width is one that the edge may have: then what
    /// remains is measured only in the rows from which the model learns.
    #[inline(always)]
    pub(crate) fn locate_usual<P: Pixels>(
        &mut self,
        row: &PixelRow<'_, P>,
        expected_q16: i32,
        gate_q16: u32,
        around: &Neighbours,
    ) -> Option<LocatedPoint> {
        if !self.is_usual {
            return None;
        }
        let step = self.usual_step(row, expected_q16, around)?;
        if step.column_q16.abs_diff(expected_q16) > self.one_step_q16() {
            return self.locate_usual_in_two(row, step.column_q16, (expected_q16, gate_q16), around);
        }
        self.take_usual(step, (expected_q16, gate_q16))
    }

    /// Likewise with another step from where the first one has led, if that is no farther than the blur. What is found
    /// must not depend on what was expected, as in [`EdgeModel::approach`].
    #[inline(never)]
    fn locate_usual_in_two<P: Pixels>(
        &mut self,
        row: &PixelRow<'_, P>,
        from_q16: i32,
        (expected_q16, gate_q16): (i32, u32),
        around: &Neighbours,
    ) -> Option<LocatedPoint> {
        if from_q16.abs_diff(expected_q16) > self.blur_q16() {
            return None;
        }
        let step = self.usual_step(row, from_q16, around)?;
        let is_there = step.column_q16.abs_diff(from_q16) <= self.one_step_q16();
        if is_there { self.take_usual(step, (expected_q16, gate_q16)) } else { None }
    }

    /// Takes what a step has found, if it is within the gate and what noise explains, and no wider or narrower than an
    /// edge may be.
    #[inline(always)]
    fn take_usual(&mut self, step: UsualStep<'_>, (expected_q16, gate_q16): (i32, u32)) -> Option<LocatedPoint> {
        let UsualStep { column_q16, width_q12, .. } = step;
        let sigma_q16 = sigma_q16(step.window.phase.norms.sigma_q8, self.noise_q8, self.per_contrast);
        let half_q12 = u32::from(self.blur_q12) / 2;
        let noise_q16 = 4 * sigma_q16 + (u32::from(self.blur_q12) << 2);
        let is_usual = column_q16.abs_diff(expected_q16) <= gate_q16.min(noise_q16)
            && width_q12.wrapping_sub(half_q12 as i32) as u32 <= 2 * half_q12;
        if !is_usual {
            return None;
        }
        if self.learns_next() {
            self.learn_usual(step, sigma_q16)?;
        }
        self.count_row();
        Some(LocatedPoint { column_q16, sigma_q16: sigma_q16.max(1), width_q8: (width_q12 >> 4) as u16 })
    }

    /// What the pixels around a column say, if both levels are the usual ones.
    #[inline(always)]
    fn usual_step<'p, P: Pixels>(
        &self,
        row: &'p PixelRow<'_, P>,
        from_q16: i32,
        around: &Neighbours,
    ) -> Option<UsualStep<'p>> {
        let template = self.template();
        let window = WholeWindow::new(row, from_q16 >> 8, template, self.bounds_q8(from_q16, around))?;
        let sums = window.sums();
        let own_q8 = sums.levels_q8(template);
        let ([left_q8, right_q8], [own_left_q8, own_right_q8]) = (self.levels_q8(0), own_q8);
        let off_q8 = [own_left_q8 - left_q8, own_right_q8 - right_q8];
        if off_q8.into_iter().any(|off_q8| self.departure(off_q8) != 0) {
            return None;
        }
        let products = sums.products(window.phase, own_q8);
        let (slope, widening) = (products.residual_slope, products.residual_widening);
        let (slope, widening) = if left_q8 > right_q8 { (-slope, -widening) } else { (slope, widening) };
        let Phase { norms, per_width, .. } = window.phase;
        let shift_q16 = norms.per_slope.roughly_and(self.per_contrast).product(slope);
        let column_q16 = (window.centre_q8 << 8).saturating_sub(shift_q16);
        let change_q12 = per_width.roughly_and(self.per_contrast).product(widening);
        let width_q12 = (i32::from(template.width_q8) << 4).saturating_add(change_q12);
        Some(UsualStep { window, own_q8, off_q8, column_q16, width_q12 })
    }

    /// Learns from a row, unless too much of it remains.
    #[inline(never)]
    fn learn_usual(&mut self, step: UsualStep<'_>, sigma_q16: u32) -> Option<()> {
        let UsualStep { window, own_q8, off_q8, column_q16, width_q12 } = step;
        let residual_q16 = window.moments(own_q8).residual_q16(&window.phase.norms, false);
        if residual_q16 > self.most_residual_q16() {
            return None;
        }
        let of_noise_q8 = window.phase.norms.sigma_q8;
        self.learn(0, &Fit { column_q16, sigma_q16, of_noise_q8, width_q12, residual_q16, off_q8 });
        Some(())
    }
}

/// One step towards an edge.
struct UsualStep<'p> {
    window: WholeWindow<'p>,
    /// The row's own levels, and what they are off the mean ones.
    own_q8: [i32; 2],
    off_q8: [i32; 2],
    column_q16: i32,
    width_q12: i32,
}
