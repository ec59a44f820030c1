//! Wrong input: exit codes and messages that name what is wrong and what would be right.

use crate::tool::{Folder, SETUP};

const POINTS: &str = "row,column\n1,2\n";

#[track_caller]
fn assert_fails(folder: &Folder, message: &str) {
    let outcome = folder.edges();
    assert_eq!(outcome.code, 1, "{}", outcome.stderr);
    assert_eq!(outcome.stdout, "");
    assert_eq!(outcome.stderr, format!("error: {message}\n"));
}

/// The setup with one text replaced by another.
#[track_caller]
fn refuse_setup(old: &str, new: &str, message: &str) {
    assert!(SETUP.contains(old), "{old}");
    assert_fails(&Folder::of(&SETUP.replace(old, new), POINTS), &format!("setup.toml: {message}"));
}

#[track_caller]
fn refuse_edges(edges: &str, message: &str) {
    assert_fails(&Folder::of(SETUP, edges), &format!("edges.csv: {message}"));
}

#[test]
fn usage_is_exit_code_2() {
    let folder = Folder::of(SETUP, POINTS);
    for arguments in [&["edges"][..], &["edges", "edges.csv"], &[], &["table3"], &["table2", "--yaml"]] {
        assert_eq!(folder.run(arguments).code, 2, "{arguments:?}");
    }
    for arguments in [&["--help"][..], &["edges", "--help"], &["--version"]] {
        assert_eq!(folder.run(arguments).code, 0, "{arguments:?}");
    }
    assert!(folder.run(&["--help"]).stdout.contains("Examples:"));
}

/// Not taken for an option that does not exist.
#[test]
fn negative_values_are_refused_by_the_name_of_their_option() {
    let folder = Folder::new();
    let frame = ["frame", "a.png", "--setup", "setup.toml"];
    let simulate = ["simulate", "--setup", "setup.toml", "--out", "out"];
    let flicker = ["calibrate", "flicker", "a.png"];
    let scale = ["calibrate", "scale", "passes.csv"];
    let imu = ["calibrate", "imu", "a.png", "--setup", "setup.toml"];
    for (command, options) in [
        (&frame[..], &["--jobs", "--frame-interval-s"][..]),
        (&["edges", "edges.csv", "--setup", "setup.toml"], &["--frame-interval-s"]),
        (&simulate, &["--frames", "--seed", "--frame-interval-s", "--swing-deg", "--swing-hz", "--clock-offset-s"]),
        (&["setup", "--sensor", "ov7725-qvga"], &["--clock-mhz"]),
        (&flicker, &["--frequency-hz", "--sigma-hz", "--exposure-s", "--frame-rate-hz"]),
        (&scale, &["--focal-px", "--readout-s", "--rows", "--sigma-roll-deg"]),
        (&imu, &["--frame-interval-s"]),
        (&["plan", "--setup", "setup.toml"], &["--from", "--to", "--steps", "--sigma", "--read-noise", "--height-m"]),
    ] {
        for option in options {
            let outcome = folder.run(&[command, &[option, "-3"]].concat());
            let told = outcome.stderr.contains(&format!("'-3' for '{option} <"));
            assert!(outcome.code == 2 && told, "{command:?} {option}: {}", outcome.stderr);
        }
    }
}

#[test]
fn missing_files() {
    let outcome = Folder::new().with("setup.toml", SETUP).edges();
    assert!(outcome.code == 1 && outcome.stderr.starts_with("error: reading edges.csv: "), "{}", outcome.stderr);
    let outcome = Folder::new().with("edges.csv", POINTS).edges();
    assert!(outcome.code == 1 && outcome.stderr.starts_with("error: reading setup.toml: "), "{}", outcome.stderr);
    let outcome = Folder::new().with("setup.toml", SETUP).with("edges.csv", [0xff, 0xfe]).edges();
    assert!(outcome.code == 1 && outcome.stderr.contains("UTF-8"), "{}", outcome.stderr);
}

#[test]
fn unknown_keys_of_a_setup() {
    refuse_setup(
        "fx = 600",
        "fx = 600\nreadout = 0.02",
        "unknown key `camera.readout`; the nearest is `camera.readout_s`",
    );
    refuse_setup("columns", "colums", "unknown key `camera.colums`; the nearest is `camera.columns`");
    refuse_setup("velocity_m_s", "velocity", "unknown key `motion.velocity`; the nearest is `motion.velocity_m_s`");
    refuse_setup(
        "fx = 600",
        "fx = 600\ngravity = [0, 1, 0]",
        "unknown key `camera.gravity`; the nearest is `attitude.gravity`",
    );
    refuse_setup("[attitude]", "[atitude]", "unknown section [atitude]; the nearest is [attitude]");
    refuse_setup(
        "[camera]",
        "exposure_ms = 1\n[camera]",
        "unknown key `exposure_ms` outside the sections; the nearest is `camera.exposure_s`",
    );
}

#[test]
fn keys_that_are_like_none_are_refused_with_the_list() {
    let attitude = "the keys of [attitude] are `gravity`, `sigma_tilt_deg` and `sigma_gravity_deg`";
    for key in ["tip", "down", "x", "тангаж"] {
        let setup = SETUP.replace("[attitude]", &format!("[attitude]\n\"{key}\" = 1"));
        let message = format!("setup.toml: unknown key `attitude.{key}`; {attitude}");
        assert_fails(&Folder::of(&setup, POINTS), &message);
    }
    let sections = "the sections are [camera], [motion], [attitude], [mount]";
    refuse_setup("[attitude]", "[lens]", &format!("unknown section [lens]; {sections}"));
    refuse_setup("[camera]", "gain = 1\n[camera]", &format!("unknown key `gain` outside the sections; {sections}"));
    let camera = SETUP.replace("fx = 600", "fx = 600\nvendor = \"x\"");
    let outcome = Folder::of(&camera, POINTS).edges();
    assert!(outcome.stderr.contains("unknown key `camera.vendor`; the keys of [camera] are `columns`, `rows`, "));
    assert!(outcome.stderr.contains(" and `sigma_focal`\n"), "{}", outcome.stderr);
}

#[test]
fn values_of_a_setup() {
    refuse_setup(
        "fx = 600",
        "fx = -1",
        "`camera.fx` is -1, but must be a number from 1 to 1000000 (focal length in pixels)",
    );
    refuse_setup(
        "fx = 600",
        "fx = \"wide\"",
        "`camera.fx` is \"wide\", but must be a number from 1 to 1000000 (focal length in pixels)",
    );
    refuse_setup(
        "fx = 600",
        "fx = nan",
        "`camera.fx` is nan, but must be a number from 1 to 1000000 (focal length in pixels)",
    );
    refuse_setup("fx = 600", "fx = 600\ncy = inf", "`camera.cy` is inf, but must be a finite number (pixels)");
    refuse_setup(
        "fx = 600",
        "fx = 600\ncx = -700.0",
        "`camera.cx` is -700, but must be at most one image size outside the image (pixels)",
    );
    refuse_setup("rows = 480", "rows = 0", "`camera.rows` is 0, but must be a whole number from 1 to 32767 (pixels)");
    refuse_setup("rows = 480", "", "`camera.rows` is missing: it must be a whole number from 1 to 32767 (pixels)");
    refuse_setup(
        "columns = 640",
        "columns = 640.5",
        "`camera.columns` is 640.5, but must be a whole number from 1 to 32767 (pixels)",
    );
    refuse_setup(
        "fx = 600",
        "fx = 600\ndirection = \"down\"",
        "`camera.direction` is \"down\", but must be \"top-to-bottom\" or \"bottom-to-top\"",
    );
    refuse_setup(
        "fx = 600",
        "fx = 600\nexposure_s = 0",
        "`camera.exposure_s` is 0, but must be a number above 0, at most 60 (seconds)",
    );
    refuse_setup(
        "fx = 600",
        "fx = 600\nlens_blur_px = -0.7",
        "`camera.lens_blur_px` is -0.7, but must be a number above 0, at most 1000 (pixels, one sigma)",
    );
    refuse_setup(
        "fx = 600",
        "fx = 600\nsigma_column_px = 0.0",
        "`camera.sigma_column_px` is 0.0, but must be a number above 0, at most 256 (pixels, one standard deviation)",
    );
    refuse_setup(
        "sigma_tilt_deg = 0",
        "sigma_tilt_deg = -0.1",
        "`attitude.sigma_tilt_deg` is -0.1, but must be a number from 0 to 45 (degrees, one standard deviation)",
    );
    refuse_setup(
        "sigma_speed = 0",
        "sigma_speed = nan",
        "`motion.sigma_speed` is nan, but must be a number from 0 to 1 (relative, one standard deviation)",
    );
}

#[test]
fn values_of_keys_about_pixels_are_checked() {
    let response = "\"linear\", \"srgb\", \"gamma 2.2\" (or another number from 1 to 5) or \"unknown\"";
    for value in ["\"log\"", "\"gamma\"", "\"gamma 0.45\"", "\"gamma nan\"", "2.2"] {
        let message = format!("`camera.response` is {value}, but must be {response}");
        refuse_setup("fx = 600", &format!("fx = 600\nresponse = {value}"), &message);
    }
    refuse_setup(
        "fx = 600",
        "fx = 600\nbits = 24",
        "`camera.bits` is 24, but must be a whole number from 8 to 16 (significant bits of a grey level)",
    );
    refuse_setup(
        "fx = 600",
        "fx = 600\nsigma_blur = -1",
        "`camera.sigma_blur` is -1, but must be a number from 0 to 10 (one sigma of a logarithm)",
    );
    refuse_setup(
        "edge_roughness_px = 0",
        "edge_roughness_px = 2",
        "`camera.edge_roughness_px` is 2, but must be a number from 0 to 1 (pixels, one standard deviation)",
    );
}

#[test]
fn focal_length_once() {
    let choice = "`camera.fx`, or `camera.focal_length_mm` and `camera.pixel_pitch_um`";
    refuse_setup("fx = 600", "", &format!("the focal length is missing: give {choice}"));
    refuse_setup(
        "fx = 600",
        "fx = 600\npixel_pitch_um = 3",
        &format!("the focal length is given twice: give {choice}, not all"),
    );
    refuse_setup(
        "fx = 600",
        "focal_length_mm = 3",
        "`camera.pixel_pitch_um` is missing: it must be a number above 0, at most 10000 (µm)",
    );
    let metres = "`camera.focal_length_mm` / `camera.pixel_pitch_um` × 1000 is 0.6, but must be a number from 1 to 1000000 \
                  (focal length in pixels)";
    refuse_setup("fx = 600", "focal_length_mm = 0.0018\npixel_pitch_um = 3", metres);
}

#[test]
fn readout_once() {
    let ways = "`camera.readout_s`, `camera.line_time_us`, or `camera.line_length_clocks` and `camera.pixel_clock_hz`";
    refuse_setup("readout_s = 0.0333", "", &format!("the readout time is missing: give {ways}"));
    for other in ["line_time_us = 69", "line_length_clocks = 1665", "pixel_clock_hz = 24e6"] {
        let message = format!("the readout time is given twice: give {ways}, not several");
        refuse_setup("fx = 600", &format!("fx = 600\n{other}"), &message);
    }
    refuse_setup(
        "readout_s = 0.0333",
        "line_length_clocks = 1665",
        "`camera.pixel_clock_hz` is missing: it must be a number above 0, at most 1000000000000 (Hz)",
    );
    refuse_setup(
        "fx = 600",
        "fx = 600\nsensor_rows_per_row = 2",
        "`camera.sensor_rows_per_row` is 2, but must be 1 or left out beside `camera.readout_s`, which is the time of all \
         rows already",
    );
    refuse_setup(
        "0.0333",
        "0",
        "`camera.readout_s` is 0, but must be a number above 0, at most 60 (seconds for the whole frame; a global shutter \
         has no effect to measure)",
    );
    let expected = "but must be above zero (a global shutter has no effect to measure), and a frame below one minute";
    refuse_setup(
        "readout_s = 0.0333",
        "line_time_us = 1e6",
        &format!("`camera.line_time_us` is 1000000.0, a readout of 480 s, {expected}"),
    );
    refuse_setup(
        "readout_s = 0.0333",
        "line_length_clocks = 1665\npixel_clock_hz = 24",
        &format!(
            "`camera.line_length_clocks` is 1665 and `camera.pixel_clock_hz` is 24, a readout of 33300 s, {expected}"
        ),
    );
}

#[test]
fn vectors_of_a_setup() {
    refuse_setup(
        "fx = 600",
        "fx = 600\ndistortion = [0.1, 0.2]",
        "`camera.distortion` is [0.1, 0.2], but must be 4, 5 or 8 numbers: k1, k2, p1, p2, k3 (OpenCV's order), \
         or k1, k2, p1, p2, k3, k4, k5, k6",
    );
    refuse_setup(
        "fx = 600",
        "fx = 600\ndistortion = [0, 0, nan, 0, 0]",
        "`camera.distortion[2]` is nan, but must be a number from -1000 to 1000 (coefficient of distortion)",
    );
    let outcome = Folder::of(&SETUP.replace("fx = 600", "fx = 600\ndistortion = [-2, 0, 0, 0, 0]"), POINTS).edges();
    assert!(
        outcome.stderr.starts_with("error: setup.toml: `camera.distortion` folds over at radius "),
        "{}",
        outcome.stderr
    );
    refuse_setup(
        "velocity_m_s = [-1.5, 0, 0]",
        "velocity_m_s = -1.5",
        "`motion.velocity_m_s` is -1.5, but must be 3 numbers: x right, y down, z forward (m/s)",
    );
    refuse_setup(
        "velocity_m_s = [-1.5, 0, 0]\n",
        "",
        "`motion.velocity_m_s` is missing: it must be 3 numbers: x right, y down, z forward (m/s)",
    );
    refuse_setup(
        "[motion]",
        "[motion]\nrate_rad_s = [0, inf, 0]",
        "`motion.rate_rad_s[1]` is inf, but must be a number from -1000 to 1000 (rad/s)",
    );
    refuse_setup(
        "[attitude]",
        "[attitude]\ngravity = [0, 0, 0]",
        "`attitude.gravity` is [0, 0, 0], but must be a direction: at least 0.001 long",
    );
}

#[test]
fn files_that_are_not_toml() {
    let outcome = Folder::of(&SETUP.replace("rows = 480", "rows == 480"), POINTS).edges();
    assert_eq!(outcome.code, 1);
    assert!(outcome.stderr.starts_with("error: setup.toml: line 3: "), "{}", outcome.stderr);
    assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
    refuse_setup("fx = 600", "fx = 600\nfx = 6", "line 5: `fx` is there a second time, but must be there once");
    assert_fails(&Folder::of("camera = 3\n", POINTS), "setup.toml: `camera` is 3, but must be a section: [camera]");
}

#[test]
fn headers_of_edges() {
    refuse_edges("", "the file is empty: it must begin with a header such as `row,column`");
    refuse_edges(
        "1,2\n",
        "line 1: the header begins with `1`: the first line must name the columns, such as `row,column`",
    );
    refuse_edges("row,colum\n", "line 1: unknown column `colum`; the nearest is `column`");
    refuse_edges("row,column,time\n", "line 1: unknown column `time`; the nearest is `time_s`");
    let columns = "`row`, `column`, `time_s`, `line`, `frame`, `polarity`, `sigma_px` and `width_px`";
    refuse_edges("row,column,depth\n", &format!("line 1: unknown column `depth`; the columns are {columns}"));
    refuse_edges("\nrow,sigma_px\n", "line 2: column `column` is missing: the header must name `row` and `column`");
    refuse_edges("row,column,row\n", "line 1: column `row` appears twice: each must appear once");
    refuse_edges("row;column\n", "line 1: the header is `row;column`: columns must be separated by commas");
}

#[test]
fn values_of_edges() {
    refuse_edges(
        "row,column\n480,2\n",
        "line 2: `row` is `480`, but must be a whole number from 0 to 479 (rows of the image)",
    );
    refuse_edges(
        "row,column\n1.5,2\n",
        "line 2: `row` is `1.5`, but must be a whole number from 0 to 479 (rows of the image)",
    );
    refuse_edges(
        "row,column\n,2\n",
        "line 2: `row` is empty, but must be a whole number from 0 to 479 (rows of the image)",
    );
    let columns = "but must be a number from -1 to 640 (columns of the image)";
    refuse_edges("row,column\n\n1,2\n\n\n2,641\n", &format!("line 6: `column` is `641`, {columns}"));
    refuse_edges("row,column\r\n\r\n1,nan\r\n", &format!("line 3: `column` is `nan`, {columns}"));
    refuse_edges("row,column\n1,left\n", &format!("line 2: `column` is `left`, {columns}"));
    refuse_edges("row,column\n1,2,3\n", "line 2: 3 values, but must be 2, one for each column of the header");
    refuse_edges(
        "row,column,time_s\n1,2,inf\n",
        "line 2: `time_s` is `inf`, but must be a number from -4000000000 to 4000000000 (seconds since frame start)",
    );
    refuse_edges(
        "row,column,sigma_px\n1,2,0\n",
        "line 2: `sigma_px` is `0`, but must be a number above 0, at most 256 (pixels, one standard deviation)",
    );
    let width =
        "but must be a number from 0 to 255 (pixels, one sigma of the edge's blur; 0 where it was not measured)";
    for value in ["-1", "256", "nan", "wide"] {
        let message = format!("line 2: `width_px` is `{value}`, {width}");
        refuse_edges(&format!("row,column,width_px\n1,2,{value}\n"), &message);
    }
    refuse_edges("row,column,line\n1,2,a\n", "line 2: `line` is `a`, but must be a whole number");
    refuse_edges("row,column,frame\n1,2,0.5\n", "line 2: `frame` is `0.5`, but must be a whole number");
    refuse_edges("row,column,polarity\n1,2,up\n", "line 2: `polarity` is `up`, but must be rising, falling or empty");
}

#[test]
fn edges_that_contradict_each_other() {
    refuse_edges(
        "row,column,line\n7,2,5\n1,2,5\n7,3,5\n",
        "lines 2 and 4: `line` 5 has two edge points on `row` 7, but must have one: number them as two lines",
    );
    refuse_edges("row,column\n7,2.5\n1,2\n7,2.5\n", "line 4: `row` 7, `column` 2.5 comes twice, but must come once");
    let backwards = "`time_s` is 0.001, earlier than on row 1, which was read before row 2: check the stamps and \
                     `camera.direction`";
    refuse_edges("row,column,time_s\n1,2,0.002\n2,2,0.001\n", &format!("line 3: {backwards}"));
    refuse_edges("row,column,time_s,line\n1,2,0.002,4\n2,2,0.001,4\n", &format!("line 3: {backwards}"));
}
