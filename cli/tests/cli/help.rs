//! What `--help` must not leave out.

use crate::tool::Folder;

fn help(command: &str) -> String {
    let outcome = Folder::new().run(&[command, "--help"]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    outcome.stdout
}

#[test]
fn every_status_is_explained() {
    let statuses = ["ok", "far", "slow", "inconsistent", "leaning", "moving", "bent", "cluttered", "short", "sideways"];
    for text in [help("edges"), help("frame")] {
        for status in statuses {
            let is_row =
                |line: &str| line.strip_prefix("  ").is_some_and(|line| line.starts_with(&format!("{status} ")));
            assert!(text.lines().any(is_row), "{status} is missing:\n{text}");
        }
    }
    let text = help("frame");
    let (_, overlay) = text.split_once("Overlay:\n").expect("a table of colours");
    for status in statuses {
        assert!(overlay.contains(status), "the colour of {status} is missing:\n{overlay}");
    }
}

#[test]
fn every_column_of_edges_is_explained() {
    let text = help("edges");
    for column in ["row, column", "time_s", "line", "frame", "polarity", "sigma_px", "width_px"] {
        assert!(text.lines().any(|line| line.starts_with(&format!("  {column} "))), "{column} is missing:\n{text}");
    }
}

#[test]
fn overwrite_and_interruption_are_explained() {
    let text = help("simulate");
    assert!(text.contains("--overwrite") && text.contains("after an interruption"), "{text}");
}
