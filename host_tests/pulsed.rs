//! Frames in pulsed light: a row sees an edge where it was during each pulse within its exposure, so that blur comes in
//! steps and edges advance in jumps, and rows without a pulse are dark.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use shutter_range::sim::{Exposure, Scene, Simulator, Truth};
use shutter_range::{MotionBlur, Range, RangeStatus, Ranger, Response, Setup, Uncertainty};

use crate::rendered::{COLUMNS, Frame, ROWS, TOP, errors, moving};
use crate::scenes::{TENTH_DEGREE, tilt_of};
use crate::thresholded::{black_and_white, posts};

const PSF_PX: f32 = 0.7;

/// A lamp that is on for a share of each period.
#[derive(Clone, Copy, Debug)]
struct Lamp {
    frequency_hz: f64,
    duty: f64,
    /// When a pulse begins, in periods after the start of the frame.
    phase: f64,
}

impl Lamp {
    /// When it is on between two times, in seconds.
    fn pulses(self, from_s: f64, to_s: f64) -> impl Iterator<Item = [f64; 2]> {
        let [first, last] = [from_s, to_s].map(|time_s| (time_s * self.frequency_hz - self.phase).floor() as i32);
        let pulse = move |index: i32| {
            let [on, off] = [0.0, self.duty].map(|part| (f64::from(index) + self.phase + part) / self.frequency_hz);
            [on.max(from_s), off.min(to_s)]
        };
        (first..=last).map(pulse).filter(|[on, off]| on < off)
    }
}

/// A camera that passes posts in the light of a lamp.
struct Passing {
    scene: Scene<3>,
    speed_m_s: f64,
    exposure_s: f64,
    lamp: Lamp,
    seed: u64,
}

/// Ranges up to where a frame is found torn, each with its edge; and whether it is.
struct Told {
    edges: Vec<(Range<f32>, Truth)>,
    is_torn: bool,
}

impl Passing {
    fn setup(&self, uncertainty: Uncertainty<f32>) -> Setup<f32> {
        moving(self.speed_m_s).setup_read(uncertainty, TOP)
    }

    fn simulator(&self, time_s: f64) -> Simulator<'_, 3> {
        let setup = self.setup(Uncertainty::NONE);
        let exposure = Exposure { time_s: time_s as f32, psf_sigma_px: PSF_PX, ..Exposure::IDEAL };
        let motion = moving(self.speed_m_s).motion();
        Simulator::new(&self.scene, setup.camera(), setup.readout(), &motion, exposure, self.seed)
            .expect("sound parameters")
    }

    /// The light of a row's pulses, in seconds at full brightness for each column.
    fn light(&self, row: u16) -> Vec<f64> {
        let row_s = moving(self.speed_m_s).time_s(row);
        let mut light = vec![0.0; COLUMNS.into()];
        for [on, off] in self.lamp.pulses(row_s - 0.5 * self.exposure_s, row_s + 0.5 * self.exposure_s) {
            let mut levels_q8 = [0; COLUMNS as usize];
            let start_ns = ((0.5 * (on + off) - row_s) * 1e9).round() as i64;
            self.simulator(off - on).at_frame(0, start_ns).row_q8(row, &mut levels_q8);
            light.iter_mut().zip(levels_q8).for_each(|(sum, level)| *sum += f64::from(level) / 256.0 * (off - on));
        }
        light
    }

    /// The frame, exposed so that its brightest rows have the levels of the scene.
    fn frame(&self) -> Frame {
        let mut random = StdRng::seed_from_u64(self.seed);
        let light: Vec<_> = (0..ROWS).map(|row| self.light(row)).collect();
        let brightest = light.iter().flatten().fold(0.0_f64, |most, light| most.max(*light));
        let mut pixel = |light: f64| {
            let level = 180.0 * light / brightest;
            let noise: f64 = random.sample(StandardNormal);
            (level + (1.0 + 0.05 * level).sqrt() * noise).round() as u8
        };
        light.iter().map(|row| row.iter().map(|light| pixel(*light)).collect()).collect()
    }

    /// The ranges of a frame, each with the edge of its polarity that is nearest to it.
    fn told(&self, frame: &Frame, setup: &Setup<f32>) -> Vec<(Range<f32>, Truth)> {
        self.told_of(frame, setup).edges
    }

    fn told_of(&self, frame: &Frame, setup: &Setup<f32>) -> Told {
        self.told_at(frame, setup, |_| true)
    }

    /// Likewise, with the ranges taken after some of the rows and at the end.
    fn told_at(&self, frame: &Frame, setup: &Setup<f32>, takes_after: impl Fn(u16) -> bool) -> Told {
        let mut ranger = Ranger::<64, 16, 64>::new();
        let motion = moving(self.speed_m_s).motion();
        let mut found = Vec::new();
        for (row, pixels) in (0..).zip(frame) {
            if ranger.row(setup, row, pixels).is_err() {
                break;
            }
            if takes_after(row) {
                found.extend(ranger.ranges(setup, &motion));
            }
        }
        let is_torn = ranger.is_torn();
        ranger.end_frame(setup);
        found.extend(ranger.ranges(setup, &motion));
        let truths: Vec<Truth> = self.simulator(0.0).truth().collect();
        let truth_of = |range: &Range<f32>| {
            let off = |truth: &&Truth| (truth.bearing - f64::from(range.estimate.bearing)).abs();
            let alike = truths.iter().filter(|truth| truth.polarity == range.polarity);
            *alike.min_by(|a, b| off(a).total_cmp(&off(b))).expect("an edge of each polarity")
        };
        Told { edges: found.into_iter().map(|range| (range, truth_of(&range))).collect(), is_torn }
    }
}

/// Whether the truth is within three sigma of what is told.
fn is_right((range, truth): &(Range<f32>, Truth)) -> bool {
    let (_, sigmas) = errors(range, truth);
    match range.status {
        RangeStatus::Ok => sigmas.abs() < 3.0,
        RangeStatus::Far => sigmas > -3.0,
        _ => true,
    }
}

/// Edges that are `ok` all along the frame but for a fifth at most.
fn whole_edges(told: &[(Range<f32>, Truth)]) -> usize {
    told.iter().filter(|(range, _)| range.status == RangeStatus::Ok && range.points > ROWS * 8 / 10).count()
}

const EDGES: usize = 6;

fn passing(speed_m_s: f64, exposure_s: f64, frequency_hz: f64, duty: f64) -> impl Iterator<Item = Passing> {
    (1..=3).map(move |seed| {
        let lamp = Lamp { frequency_hz, duty, phase: 0.3 * seed as f64 };
        Passing { scene: posts(seed), speed_m_s, exposure_s, lamp, seed }
    })
}

const SPEEDS_M_S: [f64; 4] = [-2.5, -0.8, 0.8, 2.5];

/// Four to eight pulses in an exposure, up to 3 px apart: each edge is one line, right within its sigma, also where the
/// blur is stated and compared. (Where no blur is stated, a step that breaks off at the upper border may pass for an
/// edge far away; so it may with shorter pulses.)
#[test]
fn edges_blurred_in_steps_are_where_they_are() {
    const EXPOSURE_S: f64 = 0.016;
    let (mut whole, mut edges) = (0, 0);
    for (frequency_hz, duty) in [(240.0, 0.2), (240.0, 0.5), (500.0, 0.2), (500.0, 0.5)] {
        for passing in SPEEDS_M_S.into_iter().flat_map(|speed| passing(speed, EXPOSURE_S, frequency_hz, duty)) {
            let name = format!("{:?}, {} m/s, seed {}", passing.lamp, passing.speed_m_s, passing.seed);
            let frame = passing.frame();
            let plain = passing.setup(tilt_of(TENTH_DEGREE));
            let told = passing.told(&frame, &plain);
            assert!(told.iter().all(|edge| edge.0.status != RangeStatus::Ok || is_right(edge)), "{name}: {told:#?}");
            let blur = MotionBlur::from_calibrated_lens(EXPOSURE_S as f32, PSF_PX);
            let stated = plain.with_response(Response::Linear).with_motion_blur(blur).expect("a sound blur");
            let told_with_blur = passing.told(&frame, &stated);
            assert!(told_with_blur.iter().all(is_right), "blur stated, {name}: {told_with_blur:#?}");
            whole += whole_edges(&told) + whole_edges(&told_with_blur);
            edges += 2 * EDGES;
        }
    }
    println!("{whole} of {edges}");
    assert!(whole * 100 >= edges * 97, "{whole} of {edges}");
}

/// On for half of the time at 500 Hz, so that edges stand still for no more than a pixel: nothing is told that is not
/// so, in grey and in black and white. (Slower lamps and shorter pulses leave steps that pass for edges far away.)
#[test]
fn fast_light_moves_no_edge() {
    for exposure_s in [0.002, 0.004, 0.008, 0.016] {
        for passing in SPEEDS_M_S.into_iter().flat_map(|speed| passing(speed, exposure_s, 500.0, 0.5)) {
            let name = format!("{exposure_s} s, {} m/s, seed {}", passing.speed_m_s, passing.seed);
            let setup = passing.setup(tilt_of(TENTH_DEGREE));
            let grey = passing.frame();
            for frame in [black_and_white(&grey, 120), grey] {
                let told = passing.told(&frame, &setup);
                assert_eq!(whole_edges(&told), EDGES, "{name}: {told:#?}");
                assert!(told.iter().all(is_right), "{name}: {told:#?}");
            }
        }
    }
}

/// Short pulses, of which an exposure sees two or three, show each edge as often, side by side and of one polarity, as the
/// bars of a fence are not: of twelve frames at least half are found torn.
#[test]
fn images_of_several_pulses_are_no_fence() {
    let (mut torn, mut frames) = (0, 0);
    for duty in [0.05, 0.1] {
        for passing in [-2.5, 2.5].into_iter().flat_map(|speed| passing(speed, 0.016, 160.0, duty)) {
            torn += usize::from(passing.told_of(&passing.frame(), &passing.setup(tilt_of(TENTH_DEGREE))).is_torn);
            frames += 1;
        }
    }
    assert!(torn * 2 >= frames, "{torn} of {frames}");
}

/// What is told of an edge does not depend on when it is asked for.
#[test]
fn it_is_told_alike_whenever_it_is_asked() {
    for passing in [60.0, 120.0, 160.0].into_iter().flat_map(|frequency_hz| passing(2.5, 0.008, frequency_hz, 0.1)) {
        let (frame, setup) = (passing.frame(), passing.setup(tilt_of(TENTH_DEGREE)));
        let told = |takes_after: fn(u16) -> bool| {
            let edges = passing.told_at(&frame, &setup, takes_after).edges;
            let mut told: Vec<_> =
                edges.iter().map(|(range, _)| (range.first_row, range.status.name(), range.points)).collect();
            told.sort_unstable();
            told
        };
        assert_eq!(told(|_| false), told(|_| true), "{:?}, seed {}", passing.lamp, passing.seed);
    }
}

/// Of frames in light of one frequency: how many there are and how many are found torn; how many edges are `ok`, and
/// how many of those are not within three sigma; how many are `far`, and how many of those are not.
#[derive(Clone, Copy, Default)]
struct Tally {
    frames: usize,
    torn: usize,
    ok: [usize; 2],
    far: [usize; 2],
}

impl Tally {
    fn add(&mut self, told: &Told) {
        let count = |status| {
            let alike = told.edges.iter().filter(move |edge| edge.0.status == status);
            [alike.clone().count(), alike.filter(|edge| !is_right(edge)).count()]
        };
        let plus = |sums: [usize; 2], more: [usize; 2]| [sums[0] + more[0], sums[1] + more[1]];
        self.frames += 1;
        self.torn += usize::from(told.is_torn);
        self.ok = plus(self.ok, count(RangeStatus::Ok));
        self.far = plus(self.far, count(RangeStatus::Far));
    }

    fn wrong(&self) -> usize {
        self.ok[1] + self.far[1]
    }
}

const FREQUENCIES_HZ: [f64; 9] = [50.0, 60.0, 80.0, 100.0, 120.0, 160.0, 240.0, 320.0, 500.0];

/// Light of each frequency, with pulses and exposures of every length, of which each n-th frame is looked at.
fn tallies(every: usize) -> Vec<(f64, Tally)> {
    let mut index = 0;
    let of_frequency = |frequency_hz| {
        let mut tally = Tally::default();
        for (duty, exposure_s) in
            [0.05, 0.1, 0.2, 0.5].into_iter().flat_map(|duty| [0.002, 0.004, 0.008, 0.016].map(|time_s| (duty, time_s)))
        {
            for passing in SPEEDS_M_S.into_iter().flat_map(|speed| passing(speed, exposure_s, frequency_hz, duty)) {
                index += 1;
                if index % every == 0 {
                    let lamp = Lamp { phase: (0.618 * index as f64).fract(), ..passing.lamp };
                    let passing = Passing { lamp, ..passing };
                    tally.add(&passing.told_of(&passing.frame(), &passing.setup(tilt_of(TENTH_DEGREE))));
                }
            }
        }
        (frequency_hz, tally)
    };
    FREQUENCIES_HZ.map(of_frequency).into()
}

/// Two of three frames at 50 to 120 Hz are found torn before the pieces of their edges are told, and pieces that stand still
/// are bent: of what is told at all frequencies one in twelve is not so, and one in so many is nearer than told.
fn assert_noticed(every: usize, told_for_each_far: usize) {
    let tallies = tallies(every);
    println!("   Hz frames torn  ok wrong  far wrong");
    for (frequency_hz, Tally { frames, torn, ok, far }) in &tallies {
        println!("{frequency_hz:5} {frames:6} {torn:4} {:3} {:5} {:4} {:5}", ok[0], ok[1], far[0], far[1]);
    }
    let sum = |of: fn(&Tally) -> usize| -> usize { tallies.iter().map(|(_, tally)| of(tally)).sum() };
    let (wrong, told) = (sum(Tally::wrong), sum(|tally| tally.ok[0] + tally.far[0]));
    let too_far = sum(|tally| tally.far[1]);
    println!("{wrong} of {told}, {too_far} too far");
    assert!(12 * wrong <= told && told_for_each_far * too_far <= told, "{wrong} of {told}, {too_far} too far");
}

#[test]
fn pulsed_light_is_noticed() {
    assert_noticed(7, 100);
}

#[test]
#[ignore = "half a minute; `pulsed_light_is_noticed` takes each seventh of them"]
fn pulsed_light_of_every_kind() {
    assert_noticed(1, 60);
}
