//! A camera drives past posts; the points of their edges are streamed row by row, and each range is printed as its line
//! ends.
//!
//! Desktop: `cargo run --release --example stream`
//! Board (emulated Cortex-M4F): `cargo run --release --example stream --target thumbv7em-none-eabihf`
//! Prints what is in `stream.out`.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod board;

use board::say;
use shutter_range::{EdgePoint, ParameterError, Polarity, Range, Ranger, Setup, Sigmas, Twist};

/// An edge of a post: bearing and depth at frame start, lean as a slope, and the rows that show it.
struct Post {
    bearing: f32,
    depth_m: f32,
    lean: f32,
    rows: core::ops::Range<u16>,
}

const SPEED_M_S: f32 = 1.5;
const POSTS: [Post; 4] = [
    Post { bearing: -0.40, depth_m: 1.2, lean: 0.0, rows: 40..200 },
    Post { bearing: -0.10, depth_m: 3.0, lean: 0.0, rows: 0..240 },
    Post { bearing: 0.15, depth_m: 300.0, lean: 0.0, rows: 60..240 },
    Post { bearing: 0.35, depth_m: 2.0, lean: -0.1, rows: 20..230 },
];

/// QVGA at 60 frames a second.
fn setup() -> Result<Setup<f32>, ParameterError> {
    Setup::pinhole(320, 240, 300.0, 16_666_667)
}

/// What an edge detector would deliver: the true column and some noise, in 1/65536 px.
fn column_q16(post: &Post, setup: &Setup<f32>, row: u16, noise: i32) -> i32 {
    let time_s = setup.readout().row_time_ns(row) as f32 * 1e-9;
    let w = (f32::from(row) - setup.camera().intrinsics().cy) / setup.camera().intrinsics().fy;
    let u = post.bearing + SPEED_M_S * time_s / post.depth_m + post.lean * w;
    let (column, _) = setup.camera().pixel(u, w);
    (column * 65536.0) as i32 + noise
}

fn report(range: &Range<f32>) {
    let depth = range.depth(Sigmas(2.0));
    let (rows, status) = ((range.first_row, range.last_row), range.status);
    match (depth.estimate_m, depth.nearest_m, depth.farthest_m) {
        (Some((depth_m, sigma_m)), Some(nearest), Some(farthest)) => {
            say!("rows {rows:?}: {depth_m:.3} m ± {sigma_m:.3}, [{nearest:.3}, {farthest:.3}], {status:?}");
        }
        (None, Some(nearest), None) => say!("rows {rows:?}: farther than {nearest:.3} m, {status:?}"),
        _ => say!("rows {rows:?}: no distance, {status:?}"),
    }
}

fn main() {
    let setup = setup().expect("a sound setup");
    let motion = Twist::level([-SPEED_M_S, 0.0, 0.0]).expect("a sound motion");
    let mut ranger = const { Ranger::<8, 12, 8>::new() };
    let mut random = 1_u32;
    for row in 0..setup.readout().rows() {
        for post in POSTS.iter().filter(|post| post.rows.contains(&row)) {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = (random >> 18) as i32 - (1 << 13); // ±1/8 px, evenly: 0.072 px of sigma
            let point = EdgePoint::new(row, column_q16(post, &setup, row, noise), setup.readout().row_time_ns(row));
            let point = point.with_polarity(Polarity::Rising).with_sigma_q16(4729);
            if let Err(refused) = ranger.edge_point(&setup, point) {
                say!("{refused}");
            }
        }
        ranger.end_row(&setup, row).expect("rows come in order");
        while let Some(range) = ranger.next_range(&setup, &motion) {
            report(&range);
        }
    }
    ranger.end_frame(&setup);
    while let Some(range) = ranger.next_range(&setup, &motion) {
        report(&range);
    }
}
