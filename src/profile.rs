//! [`Profile`]: what a tracked edge looks like, and where the next row has it.
//!
//! A row on its own locates an edge with the noise of all pixels around it. Where a line predicts the column, and its rows
//! so far tell both levels and the blur, the maximum-likelihood estimate is one step from the prediction: the row minus
//! the expected profile, weighted by the profile's slope. Its noise is the Cramér–Rao bound.

use crate::{Edge, Polarity, ScannedEdge};

/// Levels, blur and noise of a tracked edge, running means over its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Profile {
    left_q8: u16,
    right_q8: u16,
    /// One sigma of the edge's blur.
    blur_q8: u16,
    rows: u16,
    /// Variance of a pixel's noise, in 1/65536 square grey level.
    noise_q16: u32,
    /// Mean difference between a row's own level and the running mean, left and right.
    unrest_q8: [u16; 2],
    /// One sigma of the pixels' noise when the line was confirmed.
    white_q8: u16,
    /// Rows with texture on either side.
    restless_rows: u16,
}

/// What one row says, given the profile.
struct Fit {
    /// Column minus the expected one.
    shift_q16: i64,
    /// Blur minus the expected one.
    widening_q8: i64,
    /// Contrast as a part of the expected one, in 1/256.
    amplitude_q8: i64,
    /// Residual variance of a pixel.
    residual_q16: i64,
    sigma_q16: i64,
    left_q8: Option<u16>,
    right_q8: Option<u16>,
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

    /// The nearest to an edge among those of its row that end its plateaus: one of its own polarity may be a piece of it, as
    /// noise breaks a long blur.
    pub(crate) fn among<'e>(edges: impl Iterator<Item = &'e Edge>, edge: &Edge) -> Self {
        let mut around = Self::NONE;
        for column_q16 in edges.filter(|other| other.polarity != edge.polarity).map(|other| other.column_q16) {
            if column_q16 < edge.column_q16 {
                around.left_q16 = around.left_q16.max(i64::from(column_q16));
            } else if column_q16 > edge.column_q16 {
                around.right_q16 = around.right_q16.min(i64::from(column_q16));
            }
        }
        around
    }
}

/// Pixels of plateau on either side that tell its level.
const PLATEAU: i32 = 4;
/// Least contrast in 1/256 grey level.
const LEAST_CONTRAST_Q8: i32 = 4 << 8;
/// Root of the number of rows in which texture errs alike.
const LIKE_ROWS: u32 = 3;
/// Rounding to whole grey levels alone.
const LEAST_NOISE_Q16: u32 = 65536 / 12;

impl Profile {
    /// From an edge that a row shows on its own.
    pub(crate) fn new(pixels: &[u8], edge: &Edge, around: Neighbours, noise_q8: u32) -> Option<Self> {
        let blur_q8 = edge.width_q8.clamp(USUAL_BLUR_Q8, MOST_BLUR_Q8);
        let left_q8 = plateau(pixels, edge.column_q16, blur_q8, Side::Left, around)?;
        let right_q8 = plateau(pixels, edge.column_q16, blur_q8, Side::Right, around)?;
        let noise_q16 = noise_q8.saturating_mul(noise_q8);
        let white_q8 = noise_q8.min(u32::from(u16::MAX)) as u16;
        let noise_q16 = noise_q16.max(LEAST_NOISE_Q16);
        let unrest_q8 = [
            unrest(pixels, edge.column_q16, blur_q8, Side::Left, around)?,
            unrest(pixels, edge.column_q16, blur_q8, Side::Right, around)?,
        ];
        // One row alone is soon outweighed.
        let unrest_q8 = unrest_q8.map(|unrest| unrest.min(white_q8.saturating_mul(2)));
        let profile = Self { left_q8, right_q8, blur_q8, noise_q16, rows: 1, unrest_q8, white_q8, restless_rows: 0 };
        let polarity = if profile.contrast_q8() < 0 { Polarity::Falling } else { Polarity::Rising };
        (polarity == edge.polarity && profile.contrast_q8().abs() >= LEAST_CONTRAST_Q8).then_some(profile)
    }

    fn contrast_q8(&self) -> i32 {
        i32::from(self.right_q8) - i32::from(self.left_q8)
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
        let blur_q16 = i64::from(self.blur_q8) << 8;
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
        self.learn(&fit);
        Some(ScannedEdge {
            column_q16: i32::try_from(expected_q16 + fit.shift_q16).ok()?,
            sigma_q16: u32::try_from(fit.sigma_q16 * i64::from(self.like_rows())).ok()?.max(1),
            width_q8: self.blur_q8,
            contrast: i16::try_from(self.contrast_q8() >> 8).ok()?,
        })
    }

    fn fit(&self, pixels: &[u8], expected_q16: i32, around: Neighbours) -> Option<Fit> {
        let reach_q16 = (3 * i64::from(self.blur_q8) + 256) << 8;
        let expected = i64::from(expected_q16);
        // Beside the border, or with a neighbour's blur in its own, an edge would be drawn aside.
        let clear_q16 = (2 * i64::from(self.blur_q8) + 256) << 8;
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
        let left_q8 = plateau(pixels, expected_q16, self.blur_q8, Side::Left, around);
        let right_q8 = plateau(pixels, expected_q16, self.blur_q8, Side::Right, around);
        let [left_unrest, right_unrest] = self.unrest_q8;
        let (left, left_free) = self.level(left_q8, self.left_q8, left_unrest);
        let (right, right_free) = self.level(right_q8, self.right_q8, right_unrest);
        let middle_q8 = (left + right) / 2;
        let per_blur_q16 = (1_i64 << 24) / i64::from(self.blur_q8.max(1));
        let mut sums = Sums::default();
        for (index, pixel) in window.iter().enumerate() {
            let off_q8 = ((from + index as i64) << 8) - i64::from(expected_q16 >> 8);
            let z_q8 = (off_q8 * per_blur_q16) >> 16;
            let (density, cumulative) = normal(z_q8);
            let value_q8 = i64::from(*pixel) << 8;
            let expected_q8 = left + (((right - left) * cumulative) >> 15);
            sums.add(
                value_q8 - expected_q8,
                density,
                (density * z_q8) >> 8,
                cumulative - (1 << 14),
                value_q8 - middle_q8,
            );
        }
        let [change_left, change_right] = sums.free_levels([left_free, right_free]);
        let contrast = right + change_right - left - change_left;
        // The same kind of edge: half to twice as strong, of the same sign.
        let usual = i64::from(self.contrast_q8());
        if contrast * usual.signum() * 2 < usual.abs() || contrast.abs() > 2 * usual.abs() {
            return None;
        }
        let count = window.len() as i64;
        // Both flanks must be in view.
        if count < 4 || sums.slope_slope < (1 << 24) {
            return None;
        }
        let blur_q16 = i64::from(self.blur_q8) << 8;
        let per = |sum: i64, square: i64| -> Option<i64> { (-blur_q16 * sum).checked_div(contrast * (square >> 15)) };
        let shift_q16 = per(sums.residual_slope, sums.slope_slope)?;
        let widening_q8 = per(sums.residual_width, sums.width_width.max(1 << 15))? >> 8;
        let per_slope = sums.residual_slope.checked_div((sums.slope_slope >> 15).max(1))?;
        let explained = (per_slope * sums.residual_slope) >> 15;
        let residual_q16 = ((sums.residual_residual - explained).max(0))
            / (count - 2 - i64::from(left_free) - i64::from(right_free)).max(1);
        let noise_q8 = i64::from(self.noise_q16.isqrt());
        let of_noise_q16 =
            ((noise_q8 * blur_q16) << 15).checked_div(contrast.abs() * (sums.slope_slope as u64).isqrt() as i64)?;
        // A level that is wrong by u shifts the edge by u σ/(0.56 A), and beside texture for some rows in the same direction.
        let restless =
            self.unrest_q8.iter().filter(|unrest| self.is_restless(**unrest)).map(|unrest| i64::from(*unrest));
        let of_texture_q16 = (restless.sum::<i64>() * blur_q16 / 2).checked_div(contrast.abs())?;
        let sigma_q16 = ((of_noise_q16 * of_noise_q16 + of_texture_q16 * of_texture_q16) as u64).isqrt() as i64;
        Some(Fit {
            shift_q16,
            widening_q8,
            amplitude_q8: ((sums.step_value << 15).checked_div(sums.step_step)? << 8).checked_div(contrast)?,
            residual_q16,
            sigma_q16,
            left_q8,
            right_q8,
        })
    }

    /// How many times larger than a row's own noise its sigma is stated, for what it has in common with the rows around it.
    pub(crate) const fn like_rows(&self) -> u32 {
        let restless = self.restless_rows >= 4 && self.restless_rows > self.rows / 4;
        if restless { LIKE_ROWS } else { 1 }
    }

    /// Whether the rows' own levels change by more than noise explains: 0.4 sigma for a mean over four pixels.
    fn is_restless(&self, unrest_q8: u16) -> bool {
        u32::from(unrest_q8) * 4 > u32::from(self.white_q8) * 5
    }

    /// The level to expect: the running mean, or the row's own where it is another one, as at the end of an object, where its
    /// brightness fades and the mean would shift the edge. The latter is only a start: the pixels of the edge know better.
    fn level(&self, row_q8: Option<u16>, mean_q8: u16, unrest_q8: u16) -> (i64, bool) {
        let noise_q8 = self.noise_q16.isqrt();
        match row_q8 {
            // Three sigma of a mean over four pixels.
            Some(row) if self.is_restless(unrest_q8) || u32::from(row.abs_diff(mean_q8)) > noise_q8 * 3 / 2 => {
                (i64::from(row), true)
            }
            _ => (i64::from(mean_q8), false),
        }
    }

    /// Running means: a small part of each new row, more at first.
    fn learn(&mut self, fit: &Fit) {
        self.rows = self.rows.saturating_add(1);
        let rows = i64::from(self.rows);
        let [left_unrest, right_unrest] = &mut self.unrest_q8;
        if let Some(level) = fit.left_q8 {
            *left_unrest = toward(*left_unrest, i64::from(level.abs_diff(self.left_q8)), rows.min(16));
            self.left_q8 = toward(self.left_q8, i64::from(level), rows.min(32));
        }
        if let Some(level) = fit.right_q8 {
            *right_unrest = toward(*right_unrest, i64::from(level.abs_diff(self.right_q8)), rows.min(16));
            self.right_q8 = toward(self.right_q8, i64::from(level), rows.min(32));
        }
        let restless = self.unrest_q8.iter().any(|unrest| self.is_restless(*unrest));
        self.restless_rows = self.restless_rows.saturating_add(u16::from(restless));
        let blur = i64::from(self.blur_q8);
        let wider = blur + fit.widening_q8.clamp(-blur / 2, blur);
        self.blur_q8 = toward(self.blur_q8, wider, rows.min(16)).clamp(LEAST_BLUR_Q8, MOST_BLUR_Q8);
        let noise = i64::from(self.noise_q16);
        let residual = fit.residual_q16.min(4 * noise + (1 << 16));
        self.noise_q16 = (noise + (residual - noise) / 16).clamp(i64::from(LEAST_NOISE_Q16), 1 << 31) as u32;
    }
}

/// One part of `parts` of the way to `to`.
fn toward(from: u16, to: i64, parts: i64) -> u16 {
    let step = (to - i64::from(from)) / parts.max(1);
    (i64::from(from) + step).clamp(0, i64::from(u16::MAX)) as u16
}

/// Inner products of residual r, slope of the profile φ, its change with the blur φz, and the step itself.
#[derive(Default)]
struct Sums {
    residual_residual: i64,
    residual_slope: i64,
    residual_width: i64,
    slope_slope: i64,
    width_width: i64,
    step_step: i64,
    step_value: i64,
    /// Of the left level's share of each pixel, and of the right one's.
    levels: [Level; 2],
    left_right: i64,
}

/// Inner products with a level's share of each pixel.
#[derive(Clone, Copy, Default)]
struct Level {
    own: i64,
    residual: i64,
    slope: i64,
    width: i64,
}

impl Sums {
    fn add(&mut self, residual: i64, slope: i64, width: i64, step: i64, value: i64) {
        let shares = [(1 << 14) - step, (1 << 14) + step];
        for (level, share) in self.levels.iter_mut().zip(shares) {
            level.own += share * share;
            level.residual += share * residual;
            level.slope += share * slope;
            level.width += share * width;
        }
        let [left, right] = shares;
        self.left_right += left * right;
        self.residual_residual += residual * residual;
        self.residual_slope += residual * slope;
        self.residual_width += residual * width;
        self.slope_slope += slope * slope;
        self.width_width += width * width;
        self.step_step += step * step;
        self.step_value += step * value;
    }

    /// Leaves it to the edge's own pixels to tell the levels that are free: takes out of the sums what these levels explain,
    /// by orthogonalisation, and returns what they are above the expected ones.
    fn free_levels(&mut self, free: [bool; 2]) -> [i64; 2] {
        let [mut left, mut right] = self.levels;
        // Too few pixels tell nothing.
        let [left_free, right_free] = [free[0] && left.own >= 1 << 29, free[1] && right.own >= 1 << 29];
        let part = |of: i64, own: i64| (of << 15) / own.max(1);
        if left_free && right_free {
            let common = part(self.left_right, left.own);
            right.own = (right.own - ((common * self.left_right) >> 15)).max(1 << 26);
            right.residual -= (common * left.residual) >> 15;
            right.slope -= (common * left.slope) >> 15;
        }
        for (level, _) in [(left, left_free), (right, right_free)].into_iter().filter(|(_, free)| *free) {
            let share = part(level.slope, level.own);
            self.slope_slope -= (share * level.slope) >> 15;
            self.residual_slope -= (share * level.residual) >> 15;
            self.residual_residual -= (part(level.residual, level.own) * level.residual) >> 15;
        }
        let shift = part(self.residual_slope, self.slope_slope);
        let change = |level: &Level| part(level.residual - ((shift * level.slope) >> 15), level.own);
        let right_change = if right_free { change(&right) } else { 0 };
        left.residual -= (right_change * self.left_right) >> 15;
        let left_change = if left_free { change(&left) } else { 0 };
        for (level, change) in self.levels.iter().zip([left_change, right_change]) {
            self.residual_width -= (change * level.width) >> 15;
        }
        [left_change, right_change]
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
}

/// Mean brightness of a [`plateau`] in 1/256 grey level.
fn plateau(pixels: &[u8], column_q16: i32, blur_q8: u16, side: Side, around: Neighbours) -> Option<u16> {
    let window = plateau_pixels(pixels, column_q16, blur_q8, side, around)?;
    let sum: u32 = window.iter().map(|pixel| u32::from(*pixel)).sum();
    u16::try_from((sum << 8).checked_div(window.len() as u32)?).ok()
}

/// Mean difference of a plateau's pixels from their mean, in 1/256 grey level: 0.7 sigma of noise, more of texture.
fn unrest(pixels: &[u8], column_q16: i32, blur_q8: u16, side: Side, around: Neighbours) -> Option<u16> {
    let window = plateau_pixels(pixels, column_q16, blur_q8, side, around)?;
    let mean_q8 = plateau(pixels, column_q16, blur_q8, side, around)?;
    let sum: u32 = window.iter().map(|pixel| (u32::from(*pixel) << 8).abs_diff(u32::from(mean_q8))).sum();
    u16::try_from(sum.checked_div(window.len() as u32)?).ok()
}

/// The pixels beyond the blur on one side: up to where a neighbour's blur begins, or the pixel
/// half way to it where the two blurs meet.
fn plateau_pixels(pixels: &[u8], column_q16: i32, blur_q8: u16, side: Side, around: Neighbours) -> Option<&[u8]> {
    let column = i64::from(column_q16);
    // 2.5 sigma of a lens, but a path of motion ends after 1.73.
    let blur = i64::from(blur_q8);
    let clear_q16 = ((5 * blur / 2).min(7 * blur / 4 + 448) + 128) << 8;
    // The longer the blur, the more a wrong level shifts the edge.
    let length_q16 = (i64::from(PLATEAU) << 16) + (i64::from(blur_q8) << 9);
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
    pixels.get(usize::try_from(from).ok()?..=usize::try_from(to).ok()?)
}

/// Density and cumulative normal distribution at z (1/256), in 1/32768.
fn normal(z_q8: i64) -> (i64, i64) {
    let size = z_q8.unsigned_abs();
    let (index, part) = ((size >> 4) as usize, (size & 15) as i64);
    let between = |table: &[u16; 66], beyond: i64| match (table.get(index), table.get(index + 1)) {
        (Some(a), Some(b)) => (i64::from(*a) * (16 - part) + i64::from(*b) * part) >> 4,
        _ => beyond,
    };
    let cumulative = between(&CUMULATIVE_Q15, 1 << 15);
    (between(&DENSITY_Q15, 0), if z_q8 < 0 { (1 << 15) - cumulative } else { cumulative })
}

/// Density of the normal distribution at k/16, in 1/32768.
const DENSITY_Q15: [u16; 66] = [
    13_073, 13_047, 12_971, 12_845, 12_670, 12_450, 12_185, 11_879, 11_536, 11_160, 10_753, 10_321, 9868, 9397, 8915,
    8424, 7929, 7434, 6943, 6459, 5985, 5524, 5079, 4652, 4244, 3857, 3491, 3148, 2827, 2529, 2254, 2001, 1769, 1558,
    1367, 1195, 1040, 902, 779, 670, 574, 490, 417, 353, 298, 250, 210, 175, 145, 120, 99, 81, 66, 54, 44, 36, 29, 23,
    18, 15, 12, 9, 7, 6, 4, 3,
];

/// Cumulative normal distribution at k/16, in 1/32768.
const CUMULATIVE_Q15: [u16; 66] = [
    16_384, 17_201, 18_014, 18_821, 19_618, 20_404, 21_174, 21_926, 22_658, 23_367, 24_052, 24_711, 25_342, 25_944,
    26_516, 27_058, 27_569, 28_049, 28_499, 28_917, 29_306, 29_666, 29_997, 30_301, 30_579, 30_832, 31_061, 31_269,
    31_455, 31_623, 31_772, 31_905, 32_023, 32_126, 32_218, 32_298, 32_367, 32_428, 32_480, 32_526, 32_565, 32_598,
    32_626, 32_650, 32_670, 32_687, 32_702, 32_714, 32_724, 32_732, 32_739, 32_744, 32_749, 32_753, 32_756, 32_758,
    32_760, 32_762, 32_763, 32_764, 32_765, 32_766, 32_766, 32_767, 32_767, 32_767,
];
