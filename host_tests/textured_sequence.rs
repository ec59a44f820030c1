//! Edges before a textured wall in several frames: what is behind an edge changes from frame to frame and draws its
//! column aside, and sigma says so.

use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator, Texture, Truth};
use shutter_range::{Line, Motion, Range, RangeStatus, Ranger, Sequence, Twist, Uncertainty};

use crate::journey::{normal, seed};
use crate::projection;
use crate::scenes::TENTH_DEGREE;
use crate::score::rms;

const FRAMES: u32 = 5;
const INTERVAL_S: f64 = 1.0 / 30.0;
const LEAN: f64 = 3.0 * TENTH_DEGREE;

/// A drive along posts before a textured wall; hands over what each frame tells, in the sequence and by itself, and
/// returns where the edges are in the last one.
fn drive(number: u64, contrast: f32, mut told: impl FnMut(u32, &[Range<f64>], &[Range<f64>])) -> Vec<Truth> {
    let random = &mut seed(90 + number);
    let world = projection::Scene::vga();
    let motion = Twist::<f32>::level([-0.9, 0.0, 0.0]).expect("sound");
    let texture = Texture { contrast, cell: 0.02, seed: number as u32 };
    let mut scene = Scene::<5>::new(Background::textured(150.0, texture)).expect("sound background");
    for place in 0..5_u8 {
        let bearing = -0.44 + 0.19 * f32::from(place);
        let bar = Bar::upright(bearing, 1.6 + 0.5 * f32::from(place * 3 % 5), 0.12, 60.0);
        scene.push(bar.leaning((LEAN * normal(random)) as f32)).expect("a sound bar");
    }
    let uncertainty = Uncertainty::NONE.with_sigma_tilt(LEAN).with_edge_roughness_px(0.03);
    let (setup, camera) = (world.setup_with::<f64>(uncertainty), world.setup::<f32>());
    let exposure = Exposure { time_s: 0.002, ..Exposure::default() };
    let simulator =
        Simulator::new(&scene, camera.camera(), camera.readout(), &motion, exposure, number).expect("sound");
    let known = Twist::level([-0.9, 0.0, 0.0]).expect("sound");
    let mut ranger = Box::new(Ranger::<128, 16, 512>::new());
    let mut sequence: Box<Sequence<f64, 128>> = Box::default();
    let mut pixels = [0; 640];
    for frame in 0..FRAMES {
        let simulator = simulator.clone().at_frame(frame, (f64::from(frame) * INTERVAL_S * 1e9) as i64);
        for row in 0..480 {
            simulator.row(row, &mut pixels);
            ranger.row(&setup, row, &pixels).expect("rows in order");
        }
        ranger.end_frame(&setup);
        let lines: Vec<Line<16>> = std::iter::from_fn(|| ranger.next_line()).collect();
        let single: Vec<_> = lines.iter().map(|line| Range::from_line(&setup, &known, line)).collect();
        let mut ranges = Vec::new();
        sequence.lines(&setup, &known, &lines, |range| ranges.push(range));
        told(frame, &ranges, &single);
        if frame + 1 < FRAMES {
            let pose = known.pose(INTERVAL_S);
            sequence.advance(&setup, &pose, INTERVAL_S, known.gravity()).expect("sound gravity");
        }
    }
    simulator.at_frame(FRAMES - 1, (f64::from(FRAMES - 1) * INTERVAL_S * 1e9) as i64).truth().collect()
}

/// Errors of the distances that the fifth frame tells, in sigmas.
fn errors(number: u64, contrast: f32) -> Vec<f64> {
    let mut last = Vec::new();
    let truth = drive(number, contrast, |_, ranges, _| last = ranges.to_vec());
    let error = |range: &Range<f64>| {
        let off = |depth_m: f64| range.estimate.inverse_depth_per_m - 1.0 / depth_m;
        let of = truth.iter().filter(|truth| truth.polarity == range.polarity);
        let nearest = of.min_by(|a, b| {
            let apart = |bearing: f64| (bearing - range.estimate.bearing).abs();
            apart(a.bearing).total_cmp(&apart(b.bearing))
        })?;
        let is_its_own = (nearest.bearing - range.estimate.bearing).abs() < 0.01;
        is_its_own.then(|| off(nearest.depth_m) / range.estimate.sigma_inverse_depth_per_m)
    };
    last.iter().filter(|range| range.status == RangeStatus::Ok).filter_map(error).collect()
}

#[test]
fn texture_behind_an_edge_is_in_the_sigma_of_a_sequence() {
    for contrast in [20.0, 40.0] {
        let all: Vec<_> = (0..12).flat_map(|number| errors(number, contrast)).collect();
        let inside = all.iter().filter(|error| error.abs() < 2.0).count();
        let honest = rms(all.iter().copied());
        println!("contrast {contrast}: {inside} of {} in two sigma, error/sigma {honest:.2}", all.len());
        assert!(all.len() > 80, "{contrast}: {} distances", all.len());
        assert!(inside * 100 >= all.len() * 90 && honest < 1.2, "{contrast}: {inside}, {honest}");
    }
}

/// A line that stands out of the texture just enough for a single frame is told once three frames agree.
#[test]
fn what_stands_out_a_little_waits_for_three_frames() {
    let (mut single, mut first, mut third) = (0, 0, 0);
    for number in 0..12 {
        drive(number, 120.0, |frame, ranges, alone| {
            let ok = |ranges: &[Range<f64>]| ranges.iter().filter(|range| range.status == RangeStatus::Ok).count();
            match frame {
                0 => (single, first) = (single + ok(alone), first + ok(ranges)),
                2 => third += ok(ranges),
                _ => {}
            }
        });
    }
    println!(
        "{single} distances in single frames; of them {first} at the start of a sequence, and {third} in its third frame"
    );
    assert!(4 * first < 3 * single && third > 2 * single, "{single}, {first}, {third}");
}
