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

/// A verdict and the table under it are for one motion: that of the first setup.
#[test]
fn all_setups_are_planned_at_the_motion_of_the_first() {
    let folder = Folder::new().with("fast.toml", USUAL).with("slow.toml", USUAL.replace("1.5", "0.15"));
    let plans = |setups: [&str; 2]| {
        let arguments = ["plan", "--setup", setups[0], "--setup", setups[1], "--from", "1", "--to", "3", "--json"];
        let document = folder.run(&arguments).json();
        let [first, second] = [0, 1].map(|index| document["plans"][index].clone());
        for key in ["verdict", "depths", "nearest_m", "farthest_m", "slowest_m_s"] {
            assert_eq!(first[key], second[key], "{key}: the setups differ in their motion alone");
        }
        (number(&document, "speed_m_s"), first)
    };
    let ((fast_m_s, fast), (slow_m_s, slow)) = (plans(["fast.toml", "slow.toml"]), plans(["slow.toml", "fast.toml"]));
    assert_eq!((fast_m_s, slow_m_s), (1.5, 0.15));
    assert_ne!(fast["depths"], slow["depths"]);
    let text = folder.run(&["plan", "--setup", "slow.toml", "--setup", "fast.toml"]).stdout;
    assert!(text.contains("motion of slow.toml, 0.15 m/s"), "{text}");
}

/// An option that is wrong is bad usage, and told by the name that was typed.
#[test]
fn options_out_of_range_are_bad_usage() {
    let folder = Folder::new().with("setup.toml", USUAL);
    for (option, value) in [
        ("--from", "0"),
        ("--from", "1e-4"),
        ("--to", "-1"),
        ("--to", "1e6"),
        ("--steps", "0"),
        ("--sigma", "nan"),
        ("--sigma", "-1"),
        ("--sigma", "5"),
        ("--slowest-m-s", "1e-5"),
        ("--fastest-m-s", "2000"),
        ("--height-m", "1e9"),
        ("--width-m", "1e6"),
        ("--contrast", "300"),
        ("--bearing", "nan"),
        ("--bearing", "-11"),
        ("--read-noise", "-1"),
        ("--shot-gain", "inf"),
    ] {
        let outcome = folder.run(&["plan", "--setup", "setup.toml", option, value]);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{option} {value}");
        let message = format!("'{value}' for '{option} <");
        assert!(outcome.stderr.contains(&message), "{option} {value}: {}", outcome.stderr);
    }
    // The ends of the ranges are taken.
    for (option, value) in
        [("--height-m", "20000"), ("--bearing", "-10"), ("--read-noise", "0"), ("--to", "100000"), ("--sigma", "1")]
    {
        let outcome = folder.run(&["plan", "--setup", "setup.toml", option, value]);
        assert_eq!(outcome.code, 0, "{option} {value}: {}", outcome.stderr);
    }
}

#[test]
fn options_that_contradict_each_other_are_bad_usage() {
    let folder = Folder::new().with("setup.toml", USUAL);
    let plan = |arguments: &[&str]| folder.run(&[&["plan", "--setup", "setup.toml"], arguments].concat());
    let reversed = plan(&["--from", "10", "--to", "1"]);
    let message = "--from is 10, but must be at most --to, which is 1 (m)";
    assert!(reversed.code == 2 && reversed.stderr.contains(message), "{}", reversed.stderr);
    let slow = plan(&["--slowest-m-s", "5", "--fastest-m-s", "1"]);
    let message = "--slowest-m-s is 5, but must be at most --fastest-m-s, which is 1 (m/s)";
    assert!(slow.code == 2 && slow.stderr.contains(message), "{}", slow.stderr);
    let many = plan(&["--setup", "setup.toml"].repeat(32));
    assert!(many.code == 2 && many.stderr.contains("--setup is given 33 times"), "{}", many.stderr);
}

#[test]
fn speeds_that_the_setup_contradicts() {
    let folder = Folder::new().with("setup.toml", USUAL).with("rest.toml", USUAL.replace("1.5", "0"));
    let refused = |setup: &str, arguments: &[&str], message: &str| {
        let outcome = folder.run(&[&["plan", "--setup", setup], arguments].concat());
        assert_eq!(outcome.code, 1, "{}", outcome.stdout);
        assert!(outcome.stderr.starts_with(&format!("error: {setup}: {message}")), "{}", outcome.stderr);
    };
    refused("setup.toml", &["--slowest-m-s", "3"], "--slowest-m-s is 3, but must be at most 1.5 (m/s)");
    refused("setup.toml", &["--fastest-m-s", "1"], "--fastest-m-s is 1, but must be at least 1.5 (m/s)");
    let at_rest = "`motion.velocity_m_s` is zero, but must have a direction";
    refused("rest.toml", &[], at_rest);
    refused("rest.toml", &["--slowest-m-s", "1", "--fastest-m-s", "2"], at_rest);
    assert_eq!(folder.run(&["plan"]).code, 2);
}
