//! [`Prominence`]: how an edge stands out of what is around its line. docs/model.md, section 7.8.

use super::halo::Halo;
use super::tuning::{
    AROUND_PX, CHANCE_SCATTER_Q32, CHANCE_SIGMAS_Q1, GAUSSIAN_VARIANCE_Q16, HALO_SIGMAS_Q1, LEAST_CHANGES,
    LEAST_SHARE_Q12, LEAST_VARIANCE_Q16, LIKE_PARTS, LOOK_PLACES, LOOK_ROWS, ROWS_ALIKE_IN_TEXTURE, SHARE_SIGMAS_Q8,
    TAIL_ROWS,
};
use crate::edge::{EdgePoint, PixelRow, Polarity, root};
use crate::format::Pixels;

/// Contrast along a line, and how much it changes from row to row along parallel lines around.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Prominence {
    /// Sum of the rows' steps at the line, positive along its polarity, in grey levels times four pixels.
    along: i32,
    /// The same of the two pixels that are nearest, on either side: in grey levels times two pixels.
    near: i32,
    rows: u16,
    /// Upper quartile of the sizes of the steps beside the line in its first row: other upright edges are few among
    /// them.
    first_step: u16,
    /// How many steps beside it have changed, and the sum of the sizes of these changes.
    changes: u16,
    changes_sum: u32,
    halo: Halo,
}

impl Prominence {
    /// Whether parallel lines in the texture around would show as much contrast, divided by `times`, once in many
    /// frames, and lead as straight, for a line with `points` in `rows`; beside texture with the variance of their
    /// scatter in 1/2³² px².
    pub(super) fn is_by_chance(&self, times: u64, points: u16, rows: u16, scatter_q32: Option<u64>) -> bool {
        let (points, rows) = (u64::from(points), u64::from(rows));
        let mean_q8 = (u64::from(self.along.max(0) as u32) << 8).checked_div(self.rows.into()).unwrap_or(0);
        let sigma_q8 = self.sigma_q8();
        // Rows without a point have no contrast.
        let seen_q8 = (points << 8).checked_div(rows).unwrap_or(0);
        let rows = (points * seen_q8 * seen_q8 * seen_q8) >> 24;
        // The mean of n rows has √(8/n) of the deviation of one, and longer tails the fewer they are.
        let left_q8 = (mean_q8 * rows).checked_div(rows + TAIL_ROWS).unwrap_or(0);
        let alike = u64::from(ROWS_ALIKE_IN_TEXTURE);
        let most_square = CHANCE_SIGMAS_Q1 * CHANCE_SIGMAS_Q1 * alike * sigma_q8 * sigma_q8;
        // Of so many rows as are not alike, two say where a line leads; each other one is that near to it by chance as
        // the scatter is to that of texture. As a square of sigmas, twice its logarithm.
        let straight_rows = rows.saturating_sub(2 * alike) as i64;
        let twice_ln_q8 = |scatter_q32| ((log2_q8(CHANCE_SCATTER_Q32) - log2_q8(scatter_q32)) * LN_2_Q8) >> 8;
        let straight = (((sigma_q8 * sigma_q8) as i64 * straight_rows) >> 8) * scatter_q32.map_or(0, twice_ln_q8);
        4 * ((left_q8 * left_q8 * rows) as i64 + straight) < (times * times * most_square) as i64
    }

    /// Deviation of the steps beside the line, in 1/256 of a grey level times four pixels.
    fn sigma_q8(&self) -> u64 {
        // Of normal values the quartile of their sizes is 1.08 sigma and the mean 0.8; a change has √2 times the sigma
        // of a step.
        let sigma_q8 = if self.changes < LEAST_CHANGES {
            u64::from(self.first_step) * 237
        } else {
            (u64::from(self.changes_sum) * 226).checked_div(self.changes.into()).unwrap_or(0)
        };
        // Rounding alone makes one.
        sigma_q8.max(1 << 8)
    }

    /// The most that the variance of the edge's blur can be, in 1/65536 square pixel, given the share of its step that lies
    /// within two pixels of it: texture on either side adds to both steps alike. `None` where that may be little more than
    /// a half, as along any long slope.
    pub(super) fn most_variance_q16(&self) -> Option<u32> {
        let rows = u32::from(self.rows);
        // They fit: of 65535 rows each has at most 1020 levels.
        let mean_q4 = |sum: i32| (u32::try_from(sum).ok()? << 4).checked_div(rows);
        let step_q4 = mean_q4(self.along)?;
        let share_q12 = (mean_q4(self.near)? << 13).checked_div(step_q4)?;
        // A look has this deviation, and every second one errs alike, as a share of the mean step.
        let sigma_q12 = ((self.sigma_q8() as u32) * SHARE_SIGMAS_Q8).checked_div(step_q4 * root(rows))?;
        let least_q12 = share_q12.saturating_sub(sigma_q12).min(1 << 12);
        if least_q12 < LEAST_SHARE_Q12 {
            return None;
        }
        let of_gaussian_q16 = ((1 << 12) - least_q12) * GAUSSIAN_VARIANCE_Q16;
        Some(of_gaussian_q16.checked_div(least_q12 - (1 << 11))?.max(LEAST_VARIANCE_Q16))
    }

    /// How far the levels overshoot beside the edge in the mean, as a share of its contrast times a pixel, in 1/65536;
    /// zero where noise or texture overshoot as far.
    pub(super) fn overshoot_q16(&self) -> u32 {
        let contrast_q2 = u32::try_from(self.along).ok().and_then(|along| along.checked_div(self.rows.into()));
        // Two pixels on either side have a third of the deviation of eight in their mean.
        let sigma_q18 = (self.sigma_q8() << 9).checked_div(u64::from(self.halo.rows()).isqrt() * 3 / 2).unwrap_or(0);
        let mean_q18 = self.halo.mean_q18();
        let is_chance = 2 * u64::from(mean_q18) < HALO_SIGMAS_Q1 * sigma_q18;
        if is_chance { 0 } else { mean_q18.checked_div(contrast_q2.unwrap_or(0)).unwrap_or(0) }
    }

    /// Takes what a row shows beside the flank.
    #[inline(always)]
    pub(super) fn add_overshoot(&mut self, overshoot: i16) {
        self.halo.add_row(overshoot);
    }

    /// Mean contrast in grey levels; zero where none was looked at.
    pub(super) fn contrast(&self) -> u8 {
        let sum = u32::from(self.rows) << 2;
        let mean = (self.along.max(0) as u32).saturating_add(sum >> 1).checked_div(sum).unwrap_or(0);
        mean.min(u8::MAX.into()) as u8
    }

    /// Whether two lines have the same contrast, within a third.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let mean_q8 = |one: &Self| (i64::from(one.along) << 8).checked_div(one.rows.into()).unwrap_or(0);
        let (mine, theirs) = (mean_q8(self), mean_q8(other));
        LIKE_PARTS * mine.min(theirs) >= (LIKE_PARTS - 1) * mine.max(theirs)
    }

    pub(super) const fn is_unseen(&self) -> bool {
        self.rows == 0
    }

    /// Adds what another part of the same line shows.
    #[inline(never)] // seldom
    pub(super) fn add(&mut self, other: &Self) {
        self.along = self.along.saturating_add(other.along);
        self.near = self.near.saturating_add(other.near);
        self.rows = self.rows.saturating_add(other.rows);
        self.changes = self.changes.saturating_add(other.changes);
        self.changes_sum = self.changes_sum.saturating_add(other.changes_sum);
        self.halo.add(&other.halo);
    }
}

const LN_2_Q8: i64 = 177;

/// Binary logarithm in 1/256, by chords between powers of two: at most 0.09 too little.
const fn log2_q8(value: u64) -> i64 {
    let value = if value > 0 { value } else { 1 };
    let whole = value.ilog2();
    // The highest nine bits.
    let part = if whole > 8 { value >> (whole - 8) } else { value << (8 - whole) };
    ((whole << 8) + (part as u32 & 0xff)) as i64
}

/// Steps beside a line when they were last looked at. An upright edge beside it shows the same again, texture does not.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Around {
    steps: [i16; LOOK_PLACES],
}

/// No step: not looked at yet.
const UNSEEN: i16 = i16::MIN;

impl Around {
    pub(super) const UNSEEN: Self = Self { steps: [UNSEEN; LOOK_PLACES] };

    /// Looks at the row of a point, at its line and beside it: at all places in the first row, then at one; in every
    /// fourth row.
    pub(super) fn look<P: Pixels>(&mut self, prominence: &mut Prominence, row: PixelRow<'_, P>, point: &EdgePoint) {
        if prominence.rows > 0 && !point.row.is_multiple_of(LOOK_ROWS) {
            return;
        }
        let boundary = point.boundary();
        let Some([step, near]) = row.steps_at(boundary) else { return };
        let reach = i32::from(point.width_q8) >> 7;
        let beside = |off: i32| row.step_at(boundary + off + off.signum() * reach);
        if prominence.rows == 0 {
            prominence.first_step = upper_quartile(AROUND_PX.into_iter().flat_map(|off| [beside(off), beside(-off)]));
        } else {
            let index = usize::from(point.row / LOOK_ROWS) % LOOK_PLACES;
            let (Some(off), Some(before)) = (AROUND_PX.get(index), self.steps.get_mut(index)) else { return };
            let Some(step) = beside(*off) else { return };
            if *before != UNSEEN {
                prominence.changes = prominence.changes.saturating_add(1);
                prominence.changes_sum = prominence.changes_sum.saturating_add(step.abs_diff(*before).into());
            }
            *before = step;
        }
        let is_falling = point.polarity == Polarity::Falling;
        let rising = |step: i16| i32::from(if is_falling { -step } else { step });
        prominence.along = prominence.along.saturating_add(rising(step));
        prominence.near = prominence.near.saturating_add(rising(near));
        prominence.rows = prominence.rows.saturating_add(1);
    }
}

/// Of the sizes of the steps beside a line, as many as there are.
#[inline(never)]
fn upper_quartile(steps: impl Iterator<Item = Option<i16>>) -> u16 {
    // From the largest on, as many as it is among.
    let (mut largest, mut count) = ([0; AROUND_PX.len() / 2 + 1], 0_usize);
    for mut size in steps.flatten().map(i16::unsigned_abs) {
        for other in &mut largest {
            if size > *other {
                core::mem::swap(other, &mut size);
            }
        }
        count += 1;
    }
    largest.get(count.saturating_sub((count * 3 / 4).max(1))).copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::{Around, Prominence};
    use crate::edge::{EdgePoint, PixelRow, Polarity};
    use crate::setup::Response;

    const COLUMNS: usize = 128;
    const COLUMN: usize = 64;

    /// What is told after some rows of an edge at the middle column, in the pixels of `row`.
    fn after(rows: u16, row: impl Fn(u16) -> [u8; COLUMNS]) -> Prominence {
        let (mut around, mut prominence) = (Around::UNSEEN, Prominence::default());
        for index in 0..rows {
            let pixels = row(index);
            let pixels = PixelRow { pixels: &pixels, response: &Response::Linear };
            let column_q16 = ((COLUMN as i32) << 16) - (1 << 15);
            let point = EdgePoint::new(index, column_q16, i64::from(index)).with_polarity(Polarity::Rising);
            around.look(&mut prominence, pixels, &point);
        }
        prominence
    }

    /// Squares of `size` pixels, each of a level of its own.
    fn texture(index: u16, size: usize, contrast: u32) -> [u8; COLUMNS] {
        core::array::from_fn(|column| {
            // The finaliser of MurmurHash3.
            let mut mixed = (column / size) as u32 + (u32::from(index) / size as u32) * 1000;
            mixed = (mixed ^ (mixed >> 16)).wrapping_mul(0x85eb_ca6b);
            mixed = (mixed ^ (mixed >> 13)).wrapping_mul(0xc2b2_ae35);
            mixed ^= mixed >> 16;
            (100 + mixed % contrast) as u8
        })
    }

    fn with_step(mut pixels: [u8; COLUMNS], contrast: u8) -> [u8; COLUMNS] {
        pixels.iter_mut().skip(COLUMN).for_each(|pixel| *pixel = pixel.saturating_add(contrast));
        pixels
    }

    #[test]
    fn an_edge_before_nothing_is_not_by_chance() {
        for rows in [8, 40, 400] {
            let prominence = after(rows, |_| with_step([100; COLUMNS], 12));
            assert!(!prominence.is_by_chance(1, rows, rows, None), "{rows} rows");
        }
    }

    #[test]
    fn texture_decides_by_contrast_and_length() {
        for (rows, contrast, is_by_chance) in [(12, 40, true), (60, 12, true), (60, 120, false), (200, 80, false)] {
            let prominence = after(rows, |row| with_step(texture(row, 4, 50), contrast));
            assert_eq!(prominence.is_by_chance(1, rows, rows, None), is_by_chance, "{rows} rows, contrast {contrast}");
        }
    }

    /// Of one contrast, what scatters as texture does is by chance, and what is straighter is none.
    #[test]
    fn a_straight_line_is_none_by_chance() {
        let px_q32 = |px: f64| Some((px * px * f64::from(1 << 16).powi(2)) as u64);
        let is_by_chance = |contrast, rows, scatter| {
            let prominence = after(rows, |row| with_step(texture(row, 4, 50), contrast));
            prominence.is_by_chance(1, rows, rows, scatter)
        };
        for (contrast, rows, straight_px, scattered_px) in
            [(40, 60, 0.2, 0.3), (32, 100, 0.2, 0.3), (48, 100, 0.5, 0.7)]
        {
            assert!(!is_by_chance(contrast, rows, px_q32(straight_px)), "{rows} rows");
            assert!(is_by_chance(contrast, rows, px_q32(scattered_px)), "{rows} rows");
        }
        // What scatters more than texture needs more contrast.
        assert!(!is_by_chance(56, 100, px_q32(0.5)) && is_by_chance(56, 100, px_q32(1.0)));
        assert!(is_by_chance(30, 16, px_q32(0.001)), "two places lie on every line");
    }

    /// What the step at the middle column tells of its blur, over many rows: each moves it by a part of a pixel.
    fn most_blur_px(blur_px: f64, row: impl Fn(u16) -> [u8; COLUMNS]) -> Option<f64> {
        let prominence = after(240, |index| {
            let middle = COLUMN as f64 + f64::from(index * 7 % 16) / 16.0 - 0.5;
            let below = row(index);
            core::array::from_fn(|column| {
                let off_px = column as f64 + 0.5 - middle;
                let step = 0.5 * (1.0 + libm::erf(off_px / blur_px / core::f64::consts::SQRT_2));
                below.get(column).copied().unwrap_or(0) + (80.0 * step) as u8
            })
        });
        prominence.most_variance_q16().map(|variance_q16| (f64::from(variance_q16) / 65536.0).sqrt())
    }

    /// An edge is told to be no wider than it is and some: never less, and beside texture not much more. Nothing is told
    /// of a long slope.
    #[test]
    fn the_blur_is_no_longer_than_that() {
        for blur_px in [0.5, 0.8, 1.0, 1.3, 1.6] {
            let plain = most_blur_px(blur_px, |_| [60; COLUMNS]).unwrap_or(f64::NAN);
            let beside_texture = most_blur_px(blur_px, |row| texture(row, 12, 60)).unwrap_or(f64::NAN);
            assert!((1.0..1.2).contains(&(plain / blur_px.max(1.0))), "{blur_px}: {plain}");
            assert!((1.0..1.7).contains(&(beside_texture / blur_px.max(1.0))), "{blur_px}: {beside_texture}");
        }
        for blur_px in [2.6, 4.0, 20.0] {
            assert_eq!(most_blur_px(blur_px, |_| [60; COLUMNS]), None, "{blur_px}");
        }
        assert_eq!(Prominence::default().most_variance_q16(), None);
    }

    #[test]
    fn logarithms_are_good_to_a_tenth() {
        for shift in 0..40 {
            for part in 1..=50_u64 {
                let value = part << shift;
                let exact = (value as f64).log2();
                let off = exact - super::log2_q8(value) as f64 / 256.0;
                assert!((-0.004..0.09).contains(&off), "{value}: {off}");
            }
        }
        assert_eq!(super::log2_q8(0), 0);
    }

    /// Other upright edges, however dense, are no texture.
    #[test]
    fn a_fence_is_no_texture() {
        let fence = |_| core::array::from_fn(|column| if column / 4 % 2 == 0 { 180 } else { 60 });
        assert!(!after(60, fence).is_by_chance(1, 60, 60, None));
    }

    #[test]
    fn lines_of_another_contrast_are_not_alike() {
        let of = |contrast| after(20, |_| with_step([100; COLUMNS], contrast));
        assert!(of(60).is_like(&of(60)) && of(60).is_like(&of(45)) && of(45).is_like(&of(60)));
        assert!(!of(60).is_like(&of(30)) && !of(30).is_like(&of(60)));
    }

    #[test]
    fn gaps_count_against_a_line() {
        let prominence = after(60, |row| with_step(texture(row, 4, 50), 120));
        assert!(!prominence.is_by_chance(1, 60, 60, None) && prominence.is_by_chance(1, 60, 150, None));
    }
}
