//! `figures`: files that show what they say.

use crate::tool::Folder;

fn drawn() -> Folder {
    let folder = Folder::new();
    let outcome = folder.run(&["figures", "figures"]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    folder
}

fn svg(folder: &Folder, name: &str) -> String {
    String::from_utf8(folder.read(&format!("figures/{name}.svg"))).expect("UTF-8")
}

#[test]
fn all_figures_are_there() {
    let folder = drawn();
    let files = folder.files_of("figures");
    for name in ["9a", "11a", "12a", "12b", "12c", "12d", "15a", "15b", "15c", "tilt", "lidar", "budget"] {
        assert!(files.contains(&format!("{name}.svg")), "{name}");
        let svg = svg(&folder, name);
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && svg.contains("<polyline"), "{name}");
    }
    for name in ["6b", "9b", "11b"] {
        assert_eq!(&folder.read(&format!("figures/{name}.png"))[1..4], b"PNG", "{name}");
    }
}

/// One circle for each measured point of its cases, and one in the legend.
#[test]
fn measured_points_are_on_them() {
    let folder = drawn();
    for (name, points) in [("15a", 15), ("15b", 20), ("15c", 15), ("tilt", 40), ("lidar", 40)] {
        assert_eq!(svg(&folder, name).matches("<circle").count(), points + 1, "{name}");
    }
    // Two sigma of lean: a band, and its name.
    for name in ["15a", "15b", "15c", "tilt"] {
        let svg = svg(&folder, name);
        assert!(svg.contains("<polygon") && svg.contains("two sigma"), "{name}");
    }
    assert!(svg(&folder, "tilt").contains("constant tilt 0.006 ± 0.034"), "the fit of Table 2");
    assert!(svg(&folder, "lidar").contains("lidar: 0.005 m per metre"));
}

#[test]
fn a_folder_that_cannot_be_made() {
    let folder = Folder::new().with("file", "");
    let outcome = folder.run(&["figures", "file/figures"]);
    assert_eq!(outcome.code, 1);
    assert!(outcome.stderr.contains("making file/figures"), "{}", outcome.stderr);
    assert_eq!(folder.run(&["figures"]).code, 2);
}
