use serde_json::Value;

use crate::tool::{Folder, Outcome, SETUP, assert_near, number};

pub(crate) fn simulate(folder: &Folder, rest: &[&str]) -> Outcome {
    folder.run(&[&["simulate", "--setup", "setup.toml"], rest].concat())
}

pub(crate) fn with_setup() -> Folder {
    Folder::new().with("setup.toml", SETUP)
}

pub(crate) const SCENE: &str = "\
[background]
level = 200
[[bar]]
bearing = -0.2
depth_m = 2.0
width_m = 0.1
level = 40
[[bar]]
bearing = 0.25
depth_m = 3.0
width_m = 0.2
level = 60
";

/// The bar's edges from left to right: bearing, depth and polarity.
const POINTS: [(f64, f64, &str); 4] = [
    (-0.225, 2.0, "falling"),
    (-0.175, 2.0, "rising"),
    (0.25 - 0.1 / 3.0, 3.0, "falling"),
    (0.25 + 0.1 / 3.0, 3.0, "rising"),
];

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().unwrap_or_else(|| panic!("{key} is no list: {value}"))
}

#[test]
fn what_is_simulated_is_found() {
    let folder = with_setup().with("scene.toml", SCENE);
    let printed = simulate(&folder, &["--out", "out", "--scene", "scene.toml", "--frames", "3", "--json"]).json();
    let written: Value = serde_json::from_slice(&folder.read("out/truth.json")).expect("JSON");
    assert_eq!(printed, written);
    let names = ["frame-0000.png", "frame-0001.png", "frame-0002.png"];
    assert_eq!(
        folder.files_of("out"),
        [&names[..], &["scene.toml", "setup.toml", "trajectory.csv", "truth.json"]].concat()
    );
    assert_eq!(folder.read("out/setup.toml"), SETUP.as_bytes());
    assert_eq!(folder.read("out/scene.toml"), SCENE.as_bytes());
    let files = names.map(|name| format!("out/{name}"));
    let arguments = ["frame", &files[0], &files[1], &files[2], "--setup", "out/setup.toml", "--json"];
    let found = folder.run(&arguments).json();
    for (number_of_frame, (truth, found)) in list(&printed, "frames").iter().zip(list(&found, "frames")).enumerate() {
        let (edges, ranges) = (list(truth, "edges"), list(found, "ranges"));
        assert_eq!((edges.len(), ranges.len()), (4, 4), "{ranges:?}");
        for ((edge, range), (bearing, depth_m, polarity)) in edges.iter().zip(ranges).zip(POINTS) {
            // To the left at 1.5 m/s, frame by frame.
            let bearing = bearing + 1.5 / depth_m * number_of_frame as f64 / 30.0;
            assert_near(number(edge, "bearing"), bearing, 1e-5);
            assert_near(number(edge, "depth_m"), depth_m, 1e-5);
            assert_eq!((&edge["polarity"], &edge["upright"]), (&polarity.into(), &true.into()));
            assert_eq!((&edge["first_row"], &edge["last_row"]), (&0.into(), &479.into()));
            assert_eq!((&range["polarity"], &range["status"]), (&polarity.into(), &"ok".into()));
            assert_near(number(range, "bearing"), bearing, 2e-4);
            let (rho, sigma) = (number(range, "inverse_depth_per_m"), number(range, "sigma_inverse_depth_per_m"));
            assert_near(rho, 1.0 / depth_m, 5.0 * sigma);
            assert!(sigma < 0.02 / depth_m, "{sigma}");
        }
    }
}

#[test]
fn with_a_known_exposure_the_blur_shows_a_lean() {
    // Leans as if it were three times as near, but is not blurred as much.
    let scene = SCENE.replace("level = 60", "level = 60\nlean_deg = 2");
    let exposed = SETUP.replace("fx = 600", "fx = 600\nexposure_s = 0.01\nlens_blur_px = 0.7\nresponse = \"linear\"");
    let folder = Folder::new().with("setup.toml", exposed).with("unaware.toml", SETUP).with("scene.toml", scene);
    assert_eq!(simulate(&folder, &["--out", "out", "--scene", "scene.toml"]).code, 0);
    let statuses = |setup: &str| {
        let document = folder.run(&["frame", "out/frame-0000.png", "--setup", setup, "--json"]).json();
        let ranges = list(&document["frames"][0], "ranges");
        ranges.iter().map(|range| range["status"].as_str().expect("a word").to_string()).collect::<Vec<_>>()
    };
    assert_eq!(statuses("unaware.toml"), ["ok"; 4]);
    assert_eq!(statuses("setup.toml"), ["ok", "ok", "leaning", "leaning"]);
}

#[test]
fn the_street_has_upright_and_leaning_edges() {
    let folder = with_setup();
    let truth = simulate(&folder, &["--out", "out/street", "--json"]).json();
    let edges = list(&truth["frames"][0], "edges");
    assert!(edges.len() >= 10, "{edges:?}");
    assert!(edges.iter().any(|edge| edge["upright"] == false && number(edge, "lean_deg").abs() > 1.0));
    assert!(edges.windows(2).all(|pair| number(&pair[0], "bearing") <= number(&pair[1], "bearing")));
    let text = simulate(&folder, &["--out", "out/street", "--overwrite"]).stdout;
    assert!(text.contains("leaning +2.00 deg") && text.ends_with("1 frame with truth.json in out/street\n"), "{text}");
}

#[test]
fn a_seed_repeats() {
    let folder = with_setup();
    let picture = |seed| {
        assert_eq!(simulate(&folder, &["--out", "out", "--overwrite", "--seed", seed]).code, 0);
        folder.read("out/frame-0000.png")
    };
    let first = picture("7");
    assert_ne!(picture("8"), first);
    assert_eq!(picture("7"), first);
}

#[test]
fn an_interval_of_zero_is_the_same_instant() {
    let folder = with_setup();
    let arguments = ["--out", "out", "--frames", "2", "--frame-interval-s", "0", "--json"];
    let truth = simulate(&folder, &arguments).json();
    assert_eq!(truth["frames"][0]["edges"], truth["frames"][1]["edges"]);
    assert_ne!(folder.read("out/frame-0000.png"), folder.read("out/frame-0001.png"), "noise is another");
}

/// What `frame` refuses of a sequence is not simulated.
#[test]
fn an_interval_shorter_than_the_readout_is_refused() {
    let folder = with_setup();
    let arguments = |interval| ["--frames", "2", "--frame-interval-s", interval];
    let message =
        "--frame-interval-s is 0.01, but must be at least 0.0333 s, the readout of a frame in the setup, or 0";
    refuse(&folder, &arguments("0.01"), message);
    assert_eq!(folder.files(), ["setup.toml"], "nothing is left behind");
    // Less than a line time is rounding.
    let outcome = simulate(&folder, &[&["--out", "out"], &arguments("0.03325")[..]].concat());
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
}

#[test]
fn motion_is_in_the_axes_of_each_frame() {
    let turning = SETUP.replace("[motion]", "[motion]\nrate_rad_s = [0, 0, 1.0]");
    let folder = Folder::new().with("setup.toml", turning);
    let truth = simulate(&folder, &["--out", "out", "--frames", "2", "--frame-interval-s", "0.1", "--json"]).json();
    // Clockwise by 0.1 rad about the optical axis: down turns to the right in the picture, as all directions do.
    let [gx, gy] = [0, 1].map(|axis| truth["frames"][1]["gravity"][axis].as_f64().expect("a number"));
    assert_near(gx, 0.1_f64.sin(), 1e-5);
    assert_near(gy, 0.1_f64.cos(), 1e-5);
}

#[track_caller]
fn refuse(folder: &Folder, rest: &[&str], message: &str) {
    let outcome = simulate(folder, &[&["--out", "out"], rest].concat());
    assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""));
    assert_eq!(outcome.stderr, format!("error: {message}\n"));
}

#[track_caller]
fn refuse_scene(old: &str, new: &str, message: &str) {
    let folder = with_setup().with("scene.toml", SCENE.replacen(old, new, 1));
    let outcome = simulate(&folder, &["--out", "out", "--scene", "scene.toml"]);
    assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""));
    assert!(outcome.stderr.starts_with(&format!("error: scene.toml: {message}")), "{}", outcome.stderr);
    assert_eq!(folder.files(), ["scene.toml", "setup.toml"], "nothing is left behind");
}

#[test]
fn scenes_that_are_refused() {
    refuse_scene("bearing", "bering", "line 4: unknown field `bering`, expected one of `bearing`, ");
    refuse_scene("depth_m = 2.0\n", "", "line 3: missing field `depth_m`");
    refuse_scene("depth_m = 2.0", "depth_m = 0", "[[bar]] number 1: depth_m is 0, but must be ");
    refuse_scene("level = 60", "level = 60\nlean_deg = 89", "[[bar]] number 2: lean_deg is 89, but must be -84 to 84");
    refuse_scene("level = 200", "level = 300", "[background]: level is 300, but must be 0 to 255");
    refuse_scene("[background]", "[sensor]\nread_noise = -1\n[background]", "`sensor.read_noise` is -1, but must be ");
    refuse_scene("[background]", "[lamp]\nfrequency_hz = 0\n[background]", "`lamp.frequency_hz` is 0, but must be ");
    let many = "[[rail]]\ndepth_m = 1\ntop_m = 1\nbottom_m = 2\nlevel = 0\n".repeat(63);
    refuse_scene(
        "[background]",
        &format!("{many}[background]"),
        "the scene has 65 bars and rails, but must have at most 64",
    );
}

#[test]
fn brackets_of_scenes() {
    let refuse = |scene: &str, message: &str| {
        let folder = with_setup().with("scene.toml", scene);
        let outcome = simulate(&folder, &["--out", "out", "--scene", "scene.toml"]);
        assert_eq!((outcome.code, outcome.stderr), (1, format!("error: scene.toml: {message}\n")));
    };
    for name in ["bar", "rail"] {
        let message = format!("`{name}` must be written [[{name}]], in double brackets, before each {name}");
        refuse(&format!("[background]\nlevel = 190\n[{name}]\ndepth_m = 2\n"), &message);
    }
    for name in ["background", "sensor", "lamp"] {
        let message = format!("`{name}` must be written [{name}], in single brackets, and once");
        refuse(&format!("[[{name}]]\nlevel = 190\n"), &message);
    }
}

/// The tool lists the keys of a section for one that it does not know.
#[test]
fn every_key_of_a_scene_is_in_the_help() {
    let help = Folder::new().run(&["simulate", "--help"]).stdout;
    let (_, example) = help.split_once("A scene:\n").expect("a scene");
    for header in ["[background]", "[[bar]]", "[[rail]]", "[sensor]", "[lamp]"] {
        let folder = with_setup().with("scene.toml", format!("{header}\nq = 1\n"));
        let outcome = simulate(&folder, &["--out", "out", "--scene", "scene.toml"]);
        let (_, list) = outcome.stderr.split_once("unknown field `q`, expected ").expect("a list of keys");
        let (_, section) = example.split_once(&format!("  {header}")).expect("the section");
        let section = section.split("\n  [").next().expect("its keys");
        let keys: Vec<_> = list.split('`').skip(1).step_by(2).collect();
        assert!(keys.len() >= 2, "{list}");
        for key in keys {
            assert!(section.contains(&format!("\n  {key} = ")), "{header} {key} is missing:\n{example}");
        }
    }
}

#[test]
fn setups_that_cannot_be_simulated() {
    let distorted = SETUP.replace("fx = 600", "fx = 600\ndistortion = [-0.1, 0, 0, 0, 0]");
    let message = "setup.toml: `camera.distortion` must be left out or zero: the simulated lens is a pinhole";
    refuse(&Folder::new().with("setup.toml", distorted), &[], message);
    let blurred = SETUP.replace("fx = 600", "fx = 600\nlens_blur_px = 30");
    let message = "setup.toml: `camera.lens_blur_px` is 30, but must be 0 to 20 (px)";
    refuse(&Folder::new().with("setup.toml", blurred), &[], message);
}

#[test]
fn usage_is_exit_code_2() {
    let folder = with_setup();
    for rest in [&[][..], &["--out", "out", "--frames", "0"], &["--out", "out", "--frame-interval-s", "-1"]] {
        assert_eq!(simulate(&folder, rest).code, 2, "{rest:?}");
    }
}
