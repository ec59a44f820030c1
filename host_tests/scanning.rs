//! `Scanner`: what of a row is an edge, and what noise, against rendered rows.

use shutter_range::sim::{Background, Bar, Exposure, Object, Scene, Simulator};
use shutter_range::{ReadoutDirection, ScannedPoint, Scanner, Uncertainty};

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
pub(crate) fn rows_of<const N: usize>(
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

pub(crate) fn scene_of<const N: usize>(background: Background, objects: [Object; N]) -> Scene<N> {
    let mut scene = Scene::new(background).expect("sound background");
    for object in objects {
        scene.push(object).expect("a sound object");
    }
    scene
}

/// One level to the left of a column, another to the right of it.
pub(crate) fn step(column: f64, levels: [f32; 2]) -> Scene<1> {
    let [left, right] = levels;
    let bearing = (column - 159.5) / 300.0;
    scene_of(Background::plain(left), [Bar::upright((bearing + 2.0) as f32, 1.0, 4.0, right).into()])
}

fn flat(level: f32) -> Scene<0> {
    scene_of(Background::plain(level), [])
}

pub(crate) fn noisy(read_noise: f32) -> Exposure {
    Exposure { read_noise, ..Exposure::IDEAL }
}

pub(crate) fn scan(scanner: &mut Scanner, pixels: &[u8]) -> Vec<ScannedPoint> {
    let mut points = Vec::new();
    scanner.scan(pixels, |point| points.push(point));
    points
}

pub(crate) fn only(points: &[ScannedPoint]) -> ScannedPoint {
    let [point] = points else { panic!("one point: {points:?}") };
    *point
}

/// Points within four pixels of a column.
pub(crate) fn near(points: &[ScannedPoint], column: f64) -> Vec<ScannedPoint> {
    points.iter().filter(|point| (column_px(point) - column).abs() < 4.0).copied().collect()
}

pub(crate) fn column_px(point: &ScannedPoint) -> f64 {
    f64::from(point.column_q16) / 65536.0
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

/// However narrow the rows are, and wherever it is.
#[test]
fn the_first_row_shows_a_single_edge() {
    for columns in [32_usize, 40, 64, 90, 96, 120, 128, 160, 320] {
        for (edge, contrast) in (10..columns - 10).flat_map(|edge| [40, 110].map(|contrast| (edge, contrast))) {
            // A blurred step and noise of some levels.
            let level = |column: usize| match column.cmp(&edge) {
                std::cmp::Ordering::Less => 60,
                std::cmp::Ordering::Equal => 60 + contrast / 3,
                std::cmp::Ordering::Greater => 60 + contrast,
            };
            let row: Vec<u8> =
                (0..columns).map(|column| level(column) + (column * column * 7 % 11 % 5) as u8).collect();
            let mut columns_px = Vec::new();
            Scanner::new().scan(&row[..], |point: ScannedPoint| columns_px.push(point.column_q16 as f64 / 65536.0));
            let is_it = |column_px: &f64| (column_px - edge as f64).abs() < 1.0;
            assert!(matches!(&columns_px[..], [one] if is_it(one)), "{columns} columns, {edge}: {columns_px:?}");
        }
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
