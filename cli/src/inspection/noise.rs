//! Noise against brightness, and whether neighbours share it.

use super::grey::Grey;
use super::robust::{median, quantile};

/// Width of a block and of a bin of brightness.
const BLOCK: usize = 8;
const BIN_LEVELS: usize = 16;
/// A bin of fewer blocks says nothing.
const FEWEST_BLOCKS: usize = 24;
/// The kernel's own correlation from one pixel to the next, for noise that neighbours do not share.
const WHITE: f64 = -2.0 / 3.0;

#[derive(Clone)]
pub(crate) struct Noise {
    /// Mean grey level of each bin, and one sigma there.
    pub(crate) bins: Vec<(f64, f64)>,
    /// Of all blocks together.
    pub(crate) sigma: f64,
    /// Variance at level 0, and its rise with each level.
    pub(crate) read_variance: f64,
    pub(crate) shot_gain: f64,
    /// How much more neighbours are alike than those of white noise; 0: not at all, above: smoothed, below: sharpened.
    pub(crate) correlation: f64,
    /// Variance from pixel to pixel over that from every second one to the next: 1 for white noise, more where it is
    /// sharpened, less where it is smoothed.
    pub(crate) roughness: f64,
    /// Variance on even over that on odd columns, and the same of rows: 1 where all pixels are alike.
    pub(crate) parity: [f64; 2],
}

/// Sums over a block.
struct Block {
    level: f64,
    sigma: f64,
    squares: f64,
    /// Of what the same differences are over twice the distance.
    wide_squares: f64,
    /// Of neighbours, along the row and along the column.
    products: [f64; 2],
    /// Squares on even columns, odd columns, even rows, odd rows.
    by_parity: [f64; 4],
}

pub(crate) fn of(grey: &Grey<'_>) -> Noise {
    let mut blocks = Vec::new();
    for top in (2..grey.rows.saturating_sub(BLOCK + 2)).step_by(BLOCK) {
        for left in (2..grey.columns.saturating_sub(BLOCK + 2)).step_by(BLOCK) {
            blocks.extend(block(grey, left, top));
        }
    }
    let mut by_level: Vec<Vec<&Block>> = (0..256 / BIN_LEVELS).map(|_| Vec::new()).collect();
    for block in &blocks {
        if let Some(bin) = by_level.get_mut(block.level as usize / BIN_LEVELS) {
            bin.push(block);
        }
    }
    let bins: Vec<(f64, f64)> = by_level
        .iter()
        .filter(|bin| bin.len() >= FEWEST_BLOCKS)
        .map(|bin| (median(bin.iter().map(|block| block.level)), median(bin.iter().map(|block| block.sigma))))
        .collect();
    let (read_variance, shot_gain) = line(&bins);
    let plain: Vec<&Block> =
        by_level.iter().filter(|bin| bin.len() >= FEWEST_BLOCKS).flat_map(|bin| plain(bin)).collect();
    let sum = |value: &dyn Fn(&Block) -> f64| plain.iter().map(|block| value(block)).sum::<f64>();
    let ratio = |above: f64, below: f64| if below > 0.0 { above / below } else { 1.0 };
    let products = sum(&|block| block.products.iter().sum::<f64>() / 2.0);
    let squares = sum(&|block| block.squares);
    Noise {
        sigma: median(blocks.iter().map(|block| block.sigma)),
        bins,
        read_variance,
        shot_gain,
        correlation: if squares > 0.0 { products / squares - WHITE } else { 0.0 },
        roughness: median(
            plain.iter().filter(|block| block.wide_squares > 0.0).map(|block| block.squares / block.wide_squares),
        ),
        parity: [0, 2]
            .map(|first| ratio(sum(&|block| block.by_parity[first]), sum(&|block| block.by_parity[first + 1]))),
    }
}

/// Blocks without an edge: about as noisy as most of their brightness.
fn plain<'b>(bin: &[&'b Block]) -> Vec<&'b Block> {
    let usual = quantile(bin.iter().map(|block| block.sigma), 0.4);
    bin.iter().copied().filter(|block| block.sigma <= 1.3 * usual).collect()
}

/// `None` where a pixel is clipped.
fn block(grey: &Grey<'_>, left: usize, top: usize) -> Option<Block> {
    let pixels = || (top..top + BLOCK).flat_map(move |row| (left..left + BLOCK).map(move |column| (column, row)));
    let (mut sum, mut sizes) = (0, 0);
    let mut found =
        Block { level: 0.0, sigma: 0.0, squares: 0.0, wide_squares: 0.0, products: [0.0; 2], by_parity: [0.0; 4] };
    for (column, row) in pixels() {
        let level = grey.at(column, row);
        if level <= 0 || level >= 255 {
            return None;
        }
        let rough = grey.roughness(column, row);
        let square = f64::from(rough * rough);
        sum += level;
        let wide = grey.wide_roughness(column, row);
        found.wide_squares += f64::from(wide * wide);
        sizes += rough.abs();
        found.squares += square;
        found.products[0] += f64::from(rough * grey.roughness(column + 1, row));
        found.products[1] += f64::from(rough * grey.roughness(column, row + 1));
        found.by_parity[column % 2] += square;
        found.by_parity[2 + row % 2] += square;
    }
    let count = (BLOCK * BLOCK) as f64;
    found.level = f64::from(sum) / count;
    // The mean size of a normal distribution is √(2/π) of its sigma.
    found.sigma = f64::from(sizes) / count * (std::f64::consts::PI / 2.0).sqrt() / 6.0;
    Some(found)
}

/// Variance over level: value at 0 and slope, by least squares.
fn line(bins: &[(f64, f64)]) -> (f64, f64) {
    let count = bins.len() as f64;
    let mean = |value: &dyn Fn(&(f64, f64)) -> f64| bins.iter().map(value).sum::<f64>() / count.max(1.0);
    let (level, variance) = (mean(&|bin| bin.0), mean(&|bin| bin.1 * bin.1));
    let spread = mean(&|bin| (bin.0 - level).powi(2));
    let slope = if spread > 0.0 { mean(&|bin| (bin.0 - level) * (bin.1 * bin.1 - variance)) / spread } else { 0.0 };
    (variance - slope * level, slope)
}
