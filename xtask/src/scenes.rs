//! The scenes of pixels: what stands before a QVGA camera that moves sideways at 1.5 m/s.

use anyhow::{Context, Result};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use shutter_range::format::PixelFormat;
use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator, Texture, Tint};
use shutter_range::{Setup, Twist};

use crate::job::{Motion, Rig};

/// So many frames of each scene, with noise of their own.
const FRAMES: u32 = 4;
const FOCAL_PX: f32 = Rig::QVGA.focal_px as f32;
/// Grey levels: a contrast of 110.
const BRIGHT: f32 = 170.0;
const DARK: f32 = 60.0;

/// The bytes of a frame, row by row.
pub(crate) type Frame = Vec<u8>;

/// The frames of a scene.
pub(crate) fn frames(scene: &str) -> Result<Option<Vec<Frame>>> {
    let frames = match scene {
        "flat" => render(&Scene::new(Background::plain(115.0))?, false)?,
        "two bars" => render(&with(Background::plain(BRIGHT), &TWO_BARS)?, false)?,
        "five bars" => render(&with(Background::plain(BRIGHT), &five_bars())?, false)?,
        "noise 12" => render(&with(Background::plain(BRIGHT), &TWO_BARS)?, true)?,
        "clutter" => clutter()?,
        "fence" => render(&fence()?, false)?,
        _ => return Ok(None),
    };
    Ok(Some(frames))
}

type Objects = Scene<48>;

/// 12 cm wide, at 1 and 2 m.
const TWO_BARS: [Bar; 2] = [Bar::upright(-0.2, 1.0, 0.12, DARK), Bar::upright(0.2, 2.0, 0.12, DARK)];

fn five_bars() -> [Bar; 5] {
    let bar = |k: f32| Bar::upright(0.18 * (k - 2.0), 1.5 + 0.5 * k, 0.12, DARK);
    [0.0, 1.0, 2.0, 3.0, 4.0].map(bar)
}

fn with(background: Background, bars: &[Bar]) -> Result<Objects> {
    let mut scene = Scene::new(background)?;
    for bar in bars {
        scene.push(*bar)?;
    }
    Ok(scene)
}

/// Bars of 4 px every 8 px, 1 m away, over the whole row.
fn fence() -> Result<Objects> {
    let pixel = 1.0 / FOCAL_PX;
    let bars: Vec<Bar> =
        (0..44_u8).map(|k| Bar::upright((f32::from(k) - 22.0) * 8.0 * pixel, 1.0, 4.0 * pixel, DARK)).collect();
    with(Background::plain(BRIGHT), &bars)
}

/// Two upright bars before 24 that lean by 8° to 75°, before a texture of 12 levels RMS: cells of 2, 4, 8 and 16 px in
/// one frame each.
fn clutter() -> Result<Vec<Frame>> {
    // An even distribution between neighbours that are interpolated smoothly: the RMS is 0.4 of the largest deviation.
    const CONTRAST: f32 = 30.0;
    let mut frames = Vec::new();
    for (seed, cell_px) in [(1, 2.0), (2, 4.0), (3, 8.0), (4, 16.0)] {
        let mut random = StdRng::seed_from_u64(seed.into());
        let texture = Texture { contrast: CONTRAST, cell: cell_px / FOCAL_PX, seed };
        let mut scene = Objects::new(Background::textured(150.0, texture))?;
        for _ in 0..24 {
            scene.push(leaning(&mut random))?;
        }
        for bar in TWO_BARS {
            scene.push(Bar { level: 150.0 - 110.0, ..bar })?;
        }
        frames.push(frame(&scene, exposure(false), seed.into())?);
    }
    Ok(frames)
}

fn leaning(random: &mut StdRng) -> Bar {
    let sign = if random.random() { 1.0 } else { -1.0 };
    let lean = sign * random.random_range(8.0_f32..=75.0).to_radians().tan();
    let bearing = random.random_range(-0.53..=0.53);
    let (depth_m, width_m) = (random.random_range(2.5..=6.0), random.random_range(0.03..=0.12));
    Bar::upright(bearing, depth_m, width_m, random.random_range(90.0..=230.0)).between(-0.7, 0.7).leaning(lean)
}

fn exposure(is_noisy: bool) -> Exposure {
    let (read_noise, shot_gain) = if is_noisy { (12.0, 0.0) } else { (2.5, 0.03) };
    Exposure { time_s: Rig::QVGA.exposure_s as f32, psf_sigma_px: Rig::QVGA.lens_px as f32, read_noise, shot_gain }
}

/// The two bars in another pixel format; those of a mosaic are seen in coloured light.
pub(crate) fn two_bars_in(format: PixelFormat) -> Result<Vec<Frame>> {
    let scene = with(Background::plain(BRIGHT), &TWO_BARS)?;
    let tint = Tint { offset: [25.0, 0.0, 45.0], gain: [0.8, 1.0, 0.7] };
    (0..FRAMES).map(|seed| frame_in(&scene, exposure(false), seed.into(), format, tint)).collect()
}

fn render(scene: &Objects, is_noisy: bool) -> Result<Vec<Frame>> {
    (0..FRAMES).map(|seed| frame(scene, exposure(is_noisy), seed.into())).collect()
}

fn frame(scene: &Objects, exposure: Exposure, seed: u64) -> Result<Frame> {
    frame_in(scene, exposure, seed, PixelFormat::Grey8, Tint::NEUTRAL)
}

fn frame_in(scene: &Objects, exposure: Exposure, seed: u64, format: PixelFormat, tint: Tint) -> Result<Frame> {
    let Rig { columns, rows, readout_ns, .. } = Rig::QVGA;
    let setup = Setup::pinhole(columns, rows, FOCAL_PX, readout_ns.unsigned_abs())?;
    let motion = Twist::level(Motion::SIDEWAYS.velocity_m_s.map(|speed| speed as f32))?;
    let simulator = Simulator::new(scene, setup.camera(), setup.readout(), &motion, exposure, seed)?;
    let simulator = simulator.with_tint(tint)?;
    let row_bytes = format.row_bytes(columns).context("a row of this format")?;
    let mut frame = vec![0; row_bytes * usize::from(rows)];
    (0..rows).zip(frame.chunks_mut(row_bytes)).for_each(|(row, bytes)| simulator.row_in(row, format, bytes));
    Ok(frame)
}
