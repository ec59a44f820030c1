//! Overshoot beside an edge, the mark of sharpening. docs/model.md, section 5.4.

use super::model::EdgeModel;
use super::pixel_row::{PixelRow, Stretch};
use super::point::EdgePoint;
use super::template::Sampled;
use crate::format::Pixels;

/// The feet of a flank, in 1/32768: pixels in which the step is less than a sixteenth off either level. There
/// sharpening shows most beside what another column or width would do (`tests::sharpening_overshoots`).
const FOOT: i32 = 1 << 11;

/// What a blur that is wider by a pixel adds to the sum of a foot, in 1/256 of the contrast: φ(z) where Φ(z) = 15/16.
const FOOT_PER_WIDTH_Q8: i32 = 31;

/// A row counts at most one of so many parts of the contrast, which is three sigma of the noise of usual ones and the
/// halo of strong sharpening (`tests::the_end_of_an_object_is_no_halo`).
const MOST_PARTS: i32 = 8;

/// The pixels of a flank at one of its ends, and the sum of what the step is off the level there, in 1/32768.
struct Foot {
    pixels: usize,
    off: i32,
}

impl Foot {
    /// Of what the step is off the level in each pixel, from the end of the flank on.
    #[inline(always)]
    fn of(each_off: impl Iterator<Item = i32>) -> Self {
        let none = Self { pixels: 0, off: 0 };
        let add = |foot: Self, off: i32| Self { pixels: foot.pixels + 1, off: foot.off + off };
        each_off.take_while(|off| *off < FOOT).fold(none, add)
    }

    /// The sum of what they should show, given the level and the contrast from there on.
    const fn expected(&self, level_q6: i32, contrast_q6: i32) -> i32 {
        self.pixels as i32 * level_q6 + ((contrast_q6 * self.off) >> 15)
    }
}

impl EdgeModel {
    /// How far the feet of the flank lie beyond what a blurred step of the point's width shows there, away from the
    /// other level: sums over the pixels on the left and on the right, in quarters of a grey level. `None` where the
    /// flank is not all in the row, is one of a mosaic, or has no width.
    pub(crate) fn overshoot<P: Pixels>(&self, row: PixelRow<'_, P>, point: &EdgePoint) -> Option<[i16; 2]> {
        let template = self.template();
        let Sampled { first, phase, .. } = template.at(point.column_q16 >> 8);
        let from = usize::try_from(first).ok()?;
        let to = from + phase.weights.len();
        if to > row.columns() as usize || row.colours() > 1 || point.width_q8 == 0 {
            return None;
        }
        let [left_q6, right_q6] = self.levels_q8(row.kind()).map(|level_q8| level_q8 >> 2);
        let contrast_q6 = right_q6 - left_q6;
        let on_left = Foot::of(phase.weights.iter().map(|weight| i32::from(weight.step)));
        let on_right = Foot::of(phase.weights.iter().rev().map(|weight| (1 << 15) - i32::from(weight.step)));
        let light_q6 = |from: usize, to: usize| (row.sum_q8(Stretch { from, to }) >> 2) as i32;
        let left = on_left.expected(left_q6, contrast_q6) - light_q6(from, from + on_left.pixels);
        let right = light_q6(to - on_right.pixels, to) - on_right.expected(right_q6, -contrast_q6);
        let wider_q8 = i32::from(point.width_q8) - i32::from(template.width_q8);
        // The phase is off by as much to one side as to the other in the mean of some rows.
        let of_width_q6 = ((contrast_q6 >> 2) * wider_q8 * FOOT_PER_WIDTH_Q8) >> 14;
        // Where an object ends it is another level that is off, by far more.
        let most_q6 = contrast_q6.abs() / MOST_PARTS;
        // What is light here is told in the grey levels in which all else beside an edge is.
        let is_grey = row.response.is_identity();
        let grey_q6 = if is_grey { contrast_q6.abs() } else { i32::from(row.step_at(point.boundary())?).abs() << 4 };
        let in_grey = |q6: i32| if is_grey { q6 } else { (q6 * grey_q6).checked_div(contrast_q6.abs()).unwrap_or(0) };
        let beyond = |foot_q6: i32| {
            let away_q6 = if contrast_q6 < 0 { -foot_q6 - of_width_q6 } else { foot_q6 + of_width_q6 };
            // No `clamp`: that would panic where its bounds were out of order.
            (in_grey(away_q6.max(-most_q6).min(most_q6)) >> 4) as i16
        };
        Some([left, right].map(beyond))
    }
}

/// Rendered edges, sharpened or not.
#[cfg(test)]
mod tests {
    use super::{EdgeModel, PixelRow};
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
                    let point = EdgePoint { width_q8: found.width_q8, ..EdgePoint::new(row, found.column_q16, 0) };
                    let [left, right] = model.overshoot(row_of(pixels), &point).unwrap();
                    // Of 110 levels in quarters.
                    sum += f64::from(left + right) / (2.0 * 440.0);
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
        let [left, right] = model.overshoot(row_of(&end), &at).unwrap();
        assert!((-56..=56).contains(&left) && (-56..-50).contains(&right), "{left}, {right}");
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
            let [plain, sharpened] = [plain, sharpened].map(|row| model.overshoot(row, &at).unwrap());
            i32::from(sharpened[0] + sharpened[1] - plain[0] - plain[1])
        };
        let (linear, curved) = (share(&Response::Linear), share(&Response::Srgb));
        assert!(linear > 10 && (2 * linear / 3..=3 * linear / 2).contains(&curved), "{linear}, {curved}");
    }
}
