//! A sigma that holds on a real robot: coverage of two sigma and accuracy, frame after frame, whatever is wrong or
//! moves.

use shutter_range::Uncertainty;

use crate::journey::{Disturbance, Drive, Journey, Path, Post, errors, follow, normal, seed};
use crate::scenes::{TENTH_DEGREE, tilt_of};

/// Runs of each case: a share of 95.4 % is then known to 0.7 %, a mean square of one to 4.5 %.
const RUNS: u64 = 1000;
/// The 95.4 % of a normal distribution, with about three times what chance makes of it in [`RUNS`] on either side.
const SHARE_INSIDE: std::ops::Range<f64> = 0.93..0.97;
/// One, with about three times what chance makes of it in [`RUNS`] on either side.
const MEAN_SQUARE: std::ops::Range<f64> = 0.85..1.15;

/// Shares of normalised errors.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    count: f64,
    inside_two_sigma: f64,
    squares: f64,
    relative_squares: f64,
}

impl Tally {
    fn add(&mut self, relative: f64, normal: f64) {
        self.count += 1.0;
        self.inside_two_sigma += f64::from(u8::from(normal.abs() < 2.0));
        self.squares += normal * normal;
        self.relative_squares += relative * relative;
    }

    fn share(&self) -> f64 {
        self.inside_two_sigma / self.count
    }

    fn rms(&self) -> f64 {
        (self.relative_squares / self.count).sqrt()
    }
}

/// One tally for each frame of as many sequences as `runs`, with random leans, noise and disturbances of the stated
/// sigmas.
fn tallies<const FRAMES: usize>(
    journey: &Journey,
    depth_m: f64,
    stated: Uncertainty<f64>,
    runs: u64,
) -> [Tally; FRAMES] {
    let mut tallies = [Tally::default(); FRAMES];
    for run in 0..runs {
        let random = &mut seed(run);
        let lean = normal(random) * stated.sigma_tilt;
        let disturbance = Disturbance {
            speed: normal(random) * stated.sigma_speed,
            rate_rad_s: std::array::from_fn(|_| normal(random) * stated.sigma_rate_rad_s),
            gravity: [normal(random) * stated.sigma_gravity, 0.0, normal(random) * stated.sigma_gravity],
            readout: normal(random) * stated.sigma_readout,
            focal: normal(random) * stated.sigma_focal,
        };
        let post = Post::at(0.1 * depth_m, depth_m).leaning(lean);
        let found = follow(journey, disturbance, stated, &post, FRAMES as u32, random);
        for (tally, (_, relative, normal)) in tallies.iter_mut().zip(&found) {
            tally.add(*relative, *normal);
        }
    }
    tallies
}

/// On any path, in every frame.
#[test]
fn sigma_holds_in_every_frame() {
    let paths = [
        Path::straight([-1.5, 0.0, 0.0]),
        Path::straight([-1.2, 0.1, 0.9]),
        Path { rate_rad_s: [0.1, -0.3, 0.15], attitude: [0.05, 0.1, -0.04], ..Path::straight([-1.2, 0.0, 0.5]) },
        Path { acceleration_m_s2: [1.0, 0.0, 0.3], ..Path::straight([-1.5, 0.0, 0.0]) },
    ];
    for path in paths {
        let journey = Journey { path, row_step: 4, sigma_px: 0.1, ..Journey::vga() };
        for (frame, tally) in tallies::<6>(&journey, 2.5, tilt_of(3.0 * TENTH_DEGREE), RUNS).iter().enumerate() {
            let square = tally.squares / tally.count;
            println!("{path:?}, frame {frame}: {:.3} inside two sigma, mean square {square:.2}", tally.share());
            assert!(SHARE_INSIDE.contains(&tally.share()), "{path:?}, frame {frame}: {}", tally.share());
            assert!(MEAN_SQUARE.contains(&square), "{path:?}, frame {frame}: {square}");
        }
    }
}

/// What may be wrong, each alone and all together: two sigma hold, in a single frame and in the fifth.
#[test]
fn sigma_holds_under_each_disturbance() {
    let degree = 10.0 * TENTH_DEGREE;
    let none = Uncertainty::<f64>::NONE;
    let all = none
        .with_sigma_tilt(TENTH_DEGREE)
        .with_sigma_gravity(0.2 * degree)
        .with_sigma_speed(0.02)
        .with_sigma_rate_rad_s(0.5 * degree)
        .with_sigma_readout(0.01)
        .with_sigma_focal(0.01);
    let alone = [
        ("tilt", none.with_sigma_tilt(all.sigma_tilt)),
        ("gravity", none.with_sigma_gravity(all.sigma_gravity)),
        ("speed", none.with_sigma_speed(all.sigma_speed)),
        ("rate", none.with_sigma_rate_rad_s(all.sigma_rate_rad_s)),
        ("readout", none.with_sigma_readout(all.sigma_readout)),
        ("focal", none.with_sigma_focal(all.sigma_focal)),
        ("all", all),
    ];
    let paths = [Path::straight([-1.5, 0.0, 0.0]), Path::straight([-1.3, 0.0, 0.75])];
    for (name, stated) in alone {
        for path in paths {
            let journey = Journey { path, row_step: 8, sigma_px: 0.1, ..Journey::vga() };
            let tallies = tallies::<5>(&journey, 2.0, stated, RUNS);
            for (frame, tally) in tallies.iter().enumerate() {
                println!(
                    "{name}, {:?}, frame {frame}: {:.3}, {:.2} %",
                    path.velocity_m_s,
                    tally.share(),
                    tally.rms() * 100.0
                );
                assert!(SHARE_INSIDE.contains(&tally.share()), "{name}, frame {frame}: {}", tally.share());
            }
        }
    }
}

/// What is measured costs nothing: turning, pitching, rolling and braking, each against the same path without it.
#[test]
fn measured_motion_costs_no_accuracy() {
    let degree = 10.0 * TENTH_DEGREE;
    let straight = Path::straight([-1.5, 0.0, 0.0]);
    let disturbed = [
        ("yaw", Path { rate_rad_s: [0.0, 10.0 * degree, 0.0], ..straight }),
        ("pitch and roll", Path { attitude: [2.0 * degree, 0.0, -2.0 * degree], ..straight }),
        ("braking", Path { acceleration_m_s2: [1.0, 0.0, 0.0], ..straight }),
    ];
    let rms = |path: Path| {
        let journey = Journey { path, row_step: 4, sigma_px: 0.1, ..Journey::vga() };
        let [tally] = tallies::<1>(&journey, 2.0, Uncertainty::NONE, 2000);
        tally.rms()
    };
    let calm = rms(straight);
    for (name, path) in disturbed {
        let ratio = rms(path) / calm;
        println!("{name}: {ratio:.3} times {:.3} %", calm * 100.0);
        // The README promises no more than 5 %, which is two sigma of a ratio of two RMS over 2000 runs.
        assert!(ratio < 1.05, "{name}: {ratio}");
    }
}

/// An error of the speed that wanders within a second or so, at two frame rates: two sigma hold in the twentieth frame,
/// too.
#[test]
fn sigma_holds_while_the_speed_drifts() {
    const RUNS: u64 = 400;
    // 95.4 %, less three times what chance makes of it in 400 runs; the sequence's drift is slower, and may state too
    // much.
    const SHARE_INSIDE: std::ops::Range<f64> = 0.92..0.995;
    let stated = tilt_of(TENTH_DEGREE).with_sigma_speed(0.02);
    for (interval_s, frames) in [(1.0 / 30.0, 20), (0.2, 8)] {
        let journey = Journey { interval_s, row_step: 8, path: Path::straight([-0.4, 0.0, 0.0]), ..Journey::vga() };
        let mut last = Tally::default();
        for run in 0..RUNS {
            let random = &mut seed(run);
            // A process of Ornstein and Uhlenbeck.
            let kept = (-interval_s).exp();
            let mut speed = vec![normal(random) * stated.sigma_speed];
            for frame in 0..frames {
                speed.push(speed[frame] * kept + normal(random) * stated.sigma_speed * (1.0 - kept * kept).sqrt());
            }
            let post = Post::at(-0.5, 2.0).leaning(normal(random) * stated.sigma_tilt);
            let known = |frame: u32| {
                let disturbance = Disturbance { speed: speed[frame as usize], ..Disturbance::default() };
                journey.known(frame, disturbance)
            };
            let mut drive = Drive::new(journey.setup(stated), interval_s, known);
            for frame in 0..frames as u32 {
                let ranges = drive.frame(&journey.points(&[post], frame, random));
                if frame + 1 == frames as u32 {
                    let (relative, normal) = errors(ranges.first().expect("a range"), &journey.truth(&post, frame));
                    last.add(relative, normal);
                }
            }
        }
        println!("{interval_s} s: {:.3} inside two sigma, {:.2} % off", last.share(), last.rms() * 100.0);
        assert!(SHARE_INSIDE.contains(&last.share()), "{interval_s} s: {}", last.share());
    }
}
