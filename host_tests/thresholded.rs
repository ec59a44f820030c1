//! Frames of black and white: an edge is only known to a pixel, and advances in jumps of one.

use shutter_range::sim::{Background, Bar, Exposure, Scene, Truth};
use shutter_range::{Range, RangeStatus, Ranger, Uncertainty};

use crate::rendered::{Frame, ROWS, TOP, errors, moving, ranges_of, render};
use crate::scenes::{TENTH_DEGREE, tilt_of};

const SPEEDS_M_S: [f64; 4] = [-2.5, -0.8, 0.8, 2.5];
const LEVELS: [u8; 3] = [90, 120, 150];
const SEEDS: u64 = 6;

/// Three posts whose edges no two frames have at the same phases of the pixel.
pub(crate) fn posts(seed: u64) -> Scene<3> {
    let mut scene = Scene::new(Background::plain(180.0)).expect("a sound background");
    for (bearing, depth_m) in [(-0.3_f32, 1.5), (0.0, 2.4), (0.3, 1.0)] {
        let bearing = bearing + 0.0011 * seed as f32;
        scene.push(Bar::upright(bearing, depth_m, 0.08 * depth_m, 60.0)).expect("a sound post");
    }
    scene
}

pub(crate) fn black_and_white(frame: &Frame, level: u8) -> Frame {
    let of_pixel = |pixel: &u8| if *pixel > level { 255 } else { 0 };
    frame.iter().map(|row| row.iter().map(of_pixel).collect()).collect()
}

/// The ranges of a frame of black and white, and its edges.
fn found(speed_m_s: f64, level: u8, seed: u64, uncertainty: Uncertainty<f32>) -> (Vec<Range<f32>>, Vec<Truth>) {
    let world = moving(speed_m_s);
    let exposure = Exposure { psf_sigma_px: 0.7, ..Exposure::default() };
    let (frame, truths) = render(&posts(seed), &world, TOP, exposure, seed);
    let setup = world.setup_read(uncertainty, TOP);
    let ranges = ranges_of(&mut Ranger::<64, 16, 64>::new(), &setup, &world, &black_and_white(&frame, level));
    (ranges, truths)
}

fn all_frames() -> impl Iterator<Item = (f64, u8, u64)> {
    let of_speed = |speed_m_s| LEVELS.into_iter().map(move |level| (speed_m_s, level));
    SPEEDS_M_S
        .into_iter()
        .flat_map(of_speed)
        .flat_map(|(speed, level)| (1..=SEEDS).map(move |seed| (speed, level, seed)))
}

/// No upright piece of a staircase claims to be far.
#[test]
fn jumps_of_a_pixel_are_not_far() {
    let nearest_m = 2.5;
    let mut edges = 0;
    for (speed_m_s, level, seed) in all_frames() {
        let (ranges, truths) = found(speed_m_s, level, seed, tilt_of(TENTH_DEGREE));
        for range in ranges.iter().filter(|range| range.status == RangeStatus::Far) {
            let Range { estimate, .. } = range;
            let most_per_m = estimate.inverse_depth_per_m + 3.0 * estimate.sigma_inverse_depth_per_m;
            let name = format!("{speed_m_s} m/s, {level}, seed {seed}: nothing is beyond {nearest_m} m, but {range:?}");
            assert!(most_per_m > 1.0 / nearest_m, "{name}");
        }
        edges += truths.len();
    }
    assert_eq!(edges, 6 * all_frames().count());
}

/// Each edge is one line all along the frame, and right within its sigma.
#[test]
fn a_staircase_is_one_line() {
    let (mut right, mut edges, mut wrong) = (0, 0, 0);
    for (speed_m_s, level, seed) in all_frames() {
        let (ranges, truths) = found(speed_m_s, level, seed, Uncertainty::NONE);
        for truth in &truths {
            let is_it = |range: &&Range<f32>| {
                (f64::from(range.estimate.bearing) - truth.bearing).abs() < 0.01 && range.polarity == truth.polarity
            };
            let is_right = |range: &Range<f32>| errors(range, truth).1.abs() < 4.0;
            let mut ok = ranges.iter().filter(is_it).filter(|range| range.status == RangeStatus::Ok);
            right += usize::from(ok.clone().any(|range| range.points > ROWS * 9 / 10 && is_right(range)));
            wrong += usize::from(ok.any(|range| !is_right(range)));
        }
        edges += truths.len();
    }
    println!("{right} of {edges} right, {wrong} wrong");
    assert!(right * 100 >= edges * 95 && wrong == 0, "{right} of {edges} right, {wrong} wrong");
}
