//! The maximum-likelihood column of an edge: where its model fits the pixels of a row best. Its noise is the Cramér–Rao
//! bound.
//!
//! A row on its own locates an edge with the noise of all pixels around it. Where a line predicts the column, and its
//! rows so far tell both levels and the blur, the best fit is a step or a few from the prediction.

use super::model::{EdgeModel, Fit};
use super::pixel_row::PixelRow;
use super::point::EdgePoint;
use super::scan::Scanner;
use super::tuning::{
    LEAST_APART_Q16, LONG_BLUR_Q8, MOST_CORRECTIONS, MOST_DRAWN_Q16, MOST_RESIDUAL, MOST_SETTLING_STEPS, SURE_SIGMA_Q16,
};
use super::whole_window::WholeWindow;
use super::window::Neighbours;
use crate::format::Pixels;

/// What a row says of a tracked edge: its column with one sigma, in 1/65536 px, and its width in 1/256 px.
pub(crate) struct LocatedPoint {
    pub(crate) column_q16: i32,
    pub(crate) sigma_q16: u32,
    pub(crate) width_q8: u16,
}

impl EdgeModel {
    /// The model of an edge that a row shows, with levels and blur found each from the other: a long blur's width is
    /// only guessed at first, and noise may have broken it into pieces.
    pub(crate) fn settled<P: Pixels>(
        row: PixelRow<'_, P>,
        edge: &EdgePoint,
        around: Neighbours,
        noise_q8: u32,
    ) -> Option<Self> {
        let bounds_q8 = around.bounds_q8();
        let mut model = Self::new(row, edge, bounds_q8, noise_q8)?;
        let mut column_q16 = edge.column_q16;
        for _ in 0..MOST_SETTLING_STEPS {
            let fit = model.fit(row, column_q16, bounds_q8, false)?;
            let (blur_q12, blur_q16) = (model.blur_q12, i32::from(model.blur_q12) << 4);
            let shift_q16 = fit.column_q16.saturating_sub(column_q16);
            column_q16 += shift_q16.clamp(-blur_q16, blur_q16);
            model.widen(fit.width_q12);
            model.look_beside(row, column_q16, bounds_q8)?;
            if model.blur_q12.abs_diff(blur_q12) < blur_q12 / 16 && shift_q16.saturating_abs() < blur_q16 / 16 {
                break;
            }
        }
        model.shows(row.kind(), edge.polarity).then_some(model)
    }

    /// Whether no more remains of a row than noise explains.
    pub(crate) fn explains<P: Pixels>(&self, row: PixelRow<'_, P>, column_q16: i32, around: Neighbours) -> bool {
        let fit = self.fit(row, column_q16, around.bounds_q8(), true);
        fit.is_some_and(|fit| fit.residual_q16 <= self.most_residual_q16())
    }

    /// An edge that a row shows on its own, located with the levels and the blur that it shows itself.
    pub(crate) fn refine_alone<P: Pixels>(
        row: PixelRow<'_, P>,
        edge: &EdgePoint,
        around: Neighbours,
        noise_q8: u32,
    ) -> Option<EdgePoint> {
        let mut model = if edge.width_q8 > LONG_BLUR_Q8 {
            Self::settled(row, edge, around, noise_q8)?
        } else {
            Self::new(row, edge, around.bounds_q8(), noise_q8)?
        };
        let is_drawn = around.is_nearer_than(Scanner::SEES_ALONE_Q16, edge.column_q16);
        let drawn_q16 = if is_drawn { MOST_DRAWN_Q16 } else { 0 };
        let found = model.locate(row, edge.column_q16, u16::MAX.into(), drawn_q16, around)?;
        let is_sure = found.sigma_q16 < SURE_SIGMA_Q16;
        if is_drawn && is_sure && around.is_nearer_than(LEAST_APART_Q16, found.column_q16) {
            return None;
        }
        let sigma_q16 = found.sigma_q16 + found.sigma_q16 / 4;
        Some(EdgePoint { column_q16: found.column_q16, sigma_q16, width_q8: found.width_q8, ..*edge })
    }

    /// The edge near the expected column, from which the model learns; `None` where the row shows something else, or
    /// where the edge is farther off than the gate, or than its noise and the bias that the expected column itself may
    /// have.
    #[inline(never)]
    pub(crate) fn locate<P: Pixels>(
        &mut self,
        row: PixelRow<'_, P>,
        expected_q16: i32,
        gate_q16: u32,
        drawn_q16: u32,
        around: Neighbours,
    ) -> Option<LocatedPoint> {
        let bounds_q8 = around.bounds_q8();
        if !self.knows(row, expected_q16, bounds_q8) {
            return None;
        }
        let fit = self.approach(row, expected_q16, bounds_q8)?;
        let noise_q16 = self.most_moved_q16(fit.sigma_q16);
        let is_within = fit.column_q16.abs_diff(expected_q16) <= gate_q16.min(noise_q16.max(drawn_q16));
        if !is_within || fit.residual_q16 > self.most_residual_q16() {
            return None;
        }
        let width_q8 = if self.is_clipped(row.kind()) { 0 } else { self.width_near_q8(fit.width_q12) };
        if self.learns_next() {
            self.learn(row.kind(), &fit);
        }
        self.count_row();
        Some(LocatedPoint { column_q16: fit.column_q16, sigma_q16: fit.sigma_q16.max(1), width_q8 })
    }

    /// The row's own width, so that the line's mean settles like any mean; beside texture it can be anything.
    pub(super) fn width_near_q8(&self, width_q12: i32) -> u16 {
        let half_q8 = i32::from(self.blur_q8() / 2);
        (width_q12 >> 4).clamp(half_q8, 3 * half_q8) as u16
    }

    /// What remains at most of a row that shows the edge, and the square of two levels for what no step has.
    pub(super) fn most_residual_q16(&self) -> u32 {
        self.noise_q16 * MOST_RESIDUAL + (1 << 18)
    }

    /// Fits column, width and levels of the edge near the expected column. Where its window may be cut off, or there is
    /// texture beside it, what remains of a row of bytes is measured only if that is asked for.
    fn fit<P: Pixels>(
        &self,
        row: PixelRow<'_, P>,
        expected_q16: i32,
        bounds_q8: (i32, i32),
        is_measured: bool,
    ) -> Option<Fit> {
        let column_q8 = expected_q16 >> 8;
        let Some(bytes) = row.quick_bytes() else { return self.fit_in_window(row, column_q8, bounds_q8) };
        if !self.is_textured()
            && let Some(window) = WholeWindow::new(bytes, column_q8, self.template(), bounds_q8)
        {
            return self.fit_whole(&window);
        }
        self.quick_fit(bytes, column_q8, bounds_q8, is_measured)
    }

    /// Steps to where the edge is. What is found must not depend on what was expected, or a line would go on where it
    /// once went astray: another step where the one before was large.
    fn approach<P: Pixels>(&self, row: PixelRow<'_, P>, expected_q16: i32, bounds_q8: (i32, i32)) -> Option<Fit> {
        let blur_q16 = self.blur_q16() as i32;
        let (mut from_q16, mut corrections) = (expected_q16, 0);
        let is_measured = self.learns_next();
        loop {
            let fit = self.fit(row, from_q16, bounds_q8, is_measured)?;
            let shift_q16 = fit.column_q16.saturating_sub(from_q16);
            // Texture is no noise.
            let sigma_q16 = if self.is_textured() { 0 } else { fit.sigma_q16 };
            let is_there = shift_q16.unsigned_abs() <= self.one_step_q16(sigma_q16);
            if is_there || corrections == MOST_CORRECTIONS {
                return Some(fit);
            }
            from_q16 += shift_q16.clamp(-blur_q16, blur_q16);
            corrections += 1;
        }
    }
}

/// A tracked edge against rendered rows: column, width, and what is stated of them.
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
            let expected_q16 = (column(row) * 65536.0) as i32;
            let Some(point) = model.locate(row_of(&pixels), expected_q16, 1 << 17, 0, Neighbours::NONE) else {
                assert!(row < SETTLING, "lens {lens_px}, path {path_px}, seed {seed}: row {row}");
                continue;
            };
            let error_px = f64::from(point.column_q16) / 65536.0 - column(row);
            let sigma_px = f64::from(point.sigma_q16) / 65536.0;
            found[usize::from(row)] = (error_px, f64::from(point.width_q8) / 256.0, sigma_px);
            let at = EdgePoint::new(row, point.column_q16, readout.row_time_ns(row));
            line.push(EdgePoint { sigma_q16: point.sigma_q16, width_q8: point.width_q8, ..at }).unwrap();
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

    /// The width is a measurement of its own, whatever the lens and the motion: a line's mean over n rows has √n times
    /// less noise than each row's.
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
