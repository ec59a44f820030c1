//! Frames whose content is torn: rows are missing, two frames are mixed, bytes are lost, or the light is pulsed.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use shutter_range::sim::{Background, Bar, Exposure, Scene};
use shutter_range::{EdgePoint, Ranger, RowError, Setup, Uncertainty};

use crate::rendered::{Frame, ROWS, TOP, moving, render};

/// Time of a row, as [`moving`] has it.
const ROW_S: f64 = 1.0 / 30.0 / 240.0;

/// Three posts before a camera that passes them.
struct Passing {
    posts: [Bar; 3],
    speed_m_s: f64,
    seed: u64,
}

/// As seen after the camera has moved to the right.
fn moved(post: Bar, by_m: f64) -> Bar {
    Bar { bearing: post.bearing - by_m as f32 / post.depth_m, ..post }
}

impl Passing {
    fn at_random(random: &mut StdRng) -> Self {
        let post = |x: f32, random: &mut StdRng| {
            let depth_m = random.random_range(0.6..3.0);
            Bar::upright(
                x + random.random_range(-0.08..0.08),
                depth_m,
                random.random_range(0.05..0.1) * depth_m,
                random.random_range(30.0..90.0),
            )
        };
        let posts = [-0.3, 0.0, 0.3].map(|x| post(x, random));
        let speed_m_s = random.random_range(1.0..3.0) * if random.random() { 1.0 } else { -1.0 };
        Self { posts, speed_m_s, seed: random.random() }
    }

    /// The frame as it is seen after the camera has moved on for a time.
    fn frame(&self, after_s: f64) -> Frame {
        let mut scene = Scene::<3>::new(Background::plain(180.0)).expect("a sound background");
        for post in self.posts {
            scene.push(moved(post, self.speed_m_s * after_s)).expect("a sound post");
        }
        render(&scene, &moving(self.speed_m_s), TOP, Exposure::default(), self.seed).0
    }

    /// By how far the farthest post moves in a time, in pixels.
    fn least_move_px(&self, time_s: f64) -> f64 {
        let moves = self.posts.map(|post| 300.0 * self.speed_m_s.abs() * time_s / f64::from(post.depth_m));
        moves.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// As seen after a time by a camera that stands still from then on.
    fn at_rest_after(&self, time_s: f64) -> Self {
        let posts = self.posts.map(|post| moved(post, self.speed_m_s * time_s));
        Self { posts, speed_m_s: 0.0, ..*self }
    }
}

/// The row at which a frame is found torn, by a ranger with room for what begins there.
fn jump_of(passing: &Passing, frame: &Frame) -> Option<u16> {
    let setup = moving(passing.speed_m_s).setup_read::<f32>(Uncertainty::NONE, TOP);
    jump_in(&mut Ranger::<32, 10, 32>::new(), &setup, frame)
}

fn jump_in<const LINES: usize, const POINTS: usize>(
    ranger: &mut Ranger<LINES, 10, POINTS>,
    setup: &Setup<f32>,
    frame: &Frame,
) -> Option<u16> {
    (0..ROWS).find_map(|row| match ranger.row(setup, row, &frame[usize::from(row)]) {
        Err(RowError::Jump { row }) => Some(row),
        _ => None,
    })
}

/// So many of twenty frames that `tear` has torn are found torn, within three rows of where they are.
fn assert_noticed(name: &str, of_twenty: usize, mut tear: impl FnMut(&Passing, &mut StdRng) -> Option<(Frame, usize)>) {
    const FRAMES: usize = 60;
    let mut random = StdRng::seed_from_u64(29);
    let mut torn = Vec::new();
    while torn.len() < FRAMES {
        let passing = Passing::at_random(&mut random);
        if let Some((frame, row)) = tear(&passing, &mut random) {
            torn.push((jump_of(&passing, &frame), row));
        }
    }
    let is_near = |jump: Option<u16>, row: usize| jump.is_some_and(|jump| usize::from(jump).abs_diff(row) <= 3);
    let noticed = torn.iter().filter(|(jump, row)| is_near(*jump, *row)).count();
    assert!(20 * noticed >= of_twenty * FRAMES, "{name}: {noticed} of {FRAMES}: {torn:?}");
}

/// The first rows of a frame, and the last ones of another.
fn mixed(first: &Frame, second: &Frame, row: usize) -> Frame {
    first[..row].iter().chain(&second[row..]).cloned().collect()
}

#[test]
fn missing_rows_are_noticed() {
    assert_noticed("missing rows", 19, |passing, random| {
        let (row, rows) = (random.random_range(30..180), random.random_range(5..40));
        let after_s = f64::from(rows) * ROW_S;
        (passing.least_move_px(after_s) > 1.0).then(|| (mixed(&passing.frame(0.0), &passing.frame(after_s), row), row))
    });
}

#[test]
fn mixed_frames_are_noticed() {
    assert_noticed("mixed frames", 19, |passing, random| {
        let row = random.random_range(30..200);
        Some((mixed(&passing.frame(0.0), &passing.frame(240.0 * ROW_S), row), row))
    });
}

#[test]
fn lost_bytes_are_noticed() {
    assert_noticed("lost bytes", 19, |passing, random| {
        let (row, bytes) = (random.random_range(30..200), random.random_range(2..160));
        let mut frame = passing.frame(0.0);
        frame[row..].iter_mut().for_each(|pixels| pixels.rotate_left(bytes));
        Some((frame, row))
    });
}

/// Each row sees the one pulse within its exposure: the edges stand still for as long as the rows see the same, and
/// jump. The nearer an edge, the farther: fewer are beyond chance.
#[test]
fn pulsed_light_is_noticed() {
    assert_noticed("pulsed light", 15, |passing, random| {
        let pulse_rows = random.random_range(24..70_usize);
        (passing.least_move_px(pulse_rows as f64 * ROW_S) > 1.0).then(|| {
            let pulse = |index: usize| passing.at_rest_after((index * pulse_rows) as f64 * ROW_S).frame(0.0);
            let pulses: Vec<_> = (0..=usize::from(ROWS) / pulse_rows + 1).map(pulse).collect();
            let start = random.random_range(0..pulse_rows - 12);
            let row = |row: usize| pulses[(row + start) / pulse_rows][row].clone();
            ((0..usize::from(ROWS)).map(row).collect(), pulse_rows - start)
        })
    });
}

fn assert_none_in(frames: u32) {
    let mut random = StdRng::seed_from_u64(30);
    for _ in 0..frames {
        let passing = Passing::at_random(&mut random);
        assert_eq!(jump_of(&passing, &passing.frame(0.0)), None);
    }
}

/// More lines than are asked: a fence of 24 bars.
#[test]
fn a_fence_that_is_torn_is_noticed() {
    let world = moving(1.5);
    let fence = |after_s: f64| {
        let mut scene = Scene::<24>::new(Background::plain(180.0)).expect("a sound background");
        for index in 0..24_u8 {
            let bar = Bar::upright(f32::from(index) * 0.043 - 0.5, 2.0, 0.04, 60.0);
            scene.push(moved(bar, 1.5 * after_s)).expect("a sound bar");
        }
        render(&scene, &world, TOP, Exposure::default(), 3).0
    };
    let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
    let jump = |frame: &Frame| jump_in(&mut Ranger::<128, 10, 128>::new(), &setup, frame);
    for row in [40, 120, 200] {
        let torn = mixed(&fence(0.0), &fence(0.01), row);
        assert!(jump(&torn).is_some_and(|jump| usize::from(jump).abs_diff(row) <= 3), "{:?} for {row}", jump(&torn));
    }
    assert_eq!(jump(&fence(0.0)), None);
}

#[test]
fn whole_frames_do_not_jump() {
    assert_none_in(200);
}

#[test]
#[ignore = "half a minute; `whole_frames_do_not_jump` takes the first 200 of them"]
fn ten_thousand_whole_frames_do_not_jump() {
    assert_none_in(10_000);
}

/// Given points tell nothing of the light: edges that begin beside others are no pulses.
#[test]
fn points_are_no_light() {
    let setup = moving(1.5).setup_read::<f32>(Uncertainty::NONE, TOP);
    let mut ranger = Ranger::<32, 10, 32>::new();
    for row in 0..ROWS {
        for edge in 0..8_u16 {
            let column_q16 = i32::from(20 + 36 * edge) << 16;
            let begun = if row >= 9 + edge / 2 { 2 } else { 1 };
            for beside in 0..begun {
                let point = EdgePoint::new(row, column_q16 + ((beside * 6) << 16), setup.readout().row_time_ns(row));
                ranger.edge_point(&setup, point).expect("edges that all go on");
            }
        }
    }
    ranger.end_frame(&setup);
    let lines: Vec<u16> = std::iter::from_fn(|| ranger.next_line()).map(|line| line.points()).collect();
    assert_eq!(lines.len(), 16, "{lines:?}");
}
