//! An edge is where it was seen and no farther: what stands above or below it is another one.

use core::ops::Range as Rows;

use shutter_range::{EdgePoint, Motion, Range, RangeStatus, Sequence};

use crate::journey::{Disturbance, Journey, Post, errors, seed};
use crate::scenes::{TENTH_DEGREE, line_of, tilt_of};

/// A nearer post of some rows, and a farther one of others, which pass through the same columns while the camera
/// drives by: what a sequence tells of their lines in each of its frames.
fn drive_past(rows: [Rows<u16>; 2], number: u64) -> (Journey, [Post; 2], Vec<Vec<Range<f64>>>) {
    let random = &mut seed(number);
    let journey = Journey::vga();
    let posts = [Post::at(-0.24, 2.0), Post::at(-0.3, 3.0)];
    let setup = journey.setup(tilt_of(TENTH_DEGREE));
    let mut sequence: Sequence<f64, 4> = Sequence::new();
    let told = (0..8).map(|frame| {
        let lines = [0, 1].map(|which| {
            let mut points = journey.points(&[posts[which]], frame, random);
            points.retain(|point| rows[which].contains(&point.row));
            line_of::<16>(&points)
        });
        let motion = journey.known(frame, Disturbance::default());
        let mut ranges = vec![];
        sequence.lines(&setup, &motion, &lines, |range| ranges.push(range));
        let interval_s = journey.interval_s;
        sequence.advance(&setup, &motion.pose(interval_s), interval_s, motion.gravity()).expect("sound gravity");
        ranges
    });
    let told = told.collect();
    (journey, posts, told)
}

/// What comes into view in line with an edge, but above or below it, is not that edge: the two may well be at different
/// depths.
#[test]
fn what_continues_an_edge_beyond_its_end_is_another_one() {
    let random = &mut seed(3);
    let journey = Journey::vga();
    let post = Post::at(-0.24, 2.0);
    let setup = journey.setup(tilt_of(TENTH_DEGREE));
    let mut sequence: Sequence<f64, 4> = Sequence::new();
    let mut told = vec![];
    for (frame, rows) in (0..).zip([0..200, 0..200, 0..200, 180..400, 300..480]) {
        let mut points = journey.points(&[post], frame, random);
        points.retain(|point| rows.contains(&point.row));
        let motion = journey.known(frame, Disturbance::default());
        sequence.lines(&setup, &motion, &[line_of::<16>(&points)], |range| told.push((range.line_id, range.frames)));
        let interval_s = journey.interval_s;
        sequence.advance(&setup, &motion.pose(interval_s), interval_s, motion.gravity()).expect("sound gravity");
    }
    assert_eq!(told, [(Some(0), 1), (Some(0), 2), (Some(0), 3), (Some(1), 1), (Some(1), 2)]);
}

/// Columns of both posts in the middle of the image, one beside the other.
fn apart_px(journey: &Journey, posts: &[Post; 2], frame: u32) -> f64 {
    let [near, far] = posts.map(|post| journey.column(&post, frame, 240).expect("in the image"));
    near - far
}

/// One above the other: each is updated in every frame, and neither by the other's rows.
#[test]
fn edges_above_each_other_are_two() {
    for number in 0..4 {
        let (journey, posts, told) = drive_past([270..480, 0..210], number);
        assert!(apart_px(&journey, &posts, 0) < -8.0 && apart_px(&journey, &posts, 7) > 8.0, "they pass each other");
        for (frame, ranges) in (0..).zip(&told) {
            for (post, range) in posts.iter().zip(ranges) {
                assert_eq!((range.status, range.frames), (RangeStatus::Ok, frame + 1), "seed {number}: {range:?}");
                let (_, sigmas) = errors(range, &journey.truth(post, frame));
                assert!(sigmas.abs() < 4.5, "seed {number}, frame {frame}: {sigmas}");
                assert_drawn_in_place(range, &journey, post, frame);
            }
        }
    }
}

/// A line is told where it is in this frame, whatever was known of it.
fn assert_drawn_in_place(range: &Range<f64>, journey: &Journey, post: &Post, frame: u32) {
    let ends = [(range.first_row, range.column_at_first_row), (range.last_row, range.column_at_last_row)];
    for (row, column) in ends {
        let truth = journey.column(post, frame, row).expect("in the image");
        assert!((column - truth).abs() < 0.25, "frame {frame}, row {row}: {column}, not {truth}");
    }
}

/// Of edges that share some rows only these are left out while they pass each other: the others still tell.
#[test]
fn only_rows_that_edges_share_are_left_out() {
    let mut shared_alone = 0;
    for number in 0..4 {
        let (journey, posts, told) = drive_past([180..480, 0..220], number);
        for (frame, ranges) in (0..).zip(&told).skip(2) {
            let is_beside = apart_px(&journey, &posts, frame).abs() < 6.0;
            for (post, range) in posts.iter().zip(ranges) {
                assert_eq!((range.status, range.frames), (RangeStatus::Ok, frame + 1), "seed {number}: {range:?}");
                let (_, sigmas) = errors(range, &journey.truth(post, frame));
                assert!(sigmas.abs() < 4.5, "seed {number}, frame {frame}: {sigmas}");
                assert_drawn_in_place(range, &journey, post, frame);
                shared_alone += u32::from(is_beside && range.points_used < range.points);
            }
        }
    }
    assert!(shared_alone > 0, "while they pass each other some rows are left out");
}

/// The line of a known edge that runs on past its end, along something beside it: what it has told stays, and only the
/// rows of the edge itself count.
#[test]
fn where_a_line_runs_on_past_a_known_edge_it_is_left_out() {
    for number in 0..4 {
        let random = &mut seed(number);
        let journey = Journey::vga();
        let post = Post::at(-0.24, 2.0);
        let setup = journey.setup(tilt_of(TENTH_DEGREE));
        let mut sequence: Sequence<f64, 4> = Sequence::new();
        for frame in 0..6 {
            let mut points = journey.points(&[post], frame, random);
            let beyond = |point: &&mut EdgePoint| frame > 3 && point.row >= 290;
            points.iter_mut().filter(beyond).for_each(|point| point.column_q16 += 2 << 16);
            let motion = journey.known(frame, Disturbance::default());
            let mut told = vec![];
            sequence.lines(&setup, &motion, &[line_of::<16>(&points)], |range| told.push(range));
            let [range] = told.as_slice() else { panic!("{told:#?}") };
            assert_eq!((range.status, range.frames), (RangeStatus::Ok, frame + 1), "seed {number}: {range:?}");
            let (relative, sigmas) = errors(range, &journey.truth(&post, frame));
            assert!(sigmas.abs() < 4.5, "seed {number}, frame {frame}: {sigmas}");
            assert!(frame < 3 || relative.abs() < 0.003, "seed {number}, frame {frame}: {relative}");
            assert!(frame < 4 || (200..300).contains(&range.points_used), "{}", range.points_used);
            let interval_s = journey.interval_s;
            sequence.advance(&setup, &motion.pose(interval_s), interval_s, motion.gravity()).expect("sound gravity");
        }
    }
}
