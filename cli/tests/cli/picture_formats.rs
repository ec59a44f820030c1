//! Pictures as cameras deliver them: frames of a motion JPEG, BMP, and files that lack a part.

use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, GrayImage, ImageFormat};
use serde_json::Value;

use crate::painting::{encoded, painted, png};
use crate::tool::{Folder, Outcome, SETUP};

fn run(content: impl AsRef<[u8]>) -> Outcome {
    let folder = Folder::new().with("setup.toml", SETUP).with("picture", content);
    folder.run(&["frame", "picture", "--setup", "setup.toml", "--json"])
}

fn frame(content: impl AsRef<[u8]>) -> Value {
    run(content).json()["frames"][0].clone()
}

fn jpeg(picture: impl Into<DynamicImage>) -> Vec<u8> {
    let mut file = Vec::new();
    picture.into().write_with_encoder(JpegEncoder::new_with_quality(&mut file, 90)).expect("encoding a JPEG");
    file
}

/// Each segment before the pixels, and the rest with the pixels.
fn segments(jpeg: &[u8]) -> (Vec<Vec<u8>>, Vec<u8>) {
    let (mut at, mut found) = (2, vec![jpeg[..2].to_vec()]);
    while jpeg[at + 1] != 0xDA {
        let length = 2 + usize::from(u16::from_be_bytes([jpeg[at + 2], jpeg[at + 3]]));
        found.push(jpeg[at..at + length].to_vec());
        at += length;
    }
    (found, jpeg[at..].to_vec())
}

fn without_tables(jpeg: &[u8]) -> Vec<u8> {
    let (segments, rest) = segments(jpeg);
    let kept: Vec<_> = segments.iter().filter(|segment| segment.get(1) != Some(&0xC4)).cloned().collect();
    assert!(kept.len() < segments.len(), "tables to leave out");
    [kept.concat(), rest].concat()
}

#[test]
fn frames_of_a_motion_jpeg_have_the_usual_tables() {
    for picture in [DynamicImage::from(painted()), DynamicImage::from(painted()).into_rgb8().into()] {
        let whole = jpeg(picture);
        assert_eq!(frame(without_tables(&whole)), frame(&whole));
    }
}

#[test]
fn bmp() {
    assert_eq!(frame(encoded(painted(), ImageFormat::Bmp)), frame(png(painted())));
    let colour = DynamicImage::from(painted()).into_rgb8();
    assert_eq!(frame(encoded(colour.clone(), ImageFormat::Bmp)), frame(png(colour)));
}

#[track_caller]
fn refuse(content: impl AsRef<[u8]>, message: &str) {
    let outcome = run(content);
    assert_eq!((outcome.code, outcome.document()["frames"].as_array().map(Vec::len)), (1, Some(0)));
    assert!(outcome.stderr.starts_with("error: picture: ") && outcome.stderr.contains(message), "{}", outcome.stderr);
}

/// Whatever is missing where: an error, and never a picture with a part that nobody has seen.
#[test]
fn a_jpeg_that_lacks_a_part_is_an_error() {
    let whole = jpeg(painted());
    for kept in [3, 20, 300, whole.len() / 3, whole.len() / 2, whole.len() - 3] {
        refuse(&whole[..kept], "truncated");
        let bare = without_tables(&whole);
        refuse(&bare[..kept.min(bare.len() - 3)], "truncated");
    }
}

/// It has its end marker, but not all of its pixels: where the loss is, nobody knows.
#[test]
fn a_jpeg_that_has_lost_bytes_is_torn() {
    let restarts = |whole: &[u8]| whole.windows(2).filter(|pair| matches!(pair, [0xFF, 0xD0..=0xD7])).count();
    for picture in [DynamicImage::from(painted()), DynamicImage::from(painted()).into_rgb8().into()] {
        let whole = jpeg(picture);
        assert_eq!(restarts(&whole), 0);
        let middle = whole.len() / 2;
        let ended_early = [&whole[..middle], &[0xFF, 0xD9]].concat();
        // Of a few bytes, as many blocks may be left by chance.
        let lost = [200, 512, 2000].map(|bytes| [&whole[..middle], &whole[middle + bytes..]].concat());
        for file in lost.into_iter().chain([ended_early.clone(), without_tables(&ended_early)]) {
            let outcome = run(file);
            if outcome.code == 1 {
                assert!(outcome.stderr.contains("truncated or damaged"), "{}", outcome.stderr);
                continue;
            }
            let frame = outcome.json()["frames"][0].clone();
            assert_eq!((&frame["torn"], frame["ranges"].as_array().map(Vec::len)), (&true.into(), Some(0)), "{frame}");
            assert!(frame["hints"][0].as_str().is_some_and(|hint| hint.starts_with("bytes of this JPEG were lost")));
        }
        assert_eq!(frame(&whole)["torn"], false);
    }
}

#[test]
fn a_bmp_that_is_wrong_is_an_error() {
    let whole = encoded(painted(), ImageFormat::Bmp);
    for kept in [2, 20, 60, whole.len() / 2, whole.len() - 1] {
        refuse(&whole[..kept], "truncated or damaged");
    }
    let mut wrong = whole.clone();
    wrong[28] = 7; // bits of a pixel
    refuse(wrong, "truncated or damaged");
    refuse(encoded(GrayImage::new(640, 479), ImageFormat::Bmp), "the frame is 640 × 479 pixels, but must be 640 × 480");
    refuse("BM", "truncated or damaged");
}

/// One after the other, as a camera that streams motion JPEG writes them: which one is meant?
#[test]
fn a_file_of_two_pictures_is_refused() {
    let other = GrayImage::from_pixel(640, 480, image::Luma([90]));
    for (first, second) in [
        (jpeg(painted()), jpeg(other.clone())),
        (png(painted()), png(other.clone())),
        (encoded(painted(), ImageFormat::Bmp), encoded(other, ImageFormat::Bmp)),
    ] {
        let alone = frame(&first);
        for padding in [0, 1, 509] {
            let padded = [&first[..], &vec![0; padding]].concat();
            assert_eq!(frame(&padded), alone, "padding is no picture");
            let message = format!("another picture begins at byte {}, but a file must hold one frame", padded.len());
            refuse([&padded[..], &second].concat(), &message);
        }
        assert_eq!(frame([&first[..], b"\0\0\0\x18ftypmp42 a clip"].concat()), alone, "a clip is no picture");
    }
    refuse([without_tables(&jpeg(painted())), without_tables(&jpeg(painted()))].concat(), "another picture begins");
    // A picture that lists others in its file is the one to look at.
    let whole = jpeg(painted());
    let listing = [&whole[..2], b"\xFF\xE2\x00\x08MPF\0ab", &whole[2..]].concat();
    assert_eq!(frame([&listing[..], &whole].concat()), frame(&whole));
}

#[test]
fn what_is_wrong_with_a_file_is_told_once() {
    let mut damaged = png(painted());
    damaged[60..200].fill(0x55);
    for content in [damaged, b"P5 64x 480 255\nabc".to_vec(), b"P2 640 480 255\n1 2 x".to_vec()] {
        let told = run(content).stderr;
        let parts: Vec<_> = told.trim_end().split(": ").collect();
        assert!(parts.len() > 3, "with its cause: {told}");
        assert!((1..parts.len()).all(|index| !parts[..index].contains(&parts[index])), "{told}");
        assert!(!told.contains("decoding"), "{told}");
    }
}
