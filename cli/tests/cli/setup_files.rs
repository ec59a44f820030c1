//! What `setup` prints: a setup file with every key.

use crate::painting::{painted, png};
use crate::tool::Folder;

const POINTS: &str = "row,column\n0,10\n1,10.1\n2,10.2\n3,10.3\n4,10.4\n5,10.5\n6,10.6\n7,10.7\n8,10.8\n";

fn printed(arguments: &[&str]) -> String {
    let outcome = Folder::new().run(&[&["setup"], arguments].concat());
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    outcome.stdout
}

/// The keys of a section, as the tool lists them for one that it does not know.
fn keys(section: &str) -> Vec<String> {
    let setup = format!("[{section}]\nq = 1\n");
    let outcome = Folder::of(&setup, POINTS).edges();
    let (_, list) = outcome.stderr.split_once(" are ").expect("a list of keys");
    list.split('`').skip(1).step_by(2).map(str::to_string).collect()
}

#[test]
fn what_is_printed_is_a_setup_as_it_stands() {
    for arguments in [&[][..], &["--example"]] {
        let folder = Folder::of(&printed(arguments), POINTS).with("a.png", png(painted()));
        assert_eq!(folder.edges().code, 0, "{}", folder.edges().stderr);
        let outcome = folder.run(&["frame", "a.png", "--setup", "setup.toml"]);
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    }
}

#[test]
fn every_key_is_there_with_its_default() {
    let (text, example) = (printed(&[]), printed(&["--example"]));
    for section in ["camera", "motion", "attitude"] {
        let (_, section_text) = text.split_once(&format!("\n[{section}]\n")).expect("the section");
        let section_text = section_text.split("\n[").next().expect("its keys");
        let keys = keys(section);
        assert!(keys.len() >= 3, "{keys:?}");
        for key in keys {
            let is_key = |line: &str| {
                let line = ["", "# ", "# or: "].iter().find_map(|before| line.strip_prefix(before)?.strip_prefix(&key));
                line.is_some_and(|rest| rest.starts_with(" = "))
            };
            assert!(section_text.lines().any(is_key), "{section}.{key} is missing");
        }
    }
    for key in keys("mount") {
        assert!(text.contains(&format!("\n# or: {key} = ")), "mount.{key} is missing");
    }
    assert!(text.contains("\n# unusual = []\n") && example.contains("\nunusual = []\n"));
    // What must be given stands alone; what need not is explained with its default.
    let given: Vec<_> = text.lines().filter(|line| !line.starts_with(['#', '['])).collect();
    let given: Vec<_> = given.iter().filter_map(|line| line.split_once(" = ")).map(|(key, _)| key).collect();
    assert_eq!(given, ["columns", "rows", "fx", "readout_s", "velocity_m_s"]);
    let mut paragraphs = text.split("\n\n").filter(|paragraph| paragraph.lines().any(|line| line.contains(" = ")));
    let first = paragraphs.next().expect("that of `unusual`");
    assert!(first.contains("Default:"), "{first}");
    for paragraph in paragraphs.filter(|paragraph| paragraph.lines().all(|line| line.starts_with('#'))) {
        assert!(paragraph.contains("Default:"), "{paragraph}");
    }
}

/// All that it sets is assumed anyway; what is unknown without it has no effect on edges without widths.
#[test]
fn the_example_changes_nothing_but_what_is_unknown_by_default() {
    let ranges = |arguments: &[&str]| Folder::of(&printed(arguments), POINTS).document();
    assert_eq!(ranges(&["--example"]), ranges(&[]));
}

#[test]
fn json_holds_the_same_text() {
    let document = Folder::new().run(&["setup", "--json"]).json();
    assert_eq!(document["setup"].as_str(), Some(printed(&[]).as_str()));
}

fn with_sensor(arguments: &[&str]) -> (String, toml::Table) {
    let text = printed(arguments);
    let camera = text.parse::<toml::Table>().expect("TOML")["camera"].as_table().expect("a section").clone();
    (text, camera)
}

/// The line times are those that OpenMV states: 150 frames of 278 lines a second.
#[test]
fn a_sensor_fills_in_what_its_table_knows() {
    let (text, camera) = with_sensor(&["--sensor", "ov7725-qvga", "--clock-mhz", "12"]);
    let of =
        |key: &str| camera[key].as_float().or(camera[key].as_integer().map(|whole| whole as f64)).expect("a number");
    assert_eq!(["columns", "rows", "line_time_us", "sigma_readout"].map(of), [320.0, 240.0, 24.0, 0.001]);
    assert!(!camera.contains_key("readout_s"));
    assert!(text.contains("Still an example, to be replaced: fx, velocity_m_s."), "{text}");
    // Half the clock, twice the time.
    let (_, slow) = with_sensor(&["--sensor", "OV7725 QVGA", "--clock-mhz", "6"]);
    assert_eq!(slow["line_time_us"].as_float(), Some(48.0));
    let folder = Folder::of(&text, POINTS);
    assert_eq!(folder.edges().code, 0, "{}", folder.edges().stderr);
}

#[test]
fn every_mode_of_the_table_is_found_by_its_name() {
    let modes = Folder::new().run(&["sensors", "--json"]).json();
    for mode in modes["modes"].as_array().expect("modes") {
        let name = format!("{} {}", mode["sensor"].as_str().expect("a name"), mode["mode"].as_str().expect("a name"));
        let outcome = Folder::new().run(&["setup", "--sensor", &name]);
        // A name may be the beginning of another one.
        let line = format!("\nline_time_us = {}", mode["line_time_us"]);
        let is_found = outcome.code == 0 && outcome.stdout.contains(&line);
        assert!(is_found || outcome.stderr.contains(" or "), "{name}: {}", outcome.stderr);
    }
}

#[test]
fn sensors_that_are_refused() {
    let refused = |arguments: &[&str]| Folder::new().run(&[&["setup"], arguments].concat());
    let several = refused(&["--sensor", "ov7725-vga"]);
    let message = "--sensor ov7725-vga may be ov7725-vga-yuv (24 MHz) or ov7725-vga-openmv-h7 (12 MHz): say which, or the \
                   clock by --clock-mhz";
    assert_eq!((several.code, several.stderr), (1, format!("error: {message}\n")));
    let (_, by_clock) = with_sensor(&["--sensor", "ov7725-vga", "--clock-mhz", "24"]);
    assert!((by_clock["line_time_us"].as_float().expect("a number") - 65.333).abs() < 1e-3);
    let unknown = refused(&["--sensor", "ov7725-cif"]).stderr;
    assert!(
        unknown.starts_with("error: --sensor ov7725-cif is unknown; there is ov7725-vga-yuv (24 MHz) or "),
        "{unknown}"
    );
    assert!(refused(&["--sensor", "imx999"]).stderr.contains("shutter-range sensors lists all"));
    for clock in ["0", "-3", "nan", "1e9", "twelve"] {
        let outcome = refused(&["--sensor", "ov7725-qvga", "--clock-mhz", clock]);
        assert!(outcome.code == 2 && outcome.stderr.contains("1 to 100 (MHz)"), "{}", outcome.stderr);
    }
    assert_eq!(refused(&["--clock-mhz", "12"]).code, 2);
}
