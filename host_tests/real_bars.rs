//! Bars of `sim` as the world has them: rough, bowed, tapered, round; and lenses that are softer in the corners.

use shutter_range::sim::{Background, Bar, Exposure, Scene, Simulator};
use shutter_range::{ReadoutDirection, Uncertainty};

use crate::projection;

/// VGA, 600 px, at rest or moving to the left.
fn world(speed_m_s: f64) -> projection::Scene {
    projection::Scene { velocity_m_s: [-speed_m_s, 0.0, 0.0], ..projection::Scene::vga() }
}

/// A row of a white bar before black.
fn rows_of(bar: Bar, world: &projection::Scene, start_ns: i64, corner_px: Option<f32>) -> Vec<Vec<u8>> {
    let mut scene = Scene::<1>::new(Background::plain(0.0)).expect("sound background");
    scene.push(bar).expect("a sound bar");
    let setup = world.setup_read::<f32>(Uncertainty::NONE, ReadoutDirection::TopToBottom);
    let simulator = Simulator::new(&scene, setup.camera(), setup.readout(), &world.motion(), Exposure::IDEAL, 1);
    let mut simulator = simulator.expect("sound parameters").at_frame(0, start_ns);
    if let Some(psf_sigma_px) = corner_px {
        simulator = simulator.with_corner_blur(psf_sigma_px).expect("sound blur");
    }
    let row = |row| {
        let mut pixels = vec![0; usize::from(world.columns)];
        simulator.row(row, &mut pixels);
        pixels
    };
    (0..world.rows).map(row).collect()
}

/// A white bar's left and right edge, by the area on each side of its middle.
fn edges(pixels: &[u8], middle: f64) -> [f64; 2] {
    let middle = middle.round();
    let white =
        |range: std::ops::Range<usize>| pixels[range].iter().map(|&pixel| f64::from(pixel) / 255.0).sum::<f64>();
    let at = middle as usize;
    [middle - 0.5 - white(at - 60..at), middle - 0.5 + white(at..at + 60)]
}

/// 2 m away, 600 px: 1 mm is 0.3 px, and a row 3.33 mm.
const PX_PER_M: f64 = 300.0;

/// Both edges of a bar 80 px wide, less their straight lines, row by row.
fn departures(bar: Bar, world: &projection::Scene, start_ns: i64) -> Vec<[f64; 2]> {
    let rows = rows_of(bar, world, start_ns, None);
    let place = |row: u16| {
        let time_s = world.time_s(row) + start_ns as f64 * 1e-9;
        let line = projection::Scene { bearing: 0.0, ..world.clone() };
        line.column_at(f64::from(row), time_s)
    };
    (0..world.rows)
        .map(|row| {
            let middle = place(row);
            let [left, right] = edges(&rows[usize::from(row)], middle);
            [left - middle + 40.0, right - middle - 40.0]
        })
        .collect()
}

fn post() -> Bar {
    Bar::upright(0.0, 2.0, (80.0 / PX_PER_M) as f32, 255.0)
}

#[test]
fn roughness_is_as_stated_and_belongs_to_the_bar() {
    let (sigma_px, length_rows) = (0.25, 10);
    let (mut squares, mut lagged, mut across, mut count) = (0.0, 0.0, 0.0, 0.0);
    for seed in 0..20 {
        let bar = post().rough((sigma_px / PX_PER_M) as f32, (f64::from(length_rows) / PX_PER_M) as f32, seed);
        let off = departures(bar, &world(0.0), 0);
        for row in 0..480 - usize::try_from(length_rows).expect("few") {
            let [left, right] = off[row];
            squares += left * left;
            lagged += left * off[row + 10][0];
            across += left * right;
            count += 1.0;
        }
        if seed < 3 {
            // The same in a later frame, from a camera that moves: its rows are the same stretches of the bar.
            for start_ns in [0, 40_000_000] {
                let moving = departures(bar, &world(1.5), start_ns);
                let same = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
                let largest = off.iter().zip(&moving).map(same).fold(0.0, f64::max);
                assert!(largest < 0.03, "seed {seed}, {start_ns}: {largest} px");
            }
        }
    }
    let sigma = f64::sqrt(squares / count);
    assert!((sigma / sigma_px - 1.0).abs() < 0.06, "{sigma} px");
    assert!((lagged / squares - 0.5).abs() < 0.06, "{}", lagged / squares);
    assert!((across / squares).abs() < 0.08, "{}", across / squares);
}

#[test]
fn bow_is_as_stated() {
    let bar = post().between(-0.5, 0.5).bowed((0.5 / PX_PER_M) as f32);
    let off = departures(bar, &world(1.5), 0);
    for row in 95..385_u16 {
        let part = (f64::from(row) - 239.5) / 150.0;
        let expected = 0.5 * (1.0 - part * part);
        for side in off[usize::from(row)] {
            assert!((side - expected).abs() < 0.02, "row {row}: {side} for {expected}");
        }
    }
}

#[test]
fn tapered_bars_lean_on_both_sides() {
    let slope = 0.34_f64.to_radians().tan();
    let off = departures(post().tapered(slope as f32), &world(1.5), 0);
    for row in [0, 100, 300, 479_u16] {
        let expected = slope * (f64::from(row) - 239.5);
        let [left, right] = off[usize::from(row)];
        assert!((left + expected).abs() < 0.02 && (right - expected).abs() < 0.02, "row {row}: {left}, {right}");
    }
    let mut scene = Scene::<1>::new(Background::plain(0.0)).expect("sound background");
    scene.push(post().leaning(0.01).tapered(0.004)).expect("a sound bar");
    let setup = world(1.5).setup_read::<f32>(Uncertainty::NONE, ReadoutDirection::TopToBottom);
    let motion = world(1.5).motion();
    let simulator = Simulator::new(&scene, setup.camera(), setup.readout(), &motion, Exposure::IDEAL, 1);
    let leans: Vec<f32> = simulator.expect("sound parameters").truth().map(|truth| truth.lean).collect();
    let [left, right] = leans.as_slice() else { panic!("two edges: {leans:?}") };
    assert!((left - 0.006).abs() < 1e-6 && (right - 0.014).abs() < 1e-6, "{leans:?}");
}

/// The cosine of a cylinder across a wide bar, and its limbs where a flat bar has its sides.
#[test]
fn cylinders_are_lit_from_their_side() {
    let wide = Bar::upright(0.0, 2.0, (400.0 / PX_PER_M) as f32, 250.0);
    for degrees in [-120.0, -75.0, 0.0, 40.0, 90.0_f64] {
        let light = degrees.to_radians();
        let rows = rows_of(wide.lit_from(light as f32, 0.2), &world(0.0), 0, None);
        // 319.5 ± 200 px.
        for (column, &pixel) in rows[100].iter().enumerate().take(517).skip(123) {
            let x = (column as f64 - 319.5) / 200.0;
            let lit = (x * light.sin() + (1.0 - x * x).sqrt() * light.cos()).max(0.0);
            let (expected, found) = (250.0 * (0.2 + 0.8 * lit), f64::from(pixel));
            assert!((found - expected).abs() < 1.5, "{degrees} degrees, column {column}: {found} for {expected}");
        }
        assert_eq!([rows[100][110], rows[100][530]], [0, 0]);
        let flat = rows_of(Bar { level: 50.0, ..wide }, &world(0.0), 0, None);
        // The shaded limb of a bar in light from the left or right is as sharp as a flat one.
        if degrees == 90.0 {
            for column in 112..122_usize {
                assert!(rows[100][column].abs_diff(flat[100][column]) <= 2, "column {column}");
            }
        }
    }
}

#[test]
fn lenses_may_be_softer_in_the_corners() {
    let width_of = |bearing: f32, corner_px: Option<f32>, row: usize| {
        // The left edge of a bar that covers all that is on its right.
        let bar = Bar::upright(bearing + 5.0, 2.0, 20.0, 255.0);
        let rows = rows_of(bar, &world(0.0), 0, corner_px);
        let derivative = rows[row].windows(2).map(|pair| (f64::from(pair[1]) - f64::from(pair[0])) / 255.0);
        let [mean, square] = derivative.zip(0_u16..).fold([0.0, 0.0], |[mean, square], (share, column)| {
            let x = f64::from(column);
            [mean + x * share, square + x * x * share]
        });
        (square - mean * mean - 1.0 / 6.0).sqrt()
    };
    let corner = 319.5_f64.hypot(239.5);
    for (bearing, row) in [(0.0, 240), (0.4, 240), (0.5, 5), (-0.5, 475), (0.2, 100)] {
        let radius = (600.0 * f64::from(bearing)).hypot(row as f64 - 239.5);
        let expected = (0.25 + (1.5 * 1.5 - 0.25) * (radius / corner).powi(2)).sqrt();
        let found = width_of(bearing, Some(1.5), row);
        assert!((found / expected - 1.0).abs() < 0.03, "{bearing}, row {row}: {found} px for {expected}");
        let plain = width_of(bearing, None, row);
        assert!((plain / 0.5 - 1.0).abs() < 0.03, "{plain}");
    }
}
