//! `sim`: rendered rows against the projection, the blur and the noise.

use shutter_range::sim::{Background, Bar, Exposure, Object, Rail, Scene, Simulator, Swing};
use shutter_range::{Motion, ReadoutDirection, Uncertainty};

use crate::projection;
use crate::scenes::range_of;

/// A white half-plane, whose left edge is the edge of a projected scene, before black.
fn half_plane(world: &projection::Scene) -> Scene<1> {
    let width_m = 4.0 * world.depth_m;
    let bar = Bar::upright((world.bearing + 2.0) as f32, world.depth_m as f32, width_m as f32, 255.0);
    scene_of(0.0, [bar.leaning(world.tilt as f32).into()])
}

pub(crate) fn scene_of<const N: usize>(background: f32, objects: [Object; N]) -> Scene<N> {
    let mut scene = Scene::new(Background::plain(background)).expect("sound background");
    for object in objects {
        scene.push(object).expect("sound object");
    }
    scene
}

pub(crate) fn simulator<'a, const N: usize>(
    scene: &'a Scene<N>,
    world: &projection::Scene,
    direction: ReadoutDirection,
    exposure: Exposure,
) -> Simulator<'a, N> {
    let setup = world.setup_read::<f32>(Uncertainty::NONE, direction);
    Simulator::new(scene, setup.camera(), setup.readout(), &world.motion(), exposure, 1).expect("sound parameters")
}

pub(crate) fn row_of<const N: usize>(simulator: &Simulator<'_, N>, row: u16, columns: u16) -> Vec<u8> {
    let mut pixels = vec![0; columns.into()];
    simulator.row(row, &mut pixels);
    pixels
}

fn frame_of<const N: usize>(simulator: &Simulator<'_, N>, world: &projection::Scene) -> Vec<Vec<u8>> {
    (0..world.rows).map(|row| row_of(simulator, row, world.columns)).collect()
}

/// Most error of the column of a single row: the five or so pixels of a flank are rounded to 1/255 of the step,
/// √(5/12)/255 px in all, at four sigma.
const ERROR_OF_ROW_PX: f64 = 0.01;

/// Where a black-to-white edge lies, by the white area within `reach` pixels of where it should be.
fn by_area(pixels: &[u8], expected: f64, reach: f64) -> Option<f64> {
    let (from, to) = ((expected - reach).floor(), (expected + reach).ceil());
    if from < 0.0 || to >= pixels.len() as f64 {
        return None;
    }
    let window = &pixels[from as usize..to as usize];
    Some(to - 0.5 - window.iter().map(|&pixel| f64::from(pixel) / 255.0).sum::<f64>())
}

fn worlds() -> [(&'static str, projection::Scene); 8] {
    let vga = projection::Scene::vga;
    let pitched = [0.0, f64::cos(0.2), f64::sin(0.2)];
    let rolled = [f64::sin(0.15), f64::cos(0.15), 0.0];
    [
        ("at rest", projection::Scene { velocity_m_s: [0.0; 3], ..vga() }),
        ("parallel", vga()),
        ("forward", projection::Scene { velocity_m_s: [0.0, 0.0, 3.0], bearing: 0.3, ..vga() }),
        ("oblique", projection::Scene { velocity_m_s: [2.0, 0.3, 1.5], bearing: -0.2, depth_m: 1.3, ..vga() }),
        ("rotating", projection::Scene { rate_rad_s: [0.3, -0.6, 0.4], ..vga() }),
        ("pitched", projection::Scene { gravity: pitched, ..vga() }),
        ("rolled", projection::Scene { gravity: rolled, rate_rad_s: [0.1, 0.2, -0.3], ..vga() }),
        ("leaning", projection::Scene { tilt: -0.3, ..vga() }),
    ]
}

#[test]
fn edges_are_where_the_projection_says() {
    for (name, world) in worlds() {
        for exposure in [Exposure::IDEAL, Exposure { time_s: 0.001, ..Exposure::IDEAL }] {
            let scene = half_plane(&world);
            let simulator = simulator(&scene, &world, ReadoutDirection::TopToBottom, exposure);
            let (mut count, mut squares, mut sum) = (0.0, 0.0, 0.0);
            for row in world.visible_rows() {
                let expected = world.column(row);
                if let Some(found) = by_area(&row_of(&simulator, row, world.columns), expected, 6.0) {
                    let error = found - expected;
                    assert!(error.abs() < ERROR_OF_ROW_PX, "{name}, row {row}: {found} for {expected}");
                    (count, squares, sum) = (count + 1.0, squares + error * error, sum + error);
                }
            }
            let (mean, rms) = (sum / count, f64::sqrt(squares / count));
            assert!(count > 300.0, "{name}: {count} rows");
            // Rounding of the flank, √(5/12)/255 px, and six sigma of its mean over 300 rows.
            assert!(f64::abs(mean) < 0.001 && rms < 0.004, "{name}: mean {mean}, RMS {rms}");
        }
    }
}

#[test]
fn edges_read_from_the_bottom_are_where_the_projection_says() {
    for (name, world) in worlds() {
        let scene = half_plane(&world);
        let simulator = simulator(&scene, &world, ReadoutDirection::BottomToTop, Exposure::IDEAL);
        for row in (0..world.rows).step_by(7) {
            let expected = world.column_at(f64::from(row), world.time_s(world.rows - 1 - row));
            if let Some(found) = by_area(&row_of(&simulator, row, world.columns), expected, 6.0) {
                assert!((found - expected).abs() < ERROR_OF_ROW_PX, "{name}, row {row}: {found} for {expected}");
            }
        }
    }
}

/// A wide image far from its middle: single precision must not show.
#[test]
fn wide_images_keep_their_precision() {
    let world = projection::Scene {
        columns: 1920,
        rows: 1080,
        focal_px: 1100.0,
        cx: 959.5,
        cy: 539.5,
        bearing: 0.83,
        velocity_m_s: [0.2, 0.0, 0.0],
        ..projection::Scene::vga()
    };
    let scene = half_plane(&world);
    let simulator = simulator(&scene, &world, ReadoutDirection::TopToBottom, Exposure::IDEAL);
    let rows: Vec<u16> = (0..world.rows).collect();
    let error = |row: &u16| {
        let expected = world.column(*row);
        by_area(&row_of(&simulator, *row, world.columns), expected, 6.0).expect("in the image") - expected
    };
    let mean = rows.iter().map(error).sum::<f64>() / 1080.0;
    // Rounding to grey levels in 1080 rows, at six sigma; columns near 1900 have steps of 0.0001 px in single
    // precision.
    assert!(mean.abs() < 0.0005, "{mean}");
}

/// Second moment of the derivative along the row, mean over the rows; the pixel's box and the difference of neighbours
/// add 1/12 each.
fn variance_of_edge(world: &projection::Scene, exposure: Exposure, rows: impl Iterator<Item = u16>) -> f64 {
    let scene = half_plane(world);
    let simulator = simulator(&scene, world, ReadoutDirection::TopToBottom, exposure);
    let (mut sum, mut count) = (0.0, 0.0);
    for row in rows {
        let pixels = row_of(&simulator, row, world.columns);
        let derivative = pixels
            .windows(2)
            .zip(0..)
            .map(|(pair, column)| (f64::from(column) + 0.5, (f64::from(pair[1]) - f64::from(pair[0])) / 255.0));
        let [mean, square] = derivative.fold([0.0, 0.0], |[m, s], (x, d)| [m + x * d, s + x * x * d]);
        sum += square - mean * mean - 1.0 / 6.0;
        count += 1.0;
    }
    sum / count
}

#[test]
fn blur_is_motion_and_lens() {
    let rows = || 140..340_u16;
    for (name, world) in worlds() {
        for (time_s, psf_sigma_px) in [(0.0, 1.2), (0.004, 0.6), (0.008, 0.8), (0.012, 2.0)] {
            let exposure = Exposure { time_s, psf_sigma_px, ..Exposure::IDEAL };
            let [mut motion, mut lens] = [0.0, 0.0];
            for row in rows() {
                let (y, t, half) = (f64::from(row), world.time_s(row), 0.5 * f64::from(time_s));
                let path = world.column_at(y, t + half) - world.column_at(y, t - half);
                let slope = world.column_at(y + 0.5, t) - world.column_at(y - 0.5, t);
                let psf = f64::from(psf_sigma_px);
                motion += path * path / 12.0 / rows().len() as f64;
                lens += (psf * psf * (1.0 + slope * slope) + slope * slope / 12.0) / rows().len() as f64;
            }
            let found = variance_of_edge(&world, exposure, rows());
            // 2 % of a width, what the range solver grants to the shape of a blur, are 4 % of its square.
            let ratio = found / (motion + lens);
            assert!((ratio - 1.0).abs() < 0.04, "{name}, {exposure:?}: {found} for {motion} + {lens}");
        }
    }
}

/// The lean of an edge makes a slope but no motion blur.
#[test]
fn leaning_edges_blur_like_upright_ones() {
    let exposure = Exposure { time_s: 0.008, ..Exposure::IDEAL };
    let upright = variance_of_edge(&projection::Scene::vga(), exposure, 140..340);
    for degrees in [-8.0, 8.0_f64] {
        let leaning = projection::Scene { tilt: degrees.to_radians().tan(), ..projection::Scene::vga() };
        let ratio = variance_of_edge(&leaning, exposure, 140..340) / upright;
        // Along the row, a slope of 8° adds 0.007 px² of lens and pixel to 1.33 px² of lens and motion.
        assert!((ratio - 1.0).abs() < 0.01, "{degrees} degrees: {ratio}");
    }
}

#[test]
fn noise_is_shot_and_read_and_rounding() {
    let world = projection::Scene::vga();
    for (level, read_noise, shot_gain) in [(100.0, 2.0, 0.0), (100.0, 0.0, 0.1), (30.0, 1.5, 0.2), (200.0, 0.8, 0.05)] {
        let scene = scene_of(level, []);
        let exposure = Exposure { read_noise, shot_gain, ..Exposure::IDEAL };
        let simulator = simulator(&scene, &world, ReadoutDirection::TopToBottom, exposure);
        let frames = [0, 1].map(|frame| frame_of(&simulator.clone().at_frame(frame, 0), &world));
        let noise = |frame: usize, row: usize, column: usize| f64::from(frames[frame][row][column]) - f64::from(level);
        // Itself, the neighbours to the right and below, and the next frame.
        let mut products = [0.0; 4];
        let mut sum = 0.0;
        let (rows, columns) = (400, 600);
        for row in 0..rows {
            for column in 0..columns {
                let here = noise(0, row, column);
                let others = [here, noise(0, row, column + 1), noise(0, row + 1, column), noise(1, row, column)];
                products.iter_mut().zip(others).for_each(|(product, other)| *product += here * other);
                sum += here;
            }
        }
        let count = (rows * columns) as f64;
        let [variance, others @ ..] = products.map(|product| product / count);
        let expected = f64::from(read_noise * read_noise + shot_gain * level) + 1.0 / 12.0;
        // Rounding adds 1/12 only where the noise is large; √(2/n) of 240000 pixels is 0.3 %.
        assert!((variance / expected - 1.0).abs() < 0.05, "{variance} for {expected}");
        // Three sigma: at most 3.3 grey levels over √n.
        assert!((sum / count).abs() < 0.02, "mean {}", sum / count);
        for other in others {
            // Five sigma: 1/√n.
            assert!((other / variance).abs() < 0.01, "correlated with a neighbour: {}", other / variance);
        }
    }
}

pub(crate) fn still() -> projection::Scene {
    projection::Scene { velocity_m_s: [0.0; 3], ..projection::Scene::vga() }
}

/// The upper edge of a rail before a camera that is rolled, column by column.
#[test]
fn rails_slant_when_the_camera_rolls() {
    let (roll, world) = (0.1_f64, still());
    let world = projection::Scene { gravity: [roll.sin(), roll.cos(), 0.0], ..world };
    let scene = scene_of(0.0, [Rail { depth_m: 2.0, top_m: 0.1, bottom_m: 4.0, level: 255.0 }.into()]);
    let simulator = simulator(&scene, &world, ReadoutDirection::TopToBottom, Exposure::IDEAL);
    let frame = frame_of(&simulator, &world);
    for column in [0, 100, 320, 639] {
        let expected = 239.5 + 600.0 * (0.1 / 2.0) - roll.tan() * (column as f64 - 319.5);
        let down: Vec<u8> = frame.iter().map(|row| row[column]).collect();
        let found = by_area(&down, expected, 6.0).expect("in the image");
        assert!((found - expected).abs() < ERROR_OF_ROW_PX, "column {column}: {found} for {expected}");
    }
}

/// They move down the image while it is read, and are blurred over their path.
#[test]
fn vertical_motion_moves_rails_and_ends() {
    let world = projection::Scene { velocity_m_s: [0.0, -1.5, 0.0], ..projection::Scene::vga() };
    let exposure = Exposure { time_s: 0.008, ..Exposure::IDEAL };
    let rail = scene_of(0.0, [Object::from(Rail { depth_m: 2.0, top_m: 0.1, bottom_m: 9.0, level: 255.0 })]);
    let bar = scene_of(0.0, [Object::from(Bar::upright(0.0, 2.0, 1.0, 255.0).between(0.1, 9.0))]);
    // Row y is read at y · line time; at that time the edge is at 269.5 + 450 t px.
    let per_row = 450.0 / 30.0 / 480.0;
    let expected = 269.5 / (1.0 - per_row);
    let blur = 3.6 / (1.0 - per_row);
    for scene in [&rail, &bar] {
        let simulator = simulator(scene, &world, ReadoutDirection::TopToBottom, exposure);
        let down: Vec<u8> = (0..480).map(|row| row_of(&simulator, row, 640)[320]).collect();
        let found = by_area(&down, expected, 8.0).expect("in the image");
        // Rounding of the flank's eight pixels, √(8/12)/255 px, at six sigma.
        assert!((found - expected).abs() < 0.02, "{found} for {expected}");
        let mean = |power: i32| -> f64 {
            let slope = |(index, pair): (usize, &[u8])| {
                (index as f64 + 0.5 - expected).powi(power) * (f64::from(pair[1]) - f64::from(pair[0])) / 255.0
            };
            down.windows(2).enumerate().map(slope).sum()
        };
        let variance = mean(2) - mean(1) * mean(1);
        let lens = (0.25 + 1.0 / 12.0) / (1.0 - per_row) / (1.0 - per_row) + 1.0 / 12.0;
        let ratio = (variance - lens) / (blur * blur / 12.0);
        // Rounding of the flank's pixels up to 5 px away, in the second moment: 0.07 px² of 1.1 px².
        assert!((ratio - 1.0).abs() < 0.1, "{variance} for {lens} + {}", blur * blur / 12.0);
    }
}

/// Rows, truth and the motion in the later frame's own axes agree.
#[test]
fn later_frames_continue_the_motion() {
    let world = projection::Scene {
        velocity_m_s: [1.0, 0.2, 0.8],
        rate_rad_s: [0.2, -0.3, 0.3],
        gravity: [0.05, 0.97, 0.2].map(|c: f64| c / (0.05_f64 * 0.05 + 0.97 * 0.97 + 0.04).sqrt()),
        ..projection::Scene::vga()
    };
    let start_s = 0.2;
    let scene = half_plane(&world);
    let simulator = simulator(&scene, &world, ReadoutDirection::TopToBottom, Exposure::IDEAL).at_frame(6, 200_000_000);
    let truth = simulator.truth().next().expect("seen");
    let motion = simulator.motion().expect("moderate");
    let vector = |v: [f32; 3]| v.map(f64::from);
    let later = projection::Scene {
        velocity_m_s: vector(motion.velocity_m_s()),
        rate_rad_s: vector(motion.rate_rad_s()),
        gravity: vector(motion.gravity()),
        bearing: truth.bearing,
        depth_m: truth.depth_m,
        ..world.clone()
    };
    for row in (0..480).step_by(13) {
        let expected = world.column_at(f64::from(row), start_s + world.time_s(row));
        // The motion comes in single precision: 1e-7 of a column, and of all that moves it.
        assert!((later.column(row) - expected).abs() < 0.001, "row {row}: {} for {expected}", later.column(row));
        if let Some(found) = by_area(&row_of(&simulator, row, 640), expected, 6.0) {
            assert!((found - expected).abs() < ERROR_OF_ROW_PX, "row {row}: {found} for {expected}");
        }
    }
}

/// A camera that turns about down: what it sees far away goes the
/// other way by as much as its rate says, and gravity stays.
#[test]
fn a_swing_turns_the_camera_about_down() {
    let scene = scene_of(0.0, [Bar::upright(0.1, 1000.0, 20.0, 200.0).into()]);
    let world = still();
    let swinging = |frequency_hz| {
        simulator(&scene, &world, ReadoutDirection::TopToBottom, Exposure::default())
            .with_swing(Swing { angle_rad: 0.2, frequency_hz })
    };
    let swing = swinging(0.8).expect("a sound swing");
    let azimuth = |time_ms: i64| {
        let at = swing.clone().at_frame(0, time_ms * 1_000_000);
        at.truth().next().expect("the bar").bearing.atan()
    };
    let mut most = 0.0_f64;
    for time_ms in (0..2500).step_by(130) {
        let motion = swing.clone().at_frame(0, time_ms * 1_000_000).motion().expect("a motion");
        let [wx, wy, wz] = motion.rate_rad_s();
        assert!(wx == 0.0 && wz == 0.0 && motion.gravity() == [0.0, 1.0, 0.0], "{motion:?}");
        let turned = (azimuth(time_ms + 1) - azimuth(time_ms - 1)) / 0.002;
        assert!((turned + f64::from(wy)).abs() < 1e-3, "{time_ms} ms: {turned} for {wy}");
        most = most.max(f64::from(wy).abs());
    }
    assert!((1.0..1.7).contains(&most), "{most}");
    assert_eq!(swinging(f32::NAN).map(|_| ()).expect_err("no frequency").parameter, "frequency_hz");
}

/// The estimator on points measured in rendered rows.
#[test]
fn the_range_finder_finds_the_truth() {
    let world = projection::Scene { rate_rad_s: [0.1, -0.2, 0.1], ..projection::Scene::vga() };
    let scene = half_plane(&world);
    let exposure = Exposure { time_s: 0.003, ..Exposure::IDEAL };
    let simulator = simulator(&scene, &world, ReadoutDirection::TopToBottom, exposure);
    let truth = simulator.truth().next().expect("seen");
    let points: Vec<_> = (truth.first_row..=truth.last_row)
        .filter_map(|row| {
            let found = by_area(&row_of(&simulator, row, world.columns), world.column(row), 8.0)?;
            Some(world.point_at(row, found))
        })
        .collect();
    let found = range_of::<f32>(&world, Uncertainty::NONE, &points).estimate;
    // Points rounded to 0.004 px in 480 rows with a skew of 15 px: 6e-5, and 1e-6 of bearing, but alike from row to
    // row.
    assert!((f64::from(found.inverse_depth_per_m) * truth.depth_m - 1.0).abs() < 0.002, "{found:?} for {truth:?}");
    assert!((f64::from(found.bearing) - truth.bearing).abs() < 1e-4, "{found:?} for {truth:?}");
}
