//! Hints: one sentence about what is probably wrong, in JSON and under the table.

use image::{DynamicImage, GrayImage, ImageFormat, Luma};

use crate::painting::{encoded, painted, png};
use crate::tool::{Folder, SETUP, column};

/// Those of the only frame, which the table repeats.
#[track_caller]
fn hints(setup: &str, picture: Vec<u8>) -> Vec<String> {
    let folder = Folder::new().with("setup.toml", setup).with("picture", picture);
    let arguments = ["frame", "picture", "--setup", "setup.toml"];
    let document = folder.run(&[&arguments[..], &["--json"]].concat()).json();
    let hints: Vec<String> = serde_json::from_value(document["frames"][0]["hints"].clone()).expect("a list of texts");
    let text = folder.run(&arguments).stdout;
    let printed: Vec<_> = text.lines().filter_map(|line| line.strip_prefix("hint: ")).collect();
    assert_eq!(printed, hints);
    hints
}

/// Rows as a real sensor would deliver them if neighbouring columns had these gains.
fn with_columns_of(gains: [f64; 2]) -> GrayImage {
    let painted = painted();
    GrayImage::from_fn(640, 480, |x, row| {
        Luma([(f64::from(painted.get_pixel(x, row).0[0]) * gains[x as usize % 2]) as u8])
    })
}

#[test]
fn a_good_frame_has_none() {
    assert_eq!(hints(SETUP, png(painted())), [""; 0]);
    assert_eq!(hints(SETUP, png(with_columns_of([1.0, 0.99]))), [""; 0], "columns of a real sensor differ a little");
}

#[test]
fn a_motion_of_the_wrong_sign_is_told() {
    let wrong = SETUP.replace("-1.5", "1.5");
    let expected =
        "6 of 6 edges slope against the motion: check the sign of velocity_m_s, direction, or a mirrored image";
    assert_eq!(hints(&wrong, png(painted())), [expected]);
}

/// Those of a frame with edges at these bearings and depths.
fn hints_of_edges(setup: &str, lines: &[(f64, f64)]) -> Vec<String> {
    let points: String = (0..)
        .zip(lines)
        .flat_map(|(number, (bearing, depth_m))| {
            (0..480).step_by(10).map(move |row| format!("{row},{:.4},{number}\n", column(*bearing, *depth_m, row)))
        })
        .collect();
    let document = Folder::of(setup, &format!("row,column,line\n{points}")).document();
    serde_json::from_value(document["frames"][0]["hints"].clone()).expect("a list of texts")
}

/// One edge alone may be that of something that moves.
#[test]
fn a_few_edges_against_the_motion_are_no_mistake() {
    assert_eq!(hints_of_edges(SETUP, &[(0.1, -2.0)]), [""; 0]);
    assert_eq!(hints_of_edges(SETUP, &[(0.1, -2.0), (0.2, 2.0), (0.3, 3.0), (0.0, -3.0)]), [""; 0]);
    let most = hints_of_edges(SETUP, &[(-0.1, -2.0), (0.0, -3.0), (0.1, -2.0), (0.2, 2.0), (0.3, 1e5)]);
    assert!(most.len() == 1 && most[0].starts_with("3 of 5 edges slope against the motion"), "{most:?}");
}

#[test]
fn a_camera_that_stands_still_is_told() {
    let still = SETUP.replace("-1.5", "0");
    let found = hints_of_edges(&still, &[(0.1, 1e9), (0.2, 1e9)]);
    assert!(found.len() == 1 && found[0].starts_with("2 of 2 edges are slow: check velocity_m_s"), "{found:?}");
}

#[test]
fn a_camera_on_its_side_is_told() {
    let sideways = SETUP.replace("[attitude]", "[attitude]\ngravity = [1, 0, 0]");
    let found = hints_of_edges(&sideways, &[(0.1, 2.0), (0.2, 3.0)]);
    assert!(found.len() == 1 && found[0].starts_with("2 of 2 edges run along the rows: check gravity"), "{found:?}");
}

#[test]
fn edges_whose_blur_is_not_that_of_the_exposure_are_told() {
    // The frames were exposed for a tenth of it.
    let points: String = (1..4)
        .flat_map(|number| {
            let bearing = 0.1 * f64::from(number);
            (0..480).map(move |row| format!("{row},{:.4},{number},0.7\n", column(bearing, 1.0, row)))
        })
        .collect();
    let setup = SETUP.replace("fx = 600", "fx = 600\nexposure_s = 0.02\nlens_blur_px = 0.7\nresponse = \"linear\"");
    let document = Folder::of(&setup, &format!("row,column,line,width_px\n{points}")).document();
    let hint = document["frames"][0]["hints"][0].as_str().expect("a hint");
    assert!(
        hint.starts_with("3 of 3 edges lean by their fit or their blur: if they are upright, check exposure_s"),
        "{hint}"
    );
}

#[test]
fn ten_bits_in_a_container_of_sixteen_are_told() {
    let mut levels = DynamicImage::from(painted()).into_luma16();
    levels.iter_mut().for_each(|level| *level = *level / 257 * 4);
    let most = levels.iter().max().expect("pixels").to_string();
    let expected =
        format!("no grey level is above {most} of 65535: if they have 10 bits, say bits = 10 in [camera] of the setup");
    let stated = SETUP.replace("fx = 600", "fx = 600\nbits = 10");
    for format in [ImageFormat::Png, ImageFormat::Pnm] {
        assert_eq!(hints(SETUP, encoded(levels.clone(), format)), [expected.as_str()]);
        assert_eq!(hints(&stated, encoded(levels.clone(), format)), [""; 0]);
    }
}

#[test]
fn a_frame_without_contrast_is_told() {
    let dark = GrayImage::from_fn(640, 480, |x, row| Luma([3 + ((x + row) % 3) as u8]));
    let expected = "nearly all grey levels are 3 to 5 of 255: check exposure, lens cap and pixel format";
    assert_eq!(hints(SETUP, png(dark)), [expected]);
}

#[test]
fn a_colour_mosaic_read_as_grey_is_told() {
    let expected = "neighbouring columns alternate: convert a Bayer mosaic or YUYV to grey first";
    let found = hints(SETUP, png(with_columns_of([1.0, 0.6])));
    assert!(found.contains(&expected.to_string()), "{found:?}");
    let painted = painted();
    let yuyv = GrayImage::from_fn(640, 480, |x, row| if x % 2 == 0 { *painted.get_pixel(x, row) } else { Luma([128]) });
    assert!(hints(SETUP, png(yuyv)).contains(&expected.to_string()));
}

/// Texture everywhere hides edges: few ranges have a reason.
#[test]
fn rows_that_cannot_be_read_are_told() {
    let gravel = GrayImage::from_fn(640, 480, |x, y| {
        let cell =
            (u64::from(x) / 4).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (u64::from(y) / 4).wrapping_mul(0xc2b2_ae3d);
        Luma([(cell.wrapping_mul(0xff51_afd7_ed55_8ccd) >> 56) as u8])
    });
    let found = hints(SETUP, png(gravel));
    let hint = found.iter().find(|hint| hint.contains("could not be read whole")).expect("a hint");
    assert!(
        hint.contains(" of 480 rows") && hint.ends_with("texture or noise everywhere hides edges in them"),
        "{hint}"
    );
}
