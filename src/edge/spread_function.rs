//! [`SpreadFunction`]: a blurred step, in integers.
//!
//! The lens blurs an edge as a Gaussian does, the pixel and motion as boxes do. The wider box is taken as it is, the other
//! one as a part of the Gaussian: exact without motion and for a long one.

/// A step of height one after a box of width b and a Gaussian of sigma s. One number, the standard deviation of the blur, decides
/// about both: up to what a usual lens explains s grows, beyond it the box.
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
/// Variance of a usual lens's blur of 0.7 px; more is motion.
const LENS_VARIANCE_Q16: i32 = 32113;
/// One sigma of a lens and a pixel.
const LENS_AND_PIXEL_Q8: i32 = 194;
const LEAST_LENS_Q8: i32 = 40;

impl SpreadFunction {
    /// The spread function of an edge whose blur has this standard deviation, the pixel's own included.
    pub(crate) fn new(width_q8: u16) -> Self {
        // Twelve times the square must fit.
        let width_q8 = i32::from(width_q8.clamp(1, 12 << 8));
        let variance_q16 = width_q8 * width_q8;
        let of_motion_q16 = variance_q16 - LENS_VARIANCE_Q16 - PIXEL_VARIANCE_Q16;
        if of_motion_q16 > PIXEL_VARIANCE_Q16 {
            let box_q8 = (12 * of_motion_q16.unsigned_abs()).isqrt() as i32;
            Self::with(
                box_q8,
                LENS_AND_PIXEL_Q8,
                (1 << 24) / box_q8.max(1),
                (box_q8 * box_q8).checked_div(12 * width_q8).unwrap_or(1),
            )
        } else {
            let lens_q8 = ((variance_q16 - PIXEL_VARIANCE_Q16).max(0).unsigned_abs().isqrt() as i32).max(LEAST_LENS_Q8);
            Self::with(PIXEL_Q8, lens_q8, 1 << 16, (lens_q8 * PIXEL_Q8).checked_div(width_q8).unwrap_or(1))
        }
    }

    fn with(box_q8: i32, lens_q8: i32, per_box_q24: i32, per_widening_q8: i32) -> Self {
        let per_lens_q20 = (1 << 20) / lens_q8.max(1);
        let box_per_lens_q8 = ((12 * lens_q8) << 8) / box_q8.max(1);
        Self { box_q8, lens_q8, per_lens_q20, per_box_q24, per_widening_q8: per_widening_q8.max(1), box_per_lens_q8 }
    }

    /// Half the width of what is neither 0 nor 1, in 1/256 px: 2.5 sigma of the Gaussian beyond the box.
    pub(crate) const fn reach_q8(&self) -> i32 {
        self.box_q8 / 2 + self.lens_q8 * 5 / 2
    }

    /// From `off_q8` from the middle of the step on, one pixel after the other.
    pub(crate) fn walk(&self, off_q8: i32) -> impl Iterator<Item = Place> {
        let mut ahead_q8 = off_q8 + self.box_q8 / 2;
        // One pixel's end is the next one's beginning.
        let mut last = None;
        core::iter::from_fn(move || {
            let behind = last.take().unwrap_or_else(|| self.normal(ahead_q8 - self.box_q8));
            let ahead = self.normal(ahead_q8);
            let place = self.at(ahead_q8, &ahead, &behind);
            if self.box_q8 == PIXEL_Q8 {
                last = Some(ahead);
            }
            ahead_q8 += PIXEL_Q8;
            Some(place)
        })
    }

    fn normal(&self, off_q8: i32) -> Normal {
        Normal::at((off_q8 * self.per_lens_q20) >> 12)
    }

    /// With J the integral of Φ it is s (J((x + b/2)/s) − J((x − b/2)/s))/b, and of J the part max(z, 0) is taken apart.
    fn at(&self, ahead_q8: i32, ahead: &Normal, behind: &Normal) -> Place {
        let area_q23 = (ahead_q8.min(self.box_q8).max(0) << 15) + self.lens_q8 * (ahead.rest - behind.rest);
        let step = ((i64::from(area_q23) * i64::from(self.per_box_q24)) >> 24) as i32;
        let slope = ahead.below - behind.below;
        let with_lens = ahead.density() - behind.density();
        if self.box_q8 > PIXEL_Q8 {
            let with_box = (ahead.below + behind.below) / 2 - step;
            Place { step, slope, widening: with_box, shape: with_lens - ((with_box * self.box_per_lens_q8) >> 8) }
        } else {
            Place { step, slope, widening: with_lens, shape: 0 }
        }
    }
}

/// The normal distribution, in 1/32768: Φ, and the integral of Φ less max(z, 0).
struct Normal {
    z_q8: i32,
    below: i32,
    rest: i32,
}

impl Normal {
    fn at(z_q8: i32) -> Self {
        let size = z_q8.unsigned_abs();
        let (index, part) = ((size >> 4) as usize, (size & 15) as i32);
        let (below, rest) = match (TABLE.get(index), TABLE.get(index + 1)) {
            (Some(a), Some(b)) => {
                let between = |a: u16, b: u16| (i32::from(a) * (16 - part) + i32::from(b) * part + 8) >> 4;
                (between(a.0, b.0), between(a.1, b.1))
            }
            _ => (1 << 15, 0),
        };
        Self { z_q8, below: if z_q8 < 0 { (1 << 15) - below } else { below }, rest }
    }

    /// φ(z) = rest + |z| Φ(−|z|).
    fn density(&self) -> i32 {
        let beyond = if self.z_q8 < 0 { self.below } else { (1 << 15) - self.below };
        self.rest + ((self.z_q8.abs() * beyond) >> 8)
    }
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
