//! [`Template`]: a class of blur, made when the library is compiled.
//!
//! What the pixels of an edge's flank should show is a spread function for each class, sampled at some
//! [phases](super::phase) of the pixel. A row is compared with the nearest phase of its line's class: what it is off is
//! told by the products with the slope and with the change by the width, so that neither phases nor classes need to be
//! fine.

use super::factor::{Factor, shifted};
use super::norms::Norms;
use super::pixel_count::{mean_q8, per_pixels_q20};
use super::spread_function::{Place, SpreadFunction};
use super::tuning::{CLASS_RATIO, LEAST_BLUR_Q8, MOST_BLUR_Q8, PLATEAU};

/// The template of one class of blur, at all its phases.
#[derive(Clone, Copy)]
pub(super) struct Template {
    /// One sigma of the blur, the pixel's own included, in 1/256 px.
    pub(super) width_q8: u16,
    /// b: the slope's unit, in 1/256 px.
    pub(super) box_q8: u16,
    /// Half the width of what is neither 0 nor 1, in 1/256 px.
    pub(super) reach_q8: u16,
    /// The width's change that one unit of [`Weight::widening`](super::weight::Weight::widening) stands for, in b, over
    /// 2¹².
    per_widening: Factor,
    /// The blurs that are not nearer to the next class, in 1/4096 px.
    blurs_q12: [u16; 2],
    /// One over the number of pixels of a plateau.
    per_plateau_q20: u32,
    far_q8: u16,
    /// Half a pixel to either side of the middle one, and half a phase to either side of each.
    pub(super) rounding_q8: u16,
    /// Phases of the pixel, and 1/256 px from one to the next: 2 to these powers.
    phases_log2: u8,
    pub(super) step_log2: u8,
    /// Pixels of each phase.
    pub(super) pixels: u8,
    /// Where its weights begin, and its phases.
    pub(super) first: u16,
    pub(super) first_phase: u8,
}

impl Template {
    /// The template of a class; the widest where there is no such class.
    pub(super) fn of(class: u8) -> &'static Self {
        const TABLE: &[Template; CLASSES] = &TEMPLATES;
        TABLE.get(usize::from(class)).unwrap_or(&WIDEST)
    }

    /// b over a contrast in 1/256 grey level: in 1/2¹⁸ px and grey level. `None` where there is none.
    pub(super) fn per_contrast(&self, contrast_q8: i32) -> Option<Factor> {
        let per_level_q18 = (u32::from(self.box_q8) << 16).checked_div(contrast_q8.unsigned_abs() >> 2)?;
        Some(Factor::of(per_level_q18, 0))
    }

    /// The width of an edge: the template's, and what the product of a row's residuals with its change, in 1/64 grey
    /// level, says of it.
    #[inline(always)]
    pub(super) fn width_q12(&self, residual_widening: i32, per_width: Factor, per_contrast: Factor) -> i32 {
        let change = per_contrast.times(per_width.times(residual_widening));
        let lost = per_width.lost() + per_contrast.lost();
        (i32::from(self.width_q8) << 4) + shifted(change, -lost).clamp(-(1 << 20), (1 << 20) - 1)
    }

    /// The width's change for one unit of the product of residuals with it, in b, over 2¹².
    pub(super) const fn per_width(&self, norms: &Norms) -> Factor {
        self.per_width_of(norms.per_widening)
    }

    /// Likewise, given one over the product of that change with itself.
    pub(super) const fn per_width_of(&self, per_widening: Factor) -> Factor {
        self.per_widening.and(per_widening)
    }

    /// Pixels of a plateau on either side: beyond the reach of the blur.
    pub(super) const fn plateau(&self) -> i32 {
        self.pixels as i32 / 2 + PLATEAU
    }

    /// Pixels of a window: of the flank and of both plateaus.
    pub(super) const fn window(&self) -> usize {
        self.pixels as usize + 2 * self.plateau() as usize
    }

    /// An edge so far from any other stands alone: its window is whole, and no other blur reaches into it.
    pub(super) const fn far_q8(&self) -> i32 {
        self.far_q8 as i32
    }

    /// Mean of the pixels of a plateau, in 1/256 level, to the nearest, from the sum of its grey levels.
    pub(super) const fn mean_q8(&self, sum: u32) -> i32 {
        mean_q8(sum, self.per_plateau_q20)
    }
}

/// The class of a blur in 1/4096 px, on from the present one: it changes where the blur is nearer to another one's, so
/// that a blur between two does not change it from row to row.
pub(super) fn class_of(blur_q12: u16, present: u8) -> u8 {
    let blurs_q12 = |class: u8| Template::of(class).blurs_q12;
    let mut class = present.min(CLASSES as u8 - 1);
    while blur_q12 > blurs_q12(class)[1] {
        class += 1;
    }
    while blur_q12 < blurs_q12(class)[0] {
        class -= 1;
    }
    class
}

const fn wider(width_q8: u16) -> u16 {
    let (numerator, denominator) = CLASS_RATIO;
    (width_q8 as u32 * numerator as u32 / denominator as u32) as u16
}

pub(super) const CLASSES: usize = {
    let (mut classes, mut width_q8) = (1, LEAST_BLUR_Q8);
    while width_q8 < MOST_BLUR_Q8 {
        width_q8 = wider(width_q8);
        classes += 1;
    }
    classes
};

/// A step between phases is at most a fifth of the blur.
const fn phases_log2(width_q8: u16) -> u8 {
    match width_q8 {
        0..384 => 3,
        384..768 => 2,
        768..1536 => 1,
        _ => 0,
    }
}

pub(super) const TEMPLATES: [Template; CLASSES] = {
    let mut templates = [Template::EMPTY; CLASSES];
    let (mut class, mut width_q8, mut first, mut first_phase) = (0, LEAST_BLUR_Q8, 0, 0);
    while class < CLASSES {
        let width = if width_q8 < MOST_BLUR_Q8 { width_q8 } else { MOST_BLUR_Q8 };
        templates[class] = Template::new(width, first, first_phase);
        if class > 0 {
            // In the middle between two widths in 1/256 px.
            let between_q12 = (templates[class - 1].width_q8 + width) << 3;
            templates[class - 1].blurs_q12[1] = between_q12;
            templates[class].blurs_q12[0] = between_q12;
        }
        first += templates[class].weights();
        first_phase += templates[class].phases();
        width_q8 = wider(width_q8);
        class += 1;
    }
    templates
};

pub(super) const WIDEST: Template = TEMPLATES[CLASSES - 1];

/// The change with the width, less what another lens at the same width would explain of it.
pub(super) const fn widening(place: &Place, share_q15: i64) -> i32 {
    place.widening - ((place.shape as i64 * share_q15) >> 15) as i32
}

impl Template {
    const EMPTY: Self = Self {
        width_q8: 0,
        box_q8: 0,
        reach_q8: 0,
        per_widening: Factor::ONE,
        blurs_q12: [0, u16::MAX],
        per_plateau_q20: 0,
        far_q8: 0,
        rounding_q8: 0,
        phases_log2: 0,
        step_log2: 8,
        pixels: 0,
        first: 0,
        first_phase: 0,
    };

    const fn new(width_q8: u16, first: u16, first_phase: u8) -> Self {
        let function = SpreadFunction::new(width_q8);
        let (reach_q8, phases_log2) = (function.reach_q8() as u16, phases_log2(width_q8));
        let mut template = Self {
            width_q8,
            box_q8: function.box_q8 as u16,
            reach_q8,
            per_widening: Factor::ONE,
            blurs_q12: [0, u16::MAX],
            per_plateau_q20: 0,
            far_q8: 0,
            rounding_q8: (128 >> phases_log2) + if phases_log2 > 0 { 128 } else { 0 },
            phases_log2,
            step_log2: 8 - phases_log2,
            pixels: (2 * ((reach_q8 + 128) >> 8) + 1) as u8,
            first,
            first_phase,
        };
        let plateau = template.plateau() as u32;
        template.per_plateau_q20 = per_pixels_q20(template.plateau() as usize);
        // The window, rounded to whole pixels, and the reach of a neighbour's blur.
        template.far_q8 = (template.pixels as u16 / 2 + plateau as u16 + 1) * 256 + reach_q8;
        let largest = template.largest_widening(&function);
        // One unit is the largest change with the width, in 1/32768, over 127.
        let per_widening = (function.per_widening_q8 as u64) * (127 << 25) / largest as u64;
        template.per_widening = Factor::of((per_widening / function.box_q8 as u64) as u32, 22);
        template
    }

    /// How many phases of the pixel it has.
    pub(super) const fn phases(&self) -> u8 {
        1 << self.phases_log2
    }

    /// Pixels of all of them.
    pub(super) const fn weights(&self) -> u16 {
        (self.pixels as u16) << self.phases_log2
    }

    /// How far a pixel is from the step at a phase, in 1/256 px.
    pub(super) const fn off_q8(&self, phase: usize, pixel: u8) -> i32 {
        let from_middle_q8 = (pixel as i32 - self.pixels as i32 / 2) << 8;
        from_middle_q8 - self.phase_off_q8(phase)
    }

    /// How far a phase is from the middle of the pixel, in 1/256 px.
    pub(super) const fn phase_off_q8(&self, phase: usize) -> i32 {
        ((phase as i32 - (1 << self.phases_log2 >> 1)) << 8) >> self.phases_log2
    }

    /// How much of the change with the width another lens at the same width would explain.
    pub(super) const fn share_of_shape(&self, function: &SpreadFunction, phase: usize) -> i64 {
        let (mut shared, mut own, mut pixel) = (0_i64, 0_i64, 0);
        while pixel < self.pixels {
            let place = function.at(self.off_q8(phase, pixel));
            shared += place.widening as i64 * place.shape as i64;
            own += place.shape as i64 * place.shape as i64;
            pixel += 1;
        }
        if own > 0 { (shared << 15) / own } else { 0 }
    }

    /// The largest change with the width at any pixel and phase.
    pub(super) const fn largest_widening(&self, function: &SpreadFunction) -> i32 {
        let (mut largest, mut phase) = (1, 0);
        while phase < self.phases() as usize {
            let share_q15 = self.share_of_shape(function, phase);
            let mut pixel = 0;
            while pixel < self.pixels {
                let place = function.at(self.off_q8(phase, pixel));
                let size = widening(&place, share_q15).abs();
                largest = if size > largest { size } else { largest };
                pixel += 1;
            }
            phase += 1;
        }
        largest
    }
}

#[cfg(test)]
mod tests {
    use super::{CLASSES, Template};

    #[test]
    fn plateaus_are_counted() {
        for template in (0..CLASSES as u8).map(Template::of) {
            let pixels = template.plateau();
            assert_eq!(template.mean_q8(200 * pixels as u32), 200 << 8, "{pixels} pixels");
        }
    }
}
