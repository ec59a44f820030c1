//! [`Phase`]: what the pixels of a flank should show at one phase of the pixel, and what follows from that: tables that
//! are made when the library is compiled.

use super::factor::Factor;
use super::feet::Feet;
use super::level_norms::LevelNorms;
use super::norms::{Norms, Squares};
use super::products::Expected;
use super::spread_function::SpreadFunction;
use super::template::{CLASSES, TEMPLATES, Template, WIDEST, widening};
use super::weight::Weight;

/// A template at a phase: where its first pixel lies and where its step, in 1/256 px.
pub(super) struct Sampled {
    pub(super) first: i32,
    pub(super) centre_q8: i32,
    pub(super) phase: &'static Phase,
}

/// What the pixels of a flank should show where the step lies at one phase of the pixel.
pub(super) struct Phase {
    pub(super) weights: &'static [Weight],
    pub(super) norms: Norms,
    pub(super) feet: Feet,
    /// How far it is from the middle of the pixel, in 1/256 px.
    off_q8: i16,
    /// Its place among the phases of all classes.
    place: u8,
}

/// What of a phase only the quick ways of grey bytes ask for: a table of its own, which programs without these leave
/// out.
pub(super) struct QuickPhase {
    pub(super) expected: Expected,
    /// [`Template::per_width`].
    pub(super) per_width: Factor,
    /// Sum of the slope.
    pub(super) slope: u16,
}

impl Template {
    /// Its phase that is nearest to a column in 1/256 px.
    #[inline(always)]
    pub(super) fn at(&self, column_q8: i32) -> Sampled {
        let shifted_q8 = column_q8 + i32::from(self.rounding_q8);
        let (pixel, part) = (shifted_q8 >> 8, (shifted_q8 & 0xFF) as usize >> (self.step_log2 & 31));
        let phase = Phase::at(usize::from(self.first_phase) + part);
        Sampled { first: pixel - i32::from(self.pixels / 2), centre_q8: (pixel << 8) + i32::from(phase.off_q8), phase }
    }
}

impl Phase {
    const NONE: Self = Self { weights: &[], norms: Norms::NONE, feet: Feet::NONE, off_q8: 0, place: 0 };

    /// The one at this place among the phases of all classes.
    #[inline(always)]
    fn at(place: usize) -> &'static Self {
        PHASES.get(place).unwrap_or(&Self::NONE)
    }

    #[inline(always)]
    pub(super) fn quick(&self) -> &'static QuickPhase {
        QUICK_PHASES.get(usize::from(self.place)).unwrap_or(&QuickPhase::NONE)
    }

    /// What its flank says of the levels, where that is in the table.
    #[inline(always)]
    pub(super) fn level_norms(&self) -> Option<&'static LevelNorms> {
        LEVEL_NORMS.get(usize::from(self.place))
    }
}

impl QuickPhase {
    const NONE: Self = Self { expected: Expected::NONE, per_width: Factor::ONE, slope: 0 };
}

static WEIGHTS: [Weight; WEIGHT_COUNT] = ALL_WEIGHTS;

const WEIGHT_COUNT: usize = (WIDEST.first + WIDEST.weights()) as usize;

static PHASES: [Phase; PHASE_COUNT] = {
    let mut phases = [const { Phase::NONE }; PHASE_COUNT];
    let (mut class, mut rest): (usize, &[Weight]) = (0, &WEIGHTS);
    while class < CLASSES {
        let template = &TEMPLATES[class];
        let mut phase = 0;
        while phase < template.phases() {
            let (weights, others) = rest.split_at(template.pixels as usize);
            let (mut sums, mut pixel) = (Squares::NONE, 0);
            while pixel < weights.len() {
                sums = sums.with(&weights[pixel]);
                pixel += 1;
            }
            let norms = sums.norms([template.plateau() as u32; 2]);
            let feet = Feet::of(weights);
            let (off_q8, place) = (template.phase_off_q8(phase as usize) as i16, template.first_phase + phase);
            phases[place as usize] = Phase { weights, norms, feet, off_q8, place };
            rest = others;
            phase += 1;
        }
        class += 1;
    }
    phases
};

static QUICK_PHASES: [QuickPhase; PHASE_COUNT] = {
    let mut phases = [const { QuickPhase::NONE }; PHASE_COUNT];
    let mut class = 0;
    while class < CLASSES {
        let template = &TEMPLATES[class];
        let mut place = template.first_phase as usize;
        while place < (template.first_phase + template.phases()) as usize {
            let Phase { weights, norms, .. } = &PHASES[place];
            let (expected, per_width) = (Expected::of(weights), template.per_width(norms));
            phases[place] = QuickPhase { expected, per_width, slope: sum_of_slope(weights) };
            place += 1;
        }
        class += 1;
    }
    phases
};

const fn sum_of_slope(mut weights: &[Weight]) -> u16 {
    let mut sum = 0;
    while let [weight, others @ ..] = weights {
        (sum, weights) = (sum + weight.slope as u16, others);
    }
    sum
}

/// Of the blurs that have eight phases: beside texture others are rare, and would take as much flash again.
static LEVEL_NORMS: [LevelNorms; LEVEL_NORM_COUNT] = {
    let mut norms = [const { LevelNorms::of(&[]) }; LEVEL_NORM_COUNT];
    let mut place = 0;
    while place < LEVEL_NORM_COUNT {
        norms[place] = LevelNorms::of(PHASES[place].weights);
        place += 1;
    }
    norms
};

const LEVEL_NORM_COUNT: usize = {
    let mut class = 0;
    while TEMPLATES[class].phases() == 8 {
        class += 1;
    }
    TEMPLATES[class].first_phase as usize
};

const PHASE_COUNT: usize = (WIDEST.first_phase + WIDEST.phases()) as usize;

const ALL_WEIGHTS: [Weight; WEIGHT_COUNT] = {
    let mut weights = [Weight { step: 0, slope: 0, widening: 0 }; WEIGHT_COUNT];
    let mut class = 0;
    while class < CLASSES {
        let template = &TEMPLATES[class];
        let function = SpreadFunction::new(template.width_q8);
        let largest = template.largest_widening(&function);
        let mut phase = 0;
        while phase < template.phases() as usize {
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

#[cfg(test)]
mod tests {
    use super::super::template::{CLASSES, Template};
    use super::Phase;

    /// Factors of a row that is as usual: their products are within the range of [`Factor::product`] for every blur and
    /// contrast, and good to a part in 2¹².
    #[test]
    fn factors_of_usual_rows_make_products() {
        for (class, template) in (0..CLASSES as u8).map(|class| (class, Template::of(class))) {
            for place in (template.first_phase..).take(template.phases().into()) {
                let phase = Phase::at(place.into());
                for level in 4..=255 {
                    let per_contrast = template.per_contrast(level << 8).expect("a contrast");
                    for factor in [phase.norms.per_slope, phase.quick().per_width] {
                        let both = factor.roughly_and(per_contrast);
                        assert!((12..44).contains(&(both.lost() + 16)), "class {class}, {level}: {both:?}");
                        let value = 1 << 24;
                        let exact = per_contrast.times(factor.times(value));
                        let exact = f64::from(exact) / libm::exp2(f64::from(per_contrast.lost() + factor.lost()));
                        let off = (f64::from(both.product(value)) - exact).abs();
                        assert!(off <= 2.0 + exact / 4096.0, "class {class}, {level}: {off} of {exact}");
                    }
                }
            }
        }
    }
}
