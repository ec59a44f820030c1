//! `Ranger::row`: rendered frames in, ranges out, against the simulator's truth.

use shutter_range::sim::{Background, Bar, Exposure, Rail, Scene, Texture, Truth};
use shutter_range::{
    MotionBlur, Polarity, Range, RangeStatus, Ranger, ReadoutDirection, Response, Scalar, Uncertainty,
};

use crate::projection;
use crate::rendered::{
    MOST_SIGMAS, ROWS, SmallRanger, TOP, assert_found, errors, moving, post, ranges_of, render, scene_of,
};
use crate::scenes::{TENTH_DEGREE, tilt_of};

/// One frame from the top with every uncertainty but the pixels' at zero: its ranges, and its bars' edges.
fn ranges_and_truths<const N: usize>(
    scene: &Scene<N>,
    world: &projection::Scene,
    exposure: Exposure,
    seed: u64,
) -> (Vec<Range<f32>>, Vec<Truth>) {
    let (frame, truths) = render(scene, world, TOP, exposure, seed);
    let setup = world.setup_read(Uncertainty::NONE, TOP);
    (ranges_of(&mut SmallRanger::new(), &setup, world, &frame), truths)
}

fn statuses<S>(found: &[Range<S>]) -> Vec<RangeStatus> {
    found.iter().map(|range| range.status).collect()
}

/// Rows at the ends of a line that may lack a point: there the edge's window reaches beyond the image or the bar.
const LOST_ROWS: u16 = 2;

fn one_post<S: Scalar>() {
    for direction in [TOP, ReadoutDirection::BottomToTop] {
        for speed_m_s in [1.5, -1.5] {
            let world = moving(speed_m_s);
            let (frame, truths) = render(&post(), &world, direction, Exposure::default(), 1);
            let setup = world.setup_read::<S>(Uncertainty::NONE, direction);
            let found = ranges_of(&mut SmallRanger::new(), &setup, &world, &frame);
            assert_found(&format!("{direction:?}, {speed_m_s} m/s"), &found, &truths, 0.01);
            for range in &found {
                // All but the rows in which levels and blur of the edge are being learned.
                assert!(range.first_row <= LOST_ROWS && range.last_row >= ROWS - 1 - LOST_ROWS, "{range:?}");
                assert!(range.points > ROWS - 10, "{range:?}");
            }
        }
    }
}

#[test]
fn a_post_is_found_in_single_precision() {
    one_post::<f32>();
}

#[test]
fn a_post_is_found_in_double_precision() {
    one_post::<f64>();
}

#[test]
fn a_bar_is_found_between_its_ends() {
    let bar = Bar::upright(0.05, 2.0, 0.1, 60.0).between(-0.4, 0.3);
    let scene = scene_of(180.0, [bar.into()]);
    let (found, truths) = ranges_and_truths(&scene, &moving(1.5), Exposure::default(), 1);
    assert_found("a post with ends", &found, &truths, 0.05);
    for (range, truth) in found.iter().zip(&truths) {
        assert!(range.first_row.abs_diff(truth.first_row) <= LOST_ROWS, "{range:?} for {truth:?}");
        assert!(range.last_row.abs_diff(truth.last_row) <= LOST_ROWS, "{range:?} for {truth:?}");
    }
}

#[test]
fn several_posts_are_found_at_once() {
    let objects = [
        Bar::upright(-0.35, 1.2, 0.08, 40.0).into(),
        Bar::upright(-0.05, 3.0, 0.2, 230.0).into(),
        Bar::upright(0.42, 4.0, 0.3, 20.0).into(),
    ];
    for seed in 1..4 {
        let (found, truths) = ranges_and_truths(&scene_of(150.0, objects), &moving(1.5), Exposure::default(), seed);
        assert_found(&format!("seed {seed}"), &found, &truths, 0.02);
    }
}

/// Normalised errors of the inverse depth over 60 frames, each of its own post, noise and phase.
fn assert_honest(name: &str, world: &projection::Scene, direction: ReadoutDirection, exposure: Exposure) {
    let mut normal = Vec::new();
    for seed in 0..60_u64 {
        let part = |step: u64| (seed * step % 60) as f32 / 60.0;
        let bar = Bar::upright(0.4 * part(7) - 0.2, 1.2 + 2.0 * part(11), 0.12, 40.0 + 40.0 * part(13));
        let (frame, truths) = render(&scene_of(190.0, [bar.into()]), world, direction, exposure, seed);
        let setup = world.setup_read::<f32>(Uncertainty::NONE, direction);
        let found = ranges_of(&mut SmallRanger::new(), &setup, world, &frame);
        assert_eq!(statuses(&found), [RangeStatus::Ok; 2], "{name}, seed {seed}: {found:#?}");
        normal.extend(found.iter().zip(&truths).map(|(range, truth)| errors(range, truth).1));
    }
    let count = normal.len() as f64;
    let mean = normal.iter().sum::<f64>() / count;
    let deviation = (normal.iter().map(|error| (error - mean).powi(2)).sum::<f64>() / count).sqrt();
    println!("{name}: mean {mean:+.3}, deviation {deviation:.3}");
    // One and zero; over 120 errors a deviation is known to 1/√240, a mean to 1/√120: three to four times that.
    assert!((0.8..1.25).contains(&deviation) && mean.abs() < 0.4, "{name}: mean {mean}, deviation {deviation}");
}

#[test]
fn sigma_is_honest() {
    let (world, exposure) = (moving(1.5), Exposure::default());
    assert_honest("to the right", &world, TOP, exposure);
    assert_honest("to the left", &moving(-1.5), TOP, exposure);
    assert_honest("from the bottom", &world, ReadoutDirection::BottomToTop, exposure);
    let turning = projection::Scene { velocity_m_s: [1.0, 0.0, 1.5], rate_rad_s: [0.1, -0.3, 0.2], ..world.clone() };
    assert_honest("ahead in a turn", &turning, TOP, exposure);
    assert_honest("noisy", &world, TOP, Exposure { read_noise: 5.0, ..exposure });
    assert_honest("quiet", &world, TOP, Exposure { read_noise: 0.3, shot_gain: 0.0, ..exposure });
    assert_honest("exposed for 8 ms", &world, TOP, Exposure { time_s: 0.008, ..exposure });
    assert_honest("exposed for 20 ms", &world, TOP, Exposure { time_s: 0.02, ..exposure });
}

#[test]
fn bearings_are_right_within_their_sigma() {
    for seed in 1..4 {
        let (found, truths) = ranges_and_truths(&post(), &moving(1.5), Exposure::default(), seed);
        for (range, truth) in found.iter().zip(&truths) {
            let error = f64::from(range.estimate.bearing) - truth.bearing;
            assert!(error.abs() < MOST_SIGMAS * f64::from(range.estimate.sigma_bearing), "{range:?} for {truth:?}");
        }
    }
}

/// The sides of so thin a rod shift each other outwards by up to a pixel, in all rows alike, and hide each other's
/// width. The depth is right all the same, and a known exposure must not refuse them.
#[test]
fn a_rod_three_pixels_wide_has_the_right_depth_and_shifted_sides() {
    let (world, exposure) = (moving(1.5), Exposure::default());
    let blur = MotionBlur::from_calibrated_lens(exposure.time_s, exposure.psf_sigma_px);
    let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
    for setup in [setup, setup.with_response(Response::Linear).with_motion_blur(blur).expect("sound blur")] {
        for seed in 1..11 {
            let bar = Bar::upright(0.02 * seed as f32 - 0.1, 2.0, 0.02, 60.0);
            let (frame, truths) = render(&scene_of(180.0, [bar.into()]), &world, TOP, exposure, seed);
            let found = ranges_of(&mut SmallRanger::new(), &setup, &world, &frame);
            assert_found(&format!("{:?}, seed {seed}", setup.motion_blur()), &found, &truths, 0.03);
            assert_eq!([found[0].polarity, found[1].polarity], [Polarity::Falling, Polarity::Rising]);
            for (outwards, (range, truth)) in [-1.0, 1.0].into_iter().zip(found.iter().zip(&truths)) {
                // The README promises about a pixel.
                let shift_px = outwards * 300.0 * (f64::from(range.estimate.bearing) - truth.bearing);
                assert!((0.5..1.25).contains(&shift_px), "seed {seed}: {shift_px} px outwards");
            }
        }
    }
}

/// One line for each side, whatever the brightness of the rail.
#[test]
fn a_line_goes_on_behind_a_rail() {
    for level in [20.0, 60.0, 120.0, 180.0, 240.0] {
        for seed in 1..4 {
            let rail = Rail { depth_m: 1.0, top_m: 0.0, bottom_m: 0.06, level };
            let scene = scene_of(180.0, [Bar::upright(0.05, 2.0, 0.1, 60.0).into(), rail.into()]);
            let (found, truths) = ranges_and_truths(&scene, &moving(1.5), Exposure::default(), seed);
            assert_found(&format!("level {level}, seed {seed}"), &found, &truths, 0.01);
            for (range, truth) in found.iter().zip(&truths) {
                assert!(range.first_row <= LOST_ROWS && range.last_row >= ROWS - 1 - LOST_ROWS, "{range:?}");
                // A row or two at either end of the image and on either side of the rail, whose own blur hides the
                // edge.
                assert!(range.points.abs_diff(truth.visible_rows) <= 5, "{range:?} for {truth:?}");
            }
        }
    }
}

/// Also where the table has no place for the line that begins below the rail.
#[test]
fn a_line_goes_on_behind_a_rail_when_the_table_is_full() {
    let rail = Rail { depth_m: 1.0, top_m: 0.02, bottom_m: 0.08, level: 120.0 };
    let posts = [Bar::upright(-0.2, 1.5, 0.08, 60.0), Bar::upright(0.2, 2.0, 0.1, 60.0)];
    let scene = scene_of(180.0, [posts[0].into(), posts[1].into(), rail.into()]);
    let world = moving(1.5);
    let (frame, truths) = render(&scene, &world, TOP, Exposure::default(), 1);
    let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
    let mut ranger: Ranger<4, 10, 32> = Ranger::new();
    for (row, pixels) in (0..).zip(&frame) {
        ranger.row(&setup, row, pixels).expect("rows in order");
    }
    ranger.end_frame(&setup);
    let found = ranger.ranges(&setup, &world.motion());
    assert_found("a full table", &found, &truths, 0.02);
    assert!(found.iter().all(|range| range.last_row >= ROWS - 1 - LOST_ROWS), "{found:#?}");
}

/// Sixteen rows are enough where nothing else is in view: nineteen of twenty bars stand out of what noise does beside
/// them. (Among so many edges that some of their points are bound to lie in line by chance, a line must be longer.)
#[test]
fn short_bars_are_found_in_a_clear_view() {
    let bar = |bearing| Bar::upright(bearing, 1.0, 0.1, 60.0).between(-0.027, 0.027).into();
    let (mut ok, mut edges) = (0, 0);
    for seed in 1..41 {
        let scene = scene_of(180.0, [bar(-0.4), bar(-0.2), bar(0.0), bar(0.2), bar(0.4)]);
        let (found, truths) = ranges_and_truths(&scene, &moving(3.0), Exposure::default(), seed);
        assert_eq!(found.len(), truths.len(), "seed {seed}");
        for (range, truth) in found.iter().zip(&truths) {
            assert!(errors(range, truth).1.abs() < MOST_SIGMAS, "seed {seed}: {range:?} for {truth:?}");
        }
        ok += found.iter().filter(|range| range.status == RangeStatus::Ok).count();
        edges += truths.len();
    }
    assert!(20 * ok >= 19 * edges, "{ok} of {edges}");
}

#[test]
fn bars_that_leave_at_the_side_are_found() {
    for seed in 1..6 {
        for (bearing, speed_m_s) in [(-0.44, 1.5), (0.44, -1.5)] {
            let scene = scene_of(180.0, [Bar::upright(bearing, 0.5, 0.03, 60.0).into()]);
            let (found, truths) = ranges_and_truths(&scene, &moving(speed_m_s), Exposure::default(), seed);
            assert_found(&format!("{bearing}, seed {seed}"), &found, &truths, 0.02);
        }
    }
}

/// At least one of their sides is found, with the right depth; the other one may come into view too late.
#[test]
fn bars_that_enter_at_the_side_have_no_wrong_depth() {
    for seed in 1..6 {
        for (bearing, depth_m, width_m, speed_m_s) in
            [(0.58, 0.5, 0.03, 1.5), (-0.58, 0.5, 0.03, -1.5), (0.66, 0.5, 0.1, 1.5), (-0.66, 0.5, 0.1, -1.5)]
        {
            let scene = scene_of(180.0, [Bar::upright(bearing, depth_m, width_m, 60.0).into()]);
            let (found, truths) = ranges_and_truths(&scene, &moving(speed_m_s), Exposure::default(), seed);
            assert!(!found.is_empty(), "{bearing}, seed {seed}");
            for range in &found {
                let truth = truths.iter().find(|truth| truth.polarity == range.polarity).expect("a side of the bar");
                let (error, normal) = errors(range, truth);
                assert_eq!(range.status, RangeStatus::Ok, "{bearing}, seed {seed}: {range:?}");
                // As in `assert_found`.
                let is_near = error.abs() < 0.02 && normal.abs() < MOST_SIGMAS;
                assert!(is_near, "{bearing}, seed {seed}: {range:?} for {truth:?}");
            }
        }
    }
}

/// Whether a frame with one leaning bar has an `Ok`.
fn lean_is_taken_for_a_distance(degrees: f32, speed_m_s: f64, time_s: f32, seed: u64, blur_known: bool) -> bool {
    let world = moving(speed_m_s);
    let bar = Bar::upright(0.02, 2.0, 0.1, 60.0).leaning(degrees.to_radians().tan());
    let exposure = Exposure { time_s, ..Exposure::default() };
    let (frame, _) = render(&scene_of(180.0, [bar.into()]), &world, TOP, exposure, seed);
    let mut setup = world.setup_read::<f32>(tilt_of(TENTH_DEGREE), TOP);
    if blur_known {
        setup = setup
            .with_response(Response::Linear)
            .with_motion_blur(MotionBlur::from_calibrated_lens(time_s, exposure.psf_sigma_px))
            .expect("sound parameters");
    }
    statuses(&ranges_of(&mut SmallRanger::new(), &setup, &world, &frame)).contains(&RangeStatus::Ok)
}

/// A lean makes a slope without blur.
#[test]
fn motion_blur_refuses_leaning_bars() {
    let mut taken = 0;
    for degrees in [8.0, 9.0, 10.0, 11.0, 12.0, 15.0, 18.0, 20.0, 22.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 60.0] {
        for (lean, speed_m_s) in [(degrees, 1.5), (-degrees, 1.5), (degrees, 0.5), (-degrees, -1.5)] {
            for time_s in [0.002, 0.005, 0.008] {
                let ok = |known| lean_is_taken_for_a_distance(lean, speed_m_s, time_s, 1, known);
                assert!(!ok(true), "{lean} degrees, {speed_m_s} m/s, {time_s} s");
                taken += u32::from(ok(false));
            }
        }
    }
    // One in six of the 192 cases, or there would be nothing to refuse.
    assert!(taken > 30, "without it, only {taken} are taken for distances");
}

/// A known exposure takes no range from an upright bar.
#[test]
fn motion_blur_confirms_upright_bars() {
    for (time_s, speed_m_s) in [(0.002, 1.5), (0.005, -1.5), (0.008, 1.5), (0.016, 1.5)] {
        let exposure = Exposure { time_s, ..Exposure::default() };
        for seed in 1..6 {
            let world = moving(speed_m_s);
            let (frame, truths) = render(&post(), &world, TOP, exposure, seed);
            let blur = MotionBlur::from_calibrated_lens(time_s, exposure.psf_sigma_px);
            let setup = world
                .setup_read::<f32>(tilt_of(TENTH_DEGREE), TOP)
                .with_response(Response::Linear)
                .with_motion_blur(blur)
                .expect("sound");
            let found = ranges_of(&mut SmallRanger::new(), &setup, &world, &frame);
            assert_found(&format!("{time_s} s, seed {seed}"), &found, &truths, 0.02);
        }
    }
}

#[test]
fn a_flat_scene_has_no_ranges() {
    for (read_noise, level) in [(0.0, 0.0), (0.0, 128.0), (0.0, 255.0), (1.0, 60.0), (5.0, 128.0), (25.0, 128.0)] {
        for seed in 1..4 {
            let exposure = Exposure { read_noise, ..Exposure::default() };
            let (found, _) = ranges_and_truths(&scene_of(level, []), &moving(1.5), exposure, seed);
            assert!(found.is_empty(), "noise {read_noise}, level {level}, seed {seed}: {found:?}");
        }
    }
}

#[test]
fn faint_and_noisy_bars_are_found() {
    for (levels, read_noise) in
        [([130.0, 115.0], 2.5), ([115.0, 130.0], 2.5), ([100.0, 160.0], 12.0), ([160.0, 100.0], 12.0)]
    {
        let exposure = Exposure { read_noise, shot_gain: 0.0, ..Exposure::default() };
        for seed in 1..6 {
            let scene = scene_of(levels[0], [Bar::upright(0.05, 2.0, 0.2, levels[1]).into()]);
            let (found, truths) = ranges_and_truths(&scene, &moving(1.5), exposure, seed);
            assert_found(&format!("{levels:?}, noise {read_noise}, seed {seed}"), &found, &truths, 0.05);
        }
    }
}

/// Rounding to whole grey levels makes errors that are alike in neighbouring rows, and that is no bend.
#[test]
fn faint_bars_without_noise_are_not_bent() {
    let exposure = Exposure { read_noise: 0.0, shot_gain: 0.0, ..Exposure::default() };
    for contrast in [8.0, 15.0, 30.0, 60.0, 120.0] {
        for depth_m in [1.0, 2.0, 3.0, 5.0] {
            let scene = scene_of(115.0, [Bar::upright(0.05, depth_m, 0.2, 115.0 + contrast).into()]);
            let (found, truths) = ranges_and_truths(&scene, &moving(1.5), exposure, 1);
            assert_found(&format!("contrast {contrast}, {depth_m} m"), &found, &truths, 0.01);
        }
    }
}

#[test]
fn bars_are_found_through_long_motion_blur() {
    // 1.5 m/s at 0.6 m: 750 px/s.
    for path_px in [8.0, 12.0, 16.0, 20.0, 24.0, 28.0] {
        for seed in 1..4 {
            let scene = scene_of(180.0, [Bar::upright(0.05, 0.6, 0.15, 60.0).into()]);
            let exposure = Exposure { time_s: path_px / 750.0, ..Exposure::default() };
            let (found, truths) = ranges_and_truths(&scene, &moving(1.5), exposure, seed);
            assert_found(&format!("{path_px} px, seed {seed}"), &found, &truths, 0.01);
        }
    }
}

/// Noise breaks the slope of a long blur into parts, each as steep as an edge; the edge is there all the same, and no part
/// of it is told as an edge elsewhere.
#[test]
fn bars_are_found_through_long_blur_and_noise() {
    let (mut right, mut edges) = (0, 0);
    for (path_px, shot_gain) in [(20.0, 0.06), (24.0, 0.06), (20.0, 0.12)] {
        for seed in 1..=6 {
            let bars = [Bar::upright(-0.2, 1.0, 0.15, 60.0), Bar::upright(0.25, 1.0, 0.2, 90.0)];
            let scene = scene_of(190.0, bars.map(Into::into));
            // 6 m/s at 1 m: 1800 px/s.
            let exposure = Exposure { time_s: path_px / 1800.0, shot_gain, ..Exposure::default() };
            let world = moving(6.0);
            let (frame, truths) = render(&scene, &world, TOP, exposure, seed);
            let setup = world.setup_read(Uncertainty::NONE, TOP);
            // Each part of a slope may take a place for some rows.
            let found = ranges_of(&mut *Box::new(Ranger::<64, 16, 64>::new()), &setup, &world, &frame);
            let is_of = |range: &&Range<f32>, truth: &Truth| {
                let off = f64::from(range.estimate.bearing) - truth.bearing;
                range.polarity == truth.polarity && off.abs() < 0.05
            };
            for truth in &truths {
                let mut told = found.iter().filter(|range| is_of(range, truth) && range.status == RangeStatus::Ok);
                let is_near = |range: &Range<f32>| errors(range, truth).1.abs() < MOST_SIGMAS;
                right += usize::from(told.clone().any(|range| range.points > ROWS * 3 / 4));
                assert!(told.all(is_near), "{path_px} px, gain {shot_gain}, seed {seed}: {found:#?} for {truth:?}");
            }
            edges += truths.len();
        }
    }
    println!("{right} of {edges}");
    assert!(right * 100 >= edges * 97, "{right} of {edges}");
}

#[test]
fn the_same_bytes_give_the_same_ranges() {
    let world = moving(1.5);
    let texture = Texture { contrast: 25.0, cell: 0.05, seed: 3 };
    let mut scene = Scene::<2>::new(Background::textured(150.0, texture)).expect("sound background");
    scene.push(Bar::upright(0.05, 2.0, 0.1, 40.0)).expect("a sound bar");
    scene.push(Bar::upright(-0.2, 1.0, 0.1, 60.0).leaning(0.1)).expect("a sound bar");
    let frames = [1, 2, 3].map(|seed| render(&scene, &world, TOP, Exposure::default(), seed).0);
    let setup = world.setup_read::<f32>(tilt_of(TENTH_DEGREE), TOP);
    let run = || {
        let mut ranger = SmallRanger::new();
        let found: Vec<_> = frames.iter().map(|frame| ranges_of(&mut ranger, &setup, &world, frame)).collect();
        (found, *ranger.counters())
    };
    let first = run();
    assert!(first.0.iter().all(|found| found.len() >= 2), "{first:?}");
    assert_eq!(first, run());
}

/// A board with 16 KiB of RAM has room for it, a row of pixels and the stack.
#[test]
fn a_small_ranger_takes_ten_kibibytes() {
    let bytes = size_of::<SmallRanger>();
    assert!(bytes <= 10 * 1024, "{bytes}");
}
