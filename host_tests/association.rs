//! Which line of a frame is which edge of those before: what is near, hidden, crossing or hardly known is not mixed up.

use shutter_range::{EdgePoint, Range, RangeStatus, Scalar};

use crate::journey::{Disturbance, Drive, Journey, Path, Post, errors, normal, seed};
use crate::rendered::MOST_SIGMAS;
use crate::scenes::{HALF_DEGREE, TENTH_DEGREE, tilt_of};

/// Ranges of each of the posts, which are told apart by their true bearing.
fn of_posts(ranges: &[Range<f64>], journey: &Journey, posts: &[Post], frame: u32) -> Vec<Option<Range<f64>>> {
    let of_post = |post: &Post| {
        let truth = journey.truth(post, frame);
        let is_near = |range: &&Range<f64>| (range.estimate.bearing - truth.bearing).abs() < 0.004;
        ranges.iter().filter(|range| range.polarity == post.polarity && is_near(range)).copied().next()
    };
    posts.iter().map(of_post).collect()
}

/// A row of posts of which each comes to lie, frame after frame, where another one was.
#[test]
fn association_is_by_prediction() {
    let random = &mut seed(7);
    let journey = Journey { path: Path::straight([-1.5, 0.0, 0.0]), ..Journey::vga() };
    // 15 px a frame, and posts 16 px apart: the nearest column is the wrong post.
    let posts: Vec<_> = (0..8).map(|k| Post::at(-0.6 + f64::from(k) * 16.0 * 2.0 / 600.0, 2.0)).collect();
    let setup = journey.setup(tilt_of(TENTH_DEGREE));
    let mut drive = Drive::new(setup, journey.interval_s, |frame| journey.known(frame, Disturbance::default()));
    for frame in 0..10 {
        let ranges = drive.frame(&journey.points(&posts, frame, random));
        for (number, range) in (0..).zip(of_posts(&ranges, &journey, &posts, frame)) {
            let range = range.expect("each post has its range");
            assert_eq!(range.frames, frame + 1, "post {number}, frame {frame}: {range:?}");
            let (relative, _) = errors(&range, &journey.truth(&posts[number], frame));
            // Three frames tell tilt from distance; the neighbour's column would be wrong by a quarter.
            assert!(frame < 2 || relative.abs() < 0.005, "post {number}, frame {frame}: {relative}");
        }
    }
}

/// A post that passes behind a nearer one is found again on its other side, under its own name.
#[test]
fn an_edge_is_found_again_beyond_an_occluder() {
    let random = &mut seed(8);
    let journey = Journey { path: Path::straight([-1.5, 0.0, 0.0]), ..Journey::vga() };
    let (near, far) = (Post::at(-0.5, 1.5), Post::at(-0.2, 3.0));
    let hidden = |frame: u32| {
        let bearing = |post| journey.truth(post, frame).bearing;
        // The nearer one is 0.06 wide to the left of its right edge.
        (-0.08..0.02).contains(&(bearing(&far) - bearing(&near)))
    };
    let setup = journey.setup(tilt_of(TENTH_DEGREE));
    let mut drive = Drive::new(setup, journey.interval_s, |frame| journey.known(frame, Disturbance::default()));
    let (mut was_hidden, mut ids) = (0, None);
    for frame in 0..24 {
        let posts = if hidden(frame) { vec![near] } else { vec![near, far] };
        was_hidden += u32::from(hidden(frame));
        let ranges = drive.frame(&journey.points(&posts, frame, random));
        let found = of_posts(&ranges, &journey, &posts, frame);
        let now: Vec<_> = found.iter().map(|range| range.expect("a range").line_id.expect("a name")).collect();
        let ids = ids.get_or_insert_with(|| now.clone());
        assert_eq!(now, ids[..posts.len()], "frame {frame}");
    }
    assert!((3..20).contains(&was_hidden), "hidden for a while, but not for most of the 24 frames: {was_hidden}");
    // Left of it at first, right of it at last.
    let side = |frame| journey.truth(&far, frame).bearing > journey.truth(&near, frame).bearing;
    assert!(side(0) && !side(23));
}

/// While two posts cross, their blended columns move neither; before and after, each is what it was.
#[test]
fn crossing_edges_keep_what_was_known() {
    let random = &mut seed(12);
    let journey = Journey::vga();
    let posts = [Post::at(-0.5, 1.5), Post::at(-0.54, 1.8)];
    let setup = journey.setup(tilt_of(TENTH_DEGREE));
    let mut drive = Drive::new(setup, journey.interval_s, |frame| journey.known(frame, Disturbance::default()));
    let mut ids: Option<Vec<_>> = None;
    let mut mixed = 0;
    for frame in 0..16 {
        let apart_px = |row| {
            let column = |post| journey.column(post, frame, row).expect("in the image");
            column(&posts[1]) - column(&posts[0])
        };
        // Nearer than seven pixels, a detector sees both half way to each other.
        let pull = |point: &EdgePoint| {
            let apart = apart_px(point.row);
            let of_first =
                (point.column_px::<f64>() - journey.column(&posts[0], frame, point.row).expect("seen")).abs() < 1.0;
            let pulled = if apart.abs() > 7.0 { 0.0 } else { apart / 4.0 * if of_first { 1.0 } else { -1.0 } };
            EdgePoint { column_q16: point.column_q16 + (pulled * 65536.0) as i32, ..*point }
        };
        let points: Vec<_> = journey.points(&posts, frame, random).iter().map(pull).collect();
        mixed += u32::from(apart_px(0).abs().min(apart_px(479).abs()) < 7.0);
        let ranges = drive.frame(&points);
        for range in ranges.iter().filter(|range| range.frames > 2 && range.status == RangeStatus::Ok) {
            let error = |post: &Post| errors(range, &journey.truth(post, frame)).0.abs();
            // The posts are 17 % apart in inverse depth: an estimate that a blend has moved would lie between them.
            assert!(posts.iter().any(|post| error(post) < 0.01), "frame {frame}: {range:?}");
        }
        if frame == 0 || frame == 15 {
            let found = of_posts(&ranges, &journey, &posts, frame);
            let now = found.iter().map(|range| range.expect("a range").line_id).collect();
            assert_eq!(
                ids.get_or_insert(now),
                &found.iter().map(|range| range.expect("seen").line_id).collect::<Vec<_>>()
            );
        }
    }
    assert!(mixed > 2, "they cross in several frames: {mixed}");
}

/// A camera that hardly moves, then loses a frame and is fast: each edge may be where the other one is, and only how it
/// runs tells which it is.
#[test]
fn edges_that_are_hardly_known_are_not_exchanged() {
    const PAIRS: usize = 200;
    const SLOW_M_S: f64 = 0.04;
    const FAST_M_S: f64 = -1.75;
    // Of some thousand ranges chance takes none so far off, and the other edge is farther.
    const EXCHANGED_SIGMAS: f64 = 6.0;
    let random = &mut seed(17);
    let journey = |speed_m_s| Journey { path: Path::straight([speed_m_s, 0.0, 0.0]), row_step: 4, ..Journey::vga() };
    let (slow, fast) = (journey(SLOW_M_S), journey(FAST_M_S));
    // From its second frame on, the world of the fast journey lies where the slow one has left it.
    let shifted_m = (FAST_M_S - SLOW_M_S) * slow.interval_s;
    let at = |frame| if frame == 0 { &slow } else { &fast };
    let mut ok = 0;
    for pair in 0..PAIRS {
        let mut drive = Drive::new(slow.setup::<f64>(tilt_of(HALF_DEGREE)), slow.interval_s, |frame| {
            at(frame).known(frame, Disturbance::default())
        });
        let posts = [(-0.57, 5.75), (-0.227, 3.4)].map(|(x, z)| Post::at(x, z).leaning(HALF_DEGREE * normal(random)));
        let of_fast = posts.map(|post| {
            let [x, y, z] = post.foot;
            Post { foot: [x + shifted_m, y, z], ..post }
        });
        for frame in 0..6 {
            let seen = if frame == 0 { &posts } else { &of_fast };
            let points = if frame == 1 { Vec::new() } else { at(frame).points(seen, frame, random) };
            for range in drive.frame(&points).iter().filter(|range| range.status == RangeStatus::Ok) {
                let off = |post: &&Post| (at(frame).truth(post, frame).bearing - range.estimate.bearing).abs();
                let nearest = seen.iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("two posts");
                let (_, normal) = errors(range, &at(frame).truth(nearest, frame));
                assert!(normal.abs() < EXCHANGED_SIGMAS, "pair {pair}, frame {frame}: {normal} sigma, {range:?}");
                ok += 1;
            }
        }
    }
    assert!(ok > PAIRS * 6, "{ok}");
}

/// A camera that stands still at first has nothing to remember but bearings; it must not mix its edges up when it moves
/// off.
#[test]
fn a_start_from_standstill_mixes_no_edges_up() {
    fn check<S: Scalar>() {
        let random = &mut seed(13);
        let still = Journey { path: Path::straight([0.0; 3]), ..Journey::vga() };
        let moving = Journey { path: Path::straight([-1.5, 0.0, 0.0]), ..Journey::vga() };
        let posts =
            [Post::at(-0.4, 2.0).leaning(HALF_DEGREE), Post::at(-0.2, 2.5).leaning(-HALF_DEGREE), Post::at(0.1, 2.2)];
        let setup = still.setup::<S>(tilt_of(HALF_DEGREE));
        let at_rest = |frame| if frame < 5 { &still } else { &moving };
        let known = |frame| at_rest(frame).known(frame, Disturbance::default());
        let mut drive = Drive::new(setup, still.interval_s, known);
        for frame in 0..12 {
            let ranges = drive.frame(&at_rest(frame).points(&posts, frame, random));
            assert_eq!(ranges.len(), 3);
            for (range, post) in ranges.iter().zip(&posts) {
                let (_, normal) = errors(range, &at_rest(frame).truth(post, frame));
                if frame < 5 {
                    assert_eq!(range.status, RangeStatus::Slow);
                } else {
                    assert!(normal.abs() < MOST_SIGMAS, "frame {frame}: {normal} sigma, {range:?}");
                    assert_eq!(range.frames, frame - 4, "frame {frame}");
                    assert!(frame == 5 || range.status == RangeStatus::Ok, "frame {frame}: {range:?}");
                }
            }
        }
    }
    check::<f32>();
    check::<f64>();
}
