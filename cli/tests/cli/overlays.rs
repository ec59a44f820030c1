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
    assert!(outcome.stderr.contains("would write a.png and a.pgm to the same file, seen-a.png"), "{}", outcome.stderr);
    let outcome = frame(&folder, &["a.png", "seen-a.png", "--overlay", "seen.png"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("would replace the frame seen-a.png"), "{}", outcome.stderr);
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
        let message = format!("--overlay would replace the frame a.png: {out} is the same file");
        assert!(outcome.stderr.contains(&message), "{out}: {}", outcome.stderr);
    }
    folder.hard_link("b.png", "seen-a.png");
    let outcome = frame(&folder, &["a.png", "b.png", "--overlay", "seen.png"]);
    assert!(
        outcome.stderr.contains("would replace the frame b.png: seen-a.png is the same file"),
        "{}",
        outcome.stderr
    );
    assert_eq!((folder.read("a.png"), folder.read("b.png")), (before.clone(), before));
}

#[test]
fn two_overlays_are_not_written_to_one_file() {
    let folder = with_frame().with("b.png", png(painted())).with("seen-a.png", "");
    folder.link("seen-a.png", "seen-b.png");
    let outcome = frame(&folder, &["a.png", "b.png", "--overlay", "seen.png"]);
    assert_eq!(outcome.code, 2);
    assert!(outcome.stderr.contains("would write a.png and b.png to the same file, seen-b.png"), "{}", outcome.stderr);
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
