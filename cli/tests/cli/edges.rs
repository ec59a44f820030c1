use std::fmt::Write;

use serde_json::Value;

use crate::tool::{Folder, Outcome, SETUP, assert_near, column, command, number};

const LINES: [(f64, f64); 4] = [(-0.4, 2.0), (-0.1, 3.0), (0.05, 1.2), (0.3, 5.0)];

/// All lines on each of the rows.
fn four_lines(rows: impl Iterator<Item = u32>) -> String {
    let mut text = "row,column\n".to_string();
    for row in rows {
        for (bearing, depth_m) in LINES {
            let _ = writeln!(text, "{row},{:.5}", column(bearing, depth_m, row));
        }
    }
    text
}

fn assert_four_lines(ranges: &[Value]) {
    assert_eq!(ranges.len(), 4, "{ranges:?}");
    for (range, (bearing, depth_m)) in ranges.iter().zip(LINES) {
        assert_eq!(range["status"], "ok");
        assert_near(number(range, "bearing"), bearing, 1e-4);
        assert_near(number(range, "depth_m"), depth_m, 0.005 * depth_m);
    }
}

/// One upright edge on every tenth row, with more cells after row and column.
fn one_line(depth_m: f64, rest: &str) -> String {
    let line = |row| format!("{row},{:.5}{rest}\n", column(0.1, depth_m, row));
    (0..480).step_by(10).map(line).collect()
}

#[test]
fn several_lines_dense_and_sparse() {
    for step in [1, 3, 10, 23, 40] {
        assert_four_lines(&Folder::of(SETUP, &four_lines((0..480).step_by(step))).ranges());
    }
}

#[test]
fn lines_with_edges_on_different_rows() {
    let mut text = "row,column\n".to_string();
    for (row, (bearing, depth_m)) in (0..480).step_by(2).zip(LINES.into_iter().cycle()) {
        let _ = writeln!(text, "{row},{:.5}", column(bearing, depth_m, row));
    }
    assert_four_lines(&Folder::of(SETUP, &text).ranges());
}

#[test]
fn the_order_of_lines_in_the_file_is_free() {
    let text = four_lines((0..480).step_by(10));
    let mut lines: Vec<&str> = text.lines().skip(1).collect();
    lines.sort_unstable();
    assert_four_lines(&Folder::of(SETUP, &format!("row,column\n{}\n", lines.join("\n"))).ranges());
}

#[test]
fn a_gap_ends_a_line() {
    let rows = (0..100).chain(300..480).map(|row| format!("{row},{:.5}\n", column(0.1, 2.0, row)));
    let ranges = Folder::of(SETUP, &format!("row,column\n{}", rows.collect::<String>())).ranges();
    let ends = ranges.iter().map(|range| (number(range, "first_row"), number(range, "last_row")));
    let mut ends: Vec<_> = ends.collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(ends, [(0.0, 99.0), (300.0, 479.0)]);
}

#[test]
fn frames_are_apart_and_in_order() {
    let second = one_line(3.0, ",12,rising");
    let first = one_line(2.0, ",-1,falling");
    let document = Folder::of(SETUP, &format!("row,column,frame,polarity\n{second}{first}")).document();
    let frames = document["frames"].as_array().expect("frames");
    let summary = |frame: &Value| {
        let range = &frame["ranges"][0];
        (frame["name"].clone(), range["polarity"].clone(), (number(range, "depth_m") * 100.0).round())
    };
    let summaries: Vec<_> = frames.iter().map(summary).collect();
    assert_eq!(
        summaries,
        [("edges.csv#-1".into(), "falling".into(), 200.0), ("edges.csv#12".into(), "rising".into(), 300.0)]
    );
}

#[test]
fn json_keys_are_as_promised() {
    let folder = Folder::of(SETUP, &format!("row,column\n{}", one_line(2.0, "")));
    let text = folder.run(&["edges", "edges.csv", "--setup", "setup.toml", "--json"]).stdout;
    let keys = [
        "frames",
        "name",
        "torn",
        "ranges",
        "bearing",
        "inverse_depth_per_m",
        "sigma_inverse_depth_per_m",
        "depth_m",
        "sigma_depth_m",
        "distance_m",
        "nearest_m",
        "farthest_m",
        "first_row",
        "last_row",
        "column_at_first_row",
        "column_at_last_row",
        "edges",
        "polarity",
        "status",
        "line_id",
        "frames",
        "tilt_deg",
        "sigma_tilt_deg",
        "sigma_common",
        "dominant",
        "edges_used",
        "misfit",
        "post",
        "post_distance_m",
        "post_sigma_m",
        "edges",
        "stray_edges",
        "dropped_edges",
        "dropped_lines",
        "gravity",
        "sigma_gravity_deg",
        "hints",
    ];
    let found: Vec<_> = text.lines().filter_map(|line| line.trim().strip_prefix('"')?.split('"').next()).collect();
    assert_eq!(found, keys);
    let frame = &folder.document()["frames"][0];
    assert_eq!((&frame["name"], &frame["torn"]), (&"edges.csv".into(), &false.into()));
    assert_eq!((&frame["dropped_edges"], &frame["dropped_lines"]), (&0.into(), &0.into()));
}

#[test]
fn gravity_is_told_as_it_was_used() {
    let attitude = "[attitude]\ngravity = [0, 9.81, 0]\nsigma_gravity_deg = 0.25";
    let text = format!("row,column\n{}", one_line(2.0, ""));
    let frame = &Folder::of(&SETUP.replace("[attitude]", attitude), &text).document()["frames"][0];
    assert_eq!(frame["gravity"], serde_json::json!([0.0, 1.0, 0.0]), "as a unit vector");
    assert_near(number(frame, "sigma_gravity_deg"), 0.25, 1e-12);
}

#[test]
fn an_ok_range_has_consistent_numbers() {
    let ranges = Folder::of(SETUP, &format!("row,column\n{}", one_line(2.0, ""))).ranges();
    let range = &ranges[0];
    let (rho, sigma) = (number(range, "inverse_depth_per_m"), number(range, "sigma_inverse_depth_per_m"));
    assert_near(number(range, "depth_m"), 1.0 / rho, 1e-9);
    assert_near(number(range, "sigma_depth_m"), sigma / (rho * rho), 1e-9);
    assert_near(number(range, "distance_m"), 1.01_f64.sqrt() / rho, 1e-5);
    assert_near(number(range, "nearest_m"), 1.0 / (rho + 2.0 * sigma), 1e-9);
    assert_near(number(range, "farthest_m"), 1.0 / (rho - 2.0 * sigma), 1e-9);
    assert_eq!((number(range, "first_row"), number(range, "last_row")), (0.0, 470.0));
    assert_eq!(range["polarity"], Value::Null);
}

#[test]
fn each_status_has_its_nulls() {
    let far = (0..480).step_by(10).map(|row| format!("{row},{:.4},1\n", column(0.1, 1e5, row))).collect::<String>();
    let wrong_way = (0..480).step_by(10).map(|row| format!("{row},{:.4},2\n", column(0.2, -2.0, row)));
    let bent = (0..480).step_by(10).map(|row| format!("{row},{:.4},3\n", 500.0 + f64::from(row * row) * 1e-4));
    let short = "0,600,4\n10,600,4\n20,600,4\n";
    let text = format!("row,column,line\n{far}{}{}{short}", wrong_way.collect::<String>(), bent.collect::<String>());
    let ranges = Folder::of(SETUP, &text).ranges();
    let statuses: Vec<_> = ranges.iter().map(|range| range["status"].as_str().expect("a word")).collect();
    assert_eq!(statuses, ["far", "inconsistent", "bent", "short"]);
    for range in &ranges {
        assert!(["depth_m", "sigma_depth_m", "distance_m"].iter().all(|key| range[key].is_null()), "{range}");
    }
    assert!(number(&ranges[0], "nearest_m") > 100.0 && ranges[0]["farthest_m"].is_null());
    assert!(ranges[1]["nearest_m"].is_null());
}

#[test]
fn a_camera_that_stands_still_is_slow() {
    let still = SETUP.replace("-1.5", "0");
    let text = format!("row,column,line\n{}", one_line(1e9, ",1"));
    let ranges = Folder::of(&still, &text).ranges();
    assert_eq!(ranges[0]["status"], "slow");
    assert!(number(&ranges[0], "sigma_inverse_depth_per_m") > 0.33);
    // On its side, upright edges run along the rows.
    let sideways = SETUP.replace("[attitude]", "[attitude]\ngravity = [1, 0, 0]");
    assert_eq!(Folder::of(&sideways, &text).ranges()[0]["status"], "sideways");
}

#[test]
fn stamps_replace_the_row_times() {
    // Slower than the setup says, as far as that may be: the same columns are those of a farther edge.
    let rows = (0..480).step_by(10).map(|row| {
        let time_s = f64::from(row) * 1.05 * 0.0333 / 480.0;
        format!("{time_s:.9},{row},{:.5}\n", column(0.1, 2.0, row))
    });
    let text = format!("time_s,row,column\n{}", rows.collect::<String>());
    let ranges = Folder::of(SETUP, &text).ranges();
    assert_near(number(&ranges[0], "depth_m"), 2.1, 0.005);
}

#[test]
fn noise_of_the_edges_comes_from_the_file_or_the_setup() {
    let sigma = |setup: &str, header: &str, rest: &str| {
        let ranges = Folder::of(setup, &format!("{header}\n{}", one_line(2.0, rest))).ranges();
        number(&ranges[0], "sigma_inverse_depth_per_m")
    };
    let usual = sigma(SETUP, "row,column", "");
    assert_near(sigma(SETUP, "row,column,sigma_px", ",0.2") / usual, 2.0, 0.001);
    assert_near(sigma(SETUP, "row,column,sigma_px", ",") / usual, 1.0, 0.001);
    let doubled = SETUP.replace("fx = 600", "fx = 600\nsigma_column_px = 0.2");
    assert_near(sigma(&doubled, "row,column", "") / usual, 2.0, 0.001);
}

/// Over 1 m the edge passes 9 px in an exposure of 10 ms, a box with a sigma of 2.6 px.
#[test]
fn a_known_exposure_and_a_measured_width_show_a_lean() {
    let setup = SETUP.replace("fx = 600", "fx = 600\nexposure_s = 0.01\nlens_blur_px = 0.7");
    let status = |header: &str, rest: &str| {
        let range = Folder::of(&setup, &format!("{header}\n{}", one_line(1.0, rest))).ranges().remove(0);
        range["status"].as_str().expect("a word").to_string()
    };
    assert_eq!(status("row,column,width_px", ",0.76"), "leaning", "it is not smeared as its slope would have it");
    assert_eq!(status("row,column,width_px", ",2.7"), "ok");
    for (header, rest) in [("row,column", ""), ("row,column,width_px", ","), ("row,column,width_px", ",0")] {
        assert_eq!(status(header, rest), "ok", "not measured: {header} {rest}");
    }
}

/// Each point is counted once even where it could be of either edge.
#[test]
fn points_of_edges_that_are_too_near_to_each_other_are_counted() {
    for (apart_px, width_px) in [(3.0, "2"), (3.0, ""), (0.1, "2"), (0.1, ""), (0.1, "0.5"), (1.0, "0.5")] {
        let rows = (0..480).flat_map(|row| {
            let column = column(0.1, 2.0, row);
            [column, column + apart_px].map(|column| format!("{row},{column:.5},rising,{width_px}\n"))
        });
        let text = format!("row,column,polarity,width_px\n{}", rows.collect::<String>());
        // That the counts add up is checked for every document.
        let frame = &Folder::of(SETUP, &text).document()["frames"][0];
        assert_eq!(frame["edges"], 960, "{apart_px} px, width {width_px}");
        let is_ambiguous = (apart_px, width_px) == (3.0, "2") || apart_px == 0.1;
        assert_eq!(number(frame, "stray_edges") > 0.0, is_ambiguous, "{apart_px} px, width {width_px}");
    }
}

#[test]
fn whatever_a_spreadsheet_writes() {
    let text = format!(" \"Row\" , column ,polarity,line\n\n,,,\n{}\n", one_line(2.0, " , RISING , 1.0"))
        .replace("Row", "row");
    let text = format!("\u{feff}{}", text.replace('\n', "\r\n"));
    let ranges = Folder::of(SETUP, &text).ranges();
    assert_near(number(&ranges[0], "depth_m"), 2.0, 0.01);
    assert_eq!(ranges[0]["polarity"], "rising");
}

#[test]
fn standard_input() {
    let folder = Folder::new().with("setup.toml", SETUP);
    let arguments = ["edges", "-", "--setup", "setup.toml", "--json"];
    let plain = folder.run_with_input(&arguments, &format!("row,column\n{}", one_line(2.0, ""))).json();
    assert_eq!(plain["frames"][0]["name"], "-");
    assert_eq!(plain["frames"][0]["ranges"].as_array().map(Vec::len), Some(1));
    let framed = folder.run_with_input(&arguments, &format!("row,column,frame\n{}", one_line(2.0, ",3"))).json();
    assert_eq!(framed["frames"][0]["name"], "-#3");
}

#[test]
fn no_edges_is_an_answer() {
    let document = Folder::of(SETUP, "row,column\n").document();
    assert_eq!(document["frames"][0]["ranges"], Value::Array(Vec::new()));
    let none = Folder::of(SETUP, "row,column,frame\n");
    assert_eq!(none.document()["frames"], Value::Array(Vec::new()));
    assert_eq!(none.edges().stdout, "no frames\n");
}

#[test]
fn what_does_not_fit_is_counted() {
    let rows = (0..12).flat_map(|row| (0..1070).map(move |line| format!("{row},{}\n", 2 * line)));
    let setup = SETUP.replace("columns = 640", "columns = 2400");
    let folder = Folder::of(&setup, &format!("row,column\n{}", rows.collect::<String>()));
    let frame = &folder.document()["frames"][0];
    assert_eq!(frame["ranges"].as_array().map(Vec::len), Some(1024));
    assert!(number(frame, "dropped_lines") > 0.0);
    let [edges, stray, dropped] = ["edges", "stray_edges", "dropped_edges"].map(|key| number(frame, key));
    assert_eq!((edges, stray, dropped), (12.0 * 1070.0, 0.0, 12.0 * (1070.0 - 1024.0)));
    assert!(folder.edges().stdout.contains("dropped because the tables were full: 552 edge points, "));
}

/// Two rows are too few for a fit, but they are somewhere.
#[test]
fn an_edge_that_cannot_be_fitted_has_the_bearing_of_its_column() {
    for (setup, bearing) in [
        (SETUP.to_string(), (5.0 - 319.5) / 600.0),
        // Barrel: what is seen at the border lies farther out.
        (SETUP.replace("fx = 600", "fx = 600\ndistortion = [-0.1, 0, 0, 0]"), -0.558),
    ] {
        let range = Folder::of(&setup, "row,column,line\n230,5,1\n240,5,1\n").ranges().remove(0);
        assert_eq!(range["status"], "short");
        assert_near(number(&range, "bearing"), bearing, 0.02);
    }
}

#[test]
fn text_has_one_line_for_each_range() {
    let far = (0..480).step_by(10).map(|row| format!("{row},{:.4}\n", column(0.4, 1e5, row))).collect::<String>();
    let outcome = Folder::of(SETUP, &format!("row,column\n{}{far}0,10\n", one_line(2.0, ""))).edges();
    assert_eq!(outcome.code, 0);
    let lines: Vec<Vec<&str>> = outcome.stdout.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(lines.len(), 5, "{}", outcome.stdout);
    assert_eq!(lines[0], ["edges.csv"]);
    assert_eq!(lines[1].last(), Some(&"status"));
    assert_eq!(lines[2][..2], ["379.50@0", "+0.1000"]);
    assert_eq!(lines[2][3], "±");
    assert_eq!(lines[2][7..], ["noise", "-", "0-470", "48", "-", "ok"]);
    assert_eq!(lines[3].last(), Some(&"far"));
    assert!(outcome.stdout.contains("∞)"));
    assert!(lines[4].starts_with(&["1", "stray", "edge", "points:"]));
    assert!(!outcome.stdout.contains('\x1b'), "no colours into a pipe");
}

#[test]
fn a_reader_that_stops_early_is_no_error() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut child = command(folder.path(), &["table2"]).spawn().expect("the tool starts");
    drop(child.stdout.take());
    let outcome = Outcome::new(child.wait_with_output().expect("the tool ends"));
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
}

#[test]
fn every_key_of_a_setup() {
    let setup = "\
unusual = [\"exposure_s\"]
[camera]
columns = 640
rows = 480
focal_length_mm = 3.6
pixel_pitch_um = 6
fy = 600.0
cx = 319.5
cy = 239.5
distortion = [0, 0.0, 0.0, 0.0, 0.0]
line_time_us = 34.6875
sensor_rows_per_row = 2
direction = \"top-to-bottom\"
exposure_s = 0.001
lens_blur_px = 0.7
response = \"srgb\"
sigma_blur = 0.25
bits = 10
edge_roughness_px = 0.0
sigma_column_px = 0.1
sigma_readout = 0.0
sigma_focal = 0.0
[motion]
velocity_m_s = [-1.5, 0, 0]
rate_rad_s = [0.0, 0.0, 0.0]
sigma_speed = 0.0
sigma_rate_rad_s = 0.0
sigma_time_s = 0.0
[attitude]
gravity = [0.0, 9.81, 0.0]
sigma_tilt_deg = 0
sigma_gravity_deg = 0.0
";
    let edges = format!("row,column\n{}", one_line(2.0, ""));
    assert_eq!(Folder::of(setup, &edges).document(), Folder::of(SETUP, &edges).document());
}

#[test]
fn uncertainty_widens_the_range() {
    let relative_sigma = |old: &str, new: &str| {
        let edges = format!("row,column\n{}", one_line(2.0, ""));
        let range = Folder::of(&SETUP.replace(old, new), &edges).ranges().remove(0);
        number(&range, "sigma_inverse_depth_per_m") / number(&range, "inverse_depth_per_m")
    };
    assert!(relative_sigma("", "") < 0.005);
    assert_near(relative_sigma("sigma_speed = 0", "sigma_speed = 0.1"), 0.1, 0.001);
    assert_near(relative_sigma("sigma_readout = 0", "sigma_readout = 0.1"), 0.1, 0.001);
    assert!(relative_sigma("edge_roughness_px = 0", "edge_roughness_px = 0.2") > 2.0 * relative_sigma("", ""));
    // A tenth of a degree over the slope of the edge, which is 0.0312; it is the default, too.
    let from_tilt = 0.1_f64.to_radians() / (600.0 * 1.5 / 2.0 * 0.0333 / 480.0);
    assert_near(relative_sigma("sigma_tilt_deg = 0", "sigma_tilt_deg = 0.1"), from_tilt, 0.002);
    assert_near(relative_sigma("sigma_tilt_deg = 0", ""), from_tilt, 0.002);
}

/// Those of a careful amateur: 2 % of speed, 1 % of readout and focal length, 0.03 px of roughness.
#[test]
fn what_a_setup_leaves_out_is_not_known_exactly() {
    let relative_sigma = |setup: &str| {
        let edges = format!("row,column\n{}", one_line(2.0, ""));
        let range = Folder::of(setup, &edges).ranges().remove(0);
        number(&range, "sigma_inverse_depth_per_m") / number(&range, "inverse_depth_per_m")
    };
    let lines = ["sigma_readout = 0\n", "sigma_focal = 0\n", "edge_roughness_px = 0\n", "sigma_speed = 0\n"];
    let stated =
        ["sigma_readout = 0.01\n", "sigma_focal = 0.01\n", "edge_roughness_px = 0.03\n", "sigma_speed = 0.02\n"];
    let left_out = lines.iter().fold(SETUP.to_string(), |setup, line| setup.replace(line, ""));
    let spelt_out =
        lines.iter().zip(stated).fold(SETUP.to_string(), |setup, (line, as_one)| setup.replace(line, as_one));
    assert_eq!(relative_sigma(&left_out), relative_sigma(&spelt_out));
    let from_all = (0.02_f64.powi(2) + 2.0 * 0.01_f64.powi(2)).sqrt();
    assert_near(relative_sigma(&left_out), from_all, 0.003);
}

#[test]
fn the_line_time_comes_from_the_registers_of_a_sensor() {
    let edges = format!("row,column\n{}", one_line(2.0, ""));
    // An OV7670 at 24 MHz: 784 pixel periods of two clocks each. The same for every second row of a sensor.
    let by_time = SETUP.replace("readout_s = 0.0333", "readout_s = 0.03136");
    let by_clocks = SETUP.replace("readout_s = 0.0333", "line_length_clocks = 1568\npixel_clock_hz = 24e6");
    let skipping = by_clocks.replace("1568", "784").replace("fx = 600", "fx = 600\nsensor_rows_per_row = 2");
    let depth = |setup: &str| number(&Folder::of(setup, &edges).ranges()[0], "depth_m");
    assert_near(depth(&by_clocks), depth(&by_time), 1e-6);
    assert_near(depth(&skipping), depth(&by_time), 1e-6);
    assert!(depth(&by_time) < 1.95, "the readout is shorter than that of the edges");
}

/// A window of 640 × 480 pixels at the left border of a sensor of 1920.
#[test]
fn the_optical_axis_may_lie_outside_the_frame() {
    let window = SETUP.replace("fx = 600", "fx = 600\ncx = 959.5");
    let edges = format!("row,column\n{}", one_line(2.0, ""));
    let range = Folder::of(&window, &edges).ranges().remove(0);
    assert_eq!(range["status"], "ok");
    assert_near(number(&range, "bearing"), 0.1 - 640.0 / 600.0, 1e-4);
}
