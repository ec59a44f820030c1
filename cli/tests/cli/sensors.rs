use crate::tool::{Folder, assert_near, number};

#[test]
fn json_has_every_mode_with_the_keys_that_are_promised() {
    let document = Folder::new().run(&["sensors", "--json"]).json();
    let modes = document["modes"].as_array().expect("modes");
    assert!(modes.len() >= 20);
    for mode in modes {
        let keys: Vec<_> = mode.as_object().expect("an object").keys().map(String::as_str).collect();
        let mut sorted = ["sensor", "mode", "line_time_us", "readout_s", "source", "kind"];
        sorted.sort_unstable();
        assert!(keys.len() == 6 && sorted.iter().all(|key| keys.contains(key)), "{keys:?}");
        let kind = mode["kind"].as_str().expect("a word");
        assert!(["measured", "computed", "documented"].contains(&kind), "{kind}");
        let (line_time_us, readout_s) = (number(mode, "line_time_us"), number(mode, "readout_s"));
        assert!((10.0..1000.0).contains(&line_time_us) && (0.004..0.3).contains(&readout_s), "{mode}");
    }
    let cif = modes.iter().find(|mode| mode["sensor"] == "OV2640" && mode["kind"] == "measured").expect("measured CIF");
    assert_near(number(cif, "line_time_us"), 59.5, 1e-9);
    assert_near(number(cif, "readout_s"), 0.017_612, 1e-9);
}

#[test]
fn text_has_a_line_for_each_mode() {
    let outcome = Folder::new().run(&["sensors"]);
    assert_eq!(outcome.code, 0);
    let lines = |kind: &str| outcome.stdout.lines().filter(|line| line.contains(kind)).count();
    let document = Folder::new().run(&["sensors", "--json"]).json();
    let modes = document["modes"].as_array().expect("modes");
    assert_eq!(lines("  measured  ") + lines("  computed  ") + lines("  documented  "), modes.len());
    assert!(outcome.stdout.contains("OV7725"), "{}", outcome.stdout);
    assert!(!outcome.stdout.contains('\x1b'), "no colours into a pipe");
}
