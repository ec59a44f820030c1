//! Setup files: camera, motion and attitude in TOML.

use std::path::Path;

use anyhow::{Context, Result};
use shutter_range::{Motion, Setup, Twist, Uncertainty};
use toml::Table;

use super::bounded_read::{self, Limit, MEBIBYTE};
use super::bounds::Bounds;
use super::camera_file::{self, CameraFile, CameraSource};
use super::camera_keys::{self, Optics};
use super::keys::{Section, by_its_key, refuse_unknown};
use super::mount::{Mount, axes_told};
use super::size::Size;
use super::toml_file;
use super::usual::{self, Usual};

/// Every key with its comment takes a few kilobytes.
const LIMIT: Limit<'_> = Limit { bytes: MEBIBYTE, rule: "a setup must have at most" };

pub(crate) struct SetupFile {
    /// As it was given.
    name: String,
    /// The file itself, with what a camera file adds.
    pub(crate) text: String,
    pub(crate) setup: Setup<f64>,
    /// Of the camera, in its axes.
    pub(crate) motion: Twist<f64>,
    /// Where motion and attitude were told as those of a robot.
    pub(crate) mount: Option<Mount>,
    /// Noise of edge points that come without their own.
    pub(crate) sigma_column_px: f64,
    pub(crate) optics: Optics,
    /// Significant bits of pictures in a container of 16.
    pub(crate) bits: Option<u32>,
    pub(crate) usual: Usual,
    pub(crate) gravity_source: GravitySource,
}

/// Where the direction of down comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GravitySource {
    /// The setup or the trajectory.
    Told,
    /// The frames of a sequence.
    Learned,
    /// Each frame's edges.
    Fitted,
}

impl SetupFile {
    /// The size of the camera's image.
    pub(crate) fn size(&self) -> Size {
        let image = self.setup.camera().intrinsics();
        Size { columns: image.columns.into(), rows: image.rows.into() }
    }

    /// Rows × line time.
    pub(crate) fn readout_s(&self) -> f64 {
        let readout = self.setup.readout();
        (readout.line_time_ps() * u64::from(readout.rows())) as f64 / 1e12
    }

    /// The shortest time from one frame to the next: the readout, of which rounding may take a line time.
    pub(crate) fn least_interval_s(&self) -> f64 {
        self.readout_s() * (1.0 - 1.0 / f64::from(self.setup.readout().rows()))
    }

    /// Refuses an exposure that is hardly ever meant, for frames that come at this interval, if any is known.
    pub(crate) fn check_exposure(&self, interval_s: Option<f64>) -> Result<()> {
        let Some(exposure_s) = self.optics.exposure_s else { return Ok(()) };
        self.check_exposure_of(&self.name, "camera.exposure_s", exposure_s, interval_s)
    }

    /// The same of one that is told elsewhere.
    pub(crate) fn check_exposure_of(
        &self,
        name: &str,
        key: &str,
        exposure_s: f64,
        interval_s: Option<f64>,
    ) -> Result<()> {
        let objection = usual::exposure(exposure_s, interval_s, self.readout_s());
        self.usual.check("exposure_s", objection, || format!("{name}: `{key}` is {exposure_s}"))
    }
}

/// A column that is noisier says nothing.
pub(crate) const SIGMA_PX: Bounds = Bounds::above_zero(256.0, "pixels, one standard deviation");
const RELATIVE: Bounds = Bounds::number(0.0, 1.0, "relative, one standard deviation");
const DEGREES: Bounds = Bounds::number(0.0, 45.0, "degrees, one standard deviation");
pub(crate) const SPEED: Bounds = Bounds::number(-10_000.0, 10_000.0, "m/s");
pub(crate) const RATE: Bounds = Bounds::number(-1_000.0, 1_000.0, "rad/s");
pub(crate) const DIRECTION: Bounds = Bounds::number(-1000.0, 1000.0, "only its direction counts");

/// Where the parts of a setup are.
#[derive(Clone, Copy)]
pub(crate) struct SetupSource<'a> {
    pub(crate) path: &'a Path,
    pub(crate) camera: Option<CameraSource<'a>>,
    /// A trajectory replaces the velocity, which may then be left out.
    pub(crate) has_trajectory: bool,
}

pub(crate) fn load(source: SetupSource<'_>) -> Result<SetupFile> {
    let camera = source.camera.map(camera_file::load).transpose()?;
    let text = bounded_read::read_text(source.path, &LIMIT)?;
    let default_velocity_m_s = source.has_trajectory.then_some([0.0; 3]);
    let name = source.path.display().to_string();
    parse(name.clone(), text, camera.as_ref(), default_velocity_m_s).context(name)
}

fn parse(
    name: String,
    mut text: String,
    camera: Option<&CameraFile>,
    default_velocity_m_s: Option<[f64; 3]>,
) -> Result<SetupFile> {
    let mut file: Table = toml_file::parse(&text)?;
    refuse_unknown(&file)?;
    if let Some(camera) = camera {
        camera.add_to(&mut file)?;
        text = toml::to_string(&file)?;
    }
    let camera = Section::of(&file, "camera");
    let motion = Section::of(&file, "motion");
    let attitude = Section::of(&file, "attitude");
    let mount = Mount::of(&Section::of(&file, "mount"))?;
    let optics = camera_keys::optics(&camera)?;
    let setup = Setup::new(camera_keys::lens(&camera)?, camera_keys::readout(&camera)?)?;
    let setup = setup.with_uncertainty(uncertainty(&camera, &motion, &attitude)?).map_err(by_its_key)?;
    let file = SetupFile {
        name,
        text,
        setup: with_optics(setup, &optics)?.with_response(camera_keys::response(&camera)?),
        motion: twist(&motion, &attitude, mount.as_ref(), default_velocity_m_s)?,
        mount,
        sigma_column_px: camera.number("sigma_column_px", SIGMA_PX)?.unwrap_or(0.1),
        optics,
        bits: camera_keys::bits(&camera)?,
        usual: Usual::of(&file)?,
        gravity_source: gravity_source(&attitude)?,
    };
    refuse_unusual(&file, &camera, &motion, &attitude)?;
    Ok(file)
}

/// Refuses values that are hardly ever meant.
fn refuse_unusual(file: &SetupFile, camera: &Section<'_>, motion: &Section<'_>, attitude: &Section<'_>) -> Result<()> {
    let image = file.setup.camera().intrinsics();
    let focal_key = camera_keys::focal_length_key(camera);
    let fy_key = if camera.has("fy") { "fy" } else { focal_key };
    let readout_key = camera_keys::readout_key(camera);
    let readout = || camera_keys::described_readout(camera);
    file.usual.check(readout_key, usual::readout(file.readout_s()), readout)?;
    let checks = [
        (camera, focal_key, usual::view(image.columns, image.fx, image.cx)),
        (camera, fy_key, usual::view(image.rows, image.fy, image.cy)),
        (motion, "velocity_m_s", usual::speed(file.motion.velocity_m_s())),
        (motion, "rate_rad_s", usual::rate(file.motion.rate_rad_s())),
        (attitude, "gravity", usual::gravity(file.motion.gravity(), axes_told(file.mount.as_ref()))),
    ];
    checks
        .into_iter()
        .try_for_each(|(section, key, objection)| file.usual.check(key, objection, || section.described(key)))
}

fn with_optics(setup: Setup<f64>, optics: &Optics) -> Result<Setup<f64>> {
    let Some(exposure_s) = optics.exposure_s else { return Ok(setup) };
    setup.with_motion_blur(optics.motion_blur(exposure_s)).map_err(by_its_key)
}

/// What the file leaves out is as the library assumes it.
fn uncertainty(camera: &Section<'_>, motion: &Section<'_>, attitude: &Section<'_>) -> Result<Uncertainty<f64>> {
    let rate = Bounds::number(0.0, 1.0, "rad/s, one standard deviation");
    let roughness = Bounds::number(0.0, 1.0, "pixels, one standard deviation");
    let degrees = |section: &Section<'_>, key, default: f64| -> Result<f64> {
        Ok(section.number(key, DEGREES)?.unwrap_or(default).to_radians())
    };
    let usual: Uncertainty<f64> = Uncertainty::default();
    let sigma_speed = motion.number("sigma_speed", RELATIVE)?.unwrap_or(usual.sigma_speed);
    let sigma_rate_rad_s = motion.number("sigma_rate_rad_s", rate)?.unwrap_or(usual.sigma_rate_rad_s);
    let sigma_readout = camera.number("sigma_readout", RELATIVE)?.unwrap_or(usual.sigma_readout);
    let sigma_focal = camera.number("sigma_focal", RELATIVE)?.unwrap_or(usual.sigma_focal);
    let edge_roughness_px = camera.number("edge_roughness_px", roughness)?.unwrap_or(usual.edge_roughness_px);
    let seconds = Bounds::number(0.0, 1.0, "seconds, one standard deviation");
    let sigma_time_s = motion.number("sigma_time_s", seconds)?.unwrap_or(0.0);
    Ok(usual
        .with_sigma_tilt(degrees(attitude, "sigma_tilt_deg", 0.1)?)
        .with_sigma_gravity(degrees(attitude, "sigma_gravity_deg", 0.0)?)
        .with_sigma_speed(sigma_speed)
        .with_sigma_rate_rad_s(sigma_rate_rad_s)
        .with_sigma_readout(sigma_readout)
        .with_sigma_focal(sigma_focal)
        .with_edge_roughness_px(edge_roughness_px)
        .with_sigma_time_s(sigma_time_s))
}

const GRAVITY: &str = "the direction of down in x, y, z; or \"learn\" or \"fit\"";

fn gravity_source(attitude: &Section<'_>) -> Result<GravitySource> {
    let source = match attitude.text("gravity", GRAVITY).ok().flatten() {
        None => return Ok(GravitySource::Told),
        Some("learn") => GravitySource::Learned,
        Some("fit") => GravitySource::Fitted,
        Some(_) => return Err(attitude.refuse("gravity", format_args!("3 numbers: {GRAVITY}"))),
    };
    if attitude.has("sigma_gravity_deg") {
        let needed = "left out where `gravity` is \"learn\" or \"fit\": it is estimated with it";
        return Err(attitude.refuse("sigma_gravity_deg", needed));
    }
    Ok(source)
}

/// In the axes of the camera.
fn twist(
    motion: &Section<'_>,
    attitude: &Section<'_>,
    mount: Option<&Mount>,
    default_velocity_m_s: Option<[f64; 3]>,
) -> Result<Twist<f64>> {
    let velocity = format!("{} (m/s)", axes_told(mount));
    let down = if mount.is_some() { [0.0, 0.0, -1.0] } else { [0.0, 1.0, 0.0] };
    let velocity_m_s = motion.numbers("velocity_m_s", SPEED, &velocity)?.or(default_velocity_m_s);
    let velocity_m_s =
        velocity_m_s.ok_or_else(|| motion.refuse("velocity_m_s", format_args!("3 numbers: {velocity}")))?;
    let rate_rad_s = motion.numbers("rate_rad_s", RATE, "about x, y, z (rad/s)")?.unwrap_or([0.0; 3]);
    let is_told = gravity_source(attitude)? == GravitySource::Told;
    let gravity = if is_told { attitude.numbers("gravity", DIRECTION, GRAVITY)? } else { None };
    let gravity = gravity.unwrap_or(down);
    let twist = match mount {
        Some(mount) => Twist::new(
            mount.velocity_in_camera(velocity_m_s, rate_rad_s),
            mount.in_camera(rate_rad_s),
            mount.in_camera(gravity),
        ),
        None => Twist::new(velocity_m_s, rate_rad_s, gravity),
    };
    twist.map_err(|error| match error.parameter {
        // The error has its length alone.
        "gravity" => attitude.refuse("gravity", error.expected),
        _ => by_its_key(error),
    })
}
