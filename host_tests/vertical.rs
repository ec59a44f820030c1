//! The vertical, learned from several frames or fitted to one.

use shutter_range::{Line, Motion, MotionBlur, Pose, RangeStatus, Sequence, Setup, Uncertainty, Vertical};

use crate::journey::{Disturbance, Journey, Known, Path, Post, SequenceRanger, errors, seed};
use crate::projection::Vector;
use crate::scenes::TENTH_DEGREE;

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

/// A camera that rolls and pitches by several degrees, of which it knows nothing, finds the vertical to a tenth of a degree
/// and the posts to a percent. Taken as level, it would be off by 12°.
#[test]
fn a_sequence_learns_the_vertical() {
    for (number, attitude) in
        [[0.2, 0.0, 0.05], [-0.15, 0.0, -0.08], [0.0, 0.0, 0.1], [0.12, 0.05, 0.0]].into_iter().enumerate()
    {
        let random = &mut seed(20 + number as u64);
        let path = Path { attitude, ..Path::straight([-1.5, 0.0, 0.2]) };
        let journey = Journey { path, ..Journey::vga() };
        // What a first frame with 13° of tilt leaves behind is not linear: a hundredth of a pixel, below the roughness of any edge.
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
    }
}

/// Without an exposure the lean of all edges looks like their distances: a single frame cannot tell the vertical, and says so.
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
    for posts in [vec![], posts()[..4].to_vec()] {
        let lines = lines(&journey, &setup, &posts, 0, random);
        let motion = Assumed { known: journey.known(0, Disturbance::default()), gravity: vertical.gravity() };
        assert!(!vertical.begin(&setup, &motion, lines.iter()));
        assert_eq!(vertical, Vertical::level());
    }
}
