//! Edges that come into view while a sequence is under way.

use shutter_range::{Continuity, Motion, Polarity, RangeStatus, Sequence};

use crate::journey::{Disturbance, Drive, Journey, Path, Post, errors, seed};
use crate::scenes::{TENTH_DEGREE, line_of, tilt_of};

/// What is told, frame after frame from its first one on, of a post that stands among `known` others from the sixth
/// frame on.
fn statuses(known: u32, number: u64) -> Vec<RangeStatus> {
    let random = &mut seed(number);
    let journey = Journey { path: Path::straight([-1.5, 0.0, 0.0]), ..Journey::vga() };
    let old = (0..known).map(|k| Post::at(-0.1 + 0.5 * f64::from(k), 2.5 + 0.5 * f64::from(k)));
    let (old, new) = (old.collect::<Vec<_>>(), Post::at(-1.0, 2.0));
    let mut drive: Drive<f64, _> = Drive::new(journey.setup(tilt_of(TENTH_DEGREE)), journey.interval_s, |frame| {
        journey.known(frame, Disturbance::default())
    });
    let mut statuses = vec![];
    for frame in 0..10 {
        let posts: Vec<_> = old.iter().copied().chain((frame >= 5).then_some(new)).collect();
        let ranges = drive.frame(&journey.points(&posts, frame, random));
        let truth = journey.truth(&new, frame);
        if frame >= 5 {
            let found = ranges.iter().find(|range| (range.estimate.bearing - truth.bearing).abs() < 0.01);
            let found = found.expect("the new post");
            let (_, sigmas) = errors(found, &truth);
            assert!(sigmas.abs() < 4.5, "{known} known, seed {number}, frame {frame}: {sigmas}");
            statuses.push(found.status);
        }
    }
    statuses
}

/// Among edges that are known a new one is a chance line as often as not: three frames must agree.
#[test]
fn a_newcomer_among_known_edges_waits_for_three_frames() {
    use RangeStatus::{Ok, Tentative};
    for number in 0..4 {
        assert_eq!(statuses(6, number), [Tentative, Tentative, Ok, Ok, Ok], "seed {number}");
    }
}

/// Where few edges are known they do not tell what else there is.
#[test]
fn a_newcomer_beside_few_known_edges_is_told_at_once() {
    for number in 0..4 {
        assert_eq!(statuses(2, number), [RangeStatus::Ok; 5], "seed {number}");
    }
}

/// What comes into view wholly beside a known edge has columns that are those of neither: it is told as tentative, and
/// begins no landmark until it stands clear.
#[test]
fn what_is_half_hidden_by_a_known_edge_is_tentative() {
    for number in 0..4 {
        let random = &mut seed(number);
        let journey = Journey { path: Path::straight([-1.5, 0.0, 0.0]), ..Journey::vga() };
        let near = Post::at(-0.1, 2.0);
        let mut drive: Drive<f64, _> = Drive::new(journey.setup(tilt_of(TENTH_DEGREE)), journey.interval_s, |frame| {
            journey.known(frame, Disturbance::default())
        });
        for frame in 0..4 {
            // In the last frame 5 px beside the near one, and twice as far.
            let column = journey.truth(&near, 3).bearing + 5.0 / 600.0;
            let far = Post::at(4.0 * column + journey.path.place(journey.start_s(3)).position_m[0], 4.0);
            let posts = if frame < 3 { vec![near] } else { vec![near, Post { polarity: Polarity::Falling, ..far }] };
            let ranges = drive.frame(&journey.points(&posts, frame, random));
            let told = |polarity| {
                let range = ranges.iter().find(|range| range.polarity == polarity).expect("a range");
                (range.status, range.line_id, range.frames)
            };
            assert_eq!(told(Polarity::Rising), (RangeStatus::Ok, Some(0), frame + 1), "seed {number}");
            if frame == 3 {
                assert_eq!(told(Polarity::Falling), (RangeStatus::Tentative, None, 1), "seed {number}");
            }
        }
        assert_eq!(drive.sequence.landmarks(), 1);
    }
}

/// Where nearly no edge is where it should be all are forgotten, and each line stands for itself: the few that are in
/// place do not make newcomers of all others.
#[test]
fn after_a_restart_nothing_is_a_newcomer() {
    let random = &mut seed(5);
    let journey = Journey::vga();
    let setup = journey.setup(tilt_of(TENTH_DEGREE));
    // Four that stay, and 20 of which others take the place.
    let staying = (0..4).map(|k| Post::at(-1.1 + 0.1 * f64::from(k), 2.5));
    let coming = (0..20).map(|k| Post::at(3.0 * (-0.26 + 0.035 * f64::from(k)), 3.0));
    let before: Vec<_> = staying.clone().chain(coming.clone()).collect();
    let falling = |post: Post| Post { polarity: Polarity::Falling, ..post };
    let after: Vec<_> = staying.chain(coming.map(falling)).collect();
    let mut sequence: Sequence<f64, 64> = Sequence::new();
    for frame in 0..5 {
        let posts = if frame < 4 { &before } else { &after };
        let lines: Vec<_> = posts.iter().map(|post| line_of::<16>(&journey.points(&[*post], frame, random))).collect();
        let motion = journey.known(frame, Disturbance::default());
        let mut ranges = vec![];
        sequence.lines(&setup, &motion, &lines, |range| ranges.push(range));
        if frame == 4 {
            assert_eq!(sequence.continuity(), Continuity::Restarted);
            assert!(ranges.iter().all(|range| (range.status, range.frames) == (RangeStatus::Ok, 1)), "{ranges:#?}");
        }
        let interval_s = journey.interval_s;
        sequence.advance(&setup, &motion.pose(interval_s), interval_s, motion.gravity()).expect("sound gravity");
    }
}

/// Edges of the first frame that pass each other in the next ones are not new, although these teach nothing of them.
#[test]
fn known_edges_that_pass_each_other_stay_told() {
    let path = Path { rate_rad_s: [0.05, -0.3, 0.1], ..Path::straight([-1.5, 0.05, 0.2]) };
    let journey = Journey { path, ..Journey::vga() };
    let post = |k: u32| {
        let depth_m = 1.0 + f64::from(k % 5);
        let polarity = if k.is_multiple_of(2) { Polarity::Rising } else { Polarity::Falling };
        Post { polarity, ..Post::at((0.06 * f64::from(k) - 0.45) * depth_m, depth_m) }
    };
    let posts: Vec<_> = (0..16).map(post).collect();
    for number in 0..4 {
        let random = &mut seed(number);
        let mut drive: Drive<f64, _> = Drive::new(journey.setup(tilt_of(TENTH_DEGREE)), journey.interval_s, |frame| {
            journey.known(frame, Disturbance::default())
        });
        for frame in 0..6 {
            let ranges = drive.frame(&journey.points(&posts, frame, random));
            let told = ranges.iter().filter(|range| range.status == RangeStatus::Ok).count();
            assert!(told >= 14, "seed {number}, frame {frame}: {told} of {}", ranges.len());
        }
    }
}
