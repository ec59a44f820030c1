//! `inspect`: each finding on frames that have its cause, and none on clean ones.

use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, GrayImage, ImageBuffer, ImageFormat, Luma};
use serde_json::Value;
use shutter_range::sim::{Background, Bar, Exposure, Flicker, Pipeline, Scene, Simulator, Stage, Texture, ToneCurve};
use shutter_range::{Setup, Twist};

use crate::painting::{encoded, png};
use crate::tool::{Folder, Outcome, assert_near, number};

const COLUMNS: usize = 640;
const ROWS: u16 = 480;

/// Noise as a small sensor has it.
const NOISY: Exposure = Exposure { time_s: 0.0005, psf_sigma_px: 0.8, read_noise: 1.2, shot_gain: 0.04 };

/// Dark and bright posts before a wall with a smooth texture, through a camera that does this to its pixels.
fn seen<const STAGES: usize>(seed: u64, exposure: Exposure, stages: [Stage; STAGES]) -> GrayImage {
    seen_before(seed, exposure, stages, wall(seed))
}

fn wall(seed: u64) -> Background {
    Background::textured(140.0, Texture { contrast: 12.0, cell: 0.04, seed: seed as u32 })
}

fn seen_before<const STAGES: usize>(
    seed: u64,
    exposure: Exposure,
    stages: [Stage; STAGES],
    background: Background,
) -> GrayImage {
    seen_in(seed, exposure, stages, background, None)
}

fn seen_in<const STAGES: usize>(
    seed: u64,
    exposure: Exposure,
    stages: [Stage; STAGES],
    background: Background,
    lamp: Option<Flicker>,
) -> GrayImage {
    let mut scene = Scene::<8>::new(background).expect("a scene");
    for (place, (depth_m, level)) in
        [(2.0, 40.0), (3.0, 220.0), (2.5, 60.0), (4.0, 25.0), (2.2, 200.0)].into_iter().enumerate()
    {
        let bearing = -0.42 + 0.2 * place as f32;
        scene.push(Bar::upright(bearing, depth_m, 0.08 * depth_m, level)).expect("room");
    }
    let setup = Setup::pinhole(COLUMNS as u16, ROWS, 600.0_f32, 33_300_000).expect("a camera");
    let motion = Twist::level([-0.5, 0.0, 0.0]).expect("a motion");
    let simulator = Simulator::new(&scene, setup.camera(), setup.readout(), &motion, exposure, seed).expect("sound");
    let simulator = lamp.map_or(simulator.clone(), |lamp| simulator.with_flicker(lamp).expect("a lamp"));
    let mut camera = Box::new(Pipeline::<COLUMNS, STAGES>::new(stages).expect("sound stages"));
    let mut pixels = Vec::new();
    let mut row_q8 = [0; COLUMNS];
    for row in 0..ROWS {
        simulator.row_q8(row, &mut row_q8);
        camera.row(&row_q8, |row| pixels.extend(row));
    }
    camera.end_frame(|row| pixels.extend(row));
    GrayImage::from_raw(COLUMNS as u32, ROWS.into(), pixels).expect("a frame")
}

fn inspect(file: Vec<u8>) -> Value {
    Folder::new().with("a.png", file).run(&["inspect", "a.png", "--json"]).json()
}

fn names(inspection: &Value) -> Vec<&str> {
    let findings = inspection["findings"].as_array().expect("findings");
    findings.iter().map(|finding| finding["name"].as_str().expect("a name")).collect()
}

#[track_caller]
fn assert_finds(picture: &GrayImage, expected: &[&str]) -> Value {
    let inspection = inspect(png(picture.clone()));
    assert_eq!(names(&inspection), expected, "{:#}", inspection["measured"]);
    inspection
}

const SEEDS: [u64; 3] = [3, 14, 159];

#[test]
fn clean_frames_have_no_finding() {
    for seed in 1..=8 {
        let inspection = assert_finds(&seen(seed, NOISY, []), &[]);
        let measured = &inspection["measured"];
        // Noise at any brightness as it was made, to a tenth and its rounding.
        for bin in measured["noise"].as_array().expect("bins") {
            let (level, sigma) = (number(bin, "level"), number(bin, "sigma"));
            let made = (1.2_f64.powi(2) + 0.04 * level + 1.0 / 12.0).sqrt();
            assert_near(sigma / made, 1.0, 0.12);
        }
        assert_near(number(measured, "edge_blur_px"), 0.8, 0.12);
        assert_eq!(
            (&inspection["keys"]["response"], number(&inspection["keys"], "sigma_blur")),
            (&"linear".into(), 0.02)
        );
    }
    // Plain walls, more and less noise, other lenses.
    for (seed, (read_noise, psf_sigma_px)) in (20..).zip([(0.6, 0.5), (2.5, 0.7), (6.0, 1.1)]) {
        let exposure = Exposure { read_noise, psf_sigma_px, ..NOISY };
        assert_finds(&seen_before(seed, exposure, [], Background::plain(130.0)), &[]);
        assert_finds(&seen(seed, exposure, []), &[]);
    }
}

#[test]
fn sharpening() {
    for seed in SEEDS {
        for stage in [Stage::Sharpen3(1.0), Stage::Sharpen3(2.0), Stage::Sharpen5(1.0)] {
            let keys = assert_finds(&seen(seed, NOISY, [stage]), &["halos"])["keys"].clone();
            assert_eq!((&keys["response"], number(&keys, "sigma_blur")), (&"unknown".into(), 0.25));
        }
    }
}

#[test]
fn denoising_and_mosaics() {
    for seed in SEEDS {
        assert_finds(&seen(seed, NOISY, [Stage::Median]), &["denoised"]);
        assert_finds(&seen(seed, NOISY, [Stage::Bilateral(6.0)]), &["denoised"]);
        let mosaic = inspect(png(seen(seed, NOISY, [Stage::Mosaic])));
        assert!(names(&mosaic).iter().any(|name| ["denoised", "mosaic"].contains(name)), "{mosaic:#}");
        assert_finds(&seen(seed, Exposure { read_noise: 0.0, shot_gain: 0.0, ..NOISY }, []), &["denoised"]);
    }
}

#[test]
fn tone_curves() {
    for seed in SEEDS {
        for curve in [ToneCurve::Srgb, ToneCurve::Gamma(2.2)] {
            let inspection = inspect(png(seen(seed, NOISY, [Stage::Tone(curve)])));
            assert!(!names(&inspection).contains(&"halos"), "{inspection:#}");
            assert_eq!(inspection["keys"]["response"], "unknown", "{inspection:#}");
        }
    }
}

#[test]
fn offsets_of_columns_and_rows() {
    for seed in SEEDS {
        for sigma in [0.6, 3.0] {
            let measured =
                assert_finds(&seen(seed, NOISY, [Stage::ColumnOffsets { sigma, seed: 5 }]), &["offsets"])["measured"]
                    .clone();
            assert_near(number(&measured, "column_offsets") / f64::from(sigma), 1.0, 0.2);
            assert_near(number(&measured, "row_offsets"), 0.0, 0.15);
        }
    }
    // Turned by a right angle, they are offsets of rows; there are no upright edges then.
    let turned = image::imageops::rotate90(&seen(7, NOISY, [Stage::ColumnOffsets { sigma: 1.0, seed: 5 }]));
    assert_near(number(&inspect(png(turned))["measured"], "row_offsets"), 1.0, 0.2);
}

#[test]
fn clipping() {
    for seed in SEEDS {
        assert!(names(&inspect(png(seen(seed, NOISY, [Stage::Gain(2.0)])))).contains(&"clipped"));
    }
}

#[test]
fn compression() {
    let jpeg = |picture: GrayImage, quality| {
        let mut file = Vec::new();
        let encoder = JpegEncoder::new_with_quality(&mut file, quality);
        DynamicImage::from(picture).write_with_encoder(encoder).expect("encoding");
        file
    };
    for seed in SEEDS {
        let coarse = inspect(jpeg(seen(seed, NOISY, []), 50));
        assert!(names(&coarse).contains(&"blocks"), "{coarse:#}");
        let fine = inspect(jpeg(seen(seed, NOISY, []), 98));
        assert_eq!(names(&fine), [""; 0], "{fine:#}");
    }
}

/// By light that is pulsed with so many periods in the frame.
fn flickering(picture: &GrayImage, periods: f64, amplitude: f64) -> GrayImage {
    GrayImage::from_fn(picture.width(), picture.height(), |x, row| {
        let phase = std::f64::consts::TAU * periods * f64::from(row) / f64::from(picture.height());
        Luma([(f64::from(picture.get_pixel(x, row).0[0]) * (1.0 + amplitude * phase.sin())).round() as u8])
    })
}

#[test]
fn flicker() {
    for seed in SEEDS {
        for (periods, amplitude) in [(3.3, 0.05), (12.0, 0.03), (6.6, 0.15)] {
            let bands = assert_finds(&flickering(&seen(seed, NOISY, []), periods, amplitude), &["bands"]);
            assert_near(number(&bands["measured"], "band_periods"), periods, 0.3);
            assert_near(number(&bands["measured"], "band_amplitude") / amplitude, 1.0, 0.2);
        }
    }
}

/// PWM, pulses and strobes on a wall with posts: hertz, duty, share of the light, exposure.
#[test]
fn pulsed_light() {
    for (frequency_hz, duty, depth, time_s) in [
        (100.0, 0.15, 0.6, 0.0005),
        (240.0, 0.5, 0.3, 0.001),
        (300.0, 0.05, 0.9, 0.0002),
        (1000.0, 0.3, 0.5, 0.0004),
        (1000.0, 0.5, 1.0, 0.0003),
        (5000.0, 0.4, 0.8, 0.000_05),
    ] {
        for seed in SEEDS {
            let lamp = Flicker { frequency_hz, depth, duty: Some(duty) };
            let lit = seen_in(seed, Exposure { time_s, ..NOISY }, [], wall(seed), Some(lamp));
            let inspection = inspect(png(lit));
            let case = format!("{frequency_hz} Hz, duty {duty}, seed {seed}: {:#}", inspection["measured"]);
            assert!(names(&inspection).contains(&"bands"), "{case}");
            let periods = f64::from(frequency_hz) * 0.0333;
            assert!((number(&inspection["measured"], "band_periods") / periods - 1.0).abs() < 0.02, "{case}");
        }
    }
}

/// Whatever is painted on a wall, it does not come back every so many rows.
#[test]
fn textures_are_no_bands() {
    for (seed, (contrast, cell)) in (1..).zip([(40.0, 0.02), (60.0, 0.1), (30.0, 0.3), (60.0, 0.01), (20.0, 0.05)]) {
        let wall = Background::textured(130.0, Texture { contrast, cell, seed });
        let inspection = inspect(png(seen_before(seed.into(), NOISY, [], wall)));
        assert!(!names(&inspection).contains(&"bands"), "{contrast}, {cell}: {:#}", inspection["measured"]);
    }
}

#[test]
fn soft_edges() {
    for seed in SEEDS {
        let soft = assert_finds(&seen(seed, Exposure { psf_sigma_px: 2.0, ..NOISY }, []), &["soft"]);
        assert_near(number(&soft["measured"], "edge_blur_px"), 2.0, 0.2);
    }
}

#[test]
fn mosaics_and_bits() {
    let clean = seen(3, NOISY, []);
    let bayer = GrayImage::from_fn(clean.width(), clean.height(), |x, row| {
        let gain = if x % 2 == 0 { 1.0 } else { 0.5 };
        Luma([(f64::from(clean.get_pixel(x, row).0[0]) * gain) as u8])
    });
    assert!(names(&inspect(png(bayer))).contains(&"alternating"));
    let ten: ImageBuffer<Luma<u16>, Vec<u16>> = ImageBuffer::from_fn(clean.width(), clean.height(), |x, row| {
        Luma([u16::from(clean.get_pixel(x, row).0[0]) * 4])
    });
    let unused = inspect(encoded(ten, ImageFormat::Png));
    assert!(names(&unused).contains(&"unused bits"), "{unused:#}");
    assert_eq!(unused["keys"]["bits"], 10);
    let five = GrayImage::from_fn(clean.width(), clean.height(), |x, row| Luma([clean.get_pixel(x, row).0[0] & 0xF8]));
    assert!(names(&inspect(png(five))).contains(&"coarse levels"));
}

#[test]
fn several_frames_and_text() {
    let folder = (0..3).fold(Folder::new(), |folder, seed| {
        folder.with(&format!("{seed}.png"), png(seen(seed, NOISY, [Stage::Sharpen3(1.0)])))
    });
    let run = |rest: &[&str]| -> Outcome { folder.run(&[&["inspect", "0.png", "1.png", "2.png"], rest].concat()) };
    assert_eq!(run(&["--json"]).json()["frames"], 3);
    let text = run(&[]).stdout;
    for part in [
        "640 × 480 pixels, median of 3 frames",
        "halos: edges overshoot by",
        "for the setup:\n[camera]\nresponse = \"unknown\"\nsigma_blur = 0.25\n",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let dump = Folder::new().with("a.raw", seen(1, NOISY, []).into_raw());
    assert_eq!(names(&dump.run(&["inspect", "a.raw", "--raw", "640x480", "--json"]).json()), [""; 0]);
}

#[test]
fn frames_that_cannot_be_inspected() {
    let folder = Folder::new().with("a.png", png(GrayImage::new(64, 48))).with("b.png", png(GrayImage::new(48, 64)));
    let folder = folder.with("tiny.png", png(GrayImage::new(8, 8))).with("none.png", "");
    let refused = |arguments: &[&str]| {
        let outcome = folder.run(&[&["inspect"], arguments].concat());
        assert_eq!((outcome.code, outcome.stdout.as_str()), (1, ""));
        outcome.stderr
    };
    assert!(
        refused(&["a.png", "b.png"]).contains("b.png: the frame is 48 × 64 pixels, but must be 64 × 48, as a.png is")
    );
    assert!(refused(&["tiny.png"]).contains("tiny.png: 8 × 8 pixels, but must be at least 16 × 16"));
    assert!(refused(&["none.png"]).contains("none.png: the file is empty"));
    assert!(refused(&["missing.png"]).contains("reading missing.png"));
    assert_eq!(folder.run(&["inspect"]).code, 2);
    // Black all over.
    let dark = folder.run(&["inspect", "a.png", "--json"]).json();
    assert!(names(&dark).contains(&"clipped"), "{dark:#}");
}
