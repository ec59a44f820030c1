//! Frames of `sim`, the ranges that a ranger finds in them, and how far off they are.

use shutter_range::sim::{Background, Bar, Exposure, Object, Scene, Simulator, Truth};
use shutter_range::{Range, RangeStatus, Ranger, ReadoutDirection, Scalar, Setup, Uncertainty};

use crate::projection;

pub(crate) const COLUMNS: u16 = 320;
pub(crate) const ROWS: u16 = 240;
pub(crate) const TOP: ReadoutDirection = ReadoutDirection::TopToBottom;
pub(crate) type Frame = Vec<Vec<u8>>;

/// As it fits on a small board.
pub(crate) type SmallRanger = Ranger<16, 10, 32>;

/// A QVGA camera, 300 px of focal length and 1/30 s of readout, that moves to the right.
pub(crate) fn moving(speed_m_s: f64) -> projection::Scene {
    projection::Scene {
        columns: COLUMNS,
        rows: ROWS,
        focal_px: 300.0,
        cx: 159.5,
        cy: 119.5,
        velocity_m_s: [speed_m_s, 0.0, 0.0],
        ..projection::Scene::vga()
    }
}

pub(crate) fn scene_of<const N: usize>(background: f32, objects: [Object; N]) -> Scene<N> {
    let mut scene = Scene::new(Background::plain(background)).expect("sound background");
    for object in objects {
        scene.push(object).expect("a sound object");
    }
    scene
}

/// Where the chance of a normally distributed error is one in 16000.
pub(crate) const MOST_SIGMAS: f64 = 4.0;

/// The frame, and its bars' edges from left to right.
pub(crate) fn render<const N: usize>(
    scene: &Scene<N>,
    world: &projection::Scene,
    direction: ReadoutDirection,
    exposure: Exposure,
    seed: u64,
) -> (Frame, Vec<Truth>) {
    let setup = world.setup_read::<f32>(Uncertainty::NONE, direction);
    let (camera, readout) = (setup.camera(), setup.readout());
    let simulator = Simulator::new(scene, camera, readout, &world.motion(), exposure, seed).expect("sound parameters");
    let row = |row| {
        let mut pixels = vec![0; COLUMNS.into()];
        simulator.row(row, &mut pixels);
        pixels
    };
    let mut truths: Vec<_> = simulator.truth().collect();
    truths.sort_by(|a, b| a.bearing.total_cmp(&b.bearing));
    ((0..ROWS).map(row).collect(), truths)
}

/// Feeds a frame in the order of its readout and takes the ranges, from left to right.
pub(crate) fn ranges_of<S: Scalar, const LINES: usize, const KNOTS: usize, const POINTS: usize>(
    ranger: &mut Ranger<LINES, KNOTS, POINTS>,
    setup: &Setup<S>,
    world: &projection::Scene,
    frame: &Frame,
) -> Vec<Range<S>> {
    let motion = world.motion::<S>();
    let mut found = Vec::new();
    for index in 0..ROWS {
        let row = setup.readout().row_after(index);
        ranger.row(setup, row, &frame[usize::from(row)]).expect("rows in order");
        found.extend(ranger.ranges(setup, &motion));
    }
    ranger.end_frame(setup);
    found.extend(ranger.ranges(setup, &motion));
    found.sort_by(|a, b| a.column_at_first_row.to_f64().total_cmp(&b.column_at_first_row.to_f64()));
    found
}

/// Error of the inverse depth: relative, and in units of the stated sigma.
pub(crate) fn errors<S: Scalar>(range: &Range<S>, truth: &Truth) -> (f64, f64) {
    let estimate = &range.estimate;
    let error = estimate.inverse_depth_per_m.to_f64() - 1.0 / truth.depth_m;
    (error * truth.depth_m, error / estimate.sigma_inverse_depth_per_m.to_f64())
}

/// A range for each edge, and nothing else: `Ok`, of its polarity, with an error below four sigma and below `relative`.
///
/// The latter is several times the Cramér–Rao bound of the scene, so that no overstated sigma hides an error.
pub(crate) fn assert_found<S: Scalar>(name: &str, found: &[Range<S>], truths: &[Truth], relative: f64) {
    assert_eq!(found.len(), truths.len(), "{name}: {found:#?} for {truths:#?}");
    for (range, truth) in found.iter().zip(truths) {
        let (error, normal) = errors(range, truth);
        let is_near = error.abs() < relative && normal.abs() < MOST_SIGMAS;
        assert_eq!(
            (range.status, range.polarity),
            (RangeStatus::Ok, truth.polarity),
            "{name}: {range:?} for {truth:?}"
        );
        assert!(is_near, "{name}: {error} or {normal} sigma, {range:?} for {truth:?}");
    }
}

pub(crate) fn post() -> Scene<1> {
    scene_of(180.0, [Bar::upright(0.05, 2.0, 0.1, 60.0).into()])
}
