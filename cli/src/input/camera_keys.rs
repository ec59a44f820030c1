//! The section [camera] of a setup file: the lens, when its rows are read, and what its pixels do.

use anyhow::{Result, anyhow};
use shutter_range::{Camera, Distortion, Intrinsics, MotionBlur, Readout, ReadoutDirection, Response};

use super::bounds::Bounds;
use super::keys::{Section, by_its_key};
use super::usual;

const SIZE: Bounds = Bounds::whole(1.0, 32_767.0, "pixels");
pub(crate) const FOCAL_PX: Bounds = Bounds::number(1.0, 1e6, "focal length in pixels");
const PIXELS: Bounds = Bounds::finite("pixels");

/// What is known of the blur of edges.
#[derive(Clone, Copy)]
pub(crate) struct Optics {
    pub(crate) exposure_s: Option<f64>,
    /// One sigma.
    pub(crate) lens_blur_px: Option<f64>,
    /// One sigma of ln(measured / expected width).
    pub(crate) sigma_blur: Option<f64>,
}

/// Of a row.
pub(crate) const EXPOSURE: Bounds = Bounds::above_zero(60.0, "seconds");

impl Optics {
    /// Of frames with this exposure.
    pub(crate) fn motion_blur(&self, exposure_s: f64) -> MotionBlur<f64> {
        let motion_blur = match self.lens_blur_px {
            Some(lens_blur_px) => MotionBlur::from_calibrated_lens(exposure_s, lens_blur_px),
            None => MotionBlur::from_exposure(exposure_s),
        };
        self.sigma_blur.map_or(motion_blur, |sigma| motion_blur.with_sigma_blur(sigma))
    }
}

pub(crate) fn optics(camera: &Section<'_>) -> Result<Optics> {
    Ok(Optics {
        exposure_s: camera.number("exposure_s", EXPOSURE)?,
        lens_blur_px: camera.number("lens_blur_px", Bounds::above_zero(1000.0, "pixels, one sigma"))?,
        sigma_blur: camera.number("sigma_blur", Bounds::number(0.0, 10.0, "one sigma of a logarithm"))?,
    })
}

pub(crate) fn lens(camera: &Section<'_>) -> Result<Camera<f64>> {
    let columns = camera.required("columns", SIZE)? as u16;
    let rows = camera.required("rows", SIZE)? as u16;
    let fx = focal_length_px(camera)?;
    let centred = Intrinsics::centred(columns, rows, fx);
    let intrinsics = Intrinsics {
        fy: camera.number("fy", FOCAL_PX)?.unwrap_or(fx),
        cx: camera.number("cx", PIXELS)?.unwrap_or(centred.cx),
        cy: camera.number("cy", PIXELS)?.unwrap_or(centred.cy),
        ..centred
    };
    let coefficient = Bounds::number(-1000.0, 1000.0, "coefficient of distortion");
    let order = "4, 5 or 8 numbers: k1, k2, p1, p2, k3 (OpenCV's order), or k1, k2, p1, p2, k3, k4, k5, k6";
    let coefficients = camera.list("distortion", &[4, 5, 8], coefficient, order)?.unwrap_or_default();
    let distortion =
        Distortion::from_opencv_rational(std::array::from_fn(|index| coefficients.get(index).copied().unwrap_or(0.0)));
    Camera::new(intrinsics, distortion).map_err(by_its_key)
}

fn focal_length_px(camera: &Section<'_>) -> Result<f64> {
    let parts = ["focal_length_mm", "pixel_pitch_um"];
    let given = parts.map(|key| camera.has(key));
    let both = "`camera.fx`, or `camera.focal_length_mm` and `camera.pixel_pitch_um`";
    match (camera.has("fx"), given) {
        (true, [false, false]) => camera.required("fx", FOCAL_PX),
        (false, [false, false]) => Err(anyhow!("the focal length is missing: give {both}")),
        (true, _) => Err(anyhow!("the focal length is given twice: give {both}, not all")),
        (false, _) => {
            let focal_length_mm = camera.required(parts[0], Bounds::above_zero(10_000.0, "mm"))?;
            let pixel_pitch_um = camera.required(parts[1], Bounds::above_zero(10_000.0, "µm"))?;
            let fx = focal_length_mm / pixel_pitch_um * 1000.0;
            let asked = "`camera.focal_length_mm` / `camera.pixel_pitch_um` × 1000";
            if FOCAL_PX.contain(fx) { Ok(fx) } else { Err(anyhow!("{asked} is {fx}, but must be {FOCAL_PX}")) }
        }
    }
}

/// The key that the focal length comes from.
pub(crate) fn focal_length_key(camera: &Section<'_>) -> &'static str {
    if camera.has("fx") { "fx" } else { "focal_length_mm" }
}

/// The ways to give the readout time, each by its first key.
const READOUT_KEYS: [&str; 3] = ["readout_s", "line_time_us", "line_length_clocks"];

/// The key that the readout time comes from.
pub(crate) fn readout_key(camera: &Section<'_>) -> &'static str {
    READOUT_KEYS.into_iter().find(|key| camera.has(key)).unwrap_or(READOUT_KEYS[0])
}

/// All keys that the readout time comes from, with their values.
pub(crate) fn described_readout(camera: &Section<'_>) -> String {
    let keys = ["readout_s", "line_time_us", "line_length_clocks", "pixel_clock_hz", "sensor_rows_per_row"];
    let described: Vec<_> = keys.iter().filter(|key| camera.has(key)).map(|key| camera.described(key)).collect();
    described.join(" and ")
}

pub(crate) fn readout(camera: &Section<'_>) -> Result<Readout> {
    let rows = camera.required("rows", SIZE)? as u16;
    let direction = match camera.choice("direction", ["top-to-bottom", "bottom-to-top"])? {
        Some(1) => ReadoutDirection::BottomToTop,
        _ => ReadoutDirection::TopToBottom,
    };
    let line_time_s = line_time_s(camera, rows)?;
    let readout = Readout::from_line_time_ps(rows, (line_time_s * 1e12).round() as u64, direction);
    readout.map_err(|error| {
        let readout_s = line_time_s * f64::from(rows);
        anyhow!("{}, {}, but must be {}", described_readout(camera), usual::in_words(readout_s), error.expected)
    })
}

/// For a row of the image, however many rows of the sensor it is made of.
fn line_time_s(camera: &Section<'_>, rows: u16) -> Result<f64> {
    const FRAME: Bounds =
        Bounds::above_zero(60.0, "seconds for the whole frame; a global shutter has no effect to measure");
    const LINE: Bounds = Bounds::above_zero(60e6, "microseconds; a global shutter has no effect to measure");
    const CLOCKS: Bounds = Bounds::whole(1.0, 1e9, "clocks from the start of one row to that of the next");
    const CLOCK: Bounds = Bounds::above_zero(1e12, "Hz");
    const ROWS_PER_ROW: Bounds = Bounds::number(1.0, 64.0, "rows that the sensor reads for each one of the image");
    let rows_per_row = camera.number("sensor_rows_per_row", ROWS_PER_ROW)?.unwrap_or(1.0);
    let ways = "`camera.readout_s`, `camera.line_time_us`, or `camera.line_length_clocks` and `camera.pixel_clock_hz`";
    let by_clock = camera.has("line_length_clocks") || camera.has("pixel_clock_hz");
    match [camera.has("readout_s"), camera.has("line_time_us"), by_clock] {
        [true, false, false] if rows_per_row == 1.0 => Ok(camera.required("readout_s", FRAME)? / f64::from(rows)),
        [true, false, false] => {
            let expected = "1 or left out beside `camera.readout_s`, which is the time of all rows already";
            Err(camera.refuse("sensor_rows_per_row", expected))
        }
        [false, true, false] => Ok(camera.required("line_time_us", LINE)? * 1e-6 * rows_per_row),
        [false, false, true] => {
            let clocks = camera.required("line_length_clocks", CLOCKS)?;
            Ok(clocks / camera.required("pixel_clock_hz", CLOCK)? * rows_per_row)
        }
        [false, false, false] => Err(anyhow!("the readout time is missing: give {ways}")),
        _ => Err(anyhow!("the readout time is given twice: give {ways}, not several")),
    }
}

pub(crate) fn response(camera: &Section<'_>) -> Result<Response> {
    const EXPECTED: &str = "\"linear\", \"srgb\", \"gamma 2.2\" (or another number from 1 to 5) or \"unknown\"";
    match camera.text("response", EXPECTED)? {
        None | Some("unknown") => Ok(Response::Unknown),
        Some("linear") => Ok(Response::Linear),
        Some("srgb") => Ok(Response::Srgb),
        Some(other) => gamma(other).map(of_gamma).ok_or_else(|| camera.refuse("response", EXPECTED)),
    }
}

/// `gamma 2.2`
fn gamma(text: &str) -> Option<f64> {
    let number = text.strip_prefix("gamma ")?.trim().parse().ok();
    number.filter(|gamma| (1.0..=5.0).contains(gamma))
}

/// The light is the grey level to the power of gamma.
fn of_gamma(gamma: f64) -> Response {
    let light = |level: usize| ((level as f64 / 255.0).powf(gamma) * 65_280.0).round() as u16;
    // A program reads one setup: there is one table, for as long as it runs.
    Response::Table(Box::leak(Box::new(std::array::from_fn(light))))
}

/// Significant bits of pictures in a container of 16.
pub(crate) fn bits(camera: &Section<'_>) -> Result<Option<u32>> {
    const BITS: Bounds = Bounds::whole(8.0, 16.0, "significant bits of a grey level");
    Ok(camera.number("bits", BITS)?.map(|bits| bits as u32))
}
