//! Frames as cameras deliver them and edges as the world has them: how many edges are found, and whether two sigma
//! hold.
//!
//! Of an honest sigma 95.4 % of the errors lie inside two of it, and the RMS of error over sigma is 1. By chance alone
//! sixty frames of four posts, 480 edges, differ from that by 1.0 % and 0.03, forty frames by 1.2 % and 0.04 (one
//! standard deviation): the bounds are three of them away. Each test prints its scores (`-- --nocapture`).

use std::sync::OnceLock;

use shutter_range::sim::{Stage, ToneCurve};
use shutter_range::{MotionBlur, RangeStatus, Response, Setup, Uncertainty};

use crate::drawn::{COLUMNS, Frame, Kind, Shot, large_ranger};
use crate::scenes::TENTH_DEGREE;
use crate::score::{Asked, Outcome, Score, rms};

/// Of posts with a quirk of their own, and of those that all cameras see.
const FRAMES: u64 = 60;
const FRAMES_OF_CAMERAS: u64 = 40;

fn shots(kind: &Kind, frames: u64) -> Vec<Shot> {
    (0..frames).map(|seed| Shot::new(kind, seed)).collect()
}

/// Each frame ranged by its own setup.
fn score(shots: &[Shot], frame: impl Fn(&Shot) -> Frame, setup: impl Fn(&Shot) -> Setup<f64>) -> Score {
    let frames: Vec<_> = shots.iter().map(frame).collect();
    score_of(shots, &frames, setup)
}

fn score_of(shots: &[Shot], frames: &[Frame], setup: impl Fn(&Shot) -> Setup<f64>) -> Score {
    let mut ranger = large_ranger();
    let mut score = Score::default();
    for (shot, frame) in shots.iter().zip(frames) {
        score.add(shot, &shot.ranges(&mut ranger, &setup(shot), frame));
    }
    score
}

/// Nothing but roughness is uncertain, and that only as far as it is by default.
fn roughness_unstated() -> Uncertainty<f64> {
    Uncertainty::NONE.with_edge_roughness_px(Uncertainty::<f64>::default().edge_roughness_px)
}

/// The same and a lean.
fn leaning(sigma_tilt: f64) -> Uncertainty<f64> {
    roughness_unstated().with_sigma_tilt(sigma_tilt)
}

fn with_exposure(shot: &Shot, uncertainty: Uncertainty<f64>) -> Setup<f64> {
    shot.setup(uncertainty).with_motion_blur(MotionBlur::from_exposure(shot.exposure_s)).expect("sound blur")
}

fn assert_none(breaches: Vec<String>) {
    assert!(breaches.is_empty(), "{breaches:#?}");
}

fn judge_ratio(name: &str, ratio: f64, most: f64) -> Vec<String> {
    println!("{name:<44} {ratio:.3}");
    if ratio <= most { vec![] } else { vec![format!("{name}: {ratio:.3}")] }
}

/// Straight upright edges, linear pixels, a roughness of zero: as good as before anything was done about the rest.
#[test]
fn clean_frames() {
    let shots = shots(&Kind::STRAIGHT, FRAMES);
    let score = score(&shots, |shot| shot.through([]), |shot| with_exposure(shot, Uncertainty::NONE));
    let mut breaches = score.judge("clean", Asked { found: 1.0, inside: 0.93 });
    breaches.extend(Score::judge_row("clean", std::slice::from_ref(&score)));
    let bounds = shots.iter().flat_map(|shot| shot.edges.iter().map(|edge| shot.bound(edge)));
    let over_bound = |(outcome, bound): (&Option<_>, f64)| outcome.map(|outcome: Outcome| outcome.relative / bound);
    let over_bound: Vec<_> = score.outcomes.iter().zip(bounds).filter_map(over_bound).collect();
    breaches.extend(judge_ratio("clean, RMS of error over bound", rms(over_bound.into_iter()), 1.25));
    assert_none(breaches);
}

/// Linear frames of several kinds of edges, with a tilt of 0.
fn assert_edges(name: &str, kinds: &[(&str, Kind)], stated: Uncertainty<f64>, asked: Asked) {
    let (mut breaches, mut scores) = (Vec::new(), Vec::new());
    for (what, kind) in kinds {
        let setup = |shot: &Shot| with_exposure(shot, stated);
        let score = score(&shots(kind, FRAMES), |shot| shot.through([]), setup);
        breaches.extend(score.judge(&format!("{name}, {what}"), asked));
        scores.push(score);
    }
    breaches.extend(Score::judge_row(name, &scores));
    assert_none(breaches);
}

#[test]
fn rough_and_bowed_edges() {
    let rough = |roughness_px| Kind { roughness_px, ..Kind::STRAIGHT };
    let bowed = |bow_px| Kind { bow_px, ..Kind::STRAIGHT };
    let kinds = [
        ("rough by 0.05 px over 10 rows", rough(0.05)),
        ("rough by 0.1 px", rough(0.1)),
        ("rough by 0.25 px", rough(0.25)),
        ("bowed by 0.2 px", bowed(0.2)),
        ("bowed by 0.5 px", bowed(0.5)),
    ];
    assert_edges("edges", &kinds, roughness_unstated(), Asked { found: 1.0, inside: 0.9 });
}

/// Each column of the sensor has an offset of its own, alike in all rows; a tilt of 0.
#[test]
fn column_offsets() {
    let shots = shots(&Kind::STRAIGHT, FRAMES);
    let (mut breaches, mut scores) = (Vec::new(), Vec::new());
    for sigma in [1.0, 2.0, 3.0] {
        let frame = |(seed, shot): (u32, &Shot)| shot.through([Stage::ColumnOffsets { sigma, seed }]);
        let frames: Vec<_> = (0..).zip(&shots).map(frame).collect();
        let score = score_of(&shots, &frames, |shot| with_exposure(shot, roughness_unstated()));
        breaches.extend(score.judge(&format!("column offsets of {sigma} levels"), Asked { found: 0.97, inside: 0.9 }));
        scores.push(score);
    }
    breaches.extend(Score::judge_row("column offsets", &scores));
    assert_none(breaches);
}

/// Shots with a lean of 0.1 and 0.3° for each edge by itself.
type LeaningShots = [(f64, Vec<Shot>); 2];

fn leaning_shots(kind: &Kind) -> LeaningShots {
    [0.1, 0.3].map(|degrees| {
        let sigma_tilt = 10.0 * degrees * TENTH_DEGREE;
        (degrees, shots(&Kind { sigma_tilt, ..*kind }, FRAMES_OF_CAMERAS))
    })
}

/// The same frames of the sensor serve all cameras.
fn sensors_frames() -> &'static LeaningShots {
    static SHOTS: OnceLock<LeaningShots> = OnceLock::new();
    SHOTS.get_or_init(|| leaning_shots(&Kind::STRAIGHT))
}

/// Leans stated and true, the exposure known (and with it the lens as it was before the camera did anything), against
/// the same frames without the exposure.
fn judge_camera(name: &str, shots: &LeaningShots, frame: impl Fn(&Shot) -> Frame) -> Vec<String> {
    let asked = Asked { found: 0.97, inside: 0.92 };
    let (mut breaches, mut scores) = (Vec::new(), Vec::new());
    for (degrees, shots) in shots {
        let stated = leaning(10.0 * degrees * TENTH_DEGREE);
        let frames: Vec<_> = shots.iter().map(&frame).collect();
        let without = score_of(shots, &frames, |shot| shot.setup(stated));
        let exposure = score_of(shots, &frames, |shot| with_exposure(shot, stated));
        let lens = score_of(shots, &frames, |shot| {
            let blur = MotionBlur::from_calibrated_lens(shot.exposure_s, 0.7);
            shot.setup(stated).with_motion_blur(blur).expect("sound blur")
        });
        breaches.extend(without.judge(&format!("{name}, {degrees}°, exposure not known"), asked));
        for (what, score) in [("exposure known", exposure), ("exposure and lens", lens)] {
            let name = format!("{name}, {degrees}°, {what}");
            breaches.extend(score.judge(&name, asked));
            breaches.extend(judge_ratio(&format!("{name}, RMS against not"), score.rms_against(&without), 1.05));
            scores.push(score);
        }
    }
    breaches.extend(Score::judge_row(name, &scores));
    breaches
}

fn assert_camera<const STAGES: usize>(name: &str, stages: [Stage; STAGES]) {
    assert_none(judge_camera(name, sensors_frames(), |shot| shot.through(stages)));
}

#[test]
fn linear_frames() {
    assert_camera("linear", []);
}

#[test]
fn srgb() {
    assert_camera("sRGB", [Stage::Tone(ToneCurve::Srgb)]);
}

#[test]
fn gamma() {
    assert_camera("gamma 2.2", [Stage::Tone(ToneCurve::Gamma(2.2))]);
}

#[test]
fn s_curve() {
    assert_camera("S curve", [Stage::Tone(ToneCurve::S { middle: 0.5, steepness: 5.0 })]);
}

#[test]
fn steep_s_curve() {
    assert_camera("steep S curve", [Stage::Tone(ToneCurve::S { middle: 0.43, steepness: 10.0 })]);
}

#[test]
fn sharpened_3x3() {
    for strength in [0.5, 1.0, 1.5] {
        assert_camera(&format!("3x3, {strength}"), [Stage::Sharpen3(strength)]);
    }
}

#[test]
fn sharpened_5x5() {
    for strength in [0.5, 1.0, 1.5] {
        assert_camera(&format!("5x5, {strength}"), [Stage::Sharpen5(strength)]);
    }
}

/// What is brighter than 160 is white.
#[test]
fn clipped() {
    assert_camera("clipping", [Stage::Gain(1.6)]);
}

#[test]
fn median() {
    assert_camera("median", [Stage::Median]);
}

#[test]
fn bilateral() {
    assert_camera("bilateral", [Stage::Bilateral(10.0)]);
}

#[test]
fn colour_mosaic() {
    assert_camera("Bayer", [Stage::Mosaic]);
}

/// As many cameras do it: a mosaic, denoising, a tone curve, sharpening.
#[test]
fn all_together() {
    let stages = [Stage::Mosaic, Stage::Bilateral(8.0), Stage::Tone(ToneCurve::Srgb), Stage::Sharpen3(1.0)];
    assert_camera("all together", stages);
}

/// Half a pixel of lens blur in the middle, one and a half in the corners.
#[test]
fn soft_corners() {
    let shots = leaning_shots(&Kind { lens_px: [0.5, 1.5], ..Kind::STRAIGHT });
    assert_none(judge_camera("field blur", &shots, |shot| shot.through([])));
}

/// Cylinders in light from angles in degrees, 0 from where the camera is.
fn judge_round_posts<const ANGLES: usize>(angles: [f32; ANGLES]) {
    let (mut breaches, mut scores) = (Vec::new(), Vec::new());
    for degrees in angles {
        let kind = Kind { light_rad: Some(degrees.to_radians()), ..Kind::leaning(TENTH_DEGREE) };
        let setup = |shot: &Shot| with_exposure(shot, leaning(TENTH_DEGREE));
        let score = score(&shots(&kind, FRAMES), |shot| shot.through([]), setup);
        breaches.extend(score.judge(&format!("cylinders, light from {degrees}°"), Asked { found: 0.97, inside: 0.92 }));
        scores.push(score);
    }
    breaches.extend(Score::judge_row("cylinders", &scores));
    assert_none(breaches);
}

#[test]
fn round_posts() {
    judge_round_posts([0.0, 45.0]);
}

/// The far side lies in the dark.
#[test]
fn round_posts_lit_from_the_side() {
    judge_round_posts([75.0]);
}

/// With linear pixels stated the blur tells the lean. Its stated error covers more than these frames have.
#[test]
fn linear_pixels_stated() {
    let (degrees, shots) = &sensors_frames()[1];
    let stated = leaning(10.0 * degrees * TENTH_DEGREE);
    let frame = |shot: &Shot| shot.through([]);
    let without = score(shots, frame, |shot| shot.setup(stated).with_response(Response::Linear));
    let known = score(shots, frame, |shot| {
        let blur = MotionBlur::from_calibrated_lens(shot.exposure_s, 0.7);
        shot.setup(stated).with_motion_blur(blur).expect("sound blur").with_response(Response::Linear)
    });
    let mut breaches = known.judge("linear, stated, 0.3°", Asked { found: 0.97, inside: 0.92 });
    breaches.extend(judge_ratio("linear, stated, RMS against not", known.rms_against(&without), 0.5));
    assert_none(breaches);
}

/// With linear pixels stated, which they are not: the halos tell, and knowing the exposure harms no more than elsewhere.
#[test]
fn sharpened_frames_said_to_be_linear() {
    // Some of the shorter and fainter edges do not tell.
    let mut breaches = judge_said_to_be_linear("3x3, 1", [Stage::Sharpen3(1.0)], 1.15);
    breaches.extend(judge_said_to_be_linear("3x3, 1.5", [Stage::Sharpen3(1.5)], 1.05));
    breaches.extend(judge_said_to_be_linear("5x5, 0.5", [Stage::Sharpen5(0.5)], 1.05));
    breaches.extend(judge_said_to_be_linear("5x5, 1.5", [Stage::Sharpen5(1.5)], 1.05));
    assert_none(breaches);
}

fn judge_said_to_be_linear<const STAGES: usize>(name: &str, stages: [Stage; STAGES], most: f64) -> Vec<String> {
    let mut breaches = Vec::new();
    for (degrees, shots) in sensors_frames() {
        let stated = leaning(10.0 * degrees * TENTH_DEGREE);
        let frames: Vec<_> = shots.iter().map(|shot| shot.through(stages)).collect();
        let without = score_of(shots, &frames, |shot| shot.setup(stated));
        let known = score_of(shots, &frames, |shot| {
            let blur = MotionBlur::from_calibrated_lens(shot.exposure_s, 0.7);
            shot.setup(stated).with_motion_blur(blur).expect("sound blur").with_response(Response::Linear)
        });
        let name = format!("{name}, {degrees}°, said to be linear");
        breaches.extend(known.judge(&name, Asked { found: 0.97, inside: 0.92 }));
        breaches.extend(judge_ratio(&format!("{name}, RMS against not"), known.rms_against(&without), most));
    }
    breaches
}

/// Bright posts before a dark background that is not alike everywhere, coded by sRGB: with the curve stated they are as
/// good as linear ones; a tilt of 0.
#[test]
fn srgb_of_high_contrast() {
    let shots = shots(&Kind { levels: [20.0, 200.0], uneven: 12.0, ..Kind::STRAIGHT }, FRAMES);
    let coded = |shot: &Shot| shot.through([Stage::Tone(ToneCurve::Srgb)]);
    let setup = |shot: &Shot| with_exposure(shot, Uncertainty::NONE);
    let linear = score(&shots, |shot| shot.through([]), setup);
    let unstated = score(&shots, coded, setup);
    let stated = score(&shots, coded, |shot| setup(shot).with_response(Response::Srgb));
    let mut breaches = linear.judge("8 to 200, linear", Asked { found: 1.0, inside: 0.92 });
    unstated.judge("8 to 200, sRGB not stated", Asked { found: 0.0, inside: 0.0 });
    breaches.extend(stated.judge("8 to 200, sRGB stated", Asked { found: 1.0, inside: 0.92 }));
    let ratio = stated.two_thirds() / linear.two_thirds();
    breaches.extend(judge_ratio("8 to 200, sRGB stated, two thirds of errors against linear", ratio, 1.3));
    assert_none(breaches);
}

/// Good edges that used to be refused.
#[test]
fn noise_and_high_contrast() {
    let kinds = [
        ("levels 8 and 200, noise 4", Kind { levels: [8.0, 200.0], read_noise: 4.0, ..Kind::STRAIGHT }),
        ("noise 8", Kind { levels: [8.0, 200.0], read_noise: 8.0, ..Kind::STRAIGHT }),
    ];
    assert_edges("high contrast", &kinds, Uncertainty::NONE, Asked { found: 0.99, inside: 0.92 });
}

/// Neither refused nor with a sigma that is too large.
#[test]
fn long_blur() {
    let kinds = [("16 to 21 px", Kind { blur_px: Some([16.0, 21.0]), ..Kind::STRAIGHT })];
    assert_edges("blur", &kinds, Uncertainty::NONE, Asked { found: 0.99, inside: 0.92 });
}

/// Some rows are lost and the rest of the frame moves up, with nobody telling: an edge that is given a distance has the
/// right one, whichever part of it was seen, or is refused; most frames are found torn. A tilt of 0.
fn assert_lost_rows_do_no_harm(lost: usize) {
    let mut ranger = large_ranger();
    let (mut inside, mut outside, mut torn) = (0, Vec::new(), 0);
    for (index, shot) in shots(&Kind::STRAIGHT, FRAMES).iter().enumerate() {
        let at = 120 + 4 * index;
        let mut frame = shot.through([]);
        frame.drain(at..(at + lost).min(479));
        // Nothing comes after them.
        frame.resize(480, [115; COLUMNS]);
        let setup = with_exposure(shot, roughness_unstated());
        let found = shot.ranges_if_whole(&mut ranger, &setup, &frame);
        torn += usize::from(found.is_none());
        for range in found.into_iter().flatten() {
            let edge = shot.edges.iter().find(|edge| edge.is_of(&range, shot.exposure_s));
            if let Some(edge) = edge.filter(|_| matches!(range.status, RangeStatus::Ok | RangeStatus::Far)) {
                let off = range.estimate.inverse_depth_per_m - 1.0 / edge.depth_m();
                let normal = off / range.estimate.sigma_inverse_depth_per_m;
                if normal.abs() <= 2.0 {
                    inside += 1;
                } else {
                    outside.push((normal, range.status, range.points, edge.depth_m()));
                }
            }
        }
    }
    let wild: Vec<_> = outside.iter().filter(|(normal, ..)| normal.abs() > 6.0).collect();
    let told =
        format!("{lost} rows lost: {torn} torn; {inside} in two sigma, {} not, beyond six: {wild:.1?}", outside.len());
    println!("{told}");
    assert!(inside >= 9 * outside.len() && wild.is_empty(), "{told}");
}

#[test]
fn forty_lost_rows() {
    assert_lost_rows_do_no_harm(40);
    assert_lost_rows_do_no_harm(80);
}

#[test]
fn twenty_lost_rows() {
    assert_lost_rows_do_no_harm(20);
}

/// A step of 0.2 to 1 px.
#[test]
#[ignore = "not reached: 65 % in two sigma, as so small a step is a wander of the whole edge; none is beyond six"]
fn ten_lost_rows() {
    assert_lost_rows_do_no_harm(10);
}
