//! What an upright edge looks like: its blur, and the halos of sharpening.

use super::grey::Grey;

/// Pixels on each side that belong to an edge, and those from where on it must be flat.
const REACH: usize = 10;
const FLAT_FROM: usize = 6;
const FEWEST_LEVELS: f64 = 30.0;
/// Steps of the profile in a pixel.
const STEPS: usize = 4;
const CELLS: usize = 2 * REACH * STEPS;
/// Of a profile's cell.
const FEWEST_SAMPLES: f64 = 12.0;

/// The mean of many edges from 0 (dark) to 1 (bright).
pub(crate) struct EdgeProfile {
    cells: [Cell; CELLS],
    /// Crossings of rows and edges.
    pub(crate) crossings: usize,
}

#[derive(Clone, Copy, Default)]
struct Cell {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Cell {
    fn mean(&self) -> f64 {
        self.sum / self.count
    }

    /// One sigma of the mean.
    fn sigma(&self) -> f64 {
        ((self.squares / self.count - self.mean().powi(2)).max(0.0) / self.count).sqrt()
    }
}

pub(crate) fn of(grey: &Grey<'_>, noise_sigma: f64) -> EdgeProfile {
    let mut profile = EdgeProfile { cells: [Cell::default(); CELLS], crossings: 0 };
    for row in 0..grey.rows {
        let levels = grey.row(row);
        for window in levels.windows(2 * REACH + 2) {
            profile.add(window, noise_sigma);
        }
    }
    profile
}

impl EdgeProfile {
    /// Takes a window whose middle two pixels an isolated edge crosses half-way.
    fn add(&mut self, window: &[u8], noise_sigma: f64) {
        let (Some(left), Some(right)) = (window.get(..=REACH - FLAT_FROM), window.get(REACH + 1 + FLAT_FROM..)) else {
            return;
        };
        let (Some(left), Some(right)) = (plateau(left, noise_sigma), plateau(right, noise_sigma)) else { return };
        let step = right - left;
        let (Some(a), Some(b)) = (window.get(REACH), window.get(REACH + 1)) else { return };
        let [a, b] = [a, b].map(|level| (f64::from(*level) - left) / step);
        if step.abs() < FEWEST_LEVELS.max(10.0 * noise_sigma) || !(a < 0.5 && b >= 0.5) || is_clipped(window) {
            return;
        }
        let crossing = REACH as f64 + (0.5 - a) / (b - a);
        self.crossings += 1;
        // From dark to bright, whichever side is which.
        let is_rising = step > 0.0;
        for (index, level) in window.iter().enumerate() {
            let offset = if is_rising { index as f64 - crossing } else { crossing - index as f64 };
            let part = (f64::from(*level) - left) / step;
            let part = if is_rising { part } else { 1.0 - part };
            let cell = ((offset + REACH as f64) * STEPS as f64).floor();
            if let Some(cell) = self.cells.get_mut(cell.max(0.0) as usize) {
                cell.count += 1.0;
                cell.sum += part;
                cell.squares += part * part;
            }
        }
    }

    fn sound(&self) -> impl Iterator<Item = (f64, &Cell)> {
        let place = |index: usize| (index as f64 + 0.5) / STEPS as f64 - REACH as f64;
        self.cells
            .iter()
            .enumerate()
            .filter(|(_, cell)| cell.count >= FEWEST_SAMPLES)
            .map(move |(index, cell)| (place(index), cell))
    }

    /// How far the profile goes beyond black and beyond white within 4 px, each as a share of the step.
    pub(crate) fn halos(&self) -> [f64; 2] {
        let beyond = |is_bright: bool| {
            if !self.is_isolated(is_bright) {
                return 0.0;
            }
            let cells = self.sound().filter(|(place, _)| place.abs() < 4.0 && (*place > 0.0) == is_bright);
            let excess = |cell: &Cell| {
                let over = if is_bright { cell.mean() - 1.0 } else { -cell.mean() };
                // What chance may have added to the largest of some dozen cells.
                over - 3.0 * cell.sigma()
            };
            cells.map(|(_, cell)| excess(cell)).fold(0.0, f64::max)
        };
        [beyond(false), beyond(true)]
    }

    /// Whether a side stays as it is from 5 px on: the beginning of a next edge is no plateau.
    fn is_isolated(&self, is_bright: bool) -> bool {
        const MOST_CHANGE: f64 = 0.01;
        let mean = |from: f64, to: f64| {
            let cells = self.sound().filter(|(place, _)| (*place > 0.0) == is_bright);
            let within = cells.filter(|(place, _)| (from..to).contains(&place.abs()));
            let (sum, count) = within.fold((0.0, 0.0), |(sum, count), (_, cell)| (sum + cell.mean(), count + 1.0));
            sum / count
        };
        let plateau = if is_bright { 1.0 } else { 0.0 };
        let is_there = |(from, to)| (mean(from, to) - plateau).abs() < MOST_CHANGE;
        [(5.0, 6.25), (6.25, 7.5), (7.5, 9.0)].into_iter().all(is_there)
    }

    /// One sigma of the blur without the pixel's own, in pixels; `None` without enough edges.
    pub(crate) fn blur_px(&self) -> Option<f64> {
        const PIXEL_VARIANCE: f64 = 1.0 / 12.0;
        let at = |part: f64| {
            let cells: Vec<(f64, f64)> = self.sound().map(|(place, cell)| (place, cell.mean())).collect();
            cells.windows(2).find_map(|pair| match *pair {
                [(x0, y0), (x1, y1)] if y0 < part && y1 >= part => Some(x0 + (x1 - x0) * (part - y0) / (y1 - y0)),
                _ => None,
            })
        };
        // A normal distribution has these shares one sigma below and above its middle.
        let sigma = 0.5 * (at(0.8413)? - at(0.1587)?);
        // The cells have a width, too.
        let cell_variance = 1.0 / (12.0 * (STEPS * STEPS) as f64);
        Some((sigma * sigma - PIXEL_VARIANCE - cell_variance).max(0.0).sqrt())
    }
}

fn is_clipped(window: &[u8]) -> bool {
    window.iter().any(|level| matches!(level, 0 | 255))
}

/// The mean of a side that is flat but for noise.
fn plateau(levels: &[u8], noise_sigma: f64) -> Option<f64> {
    let (darkest, brightest) = (levels.iter().min()?, levels.iter().max()?);
    let is_flat = f64::from(brightest - darkest) <= 5.0 * noise_sigma + 3.0;
    let sum: f64 = levels.iter().map(|level| f64::from(*level)).sum();
    is_flat.then(|| sum / levels.len() as f64)
}
