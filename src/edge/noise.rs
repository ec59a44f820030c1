//! What is usual in a row: [`Across`] it, as neighbouring pixels differ, and [`Down`] from row to row.
//!
//! A fence over the whole row is what is usual across. But upright edges hardly change down the rows, where noise and
//! texture do as much as across: each is taken for what both agree on. All are medians, which the edges that do move
//! hardly disturb.

use super::pixel_row::{difference, grey};
use super::tuning::{DOWN_COLUMNS, DOWN_ROWS, FEW_STRETCHES, MEMORY_LOOKS, SETTLED_LOOKS, TEXTURE_LAG};
use crate::format::{MosaicRow, Pixels};

/// Pixels of a sum: half the width of the scanner's sliding difference.
pub(super) const WINDOW: usize = 4;
/// Stretches of a row, one difference across each.
const STRETCH: usize = 32;

/// As neighbouring pixels differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Across {
    /// Median size of the second difference of pixels.
    second_q8: u32,
    /// Median size of the sliding difference.
    difference_q8: u32,
    /// Which stretch of the next row comes first, and rows so far.
    first: u16,
    rows: u16,
}

impl Across {
    pub(super) const fn new() -> Self {
        Self { second_q8: 0, difference_q8: 0, first: 0, rows: 0 }
    }

    /// One sigma of a pixel's noise, in 1/256 grey level.
    pub(super) const fn noise_q8(&self) -> u32 {
        // A second difference has √6 times the noise, and a median 0.6745 times sigma.
        self.second_q8 / 64 * 39
    }

    /// One sigma of the sliding difference.
    pub(super) const fn difference_q8(&self) -> u32 {
        sigma_of(self.difference_q8)
    }

    /// The first row sets the scale; later ones are sampled and move it little by little.
    pub(super) fn learn(&mut self, pixels: &impl Pixels) {
        // Some four stretches a row are plenty, others in each row.
        let usual = (pixels.columns() / (STRETCH * 4)).max(2);
        let every = if self.rows == 0 { 1 } else { usual };
        if self.rows == 0 {
            self.begin(pixels);
        }
        let first = usize::from(self.first);
        let is_mosaic = pixels.mosaic_row().is_some();
        match pixels.grey().filter(|_| !is_mosaic) {
            Some(grey) => self.learn_grey(grey, first, every),
            None => {
                for from in
                    (first * STRETCH..).step_by(every * STRETCH).take_while(|at| at + STRETCH <= pixels.columns())
                {
                    self.take(beside(pixels, from + STRETCH / 2), is_mosaic);
                }
            }
        }
        // A row has fewer stretches than that.
        self.first = if first + 1 < usual { (first + 1) as u16 } else { 0 };
        self.rows = self.rows.saturating_add(1);
    }

    /// Likewise of grey bytes of one colour.
    #[inline(never)] // all of it then fits into the registers
    fn learn_grey(&mut self, grey: &[u8], first: usize, every: usize) {
        let mut across = *self;
        let rest = grey.get(first * STRETCH + STRETCH / 2 - WINDOW..).unwrap_or_default();
        for stretch in rest.chunks((every * STRETCH).max(1)) {
            if let Some(around) = stretch.first_chunk().filter(|_| stretch.len() >= STRETCH / 2 + WINDOW) {
                across.take(*around, false);
            }
        }
        *self = across;
    }

    /// Moves by what the pixels around one place show.
    #[inline(always)]
    fn take(&mut self, around: [u8; 2 * WINDOW], is_mosaic: bool) {
        approach(&mut self.second_q8, second_difference(around, is_mosaic));
        approach(&mut self.difference_q8, sliding_difference(around));
    }

    /// Sets the scale.
    #[inline(never)]
    fn begin(&mut self, pixels: &impl Pixels) {
        let columns = pixels.columns();
        // In few stretches one edge would be what is usual.
        let every = if columns < FEW_STRETCHES * STRETCH { 2 * WINDOW } else { STRETCH };
        // Either is a power of two: a division would take flash where a core has none.
        let every_log2 = every.ilog2();
        let middles = || (0..columns >> every_log2).map(|index| beside(pixels, (2 * index + 1) << (every_log2 - 1)));
        let is_mosaic = pixels.mosaic_row().is_some();
        self.second_q8 = usual_size(|| middles().map(|pixels| second_difference(pixels, is_mosaic)));
        self.difference_q8 = usual_size(|| middles().map(sliding_difference));
    }
}

/// From row to row, in a few columns of some of the rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Down {
    /// Median size of the third difference of pixels; zero while there are too few rows.
    third_q8: u32,
    /// Likewise of what a sum of four pixels changes by over [`TEXTURE_LAG`] rows, less what one motion of the row
    /// explains.
    change_q8: u32,
    /// How often rows were compared, up to [`SETTLED_LOOKS`], and rows since the last time began.
    looks: u8,
    turn: u8,
    /// The pixels of the first three rows of a look.
    pixels: [[u8; DOWN_COLUMNS]; 3],
    /// A sum of four pixels from each column on.
    sums: [u16; DOWN_COLUMNS],
}

/// A median that is not known: as in an empty scanner, which is all zero bits.
const UNKNOWN: u32 = 0;
/// Fewest pixels of a row that has such columns.
const LEAST_PIXELS: usize = 2 * DOWN_COLUMNS + 16;

impl Down {
    pub(super) const fn new() -> Self {
        Self {
            third_q8: UNKNOWN,
            change_q8: UNKNOWN,
            looks: 0,
            turn: 0,
            pixels: [[0; DOWN_COLUMNS]; 3],
            sums: [0; DOWN_COLUMNS],
        }
    }

    /// What comes next is not below what was compared last.
    pub(super) const fn begin_frame(&mut self) {
        self.turn = 0;
    }

    /// One sigma of a pixel's noise, in 1/256 grey level.
    pub(super) const fn noise_q8(&self) -> u32 {
        // A third difference has √20 times the noise, and a median 0.6745 times sigma.
        if self.third_q8 == UNKNOWN { u32::MAX } else { self.third_q8 * 85 / 256 }
    }

    /// One sigma of what texture or noise does to the sliding difference: as much as over as many rows.
    pub(super) const fn difference_q8(&self) -> u32 {
        if self.change_q8 == UNKNOWN { u32::MAX } else { sigma_of(self.change_q8) }
    }

    /// Compares some of the rows with those before; of a mosaic every other row counts, since its two kinds differ.
    #[inline(always)]
    pub(super) fn learn(&mut self, pixels: &impl Pixels) {
        if pixels.columns() < LEAST_PIXELS || pixels.mosaic_row() == Some(MosaicRow::Odd) {
            return;
        }
        if self.turn <= TEXTURE_LAG {
            self.look(pixels);
        }
        let rows = if self.looks < SETTLED_LOOKS { TEXTURE_LAG + 1 } else { DOWN_ROWS };
        self.turn = if self.turn + 1 < rows { self.turn + 1 } else { 0 };
    }

    /// Takes one of the first rows of a turn.
    #[inline(never)] // few rows come here
    fn look(&mut self, pixels: &impl Pixels) {
        match self.pixels.get_mut(usize::from(self.turn)) {
            Some(row) => columns(pixels.columns()).zip(row).for_each(|(column, pixel)| *pixel = level(pixels, column)),
            None if self.turn == 3 => self.compare_pixels(pixels),
            None => {}
        }
        if self.turn == 0 {
            columns(pixels.columns())
                .zip(&mut self.sums)
                .for_each(|(column, sum)| *sum = sum_of(around(pixels, column)));
        }
        if self.turn == TEXTURE_LAG {
            self.compare_sums(pixels);
            self.looks = (self.looks + 1).min(SETTLED_LOOKS);
        }
    }

    #[inline(never)] // all of it then fits into the registers
    fn compare_pixels(&mut self, pixels: &impl Pixels) {
        let [first, second, third] = self.pixels;
        let mut before = first.into_iter().zip(second).zip(third);
        let mut differences = columns(pixels.columns()).zip(&mut before).map(|(column, ((first, second), third))| {
            let [a, b, c, d] = [first, second, third, level(pixels, column)].map(i32::from);
            (d - a + 3 * (b - c)).unsigned_abs()
        });
        let thirds = core::array::from_fn(|_| differences.next().unwrap_or(0));
        settle(&mut self.third_q8, self.looks, &thirds);
    }

    /// An edge that moves changes a sum by as much as one that is so far to the side: what one motion of the whole row
    /// explains is no texture.
    #[inline(never)] // likewise
    fn compare_sums(&mut self, pixels: &impl Pixels) {
        let mut changes = [(0, 0); DOWN_COLUMNS];
        for ((column, change), before) in columns(pixels.columns()).zip(&mut changes).zip(self.sums) {
            let around = around(pixels, column);
            let [left, a, _, _, d, right] = around.map(i32::from);
            *change = (i32::from(sum_of(around)) - i32::from(before), (right + d - a - left) / 2);
        }
        let (shared, own) =
            changes.iter().fold((0, 0), |(shared, own), (down, aside)| (shared + down * aside, own + aside * aside));
        let motion_q8 = (shared << 4).checked_div((own >> 4).max(1)).unwrap_or(0).clamp(-1024, 1024);
        let rest = |(down, aside): (i32, i32)| (down - ((motion_q8 * aside) >> 8)).unsigned_abs();
        settle(&mut self.change_q8, self.looks, &changes.map(rest));
    }
}

/// The grey level at a column.
#[inline(always)]
fn level(pixels: &impl Pixels, column: usize) -> u8 {
    grey(pixels, column..column + 1, &mut [0]).first().copied().unwrap_or(0)
}

/// Four pixels from a column on, and one on either side of them.
#[inline(always)]
fn around(pixels: &impl Pixels, column: usize) -> [u8; WINDOW + 2] {
    let mut buffer = [0; WINDOW + 2];
    grey(pixels, column - 1..column + WINDOW + 1, &mut buffer).first_chunk().copied().unwrap_or_default()
}

/// Of those four.
const fn sum_of([_, a, b, c, d, _]: [u8; WINDOW + 2]) -> u16 {
    a as u16 + b as u16 + c as u16 + d as u16
}

/// Where rows are compared: at irregular distances, so that no fence has a post at each of them; some pixels off the
/// border.
fn columns(length: usize) -> impl Iterator<Item = usize> {
    const OFF: [usize; DOWN_COLUMNS] = [0, 5, 2, 7, 3, 6, 1, 4];
    let spacing = length.saturating_sub(16) / DOWN_COLUMNS;
    OFF.into_iter().enumerate().map(move |(index, off)| 1 + index * spacing + off)
}

/// Moves a median to the mean of those of the first looks, then a part of the way to that of the next one; from twice
/// the first one: so few values tell it to a factor of two.
fn settle(median_q8: &mut u32, looks: u8, values: &[u32; DOWN_COLUMNS]) {
    let own_q8 = usual_size(|| values.iter().copied());
    let (own_q8, looks) = if looks == 0 { (2 * own_q8, 0) } else { (own_q8, u32::from(looks).min(MEMORY_LOOKS)) };
    *median_q8 = ((*median_q8 * looks + own_q8) / (looks + 1)).max(1);
}

/// One sigma of normal values from their median size.
const fn sigma_of(median: u32) -> u32 {
    median * 95 / 64
}

/// Moves a median in 1/256 towards a value by a small step.
fn approach(median_q8: &mut u32, value: u32) {
    let step = *median_q8 / 32 + 8;
    *median_q8 = if value << 8 > *median_q8 { *median_q8 + step } else { median_q8.saturating_sub(step) };
}

/// Median of what is normal among the values, in 1/256, from means that leave out ever more of the large ones.
fn usual_size<I: Iterator<Item = u32>>(values: impl Fn() -> I) -> u32 {
    // Three times the mean keeps 98 % of what is normal, whose median is 0.85 of its mean.
    let rough = mean_up_to(u32::MAX, values());
    let finer = mean_up_to((rough * 2) >> 8, values());
    mean_up_to((finer * 3) >> 8, values()) * 7 / 8
}

/// Mean of the values up to a limit, in 1/256.
#[inline(never)] // it would be there three times
fn mean_up_to(limit: u32, values: impl Iterator<Item = u32>) -> u32 {
    let (sum, count) = values.filter(|value| *value <= limit).fold((0, 0), |(s, n), value| (s + value, n + 1));
    (sum << 8_u32).checked_div(count).unwrap_or(0)
}

/// The pixels on both sides of a boundary, which the row has.
fn beside(pixels: &impl Pixels, middle: usize) -> [u8; 2 * WINDOW] {
    let mut buffer = [0; 2 * WINDOW];
    grey(pixels, middle - WINDOW..middle + WINDOW, &mut buffer).first_chunk().copied().unwrap_or_default()
}

/// Second difference of three pixels of one colour: its sigma is √6 times the noise.
fn second_difference(pixels: [u8; 2 * WINDOW], is_mosaic: bool) -> u32 {
    let [_, _, second, first, centre, third, fourth, _] = pixels.map(i32::from);
    let ends = if is_mosaic { second + fourth } else { first + third };
    (ends - 2 * centre).unsigned_abs()
}

fn sliding_difference(pixels: [u8; 2 * WINDOW]) -> u32 {
    difference(&pixels).unsigned_abs()
}
