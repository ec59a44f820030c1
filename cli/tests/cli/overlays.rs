use image::{ImageFormat, RgbImage};

use crate::painting::{BANDS, painted, png};
use crate::tool::{Folder, Outcome, SETUP, column};

fn with_frame() -> Folder {
    Folder::new().with("setup.toml", SETUP).with("a.png", png(painted()))
}

fn frame(folder: &Folder, rest: &[&str]) -> Outcome {
    folder.run(&[&["frame", "--setup", "setup.toml"], rest].concat())
}

fn picture(folder: &Folder, name: &str) -> RgbImage {
    let bytes = folder.read(name);
    image::load_from_memory_with_format(&bytes, ImageFormat::Png).expect("a PNG").into_rgb8()
}

fn is_green(pixel: [u8; 3]) -> bool {
    let [red, green, blue] = pixel;
    green > red && green > blue
}

#[test]
fn edges_are_drawn_where_they_are() {
    let folder = with_frame();
    let outcome = frame(&folder, &["a.png", "--overlay", "seen.png"]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    let drawn = picture(&folder, "seen.png");
    assert_eq!(drawn.dimensions(), (640, 480));
    for (bearings, depth_m) in BANDS {
        for (bearing, row) in bearings.into_iter().flat_map(|bearing| [10, 120, 360, 470].map(|row| (bearing, row))) {
            let x = column(bearing, depth_m, row).round() as u32;
            let near = (x - 1..=x + 1).filter(|x| is_green(drawn.get_pixel(*x, row).0));
            assert!(near.count() >= 2, "bearing {bearing}, row {row}");
        }
    }
    // Beside lines and labels, the picture is as it was.
    let original = painted();
    for (x, y, pixel) in drawn.enumerate_pixels().filter(|(x, ..)| *x < 60 || *x > 620) {
        let [grey] = original.get_pixel(x, y).0;
        assert_eq!(pixel.0, [grey; 3], "column {x}, row {y}");
    }
}

#[test]
fn each_distance_has_a_label() {
    let folder = with_frame();
    frame(&folder, &["a.png", "--overlay", "seen.png"]);
    let drawn = picture(&folder, "seen.png");
    let dark = drawn.pixels().filter(|pixel| pixel.0 == [16; 3]).count();
    // Six boxes of at least 8 characters of 6 × 7 pixels, of which ink takes less than half.
    assert!(dark > 6 * 8 * 21, "{dark}");
}

#[test]
fn what_is_far_is_blue() {
    // What is not sheared is at infinity.
    let vertical = image::GrayImage::from_fn(640, 480, |x, _| image::Luma([if x < 320 { 50 } else { 200 }]));
    let folder = Folder::new().with("setup.toml", SETUP).with("far.png", png(vertical));
    let outcome = frame(&folder, &["far.png", "--overlay", "seen.png"]);
    assert!(outcome.stdout.contains("far\n"), "{}", outcome.stdout);
    let [red, green, blue] = picture(&folder, "seen.png").get_pixel(320, 20).0;
    assert!(blue > red && blue > green);
}

#[test]
fn several_frames_have_one_each() {
    let folder = with_frame().with("b.pgm", crate::painting::encoded(painted(), ImageFormat::Pnm)).with("bad.png", "");
    let outcome = frame(&folder, &["a.png", "bad.png", "b.pgm", "--overlay", "seen.png"]);
    assert_eq!(outcome.code, 1);
    assert_eq!(folder.files(), ["a.png", "b.pgm", "bad.png", "seen-a.png", "seen-b.png", "setup.toml"]);
    assert_eq!(folder.read("seen-a.png"), folder.read("seen-b.png"));
}

#[test]
fn overlays_that_would_replace_each_other_or_a_frame() {
    let folder = with_frame().with("a.pgm", "").with("seen-a.png", "");
    let outcome = frame(&folder, &["a.png", "a.pgm", "--overlay", "seen.png"]);
    assert_eq!(outcome.code, 2);
    assert!(
        outcome.stderr.contains("--overlay of a.png and --overlay of a.pgm would be written to one file, seen-a.png"),
        "{}",
        outcome.stderr
    );
    let outcome = frame(&folder, &["a.png", "seen-a.png", "--overlay", "seen.png"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("--overlay of a.png would replace seen-a.png"), "{}", outcome.stderr);
}

/// However it is spelt.
#[test]
fn a_frame_is_never_replaced_by_an_overlay() {
    let folder = with_frame().with("b.png", png(painted()));
    folder.make("sub");
    folder.hard_link("a.png", "hard.png");
    folder.link("a.png", "soft.png");
    folder.link("soft.png", "softer.png");
    let before = folder.read("a.png");
    for out in ["a.png", "./a.png", "sub/../a.png", "hard.png", "soft.png", "softer.png"] {
        let outcome = frame(&folder, &["a.png", "--overlay", out]);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{out}");
        let message = format!("--overlay would replace a.png: {out} is the same file");
        assert!(outcome.stderr.contains(&message), "{out}: {}", outcome.stderr);
    }
    folder.hard_link("b.png", "seen-a.png");
    let outcome = frame(&folder, &["a.png", "b.png", "--overlay", "seen.png"]);
    assert!(
        outcome.stderr.contains("--overlay of a.png would replace b.png: seen-a.png is the same file"),
        "{}",
        outcome.stderr
    );
    assert_eq!((folder.read("a.png"), folder.read("b.png")), (before.clone(), before));
}

/// How many frames it has shows only when they come: each name with a number may be one of theirs.
#[test]
fn overlays_of_a_video_replace_no_frame_and_no_other_overlay() {
    let video = [b"YUV4MPEG2 W640 H480 Cmono\nFRAME\n".to_vec(), painted().into_raw()].concat();
    let folder =
        with_frame().with("v.y4m", video).with("q-v-0000.png", png(painted())).with("v-0001.png", png(painted()));
    folder.hard_link("a.png", "h-v-0000.png");
    let before = folder.read("a.png");
    for (files, out, message) in [
        (&["v.y4m", "q-v-0000.png"][..], "q.png", "--overlay of v.y4m would replace q-v-0000.png: q-v-0000.png is the"),
        (&["q-v-0000.png", "v.y4m"], "./q.png", "--overlay of v.y4m would replace q-v-0000.png: ./q-v-0000.png is the"),
        (&["v.y4m", "a.png"], "h.png", "--overlay of v.y4m would replace a.png: h-v-0000.png is the"),
        (
            &["v.y4m", "v-0001.png"],
            "z.png",
            "--overlay of v.y4m and --overlay of v-0001.png would be written to one file",
        ),
        (
            &["v-0001.png", "v.y4m"],
            "z.png",
            "--overlay of v.y4m and --overlay of v-0001.png would be written to one file",
        ),
        (&["v.y4m", "./v.y4m"], "z.png", "would be written to one file, z-v.png"),
    ] {
        let outcome = frame(&folder, &[files, &["--overlay", out]].concat());
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{files:?}");
        assert!(outcome.stderr.contains(message), "{files:?}: {}", outcome.stderr);
    }
    assert_eq!((folder.read("a.png"), folder.read("q-v-0000.png")), (before.clone(), before));
    // Names that are none of theirs, or an earlier run's.
    for rest in [&["a.png", "--overlay", "y.png"][..], &["--overlay", "q-v.png"]] {
        assert_eq!(frame(&folder, &[&["v.y4m"], rest].concat()).code, 0, "{rest:?}");
    }
}

/// Whatever it is that is read, and whatever writes.
#[test]
fn no_output_replaces_an_input() {
    let drive = "time_s,vx\n-1,-1.5\n1,-1.5\n";
    let passes = "speed_m_s,distance_m,slope\n1,2,0.03\n-1,2,-0.03\n";
    let folder = with_frame()
        .with("drive.html", drive)
        .with("times.svg", "time_s\n0\n")
        .with("s.svg", SETUP)
        .with("p.svg", passes)
        .with("f.svg", png(painted()));
    let frame = ["frame", "a.png", "--setup", "setup.toml"];
    let sequence = [&frame[..], &["--frame-times", "times.svg", "--trajectory", "drive.html"]].concat();
    for (arguments, message) in [
        ([&sequence[..], &["--report", "drive.html"]].concat(), "--report would replace drive.html: drive.html is"),
        ([&sequence[..], &["--map", "./times.svg"]].concat(), "--map would replace times.svg: ./times.svg is"),
        (vec!["frame", "a.png", "--setup", "s.svg", "--map", "s.svg"], "--map would replace s.svg"),
        (vec!["plan", "--setup", "setup.toml", "--setup", "s.svg", "--svg", "s.svg"], "--svg would replace s.svg"),
        (vec!["calibrate", "scale", "p.svg", "--svg", "p.svg"], "--svg would replace p.svg"),
        (vec!["calibrate", "flicker", "f.svg", "a.png", "--frequency-hz", "100", "--svg", "f.svg"], "replace f.svg"),
        ([&["calibrate", "imu"], &sequence[1..], &["--svg", "times.svg"]].concat(), "--svg would replace times.svg"),
    ] {
        let outcome = folder.run(&arguments);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{arguments:?}: {}", outcome.stderr);
        assert!(outcome.stderr.contains(message), "{arguments:?}: {}", outcome.stderr);
    }
    assert_eq!((folder.read("drive.html"), folder.read("s.svg")), (drive.into(), SETUP.into()));
    assert_eq!((folder.read("times.svg"), folder.read("p.svg")), (b"time_s\n0\n".to_vec(), passes.into()));
    folder.link("s.svg", "both.html");
    let outcome = folder.run(&[&frame[..], &["--map", "s.svg", "--report", "both.html"]].concat());
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("--report and --map would be written to one file, s.svg"), "{}", outcome.stderr);
}

#[test]
fn two_overlays_are_not_written_to_one_file() {
    let folder = with_frame().with("b.png", png(painted())).with("seen-a.png", "");
    folder.link("seen-a.png", "seen-b.png");
    let outcome = frame(&folder, &["a.png", "b.png", "--overlay", "seen.png"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("would be written to one file, seen-b.png"), "{}", outcome.stderr);
}

#[test]
fn an_overlay_replaces_an_earlier_one_also_behind_a_link() {
    let folder = with_frame().with("earlier.png", "an earlier one");
    folder.link("earlier.png", "seen.png");
    assert_eq!(frame(&folder, &["a.png", "--overlay", "seen.png"]).code, 0);
    assert_eq!(picture(&folder, "earlier.png").dimensions(), (640, 480));
    assert_eq!(folder.files(), ["a.png", "earlier.png", "seen.png", "setup.toml"]);
}

#[test]
fn an_overlay_that_cannot_be_written() {
    let outcome = frame(&with_frame(), &["a.png", "--overlay", "none/seen.png"]);
    assert_eq!(outcome.code, 1);
    assert!(outcome.stderr.starts_with("error: writing none/seen.png: "), "{}", outcome.stderr);
    assert!(outcome.stdout.starts_with("a.png\n"), "what was found counts all the same");
}

#[test]
fn pictures_of_all_sizes() {
    for (columns, rows) in [(16, 9), (100, 1), (1, 100), (801, 20), (2000, 50)] {
        let size = format!("columns = {columns}\nrows = {rows}");
        let setup = SETUP.replace("columns = 640\nrows = 480", &size);
        let picture =
            image::GrayImage::from_fn(columns, rows, |x, _| image::Luma([if x < columns / 2 { 50 } else { 200 }]));
        let folder = Folder::new().with("setup.toml", setup).with("a.png", png(picture));
        let outcome = frame(&folder, &["a.png", "--overlay", "seen.png"]);
        assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""), "{size}");
    }
}
