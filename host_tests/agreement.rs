//! All back ends say of a line what double precision says of it, but for borderline cases, which are counted here.

use rand::{Rng, SeedableRng, rngs::StdRng};
use shutter_range::{EdgePoint, Micro, Q32, Range, RangeStatus, Scalar, Uncertainty};

use crate::projection::Scene;
use crate::scenes::{TENTH_DEGREE, line_of, q16};

/// A line, and what is known of the camera that sees it.
struct Case {
    scene: Scene,
    sigma_gravity: f64,
    sigma_speed: f64,
    points: Vec<EdgePoint>,
}

/// Status, inverse depth and its sigma.
type Verdict = (RangeStatus, f64, f64);

impl Case {
    fn verdict<S: Scalar>(&self) -> Verdict {
        let uncertainty = Uncertainty::NONE
            .with_sigma_tilt(S::from_f64(TENTH_DEGREE))
            .with_sigma_gravity(S::from_f64(self.sigma_gravity))
            .with_sigma_speed(S::from_f64(self.sigma_speed));
        let setup = self.scene.setup_with::<S>(uncertainty);
        let range = Range::from_line(&setup, &self.scene.motion::<S>(), &line_of::<16>(&self.points));
        let estimate = range.estimate;
        let numbers = [estimate.bearing, estimate.inverse_depth_per_m, estimate.sigma_inverse_depth_per_m];
        assert!(numbers.into_iter().all(S::is_finite), "{range:?}");
        (range.status, estimate.inverse_depth_per_m.to_f64(), estimate.sigma_inverse_depth_per_m.to_f64())
    }
}

/// A few noisy points near the middle of the image while the camera backs up: they fix neither depth nor tilt.
fn short_line_of_a_camera_that_backs_up(random: &mut StdRng) -> Case {
    let scene = Scene { velocity_m_s: [0.0, 0.0, -2.0], readout_s: 0.0333, depth_m: 1.0, bearing: 0.0, ..Scene::vga() };
    let (first, count) = (random.random_range(200..280_u16), random.random_range(8..14_u16));
    let (column, slope) = (random.random_range(300.0..340.0), random.random_range(-0.3..0.3));
    let sigma_px = random.random_range(0.1..1.0);
    let point = |row: u16| {
        // Evenly spread noise of this sigma.
        let noise = random.random_range(-1.73..1.73) * sigma_px;
        let column_px = column + slope * f64::from(row - first) + noise;
        scene.point_at(row, column_px).with_sigma_q16(q16(sigma_px) as u32)
    };
    let points = (first..first + count).map(point).collect();
    Case { scene, sigma_gravity: 0.003, sigma_speed: 0.02, points }
}

/// An upright edge, up to its lean and noise, before a robot that drives and turns.
fn edge_before_a_robot(random: &mut StdRng) -> Case {
    let mut number = |from: f64, to: f64| random.random_range(from..to);
    let scene = Scene {
        focal_px: 10_f64.powf(number(2.5, 3.3)),
        velocity_m_s: [number(-3.0, 3.0), number(-0.1, 0.1), number(-1.0, 1.0)],
        rate_rad_s: [number(-0.2, 0.2), number(-0.4, 0.4), number(-0.2, 0.2)],
        gravity: unit([number(-0.1, 0.1), 1.0, number(-0.1, 0.1)]),
        bearing: number(-0.1, 0.1),
        depth_m: 10_f64.powf(number(-0.3, 1.5)),
        tilt: number(-0.003, 0.003),
        ..Scene::vga()
    };
    let (first, sigma_px) = (number(0.0, 200.0) as usize, number(0.02, 0.2));
    let rows = scene.visible_rows();
    let last = (first + number(20.0, 280.0) as usize).min(rows.len());
    let point = |row: &u16| {
        let column_px = scene.column(*row) + number(-1.73, 1.73) * sigma_px;
        scene.point_at(*row, column_px.clamp(0.0, 639.0)).with_sigma_q16(q16(sigma_px) as u32)
    };
    let points = rows.get(first..last).unwrap_or_default().iter().map(point).collect();
    Case { scene, sigma_gravity: 0.002, sigma_speed: 0.01, points }
}

fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = vector.iter().map(|component| component * component).sum::<f64>().sqrt();
    vector.map(|component| component / length)
}

/// How many of the cases a back end calls otherwise than double precision does, and how many of these it gives a
/// distance.
fn disagreements<S: Scalar>(cases: &[Case]) -> (usize, usize) {
    let mut others = 0;
    let mut wrongly_ok = 0;
    for case in cases {
        let ((exact, ..), (status, ..)) = (case.verdict::<f64>(), case.verdict::<S>());
        others += usize::from(status != exact);
        wrongly_ok += usize::from(status != exact && status == RangeStatus::Ok);
    }
    (others, wrongly_ok)
}

fn cases(make: impl Fn(&mut StdRng) -> Case, count: usize) -> Vec<Case> {
    let mut random = StdRng::seed_from_u64(7);
    let whole = |case: &Case| case.points.len() >= 8;
    std::iter::repeat_with(|| make(&mut random)).filter(whole).take(count).collect()
}

/// A back end that squares, or passes over, what is not a number called a few per cent of these lines `Ok` at a
/// distance of nothing.
#[test]
fn no_back_end_gives_a_distance_to_a_line_that_fixes_none() {
    const COUNT: usize = 4000;
    let cases = cases(short_line_of_a_camera_that_backs_up, COUNT);
    let exact = cases.iter().filter(|case| case.verdict::<f64>().0 == RangeStatus::Ok).count();
    assert_eq!(exact, 0);
    // Lines whose rounds do not settle: which of two wrong places they end at is a matter of rounding. What such a line
    // shows of the depth is smaller than the step of numbers near one: where floating point follows its noise away and
    // calls the line bent, fixed point says that nothing is known.
    for (name, (others, wrongly_ok), most) in [
        ("f32", disagreements::<f32>(&cases), COUNT / 1000),
        ("Micro", disagreements::<Micro>(&cases), COUNT / 1000),
        ("Q32", disagreements::<Q32>(&cases), COUNT / 40),
    ] {
        println!("{name}: {others} of {COUNT}");
        assert_eq!(wrongly_ok, 0, "{name}");
        assert!(others <= most, "{name}: {others}");
    }
}

#[test]
fn all_back_ends_agree_on_the_status_of_upright_edges() {
    const COUNT: usize = 4000;
    let cases = cases(edge_before_a_robot, COUNT);
    let ok = cases.iter().filter(|case| case.verdict::<f64>().0 == RangeStatus::Ok).count();
    assert!(ok > COUNT / 4, "{ok} distances");
    for (name, (others, _)) in [
        ("f32", disagreements::<f32>(&cases)),
        ("Micro", disagreements::<Micro>(&cases)),
        ("Q32", disagreements::<Q32>(&cases)),
    ] {
        println!("{name}: {others} of {COUNT}");
        // Numbers that lie on a limit of a status, within what the back end's numbers are off.
        assert!(others <= COUNT / 1000, "{name}: {others}");
    }
}
