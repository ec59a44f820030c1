//! A camera stands still beside a road, and a van passes: with the relative velocity the van's edges have ranges, and
//! from the second frame on the lean of each of them is known.
//!
//! Desktop: `cargo run --release --example passing`
//! Board (emulated Cortex-M4F): `cargo run --release --example passing --target thumbv7em-none-eabihf`
//! Prints what is in `passing.out`.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod board;

use board::say;
use shutter_range::{
    EdgePoint, Motion, ParameterError, Polarity, Range, Ranger, Sequence, Setup, Sigmas, Twist, Uncertainty,
};

/// An edge of the van: its place at first, and its lean as a slope.
struct Pillar {
    x_m: f32,
    z_m: f32,
    lean: f32,
    polarity: Polarity,
}

/// The van drives to the right and comes a little nearer: its velocity, as a radar would measure it.
const VAN_M_S: [f32; 3] = [8.0, 0.0, -0.5];
const PILLARS: [Pillar; 3] = [
    Pillar { x_m: -3.2, z_m: 7.0, lean: 0.0, polarity: Polarity::Rising },
    Pillar { x_m: -1.9, z_m: 7.0, lean: 0.012, polarity: Polarity::Falling },
    Pillar { x_m: -0.9, z_m: 7.05, lean: -0.008, polarity: Polarity::Falling },
];
const FRAMES: u8 = 4;
const INTERVAL_S: f32 = 1.0 / 30.0;

/// VGA at 30 frames a second; pillars may lean by half a degree, and the van's speed is known to 1 %.
fn setup() -> Result<Setup<f32>, ParameterError> {
    let uncertainty = Uncertainty::NONE.with_sigma_tilt(0.0087).with_sigma_speed(0.01);
    Setup::pinhole(640, 480, 600.0, 30_000_000)?.with_uncertainty(uncertainty)
}

/// What an edge detector would deliver: the true column and some noise.
fn point_of(pillar: &Pillar, setup: &Setup<f32>, frame: u8, row: u16, noise: i32) -> Option<EdgePoint> {
    let time_ns = setup.readout().row_time_ns(row);
    let time_s = f32::from(frame) * INTERVAL_S + time_ns as f32 * 1e-9;
    let [vx, _, vz] = VAN_M_S;
    let w = (f32::from(row) - setup.camera().intrinsics().cy) / setup.camera().intrinsics().fy;
    let u = (pillar.x_m + vx * time_s) / (pillar.z_m + vz * time_s) + pillar.lean * w;
    let (column, _) = setup.camera().pixel(u, w);
    let point = EdgePoint::new(row, (column * 65536.0) as i32 + noise, time_ns);
    let point = point.with_polarity(pillar.polarity).with_sigma_q16(4729);
    setup.camera().contains(point.column_q16, row).then_some(point)
}

fn report(range: &Range<f32>) {
    let (id, frames, status) = (range.line_id.unwrap_or(0), range.frames, range.status);
    let source = range.estimate.budget.dominant();
    match range.depth(Sigmas(2.0)).estimate_m {
        Some((depth_m, sigma_m)) => {
            let (tilt, sigma_tilt) = (range.estimate.tilt * 57.3, range.estimate.sigma_tilt * 57.3);
            say!(
                "  edge {id}, {frames} frames: {depth_m:.3} m ± {sigma_m:.3} ({source:?}), leans {tilt:+.2}° ± {sigma_tilt:.3}°"
            );
        }
        None => say!("  edge {id}, {frames} frames: no distance, {status:?}"),
    }
}

fn main() {
    let setup = setup().expect("a sound setup");
    // The camera's own velocity as the van sees it.
    let [vx, vy, vz] = VAN_M_S;
    let motion = Twist::level([-vx, -vy, -vz]).expect("a sound motion");
    let mut ranger = const { Ranger::<3, 8, 4>::new() };
    let mut sequence = const { Sequence::<f32, 3>::new() };
    let mut random = 1_u32;
    for frame in 0..FRAMES {
        say!("frame {frame}");
        for row in 0..setup.readout().rows() {
            for pillar in &PILLARS {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let noise = (random >> 18) as i32 - (1 << 13); // ±1/8 px, evenly: 0.072 px of sigma
                if let Some(point) = point_of(pillar, &setup, frame, row, noise) {
                    ranger.edge_point(&setup, point).expect("rows come in order");
                }
            }
        }
        ranger.end_frame(&setup);
        sequence.frame(&setup, &motion, &mut ranger, |range| report(&range));
        sequence.advance(&setup, &motion.pose(INTERVAL_S), INTERVAL_S, motion.gravity()).expect("sound gravity");
    }
}
