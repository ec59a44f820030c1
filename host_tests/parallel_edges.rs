//! Two parallel edges of one polarity, close together: from dark over grey to bright, and the other way round. Both are
//! lines, each where its edge is, and one blurred edge is no two.

use shutter_range::sim::{Background, Bar, Exposure, Scene};
use shutter_range::{Polarity, Range, RangeStatus, Ranger, Scanner, Uncertainty};

use crate::rendered::{Frame, TOP, moving, ranges_of, render, scene_of};
use crate::scanning::scan;

const ROWS: f64 = 240.0;
const FOCAL_PX: f64 = 300.0;
const CENTRE_PX: f64 = 159.5;
const DARK: f64 = 40.0;
/// Of noise, one sigma at grey level 140: 2.5 levels.
const EXPOSURE: Exposure = Exposure { time_s: 0.0001, psf_sigma_px: 0.7, read_noise: 2.0, shot_gain: 0.015 };
/// An edge is a line if one has so many of its rows and lies so near to it.
const LEAST_SHARE: f64 = 0.8;
const MOST_OFF_PX: f64 = 1.0;

/// Two steps, one behind the other, both 1 m away.
#[derive(Clone, Copy, Debug)]
struct Staircase {
    blur_px: f32,
    apart_px: f64,
    /// Grey levels of the steps, from the darker side on.
    steps: [f64; 2],
    polarity: Polarity,
    speed_m_s: f64,
    seed: u64,
}

impl Staircase {
    /// Columns of the edges in the first row.
    fn columns(&self) -> [f64; 2] {
        let first = 180.0 + 0.37 * (self.seed % 16) as f64;
        [first, first + self.apart_px]
    }

    fn frame(&self) -> Frame {
        let [first, second] = self.steps;
        let levels = [DARK, DARK + first, DARK + first + second];
        let is_rising = self.polarity == Polarity::Rising;
        let [left, middle, right] = if is_rising { levels } else { [levels[2], levels[1], levels[0]] };
        let mut scene: Scene<2> = Scene::new(Background::plain(left as f32)).expect("sound background");
        let [first_px, second_px] = self.columns();
        for (from_px, depth_m, level) in [(first_px, 1.0, middle), (second_px, 0.9999, right)] {
            const WIDTH_M: f64 = 2.0;
            let bearing = (from_px - CENTRE_PX) / FOCAL_PX + WIDTH_M / 2.0 / depth_m;
            scene
                .push(Bar::upright(bearing as f32, depth_m as f32, WIDTH_M as f32, level as f32))
                .expect("a sound bar");
        }
        let exposure = Exposure { psf_sigma_px: self.blur_px, ..EXPOSURE };
        render(&scene, &moving(self.speed_m_s), TOP, exposure, self.seed).0
    }

    fn ranges(&self) -> Vec<Range<f32>> {
        let world = moving(self.speed_m_s);
        let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
        ranges_of(&mut *Box::new(Ranger::<32, 16, 64>::new()), &setup, &world, &self.frame())
    }

    /// What the frame shows of each edge.
    fn tally(&self, tally: &mut Tally) {
        let found = self.ranges();
        let moved_px = FOCAL_PX * self.speed_m_s / 30.0;
        let mut seen = 0;
        for column_px in self.columns() {
            let off_px = |range: &Range<f32>| {
                let of = |column: f32, row| f64::from(column) - (column_px - moved_px * f64::from(row) / ROWS);
                let ends =
                    [of(range.column_at_first_row, range.first_row), of(range.column_at_last_row, range.last_row)];
                (ends[0] + ends[1]) / 2.0
            };
            let is_its = |range: &&Range<f32>| {
                range.polarity == self.polarity
                    && f64::from(range.points) >= LEAST_SHARE * ROWS
                    && off_px(range).abs() < MOST_OFF_PX.min(self.apart_px / 2.0)
            };
            if let Some(range) = found.iter().filter(is_its).min_by(|a, b| off_px(a).abs().total_cmp(&off_px(b).abs()))
            {
                seen += 1;
                tally.edges += 1;
                let off = off_px(range);
                tally.columns += off * off;
                // Outwards.
                tally.outwards += if column_px == self.columns()[0] { -off } else { off };
                let sigma = f64::from(range.estimate.sigma_inverse_depth_per_m);
                let error = f64::from(range.estimate.inverse_depth_per_m) - 1.0;
                tally.depths += error * error;
                tally.normal += error * error / (sigma * sigma);
                tally.covered += u32::from(error.abs() < 2.0 * sigma);
                tally.ok += u32::from(range.status == RangeStatus::Ok);
            }
        }
        tally.frames[seen] += 1;
        tally.others += found.iter().filter(|range| range.status == RangeStatus::Ok).count() as i32 - seen as i32;
    }
}

/// Of many frames.
#[derive(Default)]
struct Tally {
    /// That show none, one, or both of the edges.
    frames: [u32; 3],
    edges: u32,
    columns: f64,
    outwards: f64,
    depths: f64,
    normal: f64,
    covered: u32,
    ok: u32,
    others: i32,
}

impl Tally {
    fn print(&self, of: &str) {
        let n = f64::from(self.edges.max(1));
        let mean = |sum: f64| sum / n;
        println!(
            "{of}: {:?}, ok {:.2}, others {}, rms {:.3} px, outwards {:+.3} px, depth {:.2} %, {:.2} sigma, {:.2} in 2",
            self.frames,
            f64::from(self.ok) / n,
            self.others,
            mean(self.columns).sqrt(),
            mean(self.outwards),
            100.0 * mean(self.depths).sqrt(),
            mean(self.normal).sqrt(),
            f64::from(self.covered) / n
        );
    }
}

/// Both polarities, phases and seeds.
fn tally(blur_px: f32, apart_px: f64, steps: [f64; 2], frames: u64) -> Tally {
    let mut tally = Tally::default();
    for seed in 0..frames {
        let polarity = if seed % 2 == 0 { Polarity::Rising } else { Polarity::Falling };
        let speed_m_s = if seed / 2 % 2 == 0 { 1.5 } else { 0.7 };
        Staircase { blur_px, apart_px, steps, polarity, speed_m_s, seed: seed + 3 }.tally(&mut tally);
    }
    tally
}

impl Tally {
    /// Both edges are lines in so much of the frames, and these are right: as far off as they state, and columns by no
    /// more than so much.
    fn assert_both(&self, of: &str, least_share: f64, most_off_px: f64) {
        self.print(of);
        let [_, _, both] = self.frames;
        let (frames, edges) = (f64::from(self.frames.iter().sum::<u32>()), f64::from(self.edges.max(1)));
        assert!(f64::from(both) >= least_share * frames, "{of}: {:?}", self.frames);
        assert!(self.ok == self.edges && f64::from(self.covered) >= 0.88 * edges, "{of}: {} of {edges}", self.covered);
        assert!((self.normal / edges).sqrt() < 1.3, "{of}: {} sigma", (self.normal / edges).sqrt());
        assert!((self.columns / edges).sqrt() < most_off_px, "{of}: {} px", (self.columns / edges).sqrt());
    }
}

const FRAMES: u64 = 16;

/// 200 grey levels in two equal steps: from 4 px apart at a blur of up to 1 px, and at 2 px from 7 px. What the other's
/// blur draws aside is alike in all rows: the column is off by it, the distance is not.
#[test]
fn two_equal_steps_are_two_lines() {
    for (blur_px, apart_px, most_off_px) in [
        (0.5, 4.0, 0.02),
        (0.7, 4.0, 0.06),
        (1.0, 4.0, 0.15),
        (1.0, 5.0, 0.08),
        (1.5, 6.0, 0.15),
        (2.0, 7.0, 0.2),
        (2.0, 8.0, 0.15),
        (0.7, 8.0, 0.02),
        (2.0, 12.0, 0.04),
    ] {
        let of = format!("blur {blur_px} px, {apart_px} px apart");
        tally(blur_px, apart_px, [100.0; 2], FRAMES).assert_both(&of, 1.0, most_off_px);
    }
}

/// The weaker step is 50 grey levels: from 4 px apart at a blur of up to 0.7 px, at 1 px from 5 px.
#[test]
fn a_step_beside_one_three_times_as_strong_is_a_line() {
    for (blur_px, apart_px, most_off_px) in [(0.5, 4.0, 0.02), (0.7, 4.0, 0.06), (1.0, 5.0, 0.08), (1.0, 6.0, 0.04)] {
        for steps in [[50.0, 150.0], [150.0, 50.0], [67.0, 133.0]] {
            let of = format!("blur {blur_px} px, {apart_px} px apart, {steps:?}");
            tally(blur_px, apart_px, steps, FRAMES).assert_both(&of, 1.0, most_off_px);
        }
    }
}

/// Noise of a fifteenth of each step.
#[test]
fn fainter_steps_are_two_lines() {
    for (blur_px, apart_px) in [(0.5, 4.0), (1.0, 5.0), (1.0, 6.0)] {
        let of = format!("blur {blur_px} px, {apart_px} px apart");
        tally(blur_px, apart_px, [40.0; 2], FRAMES).assert_both(&of, 1.0, 0.08);
    }
}

/// However it is blurred, by the lens or by motion, which makes a slope of one steepness.
#[test]
fn one_blurred_edge_is_one_line() {
    let noisy = Exposure::default();
    let clean = Exposure { read_noise: 0.0, shot_gain: 0.0, ..noisy };
    for (exposure, contrast) in [(noisy, 120.0), (noisy, 60.0), (clean, 30.0)] {
        for (lens_px, path_px) in [
            (1.5, 0.0),
            (2.0, 0.0),
            (3.0, 0.0),
            (0.7, 5.0),
            (0.7, 7.0),
            (0.7, 9.0),
            (0.7, 12.0),
            (0.7, 16.0),
            (1.5, 8.0),
        ] {
            for seed in 1..4 {
                const SPEED_M_S: f64 = 1.5;
                let time_s = path_px / (FOCAL_PX as f32 * SPEED_M_S as f32);
                let exposure = Exposure { time_s, psf_sigma_px: lens_px, ..exposure };
                let scene = scene_of(DARK as f32, [Bar::upright(1.1, 1.0, 2.0, DARK as f32 + contrast).into()]);
                let world = moving(SPEED_M_S);
                let setup = world.setup_read::<f32>(Uncertainty::NONE, TOP);
                let frame = render(&scene, &world, TOP, exposure, seed).0;
                let found = ranges_of(&mut *Box::new(Ranger::<32, 16, 64>::new()), &setup, &world, &frame);
                let of = format!("lens {lens_px} px, path {path_px} px, contrast {contrast}, seed {seed}");
                assert!(
                    matches!(found[..], [Range { status: RangeStatus::Ok, points: 200.., .. }]),
                    "{of}: {found:#?}"
                );
            }
        }
    }
}

/// Light that flickers, or the half-shadow of something, makes a slope sag without any noise.
#[test]
fn an_uneven_slope_is_one_edge() {
    const STEEPNESS: i32 = 24;
    for (sag, edges) in [(4, 1), (8, 2)] {
        let slope = [[STEEPNESS; 3], [STEEPNESS - sag; 3], [STEEPNESS; 3]].concat();
        let level = |column: usize| 20 + slope.iter().take(column.saturating_sub(160)).sum::<i32>();
        let row: Vec<u8> = (0..320).map(|column| level(column) as u8).collect();
        let mut scanner = Scanner::new();
        for _ in 0..20 {
            let found = scan(&mut scanner, &row);
            assert_eq!(found.len(), edges, "sag {sag} of {STEEPNESS}: {found:?}");
        }
    }
}
