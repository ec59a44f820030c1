//! [`EdgeModel`]: levels, blur and noise of a tracked edge, and where the next row has it.
//!
//! A row on its own locates an edge with the noise of all pixels around it. Where a line predicts the column, and its rows
//! so far tell both levels and the blur, the maximum-likelihood estimate is a step or a few from the prediction: the row minus
//! the expected levels, weighted by the slope of the spread function. Its noise is the Cramér–Rao bound.

use super::moments::Moments;
use super::pixel_row::PixelRow;
use super::point::{EdgePoint, Polarity};
use super::scan::{ScannedPoint, Scanner};
use super::spread_function::SpreadFunction;
use super::window::{Neighbours, Side, Window, plateau};
use crate::format::Pixels;

/// Levels, blur and noise of a tracked edge, running means over its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct EdgeModel {
    /// Brightness on the left and on the right, in 1/65536 grey level; those of a mosaic's odd rows apart. Zero: not seen yet.
    levels_q16: [[u32; 2]; 2],
    /// One sigma of the edge's blur, in 1/4096 px.
    blur_q12: u16,
    rows: u16,
    /// Variance of a pixel's noise, in 1/65536 square grey level.
    noise_q16: u32,
    /// Mean difference between a row's own level and the running mean, left and right.
    level_scatter_q8: [u16; 2],
    /// One sigma of the pixels' noise when the line was confirmed.
    white_q8: u16,
    /// Rows with texture on either side.
    textured_rows: u16,
}

/// What one row says, given the model.
struct Fit {
    /// Column minus the expected one.
    shift_q16: i64,
    /// Width of the spread function that fits best, and that of the edge, whatever the lens.
    template_q12: i64,
    width_q12: i64,
    /// Residual variance of a pixel.
    residual_q16: i64,
    sigma_q16: i64,
    /// The row's own levels minus the mean ones.
    off_q16: [i64; 2],
}

/// Blur of a sharp lens, half a pixel, and of the pixel itself.
const LEAST_BLUR_Q8: u16 = 148;
/// What an edge is taken to be blurred at least before more is known.
const USUAL_BLUR_Q8: u16 = 195;
const MOST_BLUR_Q8: u16 = 12 << 8;
/// Beyond this the scanner tells the blur only roughly.
const LONG_BLUR_Q8: u16 = 4 << 8;
/// Most steps of [`EdgeModel::settled`].
const MOST_STEPS: usize = 6;
/// How far a neighbour may bias the scanner's column of an edge, and how far from that neighbour the located edge must be: nearer
/// ones hide each other's levels. Decided only where the noise is below the third.
const MOST_DRAWN_Q16: i64 = 5 << 14;
const LEAST_APART_Q16: i64 = 5 << 16;
const SURE_SIGMA_Q16: u32 = 1 << 13;
/// Most steps of [`EdgeModel::locate`] after the first.
const MOST_CORRECTIONS: usize = 3;

/// Least contrast in 1/256 grey level.
const LEAST_CONTRAST_Q8: i32 = 4 << 8;
/// Rows with texture that make a line one beside texture, probably and surely.
const FEW_TEXTURED_ROWS: u16 = 4;
const MANY_TEXTURED_ROWS: u16 = 12;
/// Rounding to whole grey levels alone.
const LEAST_NOISE_Q16: u32 = 65536 / 12;

impl EdgeModel {
    /// From an edge that a row shows on its own.
    fn new<P: Pixels>(row: PixelRow<'_, P>, edge: &EdgePoint, around: Neighbours, noise_q8: u32) -> Option<Self> {
        let noise_q8 = row.noise_of_light_q8(i64::from(edge.column_q16), noise_q8);
        let noise_q16 = noise_q8.saturating_mul(noise_q8).max(LEAST_NOISE_Q16);
        let white_q8 = noise_q8.min(u32::from(u16::MAX)) as u16;
        let blur_q12 = edge.width_q8.clamp(USUAL_BLUR_Q8, MOST_BLUR_Q8) << 4;
        let mut model = Self {
            levels_q16: [[0; 2]; 2],
            blur_q12,
            noise_q16,
            rows: 1,
            level_scatter_q8: [0; 2],
            white_q8,
            textured_rows: 0,
        };
        model.look_beside(row, i64::from(edge.column_q16), around)?;
        model.shows(row.kind(), edge.polarity).then_some(model)
    }

    /// The same with levels and blur of that row found each from the other: a long blur's width is only guessed at first, and
    /// noise may have broken it into pieces.
    pub(crate) fn settled<P: Pixels>(
        row: PixelRow<'_, P>,
        edge: &EdgePoint,
        around: Neighbours,
        noise_q8: u32,
    ) -> Option<Self> {
        let mut model = Self::new(row, edge, around, noise_q8)?;
        let mut column_q16 = i64::from(edge.column_q16);
        for _ in 0..MOST_STEPS {
            let fit = model.fit(row, i32::try_from(column_q16).ok()?, around)?;
            let (blur_q12, blur_q16) = (model.blur_q12, i64::from(model.blur_q12) << 4);
            column_q16 += fit.shift_q16.clamp(-blur_q16, blur_q16);
            model.widen(fit.template_q12, 1);
            model.look_beside(row, column_q16, around)?;
            if model.blur_q12.abs_diff(blur_q12) < blur_q12 / 16 && fit.shift_q16.abs() < blur_q16 / 16 {
                break;
            }
        }
        model.shows(row.kind(), edge.polarity).then_some(model)
    }

    /// Takes the levels from the plateaus of a row.
    fn look_beside<P: Pixels>(&mut self, row: PixelRow<'_, P>, column_q16: i64, around: Neighbours) -> Option<()> {
        let reach_q16 = i64::from(SpreadFunction::new(self.blur_q8()).reach_q8()) << 8;
        let side = |side| plateau(row, column_q16, reach_q16, side, around);
        let own = [side(Side::Left)?, side(Side::Right)?];
        if let Some(levels_q16) = self.levels_q16.get_mut(row.kind()) {
            *levels_q16 = own;
        }
        Some(())
    }

    /// Whether rows of this kind show an edge of this polarity.
    fn shows(&self, kind: usize, polarity: Polarity) -> bool {
        self.polarity(kind) == polarity && self.contrast_q8(kind).abs() >= LEAST_CONTRAST_Q8
    }

    fn polarity(&self, kind: usize) -> Polarity {
        if self.contrast_q8(kind) < 0 { Polarity::Falling } else { Polarity::Rising }
    }

    /// Looks at the first row of the other kind, so that its levels are known. `false` where the edge is none in such rows.
    fn knows<P: Pixels>(&mut self, row: PixelRow<'_, P>, column_q16: i64, around: Neighbours) -> bool {
        let (kind, other) = (row.kind(), 1 - row.kind());
        if self.levels_q8(kind) != [0; 2] {
            return true;
        }
        let is_one = self.look_beside(row, column_q16, around).is_some() && self.shows(kind, self.polarity(other));
        if let (false, Some(levels_q16)) = (is_one, self.levels_q16.get_mut(kind)) {
            *levels_q16 = [0; 2];
        }
        is_one
    }

    /// One part of `parts` of the way to another blur.
    fn widen(&mut self, width_q12: i64, parts: i64) {
        let blur_q12 = i64::from(self.blur_q12);
        let wider_q12 = width_q12.min(2 * blur_q12).max(blur_q12 / 2);
        self.blur_q12 = toward(self.blur_q12, wider_q12, parts).clamp(LEAST_BLUR_Q8 << 4, MOST_BLUR_Q8 << 4);
    }

    fn levels_q8(&self, kind: usize) -> [i64; 2] {
        self.levels_q16.get(kind).map_or([0; 2], |levels_q16| levels_q16.map(|level_q16| i64::from(level_q16 >> 8)))
    }

    /// Whether one of the levels is so near to the end of the scale that the sensor may have cut its noise, and a part of the
    /// flank, off: the width is then not that of the blur.
    fn is_clipped(&self, kind: usize) -> bool {
        let two_sigma_q8 = 2 * i64::from(self.white_q8);
        self.levels_q8(kind).into_iter().any(|level_q8| level_q8 + two_sigma_q8 >= 255 << 8)
    }

    fn contrast_q8(&self, kind: usize) -> i32 {
        let [left_q8, right_q8] = self.levels_q8(kind);
        (right_q8 - left_q8) as i32
    }

    const fn blur_q8(&self) -> u16 {
        self.blur_q12 >> 4
    }

    /// An edge that a row shows on its own, located with the levels and the blur that it shows itself.
    pub(crate) fn refine_alone<P: Pixels>(
        row: PixelRow<'_, P>,
        edge: &EdgePoint,
        around: Neighbours,
        noise_q8: u32,
    ) -> Option<EdgePoint> {
        let learn = if edge.width_q8 > LONG_BLUR_Q8 { Self::settled } else { Self::new };
        let mut model = learn(row, edge, around, noise_q8)?;
        let column_q16 = i64::from(edge.column_q16);
        let is_drawn = around.is_nearer_than(Scanner::SEES_ALONE_Q16, column_q16);
        let drawn_q16 = if is_drawn { MOST_DRAWN_Q16 } else { 0 };
        let found = model.locate(row, column_q16, i64::from(u16::MAX), drawn_q16, around)?;
        let is_sure = found.sigma_q16 < SURE_SIGMA_Q16;
        if is_drawn && is_sure && around.is_nearer_than(LEAST_APART_Q16, i64::from(found.column_q16)) {
            return None;
        }
        let sigma_q16 = found.sigma_q16 + found.sigma_q16 / 4;
        Some(EdgePoint { column_q16: found.column_q16, sigma_q16, width_q8: found.width_q8, ..*edge })
    }

    /// The edge near the expected column, from which the model learns; `None` where the row shows something else, or where the edge
    /// is farther off than the gate, or than its noise and the bias that the expected column itself may have. What is found must
    /// not depend on what was expected, or a line would go on where it once went astray: more steps where the first one is large.
    pub(crate) fn locate<P: Pixels>(
        &mut self,
        row: PixelRow<'_, P>,
        expected_q16: i64,
        gate_q16: i64,
        drawn_q16: i64,
        around: Neighbours,
    ) -> Option<ScannedPoint> {
        if !self.knows(row, expected_q16, around) {
            return None;
        }
        let expected = i32::try_from(expected_q16).ok()?;
        let mut fit = self.fit(row, expected, around)?;
        let blur_q16 = i64::from(self.blur_q12) << 4;
        let mut from_q16 = expected_q16;
        for _ in 0..MOST_CORRECTIONS {
            if fit.shift_q16.abs() <= blur_q16 / 8 {
                break;
            }
            from_q16 += fit.shift_q16.clamp(-blur_q16, blur_q16);
            fit = self.fit(row, i32::try_from(from_q16).ok()?, around)?;
        }
        fit.shift_q16 += from_q16 - expected_q16;
        let fits = fit.shift_q16.abs() <= gate_q16.min((4 * fit.sigma_q16 + blur_q16 / 4).max(drawn_q16))
            && fit.residual_q16 <= 9 * i64::from(self.noise_q16) + (1 << 18);
        if !fits {
            return None;
        }
        // The row's own width, so that the line's mean settles like any mean; beside texture it can be anything.
        let half_q8 = i64::from(self.blur_q8() / 2);
        let width_q8 = (fit.width_q12 >> 4).clamp(half_q8, 3 * half_q8) as u16;
        let width_q8 = if self.is_clipped(row.kind()) { 0 } else { width_q8 };
        self.learn(row.kind(), &fit);
        Some(ScannedPoint {
            column_q16: i32::try_from(expected_q16 + fit.shift_q16).ok()?,
            sigma_q16: u32::try_from(fit.sigma_q16).ok()?.max(1),
            width_q8,
            contrast: i16::try_from(self.contrast_q8(row.kind()) >> 8).ok()?,
        })
    }

    fn fit<P: Pixels>(&self, row: PixelRow<'_, P>, expected_q16: i32, around: Neighbours) -> Option<Fit> {
        let template = SpreadFunction::new(self.blur_q8());
        let expected = i64::from(expected_q16);
        if !self.is_alone(expected, around, row.pixels.columns()) {
            return None;
        }
        let look = Window::new(row, expected, &template, around)?;
        let means_q8 = self.levels_q8(row.kind());
        let of_means = look.sums(&template, means_q8);
        let off_q16 = of_means.off_q16;
        let (sums, [left_q8, right_q8], residual_slope) = self.with_own_levels(&look, &template, means_q8, of_means)?;
        let usual = i64::from(self.contrast_q8(row.kind()));
        let contrast = usual + right_q8 - left_q8;
        if !is_alike(contrast, usual) || !sums.shows_edge() {
            return None;
        }
        let (box_q16, slope_slope) = (i64::from(template.box_q8) << 8, sums.slope_slope >> 15);
        let shift_q16 = (-box_q16 * residual_slope).checked_div(contrast * slope_slope)?;
        let wider_q12 = |(residual, square): (i64, i64)| -> Option<i64> {
            let off_q12 = 16 * i64::from(template.per_widening_q8) * residual;
            Some(i64::from(self.blur_q12) + off_q12.checked_div(contrast * square.max(1))?)
        };
        let [template_q12, width_q12] = sums.widening().map(wider_q12);
        let explained = (sums.residual_slope.checked_div(slope_slope)? * sums.residual_slope) >> 15;
        Some(Fit {
            shift_q16,
            template_q12: template_q12?,
            width_q12: width_q12?,
            residual_q16: (sums.residual_residual - explained).max(0).checked_div(sums.pixels - 1)?,
            sigma_q16: self.sigma_q16(&sums, (box_q16 << 8).checked_div(contrast.abs())?)?,
            off_q16,
        })
    }

    /// Whether neither the border nor a neighbour's blur lies within the edge's own blur: its column would be biased.
    fn is_alone(&self, column_q16: i64, around: Neighbours, columns: usize) -> bool {
        let clear_q16 = (2 * i64::from(self.blur_q8()) + 256) << 8;
        let border_q16 = (columns as i64 - 1) << 16;
        column_q16 - clear_q16 >= around.left_q16.max(0) && column_q16 + clear_q16 <= around.right_q16.min(border_q16)
    }

    /// The sums with the levels that the row itself shows, what these are above the mean ones, and the product of residual and slope.
    fn with_own_levels<P: Pixels>(
        &self,
        look: &Window<'_, P>,
        template: &SpreadFunction,
        [left_mean_q8, right_mean_q8]: [i64; 2],
        of_means: Moments,
    ) -> Option<(Moments, [i64; 2], i64)> {
        let mut sums = of_means;
        if self.is_textured() {
            // Beside texture no plateau tells the level at the edge: the edge's own pixels do. With one of the levels from its
            // plateau, an error of the width would shift the edge.
            sums.free_levels(look.level_sums(template, [left_mean_q8, right_mean_q8]))?;
            let (change_q8, residual_slope) = (sums.off_q16.map(|off_q16| off_q16 >> 8), sums.residual_slope);
            return Some((sums, change_q8, residual_slope));
        }
        let [left_q8, right_q8] = self.departure(sums.off_q16);
        if left_q8 != 0 || right_q8 != 0 {
            sums = look.sums(template, [left_mean_q8 + left_q8, right_mean_q8 + right_q8]);
        }
        let residual_slope = sums.residual_slope_of_plateaus();
        Some((sums, [left_q8, right_q8], residual_slope))
    }

    /// Sigma of the column: from the noise on the flank, and on the plateaus, whose levels shift the edge when they are wrong.
    /// `per_grey` is b/A in 1/65536 px and grey level.
    fn sigma_q16(&self, sums: &Moments, per_grey: i64) -> Option<i64> {
        let slope_slope = sums.slope_slope >> 15;
        // With S the slope and n pixels on a plateau, 1/ΣS² + (ΣS/ΣS²)²/4 (1/n + 1/n').
        let of_flank_q16 = (1_i64 << 31).checked_div(slope_slope)?;
        let half_q8 = (sums.slope << 7).checked_div(slope_slope)?;
        let of_levels_q16: i64 = sums.plateau_pixels.iter().map(|pixels| half_q8 * half_q8 / pixels.max(&1)).sum();
        let variance_q16 = (i64::from(self.noise_q16) * (of_flank_q16 + of_levels_q16)) >> 16;
        Some((per_grey * root(variance_q16)) >> 8)
    }

    /// What to add to the mean levels for this row, in 1/256 grey level: nothing, or what the row itself shows where that is
    /// another level, as at the end of an object, where its brightness fades and the mean would shift the edge.
    fn departure(&self, off_q16: [i64; 2]) -> [i64; 2] {
        // Three sigma of a mean over four pixels: squares, in 1/2³² square grey level.
        let most_q32 = (i64::from(self.noise_q16) << 16) * 9 / 4;
        off_q16.map(|off_q16| if off_q16 * off_q16 > most_q32 { off_q16 >> 8 } else { 0 })
    }

    /// Whether many of the rows have texture beside the edge.
    const fn is_beside_texture(&self) -> bool {
        self.textured_rows >= FEW_TEXTURED_ROWS && self.textured_rows > self.rows / 4
    }

    /// Whether that is sure.
    pub(crate) const fn is_surely_beside_texture(&self) -> bool {
        self.textured_rows >= MANY_TEXTURED_ROWS && self.is_beside_texture()
    }

    /// Whether one of the rows' own levels has changed lately by more than noise explains.
    fn is_textured(&self) -> bool {
        self.level_scatter_q8.iter().any(|level_scatter| self.exceeds_noise(*level_scatter))
    }

    /// 0.4 sigma for a mean over four pixels is noise.
    fn exceeds_noise(&self, level_scatter_q8: u16) -> bool {
        u32::from(level_scatter_q8) * 4 > u32::from(self.white_q8) * 5
    }

    /// Running means: a small part of each new row, more at first.
    fn learn(&mut self, kind: usize, fit: &Fit) {
        self.rows = self.rows.saturating_add(1);
        let rows = i64::from(self.rows);
        // A few rows of something else are no texture.
        let most_q8 = 4 * i64::from(self.white_q8);
        let means_q16 = self.levels_q16.iter_mut().skip(kind).take(1).flatten();
        for ((mean_q16, level_scatter_q8), off_q16) in means_q16.zip(&mut self.level_scatter_q8).zip(fit.off_q16) {
            *level_scatter_q8 = toward(*level_scatter_q8, (off_q16.abs() >> 8).min(most_q8), rows.min(16));
            add(mean_q16, off_q16, rows.min(32));
        }
        self.textured_rows = self.textured_rows.saturating_add(u16::from(self.is_textured()));
        self.widen(fit.template_q12, rows.min(16));
        let noise = i64::from(self.noise_q16);
        let residual = fit.residual_q16.min(4 * noise + (1 << 16));
        self.noise_q16 = (noise + (residual - noise) / 16).clamp(i64::from(LEAST_NOISE_Q16), 1 << 31) as u32;
    }
}

/// Whether an edge of this contrast is of the usual kind: not so much weaker that it would only add noise, and at most twice
/// as strong.
fn is_alike(contrast_q8: i64, usual_q8: i64) -> bool {
    contrast_q8 * usual_q8.signum() * 3 >= usual_q8.abs() * 2 && contrast_q8.abs() <= 2 * usual_q8.abs()
}

/// One part of `parts` of the way to `to`.
fn toward(from: u16, to: i64, parts: i64) -> u16 {
    let value = i64::from(from);
    (value + (to - value) / parts.max(1)).clamp(0, i64::from(u16::MAX)) as u16
}

/// Adds one part of `parts` to a level, in 1/65536 grey level.
fn add(level_q16: &mut u32, off_q16: i64, parts: i64) {
    *level_q16 = (i64::from(*level_q16) + off_q16 / parts.max(1)).clamp(0, 255 << 16) as u32;
}

fn root(square: i64) -> i64 {
    (square.max(0) as u64).isqrt() as i64
}

#[cfg(test)]
mod tests {
    use super::{EdgeModel, Neighbours, PixelRow};
    use crate::sim::{Background, Bar, Exposure, Scene, Simulator};
    use crate::{Camera, Distortion, EdgePoint, Intrinsics, Line, Readout, Response, Scanner, Twist};

    fn row_of(pixels: &[u8]) -> PixelRow<'_, &[u8]> {
        PixelRow { pixels, response: &Response::Linear }
    }

    const ROWS: u16 = 240;
    const FOCAL_PX: f32 = 300.0;
    const SPEED_M_S: f32 = 1.5;
    /// Rows that may be refused while levels and blur settle.
    const SETTLING: u16 = 16;

    /// What came out of the rows of one edge.
    struct Outcome {
        mean_width_px: f64,
        /// Standard deviations of the rows' columns and widths, and what is stated for the column.
        column_px: f64,
        width_px: f64,
        stated_px: f64,
    }

    fn deviation(values: impl Iterator<Item = f64> + Clone) -> f64 {
        let count = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / count;
        libm::sqrt(values.map(|value| (value - mean) * (value - mean)).sum::<f64>() / (count - 1.0))
    }

    /// An edge 1 m away that a lens blurs and the exposure smears over `path_px`, row after row where it is.
    fn follow(lens_px: f32, path_px: f32, seed: u64) -> Outcome {
        let camera = Camera::new(Intrinsics::centred(320, ROWS, FOCAL_PX), Distortion::NONE).unwrap();
        let readout = Readout::from_frame_readout_ns(ROWS, 33_333_333, Default::default()).unwrap();
        let exposure = Exposure {
            time_s: path_px / (FOCAL_PX * SPEED_M_S),
            psf_sigma_px: lens_px,
            read_noise: 2.0,
            shot_gain: 0.03,
        };
        let mut scene = Scene::<1>::new(Background::plain(60.0)).unwrap();
        scene.push(Bar::upright(2.02, 1.0, 4.0, 170.0)).unwrap();
        let motion = Twist::level([SPEED_M_S, 0.0, 0.0]).unwrap();
        let simulator = Simulator::new(&scene, &camera, &readout, &motion, exposure, seed).unwrap();
        let column = |row| {
            let time_s = readout.row_time_ns(row) as f64 * 1e-9;
            159.5 + f64::from(FOCAL_PX) * (0.02 - f64::from(SPEED_M_S) * time_s)
        };
        let (mut scanner, mut pixels) = (Scanner::new(), [0; 320]);
        simulator.row(0, &mut pixels);
        let mut first = EdgePoint::new(0, 0, 0);
        scanner.scan(&pixels, |point| first = point.at(0, 0));
        let mut model = EdgeModel::settled(row_of(&pixels), &first, Neighbours::NONE, scanner.noise_q8()).unwrap();
        let mut line: Line<16> = Line::new(first);
        let mut found = [(0.0, 0.0, 0.0); ROWS as usize];
        for row in 1..ROWS {
            simulator.row(row, &mut pixels);
            let expected_q16 = (column(row) * 65536.0) as i64;
            let Some(point) = model.locate(row_of(&pixels), expected_q16, 1 << 17, 0, Neighbours::NONE) else {
                assert!(row < SETTLING, "lens {lens_px}, path {path_px}, seed {seed}: row {row}");
                continue;
            };
            let error_px = f64::from(point.column_q16) / 65536.0 - column(row);
            let sigma_px = f64::from(point.sigma_q16) / 65536.0;
            found[usize::from(row)] = (error_px, f64::from(point.width_q8) / 256.0, sigma_px);
            line.push(point.at(row, readout.row_time_ns(row))).unwrap();
        }
        // As the line's mean, which leaves out the rows in which the model settles.
        let settled = &found[SETTLING.into()..];
        Outcome {
            mean_width_px: line.mean_width_px().unwrap(),
            column_px: deviation(settled.iter().map(|row| row.0)),
            width_px: deviation(settled.iter().map(|row| row.1)),
            stated_px: settled.iter().map(|row| row.2).sum::<f64>() / settled.len() as f64,
        }
    }

    /// The width is a measurement of its own, whatever the lens and the motion: a line's mean over n rows has √n times less
    /// noise than each row's.
    #[test]
    fn widths_are_unbiased_and_as_noisy_as_stated() {
        const LINES: u8 = 12;
        // Half of the 2 % of its square that the range solver grants to the shape of a blur.
        const BIAS: f64 = 0.01;
        // Six sigma of a deviation from 12 lines of 224 rows: 1/√(2 · 12 · 224) each.
        const COLUMNS: core::ops::Range<f64> = 0.92..1.08;
        // A width has one to two times the noise of its column, as the range solver has it.
        const WIDTHS: core::ops::Range<f64> = 0.9..2.0;
        // Within three sigma of a deviation from 12 lines: 1/√(2 · 11) each.
        const MEANS: core::ops::Range<f64> = 0.4..1.5;
        for lens_px in [0.5, 0.7, 1.0] {
            for path_px in [0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 28.0] {
                let variance = lens_px * lens_px + (1.0 + path_px * path_px) / 12.0;
                let width_px = libm::sqrt(f64::from(variance));
                let lines = || (1..=LINES).map(|seed| follow(lens_px, path_px, seed.into()));
                let mean =
                    |value: fn(&Outcome) -> f64| lines().map(|line| value(&line)).sum::<f64>() / f64::from(LINES);
                let bias = mean(|line| line.mean_width_px) / width_px - 1.0;
                let column = mean(|line| line.column_px) / mean(|line| line.stated_px);
                let width = mean(|line| line.width_px) / mean(|line| line.stated_px);
                let means: heapless::Vec<f64, 12> = lines().map(|line| line.mean_width_px).collect();
                let rows = f64::from(ROWS - SETTLING);
                let line = deviation(means.into_iter()) * libm::sqrt(rows) / mean(|line| line.width_px);
                let of = format_args!("lens {lens_px}, path {path_px}");
                assert!(bias.abs() < BIAS, "{of}: bias {bias:+.4}");
                assert!(COLUMNS.contains(&column), "{of}: columns {column:.3} of their sigma");
                assert!(WIDTHS.contains(&width), "{of}: widths {width:.3} of the column's sigma");
                assert!(MEANS.contains(&line), "{of}: a line's width {line:.2} of what its rows' say");
            }
        }
    }
}
