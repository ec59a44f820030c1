//! From a row of pixels and the model of an edge to what the row says of it ([`Fit`]).

use super::factor::{Factor, shifted};
use super::level_norms::FreeLevels;
use super::model::{EdgeModel, Fit};
use super::moments::Moments;
use super::norms::{Norms, sigma_q16};
use super::pixel_row::PixelRow;
use super::template::Template;
use super::whole_window::WholeWindow;
use super::window::Window;
use crate::format::Pixels;

/// What a window shows.
struct Step<'t> {
    template: &'t Template,
    norms: &'t Norms,
    moments: Moments,
    contrast: Contrast,
    /// Product of the slope with itself, less what free levels explain, where they are free.
    free_slope_slope: Option<i32>,
    centre_q8: i32,
    /// The row's own levels minus the mean ones.
    off_q8: [i32; 2],
}

/// Of a row.
pub(super) struct Contrast {
    pub(super) is_falling: bool,
    /// b over its size, in 1/2¹⁸ px and grey level.
    pub(super) reciprocal: Factor,
}

impl Contrast {
    pub(super) fn of(contrast_q8: i32, template: &Template) -> Option<Self> {
        Some(Self { is_falling: contrast_q8 < 0, reciprocal: template.per_contrast(contrast_q8)? })
    }
}

impl EdgeModel {
    /// Fits column, width and levels of an edge whose window is whole.
    pub(super) fn fit_whole(&self, window: &WholeWindow<'_>) -> Option<Fit> {
        let template = self.template();
        let own_q8 = window.sums().levels_q8(template);
        let (off_q8, contrast) = self.against_means(0, own_q8)?;
        let moments = window.moments(own_q8);
        let (norms, centre_q8) = (&window.phase.norms, window.centre_q8);
        Step { template, norms, moments, contrast, free_slope_slope: None, centre_q8, off_q8 }.fit_apart(self)
    }

    /// Likewise where a part of the window may be cut off, the light is no bytes, or there is texture beside the edge.
    #[inline(never)]
    pub(super) fn fit_in_window<P: Pixels>(
        &self,
        row: PixelRow<'_, P>,
        column_q8: i32,
        bounds_q8: (i32, i32),
    ) -> Option<Fit> {
        if !self.is_alone(column_q8, bounds_q8, row.columns()) {
            return None;
        }
        let window = Window::new(row, column_q8, self.template(), bounds_q8)?;
        let norms = window.norms();
        if !norms.shows_edge() {
            return None;
        }
        if self.is_textured() {
            return self.with_free_levels(&window, &norms)?.fit_apart(self);
        }
        let own_q8 = window.levels_q8()?;
        let (off_q8, contrast) = self.against_means(row.kind(), own_q8)?;
        let (moments, centre_q8, template) = (window.moments(own_q8), window.centre_q8, self.template());
        Step { template, norms: &norms, moments, contrast, free_slope_slope: None, centre_q8, off_q8 }.fit(self)
    }

    /// Whether neither the border nor a neighbour's blur lies within the edge's own blur: its column would be biased.
    pub(super) fn is_alone(&self, column_q8: i32, (left_q8, right_q8): (i32, i32), columns: i32) -> bool {
        let clear_q8 = 2 * i32::from(self.blur_q8()) + 256;
        column_q8 - clear_q8 >= left_q8.max(0) && column_q8 + clear_q8 <= right_q8.min((columns - 1) << 8)
    }

    /// What the row's own levels, those of its plateaus, are off the mean ones, and the contrast, if such an edge is of
    /// the usual kind.
    ///
    /// A window is compared with its own levels. Means over rows are less noisy, but what they are off shifts all these
    /// rows alike: for a line it comes to the same, and each row for itself knows neither lag nor drift, and no bad
    /// start.
    #[inline(always)]
    pub(super) fn against_means(&self, kind: usize, own_q8: [i32; 2]) -> Option<([i32; 2], Contrast)> {
        let ([left_q8, right_q8], [own_left_q8, own_right_q8]) = (self.levels_q8(kind), own_q8);
        let off_q8 = [own_left_q8 - left_q8, own_right_q8 - right_q8];
        let [left_change_q8, right_change_q8] = off_q8.map(|off_q8| self.departure(off_q8));
        let (usual_q8, more_q8) = (right_q8 - left_q8, right_change_q8 - left_change_q8);
        let contrast = if kind == 0 && more_q8 == 0 {
            Contrast { is_falling: usual_q8 < 0, reciprocal: self.per_contrast }
        } else {
            Contrast::of(alike(usual_q8, more_q8)?, self.template())?
        };
        Some((off_q8, contrast))
    }

    /// Beside texture a plateau hardly tells the level at the edge: the edge's own pixels do. With one of the levels
    /// from its plateau, an error of the width would shift the edge. With none from it at all, the column would be
    /// another one in rows and frames that are found to be beside texture than in those that are not.
    fn with_free_levels<'t, P: Pixels>(&self, window: &Window<'_, P>, norms: &'t Norms) -> Option<Step<'t>> {
        let [left_q8, right_q8] = self.levels_q8(window.kind());
        let own_q8 = window.levels_q8()?;
        let [own_left_q8, own_right_q8] = own_q8;
        let moments = window.moments(own_q8);
        let FreeLevels { off_q8: [free_left_q8, free_right_q8], slope_slope } =
            window.level_norms()?.free(window.level_sums(own_q8), moments.residual_slope)?;
        let [found_left_q8, found_right_q8] = [own_left_q8 + free_left_q8, own_right_q8 + free_right_q8];
        let off_q8 = [found_left_q8 - left_q8, found_right_q8 - right_q8];
        let [left_off_q8, right_off_q8] = off_q8;
        let contrast = Contrast::of(alike(right_q8 - left_q8, right_off_q8 - left_off_q8)?, self.template())?;
        let moments = window.moments([found_left_q8, found_right_q8]);
        let (free_slope_slope, centre_q8, template) = (Some(slope_slope), window.centre_q8, self.template());
        Some(Step { template, norms, moments, contrast, free_slope_slope, centre_q8, off_q8 })
    }

    /// What to add to a mean level for this row, in 1/256 grey level: nothing, or what the row itself shows where that
    /// is another level, as at the end of an object, where its brightness fades and the mean would shift the edge.
    pub(super) fn departure(&self, off_q8: i32) -> i32 {
        // Three sigma of a mean over four pixels.
        let most_q8 = u32::from(self.noise_q8) * 3 / 2;
        if off_q8.unsigned_abs() > most_q8 { off_q8 } else { 0 }
    }
}

/// The contrast of a row, the usual one and what is added to it, if such an edge is of the usual kind: not so much
/// weaker that it would only add noise, and at most twice as strong.
pub(super) fn alike(usual_q8: i32, more_q8: i32) -> Option<i32> {
    let contrast_q8 = usual_q8 + more_q8;
    let (size_q8, usual_q8) = if usual_q8 < 0 { (-contrast_q8, -usual_q8) } else { (contrast_q8, usual_q8) };
    (3 * size_q8 >= 2 * usual_q8 && size_q8 <= 2 * usual_q8).then_some(contrast_q8)
}

impl Step<'_> {
    /// The same as a call: inlined everywhere it would take 1 kB more of flash.
    #[inline(never)]
    fn fit_apart(&self, model: &EdgeModel) -> Option<Fit> {
        self.fit(model)
    }

    #[inline(always)]
    fn fit(&self, model: &EdgeModel) -> Option<Fit> {
        let Self { template, norms, moments, contrast, free_slope_slope, centre_q8, off_q8 } = self;
        let (slope, widening) = (moments.residual_slope, moments.residual_widening);
        let (slope, widening) = if contrast.is_falling { (-slope, -widening) } else { (slope, widening) };
        let per_contrast = contrast.reciprocal;
        // Where free levels explain a part of the slope, the rest is less sure.
        let of_noise_q8 = free_slope_slope.map_or(norms.sigma_q8, |slope_slope| norms.sigma_of_part_q8(slope_slope));
        let per_widening = free_slope_slope.is_none().then_some(norms.per_widening);
        let shift = per_contrast.times(norms.per_slope.times(slope));
        let shift_q16 = shifted(shift, -(norms.per_slope.lost() + per_contrast.lost()));
        Some(Fit {
            column_q16: (centre_q8 << 8).saturating_sub(shift_q16),
            sigma_q16: sigma_q16(of_noise_q8, model.noise_q8, per_contrast),
            width_q12: template.width_q12(widening, template.per_width(norms), per_contrast),
            residual_q16: moments.residual_q16(norms.per_slope, per_widening, norms.per_freedom_q16),
            off_q8: *off_q8,
            of_flank: [false; 2],
        })
    }
}
