//! Bars side by side: every edge at least four pixels from the next is a line, and so is a post beside them; and rows
//! that cannot be read are counted.

use rand::{Rng, SeedableRng, rngs::StdRng};
use shutter_range::sim::{Background, Bar, Exposure, Scene, Texture};
use shutter_range::{Polarity, RangeStatus, Ranger, Uncertainty};

use crate::rendered::{Frame, TOP, moving, ranges_of, render};

const ROWS: f64 = 240.0;
const COLUMNS: f64 = 320.0;
const FOCAL_PX: f64 = 300.0;
const CENTRE_PX: f64 = 159.5;
/// All of it is 1 m away.
const SPEED_M_S: f64 = 1.5;
/// So far it moves to the left in a frame.
const MOVED_PX: f64 = FOCAL_PX * SPEED_M_S / 30.0;
const DARK: f32 = 40.0;
const EXPOSURE: Exposure = Exposure { time_s: 0.002, psf_sigma_px: 0.7, read_noise: 2.0, shot_gain: 0.03 };
/// Edges nearer to the border or to each other are not asked for.
const BORDER_PX: f64 = 12.0;
const APART_PX: f64 = 4.0;
/// An edge is a line if it is followed along so much of the frame, and right if its inverse depth is off by less than
/// the second number.
const LEAST_SHARE: f64 = 0.8;
const MOST_ERROR: f32 = 0.05;

/// Bars from the left border on, and a post beside them where there is room.
struct Fence {
    period_px: f64,
    /// Share of a period that a bar takes, and of the row that the fence takes.
    duty: f64,
    share: f64,
    contrast: f32,
}

impl Fence {
    /// Where bars begin and end in the first row.
    fn bars(&self) -> Vec<[f64; 2]> {
        let count = ((COLUMNS + MOVED_PX) * self.share / self.period_px) as usize;
        let left = |bar: usize| 0.3 + self.period_px * bar as f64;
        let post_px = left(count) + 24.0;
        let post = (post_px + 20.0 < COLUMNS - BORDER_PX).then_some([post_px, post_px + 20.0]);
        let bar = |index| [left(index), left(index) + self.duty * self.period_px];
        (0..count).map(bar).chain(post).collect()
    }

    fn frame(&self, seed: u64) -> Frame {
        let bearing = |column: f64| (column - CENTRE_PX) / FOCAL_PX;
        let mut scene: Scene<80> = Scene::new(Background::plain(DARK)).expect("sound background");
        for [left, right] in self.bars() {
            let (middle, width) = (bearing((left + right) / 2.0), (right - left) / FOCAL_PX);
            let bar = Bar::upright(middle as f32, 1.0, width as f32, DARK + self.contrast);
            scene.push(bar).expect("a sound bar");
        }
        render(&scene, &moving(SPEED_M_S), TOP, EXPOSURE, seed).0
    }

    /// Edges in the first row that the frame shows whole, and far enough from the next.
    fn edges(&self) -> Vec<(f64, Polarity)> {
        let bars = self.bars();
        let edges = || bars.iter().flat_map(|[left, right]| [(*left, Polarity::Rising), (*right, Polarity::Falling)]);
        let is_alone = |column: f64| {
            edges().filter(|(other, _)| *other != column).all(|(other, _)| (other - column).abs() > APART_PX - 1e-6)
        };
        let is_shown = |column: f64| column - MOVED_PX > BORDER_PX && column < COLUMNS - BORDER_PX;
        edges().filter(|(column, _)| is_shown(*column) && is_alone(*column)).collect()
    }

    /// How many of the edges are ranged rightly, and how many there are.
    fn counts(&self, seed: u64) -> [usize; 2] {
        let world = moving(SPEED_M_S);
        let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
        let mut ranger = Box::new(Ranger::<128, 16, 128>::new());
        let found = ranges_of(&mut *ranger, &setup, &world, &self.frame(seed));
        let edges = self.edges();
        let is_right = |(column, polarity): &&(f64, Polarity)| {
            found.iter().any(|range| {
                let began_px = column - MOVED_PX * f64::from(range.first_row) / ROWS;
                range.polarity == *polarity
                    && range.status == RangeStatus::Ok
                    && f64::from(range.points) >= LEAST_SHARE * ROWS
                    && (f64::from(range.column_at_first_row) - began_px).abs() < 1.0
                    && (range.estimate.inverse_depth_per_m - 1.0).abs() < MOST_ERROR
            })
        };
        [edges.iter().filter(is_right).count(), edges.len()]
    }
}

const PERIODS_PX: [f64; 12] = [5.0, 7.0, 8.0, 9.3, 10.0, 12.0, 13.0, 16.0, 20.0, 24.0, 32.0, 40.0];

/// Edges of fences of all periods, shares and duties that are ranged rightly, in per cent.
fn percent_of(contrast: f32) -> f64 {
    let (mut right, mut all) = (0, 0);
    for share in [0.2, 0.5, 1.0] {
        for duty in [0.3, 0.5, 0.7] {
            for period_px in PERIODS_PX {
                let [of_fence, edges] = Fence { period_px, duty, share, contrast }.counts(5);
                if of_fence < edges {
                    println!(
                        "contrast {contrast}, share {share}, duty {duty}, {period_px} px: {of_fence} of {edges} edges"
                    );
                }
                (right, all) = (right + of_fence, all + edges);
            }
        }
    }
    let percent = 100.0 * right as f64 / all as f64;
    println!("contrast {contrast}: {percent:.1} % of {all} edges");
    percent
}

#[test]
fn edges_of_fences_are_lines() {
    // The densest fences pass for texture that is as strong across as a contrast of 15.
    for (contrast, least) in [(200.0, 99.5), (110.0, 99.5), (40.0, 99.5), (15.0, 95.0)] {
        let percent = percent_of(contrast);
        assert!(percent >= least, "contrast {contrast}: {percent:.1} %");
    }
}

/// Ranges that are `ok`, and crowded rows.
fn crowded_rows_of<const LINES: usize, const POINTS: usize>(frame: &Frame) -> (usize, u32) {
    let world = moving(SPEED_M_S);
    let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
    let mut ranger = Box::new(Ranger::<LINES, 16, POINTS>::new());
    let found = ranges_of(&mut *ranger, &setup, &world, frame);
    let right = found.iter().filter(|range| range.status == RangeStatus::Ok).count();
    (right, ranger.counters().crowded_rows)
}

#[test]
fn rows_that_cannot_be_read_are_counted() {
    let fence = Fence { period_px: 8.0, duty: 0.5, share: 0.9, contrast: 110.0 }.frame(7);
    // More edges than the table of lines holds: a full one keeps its lines.
    let (right, crowded_rows) = crowded_rows_of::<16, 128>(&fence);
    assert!((14..=16).contains(&right) && crowded_rows >= 220, "{right}, {crowded_rows}");
    // More than a row's buffer holds.
    let (_, crowded_rows) = crowded_rows_of::<128, 16>(&fence);
    assert!(crowded_rows >= 2, "{crowded_rows}");
    // As many as there is room for: but for the first rows, which cannot tell a fence from texture.
    let (_, crowded_rows) = crowded_rows_of::<128, 128>(&fence);
    println!("{crowded_rows} of a fence for which there is room");
    assert!(crowded_rows <= 5, "{crowded_rows}");
    // And no fence.
    let bars = Fence { period_px: 40.0, duty: 0.5, share: 0.5, contrast: 110.0 }.frame(7);
    let (right, crowded_rows) = crowded_rows_of::<16, 64>(&bars);
    assert!(right >= 8 && crowded_rows == 0, "{right}, {crowded_rows}");
}

/// Texture everywhere hides what is no stronger than itself.
#[test]
fn rows_of_texture_are_counted_where_it_hides_edges() {
    let rows_of = |contrast: f32| {
        let texture = Texture { contrast, cell: 4.0 / FOCAL_PX as f32, seed: 3 };
        let mut scene: Scene<1> = Scene::new(Background::textured(128.0, texture)).expect("sound background");
        scene.push(Bar::upright(0.0, 1.0, 0.1, 150.0)).expect("a sound bar");
        crowded_rows_of::<128, 128>(&render(&scene, &moving(SPEED_M_S), TOP, EXPOSURE, 4).0).1
    };
    let crowded_rows = [8.0, 30.0, 60.0, 90.0].map(rows_of);
    println!("{crowded_rows:?}");
    assert_eq!(crowded_rows[0], 0);
    assert!(crowded_rows[3] > 200, "{crowded_rows:?}");
}

/// Rows of nothing but noise as strong as edges count, also those that are passed over since nothing is in view.
#[test]
fn rows_of_noise_are_counted() {
    let mut random = StdRng::seed_from_u64(8);
    let setup = moving(SPEED_M_S).setup::<f32>();
    let mut ranger: Ranger<16, 16, 64> = Ranger::new();
    for row in 0..ROWS as u16 {
        let pixels: [u8; COLUMNS as usize] = core::array::from_fn(|_| random.random_range(40..216));
        ranger.row(&setup, row, &pixels).expect("rows in order");
    }
    let crowded_rows = ranger.counters().crowded_rows;
    assert!(crowded_rows + 4 > ROWS as u32, "{crowded_rows}");
}
