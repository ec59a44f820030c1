//! Frames drawn at random: four posts before a VGA camera that passes them, as a sensor has them before a camera makes
//! eight bits of its pixels.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use shutter_range::sim::{Background, Bar, Exposure, Pipeline, Scene, Simulator, Stage, Texture};
use shutter_range::{Polarity, Range, Ranger, ReadoutDirection, RowError, Setup, Twist, Uncertainty};

use crate::projection;

pub(crate) const COLUMNS: usize = 640;

/// A frame in 1/256 of a grey level.
pub(crate) type Sensor = Vec<[u16; COLUMNS]>;
pub(crate) type Frame = Vec<[u8; COLUMNS]>;

/// As large as on a desktop.
pub(crate) type LargeRanger = Ranger<256, 64, 2048>;

/// On the heap. Not inlined: the copy on the stack would be in the frame of each caller for good, and a test's thread
/// has 2 MiB.
#[inline(never)]
pub(crate) fn large_ranger() -> Box<LargeRanger> {
    Box::new(LargeRanger::new())
}

/// What kind of posts stand there, and how they are seen.
#[derive(Clone, Copy)]
pub(crate) struct Kind {
    /// Each edge leans by itself, one sigma as a slope.
    pub(crate) sigma_tilt: f64,
    /// Wander of the edges, one sigma in pixels, over ten rows.
    pub(crate) roughness_px: f64,
    /// Sagitta of the edges, in pixels.
    pub(crate) bow_px: f64,
    /// Cylinders before a bright background, lit at this angle from one side or the other.
    pub(crate) light_rad: Option<f32>,
    /// Lens blur in the middle and in the corners, in pixels.
    pub(crate) lens_px: [f32; 2],
    /// Grey levels of posts and background, either way round.
    pub(crate) levels: [f32; 2],
    /// By how much the background is darker here and brighter there, over some 400 px; its posts are then the brighter
    /// ones.
    pub(crate) uneven: f32,
    pub(crate) read_noise: f32,
    /// Motion blur within these bounds; `None`: exposures of 2 to 8 ms.
    pub(crate) blur_px: Option<[f64; 2]>,
}

impl Kind {
    pub(crate) const STRAIGHT: Self = Self {
        sigma_tilt: 0.0,
        roughness_px: 0.0,
        bow_px: 0.0,
        light_rad: None,
        lens_px: [0.7, 0.7],
        levels: [60.0, 170.0],
        uneven: 0.0,
        read_noise: 2.5,
        blur_px: None,
    };

    pub(crate) const fn leaning(sigma_tilt: f64) -> Self {
        Self { sigma_tilt, ..Self::STRAIGHT }
    }
}

/// One edge: its straight line, and the rows that show it.
pub(crate) struct DrawnEdge {
    line: projection::Scene,
    rows: [u16; 2],
    /// Dark to bright from left to right.
    is_rising: bool,
}

/// A frame, its edges and what was to be known of it.
pub(crate) struct Shot {
    kind: Kind,
    pub(crate) world: projection::Scene,
    pub(crate) exposure_s: f64,
    pub(crate) edges: Vec<DrawnEdge>,
    pub(crate) sensor: Sensor,
}

const HEIGHT_M: f64 = 1.0;
const WIDTH_M: f64 = 0.12;
/// Variance per grey level.
const SHOT_GAIN: f32 = 0.03;
/// Share of a cylinder's light that comes from everywhere.
const AMBIENT: f32 = 0.15;

/// Slopes are at least so many sigmas of the lean: of the steepest of those leans, two in a hundred leave less than the
/// three sigmas that make a range `ok`.
const LEAST_SIGMAS: f64 = 5.0;

/// Least speed per depth in 1/s.
const LEAST_RATE_PER_S: f64 = 0.5;

impl Shot {
    /// 1 to 5 m away, 1 to 3 m/s to either side.
    pub(crate) fn new(kind: &Kind, seed: u64) -> Self {
        let random = &mut StdRng::seed_from_u64(seed);
        let (world, exposure_s) = view(kind, random);
        let [dark, bright] = kind.levels;
        let is_dark = (random.random() || kind.light_rad.is_some()) && kind.uneven == 0.0;
        let (level, background) = if is_dark { (dark, bright) } else { (bright, dark) };
        let texture = Texture { contrast: kind.uneven, cell: 0.7, seed: random.random() };
        let mut scene = Scene::<4>::new(Background::textured(background, texture)).expect("sound background");
        let mut edges = Vec::new();
        for place in [-0.4, -0.133, 0.133, 0.4] {
            let (post, [left, right]) = post(kind, &world, place, random);
            scene.push(Bar { level, ..post }).expect("a sound bar");
            edges.push(DrawnEdge { is_rising: !is_dark, ..left });
            edges.push(DrawnEdge { is_rising: is_dark, ..right });
        }
        let exposure = Exposure {
            time_s: exposure_s as f32,
            psf_sigma_px: kind.lens_px[0],
            read_noise: kind.read_noise,
            shot_gain: SHOT_GAIN,
        };
        let sensor = rendered(&scene, &world, exposure, kind.lens_px[1], seed);
        Self { kind: *kind, world, exposure_s, edges, sensor }
    }

    /// What the camera makes of it.
    pub(crate) fn through<const STAGES: usize>(&self, stages: [Stage; STAGES]) -> Frame {
        through(&self.sensor, stages)
    }

    pub(crate) fn setup(&self, uncertainty: Uncertainty<f64>) -> Setup<f64> {
        self.world.setup_with(uncertainty)
    }

    /// Least sigma of an edge's inverse depth from white pixel noise, as a share of it: `2 √π σ_b σ_n²/A²` of variance
    /// for each row, and a line through all of them.
    pub(crate) fn bound(&self, edge: &DrawnEdge) -> f64 {
        let (line, lens_px) = (&edge.line, f64::from(self.kind.lens_px[0]));
        let [dark, bright] = self.kind.levels;
        let rate = line.focal_px * line.velocity_m_s[0].abs() / line.depth_m;
        let motion_px = rate * self.exposure_s;
        let blur_px = (lens_px * lens_px + (1.0 + motion_px * motion_px) / 12.0).sqrt();
        let noise = f64::from(self.kind.read_noise.powi(2) + SHOT_GAIN * 0.5 * (dark + bright)) + 1.0 / 12.0;
        let variance = 2.0 * std::f64::consts::PI.sqrt() * blur_px * noise / f64::from(bright - dark).powi(2);
        let slope = rate * line.readout_s / f64::from(line.rows);
        (12.0 * variance / f64::from(edge.visible_rows()).powi(3)).sqrt() / slope
    }

    pub(crate) fn ranges(&self, ranger: &mut LargeRanger, setup: &Setup<f64>, frame: &Frame) -> Vec<Range<f64>> {
        ranges(ranger, setup, &self.world.motion(), frame)
    }

    /// The same of a frame whose content may jump: none where it is found torn.
    pub(crate) fn ranges_if_whole(
        &self,
        ranger: &mut LargeRanger,
        setup: &Setup<f64>,
        frame: &Frame,
    ) -> Option<Vec<Range<f64>>> {
        let torn = (0..).zip(frame).find_map(|(row, pixels)| ranger.row(setup, row, pixels).err());
        ranger.end_frame(setup);
        let found = ranger.ranges(setup, &self.world.motion());
        match torn {
            None => Some(found),
            Some(RowError::Jump { .. }) => None,
            Some(error) => panic!("rows in order: {error}"),
        }
    }
}

/// The camera, how it moves, and its exposure.
fn view(kind: &Kind, random: &mut StdRng) -> (projection::Scene, f64) {
    // Long blur takes a fast camera.
    let speed: f64 = random.random_range(if kind.blur_px.is_some() { 2.0..3.0 } else { 1.0..3.0 });
    let velocity = if random.random() { speed } else { -speed };
    let world = projection::Scene { velocity_m_s: [velocity, 0.0, 0.0], ..projection::Scene::vga() };
    let exposure_s = match kind.blur_px {
        // At the mean depth of such posts.
        Some([least, most]) => random.random_range(least..most) / (world.focal_px * speed / 1.5),
        None => random.random_range(0.002..0.008),
    };
    (world, exposure_s)
}

/// A post that is near a bearing in the middle of the frame, and its two edges.
fn post(kind: &Kind, world: &projection::Scene, place: f64, random: &mut StdRng) -> (Bar, [DrawnEdge; 2]) {
    let [velocity, ..] = world.velocity_m_s;
    let slope_per_rate = world.focal_px * world.readout_s / f64::from(world.rows);
    let least_rate = LEAST_RATE_PER_S.max(LEAST_SIGMAS * kind.sigma_tilt / slope_per_rate);
    let most_m: f64 = if kind.blur_px.is_some() { 2.0 } else { 5.0 };
    let depth_m = random.random_range(1.0..most_m.min(velocity.abs() / least_rate));
    let bearing = place + random.random_range(-0.01..0.01) + 0.5 * velocity * world.readout_s / depth_m;
    let ends_m = [-0.5, 0.5].map(|end| end * HEIGHT_M + random.random_range(-0.1..0.1));
    let [left, right] = [(); 2].map(|()| kind.sigma_tilt * random.sample::<f64, _>(StandardNormal));

    let m_per_px = depth_m / world.focal_px;
    let bar = Bar::upright(bearing as f32, depth_m as f32, WIDTH_M as f32, 0.0)
        .between(ends_m[0] as f32, ends_m[1] as f32)
        .leaning((0.5 * (left + right)) as f32)
        .tapered((0.5 * (right - left)) as f32)
        .bowed((kind.bow_px * m_per_px) as f32)
        .rough((kind.roughness_px * m_per_px) as f32, (10.0 * m_per_px) as f32, random.random());
    let side = if random.random() { 1.0 } else { -1.0 };
    let bar = kind.light_rad.map_or(bar, |light_rad| bar.lit_from(side * light_rad, AMBIENT));

    let row = |end_m: f64| (world.cy + end_m / m_per_px).clamp(0.0, f64::from(world.rows - 1)).round() as u16;
    let edge = |to_the_right: f64, tilt| DrawnEdge {
        line: projection::Scene {
            bearing: bearing + to_the_right * 0.5 * WIDTH_M / depth_m,
            depth_m,
            tilt,
            ..world.clone()
        },
        rows: ends_m.map(row),
        is_rising: false,
    };
    (bar, [edge(-1.0, left), edge(1.0, right)])
}

/// The sensor's rows of a scene.
pub(crate) fn rendered<const N: usize>(
    scene: &Scene<N>,
    world: &projection::Scene,
    exposure: Exposure,
    corner_px: f32,
    seed: u64,
) -> Sensor {
    let setup = world.setup_read::<f32>(Uncertainty::NONE, ReadoutDirection::TopToBottom);
    let simulator = Simulator::new(scene, setup.camera(), setup.readout(), &world.motion(), exposure, seed)
        .and_then(|simulator| simulator.with_corner_blur(corner_px))
        .expect("sound parameters");
    let row = |row| {
        let mut levels = [0; COLUMNS];
        simulator.row_q8(row, &mut levels);
        levels
    };
    (0..world.rows).map(row).collect()
}

/// What a camera makes of its sensor's rows.
pub(crate) fn through<const STAGES: usize>(sensor: &Sensor, stages: [Stage; STAGES]) -> Frame {
    let mut camera = Pipeline::<COLUMNS, STAGES>::new(stages).expect("sound stages");
    let mut frame = Frame::new();
    for row in sensor {
        camera.row(row, |pixels| frame.push(*pixels));
    }
    camera.end_frame(|pixels| frame.push(*pixels));
    frame
}

/// The ranges of one frame, in the order of their lines' ends.
pub(crate) fn ranges(
    ranger: &mut LargeRanger,
    setup: &Setup<f64>,
    motion: &Twist<f64>,
    frame: &Frame,
) -> Vec<Range<f64>> {
    let mut found = Vec::new();
    for (row, pixels) in (0..).zip(frame) {
        ranger.row(setup, row, pixels).expect("rows in order");
        found.extend(std::iter::from_fn(|| ranger.next_range(setup, motion)));
    }
    ranger.end_frame(setup);
    found.extend(std::iter::from_fn(|| ranger.next_range(setup, motion)));
    found
}

impl DrawnEdge {
    pub(crate) fn depth_m(&self) -> f64 {
        self.line.depth_m
    }

    /// Number of rows that show it.
    pub(crate) fn visible_rows(&self) -> u16 {
        let [first, last] = self.rows;
        last - first + 1
    }

    /// Whether a range is of this edge: within 3 px and half of the motion blur in its first row, within 5 px in its
    /// last.
    pub(crate) fn is_of(&self, range: &Range<f64>, exposure_s: f64) -> bool {
        let blur_px = self.line.focal_px * self.line.velocity_m_s[0].abs() / self.line.depth_m * exposure_s;
        let off = |column: f64, row| (column - self.line.column(row)).abs();
        let [first, last] = self.rows;
        let overlaps = range.first_row <= last && range.last_row >= first;
        let starts = off(range.column_at_first_row, range.first_row) < 3.0 + 0.5 * blur_px;
        let polarity = if self.is_rising { Polarity::Rising } else { Polarity::Falling };
        overlaps && starts && off(range.column_at_last_row, range.last_row) < 5.0 && range.polarity == polarity
    }
}
