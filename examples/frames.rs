//! No camera is needed: the simulator renders a street of posts row by row, and each range is printed as its line ends.
//!
//! Desktop: `cargo run --release --example frames`
//! Board (emulated Cortex-M4F, 16 KiB of RAM): `cargo run --release --example frames --target thumbv7em-none-eabihf`
//! Prints what is in `frames.out`.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod board;

use board::say;
use shutter_range::sim::{Background, Bar, Exposure, Rail, Scene, Simulator};
use shutter_range::{MotionBlur, ParameterError, Range, RangeStatus, Ranger, Response, Setup, Sigmas, Twist};

const COLUMNS: u16 = 320;
const EXPOSURE_S: f32 = 0.006;
const LENS_BLUR_PX: f32 = 0.7;
/// 4.6 kB.
type SmallRanger = Ranger<8, 8, 24>;

/// QVGA at 30 frames a second, with a known exposure and a calibrated lens.
fn setup() -> Result<Setup<f32>, ParameterError> {
    let lens = MotionBlur::from_calibrated_lens(EXPOSURE_S, LENS_BLUR_PX);
    Setup::pinhole(COLUMNS, 240, 300.0, 33_333_333)?.with_response(Response::Linear).with_motion_blur(lens)
}

/// Two posts, a tower, a bar that leans like the edge of something nearer, and a rail before all of them.
fn scene() -> Result<Scene<5>, ParameterError> {
    let mut scene = Scene::new(Background::plain(190.0))?;
    scene.push(Bar::upright(-0.32, 1.2, 0.06, 50.0))?;
    scene.push(Bar::upright(-0.05, 40.0, 2.0, 90.0))?;
    scene.push(Bar::upright(0.14, 2.0, 0.10, 70.0).between(-0.5, 0.3))?;
    scene.push(Bar::upright(0.36, 2.5, 0.12, 60.0).leaning(0.2))?;
    scene.push(Rail { depth_m: 1.0, top_m: 0.05, bottom_m: 0.08, level: 120.0 })?;
    Ok(scene)
}

fn report(range: &Range<f32>) {
    let Range { first_row, last_row, status, polarity, column_at_first_row: column, .. } = range;
    let place = format_args!("rows {first_row:2} to {last_row}, column {column:5.1}, {polarity:?}");
    let depth = range.depth(Sigmas(2.0));
    match (depth.estimate_m, depth.nearest_m) {
        (Some((depth_m, sigma_m)), _) => say!("  {place}: {depth_m:.3} m ± {sigma_m:.3}"),
        (None, Some(nearest)) if *status == RangeStatus::Far => say!("  {place}: farther than {nearest:.1} m"),
        _ => say!("  {place}: no distance, {status:?}"),
    }
}

fn main() {
    let setup = setup().expect("a sound setup");
    let scene = scene().expect("a sound scene");
    let exposure = Exposure { time_s: EXPOSURE_S, psf_sigma_px: LENS_BLUR_PX, read_noise: 2.0, shot_gain: 0.05 };
    let to_the_side = Twist::level([1.5, 0.0, 0.0]).expect("a sound motion");
    let ahead_in_a_turn = Twist::new([0.6, 0.0, 2.0], [0.0, -0.4, 0.1], [0.0, 1.0, 0.0]).expect("a sound motion");

    // In a constant: a board with 16 KiB has no room for the one that is made and the one that it is copied to.
    let mut ranger = const { SmallRanger::new() };
    let mut pixels = [0; COLUMNS as usize];
    for (frame, motion) in (0..).zip([&to_the_side, &ahead_in_a_turn]) {
        say!("frame {frame}");
        let simulator = Simulator::new(&scene, setup.camera(), setup.readout(), motion, exposure, 1)
            .expect("a sound simulator")
            .at_frame(frame, 0);
        for row in 0..setup.readout().rows() {
            simulator.row(row, &mut pixels);
            if let Err(torn) = ranger.row(&setup, row, &pixels) {
                say!("  {torn}");
            }
            while let Some(range) = ranger.next_range(&setup, motion) {
                report(&range);
            }
        }
        ranger.end_frame(&setup);
        while let Some(range) = ranger.next_range(&setup, motion) {
            report(&range);
        }
    }
}
