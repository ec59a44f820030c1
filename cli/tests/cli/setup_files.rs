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
