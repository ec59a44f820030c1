//! `format`: every format against the bytes that its specification gives, and against grey on the same light.

use shutter_range::format::{Bayer, ByteOrder, PixelFormat, Pixels, Raw10, Rgb565, Strided, Wide};
use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator, Tint};
use shutter_range::{BoardRanger, RangeStatus, ReadoutDirection, RowError, Scanner, Setup, Uncertainty};

use crate::rendered::{COLUMNS, ROWS, moving};

fn levels(pixels: impl Pixels) -> Vec<u16> {
    (0..pixels.columns()).map(|column| pixels.level_q8(column)).collect()
}

fn in_q8(levels: &[u16]) -> Vec<u16> {
    levels.iter().map(|level| level << 8).collect()
}

#[test]
fn luma_of_each_order_of_yuv() {
    let [yuyv, uyvy] = [[10, 200, 20, 201, 30, 202, 40, 203], [200, 10, 201, 20, 202, 30, 203, 40]];
    assert_eq!(levels(Strided::luma_first(&yuyv)), in_q8(&[10, 20, 30, 40]));
    assert_eq!(levels(Strided::luma_second(&uyvy)), in_q8(&[10, 20, 30, 40]));
    // V before U changes nothing.
    for (name, bytes) in [("yuyv", yuyv), ("yvyu", yuyv), ("uyvy", uyvy), ("vyuy", uyvy)] {
        let format: PixelFormat = name.parse().expect("a format");
        assert_eq!(levels(format.row(&bytes, 0)), in_q8(&[10, 20, 30, 40]), "{name}");
    }
}

#[test]
fn strides_and_offsets() {
    let bytes = [0, 1, 2, 3, 4, 5, 6, 7];
    assert_eq!(levels(Strided::new(&bytes, 2, 1)), in_q8(&[2, 3, 4, 5, 6, 7]));
    assert_eq!(levels(Strided::new(&bytes, 1, 3)), in_q8(&[1, 4, 7]));
    assert_eq!(levels(Strided::new(&bytes, 0, 0)), levels(&bytes));
    assert_eq!(Strided::new(&bytes, 9, 2).columns(), 0);
    assert_eq!(Strided::new(&bytes, 0, usize::MAX).columns(), 1);
    assert_eq!(Strided::new(&bytes, 0, usize::MAX).level_q8(usize::MAX), 0);
}

/// White is 255, grey keeps its level within the steps of its bits, and either byte order gives the same.
#[test]
fn rgb565_by_luma() {
    let (white, red, green, blue) = (0xFFFF_u16, 0xF800_u16, 0x07E0_u16, 0x001F_u16);
    for (pixel, level) in [(white, 255.0), (red, 76.2), (green, 149.7), (blue, 29.1), (0, 0.0)] {
        let (little, big) = (pixel.to_le_bytes(), pixel.to_be_bytes());
        let found = Rgb565::new(&little, ByteOrder::LittleEndian).level_q8(0);
        assert!((f64::from(found) / 256.0 - level).abs() < 0.1, "{pixel:x}: {found}");
        assert_eq!(found, Rgb565::new(&big, ByteOrder::BigEndian).level_q8(0));
    }
}

/// The example of the MIPI specification's packing: four pixels, then their lower bits, the first one's lowest.
#[test]
fn raw10_as_mipi_packs_it() {
    let pixels = [0b11_1111_1101_u16, 0b00_0000_0010, 0b10_1010_1011, 0b01_0101_0100];
    let lower = pixels.iter().rev().fold(0, |byte, pixel| byte << 2 | (pixel & 3) as u8);
    let mut bytes = pixels.map(|pixel| (pixel >> 2) as u8).to_vec();
    bytes.push(lower);
    assert_eq!(lower, 0b00_11_10_01);
    let expected: Vec<_> = pixels.iter().map(|pixel| pixel << 6).collect();
    assert_eq!(levels(Raw10::new(&bytes)), expected);
    bytes.extend([1, 2, 3]);
    assert_eq!(levels(Raw10::new(&bytes)), expected, "an incomplete group is none");
}

#[test]
fn wide_levels_are_those_of_eight_bits_and_finer() {
    let bytes: Vec<_> = [0_u16, 1, 512, 1023, 1024, 65535].iter().flat_map(|level| level.to_le_bytes()).collect();
    assert_eq!(levels(Wide::<10>::new(&bytes)), [0, 64, 128 << 8, 1023 << 6, 1023 << 6, 1023 << 6]);
    assert_eq!(levels(Wide::<12>::new(&bytes)), [0, 16, 32 << 8, 1023 << 4, 1024 << 4, 4095 << 4]);
    assert_eq!(levels(Wide::<16>::new(&bytes[..11])), [0, 1, 512, 1023, 1024]);
}

#[test]
fn names_are_those_that_are_parsed() {
    for format in PixelFormat::ALL {
        assert_eq!(format.name().parse(), Ok(format));
    }
    let error = "jpeg".parse::<PixelFormat>().expect_err("no such format").to_string();
    assert!(PixelFormat::ALL.iter().all(|format| error.contains(format.name())), "{error}");
    assert_eq!(PixelFormat::Grey10Packed.row_bytes(322), None);
    assert_eq!(PixelFormat::Grey10Packed.row_bytes(320), Some(400));
}

/// What the simulator writes is what the views read: nothing but the rounding of the format differs.
#[test]
fn the_simulator_writes_what_is_read() {
    let world = moving(1.0);
    let setup = world.setup_read::<f32>(Uncertainty::NONE, ReadoutDirection::TopToBottom);
    let scene = post_and_wall();
    let simulator = camera(&scene, &setup, USUAL, 1, Tint::NEUTRAL);
    let mut exact = [0; COLUMNS as usize];
    simulator.row_q8(7, &mut exact);
    for format in PixelFormat::ALL {
        let mut bytes = vec![0xA5; format.row_bytes(COLUMNS).expect("a multiple of four")];
        simulator.row_in(7, format, &mut bytes);
        let step = match format {
            PixelFormat::Rgb565Le | PixelFormat::Rgb565Be => 4.2,
            PixelFormat::Grey10 | PixelFormat::Grey10Packed | PixelFormat::Bayer10 | PixelFormat::Bayer10Packed => 0.13,
            PixelFormat::Grey12 | PixelFormat::Bayer12 => 0.04,
            _ => 0.51,
        };
        let worst = levels(format.row(&bytes, 7))
            .iter()
            .zip(&exact)
            .fold(0.0_f64, |worst, (found, exact)| worst.max((f64::from(*found) - f64::from(*exact)).abs() / 256.0));
        assert!(worst <= step, "{format}: {worst}");
    }
}

/// A row in any format costs the noise of the scanner's grey levels nothing: a mosaic's colours are no texture.
#[test]
fn the_colours_of_a_mosaic_are_no_noise() {
    let mut flat = [60_u8; 320];
    flat.iter_mut().step_by(2).for_each(|pixel| *pixel = 140);
    let mut scanner = Scanner::new();
    scanner.scan(Bayer::new(&flat, 0), |point| panic!("{point:?} in a row without an edge"));
    assert_eq!(scanner.noise_q8(), Scanner::new().noise_q8());
}

/// Where nothing is in view some rows are not scanned: of a mosaic none of its two kinds only. A bar of a colour that
/// every second row alone shows is found, whichever these are.
#[test]
fn bars_of_one_colour_are_found() {
    const FIRST: u16 = 97;
    let setup = moving(1.5).setup::<f32>();
    for kind in [0, 1] {
        let mut ranger = BoardRanger::new();
        for row in 0..ROWS {
            let mut pixels = [90; COLUMNS as usize];
            // It moves to the left by a pixel in eight rows.
            let left = 180 - usize::from(row) / 8;
            let is_shown = row >= FIRST && row % 2 == kind;
            if let Some(bar) = pixels.get_mut(left..left + 40).filter(|_| is_shown) {
                bar.iter_mut().skip(left % 2).step_by(2).for_each(|pixel| *pixel = 190);
            }
            ranger.row(&setup, row, Bayer::new(&pixels[..], row)).expect("rows in order");
        }
        ranger.end_frame(&setup);
        let lines: Vec<_> = core::iter::from_fn(|| ranger.next_line()).collect();
        assert_eq!(lines.len(), 2, "rows of kind {kind}: {lines:#?}");
        // Either kind is looked at in two of four rows.
        assert!(lines.iter().all(|line| (FIRST..FIRST + 6).contains(&line.first().row)), "{lines:#?}");
    }
}

#[test]
fn a_row_with_too_few_bytes_is_refused() {
    let setup = Setup::pinhole(COLUMNS, ROWS, 300.0_f32, 33_300_000).expect("a sound setup");
    let bytes = [0; 2 * COLUMNS as usize - 1];
    let error = BoardRanger::new().row(&setup, 0, PixelFormat::Rgb565Le.row(&bytes, 0));
    assert_eq!(error, Err(RowError::Length { row: 0, pixels: 319, columns: 320 }));
}

fn post_and_wall() -> Scene<3> {
    let mut scene = Scene::new(Background::plain(170.0)).expect("a sound background");
    for bar in
        [Bar::upright(0.35, 3.0, 0.4, 60.0), Bar::upright(-0.05, 1.5, 0.12, 90.0), Bar::upright(-0.4, 2.0, 0.3, 40.0)]
    {
        scene.push(bar).expect("a sound bar");
    }
    scene
}

/// A usual lens, and the noise of a small sensor.
const USUAL: Exposure = Exposure { time_s: 0.002, psf_sigma_px: 0.7, read_noise: 2.0, shot_gain: 0.05 };

fn camera<'s>(scene: &'s Scene<3>, setup: &Setup<f32>, exposure: Exposure, seed: u64, tint: Tint) -> Simulator<'s, 3> {
    let camera = Simulator::new(scene, setup.camera(), setup.readout(), &moving(1.0).motion(), exposure, seed);
    camera.and_then(|camera| camera.with_tint(tint)).expect("sound parameters")
}

/// Root mean square over frames and edges of the error of inverse depth, in the sigma that is stated and in itself.
fn rms_errors(format: PixelFormat, taken_for: PixelFormat, exposure: Exposure, tint: Tint, frames: u64) -> (f64, f64) {
    rms_errors_of_rows(format, exposure, tint, frames, |ranger, setup, row, bytes| {
        ranger.row(setup, row, taken_for.row(bytes, row))
    })
}

/// Likewise of rows of bytes that are handed over in any way.
fn rms_errors_of_rows(
    format: PixelFormat,
    exposure: Exposure,
    tint: Tint,
    frames: u64,
    take: impl Fn(&mut BoardRanger, &Setup<f32>, u16, &[u8]) -> Result<(), RowError>,
) -> (f64, f64) {
    let world = moving(1.0);
    let setup = world.setup_read::<f32>(Uncertainty::NONE, ReadoutDirection::TopToBottom);
    let scene = post_and_wall();
    let (mut errors, mut normal, mut edges) = (0.0, 0.0, 0.0);
    for seed in 1..=frames {
        let simulator = camera(&scene, &setup, exposure, seed, tint);
        let mut truths: Vec<_> = simulator.truth().collect();
        truths.sort_by(|a, b| a.bearing.total_cmp(&b.bearing));
        let mut bytes = vec![0; format.row_bytes(COLUMNS).expect("a multiple of four")];
        let mut ranger = BoardRanger::new();
        for row in 0..ROWS {
            simulator.row_in(row, format, &mut bytes);
            take(&mut ranger, &setup, row, &bytes).expect("rows in order");
        }
        ranger.end_frame(&setup);
        let found = ranger.ranges(&setup, &world.motion());
        assert_eq!(found.len(), truths.len(), "{format}, seed {seed}: {found:#?}");
        for (range, truth) in found.iter().zip(&truths) {
            assert_eq!(range.status, RangeStatus::Ok, "{format}, seed {seed}: {range:?} for {truth:?}");
            let error = f64::from(range.estimate.inverse_depth_per_m) - 1.0 / truth.depth_m;
            errors += error * error;
            normal += (error / f64::from(range.estimate.sigma_inverse_depth_per_m)).powi(2);
            edges += 1.0;
        }
    }
    ((errors / edges).sqrt(), (normal / edges).sqrt())
}

/// Light of a colour, and things whose dark sides are of another one.
const COLOURED: Tint = Tint { offset: [25.0, 0.0, 45.0], gain: [0.8, 1.0, 0.7] };

/// The promise of the table in `format`: each format ranges as well as grey, on the same light.
#[test]
fn accuracy_of_each_format_against_grey() {
    const FRAMES: u64 = 40;
    let (grey, of_sigma) = rms_errors(PixelFormat::Grey8, PixelFormat::Grey8, USUAL, Tint::NEUTRAL, FRAMES);
    println!("{:>10}: {grey:.5} per metre, {of_sigma:.2} sigma", "gray8");
    assert!((0.8..1.3).contains(&of_sigma), "{of_sigma}");
    for format in PixelFormat::ALL.into_iter().skip(1) {
        let tint = if format.is_mosaic() { COLOURED } else { Tint::NEUTRAL };
        let (error, of_sigma) = rms_errors(format, format, USUAL, tint, FRAMES);
        println!("{:>10}: {:.3} of grey, {of_sigma:.2} sigma", format.name(), error / grey);
        assert!((0.7..1.3).contains(&(error / grey)), "{format}: {} of grey", error / grey);
        assert!((0.8..1.3).contains(&of_sigma), "{format}: {of_sigma} sigma");
    }
}

/// The bytes of a mosaic are none of one colour, however they are handed over.
#[test]
fn a_mosaic_of_plain_bytes_is_a_mosaic() {
    let by_name = rms_errors(PixelFormat::Bayer8, PixelFormat::Bayer8, USUAL, COLOURED, 4);
    let plain = rms_errors_of_rows(PixelFormat::Bayer8, USUAL, COLOURED, 4, |ranger, setup, row, bytes| {
        ranger.row(setup, row, Bayer::new(bytes, row))
    });
    assert_eq!(plain, by_name);
}

/// What the phase is in the model for: taken for grey, the colours of a mosaic pass for noise, and sigma is three times
/// what the error is.
#[test]
fn a_mosaic_taken_for_grey_is_worse() {
    let sharp = Exposure { psf_sigma_px: 0.5, read_noise: 0.5, shot_gain: 0.01, ..USUAL };
    let [(aware, of_sigma), (unaware, of_unaware_sigma)] = [PixelFormat::Bayer8, PixelFormat::Grey8]
        .map(|taken_for| rms_errors(PixelFormat::Bayer8, taken_for, sharp, COLOURED, 10));
    assert!((0.8..1.3).contains(&of_sigma) && of_unaware_sigma < 0.4, "{of_sigma}, {of_unaware_sigma}");
    assert!(unaware > 1.3 * aware, "{unaware} for {aware}");
}

/// Light in which red and blue are half of green, and another one.
#[test]
fn a_mosaic_in_light_of_a_strong_colour() {
    for gain in [[0.6, 1.0, 0.45], [0.9, 0.6, 0.3]] {
        let tint = Tint { gain, ..COLOURED };
        let (_, of_sigma) = rms_errors(PixelFormat::Bayer8, PixelFormat::Bayer8, USUAL, tint, 10);
        assert!((0.7..1.3).contains(&of_sigma), "{gain:?}: {of_sigma} sigma");
    }
}
