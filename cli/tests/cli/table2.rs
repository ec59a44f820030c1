use crate::tool::{Folder, assert_near, number};

#[test]
fn json_has_forty_rows_and_the_summary() {
    let document = Folder::new().run(&["table2", "--json"]).json();
    let rows = document["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 40);
    assert_eq!(rows.iter().filter(|row| row["follows"] == true).count(), 33);
    assert_near(number(&rows[0], "computed_m"), 5.2195, 5e-5);
    assert_eq!(number(&rows[35], "readout_s"), 1.0 / 60.0);
    assert_near(number(&document, "rms_error_m"), 0.238, 5e-4);
    assert_near(number(&document, "published_rms_error_m"), 0.272, 5e-4);
    assert_eq!(number(&document, "kappa"), 2.361);
}

#[test]
fn json_keys_are_as_promised() {
    let text = Folder::new().run(&["--json", "table2"]).stdout;
    let keys = [
        "rows",
        "case",
        "readout_s",
        "speed_m_s",
        "rse_deg",
        "gps_m",
        "published_m",
        "computed_m",
        "follows",
        "rms_error_m",
        "published_rms_error_m",
        "kappa",
    ];
    let last = |key: &&str| text.rfind(&format!("\"{key}\": "));
    let places: Vec<_> = keys.iter().map(last).collect();
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?}");
}

#[test]
fn text_names_what_does_not_follow() {
    let outcome = Folder::new().run(&["table2"]);
    assert_eq!(outcome.code, 0);
    let text = outcome.stdout;
    assert_eq!(text.lines().filter(|line| line.ends_with("  yes")).count(), 33);
    assert_eq!(text.lines().filter(|line| line.ends_with("  no *")).count(), 7);
    for line in [
        "  case 4, row 1: 4.20 deg (printed 4.40)",
        "  case 5, row 1: 2.97 deg (printed 3.01)",
        "  case 6, row 4: 1.95 deg (printed 1.85)",
        "  case 7, row 2: 10.36 deg (printed 10.46)",
        "  case 7, row 3: 12.27 deg (printed 12.15)",
        "  case 7, row 4: 11.42 deg (printed 11.98)",
        "  case 7, row 5: 11.25 deg (printed 11.52)",
        "RMS error against GPS: computed 0.238 m, published 0.272 m (40 measurements)",
    ] {
        assert!(text.lines().any(|other| other == line), "{line} is missing:\n{text}");
    }
    assert!(!text.contains('\x1b'), "no colours into a pipe");
}
