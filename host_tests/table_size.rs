//! How many landmarks a sequence needs: a drive past posts that come into view, pass behind nearer ones, and go.

use shutter_range::{EdgePoint, Motion, RangeStatus, Ranger, Sequence};

use crate::journey::{Disturbance, Journey, Post, seed};
use crate::scenes::{TENTH_DEGREE, line_of, tilt_of};

const FRAMES: u32 = 150;
/// Frames that tell tilt from distance.
const TOLD: u32 = 3;

/// A dozen posts in view: each third one is near, and hides what is behind it within 0.03 of its bearing.
fn posts(frame: u32, journey: &Journey) -> Vec<Post> {
    let x = journey.path.place(journey.start_s(frame)).position_m[0];
    let post = |k: i32| {
        let number = (x / 0.2).round() as i32 + k;
        let depth = if number.rem_euclid(3) == 0 { 1.5 } else { 3.0 + 0.3 * f64::from(number.rem_euclid(7)) };
        Post::at(0.2 * f64::from(number), depth)
    };
    let all: Vec<_> = (-15..=15).map(post).collect();
    let bearing = |post: &Post| journey.truth(post, frame).bearing;
    let is_hidden = |post: &Post| {
        let hides = |other: &Post| other.foot[2] < post.foot[2] && (bearing(other) - bearing(post)).abs() < 0.03;
        all.iter().any(hides)
    };
    all.iter().filter(|post| !is_hidden(post)).copied().collect()
}

/// What a table of so many landmarks tells.
struct Told {
    /// Most lines of a frame.
    lines: usize,
    /// Lines that are told to rest on three frames or more, and all.
    known: usize,
    all: usize,
    dropped: u32,
}

fn drive<const LANDMARKS: usize>() -> Told {
    let random = &mut seed(80);
    let journey = Journey { row_step: 12, interval_s: 0.05, ..Journey::vga() };
    let setup = journey.setup::<f32>(tilt_of(TENTH_DEGREE));
    let limits = setup.limits().with_tentative_gap_rows(24).with_gap_rows(24);
    let setup = setup.with_limits(limits).expect("sound limits");
    let mut ranger = Box::new(Ranger::<64, 16, 64>::new());
    let mut sequence: Sequence<f32, LANDMARKS> = Sequence::new();
    let mut told = Told { lines: 0, known: 0, all: 0, dropped: 0 };
    for frame in 0..FRAMES {
        let points: Vec<EdgePoint> = journey.points(&posts(frame, &journey), frame, random);
        points.iter().for_each(|point| ranger.edge_point(&setup, *point).expect("sound points"));
        ranger.end_frame(&setup);
        let known = journey.known(frame, Disturbance::default());
        let mut lines = 0;
        sequence.frame(&setup, &known, &mut ranger, |range| {
            lines += 1;
            told.all += 1;
            told.known += usize::from(range.frames >= TOLD && range.status == RangeStatus::Ok);
        });
        told.lines = told.lines.max(lines);
        let pose = Motion::<f32>::pose(&known, journey.interval_s as f32);
        sequence.advance(&setup, &pose, journey.interval_s as f32, [0.0, 1.0, 0.0]).expect("sound gravity");
    }
    Told { dropped: sequence.dropped_lines(), ..told }
}

/// A landmark for each line and a quarter more is as good as any number; as many as lines loses little, half as many do
/// not do.
#[test]
fn table_size_is_a_quarter_more_than_lines() {
    let told = [drive::<7>(), drive::<14>(), drive::<18>(), drive::<28>(), drive::<128>()];
    for (size, told) in [7, 14, 18, 28, 128].into_iter().zip(&told) {
        let share = 100.0 * told.known as f64 / told.all as f64;
        println!(
            "{size:>3} landmarks, at most {} lines: {share:.1} % of ranges rest on {TOLD} frames, {} lines dropped",
            told.lines, told.dropped
        );
    }
    let [half, as_many, quarter_more, _, all] = &told;
    let share = |told: &Told| told.known as f64 / told.all as f64;
    assert_eq!(all.lines, 14);
    assert!(share(all) > 0.9 && all.dropped == 0);
    assert!(share(quarter_more) > 0.995 * share(all) && quarter_more.dropped == 0, "{}", share(quarter_more));
    assert!((0.9..0.995).contains(&(share(as_many) / share(all))), "{}", share(as_many));
    assert!(share(half) < 0.7 * share(all) && half.dropped > 0, "{}", share(half));
}

/// A full table gives up what too few frames agree on before an edge that is known, though hidden for longer.
#[test]
fn a_tentative_edge_goes_before_one_that_is_hidden_for_longer() {
    let random = &mut seed(81);
    let journey = Journey::vga();
    let setup = journey.setup(tilt_of(TENTH_DEGREE));
    let [known, weak, new] = [Post::at(-0.3, 2.0), Post::at(0.0, 2.0), Post::at(0.3, 2.0)];
    let mut sequence: Sequence<f64, 2> = Sequence::new();
    let mut told = vec![];
    for (frame, post) in (0..).zip([known, known, known, weak, new, known]) {
        let mut points = journey.points(&[post], frame, random);
        // Seven rows are short.
        points.retain(|point| frame != 3 || (200..207).contains(&point.row));
        let motion = journey.known(frame, Disturbance::default());
        sequence.lines(&setup, &motion, &[line_of::<16>(&points)], |range| told.push((range.line_id, range.frames)));
        let interval_s = journey.interval_s;
        sequence.advance(&setup, &motion.pose(interval_s), interval_s, motion.gravity()).expect("sound gravity");
    }
    // What is short has a name of its own, which is told once frames agree.
    assert_eq!(told, [(Some(0), 1), (Some(0), 2), (Some(0), 3), (None, 1), (Some(2), 1), (Some(0), 4)]);
}
