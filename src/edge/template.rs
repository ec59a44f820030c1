//! [`Template`]: what the pixels of an edge's flank should show, made when the library is compiled.
//!
//! A spread function for each class of blur, sampled at some phases of the pixel. A row is compared with the nearest phase of its
//! line's class: what it is off is told by the products with the slope and with the change by the width, so that neither
//! phases nor classes need to be fine.

use super::norms::{Norms, Squares};
use super::spread_function::{Place, SpreadFunction};
use super::tuning::{CLASS_RATIO, LEAST_BLUR_Q8, MOST_BLUR_Q8, PLATEAU};
use super::weight::Weight;

/// The templates of one blur.
#[derive(Clone, Copy)]
pub(super) struct Template {
    /// One sigma of the blur, the pixel's own included, in 1/256 px.
    pub(super) width_q8: u16,
    /// b: the slope's unit, in 1/256 px.
    pub(super) box_q8: u16,
    /// Half the width of what is neither 0 nor 1, in 1/256 px.
    pub(super) reach_q8: u16,
    /// The width's change that one unit of [`Weight::widening`] stands for, in 1/4 px.
    pub(super) per_widening_q2: u32,
    /// Phases of the pixel: 2 to this power.
    phases_log2: u8,
    /// Pixels of each phase.
    pixels: u8,
    /// Where its weights begin, and the norms of its phases.
    first: u16,
    first_phase: u8,
}

/// A template at a phase: where its first pixel lies and where its step, in 1/256 px.
pub(super) struct Sampled {
    pub(super) first: i32,
    pub(super) centre_q8: i32,
    pub(super) weights: &'static [Weight],
    pub(super) norms: &'static Norms,
}

impl Template {
    /// The template of a class; the widest where there is no such class.
    pub(super) fn of(class: u8) -> &'static Self {
        const TABLE: &[Template; CLASSES] = &TEMPLATES;
        TABLE.get(usize::from(class)).unwrap_or(&WIDEST)
    }

    /// Its phase that is nearest to a column in 1/256 px.
    pub(super) fn at(&self, column_q8: i32) -> Sampled {
        let fine = 8 - u32::from(self.phases_log2);
        let phase = (column_q8 + (1 << fine >> 1)) >> fine;
        // Half a pixel to either side of the middle one.
        let shifted = phase + (1 << self.phases_log2 >> 1);
        let (pixel, part) = (shifted >> self.phases_log2, shifted & ((1 << self.phases_log2) - 1));
        let pixels = usize::from(self.pixels);
        let from = usize::from(self.first) + part as usize * pixels;
        Sampled {
            first: pixel - i32::from(self.pixels / 2),
            centre_q8: phase << fine,
            weights: WEIGHTS.get(from..from + pixels).unwrap_or_default(),
            norms: NORMS.get(usize::from(self.first_phase) + part as usize).unwrap_or(&Norms::NONE),
        }
    }

    /// Pixels of a plateau on either side: beyond the reach of the blur.
    pub(super) const fn plateau(&self) -> i32 {
        self.pixels as i32 / 2 + PLATEAU
    }
}

/// The class of a blur in 1/4096 px, on from the present one: it changes where the blur is nearer to another one's, so that a
/// blur between two does not change it from row to row.
pub(super) fn class_of(blur_q12: u16, present: u8) -> u8 {
    let width_q12 = |class: u8| u32::from(Template::of(class).width_q8) << 4;
    let blur_q12 = u32::from(blur_q12);
    let mut class = present.min(CLASSES as u8 - 1);
    while usize::from(class) + 1 < CLASSES && blur_q12 * 2 > width_q12(class) + width_q12(class + 1) {
        class += 1;
    }
    while class > 0 && blur_q12 * 2 < width_q12(class) + width_q12(class - 1) {
        class -= 1;
    }
    class
}

const fn wider(width_q8: u16) -> u16 {
    let (numerator, denominator) = CLASS_RATIO;
    (width_q8 as u32 * numerator as u32 / denominator as u32) as u16
}

const CLASSES: usize = {
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

const TEMPLATES: [Template; CLASSES] = {
    let mut templates = [Template::EMPTY; CLASSES];
    let (mut class, mut width_q8, mut first, mut first_phase) = (0, LEAST_BLUR_Q8, 0, 0);
    while class < CLASSES {
        let width = if width_q8 < MOST_BLUR_Q8 { width_q8 } else { MOST_BLUR_Q8 };
        templates[class] = Template::new(width, first, first_phase);
        first += templates[class].weights();
        first_phase += 1 << templates[class].phases_log2;
        width_q8 = wider(width_q8);
        class += 1;
    }
    templates
};

const WIDEST: Template = TEMPLATES[CLASSES - 1];

static WEIGHTS: [Weight; WEIGHT_COUNT] = ALL_WEIGHTS;

const WEIGHT_COUNT: usize = (WIDEST.first + WIDEST.weights()) as usize;

static NORMS: [Norms; PHASE_COUNT] = {
    let mut norms = [Norms::NONE; PHASE_COUNT];
    let mut class = 0;
    while class < CLASSES {
        let template = &TEMPLATES[class];
        let mut phase = 0;
        while phase < 1 << template.phases_log2 {
            let (mut sums, mut pixel) = (Squares::NONE, 0);
            while pixel < template.pixels {
                let at = template.first as usize + phase * template.pixels as usize + pixel as usize;
                sums = sums.with(&ALL_WEIGHTS[at]);
                pixel += 1;
            }
            norms[template.first_phase as usize + phase] = sums.norms([template.plateau() as u32; 2]);
            phase += 1;
        }
        class += 1;
    }
    norms
};

const PHASE_COUNT: usize = WIDEST.first_phase as usize + (1 << WIDEST.phases_log2);

const ALL_WEIGHTS: [Weight; WEIGHT_COUNT] = {
    let mut weights = [Weight { step: 0, slope: 0, widening: 0 }; WEIGHT_COUNT];
    let mut class = 0;
    while class < CLASSES {
        let template = &TEMPLATES[class];
        let function = SpreadFunction::new(template.width_q8);
        let largest = template.largest_widening(&function);
        let mut phase = 0;
        while phase < 1 << template.phases_log2 {
            let share_q15 = template.share_of_shape(&function, phase);
            let mut pixel = 0;
            while pixel < template.pixels {
                let at = template.first as usize + phase * template.pixels as usize + pixel as usize;
                let place = function.at(template.off_q8(phase, pixel));
                weights[at] = Weight::new(&place, widening(&place, share_q15), largest);
                pixel += 1;
            }
            phase += 1;
        }
        class += 1;
    }
    weights
};

/// The change with the width, less what another lens at the same width would explain of it.
const fn widening(place: &Place, share_q15: i64) -> i32 {
    place.widening - ((place.shape as i64 * share_q15) >> 15) as i32
}

impl Template {
    const EMPTY: Self = Self {
        width_q8: 0,
        box_q8: 0,
        reach_q8: 0,
        per_widening_q2: 0,
        phases_log2: 0,
        pixels: 0,
        first: 0,
        first_phase: 0,
    };

    const fn new(width_q8: u16, first: u16, first_phase: u8) -> Self {
        let function = SpreadFunction::new(width_q8);
        let reach_q8 = function.reach_q8() as u16;
        let mut template = Self {
            width_q8,
            box_q8: function.box_q8 as u16,
            reach_q8,
            per_widening_q2: 0,
            phases_log2: phases_log2(width_q8),
            pixels: (2 * ((reach_q8 + 128) >> 8) + 1) as u8,
            first,
            first_phase,
        };
        let largest = template.largest_widening(&function);
        // One unit is the largest change with the width, in 1/32768, over 127.
        template.per_widening_q2 = (function.per_widening_q8 as u32) * (127 << 9) / largest as u32;
        template
    }

    const fn weights(&self) -> u16 {
        (self.pixels as u16) << self.phases_log2
    }

    const fn off_q8(&self, phase: usize, pixel: u8) -> i32 {
        let from_middle_q8 = (pixel as i32 - self.pixels as i32 / 2) << 8;
        from_middle_q8 - (((phase as i32 - (1 << self.phases_log2 >> 1)) << 8) >> self.phases_log2)
    }

    /// How much of the change with the width another lens at the same width would explain.
    const fn share_of_shape(&self, function: &SpreadFunction, phase: usize) -> i64 {
        let (mut shared, mut own, mut pixel) = (0_i64, 0_i64, 0);
        while pixel < self.pixels {
            let place = function.at(self.off_q8(phase, pixel));
            shared += place.widening as i64 * place.shape as i64;
            own += place.shape as i64 * place.shape as i64;
            pixel += 1;
        }
        if own > 0 { (shared << 15) / own } else { 0 }
    }

    const fn largest_widening(&self, function: &SpreadFunction) -> i32 {
        let (mut largest, mut phase) = (1, 0);
        while phase < 1 << self.phases_log2 {
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
