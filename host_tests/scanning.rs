//! `Scanner`: the edges of single rows of pixels, against rendered rows.

use shutter_range::sim::{Background, Bar, Exposure, Object, Scene, Simulator, Texture};
use shutter_range::{Polarity, ReadoutDirection, ScannedPoint, Scanner, Uncertainty};

use crate::projection;

const COLUMNS: u16 = 320;

/// A QVGA camera of 300 px of focal length, at rest.
fn still() -> projection::Scene {
    projection::Scene {
        columns: COLUMNS,
        rows: 240,
        focal_px: 300.0,
        cx: 159.5,
        cy: 119.5,
        velocity_m_s: [0.0; 3],
        ..projection::Scene::vga()
    }
}

/// A rendered row for each number of `rows`, all of the same scene at rest.
fn rows_of<const N: usize>(
    scene: &Scene<N>,
    exposure: Exposure,
    seed: u64,
    rows: impl Iterator<Item = u32>,
) -> Vec<Vec<u8>> {
    let setup = still().setup_read::<f32>(Uncertainty::NONE, ReadoutDirection::TopToBottom);
    let (camera, readout) = (setup.camera(), setup.readout());
    let simulator =
        Simulator::new(scene, camera, readout, &still().motion(), exposure, seed).expect("sound parameters");
    let row = |number: u32| {
        let mut pixels = vec![0; COLUMNS.into()];
        simulator.clone().at_frame(number / 240, 0).row((number % 240) as u16, &mut pixels);
        pixels
    };
    rows.map(row).collect()
}

fn scene_of<const N: usize>(background: Background, objects: [Object; N]) -> Scene<N> {
    let mut scene = Scene::new(background).expect("sound background");
    for object in objects {
        scene.push(object).expect("a sound object");
    }
    scene
}

/// One level to the left of a column, another to the right of it.
fn step(column: f64, levels: [f32; 2]) -> Scene<1> {
    let [left, right] = levels;
    let bearing = (column - 159.5) / 300.0;
    scene_of(Background::plain(left), [Bar::upright((bearing + 2.0) as f32, 1.0, 4.0, right).into()])
}

fn flat(level: f32) -> Scene<0> {
    scene_of(Background::plain(level), [])
}

fn noisy(read_noise: f32) -> Exposure {
    Exposure { read_noise, ..Exposure::IDEAL }
}

/// Row 0 without noise.
fn first_row_of<const N: usize>(scene: &Scene<N>, exposure: Exposure) -> Vec<u8> {
    rows_of(scene, exposure, 1, 0..1).remove(0)
}

fn scan(scanner: &mut Scanner, pixels: &[u8]) -> Vec<ScannedPoint> {
    let mut points = Vec::new();
    scanner.scan(pixels, |point| points.push(point));
    points
}

fn only(points: &[ScannedPoint]) -> ScannedPoint {
    let [point] = points else { panic!("one point: {points:?}") };
    *point
}

/// Points within four pixels of a column.
fn near(points: &[ScannedPoint], column: f64) -> Vec<ScannedPoint> {
    points.iter().filter(|point| (column_px(point) - column).abs() < 4.0).copied().collect()
}

fn column_px(point: &ScannedPoint) -> f64 {
    f64::from(point.column_q16) / 65536.0
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

/// Where noise rules, and not the threshold at the edge's flanks.
#[test]
fn the_sigma_of_an_isolated_edge_is_its_noise() {
    for (read_noise, contrast, psf_sigma_px) in
        [(2.0, 40.0, 0.7), (2.0, 150.0, 0.7), (2.0, 150.0, 2.0), (5.0, 100.0, 1.0), (12.0, 150.0, 0.7)]
    {
        let column = 160.3;
        let scene = step(column, [60.0, 60.0 + contrast]);
        let mut scanner = Scanner::new();
        let mut others = 0;
        let (mut count, mut sum, mut squares, mut sigmas) = (0.0, 0.0, 0.0, 0.0);
        for row in rows_of(&scene, Exposure { psf_sigma_px, ..noisy(read_noise) }, 3, 0..480) {
            let points = scan(&mut scanner, &row);
            let point = only(&near(&points, column));
            others += points.len() - 1;
            let error = column_px(&point) - column;
            (count, sum, squares) = (count + 1.0, sum + error, squares + error * error);
            sigmas += f64::from(point.sigma_q16) / 65536.0;
        }
        let mean = sum / count;
        let (deviation, sigma) = (f64::sqrt(squares / count - mean * mean), sigmas / count);
        let case = format!("noise {read_noise}, contrast {contrast}, {psf_sigma_px} px of blur");
        // The formula leaves the shape of the edge out; within a factor of √2 is what a row on its own needs.
        assert!((0.7..1.4).contains(&(deviation / sigma)), "{case}: {deviation} for {sigma}");
        // As in `columns_are_good_to_a_fraction_of_a_pixel`.
        assert!(mean.abs() < 0.05, "{case}: bias {mean}");
        // Four sigma on either side, once in 16000 of the 20 or so independent windows of 480 rows: 0.6, five at most.
        assert!(others <= 5, "{case}: {others} false edges in 480 rows");
    }
}

/// On the average over the rows; from one row to the next it wavers.
#[test]
fn noise_is_estimated() {
    // A median of whole grey levels is coarse where the noise is about a level.
    const MEAN_OFF: f32 = 0.2;
    // Steps of a thirty-second let the median waver by 13 %, four sigma of which are a factor of 1.5; and half a level
    // of rounding on top where the noise is about a level.
    const WORST: f32 = 2.5;
    for read_noise in [0.5_f32, 1.0, 1.5, 2.0, 2.5, 3.0, 5.0, 8.0, 12.0, 20.0] {
        let mut scanner = Scanner::new();
        let (mut sum, mut worst) = (0.0, 0.0_f32);
        let expected = (read_noise * read_noise + 1.0 / 12.0).sqrt();
        for (index, row) in rows_of(&flat(128.0), noisy(read_noise), 5, 0..960).iter().enumerate() {
            scanner.scan(row, |_| {});
            if index >= 48 {
                let ratio = scanner.noise_q8() as f32 / 256.0 / expected;
                sum += ratio / (960.0 - 48.0);
                worst = worst.max(ratio.max(1.0 / ratio));
            }
        }
        println!("noise {read_noise}: {sum}, worst {worst}");
        assert!((sum - 1.0).abs() < MEAN_OFF, "noise {read_noise}: {sum} of it");
        assert!(worst < WORST, "noise {read_noise}: {worst} of it, once");
    }
    let mut scanner = Scanner::new();
    (0..240).for_each(|_| scanner.scan(&[100; 320], |_| {}));
    assert_eq!(scanner.noise_q8(), 74, "rounding alone");
}

#[test]
fn noise_is_no_edge() {
    for read_noise in [0.0, 0.3, 1.0, 2.5, 5.0, 12.0, 25.0] {
        let mut scanner = Scanner::new();
        let rows = rows_of(&flat(128.0), noisy(read_noise), 7, 0..1000);
        let found: usize = rows.iter().map(|row| scan(&mut scanner, row).len()).sum();
        // Four sigma on either side, once in 16000 of the 20 or so independent windows of 1000 rows: 1.2, three at
        // most.
        assert!(found <= 3, "noise {read_noise}: {found} edges in 1000 rows");
    }
}

#[test]
fn the_threshold_follows_the_noise() {
    for (before, after) in [(1.0, 5.0), (1.0, 12.0), (2.5, 25.0)] {
        let mut scanner = Scanner::new();
        for row in rows_of(&flat(128.0), noisy(before), 7, 0..240) {
            scanner.scan(&row, |_| {});
        }
        let rows = rows_of(&flat(128.0), noisy(after), 8, 0..240);
        let found: Vec<usize> = rows.iter().map(|row| scan(&mut scanner, row).len()).collect();
        let later: usize = found[48..].iter().sum();
        // As in `noise_is_no_edge`: 0.2 in 192 rows.
        assert!(later <= 1, "from noise {before} to {after}: {found:?}");
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

/// Bars side by side over a part of the row, seen in motion: the columns of their edges in a row, and those rows.
fn fence(period_px: f64, duty: f64, share: f64, contrast: f32, seed: u64) -> (Vec<Vec<u8>>, impl Fn(u16) -> Vec<f64>) {
    const SPEED_M_S: f32 = 1.5;
    let moving = projection::Scene { velocity_m_s: [f64::from(SPEED_M_S), 0.0, 0.0], ..still() };
    let bars = (f64::from(COLUMNS) * share / period_px) as usize;
    let left = move |bar: usize| (20.0 + period_px * bar as f64 - 159.5) / 300.0;
    let width = duty * period_px / 300.0;
    let mut scene = Scene::<64>::new(Background::plain(40.0)).expect("sound background");
    for bar in 0..bars {
        let middle = left(bar) + width / 2.0;
        scene.push(Bar::upright(middle as f32, 1.0, width as f32, 40.0 + contrast)).expect("a sound bar");
    }
    let setup = moving.setup_read::<f32>(Uncertainty::NONE, ReadoutDirection::TopToBottom);
    let readout = *setup.readout();
    let exposure = Exposure { time_s: 0.002, ..noisy(2.0) };
    let simulator =
        Simulator::new(&scene, setup.camera(), &readout, &moving.motion(), exposure, seed).expect("sound parameters");
    let rows = (0..240).map(|row| {
        let mut pixels = vec![0; COLUMNS.into()];
        simulator.row(row, &mut pixels);
        pixels
    });
    let columns = move |row: u16| {
        let moved = f64::from(SPEED_M_S) * readout.row_time_ns(row) as f64 * 1e-9;
        let edges = (0..bars).flat_map(|bar| [left(bar), left(bar) + width]);
        edges.map(|bearing| 159.5 + 300.0 * (bearing - moved)).collect()
    };
    (rows.collect(), columns)
}

/// However many upright edges there are over the whole row, they are neither noise nor texture, and no period hides
/// them in sums of pixels.
#[test]
fn fences_are_edges() {
    let mut missed = Vec::new();
    for (period_px, duty, share) in
        [(8.0, 0.5, 0.9), (10.0, 0.45, 0.9), (13.0, 0.6, 0.9), (24.0, 0.5, 0.9), (32.0, 0.2, 0.9), (40.0, 0.5, 0.9)]
    {
        for contrast in [60.0_f32, 200.0] {
            let (rows, columns) = fence(period_px, duty, share, contrast, 5);
            let mut scanner = Scanner::new();
            let (mut seen, mut all, mut others) = (0, 0, 0);
            for (row, pixels) in (0..).zip(&rows) {
                let points = scan(&mut scanner, pixels);
                if row < 16 {
                    continue;
                }
                let edges: Vec<f64> =
                    columns(row).into_iter().filter(|column| (12.0..308.0).contains(column)).collect();
                let is_seen = |column: &&f64| points.iter().any(|point| (column_px(point) - **column).abs() < 1.5);
                seen += edges.iter().filter(is_seen).count();
                all += edges.len();
                others += points.len().saturating_sub(edges.len() + 4);
            }
            let case = format!("period {period_px}, duty {duty}, share {share}, contrast {contrast}");
            println!("{case}: {seen} of {all} seen, {others} others, noise {}", scanner.noise_q8());
            if seen * 100 < all * 99 {
                missed.push(case);
            }
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}
