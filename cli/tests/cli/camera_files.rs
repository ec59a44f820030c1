//! `--camera`: cameras that other programs have calibrated.

use toml::{Table, Value};

use crate::tool::{Folder, SETUP, assert_near};

const ROS: &str = "\
image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [438.78, 0.0, 305.59, 0.0, 437.35, 243.74, 0.0, 0.0, 1.0]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.361976, 0.110510, 0.001014, 0.000505, 0.000000]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [393.6, 0, 322.8, 0, 0, 393.6, 241.1, 0, 0, 0, 1, 0]
";

const OPENCV: &str = "\
%YAML:1.0
---
calibration_time: \"Sat 28 Nov 2026\"
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 438.78, 0., 305.59, 0., 437.35,
       243.74, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -3.61976e-01, 1.10510e-01, 1.014e-03, 5.05e-04, 0. ]
avg_reprojection_error: .Nan
";

const OPENCV_XML: &str = "\
<?xml version=\"1.0\"?>
<opencv_storage>
<image_width>640</image_width>
<image_height>480</image_height>
<camera_matrix type_id=\"opencv-matrix\">
  <rows>3</rows><cols>3</cols><dt>d</dt>
  <data>438.78 0. 305.59 0. 437.35
    243.74 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id=\"opencv-matrix\">
  <rows>5</rows><cols>1</cols><dt>d</dt>
  <data>-3.61976e-01 1.10510e-01 1.014e-03 5.05e-04 0.</data></distortion_coefficients>
</opencv_storage>
";

const KALIBR: &str = "\
cam0:
  camera_model: pinhole
  distortion_coeffs: [-0.361976, 0.110510, 0.001014, 0.000505]
  distortion_model: radtan
  intrinsics: [438.78, 437.35, 305.59, 243.74]
  line_delay: 6.9375e-05
  resolution: [640, 480]
  rostopic: /cam0/image_raw
";

const GYROFLOW: &str = r#"{
  "name": "Some_Camera_1080p", "calibrator_version": "1.5.4", "camera_brand": "Some",
  "calib_dimension": { "w": 640, "h": 480 }, "orig_dimension": { "w": 640, "h": 480 },
  "frame_readout_time": -33.3, "input_horizontal_stretch": 1.0, "digital_lens": null,
  "distortion_model": "opencv_standard",
  "fisheye_params": {
    "RMS_error": 0.4,
    "camera_matrix": [[438.78, 0.0, 305.59], [0.0, 437.35, 243.74], [0.0, 0.0, 1.0]],
    "distortion_coeffs": [-0.361976, 0.110510, 0.001014, 0.000505]
  }
}"#;

/// The [camera] that `setup --camera` prints for the file.
fn camera(file: &str) -> Table {
    let outcome = Folder::new().with("cam", file).run(&["setup", "--camera", "cam"]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    let setup: Table = outcome.stdout.parse().expect("TOML");
    setup["camera"].as_table().expect("a section").clone()
}

fn numbers(value: &Value) -> Vec<f64> {
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|whole| whole as f64)).expect("a number");
    value.as_array().map_or_else(|| vec![number(value)], |list| list.iter().map(number).collect())
}

#[track_caller]
fn assert_keys(camera: &Table, keys: &[(&str, &[f64])]) {
    for (key, expected) in keys {
        assert_eq!(numbers(camera.get(*key).unwrap_or_else(|| panic!("no {key}"))), *expected, "{key}");
    }
}

const LENS: [(&str, &[f64]); 7] = [
    ("columns", &[640.0]),
    ("rows", &[480.0]),
    ("fx", &[438.78]),
    ("fy", &[437.35]),
    ("cx", &[305.59]),
    ("cy", &[243.74]),
    ("distortion", &[-0.361976, 0.110510, 0.001014, 0.000505, 0.0]),
];

#[test]
fn every_format_tells_the_same_lens() {
    let opencv5 = OPENCV.replace("%YAML:1.0", "%YAML 1.2");
    for file in [ROS, OPENCV, &opencv5, OPENCV_XML, KALIBR, GYROFLOW] {
        assert_keys(&camera(file), &LENS);
    }
}

#[test]
fn the_readout_is_that_of_the_file() {
    let kalibr = camera(KALIBR);
    assert_near(numbers(&kalibr["line_time_us"])[0], 69.375, 1e-9);
    assert!(!kalibr.contains_key("readout_s"), "given once");
    let nanoseconds = camera(&KALIBR.replace("line_delay: 6.9375e-05", "line_delay_nanoseconds: 69375"));
    assert_near(numbers(&nanoseconds["line_time_us"])[0], 69.375, 1e-9);
    // The sign of Gyroflow's readout is its direction.
    let upwards = camera(GYROFLOW);
    assert_near(numbers(&upwards["readout_s"])[0], 0.0333, 1e-12);
    assert_eq!(upwards["direction"].as_str(), Some("bottom-to-top"));
    assert!(!camera(&GYROFLOW.replace("-33.3", "33.3")).contains_key("direction"));
    let other_way = GYROFLOW.replace("-33.3", "33.3, \"frame_readout_direction\": \"BottomToTop\"");
    assert_eq!(camera(&other_way)["direction"].as_str(), Some("bottom-to-top"));
}

#[test]
fn messages_of_ros_and_rational_lenses() {
    let message = "\
header:
  frame_id: camera
height: 480
width: 640
distortion_model: rational_polynomial
d: [0.452, -0.2, 0.0006, -0.0002, 0.1, 0.8, -0.1, 0.05]
k: [438.78, 0.0, 305.59, 0.0, 437.35, 243.74, 0.0, 0.0, 1.0]
binning_x: 0
roi: {x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false}
---
";
    let rational = &[0.452, -0.2, 0.0006, -0.0002, 0.1, 0.8, -0.1, 0.05][..];
    assert_keys(&camera(message), &[("fx", &[438.78]), ("rows", &[480.0]), ("distortion", rational)]);
    refuse(&message.replace("binning_x: 0", "binning_x: 2"), "`binning_x` is 2, but must be 0 or 1");
    refuse(&message.replace("x_offset: 0", "x_offset: 100"), "`roi.x_offset` is 100, but must be 0");
    // Thin prisms and tilts only where they are zero.
    let many = message.replace("0.05]", "0.05, 0, 0, 0, 0]");
    assert_keys(&camera(&many), &[("distortion", rational)]);
    refuse(&many.replace("0, 0, 0, 0]", "0, 0.01, 0, 0]"), "`d` has a coefficient of thin prism or tilt, 0.01");
}

/// Where a fisheye lens records what the angle θ off its axis is: by its own model and by the rational one.
#[test]
fn fisheye_lenses_become_rational_ones() {
    for k in [[0.0; 4], [0.02, -0.01, 0.004, -0.0008], [-0.03, 0.01, -0.006, 0.001]] {
        let file =
            KALIBR.replace("radtan", "equi").replace("-0.361976, 0.110510, 0.001014, 0.000505", &format!("{k:?}")[1..]);
        let file = file.replace("]]", "]");
        let camera = camera(&file);
        let [k1, k2, p1, p2, k3, k4, k5, k6] = numbers(&camera["distortion"])[..] else { panic!("{camera}") };
        assert_eq!([p1, p2], [0.0; 2]);
        for degrees in 0..=42 {
            let angle = f64::from(degrees).to_radians();
            let (a2, r) = (angle * angle, angle.tan());
            let recorded = angle * (1.0 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3]))));
            let r2 = r * r;
            let cubic = |a: f64, b: f64, c: f64| 1.0 + r2 * (a + r2 * (b + r2 * c));
            let rational = r * cubic(k1, k2, k3) / cubic(k4, k5, k6);
            assert_near(438.78 * rational, 438.78 * recorded, 0.005);
        }
    }
    // A wide one looks farther to the side than the model carries, and says so.
    let wide = KALIBR.replace("radtan", "equi").replace("438.78, 437.35", "238.78, 237.35");
    refuse(&wide, "a fisheye lens whose corners look farther than 60° off the axis");
    let flag = OPENCV.replace("avg_reproj", "fisheye_model: 1\navg_reproj");
    refuse(&flag, "`distortion_coefficients` has 5 coefficients, but must have 4: a fisheye lens");
}

/// Frames of the camera are ranged as by a setup with the same numbers, and what is missing is asked for.
#[test]
fn a_camera_completes_a_setup() {
    let points: String =
        (0..480).step_by(8).map(|row| format!("{row},{:.4}\n", 300.0 + 0.02 * f64::from(row))).collect();
    let motion = "[motion]\nvelocity_m_s = [-1.5, 0, 0]\n";
    let whole = format!(
        "[camera]\ncolumns = 640\nrows = 480\nfx = 438.78\nfy = 437.35\ncx = 305.59\ncy = 243.74\nline_time_us = 69.375\n\
         distortion = [-0.361976, 0.110510, 0.001014, 0.000505]\n{motion}"
    );
    let folder = Folder::of(motion, &format!("row,column\n{points}")).with("cam.yaml", KALIBR).with("ros.yaml", ROS);
    let folder =
        folder.with("whole.toml", whole).with("late.toml", format!("[camera]\nline_time_us = 69.375\n{motion}"));
    let edges = |rest: &[&str]| folder.run(&[&["edges", "edges.csv", "--json"], rest].concat());
    let expected = edges(&["--setup", "whole.toml"]).json();
    assert_eq!(expected["frames"][0]["ranges"].as_array().map(Vec::len), Some(1));
    assert_eq!(edges(&["--setup", "setup.toml", "--camera", "cam.yaml"]).json(), expected);
    assert_eq!(edges(&["--setup", "late.toml", "--camera", "ros.yaml"]).json(), expected);
    let without = edges(&["--setup", "setup.toml", "--camera", "ros.yaml"]);
    assert_eq!(without.code, 1);
    assert!(without.stderr.contains("the readout time is missing: give `camera.readout_s`"), "{}", without.stderr);
    let folder = Folder::of(SETUP, "row,column\n1,2\n").with("cam.yaml", KALIBR);
    let twice = folder.run(&["edges", "edges.csv", "--setup", "setup.toml", "--camera", "cam.yaml"]);
    let message = "error: setup.toml: `camera.fx` is 600, but cam.yaml has fx = 438.78: leave one of them out\n";
    assert_eq!((twice.code, twice.stderr.as_str()), (1, message));
}

#[test]
fn one_of_several_cameras() {
    let two = format!("{KALIBR}{}", KALIBR.replace("cam0", "cam1").replace("438.78", "500.5"));
    refuse(&two, "the file has the cameras `cam0` and `cam1`: say --camera-name NAME");
    let folder = Folder::new().with("cam", two);
    let outcome = folder.run(&["setup", "--camera", "cam", "--camera-name", "cam1"]);
    assert!(outcome.code == 0 && outcome.stdout.contains("\nfx = 500.5\n"), "{}", outcome.stderr);
    let outcome = folder.run(&["setup", "--camera", "cam", "--camera-name", "cam2"]);
    assert_eq!(outcome.code, 1);
    assert!(
        outcome.stderr.contains("--camera-name cam2: the cameras of the file are `cam0` and `cam1`"),
        "{}",
        outcome.stderr
    );
    assert_eq!(folder.run(&["setup", "--camera-name", "cam2"]).code, 2);
}

#[track_caller]
fn refuse(file: &str, message: &str) {
    let outcome = Folder::new().with("cam", file).run(&["setup", "--camera", "cam"]);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""));
    assert!(outcome.stderr.starts_with("error: cam: ") && outcome.stderr.contains(message), "{}", outcome.stderr);
}

#[test]
fn camera_files_that_are_refused() {
    refuse("", "the file is empty");
    refuse("just: this\n", "no camera file: it must have `camera_matrix` (ROS camera_info, OpenCV), `cam0` (Kalibr)");
    refuse("[1, 2]\n", "the file must have names with values");
    refuse(
        &OPENCV.replace("%YAML:1.0", "%YAML:3.0"),
        "the file begins with `%YAML:3.0`, but must with one of `%YAML:1.0`",
    );
    refuse(&OPENCV.replace("438.78, 0.", ".Nan, 0."), "`camera_matrix.data[0]` is");
    refuse(&OPENCV.replace("243.74, 0., 0., 1.", "243.74, 0., 0."), "has 8 numbers, but must have 3 × 3");
    refuse(&OPENCV.replace("438.78, 0.", "438.78, 2."), "`camera_matrix` has a skew of 2, but it must be 0");
    refuse(&OPENCV.replace("   cols: 3", "   cols"), "no sound YAML");
    refuse(
        &OPENCV_XML.replace("opencv_storage", "storage"),
        "the root of the XML is <storage>, but must be <opencv_storage>",
    );
    refuse(&OPENCV_XML[..300], "no sound XML");
    refuse(&ROS.replace("plumb_bob", "thin_lens"), "`distortion_model` is \"thin_lens\", but must be plumb_bob");
    refuse(
        &ROS.replace("image_width: 640", "image_width: 640.5"),
        "`image_width` is 640.5, but must be a whole number",
    );
    refuse(&KALIBR.replace("pinhole", "omni"), "`cam0.camera_model` is \"omni\", but must be pinhole");
    refuse(&KALIBR.replace("radtan", "fov"), "`cam0.distortion_model` is \"fov\", but must be radtan, equi or none");
    refuse(
        &KALIBR.replace("305.59, 243.74", "305.59"),
        "`cam0.intrinsics` is [438.78,437.35,305.59], but must be 4 numbers",
    );
    refuse(&GYROFLOW.replace("opencv_standard", "sony"), "`distortion_model` is \"sony\", but must be opencv_fisheye");
    let zoomed = GYROFLOW.replace("\"digital_lens\": null", "\"digital_lens\": \"gopro_superview\"");
    refuse(&zoomed, "`digital_lens` is \"gopro_superview\"");
    refuse(&GYROFLOW.replace("\"frame_readout_time\"", "\"global_shutter\": true, \"x\""), "`global_shutter` is true");
    refuse(&GYROFLOW[..200], "no sound JSON");
    let outcome = Folder::new().run(&["setup", "--camera", "missing.yaml"]);
    assert!(outcome.code == 1 && outcome.stderr.starts_with("error: reading missing.yaml: "), "{}", outcome.stderr);
}

/// Someone gives such a file as a setup, or copies its names into one.
#[test]
fn setups_of_another_kind_are_recognised() {
    let setup_of =
        |text: &[u8]| Folder::new().with("setup.toml", text).with("edges.csv", "row,column\n1,2\n").edges().stderr;
    for (file, kind) in [(ROS, "YAML"), (OPENCV, "YAML"), (KALIBR, "YAML"), (GYROFLOW, "JSON"), (OPENCV_XML, "XML")] {
        let message = format!("error: setup.toml: the file is {kind}, but must be TOML");
        assert!(setup_of(file.as_bytes()).starts_with(&message), "{}", setup_of(file.as_bytes()));
    }
    let wide: Vec<u8> = [0xFF, 0xFE].into_iter().chain(SETUP.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    assert!(setup_of(&wide).contains("the file is UTF-16 text, but must be UTF-8"), "{}", setup_of(&wide));
    for (key, place) in [("image_width", "key `camera.image_width`"), ("line_delay", "key `camera.line_delay`")] {
        let message = setup_of(SETUP.replace("fx =", &format!("{key} = 1\nfx =")).as_bytes());
        let pointer =
            "it is a name of camera files of ROS, OpenCV, Kalibr or Gyroflow; give such a file by --camera FILE";
        assert_eq!(message, format!("error: setup.toml: unknown {place}: {pointer}\n"));
    }
    assert!(setup_of(b"[cam0]\nx = 1\n").contains("unknown section [cam0]: it is a name of camera files"));
    assert!(setup_of(b"camera_matrix = [1]\n").contains("unknown key `camera_matrix`: it is a name"));
    // What is TOML, if a faulty one, is not taken for anything else.
    assert!(setup_of(b"[camera]\ncolumns == 640\n").starts_with("error: setup.toml: line 2: "));
}
