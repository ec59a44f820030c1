//! From a row of pixels and the model of an edge to what the row says of it ([`Fit`]).

use super::level_moments::FreeLevels;
use super::model::{EdgeModel, Fit};
use super::moments::Moments;
use super::norms::Norms;
use super::pixel_row::PixelRow;
use super::template::Template;
use super::window::Window;
use crate::format::Pixels;

/// What a window shows.
struct Step {
    moments: Moments,
    /// Product of the slope with itself, less what free levels explain.
    slope_slope: i32,
    /// The row's own levels minus the mean ones, and what of it is no noise.
    off_q8: [i32; 2],
    change_q8: [i32; 2],
}

impl EdgeModel {
    /// Fits column, width and levels of the edge near the expected column.
    pub(super) fn fit<P: Pixels>(&self, row: PixelRow<'_, P>, expected_q16: i32, bounds_q8: (i32, i32)) -> Option<Fit> {
        let column_q8 = expected_q16 >> 8;
        if !self.is_alone(column_q8, bounds_q8, row.columns()) {
            return None;
        }
        let template = self.template();
        let window = Window::new(row, column_q8, template, bounds_q8)?;
        let norms = window.norms();
        let Step { moments, slope_slope, off_q8, change_q8 } = self.step(&window, &norms, row.kind())?;
        let ([left_q8, right_q8], usual_q8) = (change_q8, self.contrast_q8(row.kind()));
        let contrast_q6 = (usual_q8 + right_q8 - left_q8) >> 2;
        if !is_alike(contrast_q6 << 2, usual_q8) || !norms.shows_edge() {
            return None;
        }
        // b/A in 1/2¹⁸ px and grey level.
        let per_level_q18 = (i32::from(template.box_q8) << 16).checked_div(contrast_q6)?;
        let shift_q16 = (i64::from(moments.shift_q16(&norms)) * i64::from(per_level_q18)) >> 16;
        // Where free levels explain a part of the slope, the rest is less sure.
        let has_free_levels = slope_slope != norms.slope_slope;
        let of_noise_q8 = if has_free_levels { norms.sigma_of_part_q8(slope_slope) } else { norms.sigma_q8 };
        let sigma_q8 = u32::from(of_noise_q8) * u32::from(self.noise_q8);
        let sigma_q16 = (u64::from(sigma_q8 >> 4) * u64::from(per_level_q18.unsigned_abs())) >> 14;
        Some(Fit {
            column_q16: (window.centre_q8 << 8).checked_sub(i32::try_from(shift_q16).ok()?)?,
            sigma_q16: sigma_q16.min(1 << 24) as i32,
            width_q12: width_q12(template, moments.widening_q15(&norms), contrast_q6)?,
            residual_q16: moments.residual_q16(&norms, has_free_levels),
            off_q8,
        })
    }

    /// Whether neither the border nor a neighbour's blur lies within the edge's own blur: its column would be biased.
    fn is_alone(&self, column_q8: i32, (left_q8, right_q8): (i32, i32), columns: i32) -> bool {
        let clear_q8 = 2 * i32::from(self.blur_q8()) + 256;
        column_q8 - clear_q8 >= left_q8.max(0) && column_q8 + clear_q8 <= right_q8.min((columns.min(1 << 20) - 1) << 8)
    }

    /// What a window shows against the levels that the row itself has: those of its plateaus. Means over rows are less noisy, but
    /// what they are off shifts all these rows alike: for a line it comes to the same, and each row for itself knows neither lag
    /// nor drift, and no bad start.
    ///
    /// Beside texture a plateau hardly tells the level at the edge: the edge's own pixels do. With one of the levels from its
    /// plateau, an error of the width would shift the edge. With none from it at all, the column would be another one in rows and
    /// frames that are found to be beside texture than in those that are not.
    fn step<P: Pixels>(&self, window: &Window<'_, P>, norms: &Norms, kind: usize) -> Option<Step> {
        let [left_q8, right_q8] = self.levels_q8(kind);
        let own_q8 = window.levels_q8()?;
        let [own_left_q8, own_right_q8] = own_q8;
        let moments = window.moments(own_q8);
        let off_q8 = [own_left_q8 - left_q8, own_right_q8 - right_q8];
        if self.is_textured() {
            let free = window.level_moments(own_q8).free(&moments, norms)?;
            let FreeLevels { off_q8: [left_off_q8, right_off_q8], slope_slope } = free;
            let moments = window.moments([own_left_q8 + left_off_q8, own_right_q8 + right_off_q8]);
            let [own_left_off_q8, own_right_off_q8] = off_q8;
            let off_q8 = [own_left_off_q8 + left_off_q8, own_right_off_q8 + right_off_q8];
            return Some(Step { moments, slope_slope, off_q8, change_q8: off_q8 });
        }
        Some(Step { slope_slope: norms.slope_slope, moments, off_q8, change_q8: self.departure(off_q8) })
    }

    /// What to add to the mean levels for this row, in 1/256 grey level: nothing, or what the row itself shows where that is
    /// another level, as at the end of an object, where its brightness fades and the mean would shift the edge.
    fn departure(&self, off_q8: [i32; 2]) -> [i32; 2] {
        // Three sigma of a mean over four pixels.
        let most_q8 = u32::from(self.noise_q8) * 3 / 2;
        off_q8.map(|off_q8| if off_q8.unsigned_abs() > most_q8 { off_q8 } else { 0 })
    }
}

/// Whether an edge of this contrast is of the usual kind: not so much weaker that it would only add noise, and at most twice
/// as strong.
const fn is_alike(contrast_q8: i32, usual_q8: i32) -> bool {
    let (contrast_q8, usual_q8) = if usual_q8 < 0 { (-contrast_q8, -usual_q8) } else { (contrast_q8, usual_q8) };
    3 * contrast_q8 >= 2 * usual_q8 && contrast_q8 <= 2 * usual_q8
}

/// The width of the edge: that of its template, and what the row says of it.
fn width_q12(template: &Template, widening_q15: i32, contrast_q6: i32) -> Option<i32> {
    // The widest template has 24 000: 29 bits.
    let per_level_q10 = ((template.per_widening_q2 as i32) << 14).checked_div(contrast_q6)?;
    let off_q12 = (i64::from(per_level_q10) * i64::from(widening_q15)) >> 13;
    let width_q12 = i32::from(template.width_q8) << 4;
    Some(width_q12 + off_q12.clamp(-(1 << 20), 1 << 20) as i32)
}
