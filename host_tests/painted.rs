//! A pole painted in bands that are brighter and darker than what is behind it: the polarity of its sides changes from band
//! to band, and each side is one line.

use shutter_range::sim::{Background, Bar, Exposure, Scene};
use shutter_range::{Polarity, RangeStatus, Ranger, Uncertainty};

use crate::rendered::{MOST_SIGMAS, TOP, moving, ranges_of, render};

const FOCAL_PX: f32 = 300.0;
const ROWS: f32 = 240.0;
const EXPOSURE: Exposure = Exposure { time_s: 0.002, psf_sigma_px: 0.7, read_noise: 2.0, shot_gain: 0.03 };
const BEHIND: f32 = 110.0;

/// A pole 15 px wide and a metre away, as high as the frame, in bands of so many rows.
fn pole(band_rows: f32, levels: [f32; 2]) -> Scene<32> {
    let mut scene = Scene::new(Background::plain(BEHIND)).expect("sound background");
    let pole = |level| Bar::upright(0.08, 1.0, 15.0 / FOCAL_PX, level);
    for (band, level) in (0..(ROWS / band_rows).ceil() as u8 + 1).zip(levels.into_iter().cycle()) {
        let top_m = (f32::from(band) * band_rows - ROWS / 2.0) / FOCAL_PX;
        scene.push(pole(level).between(top_m, top_m + band_rows / FOCAL_PX)).expect("a sound band");
    }
    scene
}

#[test]
fn each_side_of_a_painted_pole_is_one_line() {
    let world = moving(1.5);
    let setup = world.setup_read::<f64>(Uncertainty::NONE, TOP);
    for band_rows in [16.0, 24.0, 40.0, 80.0] {
        for (levels, top) in [([200.0, 45.0], Polarity::Rising), ([60.0, 150.0], Polarity::Falling)] {
            let (frame, _) = render(&pole(band_rows, levels), &world, TOP, EXPOSURE, 1);
            let found = ranges_of(&mut Ranger::<16, 16, 64>::new(), &setup, &world, &frame);
            let name = format!("bands of {band_rows} rows, {levels:?}");
            let [left, right] = &found[..] else { panic!("{name}: {} lines: {found:#?}", found.len()) };
            assert!(left.polarity == top && right.polarity != top, "{name}: {left:?}");
            for side in [left, right] {
                let off_per_m = side.estimate.inverse_depth_per_m - 1.0;
                let is_whole = side.first_row <= 2 && side.last_row >= 237 && side.points >= 220;
                let is_right = off_per_m.abs() < (MOST_SIGMAS * side.estimate.sigma_inverse_depth_per_m).min(0.01);
                assert!(side.status == RangeStatus::Ok && is_whole && is_right, "{name}: {side:?}");
            }
        }
    }
}
