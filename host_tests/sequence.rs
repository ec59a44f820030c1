//! Lines continued from frame to frame: what several frames tell of tilt and distance, which edge is which, and what
//! moves.

use shutter_range::{Continuity, EdgePoint, ErrorSource, Polarity, Q32, Range, RangeStatus, Scalar, Sigmas};

use crate::journey::{Disturbance, Drive, Journey, Path, Post, errors, follow, normal, seed};
use crate::scenes::{TENTH_DEGREE, tilt_of};

const HALF_DEGREE: f64 = 5.0 * TENTH_DEGREE;
/// Where the chance of a normally distributed error is one in 16000.
const MOST_SIGMAS: f64 = 4.0;

#[test]
fn five_frames_tell_tilt_from_distance() {
    fn check<S: Scalar>() {
        let journey = Journey::vga();
        let post = Post::at(0.1, 2.0).leaning(HALF_DEGREE);
        let found = follow::<S>(&journey, Disturbance::default(), tilt_of(HALF_DEGREE), &post, 5, &mut seed(1));
        for (frame, (range, relative, normal)) in (0..).zip(&found) {
            println!("frame {frame}: {:+.3} %, {normal:+.2} sigma", relative * 100.0);
            assert_eq!((range.status, range.line_id, range.frames), (RangeStatus::Ok, Some(0), frame + 1));
            assert!(normal.abs() < MOST_SIGMAS, "frame {frame}: {normal} sigma");
        }
        let (first, last) = (&found[0], &found[4]);
        // Half a degree over a slope of 0.031 px per row is 28 %, but for noise; after five frames the README promises
        // 0.1 %.
        assert!((0.2..0.35).contains(&first.1.abs()), "{}", first.1);
        assert!(last.1.abs() < 0.001, "{}", last.1);
        let estimate = &last.0.estimate;
        let tilt_error = (estimate.tilt.to_f64() - HALF_DEGREE).abs();
        assert!(tilt_error < MOST_SIGMAS * estimate.sigma_tilt.to_f64(), "{estimate:?}");
        // The columns of five frames tell a thousandth of it; at a twentieth the prior no longer counts.
        assert!(estimate.sigma_tilt.to_f64() < HALF_DEGREE / 20.0);
        assert_eq!(first.0.estimate.budget.dominant(), ErrorSource::Lean);
    }
    check::<f64>();
    check::<f32>();
    check::<Q32>();
}

/// An edge that is stated to be upright stays so in every frame, however badly the rotation is known: no tilt is
/// fitted.
#[test]
fn what_is_stated_to_be_upright_stays_upright() {
    fn check<S: Scalar>() {
        let uncertainty =
            tilt_of::<S>(0.0).with_sigma_rate_rad_s(S::from_f64(0.005)).with_sigma_speed(S::from_f64(0.01));
        for (path, number) in [[0.0; 3], [0.03, 0.1, -0.02]].into_iter().zip(40..) {
            let path = Path { rate_rad_s: path, ..Path::straight([-1.5, 0.0, 0.3]) };
            let journey = Journey { path, ..Journey::vga() };
            let off = Disturbance { rate_rad_s: [0.003, 0.004, -0.005], ..Disturbance::default() };
            let found = follow::<S>(&journey, off, uncertainty, &Post::at(0.1, 2.0), 6, &mut seed(number));
            for (frame, (range, _, normal)) in (0..).zip(&found) {
                let estimate = &range.estimate;
                assert_eq!((range.status, range.frames), (RangeStatus::Ok, frame + 1));
                assert_eq!((estimate.tilt.to_f64(), estimate.sigma_tilt.to_f64()), (0.0, 0.0), "{frame}: {estimate:?}");
                assert!(normal.abs() < MOST_SIGMAS, "frame {frame}: {normal} sigma");
            }
        }
    }
    check::<f64>();
    check::<f32>();
    check::<Q32>();
}

/// Where an edge wanders, it wanders alike in all of its frames: parallax does not mind, and neither does the sigma.
#[test]
fn the_wander_of_an_edge_is_common_to_its_frames() {
    let journey = Journey::vga();
    let setup = journey.setup::<f64>(tilt_of(HALF_DEGREE).with_edge_roughness_px(0.03));
    // Sigma and error in sigmas of the fifth frame, for a short edge with a wander of so many pixels.
    let fifth = |number: u64, wander_px: f64| {
        let random = &mut seed(100 + number);
        let post = Post::at(0.1, 2.0).leaning(HALF_DEGREE * normal(random));
        let phases = [normal(random), normal(random)].map(|phase| 3.0 * phase);
        let mut drive = Drive::new(setup, journey.interval_s, |frame| journey.known(frame, Disturbance::default()));
        let mut last = None;
        for frame in 0..5 {
            let points =
                journey.points(&[post], frame, random).into_iter().filter(|point| (200..300).contains(&point.row));
            let wandering = |point: EdgePoint| {
                let [slow, fast] = phases;
                let (slow, fast) = (f64::from(point.row) / 15.0 + slow, f64::from(point.row) / 6.0 + fast);
                let off_px = wander_px * (slow.sin() + fast.sin());
                EdgePoint { column_q16: point.column_q16 + (off_px * 65536.0) as i32, ..point }
            };
            last = drive.frame(&points.map(wandering).collect::<Vec<_>>()).first().copied();
        }
        let range: Range<f64> =
            last.filter(|range: &Range<f64>| range.status == RangeStatus::Ok && range.frames >= 4)?;
        Some((range.estimate.sigma_inverse_depth_per_m, errors(&range, &journey.truth(&post, 4)).1))
    };
    let all = |wander_px| (0..40).filter_map(|number| fifth(number, wander_px)).collect::<Vec<_>>();
    let (straight, wandering) = (all(0.0), all(0.08));
    let mean = |all: &[(f64, f64)]| all.iter().map(|(sigma, _)| sigma).sum::<f64>() / all.len() as f64;
    let ratio = mean(&wandering) / mean(&straight);
    let inside = wandering.iter().filter(|(_, normal)| normal.abs() < 2.0).count();
    let told = wandering.len();
    println!("sigma {:.5} and {ratio:.2} times it, {inside} of {told} in two sigma", mean(&straight));
    assert!(told >= 36 && (0.9..1.3).contains(&ratio) && inside * 10 >= told * 9, "{ratio}, {inside} of {told}");
}

/// A speed of its own: relative to the camera, the object's velocity is the difference.
fn overtaken(frames: u32, path: impl Fn(u32) -> Path) -> Vec<Range<f64>> {
    let random = &mut seed(5);
    let post = Post::at(0.0, 2.0).moving([-0.5, 0.0, 0.0]);
    let journey = |frame| Journey { path: path(frame), ..Journey::vga() };
    let setup = journey(0).setup(tilt_of(TENTH_DEGREE));
    let known = |frame| journey(frame).known(frame, Disturbance::default());
    let mut drive = Drive::new(setup, journey(0).interval_s, known);
    let frame = |frame| drive.frame(&journey(frame).points(&[post], frame, random));
    (0..frames).map(frame).map(|ranges| *ranges.first().expect("a range")).collect()
}

#[test]
fn a_moving_object_looks_static_until_the_camera_changes_its_speed() {
    let statuses = |ranges: &[Range<f64>]| ranges.iter().map(|range| range.status).collect::<Vec<_>>();
    let steady = Path::straight([-1.5, 0.0, 0.0]);
    let ranges = overtaken(30, |_| steady);
    assert!(statuses(&ranges).iter().all(|status| *status == RangeStatus::Ok), "{:?}", statuses(&ranges));
    // It seems to be where a static one would be overtaken as fast, to the 0.1 % of five frames and more.
    assert!((ranges[29].estimate.inverse_depth_per_m - 0.5 / 1.5).abs() < 0.001);

    let braking = |frame: u32| if frame < 10 { steady } else { Path { acceleration_m_s2: [2.0, 0.0, 0.0], ..steady } };
    let braked = statuses(&overtaken(15, braking));
    assert!(braked[..10].iter().all(|status| *status == RangeStatus::Ok), "{braked:?}");
    assert!(braked[11..].contains(&RangeStatus::Moving), "{braked:?}");
    let first = braked.iter().position(|status| *status == RangeStatus::Moving).expect("seen above");
    assert!(braked[first..].iter().all(|status| *status == RangeStatus::Moving), "{braked:?}");
}

/// Statuses and names of a post that is seen in some of 46 frames, and that may stand elsewhere from frame 10 on.
fn told_of_a_post(moves_m: f64, is_seen: impl Fn(u32) -> bool) -> Vec<Option<(RangeStatus, Option<u32>)>> {
    let random = &mut seed(21);
    let journey = Journey { path: Path::straight([-0.4, 0.0, 0.0]), ..Journey::vga() };
    let setup = journey.setup::<f64>(tilt_of(TENTH_DEGREE));
    let mut drive = Drive::new(setup, journey.interval_s, |frame| journey.known(frame, Disturbance::default()));
    let frame = |frame| {
        let post = Post::at(if frame < 10 { -0.4 } else { -0.4 + moves_m }, 2.0);
        let points = if is_seen(frame) { journey.points(&[post], frame, random) } else { vec![] };
        drive.frame(&points).first().map(|range| (range.status, range.line_id))
    };
    (0..46).map(frame).collect()
}

/// By 1.8 px, which is neither noise nor another post.
#[test]
fn what_has_moved_is_static_again_after_thirty_frames() {
    let told = told_of_a_post(0.006, |_| true);
    let is_moving = |frame: usize| told[frame].is_some_and(|(status, _)| status == RangeStatus::Moving);
    assert!((0..46).all(|frame| is_moving(frame) == (10..40).contains(&frame)), "{told:?}");
}

#[test]
fn what_is_hidden_is_remembered_for_thirty_frames() {
    for (hidden, is_remembered) in [(30, true), (31, false)] {
        let told = told_of_a_post(0.0, |frame| !(5..5 + hidden).contains(&frame));
        let name = |frame: usize| told[frame].expect("a range").1.expect("a name");
        assert_eq!(name(4) == name(45), is_remembered, "{hidden} frames: {told:?}");
    }
}

/// The paper's other half: a camera at rest before an object that moves is the same with the relative velocity.
#[test]
fn a_still_camera_ranges_a_moving_object() {
    let random = &mut seed(6);
    let still = Journey { path: Path::straight([0.0; 3]), ..Journey::vga() };
    let post = Post::at(-0.3, 3.0).moving([1.2, 0.0, -0.4]);
    let relative = Journey { path: Path::straight([-1.2, 0.0, 0.4]), ..Journey::vga() };
    let setup = still.setup::<f64>(tilt_of(TENTH_DEGREE));
    let mut drive = Drive::new(setup, still.interval_s, |frame| relative.known(frame, Disturbance::default()));
    for frame in 0..8 {
        let ranges = drive.frame(&still.points(&[post], frame, random));
        let [range] = ranges.as_slice() else { panic!("{ranges:#?}") };
        let (relative, normal) = errors(range, &still.truth(&post, frame));
        assert_eq!((range.status, range.frames), (RangeStatus::Ok, frame + 1));
        // Two frames tell tilt from distance, to a part of the 0.1 % of five frames at 2 m.
        let is_near = frame < 2 || relative.abs() < 0.002;
        assert!(normal.abs() < MOST_SIGMAS && is_near, "{frame}: {relative}, {normal} sigma");
    }
}

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

/// However fast it turns, a camera that does not move measures no distance.
#[test]
fn pure_rotation_gives_no_distance() {
    let random = &mut seed(9);
    let path = Path { rate_rad_s: [0.1, 0.4, -0.2], ..Path::straight([0.0; 3]) };
    let journey = Journey { path, ..Journey::vga() };
    let post = Post::at(-0.4, 2.0);
    for (range, _, _) in follow(&journey, Disturbance::default(), tilt_of::<f64>(TENTH_DEGREE), &post, 5, random) {
        assert_eq!(range.status, RangeStatus::Slow);
        assert_eq!(range.depth(Sigmas(2.0)).estimate_m, None);
        assert!(range.depth(Sigmas(2.0)).farthest_m.is_none());
    }
}

/// More posts than the table has room for: those that are refused are counted and still have their ranges.
#[test]
fn a_full_table_refuses_and_counts() {
    let random = &mut seed(10);
    let journey = Journey::vga();
    let posts: Vec<_> = (0..6).map(|k| Post::at(-0.5 + 0.2 * f64::from(k), 2.0)).collect();
    let setup = journey.setup::<f64>(tilt_of(TENTH_DEGREE));
    let mut ranger = crate::journey::SequenceRanger::new();
    let mut sequence = shutter_range::Sequence::<f64, 4>::new();
    for point in journey.points(&posts, 0, random) {
        ranger.edge_point(&setup, point).expect("sound");
    }
    ranger.end_frame(&setup);
    let mut ids = Vec::new();
    sequence.frame(&setup, &journey.known(0, Disturbance::default()), &mut ranger, |range| {
        assert_eq!(range.status, RangeStatus::Ok);
        ids.push(range.line_id);
    });
    assert_eq!((ids.len(), ids.iter().flatten().count()), (6, 4));
    assert_eq!((sequence.landmarks(), sequence.dropped_lines()), (4, 2));
}

/// Hours of driving past posts that come and go: bounded memory, and every line of every frame is accounted for.
#[test]
fn a_long_drive_loses_no_line() {
    // 15 km, and fewer where they take longer.
    const FRAMES: u32 = if cfg!(debug_assertions) { 20_000 } else { 100_000 };
    let random = &mut seed(11);
    let journey = Journey { row_step: 40, interval_s: 0.1, ..Journey::vga() };
    let setup = journey.setup::<f32>(tilt_of(TENTH_DEGREE));
    let mut ranger = crate::journey::SequenceRanger::new();
    let mut sequence = shutter_range::Sequence::<f32, 8>::new();
    let limits = setup.limits().with_tentative_gap_rows(80).with_gap_rows(80).with_min_points(3);
    let setup = setup.with_limits(limits).expect("sound limits");
    let (mut told, mut ok, mut squares, mut ids) = (0_u64, 0_u64, 0.0, 0);
    for frame in 0..FRAMES {
        // A post every metre, 2 to 5 m away, wherever the camera has got to.
        let x = journey.path.place(journey.start_s(frame)).position_m[0];
        let posts: Vec<_> = (-2..3_i32)
            .map(|k| {
                let number = x.round() as i32 + k;
                let polarity = if number % 2 == 0 { Polarity::Rising } else { Polarity::Falling };
                Post { polarity, ..Post::at(f64::from(number), 2.0 + f64::from(number.rem_euclid(4))) }
            })
            .collect();
        let points: Vec<EdgePoint> = journey.points(&posts, frame, random);
        let shown = posts.iter().filter(|post| points_of(&journey, post, frame) >= 8).count() as u64;
        for point in points {
            ranger.edge_point(&setup, point).expect("sound");
        }
        ranger.end_frame(&setup);
        let known = journey.known(frame, Disturbance::default());
        let mut of_frame = 0_u64;
        sequence.frame(&setup, &known, &mut ranger, |range| {
            of_frame += 1;
            ids = ids.max(range.line_id.unwrap_or(0));
            let bearing = f64::from(range.estimate.bearing);
            let near = |post: &&Post| {
                post.polarity == range.polarity && (journey.truth(post, frame).bearing - bearing).abs() < 0.01
            };
            if let Some(post) = posts.iter().find(near).filter(|_| range.status == RangeStatus::Ok) {
                ok += 1;
                squares += errors(&range, &journey.truth(post, frame)).1.powi(2);
            }
        });
        assert!(of_frame >= shown, "frame {frame}: {of_frame} of {shown}");
        assert_eq!(sequence.continuity(), Continuity::Steady, "frame {frame}");
        told += of_frame;
        let interval_s = journey.interval_s as f32;
        let pose = shutter_range::Motion::<f32>::pose(&known, interval_s);
        sequence.advance(&setup, &pose, interval_s, [0.0, 1.0, 0.0]).expect("sound gravity");
    }
    println!("{told} ranges, {ok} ok, {ids} posts, mean square {:.2}", squares / ok as f64);
    // One name for each post that came by: one every metre, of which less than 1 % are named twice or never.
    let metres = FRAMES / 100 * 15;
    assert!(ids.abs_diff(metres) * 150 < metres, "{ids}");
    assert_eq!(
        (sequence.dropped_lines(), ranger.counters().dropped_lines, ranger.counters().dropped_points),
        (0, 0, 0)
    );
    // Posts that have just come into view are not yet ok; errors of a post's frames go together, so their mean square
    // wavers.
    assert!(ok * 10 > told * 9 && (0.5..2.0).contains(&(squares / ok as f64)));
}

fn points_of(journey: &Journey, post: &Post, frame: u32) -> usize {
    let rows = (0..journey.camera.rows).step_by(journey.row_step);
    rows.filter(|row| journey.column(post, frame, *row).is_some()).count()
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

/// A landmark takes at most 208 bytes in single precision, as the documentation says: what a table of 16 adds for each.
#[test]
fn a_landmark_takes_at_most_208_bytes() {
    let [small, large] = [size_of::<shutter_range::Sequence<f32, 8>>(), size_of::<shutter_range::Sequence<f32, 16>>()];
    let landmark = (large - small) / 8;
    println!("{landmark} bytes, and {}", small - 8 * landmark);
    assert!(landmark <= 208, "{landmark}");
    assert!(small - 8 * landmark <= 48);
}
