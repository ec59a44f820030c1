//! [`Profile`]: what a tracked edge looks like, and where the next row has it.
//!
//! A row on its own locates an edge with the noise of all pixels around it. Where a line predicts the column, and its rows
//! so far tell both levels and the blur, the maximum-likelihood estimate is one step from the prediction: the row minus
//! the expected profile, weighted by the profile's slope. Its noise is the Cramér–Rao bound.

use crate::template::{Place, Template};
use crate::{Edge, Polarity, ScannedEdge};

/// Levels, blur and noise of a tracked edge, running means over its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Profile {
    /// Brightness on the left and on the right, in 1/65536 grey level.
    levels_q16: [u32; 2],
    /// One sigma of the edge's blur, in 1/4096 px.
    blur_q12: u16,
    rows: u16,
    /// Variance of a pixel's noise, in 1/65536 square grey level.
    noise_q16: u32,
    /// Mean difference between a row's own level and the running mean, left and right.
    unrest_q8: [u16; 2],
    /// One sigma of the pixels' noise when the line was confirmed.
    white_q8: u16,
}

/// What one row says, given the profile.
struct Fit {
    /// Column minus the expected one.
    shift_q16: i64,
    width_q12: i64,
    /// Contrast as a part of the expected one, in 1/256.
    amplitude_q8: i64,
    /// Residual variance of a pixel.
    residual_q16: i64,
    sigma_q16: i64,
    /// The row's own.
    levels_q16: [Option<u32>; 2],
}

/// Of a sharp lens, half a pixel, and the pixel itself.
const LEAST_BLUR_Q8: u16 = 148;
/// What an edge is taken to be blurred at least before more is known.
const USUAL_BLUR_Q8: u16 = 195;
const MOST_BLUR_Q8: u16 = 12 << 8;

/// The edges on either side of the expected one, in 1/65536 px: their flanks must not be taken for this one's plateaus.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbours {
    pub(crate) left_q16: i64,
    pub(crate) right_q16: i64,
}

impl Neighbours {
    /// None near enough to matter.
    pub(crate) const NONE: Self = Self { left_q16: -(1 << 40), right_q16: 1 << 40 };
}

/// Pixels of plateau on either side that tell its level.
const PLATEAU: i64 = 4;
/// Least contrast in 1/256 grey level.
const LEAST_CONTRAST_Q8: i32 = 4 << 8;
/// Rounding to whole grey levels alone.
const LEAST_NOISE_Q16: u32 = 65536 / 12;

impl Profile {
    /// From an edge that a row shows on its own.
    pub(crate) fn new(pixels: &[u8], edge: &Edge, around: Neighbours, noise_q8: u32) -> Option<Self> {
        let blur_q8 = edge.width_q8.clamp(USUAL_BLUR_Q8, MOST_BLUR_Q8);
        let reach_q8 = Template::new(blur_q8).reach_q8();
        let side = |side| plateau(pixels, edge.column_q16, reach_q8, side, around);
        let levels_q16 = [side(Side::Left)?.level_q16(), side(Side::Right)?.level_q16()];
        let noise_q16 = noise_q8.saturating_mul(noise_q8);
        let white_q8 = noise_q8.min(u32::from(u16::MAX)) as u16;
        let noise_q16 = noise_q16.max(LEAST_NOISE_Q16);
        let profile = Self { levels_q16, blur_q12: blur_q8 << 4, noise_q16, rows: 1, unrest_q8: [0; 2], white_q8 };
        let polarity = if profile.contrast_q8() < 0 { Polarity::Falling } else { Polarity::Rising };
        (polarity == edge.polarity && profile.contrast_q8().abs() >= LEAST_CONTRAST_Q8).then_some(profile)
    }

    fn level_q8(&self, side: Side) -> i64 {
        let [left_q16, right_q16] = self.levels_q16;
        i64::from(if side == Side::Left { left_q16 } else { right_q16 }) >> 8
    }

    fn contrast_q8(&self) -> i32 {
        (self.level_q8(Side::Right) - self.level_q8(Side::Left)) as i32
    }

    const fn blur_q8(&self) -> u16 {
        self.blur_q12 >> 4
    }

    /// An edge that a row shows on its own, located with the levels and the blur that it shows itself.
    pub(crate) fn sharpen(pixels: &[u8], edge: &Edge, around: Neighbours, noise_q8: u32) -> Option<Edge> {
        let mut profile = Self::new(pixels, edge, around, noise_q8)?;
        let found = profile.locate(pixels, i64::from(edge.column_q16), i64::from(u16::MAX), around)?;
        Some(Edge { column_q16: found.column_q16, sigma_q16: found.sigma_q16 + found.sigma_q16 / 4, ..*edge })
    }

    /// The edge near the expected column, and a better profile; `None` where the row shows something else.
    pub(crate) fn locate(
        &mut self,
        pixels: &[u8],
        expected_q16: i64,
        gate_q16: i64,
        around: Neighbours,
    ) -> Option<ScannedEdge> {
        let expected = i32::try_from(expected_q16).ok()?;
        let mut fit = self.fit(pixels, expected, around)?;
        let blur_q16 = i64::from(self.blur_q12) << 4;
        // One step is exact only near the expected column.
        if fit.shift_q16.abs() > blur_q16 / 4 {
            let nearer = expected_q16 + fit.shift_q16.clamp(-blur_q16, blur_q16);
            fit = self.fit(pixels, i32::try_from(nearer).ok()?, around)?;
            fit.shift_q16 += nearer - expected_q16;
        }
        let fits = fit.shift_q16.abs() <= gate_q16.min(4 * fit.sigma_q16 + blur_q16 / 4)
            && (128..=512).contains(&fit.amplitude_q8)
            && fit.residual_q16 <= 9 * i64::from(self.noise_q16) + (1 << 18);
        if !fits {
            return None;
        }
        // The row's own width, so that the line's mean settles like any mean.
        let width_q8 = (fit.width_q12 >> 4).clamp(1, i64::from(MOST_BLUR_Q8)) as u16;
        self.learn(&fit);
        Some(ScannedEdge {
            column_q16: i32::try_from(expected_q16 + fit.shift_q16).ok()?,
            sigma_q16: u32::try_from(fit.sigma_q16).ok()?.max(1),
            width_q8,
            contrast: i16::try_from(self.contrast_q8() >> 8).ok()?,
        })
    }

    fn fit(&self, pixels: &[u8], expected_q16: i32, around: Neighbours) -> Option<Fit> {
        let template = Template::new(self.blur_q8());
        let reach_q16 = template.reach_q8() << 8;
        let expected = i64::from(expected_q16);
        // Beside the border, or with a neighbour's blur in its own, an edge would be drawn aside.
        let clear_q16 = (2 * i64::from(self.blur_q8()) + 256) << 8;
        let border_q16 = (pixels.len() as i64 - 1) << 16;
        let alone =
            expected - clear_q16 >= around.left_q16.max(0) && expected + clear_q16 <= around.right_q16.min(border_q16);
        if !alone {
            return None;
        }
        // Half the way to a neighbour is this edge's own.
        let from = ((expected - reach_q16).max((expected + around.left_q16) / 2) + 65535) >> 16;
        let to = ((expected + reach_q16).min((expected + around.right_q16) / 2) >> 16) + 1;
        let (from, to) = (from.max(0), to.min(pixels.len() as i64));
        let window = pixels.get(usize::try_from(from).ok()?..usize::try_from(to).ok()?)?;
        let plateaus =
            [Side::Left, Side::Right].map(|side| plateau(pixels, expected_q16, template.reach_q8(), side, around));
        let [left_plateau, right_plateau] = &plateaus;
        let left = self.level(left_plateau.as_ref(), Side::Left);
        let right = self.level(right_plateau.as_ref(), Side::Right);
        let contrast = right - left;
        // The same kind of edge: half to twice as strong, of the same sign.
        let usual = i64::from(self.contrast_q8());
        if contrast * usual.signum() * 2 < usual.abs() || contrast.abs() > 2 * usual.abs() {
            return None;
        }
        let middle_q8 = (left + right) / 2;
        let mut sums = Sums::default();
        for (index, pixel) in window.iter().enumerate() {
            let place = template.at(((from + index as i64) << 8) - i64::from(expected_q16 >> 8));
            let value_q8 = i64::from(*pixel) << 8;
            let expected_q8 = left + ((contrast * place.step) >> 15);
            sums.add(value_q8 - expected_q8, &place, value_q8 - middle_q8);
        }
        let count = window.len() as i64;
        // Both flanks must be in view.
        if count < 4 || sums.slope_slope < (1 << 24) {
            return None;
        }
        let box_q16 = template.box_q8 << 8;
        let shift_q16 = (-box_q16 * sums.residual_slope).checked_div(contrast * (sums.slope_slope >> 15))?;
        let widening_q12 = (16 * template.per_widening_q8 * sums.residual_widening)
            .checked_div(contrast * (sums.widening_widening >> 15).max(1))?;
        let per_slope = sums.residual_slope.checked_div((sums.slope_slope >> 15).max(1))?;
        let explained = (per_slope * sums.residual_slope) >> 15;
        let residual_q16 = ((sums.residual_residual - explained).max(0)) / (count - 1).max(1);
        Some(Fit {
            shift_q16,
            width_q12: i64::from(self.blur_q12) + widening_q12,
            amplitude_q8: ((sums.step_value << 15).checked_div(sums.step_step)? << 8).checked_div(contrast)?,
            residual_q16,
            sigma_q16: self.sigma_q16(&sums, box_q16, contrast.abs(), &plateaus)?,
            levels_q16: plateaus.map(|plateau| plateau.map(|plateau| plateau.level_q16())),
        })
    }

    /// Of the column: of the noise on the flank and on the plateaus, whose levels shift the edge when they are wrong. Levels
    /// are remembered over rows, but what they are off then shifts all these rows alike: for a line it comes to the same as
    /// each row's own levels.
    fn sigma_q16(&self, sums: &Sums, box_q16: i64, contrast_q8: i64, plateaus: &[Option<Plateau>; 2]) -> Option<i64> {
        let noise_q8 = i64::from(self.noise_q16.isqrt());
        let of_flank =
            ((noise_q8 * box_q16) << 15).checked_div(contrast_q8 * (sums.slope_slope as u64).isqrt() as i64)?;
        // Of a level off by one grey level.
        let per_grey_q16 = ((box_q16 << 7) * sums.slope).checked_div(contrast_q8 * (sums.slope_slope >> 15).max(1))?;
        let pixels = |plateau: &Option<Plateau>| plateau.as_ref().map_or(1, |plateau| plateau.pixels.max(1));
        let share_q16: u32 = plateaus.iter().map(|plateau| 65536 / pixels(plateau)).sum();
        let of_levels = (per_grey_q16 * noise_q8 * i64::from(share_q16.isqrt())) >> 16;
        // Beside texture, no plateau tells the level at the edge.
        let restless =
            self.unrest_q8.iter().filter(|unrest| self.is_restless(**unrest)).map(|unrest| i64::from(*unrest));
        let of_texture = (restless.sum::<i64>() * per_grey_q16) >> 8;
        Some(root(of_flank * of_flank + of_levels * of_levels + of_texture * of_texture))
    }

    /// Whether the rows' own levels change by more than noise explains: 0.4 sigma for a mean over four pixels.
    fn is_restless(&self, unrest_q8: u16) -> bool {
        u32::from(unrest_q8) * 4 > u32::from(self.white_q8) * 5
    }

    /// The level to expect: the running mean, or the row's own where it is another one, as at the end of an object, where its
    /// brightness fades and the mean would shift the edge.
    fn level(&self, row: Option<&Plateau>, side: Side) -> i64 {
        let noise_q8 = i64::from(self.noise_q16.isqrt());
        let [left_unrest, right_unrest] = self.unrest_q8;
        let unrest_q8 = if side == Side::Left { left_unrest } else { right_unrest };
        let mean_q8 = self.level_q8(side);
        match row.map(|plateau| i64::from(plateau.level_q16() >> 8)) {
            // Three sigma of a mean over four pixels.
            Some(row) if self.is_restless(unrest_q8) || (row - mean_q8).abs() > noise_q8 * 3 / 2 => row,
            _ => mean_q8,
        }
    }

    /// Running means: a small part of each new row, more at first.
    fn learn(&mut self, fit: &Fit) {
        self.rows = self.rows.saturating_add(1);
        let rows = i64::from(self.rows);
        for ((mean_q16, unrest_q8), row_q16) in self.levels_q16.iter_mut().zip(&mut self.unrest_q8).zip(fit.levels_q16)
        {
            if let Some(row_q16) = row_q16 {
                *unrest_q8 = toward(*unrest_q8, i64::from(row_q16.abs_diff(*mean_q16) >> 8), rows.min(16));
                *mean_q16 = toward(*mean_q16, i64::from(row_q16), rows.min(32));
            }
        }
        let blur_q12 = i64::from(self.blur_q12);
        let wider_q12 = fit.width_q12.clamp(blur_q12 / 2, 2 * blur_q12);
        self.blur_q12 = toward(self.blur_q12, wider_q12, rows.min(16)).clamp(LEAST_BLUR_Q8 << 4, MOST_BLUR_Q8 << 4);
        let noise = i64::from(self.noise_q16);
        let residual = fit.residual_q16.min(4 * noise + (1 << 16));
        self.noise_q16 = (noise + (residual - noise) / 16).clamp(i64::from(LEAST_NOISE_Q16), 1 << 31) as u32;
    }
}

/// One part of `parts` of the way to `to`.
fn toward<T: Copy + Into<i64> + TryFrom<i64>>(from: T, to: i64, parts: i64) -> T {
    let value: i64 = from.into();
    T::try_from(value + (to - value) / parts.max(1)).unwrap_or(from)
}

fn root(square: i64) -> i64 {
    (square.max(0) as u64).isqrt() as i64
}

/// Inner products of residual, slope of the profile, its change with the width, and the step itself; and the slopes' sum.
#[derive(Default)]
struct Sums {
    residual_residual: i64,
    residual_slope: i64,
    residual_widening: i64,
    slope: i64,
    slope_slope: i64,
    widening_widening: i64,
    step_step: i64,
    step_value: i64,
}

impl Sums {
    fn add(&mut self, residual: i64, place: &Place, value: i64) {
        let step = place.step - (1 << 14);
        self.residual_residual += residual * residual;
        self.residual_slope += residual * place.slope;
        self.residual_widening += residual * place.widening;
        self.slope += place.slope;
        self.slope_slope += place.slope * place.slope;
        self.widening_widening += place.widening * place.widening;
        self.step_step += step * step;
        self.step_value += step * value;
    }
}

/// Pixels beyond the blur on one side.
struct Plateau {
    sum: u32,
    pixels: u32,
}

impl Plateau {
    /// Their mean brightness, in 1/65536 grey level.
    fn level_q16(&self) -> u32 {
        (self.sum << 16).checked_div(self.pixels).unwrap_or(0)
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
}

/// The pixels beyond the blur on one side: up to where a neighbour's blur begins, or the pixel half way to it where the two
/// blurs meet.
fn plateau(pixels: &[u8], column_q16: i32, reach_q8: i64, side: Side, around: Neighbours) -> Option<Plateau> {
    let column = i64::from(column_q16);
    let clear_q16 = reach_q8 << 8;
    // The longer the blur, the more a wrong level shifts the edge.
    let length_q16 = (PLATEAU << 16) + clear_q16;
    let (near, far, half_way) = match side {
        Side::Left => {
            let near = column - clear_q16;
            (near, (near - length_q16).max(around.left_q16 + clear_q16), (column + around.left_q16) / 2)
        }
        Side::Right => {
            let near = column + clear_q16;
            (near, (near + length_q16).min(around.right_q16 - clear_q16), (column + around.right_q16) / 2)
        }
    };
    let room = if side == Side::Left { near >= far } else { near <= far };
    let (from, to) = if room { (near.min(far), near.max(far)) } else { (half_way, half_way) };
    let from = ((from + (1 << 15)) >> 16).max(0);
    let to = ((to + (1 << 15)) >> 16).min(pixels.len() as i64 - 1);
    let window = pixels.get(usize::try_from(from).ok()?..=usize::try_from(to).ok()?)?;
    // Fewer than 256 pixels: the sum fits 16 bits.
    let sum = window.iter().map(|pixel| u32::from(*pixel)).sum();
    Some(Plateau { sum, pixels: window.len() as u32 }).filter(|plateau| plateau.pixels > 0)
}
