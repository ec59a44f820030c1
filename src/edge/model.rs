//! [`EdgeModel`]: levels, blur and noise of a tracked edge, as running means over its rows.

use core::num::NonZeroU16;

use super::factor::Factor;
use super::pixel_row::PixelRow;
use super::point::{EdgePoint, Polarity};
use super::root::root;
use super::template::{Template, class_of};
use super::tuning::{
    FEW_TEXTURED_ROWS, LEARN_ROWS_LOG2, LEAST_BLUR_Q8, LEAST_CONTRAST_Q8, LEAST_NOISE_ROWS_LOG2, MANY_TEXTURED_ROWS,
    MEMORY_LOG2, MOST_BLUR_Q8, ONE_STEP_PARTS_LOG2, ONE_STEP_SIGMAS, RENEWAL_ROWS_LOG2, STAIRCASE_Q8, USUAL_BLUR_Q8,
};
use super::window::Window;
use crate::format::Pixels;

/// Levels, blur and noise of a tracked edge, running means over its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct EdgeModel {
    /// Brightness on the left and on the right, in 1/65536 grey level; those of a mosaic's odd rows apart. Zero: not
    /// seen yet.
    levels_q16: [[u32; 2]; 2],
    /// Variance of a pixel's noise, in 1/65536 square grey level.
    pub(super) noise_q16: u32,
    /// Its root as it was some rows ago, in 1/256 grey level.
    pub(super) noise_q8: u16,
    /// One sigma of the edge's blur, in 1/4096 px.
    pub(super) blur_q12: u16,
    /// Mean difference between a row's own level and the running mean, left and right.
    level_scatter_q8: [u16; 2],
    /// [`Template::per_contrast`] of the mean levels as they were some rows ago; not of a mosaic's odd rows.
    pub(super) per_contrast: Factor,
    /// One sigma of the pixels' noise when the line was confirmed.
    pub(super) white_q8: u16,
    /// How many; not zero, so that a track without a model is no larger.
    rows: NonZeroU16,
    /// Rows with texture on either side.
    textured_rows: u16,
    /// That of the blur.
    class: u8,
    /// Nothing around the edge asks for a closer look than [`EdgeModel::locate_usual`] takes: as it was when the means
    /// were taken last.
    pub(super) is_usual: bool,
}

/// Rounding to whole grey levels alone.
const LEAST_NOISE_Q16: u32 = 65536 / 12;

/// 45 grey levels, out of which no edge stands: some times as much fits.
const MOST_NOISE_Q16: u32 = 1 << 27;

/// What one row says, given the model.
pub(super) struct Fit {
    pub(super) column_q16: i32,
    pub(super) sigma_q16: u32,
    /// Width of the edge, whatever the lens.
    pub(super) width_q12: i32,
    /// Residual variance of a pixel.
    pub(super) residual_q16: u32,
    /// The row's own levels minus the mean ones.
    pub(super) off_q8: [i32; 2],
    /// Whether each is that of the flank's own outermost pixel, which changes with the phase of the pixel.
    pub(super) of_flank: [bool; 2],
}

impl EdgeModel {
    /// From an edge that a row shows on its own.
    pub(super) fn new<P: Pixels>(
        row: PixelRow<'_, P>,
        edge: &EdgePoint,
        bounds_q8: (i32, i32),
        noise_q8: u32,
    ) -> Option<Self> {
        // Its square has 31 bits.
        let white_q8 = row.noise_of_light_q8(edge.column_q16, noise_q8).min(i32::MAX.isqrt() as u32) as u16;
        let blur_q12 = edge.width_q8.clamp(USUAL_BLUR_Q8, MOST_BLUR_Q8) << 4;
        let noise_q16 = (u32::from(white_q8) * u32::from(white_q8)).clamp(LEAST_NOISE_Q16, MOST_NOISE_Q16);
        let mut model = Self {
            levels_q16: [[0; 2]; 2],
            noise_q16,
            noise_q8: root(noise_q16) as u16,
            blur_q12,
            level_scatter_q8: [0; 2],
            per_contrast: Factor::ONE,
            white_q8,
            rows: NonZeroU16::MIN,
            textured_rows: 0,
            class: class_of(blur_q12, 0),
            is_usual: false,
        };
        model.look_beside(row, edge.column_q16, bounds_q8)?;
        model.shows(row.kind(), edge.polarity).then_some(model)
    }

    /// Takes the levels from the plateaus of a row.
    pub(super) fn look_beside<P: Pixels>(
        &mut self,
        row: PixelRow<'_, P>,
        column_q16: i32,
        bounds_q8: (i32, i32),
    ) -> Option<()> {
        let window = Window::new(row, column_q16 >> 8, self.template(), bounds_q8)?;
        let own_q8 = window.levels_q8()?;
        *self.levels_q16.get_mut(row.kind())? = own_q8.map(|level_q8| (level_q8.max(0) as u32) << 8);
        self.renew_contrast();
        Some(())
    }

    /// After a change of levels or class.
    fn renew_contrast(&mut self) {
        if let Some(per_contrast) = self.template().per_contrast(self.contrast_q8(0)) {
            self.per_contrast = per_contrast;
        }
    }

    /// Whether rows of this kind show an edge of this polarity.
    pub(super) fn shows(&self, kind: usize, polarity: Polarity) -> bool {
        self.polarity(kind) == polarity && self.contrast_q8(kind).abs() >= LEAST_CONTRAST_Q8
    }

    fn polarity(&self, kind: usize) -> Polarity {
        if self.contrast_q8(kind) < 0 { Polarity::Falling } else { Polarity::Rising }
    }

    /// Looks at the first row of the other kind, so that its levels are known. `false` where the edge is none in such
    /// rows.
    pub(super) fn knows<P: Pixels>(&mut self, row: PixelRow<'_, P>, column_q16: i32, bounds_q8: (i32, i32)) -> bool {
        let (kind, other) = (row.kind(), 1 - row.kind());
        if self.levels_q8(kind) != [0; 2] {
            return true;
        }
        let is_one = self.look_beside(row, column_q16, bounds_q8).is_some() && self.shows(kind, self.polarity(other));
        if let (false, Some(levels_q16)) = (is_one, self.levels_q16.get_mut(kind)) {
            *levels_q16 = [0; 2];
        }
        is_one
    }

    pub(super) fn template(&self) -> &'static Template {
        Template::of(self.class)
    }

    /// One part in 2 to this power of the way to another blur.
    fn blur_toward(&mut self, width_q12: i32, parts_log2: u32) {
        let blur_q12 = i32::from(self.blur_q12);
        let wider_q12 = width_q12.min(2 * blur_q12).max(blur_q12 / 2);
        self.blur_q12 = toward(self.blur_q12, wider_q12, parts_log2).clamp(LEAST_BLUR_Q8 << 4, MOST_BLUR_Q8 << 4);
    }

    /// Takes a row's blur for the edge's.
    pub(super) fn widen(&mut self, width_q12: i32) {
        self.blur_toward(width_q12, 0);
        self.class = class_of(self.blur_q12, self.class);
        self.renew_contrast();
    }

    pub(super) fn levels_q8(&self, kind: usize) -> [i32; 2] {
        self.levels_q16.get(kind).map_or([0; 2], |levels_q16| levels_q16.map(|level_q16| (level_q16 >> 8) as i32))
    }

    /// Whether one of the levels is so near to the end of the scale that the sensor may have cut its noise, and a part
    /// of the flank, off: the width is then not that of the blur.
    pub(super) fn is_clipped(&self, kind: usize) -> bool {
        let two_sigma_q8 = 2 * i32::from(self.white_q8);
        self.levels_q8(kind).into_iter().any(|level_q8| level_q8 + two_sigma_q8 >= 255 << 8)
    }

    pub(super) fn contrast_q8(&self, kind: usize) -> i32 {
        let [left_q8, right_q8] = self.levels_q8(kind);
        right_q8 - left_q8
    }

    pub(super) fn blur_q16(&self) -> u32 {
        u32::from(self.blur_q12) << 4
    }

    /// An edge that is no farther off the expected column is located in one step: a part of its blur, or where noise moves
    /// it by more, what that explains.
    pub(super) fn one_step_q16(&self, sigma_q16: u32) -> u32 {
        let blur_q16 = self.blur_q16();
        let (least_q16, most_q16) = (blur_q16 >> ONE_STEP_PARTS_LOG2, blur_q16 / 2);
        (ONE_STEP_SIGMAS * sigma_q16.min(most_q16)).max(least_q16).min(most_q16)
    }

    /// Noise moves what is found, with this sigma, by no more: by four sigma, and a quarter of the blur.
    #[inline(always)]
    pub(super) fn most_moved_q16(&self, sigma_q16: u32) -> u32 {
        (4 * sigma_q16).saturating_add(u32::from(self.blur_q12) << 2)
    }

    /// What is farther away has no part in its window.
    pub(crate) fn far_q16(&self) -> u32 {
        (self.template().far_q8() as u32) << 8
    }

    pub(super) const fn blur_q8(&self) -> u16 {
        self.blur_q12 >> 4
    }

    /// Whether it is more blurred than the steps of a staircase are together.
    pub(crate) const fn is_beyond_steps(&self) -> bool {
        self.blur_q8() >= STAIRCASE_Q8.end
    }

    /// Whether many of the rows have texture beside the edge.
    const fn is_beside_texture(&self) -> bool {
        self.textured_rows >= FEW_TEXTURED_ROWS && self.textured_rows > self.rows.get() / 4
    }

    /// Whether that is sure.
    pub(crate) const fn is_surely_beside_texture(&self) -> bool {
        self.textured_rows >= MANY_TEXTURED_ROWS && self.is_beside_texture()
    }

    /// Whether one of the rows' own levels has changed lately by more than noise explains.
    pub(super) fn is_textured(&self) -> bool {
        self.level_scatter_q8.iter().any(|level_scatter| self.exceeds_noise(*level_scatter))
    }

    /// 0.4 sigma for a mean over four pixels is noise.
    fn exceeds_noise(&self, level_scatter_q8: u16) -> bool {
        u32::from(level_scatter_q8) * 4 > u32::from(self.white_q8) * 5
    }

    /// Whether the means are taken from the next row: from each at first, then from some.
    pub(super) const fn learns_next(&self) -> bool {
        let rows = self.rows.get();
        rows % (1 << LEARN_ROWS_LOG2) == (1 << LEARN_ROWS_LOG2) - 1 || rows < 2 << MEMORY_LOG2
    }

    /// Counts a row that shows the edge.
    pub(super) const fn count_row(&mut self) {
        self.rows = self.rows.saturating_add(1);
    }

    /// Running means: a small part of some of the rows, more of each of the first ones.
    #[inline(never)]
    pub(super) fn learn(&mut self, kind: usize, fit: &Fit) {
        let rows = self.rows.get().saturating_add(1);
        let is_settled = rows >= 2 << MEMORY_LOG2;
        if is_settled {
            self.learn_part(kind, fit, MEMORY_LOG2);
        } else {
            self.learn_part(kind, fit, u32::from(rows).max(1).ilog2());
        }
        let is_textured = self.is_textured();
        let new_rows = if is_settled { 1 << LEARN_ROWS_LOG2 } else { 1 };
        self.textured_rows = self.textured_rows.saturating_add(if is_textured { new_rows } else { 0 });
        let before = self.class;
        self.class = class_of(self.blur_q12, before);
        if self.class != before || rows.is_multiple_of(1 << RENEWAL_ROWS_LOG2) || rows < 1 << RENEWAL_ROWS_LOG2 {
            self.renew_contrast();
            self.noise_q8 = root(self.noise_q16) as u16;
        }
        let is_other = is_textured || self.is_surely_beside_texture() || self.is_clipped(0);
        self.is_usual = kind == 0 && !is_other;
    }

    /// One part in 2 to this power.
    // Inlined, so that shifts are by constants for most rows.
    #[inline(always)]
    fn learn_part(&mut self, kind: usize, fit: &Fit, parts_log2: u32) {
        // A few rows of something else are no texture.
        let most_q8 = 4 * i32::from(self.white_q8);
        let levels = fit.off_q8.into_iter().zip(fit.of_flank);
        for (level_scatter_q8, (off_q8, is_of_flank)) in self.level_scatter_q8.iter_mut().zip(levels) {
            // A single pixel is twice as noisy as the mean of four.
            let off_q8 = off_q8.abs() >> u32::from(is_of_flank);
            *level_scatter_q8 = toward(*level_scatter_q8, off_q8.min(most_q8), parts_log2);
        }
        if let Some(means_q16) = self.levels_q16.get_mut(kind) {
            for (mean_q16, off_q8) in means_q16.iter_mut().zip(fit.off_q8) {
                *mean_q16 = (*mean_q16 as i32 + part(off_q8 << 8, parts_log2)).clamp(0, 255 << 16) as u32;
            }
        }
        self.blur_toward(fit.width_q12, parts_log2);
        let noise_q16 = self.noise_q16 as i32;
        let most_q16 = 4 * self.noise_q16 + (1 << 16);
        let residual_q16 = fit.residual_q16.min(most_q16) as i32;
        let change_q16 = part(residual_q16 - noise_q16, parts_log2.max(LEAST_NOISE_ROWS_LOG2));
        self.noise_q16 = ((noise_q16 + change_q16) as u32).clamp(LEAST_NOISE_Q16, MOST_NOISE_Q16);
    }
}

/// One part of a value in 2 to this power, to the nearest: cut off, the means of faint edges would be biased.
fn part(value: i32, parts_log2: u32) -> i32 {
    (value + (1 << parts_log2 >> 1)) >> parts_log2
}

/// One part in 2 to this power of the way to `to`.
fn toward(from: u16, to: i32, parts_log2: u32) -> u16 {
    let value = i32::from(from);
    (value + part(to - value, parts_log2)).clamp(0, i32::from(u16::MAX)) as u16
}
