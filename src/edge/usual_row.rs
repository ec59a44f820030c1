//! A row that shows a tracked edge as the rows before did: most rows of most lines.

use super::model::{EdgeModel, Fit};
use super::norms::sigma_q16;
use super::pixel_row::PixelRow;
use super::refine::LocatedPoint;
use super::template::Phase;
use super::tuning::ONE_STEP_PARTS_LOG2;
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
        let template = self.template();
        let window = WholeWindow::new(row, expected_q16 >> 8, template, around.bounds_q8())?;
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
        let column_q16 = (window.centre_q8 << 8) - shift_q16;
        let one_step_q16 = (u32::from(self.blur_q12) << 4) >> ONE_STEP_PARTS_LOG2;
        if column_q16.abs_diff(expected_q16) > gate_q16.min(one_step_q16) {
            return None;
        }
        let change_q12 = per_width.roughly_and(self.per_contrast).product(widening);
        let width_q12 = (i32::from(template.width_q8) << 4) + change_q12;
        let half_q12 = u32::from(self.blur_q12) / 2;
        if width_q12.wrapping_sub(half_q12 as i32) as u32 > 2 * half_q12 {
            return None;
        }
        let sigma_q16 = sigma_q16(norms.sigma_q8, self.noise_q8, self.per_contrast);
        if self.learns_next() {
            let fit = Fit { column_q16, sigma_q16, width_q12, residual_q16: 0, off_q8 };
            self.learn_usual(window, own_q8, fit)?;
        }
        self.count_row();
        Some(LocatedPoint { column_q16, sigma_q16: sigma_q16.max(1), width_q8: (width_q12 >> 4) as u16 })
    }

    /// Learns from a row, unless too much of it remains.
    #[inline(never)]
    fn learn_usual(&mut self, window: WholeWindow<'_>, own_q8: [i32; 2], fit: Fit) -> Option<()> {
        let residual_q16 = window.moments(own_q8).residual_q16(&window.phase.norms, false);
        if residual_q16 > self.most_residual_q16() {
            return None;
        }
        self.learn(0, &Fit { residual_q16, ..fit });
        Some(())
    }
}
