//! `plan`: what cameras will measure.

use crate::tool::{Folder, SETUP, assert_near, number};

const USUAL: &str = "\
[camera]
columns = 640
rows = 480
fx = 600
readout_s = 0.0333
exposure_s = 0.002
lens_blur_px = 0.7
response = \"linear\"
[motion]
velocity_m_s = [1.5, 0, 0]
";

#[test]
fn a_plan_has_sigmas_their_parts_and_the_reach() {
    let folder = Folder::new().with("setup.toml", USUAL);
    let arguments =
        ["plan", "--setup", "setup.toml", "--from", "0.5", "--to", "8", "--steps", "4", "--svg", "plan.svg"];
    let document = folder.run(&[&arguments[..], &["--json"]].concat()).json();
    let plan = &document["plans"][0];
    let depths = plan["depths"].as_array().expect("depths");
    assert_eq!(depths.len(), 5);
    for row in depths.iter().filter(|row| row["status"] == "ok") {
        let parts = row["parts"].as_array().expect("parts");
        let squares: f64 = parts.iter().map(|part| number(part, "relative_sigma").powi(2)).sum();
        assert_near(squares.sqrt(), number(row, "relative_sigma"), 1e-6);
        assert_near(number(row, "sigma_depth_m"), number(row, "relative_sigma") * number(row, "depth_m"), 1e-9);
    }
    assert!(number(plan, "nearest_m") < 0.5 && (2.0..6.0).contains(&number(plan, "farthest_m")), "{plan}");
    assert!(plan["suits"] == false && document["best"].is_null(), "{document}");
    let text = folder.run(&arguments).stdout;
    assert!(text.contains("no setup does what is wanted") && text.contains("lean"), "{text}");
    assert!(String::from_utf8(folder.read("plan.svg")).expect("UTF-8").contains("lean"));
}

/// The same numbers as those of the ranges that it plans, for an edge of exactly known columns.
#[test]
fn without_uncertainties_only_noise_is_left() {
    let folder = Folder::new().with("setup.toml", SETUP);
    let document = folder.run(&["plan", "--setup", "setup.toml", "--from", "1", "--to", "3", "--json"]).json();
    for row in document["plans"][0]["depths"].as_array().expect("depths") {
        let parts = row["parts"].as_array().expect("parts");
        let noise = parts.iter().find(|part| part["source"] == "noise").expect("noise");
        assert_near(number(noise, "relative_sigma"), number(row, "relative_sigma"), 1e-9);
    }
    assert_eq!(document["best"], 0);
}

#[test]
fn the_best_of_several_setups_and_why_the_others_lost() {
    let folder = Folder::new()
        .with("vga.toml", USUAL)
        .with("fast.toml", USUAL.replace("0.0333", "0.005"))
        .with("dark.toml", USUAL.replace("0.002", "0.09"));
    let arguments = ["--setup", "vga.toml", "--setup", "fast.toml", "--setup", "dark.toml"];
    let request = ["plan", "--from", "0.8", "--to", "2.5", "--sigma", "0.15", "--fastest-m-s", "3"];
    let document = folder.run(&[&request[..], &arguments, &["--json"]].concat()).json();
    assert_eq!(document["best"], 0, "{document}");
    let verdict = |index: usize| document["plans"][index]["verdict"].as_str().expect("a sentence");
    assert!(verdict(0).starts_with("suits") && verdict(1).contains("2.50 m"), "{} / {}", verdict(0), verdict(1));
    assert!(verdict(2).contains("too blurred"), "{}", verdict(2));
}

#[test]
fn plan_refuses_what_is_wrong() {
    let folder = Folder::new().with("setup.toml", USUAL).with("rest.toml", USUAL.replace("1.5", "0"));
    let plan = |arguments: &[&str]| folder.run(&[&["plan", "--setup", "setup.toml"], arguments].concat());
    for arguments in [["--from", "0"], ["--to", "-1"], ["--sigma", "nan"], ["--steps", "0"], ["--contrast", "300"]] {
        assert_eq!(plan(&arguments).code, 2, "{arguments:?}");
    }
    let reversed = plan(&["--from", "5", "--to", "2"]);
    assert!(
        reversed.code == 1 && reversed.stderr.contains("--from is 5, but must be 0.001 to --to (m)"),
        "{}",
        reversed.stderr
    );
    let slow = plan(&["--slowest-m-s", "3"]);
    assert!(
        slow.code == 1 && slow.stderr.contains("is 3, but must be 0.001 to --fastest-m-s (m/s)"),
        "{}",
        slow.stderr
    );
    let wide = plan(&["--width-m", "1e6"]);
    assert!(wide.code == 1 && wide.stderr.contains("--width-m is 1000000"), "{}", wide.stderr);
    let negative = plan(&["--sigma", "-1"]);
    assert!(negative.stderr.contains("'--sigma <SIGMA>': it must be a finite number above 0"), "{}", negative.stderr);
    let rest = folder.run(&["plan", "--setup", "rest.toml"]);
    assert_eq!(rest.code, 1, "{}", rest.stdout);
    assert_eq!(folder.run(&["plan"]).code, 2);
}
