//! Edges that come into view while a sequence is under way.

use shutter_range::RangeStatus;

use crate::journey::{Disturbance, Drive, Journey, Path, Post, errors, seed};
use crate::scenes::{TENTH_DEGREE, tilt_of};

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
