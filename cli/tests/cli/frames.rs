use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb};
use serde_json::Value;

use crate::painting::{BANDS, encoded, painted, painted_by, png};
use crate::tool::{Folder, Outcome, SETUP, assert_near, number};

fn with_setup() -> Folder {
    Folder::new().with("setup.toml", SETUP)
}

fn frame(folder: &Folder, rest: &[&str]) -> Outcome {
    folder.run(&[&["frame", "--setup", "setup.toml"], rest].concat())
}

fn ranges(frame: &Value) -> &[Value] {
    frame["ranges"].as_array().expect("ranges")
}

/// Both edges of all bands, from left to right, within so many pixels.
#[track_caller]
fn assert_bands(frame: &Value, tolerance_px: f64) {
    assert_eq!(frame["torn"], false);
    let ranges = ranges(frame);
    let edges: Vec<_> =
        BANDS.iter().flat_map(|(bearings, depth_m)| bearings.map(|bearing| (bearing, depth_m))).collect();
    assert_eq!(ranges.len(), edges.len(), "{ranges:?}");
    for (index, (range, (bearing, depth_m))) in ranges.iter().zip(edges).enumerate() {
        assert_eq!(range["status"], "ok", "{range}");
        assert_eq!(range["polarity"], ["falling", "rising"][index % 2]);
        assert_near(number(range, "bearing"), bearing, tolerance_px / 600.0);
        // Over the frame, the edge moves by this many pixels.
        let way_px = 600.0 * 1.5 * 0.0333 / depth_m;
        assert_near(1.0 / (number(range, "inverse_depth_per_m") * depth_m), 1.0, 2.0 * tolerance_px / way_px);
    }
}

/// The only frame of the document for a file of that content.
#[track_caller]
fn only(content: Vec<u8>, rest: &[&str]) -> Value {
    let folder = with_setup().with("picture", content);
    let mut document = frame(&folder, &[&["picture", "--json"], rest].concat()).json();
    assert_eq!(document["frames"].as_array().map(Vec::len), Some(1));
    assert_eq!(document["frames"][0]["name"], "picture");
    document["frames"][0].take()
}

#[test]
fn grey_pictures() {
    assert_bands(&only(png(painted()), &[]), 0.05);
    assert_bands(&only(encoded(painted(), ImageFormat::Pnm), &[]), 0.05);
    assert_bands(&only(painted().into_raw(), &["--raw", "640x480"]), 0.05);
    let mut jpeg = Vec::new();
    painted().write_with_encoder(JpegEncoder::new_with_quality(&mut jpeg, 95)).expect("encoding a JPEG");
    assert_bands(&only(jpeg, &[]), 0.2);
}

/// As a sensor delivers it that makes two bytes of a pixel.
#[test]
fn dumps_in_other_formats() {
    let png = only(png(painted()), &[]);
    let grey = painted().into_raw();
    let yuyv = grey.iter().flat_map(|level| [*level, 128]).collect();
    let uyvy = grey.iter().flat_map(|level| [128, *level]).collect();
    let wide = grey.iter().flat_map(|level| (u16::from(*level) << 2).to_le_bytes()).collect();
    assert_eq!(only(grey.clone(), &["--raw", "640x480:gray8"]), png);
    assert_eq!(only(yuyv, &["--raw", "640x480:yuyv"]), png);
    assert_eq!(only(uyvy, &["--raw", "640x480:uyvy"]), png);
    assert_eq!(only(wide, &["--raw", "640x480:gray10le"]), png);
    // Of one colour as of two.
    assert_bands(&only(grey, &["--raw", "640x480:bayer8"]), 0.05);
}

/// What the simulator dumps is what `frame` reads, in a format with fewer bytes than pixels have bits for.
#[test]
fn simulated_dumps() {
    let folder = with_setup();
    folder.run(&["simulate", "--setup", "setup.toml", "--out", "out", "--raw", "gray10p", "--json"]).json();
    let dump = folder.read("out/frame-0000.raw");
    assert_eq!(dump.len(), 640 * 480 / 4 * 5);
    let options = ["out/frame-0000.raw", "--raw", "640x480:gray10p", "--json"];
    let document = frame(&folder, &options).json();
    let found = document["frames"][0]["ranges"].as_array().map_or(0, Vec::len);
    assert!(found >= 4, "{document}");
}

#[test]
fn formats_agree_to_the_last_digit() {
    let png = only(png(painted()), &[]);
    assert_eq!(only(encoded(painted(), ImageFormat::Pnm), &[]), png);
    assert_eq!(only(painted().into_raw(), &["--raw", "640x480"]), png);
    assert_eq!(only(encoded(DynamicImage::from(painted()).into_rgb8(), ImageFormat::Pnm), &[]), png);
    // Each grey value of 8 bits has its own among those of 16.
    assert_eq!(only(encoded(DynamicImage::from(painted()).into_luma16(), ImageFormat::Png), &[]), png);
}

#[test]
fn colour_becomes_luma() {
    // Red on green that is three times as bright: the same steps the other way round would follow from red alone.
    let grey = painted();
    let coloured = ImageBuffer::from_fn(640, 480, |x, y| {
        let [grey] = grey.get_pixel(x, y).0;
        Rgb([240 - grey, grey, 90_u8])
    });
    assert_bands(&only(png(coloured), &[]), 0.1);
}

#[test]
fn white_is_what_the_file_says() {
    // 10 bits, as machine-vision cameras write them.
    let mut file = b"P5 640 480 1023\n".to_vec();
    file.extend(painted().as_raw().iter().flat_map(|grey| (u16::from(*grey) * 4).to_be_bytes()));
    let frame = only(file, &[]);
    assert_bands(&frame, 0.05);
    let mut coarse = b"P5\n640 480\n100\n".to_vec();
    coarse.extend(painted().as_raw().iter().map(|grey| (u16::from(*grey) * 100 / 255) as u8));
    assert_bands(&only(coarse, &[]), 0.1);
}

/// Grey levels of so many bits, in a container of 16.
fn of_bits(bits: u32) -> ImageBuffer<Luma<u16>, Vec<u16>> {
    let most = (1_u32 << bits) - 1;
    let painted = painted();
    let level = |x, row| (u32::from(painted.get_pixel(x, row).0[0]) * most / 255) as u16;
    ImageBuffer::from_fn(640, 480, |x, row| Luma([level(x, row)]))
}

#[test]
fn levels_of_more_bits_are_scaled_by_their_own_range() {
    let eight = only(png(painted()), &[]);
    for bits in [10, 12, 14, 16] {
        let setup = SETUP.replace("fx = 600", &format!("fx = 600\nbits = {bits}"));
        for format in [ImageFormat::Png, ImageFormat::Pnm] {
            let folder = Folder::new().with("setup.toml", &setup).with("picture", encoded(of_bits(bits), format));
            let document = frame(&folder, &["picture", "--json"]).json();
            assert_eq!(document["frames"][0], eight, "{bits} bits");
        }
    }
    // A file that states its range needs no more.
    let setup = SETUP.replace("fx = 600", "fx = 600\nbits = 10");
    let mut file = b"P5 640 480 1023\n".to_vec();
    file.extend(of_bits(10).as_raw().iter().flat_map(|level| level.to_be_bytes()));
    let folder = Folder::new().with("setup.toml", setup).with("picture", file).with("8bit.png", png(painted()));
    let document = frame(&folder, &["picture", "8bit.png", "--json"]).json();
    assert_eq!(
        (&document["frames"][0]["ranges"], &document["frames"][1]["ranges"]),
        (&eight["ranges"], &eight["ranges"])
    );
}

#[test]
fn levels_of_more_bits_than_the_setup_says_are_refused() {
    let setup = SETUP.replace("fx = 600", "fx = 600\nbits = 10");
    let levels = of_bits(12);
    let most = levels.iter().max().expect("pixels");
    let folder = Folder::new().with("setup.toml", setup).with("picture", encoded(levels.clone(), ImageFormat::Png));
    let outcome = frame(&folder, &["picture"]);
    let limit = "but must be at most 1023 (`camera.bits` of the setup is 10)";
    assert_eq!((outcome.code, outcome.stderr), (1, format!("error: picture: a grey level is {most}, {limit}\n")));
}

#[test]
fn an_overlay_shows_levels_of_ten_bits_as_bright_as_they_are() {
    let setup = SETUP.replace("fx = 600", "fx = 600\nbits = 10");
    let folder = Folder::new().with("setup.toml", setup).with("a.png", encoded(of_bits(10), ImageFormat::Png));
    assert_eq!(frame(&folder, &["a.png", "--overlay", "seen.png"]).code, 0);
    let seen = image::load_from_memory(&folder.read("seen.png")).expect("a picture").into_rgb8();
    assert_eq!(seen.get_pixel(639, 0).0, [painted().get_pixel(639, 0).0[0]; 3]);
}

#[test]
fn bottom_to_top() {
    let setup = SETUP.replace("fx = 600", "fx = 600\ndirection = \"bottom-to-top\"");
    let folder = Folder::new().with("setup.toml", setup).with("up.png", png(painted_by(|row| 479 - row)));
    let document = frame(&folder, &["up.png", "--json"]).json();
    assert_bands(&document["frames"][0], 0.05);
    // With the wrong direction, the slopes are against the motion.
    let folder = with_setup().with("up.png", png(painted_by(|row| 479 - row)));
    let document = frame(&folder, &["up.png", "--json"]).json();
    assert!(ranges(&document["frames"][0]).iter().all(|range| range["status"] == "inconsistent"), "{document}");
}

#[test]
fn frames_are_independent_of_each_other() {
    let empty = ImageBuffer::from_pixel(640, 480, Luma([128_u8]));
    let folder = with_setup().with("a.png", png(painted())).with("b.png", png(empty));
    let document = frame(&folder, &["b.png", "a.png", "b.png", "a.png", "--json"]).json();
    let frames = document["frames"].as_array().expect("frames");
    let names: Vec<_> = frames.iter().map(|frame| frame["name"].as_str().expect("a name")).collect();
    assert_eq!(names, ["b.png", "a.png", "b.png", "a.png"]);
    assert_eq!((&frames[0], &frames[1]), (&frames[2], &frames[3]));
    assert!(ranges(&frames[0]).is_empty());
    assert_bands(&frames[1], 0.05);
    assert_eq!(frame(&folder, &["a.png", "--json"]).json()["frames"][0], frames[1]);
}

#[test]
fn a_bad_file_does_not_stop_the_others() {
    let folder = with_setup().with("a.png", png(painted())).with("b.png", "no picture").with("c.png", png(painted()));
    let outcome = frame(&folder, &["a.png", "b.png", "missing.png", "c.png", "--json"]);
    assert_eq!(outcome.code, 1);
    let document = outcome.document();
    let names: Vec<_> = document["frames"].as_array().expect("frames").iter().map(|frame| &frame["name"]).collect();
    assert_eq!(names, ["a.png", "c.png"]);
    let errors: Vec<_> = outcome.stderr.lines().collect();
    assert_eq!(errors.len(), 2, "{errors:?}");
    assert!(errors[0].starts_with("error: b.png: the file is no PNG, JPEG, BMP or PGM/PPM"), "{errors:?}");
    assert!(errors[1].starts_with("error: reading missing.png: "), "{errors:?}");
}

/// Exit code 1, nothing on standard output, and one line that begins so.
#[track_caller]
fn refuse(content: Vec<u8>, rest: &[&str], message: &str) {
    let outcome = frame(&with_setup().with("picture", content), &[&["picture"], rest].concat());
    assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""));
    assert!(outcome.stderr.starts_with(&format!("error: {message}")), "{}", outcome.stderr);
    assert_eq!(outcome.stderr.lines().count(), 1);
}

#[test]
fn files_cut_short() {
    let jpeg = encoded(painted(), ImageFormat::Jpeg);
    for (content, message) in [
        (png(painted()), "picture: the file is truncated or damaged: "),
        (encoded(painted(), ImageFormat::Pnm), "picture: the file is truncated or damaged: "),
        (jpeg, "picture: the file is truncated: a JPEG must have an end marker"),
    ] {
        refuse(content[..content.len() * 2 / 3].to_vec(), &[], message);
        refuse(content[..9].to_vec(), &[], "picture: the file is truncated or damaged: ");
    }
    refuse(Vec::new(), &[], "picture: the file is empty");
}

#[test]
fn frames_of_another_size() {
    let small = || ImageBuffer::from_pixel(320, 240, Luma([128_u8]));
    let camera = "(`camera.columns` × `camera.rows` of the setup)\n";
    let message = format!("picture: the frame is 320 × 240 pixels, but must be 640 × 480 {camera}");
    refuse(png(small()), &[], &message);
    refuse(encoded(small(), ImageFormat::Pnm), &[], &message);
    refuse(encoded(small(), ImageFormat::Jpeg), &[], &message);
    let message = format!("--raw says 320 × 240 pixels, but must say 640 × 480 {camera}");
    refuse(small().into_raw(), &["--raw", "320x240"], &message);
    // As many pixels, but lying on its side.
    refuse(png(ImageBuffer::from_pixel(480, 640, Luma([128_u8]))), &[], "picture: the frame is 480 × 640 pixels");
}

#[test]
fn dumps_of_another_size() {
    for bytes in [0, 307_199, 307_201, 614_400] {
        let message = format!("picture: the file has {bytes} bytes, but --raw 640 × 480 must have 307200\n");
        refuse(vec![128; bytes], &["--raw", "640x480"], &message);
    }
}

#[test]
fn a_second_frame_in_a_netpbm_file_is_refused() {
    let rule =
        "bytes are left after the first frame, but a file must hold one frame: split it (netpbm's pamsplit does)";
    let grey = encoded(painted(), ImageFormat::Pnm);
    let colour = encoded(DynamicImage::from(painted()).into_rgb8(), ImageFormat::Pnm);
    for frame in [grey, colour] {
        refuse([&frame[..], &frame].concat(), &[], &format!("picture: {} {rule}\n", frame.len()));
        refuse([&frame[..], b"\n"].concat(), &[], &format!("picture: 1 {rule}\n"));
    }
}

#[test]
fn a_netpbm_file_of_text_may_end_in_blank_lines() {
    let numbers = painted().as_raw().iter().map(|grey| format!("{grey}\n")).collect::<String>();
    let text = format!("P2\n640 480\n255\n{numbers}");
    assert_bands(&only(text.clone().into_bytes(), &[]), 0.05);
    assert_bands(&only(format!("{text} \n\n").into_bytes(), &[]), 0.05);
    let twice = format!("{text}{text}");
    let left = text.len();
    refuse(twice.into_bytes(), &[], &format!("picture: {} bytes are left after the first frame", left - 1));
}

#[test]
fn text_names_each_frame() {
    let folder = with_setup().with("a.png", png(painted())).with("b.png", png(painted()));
    let outcome = frame(&folder, &["a.png", "b.png"]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    let named: Vec<_> = outcome.stdout.lines().filter(|line| line.ends_with(".png")).collect();
    assert_eq!(named, ["a.png", "b.png"]);
    assert_eq!(outcome.stdout.lines().filter(|line| line.ends_with("  ok")).count(), 12);
}

#[test]
fn usage_is_exit_code_2() {
    let folder = with_setup().with("a.png", png(painted()));
    for rest in [
        &[][..],
        &["a.png", "--raw", "640"],
        &["a.png", "--raw", "640x0"],
        &["a.png", "--raw", "640x480x3"],
        &["a.png", "--raw", "640x480:jpeg"],
        &["a.png", "--raw", "642x480:gray10p"],
        &["a.png", "--overlay", "seen.jpg"],
        &["a.png", "--overlay", "a.png"],
        &["a.png", "--overlay", "./a.png"],
    ] {
        let outcome = frame(&folder, rest);
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{rest:?}: {}", outcome.stderr);
    }
}
