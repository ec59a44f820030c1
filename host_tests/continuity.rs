//! Frames that were lost, came twice, too early or too late, or torn: all known edges are off alike, and a sequence
//! says so.

use shutter_range::{Continuity, Motion, Range, RangeStatus, Sequence, Uncertainty};

use crate::journey::{Disturbance, Drive, Journey, Path, Post, SequenceRanger, errors, normal, seed};
use crate::scenes::{TENTH_DEGREE, tilt_of};

const SEEDS: u64 = 8;
const SIDEWAYS: [f64; 3] = [-1.5, 0.0, 0.0];
const OBLIQUE: [f64; 3] = [-1.0, 0.0, 1.0];

/// Posts at several depths, each with a lean of its own within `most`. The nearer ones are on the right: they
/// move to the right faster, and never cross the others.
fn posts_within(most: f64) -> Vec<Post> {
    let place = |(k, depth): (u32, f64)| {
        let lean = most * (f64::from(k) * 2.4).sin();
        Post::at((-0.5 + 0.09 * f64::from(k)) * depth, depth).leaning(lean)
    };
    (0..).zip([9.0, 7.0, 6.0, 5.0, 4.0, 3.5, 3.0, 2.6]).map(place).collect()
}

fn posts() -> Vec<Post> {
    posts_within(TENTH_DEGREE)
}

/// What a sequence tells of a frame.
struct Told {
    continuity: Continuity<f64>,
    ranges: Vec<Range<f64>>,
    /// Errors of those that are ok, in sigmas.
    errors: Vec<f64>,
}

/// Frames that are told to follow each other by the interval, and were really taken at `tenths` of it; none of an empty
/// one.
fn drive(velocity: [f64; 3], tenths: &[Option<u32>], number: u64) -> Vec<Told> {
    drive_past(&posts(), tilt_of(TENTH_DEGREE), velocity, tenths, number)
}

/// The same past other posts, with what is stated of them.
fn drive_past(
    posts: &[Post],
    stated: Uncertainty<f64>,
    velocity: [f64; 3],
    tenths: &[Option<u32>],
    number: u64,
) -> Vec<Told> {
    let random = &mut seed(number);
    let journey = Journey { path: Path::straight(velocity), ..Journey::vga() };
    let real = Journey { interval_s: journey.interval_s / 10.0, ..journey.clone() };
    let mut drive =
        Drive::new(journey.setup(stated), journey.interval_s, |frame| journey.known(frame, Disturbance::default()));
    let mut tell = |at: &Option<u32>| {
        let ranges = drive.frame(&at.map_or(Vec::new(), |at| real.points(posts, at, random)));
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

/// Errors of many distances: two sigma hold as often as they should, and none pretends to be what it is not.
fn assert_honest(what: &str, told: &[Told]) {
    let errors = || told.iter().flat_map(|told| &told.errors);
    let (all, inside) = (errors().count(), errors().filter(|error| error.abs() < 2.0).count());
    println!("{what}: {inside} of {all}");
    assert!(errors().all(|error| error.abs() < 5.0), "{what}");
    assert!(all > 300 && inside * 100 >= all * 93, "{what}: {inside} of {all}");
}

/// The frame `at` is said to be off by `tenths` of an interval, and the edges go on.
fn check_shift(what: &str, times: &[Option<u32>], at: usize, tenths: f64) {
    for velocity in [SIDEWAYS, OBLIQUE] {
        let mut all = Vec::new();
        for number in 0..SEEDS {
            let told = drive(velocity, times, number);
            assert!(told[..at].iter().all(|told| told.continuity == Continuity::Steady), "{what}, {number}");
            let Continuity::Shifted { seconds, sigma_s } = told[at].continuity else {
                panic!("{what}, {velocity:?}, {number}: {:?}", told[at].continuity)
            };
            let error_s = seconds - tenths / 10.0 * Journey::vga().interval_s;
            assert!(error_s.abs() < 3.0 * sigma_s, "{what}, {number}: {seconds} ± {sigma_s}");
            assert!(sigma_s < Journey::vga().interval_s / 50.0, "{what}: {sigma_s}");
            let goes_on = told[at].ranges.iter().filter(|range| range.frames > 5).count();
            assert!(goes_on > 6, "{what}, {velocity:?}, {number}: {goes_on} edges go on");
            all.extend(told);
        }
        assert_honest(what, &all);
    }
}

#[test]
fn a_lost_frame_is_made_up_for() {
    check_shift("lost", &later_from(5, 10), 5, 10.0);
}

#[test]
fn a_late_or_early_frame_is_made_up_for() {
    check_shift("late", &later_from(5, 1), 5, 1.0);
    check_shift("early", &later_from(5, -1), 5, -1.0);
    check_shift("half an interval late", &later_from(5, 5), 5, 5.0);
}

#[test]
fn a_frame_that_came_twice_teaches_nothing() {
    let mut times = regular(12);
    times[5] = times[4];
    for velocity in [SIDEWAYS, OBLIQUE] {
        let mut all = Vec::new();
        for number in 0..SEEDS {
            let told = drive(velocity, &times, number);
            assert_eq!(told[5].continuity, Continuity::Repeated);
            assert!(told[5].ranges.iter().all(|range| range.frames == 5), "the frame counts for nothing");
            // The next one is on time, two intervals after what the repeated one shows.
            assert!(matches!(told[6].continuity, Continuity::Shifted { seconds, .. } if seconds > 0.0));
            assert!(told[7..].iter().all(|told| told.continuity == Continuity::Steady));
            all.extend(told);
        }
        assert_honest("repeated", &all);
    }
}

/// Where more is lost than one time tells, all is forgotten, or no distance is told that pretends to be right.
#[test]
fn several_lost_frames_are_never_passed_over() {
    for lost in [2, 3, 5, 8, 13] {
        for velocity in [SIDEWAYS, OBLIQUE] {
            let mut all = Vec::new();
            for number in 0..SEEDS {
                let told = drive(velocity, &later_from(5, 10 * lost), number);
                assert_ne!(told[5].continuity, Continuity::Steady, "{lost}, {velocity:?}, {number}");
                all.extend(told);
            }
            assert_honest(&format!("{lost} lost, {velocity:?}"), &all);
        }
    }
}

/// A row of posts of which each comes to stand where another one stood when as many frames are lost: nothing shows that
/// they were. What is told of one is then true of the other.
#[test]
fn lost_frames_among_posts_alike_do_no_harm() {
    let journey = Journey::vga();
    let posts: Vec<_> = (0..8).map(|k| Post::at(-1.0 + 5.0 * 1.5 * journey.interval_s * f64::from(k), 3.0)).collect();
    let mut all = Vec::new();
    for number in 0..SEEDS {
        let told = drive_past(&posts, tilt_of(TENTH_DEGREE), SIDEWAYS, &later_from(5, 50), number);
        assert!(told.iter().all(|told| told.continuity == Continuity::Steady), "{number}");
        all.extend(told);
    }
    assert_honest("among posts alike", &all);
}

/// In two frames time and depth are the same: edges that no more have shown are forgotten.
#[test]
fn what_two_frames_have_shown_does_not_tell_the_time() {
    for at in [1, 2] {
        for velocity in [SIDEWAYS, OBLIQUE] {
            let mut all = Vec::new();
            for number in 0..SEEDS {
                let told = drive(velocity, &later_from(at, 10), number);
                assert_eq!(told[at].continuity, Continuity::Restarted, "{at}, {velocity:?}, {number}");
                assert!(told[at + 1..].iter().all(|told| told.continuity == Continuity::Steady));
                all.extend(told);
            }
            assert_honest(&format!("lost at {at}"), &all);
        }
    }
}

const DEGREE: f64 = 10.0 * TENTH_DEGREE;

/// Leans of a degree, and a time between frames that may be wrong.
fn loosely_stated() -> Uncertainty<f64> {
    tilt_of(DEGREE).with_sigma_time_s(1e-6)
}

/// With leans of a degree slopes do not tell that a frame was lost between the first two: the second frame then tells
/// of the depth what holds at any time. The third one forgets what these two have shown, be it of many edges or of a
/// few.
#[test]
fn a_frame_lost_before_the_second_is_in_the_sigma() {
    let mut breaches = Vec::new();
    let nothing_between = |tenths| {
        let mut times = later_from(2, tenths);
        times[1] = None;
        times
    };
    let twice = || {
        let mut times = regular(12);
        times[1] = times[0];
        times
    };
    // Of two lost frames three times the depth is told, of more at most three and a third sigma.
    let cases = [
        ("one lost", later_from(1, 10), 93),
        ("two lost", later_from(1, 20), 90),
        ("three lost", later_from(1, 30), 90),
        ("half an interval late", later_from(1, 5), 93),
        ("a tenth late", later_from(1, 1), 93),
        ("a tenth early", later_from(1, -1), 93),
        ("lost after the second", later_from(2, 10), 93),
        // Of two posts there are 48 edges, whose frames err together: one more or less beyond two sigma is 2 %.
        ("twice", twice(), 90),
        ("none found in the second, and two lost", nothing_between(20), 93),
    ];
    for (what, times, least) in cases {
        for (velocity, number_of_posts) in [(SIDEWAYS, 8), (SIDEWAYS, 2), (OBLIQUE, 8), (OBLIQUE, 2)] {
            let mut of_frames: [Vec<f64>; 12] = Default::default();
            for number in 0..3 * SEEDS {
                let posts = &posts_within(DEGREE)[8 - number_of_posts..];
                let told = drive_past(posts, loosely_stated(), velocity, &times, number);
                of_frames.iter_mut().zip(told).for_each(|(of_frame, told)| of_frame.extend(told.errors));
            }
            let worst: Vec<_> =
                of_frames.iter().map(|of| of.iter().fold(0.0_f64, |most, error| most.max(error.abs()))).collect();
            let all: Vec<_> = of_frames.iter().flatten().collect();
            let inside = all.iter().filter(|error| error.abs() < 2.0).count();
            let early = of_frames[1].len() + of_frames[2].len();
            let name = format!("{what}, {velocity:?}, {number_of_posts} posts");
            println!(
                "{name}: {inside} of {} in two sigma, {early} in the second frame or the one after, at most {worst:.1?}",
                all.len(),
            );
            // What came twice tells nothing.
            let is_told = number_of_posts < 8 || what == "twice" || early > 20;
            assert!(all.len() > 200 && is_told, "{name}: {}, {early}", all.len());
            if inside * 100 < all.len() * least || worst.iter().any(|worst| *worst > 5.0) {
                breaches.push(name);
            }
        }
    }
    assert!(breaches.is_empty(), "{breaches:#?}");
}

/// After a torn frame, which nothing is taken of, the time since the one before is that of both intervals: as unsure as
/// both.
#[test]
fn a_torn_frame_between_the_first_two_is_in_the_sigma() {
    let journey = Journey { path: Path::straight(SIDEWAYS), ..Journey::vga() };
    let post = Post::at(0.1, 3.0);
    for (really, told) in [(2, 2), (3, 2), (4, 2)] {
        let random = &mut seed(60 + u64::from(really));
        let setup = journey.setup::<f64>(loosely_stated());
        let (mut ranger, mut sequence) = (SequenceRanger::new(), Sequence::<f64, 4>::new());
        let mut last = None;
        for frame in [0, really] {
            for point in journey.points(&[post], frame, random) {
                ranger.edge_point(&setup, point).expect("sound");
            }
            ranger.end_frame(&setup);
            let known = journey.known(frame, Disturbance::default());
            sequence.frame(&setup, &known, &mut ranger, |range| last = Some(range));
            for _ in 0..told {
                let pose = known.pose(journey.interval_s);
                sequence.advance(&setup, &pose, journey.interval_s, [0.0, 1.0, 0.0]).expect("sound");
            }
        }
        let range: Range<f64> = last.expect("a range");
        let (relative, sigmas) = errors(&range, &journey.truth(&post, really));
        println!("{really} of {told}: {relative:.3}, {sigmas:.2} sigma, {:?}", range.status);
        assert_eq!(range.frames, 2);
        let sigma = range.estimate.sigma_inverse_depth_per_m / range.estimate.inverse_depth_per_m;
        assert!((0.25..0.4).contains(&sigma) && sigmas.abs() < 3.0, "{really} of {told}: {sigma}, {sigmas} sigma");
    }
}

/// Where other edges show that the time is right, the second frame tells the depth of a new one at once.
#[test]
fn known_edges_vouch_for_the_time() {
    let random = &mut seed(50);
    let journey = Journey { path: Path::straight(SIDEWAYS), ..Journey::vga() };
    let (old, new) = (posts_within(DEGREE), Post::at(-1.0, 2.0));
    let mut drive = Drive::new(journey.setup(loosely_stated()), journey.interval_s, |frame| {
        journey.known(frame, Disturbance::default())
    });
    for frame in 0..8 {
        let posts: Vec<_> = old.iter().copied().chain((frame >= 5).then_some(new)).collect();
        let ranges = drive.frame(&journey.points(&posts, frame, random));
        let truth = journey.truth(&new, frame);
        let found = ranges.iter().find(|range| (range.estimate.bearing - truth.bearing).abs() < 0.01);
        if frame >= 6 {
            let (relative, normal) = errors(found.expect("the new post"), &truth);
            assert!(relative.abs() < 0.01 && normal.abs() < 4.0, "{frame}: {relative}, {normal} sigma");
        }
    }
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

/// Speed and rotation rate are wrong within what is stated, by another amount in every frame.
#[test]
fn what_is_stated_of_the_motion_is_no_discontinuity() {
    let uncertainty = tilt_of(TENTH_DEGREE).with_sigma_speed(0.02).with_sigma_rate_rad_s(0.002);
    for velocity in [SIDEWAYS, OBLIQUE] {
        for number in 0..SEEDS {
            let random = &mut seed(number);
            let journey = Journey { path: Path::straight(velocity), ..Journey::vga() };
            let disturbances: Vec<_> = (0..=20)
                .map(|_| Disturbance {
                    speed: 0.02 * normal(random),
                    rate_rad_s: [0.0, 0.002 * normal(random), 0.0],
                    ..Disturbance::default()
                })
                .collect();
            let known = |frame: u32| journey.known(frame, disturbances[frame as usize]);
            let mut drive = Drive::new(journey.setup::<f32>(uncertainty), journey.interval_s, known);
            for frame in 0..20 {
                drive.frame(&journey.points(&posts(), frame, random));
                assert_eq!(drive.sequence.continuity(), Continuity::Steady, "{velocity:?}, {number}, {frame}");
            }
        }
    }
}
