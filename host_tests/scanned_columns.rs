//! `Scanner`: where the edges of single rows of pixels are, against rendered rows and steps.

use shutter_range::sim::{Background, Bar, Exposure, Object, Scene, Texture};
use shutter_range::{Polarity, ScannedPoint, Scanner};

use crate::scanning::{column_px, near, noisy, only, rows_of, scan, scene_of, step};

/// Row 0 without noise.
fn first_row_of<const N: usize>(scene: &Scene<N>, exposure: Exposure) -> Vec<u8> {
    rows_of(scene, exposure, 1, 0..1).remove(0)
}

/// A row of steps: a level up to each column, the last one to the end.
fn steps(length: usize, levels: &[(usize, u8)]) -> Vec<u8> {
    let mut row = vec![0; length];
    for (from, level) in levels {
        row[*from..].fill(*level);
    }
    row
}

/// Sharp to widely blurred, at all phases of the pixels and all places in a block.
#[test]
fn columns_are_good_to_a_fraction_of_a_pixel() {
    // The threshold cuts off the flanks of an edge, at some phases on one side only. A difference of 24 that is missing
    // 4 px from the centroid of an area of 16 times the contrast shifts it by 0.03 px at 200 grey levels and by 0.15 px
    // at 40; a wide blur has it 9 px away.
    for (psf_sigma_px, bound_px) in
        [(0.0, 0.05), (0.5, 0.05), (0.7, 0.05), (1.0, 0.05), (1.5, 0.05), (2.0, 0.05), (3.0, 0.07)]
    {
        let exposure = Exposure { psf_sigma_px, ..Exposure::IDEAL };
        for (levels, bound_px) in [([30.0, 230.0], bound_px), ([230.0, 30.0], bound_px), ([100.0, 140.0], 0.2)] {
            let mut worst = 0.0_f64;
            for sixteenths in 0..16 * 17 {
                let column = 150.01 + f64::from(sixteenths) / 16.0;
                let row = first_row_of(&step(column, levels), exposure);
                let found = only(&scan(&mut Scanner::new(), &row));
                worst = worst.max((column_px(&found) - column).abs());
                let contrast = levels[1] - levels[0];
                // The flanks that are cut off are missing in the sum; rounding to whole levels.
                let ratio = f32::from(found.contrast) / contrast;
                assert!((0.8..1.02).contains(&ratio), "{psf_sigma_px} px of blur: {found:?} for {contrast}");
                assert_eq!(found.polarity() == Polarity::Rising, contrast > 0.0);
            }
            println!("{levels:?} {psf_sigma_px} px of blur: {worst} px");
            assert!(worst < bound_px, "{psf_sigma_px} px of blur: {worst} px");
        }
    }
}

#[test]
fn widths_are_those_of_lens_and_pixel() {
    let mut before = 0.0;
    for psf_sigma_px in [0.5_f32, 0.7, 1.0, 1.5, 2.0, 2.5, 3.0] {
        let exposure = Exposure { psf_sigma_px, ..Exposure::IDEAL };
        let width = |sixteenths: u16| {
            let row = first_row_of(&step(150.0 + f64::from(sixteenths) / 16.0, [30.0, 230.0]), exposure);
            f32::from(only(&scan(&mut Scanner::new(), &row)).width_q8) / 256.0
        };
        let width = (0..16).map(width).sum::<f32>() / 16.0;
        let expected = (psf_sigma_px * psf_sigma_px + 1.0 / 12.0).sqrt();
        // The flanks below the threshold are missing in the second moment.
        assert!((width / expected - 1.0).abs() < 0.1, "{width} for {expected}");
        assert!(width > before, "{width} for {expected}");
        before = width;
    }
}

/// Exact from 8 px off the border on, or off the end of the last whole block.
#[test]
fn edges_eight_pixels_from_the_border_are_exact() {
    for length in [100, 112, 319, 320, 321, 335, 640] {
        let most = length / 16 * 16 - 8;
        for at in 8..=most {
            let found = only(&scan(&mut Scanner::new(), &steps(length, &[(0, 50), (at, 200)])));
            let error = column_px(&found) - (at as f64 - 0.5);
            assert!(error.abs() < 0.001, "rounding; {found:?} for {at} of {length}");
        }
        for at in (0..8).chain(most..=length) {
            for point in scan(&mut Scanner::new(), &steps(length, &[(0, 50), (at, 200)])) {
                assert!((0.0..length as f64).contains(&column_px(&point)), "{point:?} for {at} of {length}");
            }
        }
    }
}

/// A faint edge that moves no block's sum enough is found where the look at its neighbour comes upon it, on either
/// side.
#[test]
fn an_edge_at_the_end_of_a_look_is_whole() {
    for first in 160..176 {
        let bar = steps(320, &[(0, 115), (first, 124), (first + 12, 115)]);
        for row in [bar.clone(), bar.into_iter().rev().collect()] {
            let points = scan(&mut Scanner::new(), &row);
            assert_eq!(points.len(), 2, "columns {first} to {}: {points:?}", first + 12);
        }
    }
}

#[test]
fn short_rows_have_no_edge_outside_them() {
    for length in 0..70 {
        for at in 0..=length {
            for (left, right) in [(50, 200), (255, 0)] {
                for point in scan(&mut Scanner::new(), &steps(length, &[(0, left), (at, right)])) {
                    assert!((0.0..length as f64).contains(&column_px(&point)), "{point:?} for {at} of {length}");
                }
            }
        }
    }
    for pixel in [0, 128, 255] {
        assert!(scan(&mut Scanner::new(), &[pixel]).is_empty());
    }
    // Nothing to learn from, but no harm either.
    let mut scanner = Scanner::new();
    (0..1000).for_each(|_| scanner.scan(&[], |_| panic!("an edge in an empty row")));
    assert_eq!(only(&scan(&mut scanner, &steps(320, &[(0, 50), (160, 200)]))).contrast, 150);
}

#[test]
fn the_longest_row_is_scanned_as_far_as_columns_go() {
    for length in [32_767, 32_768, 65_535, 100_000] {
        let found = scan(&mut Scanner::new(), &steps(length, &[(0, 50), (16_384, 200), (32_700, 10)]));
        let [rising, falling] = found.as_slice() else { panic!("two edges: {found:?}") };
        assert_eq!((column_px(rising), rising.contrast), (16_383.5, 150));
        assert_eq!((column_px(falling), falling.contrast), (32_699.5, -190));
    }
    // Columns end where 1/65536 px does.
    for at in [32_760, 32_768, 32_780, 90_000] {
        for point in scan(&mut Scanner::new(), &steps(100_000, &[(at, 255)])) {
            assert!((column_px(&point) - (at as f64 - 0.5)).abs() < 0.1, "not wrapped; {point:?} for {at}");
        }
    }
}

#[test]
fn edges_from_black_to_burnt_out_are_where_they_are() {
    for levels in [[0.0, 255.0], [255.0, 0.0]] {
        for psf_sigma_px in [0.0, 0.7, 2.0] {
            for phase in 0..16 {
                let column = 150.0 + f64::from(phase) / 16.0;
                let row = first_row_of(&step(column, levels), Exposure { psf_sigma_px, ..Exposure::IDEAL });
                let found = only(&scan(&mut Scanner::new(), &row));
                // As in `columns_are_good_to_a_fraction_of_a_pixel`, with flanks of 2 % of the contrast.
                assert!((column_px(&found) - column).abs() < 0.05, "{found:?} for {column}");
                assert!((f32::from(found.contrast) - (levels[1] - levels[0])).abs() <= 4.0, "{found:?}");
            }
        }
    }
    // Noise of 5 of 255 levels makes 0.03 px; that of the dark side is cut off at zero, which shifts the edge a little.
    for seed in 0..20 {
        let rows = rows_of(&step(150.3, [0.0, 255.0]), Exposure { psf_sigma_px: 0.7, ..noisy(5.0) }, seed, 0..1);
        let found = only(&near(&scan(&mut Scanner::new(), &rows[0]), 150.3));
        assert!((column_px(&found) - 150.3).abs() < 0.15, "seed {seed}: {found:?}");
    }
    for level in [0, 255] {
        assert!(scan(&mut Scanner::new(), &[level; 640]).is_empty());
    }
}

/// Rows with bars, a lean and a background that is not plain.
fn busy_rows(exposure: Exposure) -> Vec<Vec<u8>> {
    let texture = Texture { contrast: 25.0, cell: 0.08, seed: 7 };
    let bars = [
        Bar::upright(-0.3, 1.5, 0.12, 50.0),
        Bar::upright(0.02, 2.5, 0.03, 70.0),
        Bar::upright(0.25, 4.0, 0.5, 210.0),
        Bar::upright(0.1, 1.2, 0.05, 60.0).leaning(0.2),
    ];
    let scene = scene_of(Background::textured(150.0, texture), bars.map(Object::from));
    rows_of(&scene, exposure, 11, 0..240)
}

/// In the negative, with the other polarity.
#[test]
fn negatives_and_brighter_rows_have_the_same_edges() {
    let [mut original, mut negative, mut brighter] = [Scanner::new(); 3];
    let mut count = 0;
    for row in busy_rows(Exposure { psf_sigma_px: 0.8, ..noisy(2.0) }) {
        let points = scan(&mut original, &row);
        let inverted: Vec<u8> = row.iter().map(|pixel| 255 - pixel).collect();
        let flipped = points.iter().map(|point| ScannedPoint { contrast: -point.contrast, ..*point });
        assert_eq!(scan(&mut negative, &inverted), flipped.collect::<Vec<_>>());
        let lifted: Vec<u8> = row.iter().map(|pixel| pixel + 20).collect();
        assert_eq!(scan(&mut brighter, &lifted), points);
        count += points.len();
    }
    assert!(count > 500, "two of the eight edges in each of 240 rows, or more: {count}");
    // The pixels that they remember differ.
    assert_eq!([original.noise_q8(); 2], [negative.noise_q8(), brighter.noise_q8()]);
}

/// Without noise, which is sampled elsewhere in a mirrored row, and the threshold with it.
#[test]
fn mirrored_rows_have_mirrored_edges() {
    let bars = [
        Bar::upright(-0.3, 1.5, 0.12, 50.0),
        Bar::upright(0.02, 2.5, 0.03, 70.0),
        Bar::upright(0.1, 1.2, 0.05, 60.0).leaning(0.1),
    ];
    let scene = scene_of(Background::plain(150.0), bars.map(Object::from));
    for psf_sigma_px in [0.3, 0.8, 2.0] {
        for row in rows_of(&scene, Exposure { psf_sigma_px, ..Exposure::IDEAL }, 1, 0..240) {
            let points = scan(&mut Scanner::new(), &row);
            let mirrored = scan(&mut Scanner::new(), &row.iter().rev().copied().collect::<Vec<_>>());
            assert_eq!((points.len(), mirrored.len()), (6, 6));
            for (point, other) in points.iter().zip(mirrored.iter().rev()) {
                // Divisions that round towards zero on either side.
                assert!((column_px(point) + column_px(other) - 319.0).abs() < 0.001, "{point:?}, {other:?}");
                assert_eq!(point.contrast, -other.contrast);
                assert!(point.width_q8.abs_diff(other.width_q8) <= 1, "{point:?}, {other:?}");
            }
        }
    }
}

#[test]
fn a_scanned_point_becomes_an_edge_point() {
    let point = only(&scan(&mut Scanner::new(), &steps(320, &[(0, 200), (160, 50)])));
    let placed = point.at(17, 1_234);
    assert_eq!((placed.row, placed.time_ns, placed.polarity), (17, 1_234, Polarity::Falling));
    assert_eq!(
        (placed.column_q16, placed.sigma_q16, placed.width_q8),
        (point.column_q16, point.sigma_q16, point.width_q8)
    );
}
