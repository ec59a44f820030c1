//! The camera files that people have: ROS and OpenCV (one camera matrix), Kalibr, Gyroflow.

use anyhow::{Result, anyhow, bail, ensure};
use serde_json::Value;

use super::calibration::{self, Calibration, LensModel};
use super::document_tree::Node;
use super::nearest::list;
use super::size::Size;

const MATRICES: [&str; 5] = ["camera_matrix", "Camera_Matrix", "cameraMatrix", "K", "k"];
const COEFFICIENTS: [&str; 6] =
    ["distortion_coefficients", "Distortion_Coefficients", "distCoeffs", "dist_coeffs", "D", "d"];
const SIZES: [[&str; 2]; 3] = [["image_width", "image_height"], ["image_Width", "image_Height"], ["width", "height"]];

/// Names that only these files have, for someone who takes one for a setup.
pub(crate) fn is_name_of_camera_file(name: &str) -> bool {
    const FURTHER: [&str; 15] = [
        "distortion_model",
        "camera_name",
        "rectification_matrix",
        "projection_matrix",
        "camera_model",
        "intrinsics",
        "distortion_coeffs",
        "resolution",
        "line_delay",
        "line_delay_nanoseconds",
        "timeshift_cam_imu",
        "fisheye_params",
        "calib_dimension",
        "frame_readout_time",
        "cam0",
    ];
    // Width and height are what anybody may call columns and rows.
    let sizes = SIZES.iter().take(2).flatten();
    MATRICES.iter().chain(&COEFFICIENTS).chain(sizes).chain(&FURTHER).any(|known| *known == name)
}

/// `camera` says which one of several is meant.
pub(crate) fn calibration(tree: &Value, camera: Option<&str>) -> Result<Calibration> {
    let root = Node::root(tree)?;
    let cameras: Vec<&str> = root.names().filter(|name| is_kalibr_camera(name)).collect();
    if let (Some(camera), true) = (camera, cameras.is_empty()) {
        bail!("--camera-name {camera}: the file has one camera, without a name of that kind");
    }
    if !cameras.is_empty() {
        kalibr(&chosen(&root, &cameras, camera)?)
    } else if root.first_of(&["fisheye_params", "calib_dimension"]).is_some() {
        gyroflow(&root)
    } else if root.first_of(&["intrinsics"]).is_some() {
        kalibr(&root)
    } else if let Some(matrix) = root.first_of(&MATRICES) {
        camera_matrix(&root, matrix)
    } else {
        bail!(
            "no camera file: it must have `camera_matrix` (ROS camera_info, OpenCV), `cam0` (Kalibr) or `fisheye_params` \
             (Gyroflow)"
        );
    }
}

fn is_kalibr_camera(name: &str) -> bool {
    name.strip_prefix("cam").is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
}

fn chosen<'a>(root: &Node<'a>, cameras: &[&str], camera: Option<&str>) -> Result<Node<'a>> {
    let name = match (camera, cameras) {
        (None, [only]) => *only,
        (None, _) => bail!("the file has the cameras {}: say --camera-name NAME", list(cameras)),
        (Some(camera), _) => camera,
    };
    let inner = root.inner(name).filter(|_| cameras.contains(&name));
    inner.ok_or_else(|| anyhow!("--camera-name {name}: the cameras of the file are {}", list(cameras)))
}

/// ROS camera_info, as files and as messages, and OpenCV's file storage.
fn camera_matrix(root: &Node<'_>, matrix: &str) -> Result<Calibration> {
    refuse_part_of_sensor(root)?;
    let model = match root.text("distortion_model")?.unwrap_or("plumb_bob") {
        "plumb_bob" | "rational_polynomial" | "" => LensModel::BrownConrady,
        "equidistant" | "fisheye" => LensModel::Fisheye,
        _ => return Err(root.refuse("distortion_model", "plumb_bob, rational_polynomial or equidistant")),
    };
    // OpenCV's own calibration program says so.
    let is_fisheye = root.value("fisheye_model").is_some_and(|flag| flag.as_f64().is_some_and(|flag| flag != 0.0));
    let size = SIZES.iter().find(|names| root.first_of(&names[..]).is_some());
    let calibration = Calibration {
        size: size.map(|names| calibration::size(root, *names)).transpose()?.flatten(),
        intrinsics: calibration::intrinsics(root, matrix)?,
        ..Calibration::default()
    };
    let coefficients = root.first_of(&COEFFICIENTS).unwrap_or(COEFFICIENTS[0]);
    calibration.with_lens(if is_fisheye { LensModel::Fisheye } else { model }, root, coefficients)
}

/// The matrix is that of the whole sensor, but the frames are not.
fn refuse_part_of_sensor(root: &Node<'_>) -> Result<()> {
    for name in ["binning_x", "binning_y"] {
        if root.number(name)?.is_some_and(|binning| binning > 1.0) {
            return Err(root.refuse(name, "0 or 1: calibrate the frames as they are"));
        }
    }
    if let Some(window) = root.inner("roi") {
        for name in ["x_offset", "y_offset", "width", "height"] {
            if window.number(name)?.is_some_and(|side| side != 0.0) {
                return Err(window.refuse(name, "0: calibrate the frames as they are"));
            }
        }
    }
    Ok(())
}

fn kalibr(camera: &Node<'_>) -> Result<Calibration> {
    let model = camera.text("camera_model")?.unwrap_or("pinhole");
    if !matches!(model, "pinhole" | "pinhole-rs") {
        return Err(camera.refuse("camera_model", "pinhole"));
    }
    let intrinsics = camera.numbers("intrinsics")?.ok_or_else(|| camera.missing("intrinsics", "fu, fv, pu, pv"))?;
    let Ok(intrinsics) = <[f64; 4]>::try_from(intrinsics) else {
        return Err(camera.refuse("intrinsics", "4 numbers: fu, fv, pu, pv"));
    };
    let size = match camera.numbers("resolution")?.as_deref() {
        None => None,
        Some(&[columns, rows]) if columns.fract() == 0.0 && rows.fract() == 0.0 => {
            Some(Size { columns: columns as u32, rows: rows as u32 })
        }
        Some(_) => return Err(camera.refuse("resolution", "2 whole numbers of pixels: width, height")),
    };
    let readout = match (camera.number("line_delay")?, camera.number("line_delay_nanoseconds")?) {
        (Some(_), Some(_)) => bail!("the line time is given twice: `line_delay` and `line_delay_nanoseconds`"),
        (seconds, nanoseconds) => seconds.map(|seconds| seconds * 1e6).or(nanoseconds.map(|ns| ns * 1e-3)),
    };
    let readout = readout.map(|line_time_us| ("line_time_us", line_time_us));
    let calibration = Calibration { size, intrinsics, readout, ..Calibration::default() };
    match camera.text("distortion_model")?.unwrap_or("none") {
        "none" => Ok(calibration),
        "radtan" => calibration.with_lens(LensModel::BrownConrady, camera, "distortion_coeffs"),
        "equi" => calibration.with_lens(LensModel::Fisheye, camera, "distortion_coeffs"),
        _ => Err(camera.refuse("distortion_model", "radtan, equi or none")),
    }
}

fn gyroflow(profile: &Node<'_>) -> Result<Calibration> {
    refuse_warped(profile)?;
    let dimension = profile.inner("calib_dimension").ok_or_else(|| profile.missing("calib_dimension", "w and h"))?;
    let parameters = profile.inner("fisheye_params");
    let parameters = parameters.ok_or_else(|| profile.missing("fisheye_params", "the lens"))?;
    let size =
        calibration::size(&dimension, ["w", "h"])?.ok_or_else(|| dimension.missing("w", "the width, beside `h`"))?;
    let readout_ms = profile.number("frame_readout_time")?.filter(|readout_ms| *readout_ms != 0.0);
    let calibration = Calibration {
        size: Some(size),
        intrinsics: calibration::intrinsics(&parameters, "camera_matrix")?,
        readout: readout_ms.map(|readout_ms| ("readout_s", readout_ms.abs() * 1e-3)),
        is_bottom_to_top: readout_ms.is_some_and(|readout_ms| readout_ms < 0.0) != is_upwards(profile)?,
        ..Calibration::default()
    };
    let model = match profile.text("distortion_model")?.unwrap_or("opencv_fisheye") {
        "opencv_fisheye" => LensModel::Fisheye,
        "opencv_standard" => LensModel::BrownConrady,
        _ => return Err(profile.refuse("distortion_model", "opencv_fisheye or opencv_standard")),
    };
    calibration.with_lens(model, &parameters, "distortion_coeffs")
}

fn is_upwards(profile: &Node<'_>) -> Result<bool> {
    match profile.text("frame_readout_direction")? {
        None | Some("TopToBottom") => Ok(false),
        Some("BottomToTop") => Ok(true),
        _ => Err(profile
            .refuse("frame_readout_direction", "TopToBottom or BottomToTop: upright edges do not lean otherwise")),
    }
}

/// Lenses and cameras for which a camera matrix and its coefficients are not all.
fn refuse_warped(profile: &Node<'_>) -> Result<()> {
    let is_global = profile.value("global_shutter").is_some_and(|flag| flag == &Value::Bool(true));
    ensure!(!is_global, "`global_shutter` is true: a global shutter has no effect to measure");
    if profile.text("digital_lens")?.is_some_and(|lens| !lens.is_empty()) {
        return Err(profile.refuse("digital_lens", "null: such frames were warped after they were read"));
    }
    for name in ["input_horizontal_stretch", "input_vertical_stretch"] {
        if profile.number(name)?.is_some_and(|stretch| stretch != 1.0 && stretch != 0.0) {
            return Err(profile.refuse(name, "1: frames must be as the sensor read them"));
        }
    }
    Ok(())
}
