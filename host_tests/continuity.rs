//! Frames that were lost, came twice, too early or too late, or torn: all known edges are off alike, and a sequence says so.

use shutter_range::{Continuity, Range, RangeStatus};

use crate::journey::{Disturbance, Drive, Journey, Path, Post, errors, seed};
use crate::scenes::{TENTH_DEGREE, tilt_of};

const SEEDS: u64 = 8;
const SIDEWAYS: [f64; 3] = [-1.5, 0.0, 0.0];
const OBLIQUE: [f64; 3] = [-1.0, 0.0, 1.0];

/// Posts at several depths, each with a lean of its own within a tenth of a degree. The nearer ones are on the right: they
/// move to the right faster, and never cross the others.
fn posts() -> Vec<Post> {
    let place = |(k, depth): (u32, f64)| {
        let lean = TENTH_DEGREE * (f64::from(k) * 2.4).sin();
        Post::at((-0.5 + 0.09 * f64::from(k)) * depth, depth).leaning(lean)
    };
    (0..).zip([9.0, 7.0, 6.0, 5.0, 4.0, 3.5, 3.0, 2.6]).map(place).collect()
}

/// What a sequence tells of a frame.
struct Told {
    continuity: Continuity,
    ranges: Vec<Range<f64>>,
    /// Errors of those that are ok, in sigmas.
    errors: Vec<f64>,
}

/// Frames that are told to follow each other by the interval, and were really taken at `tenths` of it; none of an empty one.
fn drive(velocity: [f64; 3], tenths: &[Option<u32>], number: u64) -> Vec<Told> {
    let random = &mut seed(number);
    let journey = Journey { path: Path::straight(velocity), ..Journey::vga() };
    let real = Journey { interval_s: journey.interval_s / 10.0, ..journey.clone() };
    let posts = posts();
    let mut drive = Drive::new(journey.setup(tilt_of(TENTH_DEGREE)), journey.interval_s, |frame| {
        journey.known(frame, Disturbance::default())
    });
    let mut tell = |at: &Option<u32>| {
        let ranges = drive.frame(&at.map_or(Vec::new(), |at| real.points(&posts, at, random)));
        let error = |range: &Range<f64>| {
            let of_post = |post: &Post| {
                let truth = real.truth(post, at.expect("a frame with ranges"));
                ((truth.bearing - range.estimate.bearing).abs(), errors(range, &truth).1)
            };
            posts.iter().map(of_post).min_by(|a, b| a.0.total_cmp(&b.0)).expect("posts").1
        };
        let ok = ranges.iter().filter(|range| range.status == RangeStatus::Ok);
        Told { continuity: drive.sequence.continuity(), errors: ok.map(error).collect(), ranges: ranges.clone() }
    };
    tenths.iter().map(&mut tell).collect()
}

fn regular(frames: u32) -> Vec<Option<u32>> {
    (0..frames).map(|frame| Some(10 * frame)).collect()
}

/// The same with all frames from one on later by so many tenths.
fn later_from(frame: usize, tenths: i32) -> Vec<Option<u32>> {
    let mut times = regular(12);
    times.iter_mut().skip(frame).flatten().for_each(|time| *time = time.saturating_add_signed(tenths));
    times
}

#[test]
fn a_clean_sequence_is_steady() {
    for velocity in [SIDEWAYS, OBLIQUE] {
        for number in 0..SEEDS {
            let told = drive(velocity, &regular(20), number);
            assert!(told.iter().all(|told| told.continuity == Continuity::Steady), "{velocity:?}, {number}");
            assert!(told[19].ranges.iter().any(|range| range.frames == 20));
        }
    }
}

/// A frame that does not fit to those before is said, and no distance pretends to be what it is not.
fn check(what: &str, tenths: &[Option<u32>], at: usize) {
    for velocity in [SIDEWAYS, OBLIQUE] {
        let (mut all, mut inside) = (0, 0);
        for number in 0..SEEDS {
            let told = drive(velocity, tenths, number);
            for (frame, told) in told.iter().enumerate() {
                println!("{what} {number} {frame}: {:?} {} {:.1?}", told.continuity, told.ranges.len(), told.errors);
                let is_steady = told.continuity == Continuity::Steady;
                assert!(frame >= at || is_steady, "{what}, {velocity:?}, {number}, {frame}");
                assert!(frame != at || !is_steady, "{what}, {velocity:?}, {number}");
                assert!(told.errors.iter().all(|error| error.abs() < 5.0), "{what}, {frame}: {:.1?}", told.errors);
                all += told.errors.len();
                inside += told.errors.iter().filter(|error| error.abs() < 2.0).count();
            }
        }
        println!("{what}, {velocity:?}: {inside} of {all}");
        assert!(all > 300 && inside * 100 >= all * 93, "{what}, {velocity:?}: {inside} of {all}");
    }
}

#[test]
fn a_lost_frame_is_said() {
    check("lost", &later_from(5, 10), 5);
}

#[test]
fn a_repeated_frame_is_said() {
    let mut times = regular(12);
    times[5] = times[4];
    check("repeated", &times, 5);
}

#[test]
fn a_late_frame_is_said() {
    check("late", &later_from(5, 1), 5);
    check("early", &later_from(5, -1), 5);
}

#[test]
fn an_empty_frame_changes_nothing() {
    for velocity in [SIDEWAYS, OBLIQUE] {
        for number in 0..SEEDS {
            let mut times = regular(12);
            times[5] = None;
            let told = drive(velocity, &times, number);
            assert!(told.iter().all(|told| told.continuity == Continuity::Steady));
            assert!(told[6].ranges.iter().any(|range| range.frames == 6), "the edges go on");
        }
    }
}

/// Three of the eight edges suddenly move: they do not speak for all.
#[test]
fn moving_objects_do_not_speak_for_all() {
    for number in 0..SEEDS {
        let random = &mut seed(number);
        let journey = Journey { path: Path::straight(SIDEWAYS), ..Journey::vga() };
        let setup = journey.setup::<f64>(tilt_of(TENTH_DEGREE));
        let mut drive = Drive::new(setup, journey.interval_s, |frame| journey.known(frame, Disturbance::default()));
        let mut moved = 0;
        for frame in 0..12 {
            let start = |post: Post| {
                let moves = post.moving([-1.5, 0.0, 0.0]);
                // From the sixth frame on it keeps pace with the camera.
                let begin = 5.0 * journey.interval_s;
                let foot = std::array::from_fn(|axis| post.foot[axis] - moves.velocity_m_s[axis] * begin);
                if frame < 5 { post } else { Post { foot, ..moves } }
            };
            let is_mover = |index: usize| [1, 4, 6].contains(&index);
            let all = posts().into_iter().enumerate();
            let posts: Vec<_> = all.map(|(index, post)| if is_mover(index) { start(post) } else { post }).collect();
            let ranges = drive.frame(&journey.points(&posts, frame, random));
            assert_eq!(drive.sequence.continuity(), Continuity::Steady, "{number}, {frame}");
            moved += ranges.iter().filter(|range| frame >= 5 && range.frames < frame + 1).count();
        }
        assert!(moved > 6, "what moves begins anew: {moved}");
    }
}
