//! [`SpreadFunction`]: a blurred step, in integers.
//!
//! The lens blurs an edge as a Gaussian does, the pixel and motion as boxes do. The wider box is taken as it is, the
//! other one as a part of the Gaussian: exact without motion and for a long one. All of it is evaluated when the
//! library is compiled: see [`template`](super::template).

use super::tuning::{LENS_VARIANCE_Q16, MOST_BLUR_Q8};

/// A step of height one after a box of width b and a Gaussian of sigma s. One number, the standard deviation of the
/// blur, decides about both: up to what a usual lens explains s grows, beyond it the box.
#[derive(Clone, Copy)]
pub(crate) struct SpreadFunction {
    pub(crate) box_q8: i32,
    lens_q8: i32,
    /// 1/s in 1/256 px, times 2²⁰; 1/b likewise, times 2²⁴.
    per_lens_q20: i32,
    per_box_q24: i32,
    /// What makes the change with the width one per pixel, in 1/256 px.
    pub(crate) per_widening_q8: i32,
    /// 12 s/b: how much the box changes with the lens at a given width.
    box_per_lens_q8: i32,
}

/// The spread function and its derivatives at one place, in 1/32768.
pub(crate) struct Place {
    /// The step itself.
    pub(crate) step: i32,
    /// Its slope times b.
    pub(crate) slope: i32,
    /// Its change with the width, times [`SpreadFunction::per_widening_q8`].
    pub(crate) widening: i32,
    /// Its change where the lens blurs more and the box less, the width being the same; zero where there is no box.
    pub(crate) shape: i32,
}

/// One pixel.
const PIXEL_Q8: i32 = 256;
/// Variance of a pixel's box, in 1/65536 square pixel.
const PIXEL_VARIANCE_Q16: i32 = 65536 / 12;
/// One sigma of a lens and a pixel.
const LENS_AND_PIXEL_Q8: i32 = 194;
const LEAST_LENS_Q8: i32 = 40;

impl SpreadFunction {
    /// The spread function of an edge whose blur has this standard deviation, the pixel's own included, in 1/256 px.
    pub(crate) const fn new(width_q8: u16) -> Self {
        // Twelve times the square must fit.
        let width_q8 = (if width_q8 < MOST_BLUR_Q8 { width_q8 } else { MOST_BLUR_Q8 }) as i32;
        let variance_q16 = width_q8 * width_q8;
        let of_motion_q16 = variance_q16 - LENS_VARIANCE_Q16 - PIXEL_VARIANCE_Q16;
        if of_motion_q16 > PIXEL_VARIANCE_Q16 {
            let box_q8 = (12 * of_motion_q16).unsigned_abs().isqrt() as i32;
            let per_widening_q8 = ratio(box_q8 * box_q8, 12 * width_q8);
            Self::with(box_q8, LENS_AND_PIXEL_Q8, ratio(1 << 24, box_q8), per_widening_q8)
        } else {
            let lens_variance_q16 = variance_q16 - PIXEL_VARIANCE_Q16;
            let least_q16 = LEAST_LENS_Q8 * LEAST_LENS_Q8;
            let lens_q8 = (if lens_variance_q16 > least_q16 { lens_variance_q16 } else { least_q16 })
                .unsigned_abs()
                .isqrt() as i32;
            Self::with(PIXEL_Q8, lens_q8, 1 << 16, ratio(lens_q8 * PIXEL_Q8, width_q8))
        }
    }

    const fn with(box_q8: i32, lens_q8: i32, per_box_q24: i32, per_widening_q8: i32) -> Self {
        let box_per_lens_q8 = ratio((12 * lens_q8) << 8, box_q8);
        let per_widening_q8 = if per_widening_q8 > 1 { per_widening_q8 } else { 1 };
        Self { box_q8, lens_q8, per_lens_q20: ratio(1 << 20, lens_q8), per_box_q24, per_widening_q8, box_per_lens_q8 }
    }

    /// Half the width of what is neither 0 nor 1, in 1/256 px: 2.5 sigma of the Gaussian beyond the box.
    pub(crate) const fn reach_q8(&self) -> i32 {
        self.box_q8 / 2 + self.lens_q8 * 5 / 2
    }

    /// At `off_q8` from the middle of the step. With J the integral of Φ it is s (J((x + b/2)/s) − J((x − b/2)/s))/b,
    /// and of J the part max(z, 0) is taken apart.
    pub(crate) const fn at(&self, off_q8: i32) -> Place {
        let ahead_q8 = off_q8 + self.box_q8 / 2;
        let (ahead, behind) = (self.normal(ahead_q8), self.normal(ahead_q8 - self.box_q8));
        let of_box_q8 = if ahead_q8 < self.box_q8 { ahead_q8 } else { self.box_q8 };
        let of_box_q8 = if of_box_q8 > 0 { of_box_q8 } else { 0 };
        let area_q23 = (of_box_q8 << 15) + self.lens_q8 * (ahead.rest - behind.rest);
        let step = ((area_q23 as i64 * self.per_box_q24 as i64) >> 24) as i32;
        let slope = ahead.below - behind.below;
        let with_lens = ahead.density() - behind.density();
        if self.box_q8 > PIXEL_Q8 {
            let with_box = (ahead.below + behind.below) / 2 - step;
            Place { step, slope, widening: with_box, shape: with_lens - ((with_box * self.box_per_lens_q8) >> 8) }
        } else {
            Place { step, slope, widening: with_lens, shape: 0 }
        }
    }

    const fn normal(&self, off_q8: i32) -> Normal {
        Normal::at((off_q8 * self.per_lens_q20) >> 12)
    }
}

/// A quotient by a length, which is never zero but for a width of nothing.
const fn ratio(numerator: i32, length: i32) -> i32 {
    match numerator.checked_div(length) {
        Some(quotient) => quotient,
        None => numerator,
    }
}

/// The normal distribution, in 1/32768: Φ, and the integral of Φ less max(z, 0).
struct Normal {
    z_q8: i32,
    below: i32,
    rest: i32,
}

impl Normal {
    const fn at(z_q8: i32) -> Self {
        let size = z_q8.unsigned_abs() as usize;
        let (index, part) = (size >> 4, (size & 15) as i32);
        let (below, rest) = if index + 1 < TABLE.len() {
            let (a, b) = (TABLE[index], TABLE[index + 1]);
            (between(a.0, b.0, part), between(a.1, b.1, part))
        } else {
            (1 << 15, 0)
        };
        Self { z_q8, below: if z_q8 < 0 { (1 << 15) - below } else { below }, rest }
    }

    /// φ(z) = rest + |z| Φ(−|z|).
    const fn density(&self) -> i32 {
        let beyond = if self.z_q8 < 0 { self.below } else { (1 << 15) - self.below };
        self.rest + ((self.z_q8.abs() * beyond) >> 8)
    }
}

const fn between(a: u16, b: u16, part: i32) -> i32 {
    (a as i32 * (16 - part) + b as i32 * part + 8) >> 4
}

/// Φ(z) and φ(z) − z Φ(−z) at z = k/16, in 1/32768.
#[rustfmt::skip]
const TABLE: [(u16, u16); 66] = [
    (16384, 13073), (17201, 12074), (18014, 11127), (18821, 10230), (19618, 9383), (20404, 8586),
    (21174, 7837), (21926, 7136), (22658, 6481), (23367, 5872), (24052, 5306), (24711, 4782),
    (25342, 4298), (25944, 3853), (26516, 3444), (27058, 3071), (27569, 2730), (28049, 2420),
    (28499, 2140), (28917, 1886), (29306, 1658), (29666, 1453), (29997, 1269), (30301, 1106),
    (30579, 960), (30832, 832), (31061, 718), (31269, 618), (31455, 530), (31623, 453),
    (31772, 386), (31905, 328), (32023, 278), (32126, 235), (32218, 198), (32298, 166),
    (32367, 139), (32428, 116), (32480, 96), (32526, 80), (32565, 66), (32598, 54),
    (32626, 44), (32650, 36), (32670, 29), (32687, 24), (32702, 19), (32714, 16),
    (32724, 13), (32732, 10), (32739, 8), (32744, 6), (32749, 5), (32753, 4),
    (32756, 3), (32758, 2), (32760, 2), (32762, 1), (32763, 1), (32764, 1),
    (32765, 1), (32766, 1), (32766, 0), (32767, 0), (32767, 0), (32768, 0),
];

#[cfg(test)]
mod tests {
    use super::SpreadFunction;

    /// A step after a box and a Gaussian, by numerical integration of the normal distribution.
    fn step(off: f64, width: f64, sigma: f64) -> f64 {
        const PARTS: i32 = 2000;
        let normal = |z: f64| 0.5 * libm::erfc(-z / core::f64::consts::SQRT_2);
        let at = |part: i32| (f64::from(part) + 0.5) / f64::from(PARTS) - 0.5;
        (0..PARTS).map(|part| normal((off + width * at(part)) / sigma)).sum::<f64>() / f64::from(PARTS)
    }

    /// Within 1/500 of the step, from a sharp lens to the longest blur; and its width is what it says.
    #[test]
    fn it_is_a_blurred_step() {
        for width_q8 in [148_u16, 170, 200, 240, 300, 500, 900, 1600, 3072] {
            let function = SpreadFunction::new(width_q8);
            let [box_px, lens_px] = [function.box_q8, function.lens_q8].map(|length| f64::from(length) / 256.0);
            let width_px = libm::sqrt(lens_px * lens_px + box_px * box_px / 12.0);
            assert!((width_px * 256.0 / f64::from(width_q8) - 1.0).abs() < 0.01, "{width_px} px for {width_q8}");
            for off_q8 in (-6000..6000).step_by(37) {
                let expected = step(f64::from(off_q8) / 256.0, box_px, lens_px);
                let found = f64::from(function.at(off_q8).step) / 32768.0;
                assert!((found - expected).abs() < 2e-3, "{width_q8} at {off_q8}: {found} for {expected}");
            }
        }
    }

    /// The slope and the change with the width are derivatives of the step.
    #[test]
    fn its_derivatives_are_those_of_the_step() {
        for width_q8 in [160_u16, 190, 400, 1000, 2500] {
            let function = SpreadFunction::new(width_q8);
            let (narrower, wider) = (SpreadFunction::new(width_q8 - 8), SpreadFunction::new(width_q8 + 8));
            let reach_q8 = function.reach_q8();
            for off_q8 in (-reach_q8..reach_q8).step_by(29) {
                let place = function.at(off_q8);
                let rise = f64::from(function.at(off_q8 + 32).step - function.at(off_q8 - 32).step) / 64.0;
                let slope = f64::from(place.slope) / f64::from(function.box_q8);
                assert!((rise - slope).abs() < 4.0, "{width_q8} at {off_q8}: {slope} for {rise}");
                let change = f64::from(wider.at(off_q8).step - narrower.at(off_q8).step) / 16.0;
                let widening = f64::from(place.widening) / f64::from(function.per_widening_q8);
                assert!((change - widening).abs() < 4.0, "{width_q8} at {off_q8}: {widening} for {change}");
            }
        }
    }
}
