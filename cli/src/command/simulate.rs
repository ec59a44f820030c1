//! Command `simulate`: frames of the library's simulator, with their truth.

use std::fs;
use std::path::Path;

use anyhow::{Context, Error, Result, anyhow, ensure};
use image::GrayImage;
use shutter_range::sim::{Exposure, Simulator};
use shutter_range::{Camera, Distortion, Intrinsics, Motion, ParameterError, Twist};

use crate::arguments::SimulateArgs;
use crate::input::bounded_read;
use crate::input::scene_file::{self, OBJECTS, SceneFile};
use crate::input::setup::{self, SetupFile};
use crate::output::progress;
use crate::output::terminal;
use crate::output::truth::{TruthDocument, TruthFrame};

pub(crate) fn frames(arguments: &SimulateArgs) -> Result<TruthDocument> {
    let setup_path = &arguments.setup.path;
    let file = setup::load(setup_path)?;
    let scene_text = match &arguments.scene {
        Some(path) => bounded_read::read_text(path, &scene_file::LIMIT)?,
        None => scene_file::STREET.to_string(),
    };
    let named =
        || arguments.scene.as_ref().map_or("the built-in street".to_string(), |path| path.display().to_string());
    let scene = scene_file::parse(&scene_text).with_context(named)?;
    let simulator = simulator(&file, &scene, arguments.seed).with_context(|| setup_path.display().to_string())?;
    make_folder(&arguments.out)?;
    let document = render(&simulator, &file, arguments)?;
    write(&arguments.out.join("setup.toml"), file.text.as_bytes())?;
    write(&arguments.out.join("scene.toml"), scene_text.as_bytes())?;
    write(&arguments.out.join("truth.json"), terminal::json(&document)?.as_bytes())?;
    Ok(document)
}

/// The setup's camera, motion and optics in the numbers of the simulator.
fn simulator<'a>(file: &SetupFile, scene: &'a SceneFile, seed: u64) -> Result<Simulator<'a, OBJECTS>> {
    let camera = file.setup.camera();
    ensure!(
        *camera.distortion() == Distortion::NONE,
        "`camera.distortion` must be left out or zero: the simulated lens is a pinhole"
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
    Simulator::new(&scene.scene, &camera, readout, &motion, exposure, seed).map_err(|error| named(&error))
}

/// What the simulator refuses, under its name in the setup file.
fn named(error: &ParameterError) -> Error {
    let name = match error.parameter {
        "time_s" => "camera.exposure_s",
        "psf_sigma_px" => "camera.lens_blur_px",
        other => other,
    };
    anyhow!("`{name}` is {}, but must be {}", error.value, error.expected)
}

/// Files of the same names are replaced, so a folder that someone keeps other things in is refused.
fn make_folder(folder: &Path) -> Result<()> {
    let name = folder.display();
    let is_ours = folder.join("truth.json").exists();
    let is_empty = match fs::read_dir(folder) {
        Ok(mut entries) => entries.next().is_none(),
        Err(_) => true,
    };
    ensure!(
        is_ours || is_empty,
        "{name} holds other files: --out must be a new or empty folder, or an earlier simulation"
    );
    fs::create_dir_all(folder).with_context(|| format!("making {name}"))
}

fn render(simulator: &Simulator<'_, OBJECTS>, file: &SetupFile, arguments: &SimulateArgs) -> Result<TruthDocument> {
    let readout = file.setup.readout();
    let readout_s = readout.line_time_ps() as f64 * 1e-12 * f64::from(readout.rows());
    let interval_s = arguments.frame_interval_s.unwrap_or(readout_s.max(1.0 / 30.0));
    let digits = (arguments.frames - 1).to_string().len().max(4);
    let bar = progress::bar(arguments.frames.into());
    let mut frames = Vec::new();
    for number in 0..arguments.frames {
        let start_s = f64::from(number) * interval_s;
        let simulator = simulator.clone().at_frame(number, (start_s * 1e9).round() as i64);
        let name = format!("frame-{number:0digits$}.png");
        let path = arguments.out.join(&name);
        let picture = picture(&simulator, file)?;
        picture.save(&path).with_context(|| format!("writing {}", path.display()))?;
        frames.push(TruthFrame::new(name, start_s, &simulator.motion()?, simulator.truth()));
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(TruthDocument { seed: arguments.seed, frames })
}

fn picture(simulator: &Simulator<'_, OBJECTS>, file: &SetupFile) -> Result<GrayImage> {
    let size = file.size();
    let mut pixels = vec![0; size.columns as usize * size.rows as usize];
    for (row, of_row) in (0..).zip(pixels.chunks_exact_mut(size.columns as usize)) {
        simulator.row(row, of_row);
    }
    GrayImage::from_raw(size.columns, size.rows, pixels).context("a frame of the camera's size")
}

fn write(path: &Path, content: &[u8]) -> Result<()> {
    fs::write(path, content).with_context(|| format!("writing {}", path.display()))
}
