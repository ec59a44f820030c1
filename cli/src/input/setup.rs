//! Setup files: camera, motion and attitude in TOML.

use std::path::Path;

use anyhow::{Context, Error, Result, anyhow};
use shutter_range::{
    Camera, Distortion, Intrinsics, MotionBlur, ParameterError, Readout, ReadoutDirection, Setup, Twist, Uncertainty,
};

use super::bounded_read::{self, Limit, MEBIBYTE};
use super::bounds::Bounds;
use super::keys::{KEYS, Section, refuse_unknown};
use super::size::Size;
use super::toml_file;

/// Every key with its comment takes a few kilobytes.
const LIMIT: Limit<'_> = Limit { bytes: MEBIBYTE, rule: "a setup must have at most" };

pub(crate) struct SetupFile {
    /// The file itself.
    pub(crate) text: String,
    pub(crate) setup: Setup<f64>,
    pub(crate) motion: Twist<f64>,
    /// Noise of edge points that come without their own.
    pub(crate) sigma_column_px: f64,
    pub(crate) optics: Optics,
}

/// What is known of the blur of edges.
#[derive(Clone, Copy)]
pub(crate) struct Optics {
    pub(crate) exposure_s: Option<f64>,
    /// One sigma.
    pub(crate) lens_blur_px: Option<f64>,
}

impl SetupFile {
    /// The size of the camera's image.
    pub(crate) fn size(&self) -> Size {
        let image = self.setup.camera().intrinsics();
        Size { columns: image.columns.into(), rows: image.rows.into() }
    }
}

/// A column that is noisier says nothing.
pub(crate) const SIGMA_PX: Bounds = Bounds::above_zero(256.0, "pixels, one standard deviation");
const SIZE: Bounds = Bounds::whole(1.0, 32_767.0, "pixels");
const RELATIVE: Bounds = Bounds::number(0.0, 1.0, "relative, one standard deviation");
const DEGREES: Bounds = Bounds::number(0.0, 45.0, "degrees, one standard deviation");
const FOCAL_PX: Bounds = Bounds::number(1.0, 1e6, "focal length in pixels");
const PIXELS: Bounds = Bounds::finite("pixels");
pub(crate) const SPEED: Bounds = Bounds::number(-10_000.0, 10_000.0, "m/s");
pub(crate) const RATE: Bounds = Bounds::number(-1_000.0, 1_000.0, "rad/s");
pub(crate) const DIRECTION: Bounds = Bounds::number(-1000.0, 1000.0, "only its direction counts");

pub(crate) fn load(path: &Path) -> Result<SetupFile> {
    load_with(path, None)
}

/// The same, but the file may leave out the velocity: a trajectory replaces it.
pub(crate) fn load_without_velocity(path: &Path) -> Result<SetupFile> {
    load_with(path, Some([0.0; 3]))
}

fn load_with(path: &Path, default_velocity_m_s: Option<[f64; 3]>) -> Result<SetupFile> {
    let text = bounded_read::read_text(path, &LIMIT)?;
    parse(text, default_velocity_m_s).with_context(|| path.display().to_string())
}

fn parse(text: String, default_velocity_m_s: Option<[f64; 3]>) -> Result<SetupFile> {
    let file = toml_file::parse(&text)?;
    refuse_unknown(&file)?;
    let camera = Section::of(&file, "camera");
    let motion = Section::of(&file, "motion");
    let attitude = Section::of(&file, "attitude");
    let optics = optics(&camera)?;
    let setup =
        Setup::new(lens(&camera)?, readout(&camera)?)?.with_uncertainty(uncertainty(&camera, &motion, &attitude)?);
    Ok(SetupFile {
        text,
        setup: with_optics(setup.map_err(by_its_key)?, &optics)?,
        motion: twist(&motion, &attitude, default_velocity_m_s)?,
        sigma_column_px: camera.number("sigma_column_px", SIGMA_PX)?.unwrap_or(0.1),
        optics,
    })
}

fn with_optics(setup: Setup<f64>, optics: &Optics) -> Result<Setup<f64>> {
    let Some(exposure_s) = optics.exposure_s else { return Ok(setup) };
    let motion_blur = match optics.lens_blur_px {
        Some(lens_blur_px) => MotionBlur::from_calibrated_lens(exposure_s, lens_blur_px),
        None => MotionBlur::from_exposure(exposure_s),
    };
    setup.with_motion_blur(motion_blur).map_err(by_its_key)
}

/// A parameter that the library refuses, under its key in the file.
fn by_its_key(error: ParameterError) -> Error {
    let name = error.parameter;
    if name == "distortion" {
        return anyhow!("`camera.distortion` folds over at radius {:.3}: it must be {}", error.value, error.expected);
    }
    match KEYS.iter().find(|(_, keys)| keys.contains(&name)) {
        Some((section, _)) => anyhow!("`{section}.{name}` is {}, but must be {}", error.value, error.expected),
        None => error.into(),
    }
}

fn optics(camera: &Section<'_>) -> Result<Optics> {
    Ok(Optics {
        exposure_s: camera.number("exposure_s", Bounds::above_zero(60.0, "seconds"))?,
        lens_blur_px: camera.number("lens_blur_px", Bounds::above_zero(1000.0, "pixels, one sigma"))?,
    })
}

fn lens(section: &Section<'_>) -> Result<Camera<f64>> {
    let columns = section.required("columns", SIZE)? as u16;
    let rows = section.required("rows", SIZE)? as u16;
    let fx = focal_length_px(section)?;
    let centred = Intrinsics::centred(columns, rows, fx);
    let intrinsics = Intrinsics {
        fy: section.number("fy", FOCAL_PX)?.unwrap_or(fx),
        cx: section.number("cx", PIXELS)?.unwrap_or(centred.cx),
        cy: section.number("cy", PIXELS)?.unwrap_or(centred.cy),
        ..centred
    };
    let coefficient = Bounds::number(-1000.0, 1000.0, "coefficient of distortion");
    let coefficients = section.numbers("distortion", coefficient, "k1, k2, p1, p2, k3 (OpenCV's order)")?;
    let distortion = coefficients.map_or(Distortion::NONE, Distortion::from_opencv);
    Camera::new(intrinsics, distortion).map_err(by_its_key)
}

fn focal_length_px(section: &Section<'_>) -> Result<f64> {
    let parts = ["focal_length_mm", "pixel_pitch_um"];
    let given = parts.map(|key| section.has(key));
    let both = "`camera.fx`, or `camera.focal_length_mm` and `camera.pixel_pitch_um`";
    match (section.has("fx"), given) {
        (true, [false, false]) => section.required("fx", FOCAL_PX),
        (false, [false, false]) => Err(anyhow!("the focal length is missing: give {both}")),
        (true, _) => Err(anyhow!("the focal length is given twice: give {both}, not all")),
        (false, _) => {
            let focal_length_mm = section.required(parts[0], Bounds::above_zero(10_000.0, "mm"))?;
            let pixel_pitch_um = section.required(parts[1], Bounds::above_zero(10_000.0, "µm"))?;
            let fx = focal_length_mm / pixel_pitch_um * 1000.0;
            let asked = "`camera.focal_length_mm` / `camera.pixel_pitch_um` × 1000";
            if FOCAL_PX.contain(fx) { Ok(fx) } else { Err(anyhow!("{asked} is {fx}, but must be {FOCAL_PX}")) }
        }
    }
}

fn readout(section: &Section<'_>) -> Result<Readout> {
    const FRAME: Bounds =
        Bounds::above_zero(60.0, "seconds for the whole frame; a global shutter has no effect to measure");
    const LINE: Bounds = Bounds::above_zero(60e6, "microseconds; a global shutter has no effect to measure");
    let rows = section.required("rows", SIZE)? as u16;
    let (key, line_time_ps) = match (section.has("readout_s"), section.has("line_time_us")) {
        (true, false) => ("readout_s", section.required("readout_s", FRAME)? * 1e12 / f64::from(rows)),
        (false, true) => ("line_time_us", section.required("line_time_us", LINE)? * 1e6),
        (true, true) => return Err(anyhow!("`camera.readout_s` and `camera.line_time_us` say the same: give one")),
        (false, false) => {
            return Err(anyhow!("the readout time is missing: give `camera.readout_s` or `camera.line_time_us`"));
        }
    };
    let direction = match section.choice("direction", ["top-to-bottom", "bottom-to-top"])? {
        Some(1) => ReadoutDirection::BottomToTop,
        _ => ReadoutDirection::TopToBottom,
    };
    let readout = Readout::from_line_time_ps(rows, line_time_ps.round() as u64, direction);
    readout.map_err(|error| section.refuse(key, error.expected))
}

fn uncertainty(camera: &Section<'_>, motion: &Section<'_>, attitude: &Section<'_>) -> Result<Uncertainty<f64>> {
    let rate = Bounds::number(0.0, 1.0, "rad/s, one standard deviation");
    let degrees = |section: &Section<'_>, key, default: f64| -> Result<f64> {
        Ok(section.number(key, DEGREES)?.unwrap_or(default).to_radians())
    };
    let or_exact =
        |section: &Section<'_>, key, bounds| -> Result<f64> { Ok(section.number(key, bounds)?.unwrap_or(0.0)) };
    Ok(Uncertainty::NONE
        .with_sigma_tilt(degrees(attitude, "sigma_tilt_deg", 0.1)?)
        .with_sigma_gravity(degrees(attitude, "sigma_gravity_deg", 0.0)?)
        .with_sigma_speed(or_exact(motion, "sigma_speed", RELATIVE)?)
        .with_sigma_rate_rad_s(or_exact(motion, "sigma_rate_rad_s", rate)?)
        .with_sigma_readout(or_exact(camera, "sigma_readout", RELATIVE)?)
        .with_sigma_focal(or_exact(camera, "sigma_focal", RELATIVE)?))
}

fn twist(motion: &Section<'_>, attitude: &Section<'_>, default_velocity_m_s: Option<[f64; 3]>) -> Result<Twist<f64>> {
    let velocity = "x right, y down, z forward (m/s)";
    let velocity_m_s = motion.numbers("velocity_m_s", SPEED, velocity)?.or(default_velocity_m_s);
    let velocity_m_s =
        velocity_m_s.ok_or_else(|| motion.refuse("velocity_m_s", format_args!("3 numbers: {velocity}")))?;
    let rate_rad_s = motion.numbers("rate_rad_s", RATE, "about x, y, z (rad/s)")?.unwrap_or([0.0; 3]);
    let gravity = attitude.numbers("gravity", DIRECTION, "the direction of down in x, y, z")?;
    Twist::new(velocity_m_s, rate_rad_s, gravity.unwrap_or([0.0, 1.0, 0.0])).map_err(by_its_key)
}
