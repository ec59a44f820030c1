//! An edge with texture beside it, as frames of a camera that moves on show it.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, Normal};
use shutter_range::{Ranger, Setup};

const COLUMNS: usize = 160;
const ROWS: u16 = 96;
const CONTRAST: f64 = 60.0;
/// One sigma of the blur, of the noise and of the texture, in pixels and grey levels.
const BLUR_PX: f64 = 0.9;
const NOISE: f64 = 1.5;
const TEXTURE: f64 = 4.0;

/// The texture on the right of the edge: levels of patches of three pixels by four rows.
struct Surface(Vec<f64>);

impl Surface {
    const ACROSS: usize = 64;

    fn new(random: &mut StdRng) -> Self {
        let texture = Normal::new(0.0, TEXTURE).unwrap();
        Self((0..Self::ACROSS * usize::from(ROWS.div_ceil(4))).map(|_| texture.sample(random)).collect())
    }

    /// Light at a distance from the edge in pixels, blurred.
    fn light(&self, row: u16, off_px: f64) -> f64 {
        let step = 1.0 / (1.0 + (-1.7 * off_px / BLUR_PX).exp());
        let place = off_px / 3.0;
        if place < 0.0 {
            return CONTRAST * step;
        }
        // One patch goes over into the next.
        let (cell, part) = (place.floor() as usize, place.fract());
        let at = |cell: usize| self.0[usize::from(row / 4) * Self::ACROSS + cell];
        let texture = at(cell) * (1.0 - part) + at(cell + 1) * part;
        step * (CONTRAST + texture)
    }
}

/// What the mean column of an edge is off in a frame, in pixels.
fn off_px(surface: &Surface, column_px: f64, random: &mut StdRng) -> f64 {
    let setup = Setup::pinhole(COLUMNS as u16, ROWS, 200.0_f64, 10_000_000).unwrap();
    let noise = Normal::new(0.0, NOISE).unwrap();
    let mut ranger: Ranger<64, 16, 64> = Ranger::new();
    for row in 0..ROWS {
        let light = |column: usize| 80.0 + surface.light(row, column as f64 - column_px);
        let pixels: Vec<u8> = (0..COLUMNS).map(|column| (light(column) + noise.sample(random)).round() as u8).collect();
        ranger.row(&setup, row, pixels.as_slice()).unwrap();
    }
    ranger.end_frame(&setup);
    let mut offs = Vec::new();
    while let Some(line) = ranger.next_line() {
        offs.extend(line.samples::<f64>().map(|mean| mean.column_px - column_px).filter(|off| off.abs() < 1.5));
    }
    assert!(offs.len() >= 8, "{} knots", offs.len());
    offs.iter().sum::<f64>() / offs.len() as f64
}

/// What texture shifts an edge by is alike in all frames: else several frames know its distance no better than one.
#[test]
fn their_columns_are_those_of_all_frames() {
    const FRAMES: u32 = 12;
    const SURFACES: u64 = 12;
    // Noise alone is 0.005 px. It is 0.008 px, and 0.011 px where plateaus count for nothing in those rows that are
    // beside texture.
    const DEVIATION_PX: core::ops::Range<f64> = 0.003..0.0095;
    let mut squares = 0.0;
    for seed in 0..SURFACES {
        let mut random = StdRng::seed_from_u64(seed);
        let surface = Surface::new(&mut random);
        let offs: Vec<f64> = (0..FRAMES)
            .map(|frame| off_px(&surface, 60.0 + 1.37 * f64::from(frame) + random.random::<f64>(), &mut random))
            .collect();
        let mean = offs.iter().sum::<f64>() / f64::from(FRAMES);
        squares += offs.iter().map(|off| (off - mean) * (off - mean)).sum::<f64>() / f64::from(FRAMES - 1);
    }
    let deviation_px = (squares / SURFACES as f64).sqrt();
    assert!(DEVIATION_PX.contains(&deviation_px), "{deviation_px} px from frame to frame");
}
