//! The maximum-likelihood column of an edge: where its model fits the pixels of a row best. Its noise is the Cramér–Rao bound.
//!
//! A row on its own locates an edge with the noise of all pixels around it. Where a line predicts the column, and its rows
//! so far tell both levels and the blur, the best fit is a step or a few from the prediction.

use super::fit::Fit;
use super::model::EdgeModel;
use super::pixel_row::PixelRow;
use super::point::EdgePoint;
use super::scan::{ScannedPoint, Scanner};
use super::tuning::{
    LEAST_APART_Q16, LONG_BLUR_Q8, MOST_CORRECTIONS, MOST_DRAWN_Q16, MOST_RESIDUAL, MOST_SETTLING_STEPS, SURE_SIGMA_Q16,
};
use super::window::Neighbours;
use crate::format::Pixels;

impl EdgeModel {
    /// The model of an edge that a row shows, with levels and blur found each from the other: a long blur's width is only guessed at
    /// first, and noise may have broken it into pieces.
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
            let fit = model.fit(row, column_q16, bounds_q8)?;
            let (blur_q12, blur_q16) = (model.blur_q12, i32::from(model.blur_q12) << 4);
            let shift_q16 = fit.column_q16.saturating_sub(column_q16);
            column_q16 += shift_q16.clamp(-blur_q16, blur_q16);
            model.widen(fit.width_q12, 0);
            model.look_beside(row, column_q16, bounds_q8)?;
            if model.blur_q12.abs_diff(blur_q12) < blur_q12 / 16 && shift_q16.abs() < blur_q16 / 16 {
                break;
            }
        }
        model.shows(row.kind(), edge.polarity).then_some(model)
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
    /// is farther off than the gate, or than its noise and the bias that the expected column itself may have.
    pub(crate) fn locate<P: Pixels>(
        &mut self,
        row: PixelRow<'_, P>,
        expected_q16: i64,
        gate_q16: i64,
        drawn_q16: i64,
        around: Neighbours,
    ) -> Option<ScannedPoint> {
        let (expected_q16, bounds_q8) = (i32::try_from(expected_q16).ok()?, around.bounds_q8());
        if !self.knows(row, expected_q16, bounds_q8) {
            return None;
        }
        let fit = self.approach(row, expected_q16, bounds_q8)?;
        let blur_q16 = i32::from(self.blur_q12) << 4;
        let gate_q16 = gate_q16.min(i64::from(4 * fit.sigma_q16 + blur_q16 / 4).max(drawn_q16));
        let off_q16 = fit.column_q16.abs_diff(expected_q16);
        if i64::from(off_q16) > gate_q16 || fit.residual_q16 as u32 > self.most_residual_q16() {
            return None;
        }
        let width_q8 = self.row_width_q8(row.kind(), &fit);
        self.learn(row.kind(), &fit);
        Some(ScannedPoint {
            column_q16: fit.column_q16,
            sigma_q16: fit.sigma_q16.max(1) as u32,
            width_q8,
            contrast: i16::try_from(self.contrast_q8(row.kind()) >> 8).ok()?,
        })
    }

    /// The row's own width, so that the line's mean settles like any mean; beside texture it can be anything.
    fn row_width_q8(&self, kind: usize, fit: &Fit) -> u16 {
        let half_q8 = i32::from(self.blur_q8() / 2);
        if self.is_clipped(kind) { 0 } else { (fit.width_q12 >> 4).clamp(half_q8, 3 * half_q8) as u16 }
    }

    /// What remains at most of a row that shows the edge, and the square of two levels for what no step has.
    fn most_residual_q16(&self) -> u32 {
        self.noise_q16.saturating_mul(MOST_RESIDUAL).saturating_add(1 << 18)
    }

    /// Steps to where the edge is. What is found must not depend on what was expected, or a line would go on where it once went
    /// astray: another step where the one before was large.
    fn approach<P: Pixels>(&self, row: PixelRow<'_, P>, expected_q16: i32, bounds_q8: (i32, i32)) -> Option<Fit> {
        let blur_q16 = i32::from(self.blur_q12) << 4;
        let mut fit = self.fit(row, expected_q16, bounds_q8)?;
        let mut from_q16 = expected_q16;
        for _ in 0..MOST_CORRECTIONS {
            let shift_q16 = fit.column_q16.saturating_sub(from_q16);
            if shift_q16.abs() <= blur_q16 / 8 {
                break;
            }
            from_q16 += shift_q16.clamp(-blur_q16, blur_q16);
            fit = self.fit(row, from_q16, bounds_q8)?;
        }
        Some(fit)
    }
}
