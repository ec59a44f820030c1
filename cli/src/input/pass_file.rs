//! Passes from CSV: an upright edge seen at known distance and speed, one look on each line.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use shutter_range::calibrate::Pass;
use shutter_range::rse::Shear;

use super::bounded_read::{self, Limit, MEBIBYTE};
use super::bounds::Bounds;
use super::table_file::{Columns, Record, TableFile};
use super::usual::READOUT_S;

/// Nobody drives past an edge a million times.
const LIMIT: Limit<'_> = Limit { bytes: MEBIBYTE, rule: "a file of passes must have at most" };

const COLUMNS: Columns = Columns {
    known: &[
        "speed_m_s",
        "distance_m",
        "slope",
        "angle_deg",
        "frame",
        "readout_s",
        "bearing",
        "heading_deg",
        "sigma_deg",
        "sigma_relative",
    ],
    required: &["speed_m_s", "distance_m"],
};
/// Each says how the edge slopes.
const SLOPES: [&str; 3] = ["slope", "angle_deg", "frame"];

const SPEED: Bounds = Bounds::number(-10_000.0, 10_000.0, "m/s, positive where the camera moves to the left");
const DISTANCE: Bounds = Bounds::above_zero(10_000.0, "metres");
const SLOPE: Bounds = Bounds::number(-100.0, 100.0, "pixels per row");
const ANGLE: Bounds = Bounds::number(-89.0, 89.0, "degrees off the column");
/// What a setup takes without more ado: another one may be left out, since the scale alone is told without it.
pub(crate) const READOUT: Bounds = Bounds::number(READOUT_S.0, READOUT_S.1, "seconds for the whole frame");
const BEARING: Bounds = Bounds::number(-100.0, 100.0, "x/z of the edge");
const HEADING: Bounds = Bounds::number(-360.0, 360.0, "degrees from the image plane");
const LEAN: Bounds = Bounds::above_zero(45.0, "degrees, one standard deviation");
const RELATIVE: Bounds = Bounds::number(0.0, 1.0, "relative, one standard deviation");

/// One line of the file.
pub(crate) struct FilePass {
    /// Its number, from 1.
    pub(crate) at: usize,
    pub(crate) speed_m_s: f64,
    pub(crate) distance_m: f64,
    pub(crate) slope: Slope,
    pub(crate) readout_s: Option<f64>,
    bearing: f64,
    heading_deg: f64,
    sigma_deg: Option<f64>,
    sigma_relative: Option<f64>,
}

pub(crate) enum Slope {
    /// In pixels per row.
    Known(f64),
    /// That of the longest edge of a picture.
    InPicture(PathBuf),
}

pub(crate) fn load(path: &Path) -> Result<Vec<FilePass>> {
    let text = bounded_read::read_text(path, &LIMIT)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    parse(&text, folder).with_context(|| path.display().to_string())
}

fn parse(text: &str, folder: &Path) -> Result<Vec<FilePass>> {
    let table = TableFile::parse(text, &COLUMNS)?;
    let given: Vec<_> = SLOPES.into_iter().filter(|name| table.has(name)).collect();
    let [slope] = given[..] else {
        bail!("the header must name one of `slope`, `angle_deg` and `frame`, but names {}", given.len());
    };
    let passes: Vec<FilePass> = table.records().map(|record| pass(&record?, slope, folder)).collect::<Result<_>>()?;
    let with_readout = passes.iter().filter(|pass| pass.readout_s.is_some()).count();
    if with_readout != 0 && with_readout != passes.len() {
        bail!("`readout_s` is empty on some lines, but must be given on all of them or on none");
    }
    Ok(passes)
}

fn pass(record: &Record<'_>, slope: &str, folder: &Path) -> Result<FilePass> {
    let slope = match slope {
        "slope" => Slope::Known(record.required("slope", SLOPE)?),
        "angle_deg" => Slope::Known(record.required("angle_deg", ANGLE)?.to_radians().tan()),
        _ => match record.cell("frame") {
            Some(name) => Slope::InPicture(folder.join(name)),
            None => return Err(record.refuse("frame", "the name of a picture, as seen from the folder of this file")),
        },
    };
    Ok(FilePass {
        at: record.at,
        speed_m_s: record.required("speed_m_s", SPEED)?,
        distance_m: record.required("distance_m", DISTANCE)?,
        slope,
        readout_s: record.number("readout_s", READOUT)?,
        bearing: record.number("bearing", BEARING)?.unwrap_or(0.0),
        heading_deg: record.number("heading_deg", HEADING)?.unwrap_or(0.0),
        sigma_deg: record.number("sigma_deg", LEAN)?,
        sigma_relative: record.number("sigma_relative", RELATIVE)?,
    })
}

/// The edge leans by so much unless the file says otherwise, one standard deviation.
const USUAL_LEAN_DEG: f64 = 0.1;

impl FilePass {
    /// With the slope that was found.
    pub(crate) fn pass(&self, slope: f64) -> Result<Pass<f64>> {
        let heading_rad = self.heading_deg.to_radians();
        let pass = Pass::oblique(slope, self.speed_m_s, self.distance_m, self.bearing, heading_rad);
        let sigma_slope = self.sigma_deg.unwrap_or(USUAL_LEAN_DEG).to_radians().tan();
        let pass = pass.and_then(|pass| pass.with_sigmas(sigma_slope, self.sigma_relative.unwrap_or(0.0)));
        let pass =
            pass.and_then(|pass| self.readout_s.map_or(Ok(pass), |readout_s| pass.with_frame_readout_s(readout_s)));
        pass.with_context(|| format!("line {}", self.at))
    }

    /// The slope that the pass would have for a scale of one; `None` for one that is refused.
    pub(crate) fn per_scale(&self) -> Option<f64> {
        let shear = Shear::oblique(1.0, self.bearing, self.heading_deg.to_radians());
        let slope = shear.slope(self.distance_m, self.speed_m_s, self.readout_s.unwrap_or(1.0));
        slope.is_finite().then_some(slope)
    }
}
