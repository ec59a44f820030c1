//! Command `simulate`: frames of the library's simulator, with their truth.

use std::io::Cursor;
use std::path::Path;

use anyhow::{Context, Error, Result, anyhow, bail, ensure};
use image::{GrayImage, ImageFormat};
use shutter_range::format::PixelFormat;
use shutter_range::sim::{Exposure, Flicker, Simulator};
use shutter_range::{Camera, Distortion, Intrinsics, Motion, ParameterError, Response, Twist};

use crate::arguments::SimulateArgs;
use crate::input::bounded_read;
use crate::input::file_identity::FileIdentity;
use crate::input::scene_file::{self, OBJECTS, SceneFile};
use crate::input::setup::{self, SetupFile};
use crate::output::simulation_folder::{self, PNG, RAW, SCENE, SETUP, SimulationFolder, TRAJECTORY, TRUTH};
use crate::output::terminal;
use crate::output::truth::{TruthDocument, TruthFrame};
use crate::output::{motion_file, progress};

/// Refuses a simulation that would replace a file that it reads.
pub(crate) fn check_inputs(arguments: &SimulateArgs) -> Result<(), String> {
    let setup = &arguments.setup;
    let inputs = [
        ("--setup", Some(&setup.path)),
        ("--camera", setup.camera.path.as_ref()),
        ("--scene", arguments.scene.as_ref()),
    ];
    // What cannot be listed holds nothing to replace.
    let replaced = simulation_folder::files(&arguments.out).unwrap_or_default();
    for file in replaced {
        let is_file = |path: &Path| FileIdentity::of(path) == FileIdentity::of(&file);
        let input = inputs.into_iter().find(|(_, path)| path.is_some_and(|path| is_file(path)));
        if let Some((option, _)) = input {
            return Err(format!("--out would replace {}, which {option} reads: choose another folder", file.display()));
        }
    }
    Ok(())
}

pub(crate) fn frames(arguments: &SimulateArgs) -> Result<TruthDocument> {
    let setup_path = &arguments.setup.path;
    let file = setup::load(arguments.setup.source())?;
    let several = arguments.frame_interval_s.filter(|interval_s| *interval_s > 0.0 && arguments.frames > 1);
    if let Some(interval_s) = several.filter(|interval_s| *interval_s < file.least_interval_s()) {
        bail!(
            "--frame-interval-s is {interval_s}, but must be at least {} s, the readout of a frame in the setup, or 0",
            file.readout_s()
        );
    }
    file.check_exposure(several)?;
    let (scene_text, scene_name) = match &arguments.scene {
        Some(path) => (bounded_read::read_text(path, &scene_file::LIMIT)?, path.display().to_string()),
        None => (scene_file::STREET.to_string(), "the built-in street".to_string()),
    };
    let scene = scene_file::parse(&scene_text).with_context(|| scene_name.clone())?;
    let simulator = simulator(&file, &scene, arguments.seed).with_context(|| setup_path.display().to_string())?;
    let simulator = lit(simulator, scene.lamp).context(scene_name)?;
    let simulator = match arguments.swing() {
        Some(swing) => simulator.with_swing(swing)?,
        None => simulator,
    };
    let mut folder = SimulationFolder::open(&arguments.out, arguments.overwrite)?;
    let interval_s = arguments.frame_interval_s.unwrap_or(file.readout_s().max(1.0 / 30.0));
    let document = render(&simulator, &file, interval_s, arguments, &mut folder)?;
    let until_s = f64::from(arguments.frames - 1) * interval_s + file.readout_s();
    let motion = motion_file::text(&simulator, file.mount.as_ref(), until_s, arguments.clock_offset_s)?;
    folder.write(SETUP, file.text.as_bytes())?;
    folder.write(SCENE, scene_text.as_bytes())?;
    folder.write(TRUTH, terminal::json(&document)?.as_bytes())?;
    folder.write(TRAJECTORY, motion.as_bytes())?;
    folder.finish()?;
    Ok(document)
}

/// The setup's camera, motion and optics as the simulator takes them.
fn simulator<'a>(file: &SetupFile, scene: &'a SceneFile, seed: u64) -> Result<Simulator<'a, OBJECTS>> {
    let camera = file.setup.camera();
    ensure!(
        *camera.distortion() == Distortion::NONE,
        "`camera.distortion` must be left out or zero: the simulated lens is a pinhole"
    );
    ensure!(
        matches!(file.setup.response(), Response::Unknown | Response::Linear),
        "`camera.response` must be left out, \"linear\" or \"unknown\": simulated grey levels are proportional to the light"
    );
    let Intrinsics { columns, rows, fx, fy, cx, cy } = *camera.intrinsics();
    let [fx, fy, cx, cy] = [fx, fy, cx, cy].map(|value| value as f32);
    let camera = Camera::new(Intrinsics { columns, rows, fx, fy, cx, cy }, Distortion::NONE)?;
    let motion = &file.motion;
    let [velocity, rate, gravity] =
        [motion.velocity_m_s(), motion.rate_rad_s(), motion.gravity()].map(|vector| vector.map(|value| value as f32));
    let motion = Twist::new(velocity, rate, gravity)?;
    let usual = Exposure::default();
    let exposure = Exposure {
        time_s: file.optics.exposure_s.map_or(usual.time_s, |seconds| seconds as f32),
        psf_sigma_px: file.optics.lens_blur_px.map_or(usual.psf_sigma_px, |pixels| pixels as f32),
        read_noise: scene.read_noise,
        shot_gain: scene.shot_gain,
    };
    let readout = file.setup.readout();
    let simulator = Simulator::new(&scene.scene, &camera, readout, &motion, exposure, seed);
    simulator.map_err(|error| by_its_key(&error))
}

/// By the scene's lamp, if it has one.
fn lit<'a>(simulator: Simulator<'a, OBJECTS>, lamp: Option<Flicker>) -> Result<Simulator<'a, OBJECTS>> {
    let Some(lamp) = lamp else { return Ok(simulator) };
    simulator
        .with_flicker(lamp)
        .map_err(|error| anyhow!("`lamp.{}` is {}, but must be {}", error.parameter, error.value, error.expected))
}

/// A parameter that the simulator refuses, under its key in the setup file.
fn by_its_key(error: &ParameterError) -> Error {
    let name = match error.parameter {
        "time_s" => "camera.exposure_s",
        "psf_sigma_px" => "camera.lens_blur_px",
        other => other,
    };
    anyhow!("`{name}` is {}, but must be {}", error.value, error.expected)
}

fn render(
    simulator: &Simulator<'_, OBJECTS>,
    file: &SetupFile,
    interval_s: f64,
    arguments: &SimulateArgs,
    folder: &mut SimulationFolder,
) -> Result<TruthDocument> {
    let bar = progress::bar(arguments.frames.into());
    let mut frames = Vec::new();
    for number in 0..arguments.frames {
        let start_s = f64::from(number) * interval_s;
        let simulator = simulator.clone().at_frame(number, (start_s * 1e9).round() as i64);
        let extension = if arguments.raw.is_some() { RAW } else { PNG };
        let name = simulation_folder::frame_name(number, arguments.frames, extension);
        let content = match arguments.raw {
            Some(format) => dump(&simulator, file, format)?,
            None => png(&picture(&simulator, file)?)?,
        };
        folder.write(&name, &content)?;
        frames.push(TruthFrame::new(name, start_s, &simulator.motion()?, simulator.truth()));
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(TruthDocument { seed: arguments.seed, frames })
}

fn picture(simulator: &Simulator<'_, OBJECTS>, file: &SetupFile) -> Result<GrayImage> {
    let size = file.size();
    let mut pixels = vec![0; size.columns as usize * size.rows as usize];
    for (row, row_pixels) in (0..).zip(pixels.chunks_exact_mut(size.columns as usize)) {
        simulator.row(row, row_pixels);
    }
    GrayImage::from_raw(size.columns, size.rows, pixels).context("a frame of the camera's size")
}

/// The rows one after the other, as the sensor delivers them.
fn dump(simulator: &Simulator<'_, OBJECTS>, file: &SetupFile, format: PixelFormat) -> Result<Vec<u8>> {
    let (size, columns) = (file.size(), file.setup.camera().intrinsics().columns);
    let row_bytes = format.row_bytes(columns);
    let row_bytes = row_bytes.with_context(|| format!("rows of {format} must have a multiple of four pixels"))?;
    let mut bytes = vec![0; row_bytes * size.rows as usize];
    for (row, row_bytes) in (0..).zip(bytes.chunks_exact_mut(row_bytes)) {
        simulator.row_in(row, format, row_bytes);
    }
    Ok(bytes)
}

fn png(picture: &GrayImage) -> Result<Vec<u8>> {
    let mut file = Cursor::new(Vec::new());
    picture.write_to(&mut file, ImageFormat::Png).context("encoding a PNG")?;
    Ok(file.into_inner())
}
