//! Overshoot beside an edge, the mark of sharpening. docs/model.md, section 5.4.

use super::model::EdgeModel;
use super::phase::{Phase, Sampled};
use super::pixel_row::{PixelRow, Stretch};
use super::refine::LocatedPoint;
use crate::format::Pixels;

/// What a blur that is wider by a pixel adds to the sum of both feet, in 1/256 of the contrast: 2 φ(z) where Φ(z) =
/// 15/16.
const FEET_PER_WIDTH_Q8: i32 = 62;

/// A row counts at most one of so many parts of the contrast, which is three sigma of the noise of usual ones and the
/// halo of strong sharpening (`tests::the_end_of_an_object_is_no_halo`).
const MOST_PARTS: i32 = 4;

impl EdgeModel {
    /// How far the feet of the flank lie beyond what a blurred step of this width shows there, away from the other
    /// level: the sum over the pixels of a side, as a mean of both, in quarters of a grey level. `None` where the flank is
    /// not all in the row, is one of a mosaic, has no width, or has levels that change from row to row.
    #[inline(never)] // all of it then fits into the registers
    pub(crate) fn overshoot<P: Pixels>(&self, row: &PixelRow<'_, P>, found: &LocatedPoint) -> Option<i16> {
        let &LocatedPoint { column_q16, width_q8, .. } = found;
        if width_q8 == 0 || row.colours() > 1 || self.is_textured() {
            return None;
        }
        let Sampled { first, phase, .. } = self.template().at(column_q16 >> 8);
        let from = usize::try_from(first).ok()?;
        let flank = Stretch { from, to: from + phase.weights.len() };
        if let Some(bytes) = row.quick_bytes() {
            return self.overshoot_of_bytes(bytes.get(flank.from..flank.to)?, phase, width_q8);
        }
        self.overshoot_of_light(row, found, flank, phase)
    }

    /// Likewise of a flank at a phase near its column, given as grey bytes that may go on behind it.
    #[inline(always)]
    pub(super) fn overshoot_of_bytes(&self, bytes: &[u8], phase: &Phase, width_q8: u16) -> Option<i16> {
        // Those of sharp edges have one pixel or two.
        let sum_q6 = |pixels: &[u8]| match *pixels {
            [one] => i32::from(one) << 6,
            [one, other] => (i32::from(one) + i32::from(other)) << 6,
            _ => pixels.iter().fold(0, |sum, pixel| sum + i32::from(*pixel)) << 6,
        };
        let (end, feet) = (phase.weights.len(), phase.feet);
        let (left, right) = (bytes.get(..feet.left())?, bytes.get(end.checked_sub(feet.right())?..end)?);
        Some((self.beyond_q6(0, phase, [sum_q6(left), sum_q6(right)], width_q8) >> 5) as i16)
    }

    /// Likewise where the light is no grey bytes.
    #[inline(never)]
    fn overshoot_of_light<P: Pixels>(
        &self,
        row: &PixelRow<'_, P>,
        found: &LocatedPoint,
        flank: Stretch,
        phase: &Phase,
    ) -> Option<i16> {
        let Stretch { from, to } = flank;
        if to > row.columns() as usize {
            return None;
        }
        let light_q6 = |from: usize, to: usize| (row.sum_q8(Stretch { from, to }) >> 2) as i32;
        let feet_q6 = [light_q6(from, from + phase.feet.left()), light_q6(to - phase.feet.right(), to)];
        let beyond_q6 = self.beyond_q6(row.kind(), phase, feet_q6, found.width_q8);
        if row.response.is_identity() {
            return Some((beyond_q6 >> 5) as i16);
        }
        // What is light here is told in the grey levels in which all else beside an edge is.
        let grey_q6 = i32::from(row.step_at((found.column_q16 >> 16) + 1)?).abs() << 4;
        let grey_q6 = (beyond_q6 * grey_q6).checked_div(self.contrast_q8(row.kind()).abs() >> 2).unwrap_or(0);
        Some((grey_q6 >> 5) as i16)
    }

    /// Likewise for both sides together, in 1/64 of a level, from the sums over their pixels.
    #[inline(always)]
    fn beyond_q6(&self, kind: usize, phase: &Phase, feet_q6: [i32; 2], width_q8: u16) -> i32 {
        let levels_q6 = self.levels_q8(kind).map(|level_q8| level_q8 >> 2);
        let [left_q6, right_q6] = levels_q6;
        let contrast_q6 = right_q6 - left_q6;
        let wider_q8 = i32::from(width_q8) - i32::from(self.template().width_q8);
        let of_width_q6 = ((contrast_q6 >> 2) * wider_q8 * FEET_PER_WIDTH_Q8) >> 14;
        // The phase is off by as much to one side as to the other in the mean of some rows.
        let toward_right_q6 = phase.feet.beyond(feet_q6, levels_q6) + of_width_q6;
        let away_q6 = if contrast_q6 < 0 { -toward_right_q6 } else { toward_right_q6 };
        // Where an object ends it is another level that is off, by far more.
        let most_q6 = contrast_q6.abs() / MOST_PARTS;
        // No `clamp`: that would panic where its bounds were out of order.
        away_q6.max(-most_q6).min(most_q6)
    }
}

/// Rendered edges, sharpened or not.
#[cfg(test)]
mod tests {
    use super::{EdgeModel, LocatedPoint, PixelRow};
    use crate::edge::Neighbours;
    use crate::sim::{Background, Bar, Exposure, Pipeline, Scene, Simulator, Stage};
    use crate::{Camera, Distortion, EdgePoint, Intrinsics, Polarity, Readout, Response, Scanner, Twist};

    const ROWS: u16 = 240;
    const COLUMNS: usize = 320;
    const FOCAL_PX: f32 = 300.0;
    const SPEED_M_S: f32 = 1.5;
    /// Rows in which levels and blur settle.
    const SETTLING: u16 = 40;

    fn row_of(pixels: &[u8]) -> PixelRow<'_, &[u8]> {
        PixelRow { pixels, response: &Response::Linear }
    }

    fn located(at: &EdgePoint) -> LocatedPoint {
        let &EdgePoint { column_q16, sigma_q16, width_q8, .. } = at;
        LocatedPoint { column_q16, sigma_q16, width_q8 }
    }

    /// Mean overshoot on both sides, in contrasts times a pixel, of an edge 1 m away that a lens of 0.7 px blurs and the
    /// exposure smears over `path_px`.
    fn overshoot<const N: usize>(stages: [Stage; N], path_px: f32) -> f64 {
        let camera = Camera::new(Intrinsics::centred(COLUMNS as u16, ROWS, FOCAL_PX), Distortion::NONE).unwrap();
        let readout = Readout::from_frame_readout_ns(ROWS, 33_333_333, Default::default()).unwrap();
        let time_s = path_px / (FOCAL_PX * SPEED_M_S);
        let exposure = Exposure { time_s, psf_sigma_px: 0.7, read_noise: 2.0, shot_gain: 0.0 };
        let mut scene = Scene::<1>::new(Background::plain(60.0)).unwrap();
        scene.push(Bar::upright(2.02, 1.0, 4.0, 170.0)).unwrap();
        let motion = Twist::level([SPEED_M_S, 0.0, 0.0]).unwrap();
        let simulator = Simulator::new(&scene, &camera, &readout, &motion, exposure, 1).unwrap();
        let mut pipeline = Pipeline::<COLUMNS, N>::new(stages).unwrap();
        let (mut scanner, mut row, mut sum, mut count) = (Scanner::new(), 0, 0.0, 0.0);
        let mut model: Option<EdgeModel> = None;
        let mut take = |pixels: &[u8; COLUMNS]| {
            let time_s = readout.row_time_ns(row) as f64 * 1e-9;
            let column_px = 159.5 + f64::from(FOCAL_PX) * (0.02 - f64::from(SPEED_M_S) * time_s);
            let expected_q16 = (column_px * 65536.0) as i32;
            if let Some(model) = &mut model {
                let found = model.locate(row_of(pixels), expected_q16, 1 << 17, 0, Neighbours::NONE);
                if let Some(found) = found.filter(|_| row >= SETTLING) {
                    // Of 110 levels in quarters.
                    sum += f64::from(model.overshoot(&row_of(pixels), &found).unwrap()) / 440.0;
                    count += 1.0;
                }
            } else {
                let mut first = EdgePoint::new(0, 0, 0);
                scanner.scan(&pixels[..], |point| first = point.at(0, 0));
                model = EdgeModel::settled(row_of(pixels), &first, Neighbours::NONE, scanner.noise_q8());
            }
            row += 1;
        };
        for row in 0..ROWS {
            let mut levels = [0; COLUMNS];
            simulator.row_q8(row, &mut levels);
            pipeline.row(&levels, &mut take);
        }
        pipeline.end_frame(&mut take);
        sum / count
    }

    /// Whatever the blur, by half of what an unsharp mask over three pixels leaves at its full strength.
    #[test]
    fn sharpening_overshoots() {
        for path_px in [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0] {
            let (plain, half) = (overshoot([], path_px), overshoot([Stage::Sharpen3(0.5)], path_px));
            let (one, wider) = (overshoot([Stage::Sharpen3(1.0)], path_px), overshoot([Stage::Sharpen5(1.0)], path_px));
            std::println!("path {path_px} px: {plain:.4}, 3x3 {half:.4} {one:.4}, 5x5 {wider:.4}");
            assert!(plain.abs() < 0.004, "path {path_px}");
            assert!(half > plain + 0.004 && one > plain + 0.01 && wider > plain + 0.035, "path {path_px}");
        }
    }

    /// There the level is another one.
    #[test]
    fn the_end_of_an_object_is_no_halo() {
        let step = |right: u8| {
            let mut pixels = [60; 64];
            pixels[32..].fill(right);
            pixels[31] = 70;
            pixels[32] = right - 10;
            pixels
        };
        let (first, end) = (step(170), step(120));
        let at = EdgePoint { width_q8: 160, ..EdgePoint::new(0, 63 << 15, 0) }.with_polarity(Polarity::Rising);
        let model = EdgeModel::settled(row_of(&first), &at, Neighbours::NONE, 100).unwrap();
        let overshoot = model.overshoot(&row_of(&end), &located(&at)).unwrap();
        assert!((-56..-50).contains(&overshoot), "{overshoot}");
    }

    /// As much of the contrast in grey levels as in light, however the levels follow it.
    #[test]
    fn a_curve_is_no_halo_of_its_own() {
        let share = |response: &Response| {
            let mut pixels = [20; 64];
            pixels[32..].fill(60);
            (pixels[31], pixels[32]) = (25, 55);
            let mut sharpened = pixels;
            (sharpened[30], sharpened[33]) = (18, 62);
            let [plain, sharpened] = [&pixels, &sharpened].map(|pixels| PixelRow { pixels: &pixels[..], response });
            let at = EdgePoint { width_q8: 160, ..EdgePoint::new(0, 63 << 15, 0) }.with_polarity(Polarity::Rising);
            let model = EdgeModel::settled(plain, &at, Neighbours::NONE, 100).unwrap();
            let [plain, sharpened] = [plain, sharpened].map(|row| model.overshoot(&row, &located(&at)).unwrap());
            i32::from(sharpened - plain)
        };
        let (linear, curved) = (share(&Response::Linear), share(&Response::Srgb));
        assert!(linear > 5 && (2 * linear / 3..=3 * linear / 2).contains(&curved), "{linear}, {curved}");
    }
}
