//! The vertical, learned from several frames or fitted to one.

use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator, Truth};
use shutter_range::{
    Line, Motion, MotionBlur, Pose, Range, RangeStatus, Ranger, Response, Sequence, Setup, Twist, Uncertainty, Vertical,
};

use crate::journey::{Disturbance, Journey, Known, Path, Post, SequenceRanger, errors, normal, seed};
use crate::projection::{self, Vector};
use crate::scenes::TENTH_DEGREE;
use crate::score::rms;

/// A motion as it is known but for gravity.
struct Assumed {
    known: Known,
    gravity: Vector,
}

impl Motion<f64> for Assumed {
    fn pose(&self, time_s: f64) -> Pose<f64> {
        self.known.pose(time_s)
    }

    fn gravity(&self) -> Vector {
        self.gravity
    }
}

/// Ten upright posts 2 to 5 m away, all over the image.
fn posts() -> Vec<Post> {
    (0..10).map(|k| Post::at(-1.2 + 0.27 * f64::from(k), 2.0 + f64::from(k * 7 % 10) / 3.0)).collect()
}

fn lines(
    journey: &Journey,
    setup: &Setup<f64>,
    posts: &[Post],
    frame: u32,
    random: &mut rand::rngs::StdRng,
) -> Vec<Line<16>> {
    let mut ranger = SequenceRanger::new();
    for point in journey.points(posts, frame, random) {
        ranger.edge_point(setup, point).expect("sound points");
    }
    ranger.end_frame(setup);
    std::iter::from_fn(|| ranger.next_line()).collect()
}

fn with_gravity(setup: &Setup<f64>, vertical: &Vertical<f64>) -> Setup<f64> {
    setup.with_uncertainty(setup.uncertainty().with_sigma_gravity(vertical.sigma_rad())).expect("sound")
}

fn angle(a: Vector, b: Vector) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum::<f64>().min(1.0).acos()
}

/// A camera that rolls and pitches by several degrees, of which it knows nothing, finds the vertical to a tenth of a
/// degree and the posts to a percent. Taken as level, it would be off by 12°.
#[test]
fn a_sequence_learns_the_vertical() {
    for (number, attitude) in
        [[0.2, 0.0, 0.05], [-0.15, 0.0, -0.08], [0.0, 0.0, 0.1], [0.12, 0.05, 0.0]].into_iter().enumerate()
    {
        let random = &mut seed(20 + number as u64);
        let path = Path { attitude, ..Path::straight([-1.5, 0.0, 0.2]) };
        let journey = Journey { path, ..Journey::vga() };
        // What a first frame with 13° of tilt leaves behind is not linear: a hundredth of a pixel, below the roughness
        // of any edge.
        let uncertainty = Uncertainty::NONE.with_sigma_tilt(TENTH_DEGREE).with_edge_roughness_px(0.03);
        let setup = journey.setup(uncertainty);
        let mut vertical = Vertical::level();
        let mut sequence: Sequence<f64, 32> = Sequence::new();
        let posts = posts();
        let mut told = 0;
        for frame in 0..8 {
            let lines = lines(&journey, &setup, &posts, frame, random);
            let motion = |vertical: &Vertical<f64>| Assumed {
                known: journey.known(frame, Disturbance::default()),
                gravity: vertical.gravity(),
            };
            if !vertical.is_told() {
                assert!(vertical.begin(&setup, &motion(&vertical), lines.iter()), "ten posts tell a vertical");
            }
            let setup = with_gravity(&setup, &vertical);
            let motion = motion(&vertical);
            let mut ranges = Vec::new();
            sequence.lines(&setup, &motion, &lines, |range| ranges.push(range));
            sequence.learn_vertical(&setup, &mut vertical);
            let down: Vector = motion.known.gravity();
            let off = angle(vertical.gravity(), down);
            println!("{number}, {frame}: {:.3}° ± {:.3}°", off.to_degrees(), vertical.sigma_rad().to_degrees());
            // Roll and pitch together: beyond four sigma once in 3000 times.
            assert!(off < 4.0 * vertical.sigma_rad(), "frame {frame}: {off}, {vertical:?}");
            if frame == 7 {
                assert!(off < TENTH_DEGREE && vertical.sigma_rad() < 2.0 * TENTH_DEGREE, "{off}, {vertical:?}");
                for range in ranges.iter().filter(|range| range.status == RangeStatus::Ok && range.frames > 4) {
                    told += 1;
                    let near =
                        |post: &&Post| (journey.truth(post, frame).bearing - range.estimate.bearing).abs() < 0.01;
                    let post = posts.iter().find(near).expect("a post is there");
                    let (relative, normal) = errors(range, &journey.truth(post, frame));
                    assert!(relative.abs() < 0.01 && normal.abs() < 4.0, "{relative}, {normal} sigma: {range:?}");
                }
            }
            let pose = motion.pose(journey.interval_s);
            vertical.advance(&pose, journey.interval_s);
            sequence.advance(&setup, &pose, journey.interval_s, vertical.gravity()).expect("sound gravity");
        }
        assert!(told >= 6, "{told} posts told");
        // Ten seconds without an edge: 0.3° each.
        let known = vertical.sigma_rad();
        vertical.advance(&journey.known(8, Disturbance::default()).pose(0.0), 10.0);
        let grown = vertical.sigma_rad();
        assert!((grown - known.hypot(0.05)).abs() < 1e-9, "{known}, {grown}");
    }
}

/// 0.03° as a slope.
const LEAN: f64 = 0.3 * TENTH_DEGREE;

/// A frame of eight short faint bars, sixteen edges, that a camera with a wide lens takes with 8 ms of exposure, rolled
/// and pitched by `attitude`.
struct Exposed {
    lines: Vec<Line<16>>,
    truth: Vec<Truth>,
    setup: Setup<f64>,
    motion: Twist<f32>,
}

impl Exposed {
    fn new(attitude: [f64; 2], number: u64) -> Self {
        let random = &mut seed(number);
        let world = projection::Scene { focal_px: 300.0, ..projection::Scene::vga() };
        let [roll, pitch] = attitude;
        let motion = Twist::new([-3.0, 0.0, 0.0], [0.0; 3], [roll, 1.0, pitch].map(|part| part as f32)).expect("sound");
        let exposure = Exposure { time_s: 0.008, ..Exposure::default() };
        let mut scene = Scene::<8>::new(Background::plain(140.0)).expect("sound background");
        for place in 0..8_u8 {
            let lean = (LEAN * normal(random)) as f32;
            let bearing = -0.95 + 0.26 * f32::from(place);
            let bar = Bar::upright(bearing, 1.7 + 0.1 * f32::from(place * 3 % 8), 0.1, 110.0)
                .between(-0.3, 0.3)
                .leaning(lean);
            scene.push(bar).expect("a sound bar");
        }
        let blur = MotionBlur::from_calibrated_lens(0.008_f64, 0.7);
        let setup = world.setup_with::<f64>(Uncertainty::NONE.with_sigma_tilt(LEAN).with_edge_roughness_px(0.03));
        let setup = setup.with_response(Response::Linear).with_motion_blur(blur).expect("sound blur");
        let camera = world.setup::<f32>();
        let simulator =
            Simulator::new(&scene, camera.camera(), camera.readout(), &motion, exposure, number).expect("sound");
        let mut ranger = Box::new(Ranger::<32, 16, 128>::new());
        let mut pixels = [0; 640];
        for row in 0..480 {
            simulator.row(row, &mut pixels);
            ranger.row(&setup, row, &pixels).expect("rows in order");
        }
        ranger.end_frame(&setup);
        let lines = std::iter::from_fn(|| ranger.next_line()).collect();
        Self { lines, truth: simulator.truth().collect(), setup, motion }
    }

    /// Errors of the edges' inverse depths, as a share and in sigmas, with this vertical.
    fn errors(&self, vertical: &Vertical<f64>) -> Vec<(f64, f64)> {
        let (setup, motion) = (with_gravity(&self.setup, vertical), self.known(vertical));
        let ranges = self.lines.iter().map(|line| Range::from_line(&setup, &motion, line));
        let error = |range: Range<f64>| {
            let near = |truth: &&Truth| {
                truth.polarity == range.polarity && (truth.bearing - range.estimate.bearing).abs() < 0.02
            };
            let truth = self.truth.iter().find(near)?;
            let off = range.estimate.inverse_depth_per_m - 1.0 / truth.depth_m;
            Some((off * truth.depth_m, off / range.estimate.sigma_inverse_depth_per_m))
        };
        ranges.filter_map(error).collect()
    }

    fn known(&self, vertical: &Vertical<f64>) -> Twist<f64> {
        Twist::new(self.motion.velocity_m_s().map(f64::from), [0.0; 3], vertical.gravity()).expect("sound")
    }
}

/// Blur tells the leans of a single frame's edges apart from their distances, and what the leans have in common is roll
/// and pitch: each within its sigma. With them the distances are a little better than with a camera that is only said
/// to be level: what all blurs have in common, of the lens and of the edges' shape, looks like roll.
#[test]
fn a_single_frame_with_blur_tells_the_vertical() {
    let level = Vertical::level();
    let (mut angles, mut before, mut after) = (Vec::new(), Vec::new(), Vec::new());
    for number in 0..24 {
        let random = &mut seed(60 + number);
        let attitude = [0.05 * normal(random), 0.08 * normal(random)];
        let frame = Exposed::new(attitude, number);
        let fitted = Vertical::fit(&with_gravity(&frame.setup, &level), &frame.known(&level), &frame.lines);
        let fitted = fitted.unwrap_or_else(|| panic!("{number}: no vertical from {} lines", frame.lines.len()));
        let down = frame.motion.gravity().map(f64::from);
        let [roll, _, pitch] = std::array::from_fn(|axis| fitted.gravity()[axis] - down[axis]);
        println!(
            "{number}: {:.3}°, {:.3}° ± {:.3}°",
            roll.to_degrees(),
            pitch.to_degrees(),
            fitted.sigma_rad().to_degrees()
        );
        angles.extend([roll, pitch].map(|off| off / fitted.sigma_rad()));
        before.extend(frame.errors(&level));
        after.extend(frame.errors(&fitted));
    }
    let rms_of = |values: &[(f64, f64)]| (rms(values.iter().map(|v| v.0)), rms(values.iter().map(|v| v.1)));
    let (level, fitted) = (rms_of(&before), rms_of(&after));
    println!("angles {:.2} sigma, edges {level:?} level, {fitted:?} fitted", rms(angles.iter().copied()));
    assert!(angles.iter().all(|off| off.abs() < 4.0), "{angles:?}");
    // The larger of two sigmas is told: their RMS is below one.
    assert!((0.3..1.2).contains(&rms(angles.iter().copied())), "{angles:?}");
    assert!(before.len() >= 300 && after.len() == before.len());
    assert!(fitted.0 < 0.95 * level.0 && (0.4..1.2).contains(&fitted.1), "{level:?}, {fitted:?}");
}

/// Without an exposure the lean of all edges looks like their distances: a single frame cannot tell the vertical, and
/// says so.
#[test]
fn a_single_frame_without_blur_tells_no_vertical() {
    let random = &mut seed(30);
    let journey = Journey::vga();
    let setup = journey.setup(Uncertainty::NONE.with_sigma_tilt(TENTH_DEGREE));
    let lines = lines(&journey, &setup, &posts(), 0, random);
    let vertical = Vertical::level();
    let motion = Assumed { known: journey.known(0, Disturbance::default()), gravity: vertical.gravity() };
    assert_eq!(Vertical::fit(&with_gravity(&setup, &vertical), &motion, &lines), None);
    assert_eq!(Vertical::fit(&with_gravity(&setup, &vertical), &motion, &[] as &[Line<16>]), None);
    let blurred = setup.with_motion_blur(MotionBlur::from_exposure(0.004)).expect("sound");
    assert_eq!(Vertical::fit(&with_gravity(&blurred, &vertical), &motion, &lines), None, "no widths are measured");
}

/// Too few lines, or lines of one bearing, tell no vertical: nothing changes.
#[test]
fn few_lines_tell_no_vertical() {
    let random = &mut seed(31);
    let journey = Journey::vga();
    let setup = journey.setup(Uncertainty::NONE);
    let mut vertical = Vertical::level();
    let motion = Assumed { known: journey.known(0, Disturbance::default()), gravity: vertical.gravity() };
    // All over the image.
    let some = |places: &[usize]| places.iter().map(|place| posts()[*place]).collect::<Vec<_>>();
    let of_one_bearing = || (0..6).map(|k| Post::at(0.1 + 0.01 * f64::from(k), 3.0)).collect();
    for posts in [vec![], some(&[1, 4, 6, 9]), of_one_bearing()] {
        let lines = lines(&journey, &setup, &posts, 0, random);
        assert_eq!(lines.len(), posts.len());
        assert!(!vertical.begin(&setup, &motion, lines.iter()));
        assert_eq!(vertical, Vertical::level());
    }
    let lines = lines(&journey, &setup, &some(&[1, 4, 6, 8, 9]), 0, random);
    assert!(vertical.begin(&setup, &motion, lines.iter()), "five are enough");
}
