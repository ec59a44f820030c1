//! Many frames: by many threads, in their order, and a document for each.

use serde_json::Value;

use crate::painting::{painted, painted_by, png};
use crate::tool::{Folder, SETUP};

/// Some dozen frames that differ, and one that is none.
fn folder() -> (Folder, Vec<String>) {
    let names: Vec<_> = (0..24).map(|number| format!("f{number:02}.png")).collect();
    let folder = names.iter().zip(1..).fold(Folder::new().with("setup.toml", SETUP), |folder, (name, step)| {
        let picture = if step % 3 == 0 { png(painted()) } else { png(painted_by(|row| row * step / 30)) };
        folder.with(name, if step == 11 { b"no picture".to_vec() } else { picture })
    });
    (folder, names)
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let (folder, names) = folder();
    let files: Vec<_> = names.iter().map(String::as_str).collect();
    for rest in [&["--json"][..], &["--frame-interval-s", "0.04", "--json"], &[]] {
        let run = |jobs: &str| {
            let outcome = folder.run(&[&["frame", "--setup", "setup.toml", "--jobs", jobs], rest, &files[..]].concat());
            assert_eq!(outcome.code, 1, "{}", outcome.stderr);
            (outcome.stdout, outcome.stderr)
        };
        let one = run("1");
        assert!(one.1.starts_with("error: f10.png: the file is no PNG") && one.1.lines().count() == 1, "{}", one.1);
        assert_eq!(run("2"), one);
        assert_eq!(run("13"), one);
    }
}

#[test]
fn json_lines_are_the_frames_of_the_document() {
    let (folder, names) = folder();
    let files: Vec<_> = names.iter().map(String::as_str).collect();
    let run =
        |rest: &[&str], files: &[&str]| folder.run(&[&["frame", "--setup", "setup.toml"], rest, files].concat()).stdout;
    let document: Value = serde_json::from_str(&run(&["--json"], &files)).expect("a document");
    let parse = |lines: &str| -> Vec<Value> {
        lines.lines().map(|line| serde_json::from_str(line).expect("a document")).collect()
    };
    let lines = run(&["--json-lines"], &files);
    assert_eq!(document["frames"].as_array(), Some(&parse(&lines)));
    // Outputs of several runs can be put together.
    let parts = [run(&["--json-lines"], &files[..7]), run(&["--json-lines"], &files[7..])].concat();
    assert_eq!(parts, lines);
}

#[test]
fn the_document_is_written_as_before() {
    let folder = Folder::new().with("setup.toml", SETUP).with("a.png", png(painted()));
    let outcome = folder.run(&["frame", "a.png", "a.png", "--setup", "setup.toml", "--json"]);
    let document: Value = serde_json::from_str(&outcome.stdout).expect("a document");
    let lines = outcome.stdout.lines().collect::<Vec<_>>();
    assert_eq!((lines[0], lines[1], lines[2], *lines.last().expect("lines")), ("{", "  \"frames\": [", "    {", "}"));
    assert_eq!(document["frames"][0], document["frames"][1]);
}

#[test]
fn usage_is_exit_code_2() {
    let (folder, _) = folder();
    let run = |rest: &[&str]| folder.run(&[&["frame", "f00.png", "--setup", "setup.toml"], rest].concat());
    for rest in [&["--jobs", "0"][..], &["--jobs", "-1"], &["--jobs", "many"], &["--json", "--json-lines"]] {
        assert_eq!(run(rest).code, 2, "{rest:?}");
    }
}
