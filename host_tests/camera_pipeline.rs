//! `sim::Pipeline`: rows that stream through a camera, against whole frames in double precision.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use shutter_range::sim::{Pipeline, Stage, ToneCurve};

const COLUMNS: usize = 24;

type Image = Vec<[u16; COLUMNS]>;

fn processed<const STAGES: usize>(stages: [Stage; STAGES], image: &Image) -> Vec<[u8; COLUMNS]> {
    let mut camera = Pipeline::<COLUMNS, STAGES>::new(stages).expect("sound stages");
    let mut rows = Vec::new();
    // A frame before it leaves no trace.
    camera.row(&[u16::MAX; COLUMNS], |_| ());
    camera.end_frame(|_| ());
    for row in image {
        camera.row(row, |pixels| rows.push(*pixels));
    }
    camera.end_frame(|pixels| rows.push(*pixels));
    rows
}

/// Flat patches and steps under noise, 40 to 215 grey levels.
fn image(rows: usize) -> Image {
    let mut random = StdRng::seed_from_u64(rows as u64);
    let pixel = |random: &mut StdRng, row: usize, column: usize| {
        let level = if (row / 5 + column / 7).is_multiple_of(2) { 60.0 } else { 190.0 };
        ((level + random.random_range(-20.0..25.0)) * 256.0) as u16
    };
    (0..rows).map(|row| std::array::from_fn(|column| pixel(&mut random, row, column))).collect()
}

/// Grey levels of a pixel; beyond the borders those of the nearest one.
fn at(image: &Image, row: isize, column: isize) -> f64 {
    let row = row.clamp(0, image.len() as isize - 1) as usize;
    f64::from(image[row][column.clamp(0, COLUMNS as isize - 1) as usize]) / 256.0
}

/// Compares every pixel with what it should be, to half a grey level for the rounding and a little for the steps
/// before.
fn assert_is(stage: Stage, expected: impl Fn(&Image, isize, isize) -> f64) {
    for rows in [1, 2, 3, 4, 30] {
        let image = image(rows);
        let out = processed([stage], &image);
        assert_eq!(out.len(), rows, "{stage:?}");
        for (row, pixels) in out.iter().enumerate() {
            for (column, &pixel) in pixels.iter().enumerate() {
                let want = expected(&image, row as isize, column as isize).clamp(0.0, 255.0);
                let off = (f64::from(pixel) - want).abs();
                assert!(off < 0.51, "{stage:?}, row {row} of {rows}, column {column}: {pixel} for {want}");
            }
        }
    }
}

fn weighted_mean<const N: usize>(image: &Image, row: isize, column: isize, weights: [f64; N]) -> f64 {
    let reach = (N / 2) as isize;
    let total: f64 = weights.iter().sum();
    let mut sum = 0.0;
    for (down, vertical) in (-reach..).zip(weights) {
        for (right, horizontal) in (-reach..).zip(weights) {
            sum += vertical * horizontal * at(image, row + down, column + right);
        }
    }
    sum / (total * total)
}

#[test]
fn sharpening() {
    for strength in [0.5, 1.0, 1.5] {
        let unsharp = |here: f64, mean: f64| here + f64::from(strength) * (here - mean);
        assert_is(Stage::Sharpen3(strength), |image, row, column| {
            unsharp(at(image, row, column), weighted_mean(image, row, column, [1.0, 2.0, 1.0]))
        });
        assert_is(Stage::Sharpen5(strength), |image, row, column| {
            unsharp(at(image, row, column), weighted_mean(image, row, column, [2.0, 4.0, 5.0, 4.0, 2.0]))
        });
    }
}

fn around(image: &Image, row: isize, column: isize) -> Vec<f64> {
    let beside = |down| [-1, 0, 1].map(|right| at(image, row + down, column + right));
    [-1, 0, 1].into_iter().flat_map(beside).collect()
}

#[test]
fn denoising() {
    assert_is(Stage::Median, |image, row, column| {
        let mut levels = around(image, row, column);
        levels.sort_by(f64::total_cmp);
        levels[4]
    });
    assert_is(Stage::Bilateral(12.0), |image, row, column| {
        let here = at(image, row, column);
        let weight = |level: f64| 1.0 / (1.0 + ((level - here) / 12.0).powi(2));
        let levels = around(image, row, column);
        levels.iter().map(|&level| weight(level) * level).sum::<f64>()
            / levels.iter().map(|&level| weight(level)).sum::<f64>()
    });
}

/// Each colour from its own pixels alone, by name.
#[test]
fn mosaic() {
    let colour = |row: isize, column: isize| match (row.rem_euclid(2), column.rem_euclid(2)) {
        (0, 0) => 'R',
        (1, 1) => 'B',
        _ => 'G',
    };
    assert_is(Stage::Mosaic, |image, row, column| {
        // The nearest pixels of a colour: the pixel itself, else its four neighbours, else the diagonal ones.
        let mean_of = |wanted: char| {
            let rings: [&[(isize, isize)]; 3] =
                [&[(0, 0)], &[(-1, 0), (1, 0), (0, -1), (0, 1)], &[(-1, -1), (-1, 1), (1, -1), (1, 1)]];
            let of_ring = |ring: &[(isize, isize)]| -> Vec<f64> {
                let is_wanted = |(down, right): &&(isize, isize)| colour(row + *down, column + *right) == wanted;
                ring.iter().filter(is_wanted).map(|(down, right)| at(image, row + down, column + right)).collect()
            };
            let nearest = rings.into_iter().map(of_ring).find(|levels| !levels.is_empty()).expect("within 3 x 3");
            nearest.iter().sum::<f64>() / nearest.len() as f64
        };
        0.3008 * mean_of('R') + 0.5859 * mean_of('G') + 0.1133 * mean_of('B')
    });
}

#[test]
fn tone_curves() {
    let logistic = |x: f64| 1.0 / (1.0 + (-10.0 * (x - 0.43)).exp());
    let s_curve = ToneCurve::S { middle: 0.43, steepness: 10.0 };
    assert_is(Stage::Tone(ToneCurve::Srgb), |image, row, column| {
        255.0 * (1.055 * (at(image, row, column) / 255.0).powf(1.0 / 2.4) - 0.055)
    });
    assert_is(Stage::Tone(ToneCurve::Gamma(2.2)), |image, row, column| {
        255.0 * (at(image, row, column) / 255.0).powf(1.0 / 2.2)
    });
    assert_is(Stage::Tone(s_curve), |image, row, column| {
        255.0 * (logistic(at(image, row, column) / 255.0) - logistic(0.0)) / (logistic(1.0) - logistic(0.0))
    });
    for curve in [ToneCurve::Srgb, ToneCurve::Gamma(2.2), s_curve] {
        let mut ends = [0; COLUMNS];
        (ends[0], ends[1]) = (255 << 8, u16::MAX);
        let out = processed([Stage::Tone(curve)], &vec![ends]);
        assert_eq!(out[0][..3], [255, 255, 0], "{curve:?}");
    }
}

#[test]
fn gain_clips() {
    assert_is(Stage::Gain(1.5), |image, row, column| 1.5 * at(image, row, column));
    assert_is(Stage::Gain(0.25), |image, row, column| 0.25 * at(image, row, column));
}

/// As large as stated, alike in all rows, and others for another seed.
#[test]
fn column_offsets() {
    let flat = |seed| {
        let mut camera = Pipeline::<4000, 1>::new([Stage::ColumnOffsets { sigma: 3.0, seed }]).expect("sound");
        let mut rows = Vec::new();
        for _ in 0..3 {
            camera.row(&[100 << 8; 4000], |pixels| rows.push(pixels.map(f64::from)));
        }
        camera.end_frame(|_| ());
        rows
    };
    let (rows, others) = (flat(1), flat(2));
    assert!(rows.iter().all(|row| *row == rows[0]) && rows.len() == 3);
    let mean_of = |product: &dyn Fn(usize) -> f64| (0..3999).map(product).sum::<f64>() / 3999.0;
    let [variance, neighbours, other] = [
        mean_of(&|column| (rows[0][column] - 100.0).powi(2)),
        mean_of(&|column| (rows[0][column] - 100.0) * (rows[0][column + 1] - 100.0)),
        mean_of(&|column| (rows[0][column] - 100.0) * (others[0][column] - 100.0)),
    ];
    assert!((variance - 9.0 - 1.0 / 12.0).abs() < 0.6, "{variance}");
    assert!(neighbours.abs() < 0.6 && other.abs() < 0.6, "{neighbours}, {other}");
}

/// Stages one after the other are the same as each by itself, but for the rounding between them.
#[test]
fn stages_in_their_order() {
    let image = image(30);
    let [first, second] = [Stage::Gain(1.3), Stage::Sharpen5(0.7)];
    let between = processed([first], &image).iter().map(|row| row.map(|level| u16::from(level) << 8)).collect();
    let (apart, together) = (processed([second], &between), processed([first, second], &image));
    assert_eq!(together.len(), 30);
    for (apart, together) in apart.iter().zip(&together) {
        assert!(apart.iter().zip(together).all(|(a, b)| a.abs_diff(*b) <= 2), "{apart:?} {together:?}");
    }
    let other_order = processed([second, first], &image);
    assert_ne!(other_order, together);
    let five = processed([Stage::Mosaic, Stage::Median, Stage::Tone(ToneCurve::Srgb), second, first], &image);
    assert_eq!(five.len(), 30);
}

#[test]
fn nonsense_is_refused_by_name() {
    let name = |stage| Pipeline::<8, 1>::new([stage]).expect_err("nonsense").parameter;
    assert_eq!(name(Stage::Gain(-1.0)), "gain");
    assert_eq!(name(Stage::Sharpen3(f32::NAN)), "strength");
    assert_eq!(name(Stage::Sharpen5(-0.1)), "strength");
    assert_eq!(name(Stage::Bilateral(0.0)), "sigma");
    assert_eq!(name(Stage::ColumnOffsets { sigma: -1.0, seed: 0 }), "sigma");
    assert_eq!(name(Stage::Tone(ToneCurve::Gamma(0.0))), "gamma");
    assert_eq!(name(Stage::Tone(ToneCurve::S { middle: 0.5, steepness: 0.0 })), "steepness");
    assert_eq!(name(Stage::Tone(ToneCurve::S { middle: 2.0, steepness: 5.0 })), "middle");
}
