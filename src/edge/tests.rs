//! A tracked edge against rendered rows: column, width, and what is stated of them.

use super::model::EdgeModel;
use super::pixel_row::PixelRow;
use super::window::Neighbours;
use crate::sim::{Background, Bar, Exposure, Scene, Simulator};
use crate::{Camera, Distortion, EdgePoint, Intrinsics, Line, Readout, Response, Scanner, Twist};

fn row_of(pixels: &[u8]) -> PixelRow<'_, &[u8]> {
    PixelRow { pixels, response: &Response::Linear }
}

const ROWS: u16 = 240;
const FOCAL_PX: f32 = 300.0;
const SPEED_M_S: f32 = 1.5;
/// Rows that may be refused while levels and blur settle.
const SETTLING: u16 = 16;

/// What came out of the rows of one edge.
struct Outcome {
    mean_width_px: f64,
    /// Standard deviations of the rows' columns and widths, and what is stated for the column.
    column_px: f64,
    width_px: f64,
    stated_px: f64,
}

fn deviation(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    libm::sqrt(values.map(|value| (value - mean) * (value - mean)).sum::<f64>() / (count - 1.0))
}

/// An edge 1 m away that a lens blurs and the exposure smears over `path_px`, row after row where it is.
fn follow(lens_px: f32, path_px: f32, seed: u64) -> Outcome {
    let camera = Camera::new(Intrinsics::centred(320, ROWS, FOCAL_PX), Distortion::NONE).unwrap();
    let readout = Readout::from_frame_readout_ns(ROWS, 33_333_333, Default::default()).unwrap();
    let exposure =
        Exposure { time_s: path_px / (FOCAL_PX * SPEED_M_S), psf_sigma_px: lens_px, read_noise: 2.0, shot_gain: 0.03 };
    let mut scene = Scene::<1>::new(Background::plain(60.0)).unwrap();
    scene.push(Bar::upright(2.02, 1.0, 4.0, 170.0)).unwrap();
    let motion = Twist::level([SPEED_M_S, 0.0, 0.0]).unwrap();
    let simulator = Simulator::new(&scene, &camera, &readout, &motion, exposure, seed).unwrap();
    let column = |row| {
        let time_s = readout.row_time_ns(row) as f64 * 1e-9;
        159.5 + f64::from(FOCAL_PX) * (0.02 - f64::from(SPEED_M_S) * time_s)
    };
    let (mut scanner, mut pixels) = (Scanner::new(), [0; 320]);
    simulator.row(0, &mut pixels);
    let mut first = EdgePoint::new(0, 0, 0);
    scanner.scan(&pixels, |point| first = point.at(0, 0));
    let mut model = EdgeModel::settled(row_of(&pixels), &first, Neighbours::NONE, scanner.noise_q8()).unwrap();
    let mut line: Line<16> = Line::new(first);
    let mut found = [(0.0, 0.0, 0.0); ROWS as usize];
    for row in 1..ROWS {
        simulator.row(row, &mut pixels);
        let expected_q16 = (column(row) * 65536.0) as i64;
        let Some(point) = model.locate(row_of(&pixels), expected_q16, 1 << 17, 0, Neighbours::NONE) else {
            assert!(row < SETTLING, "lens {lens_px}, path {path_px}, seed {seed}: row {row}");
            continue;
        };
        let error_px = f64::from(point.column_q16) / 65536.0 - column(row);
        let sigma_px = f64::from(point.sigma_q16) / 65536.0;
        found[usize::from(row)] = (error_px, f64::from(point.width_q8) / 256.0, sigma_px);
        line.push(point.at(row, readout.row_time_ns(row))).unwrap();
    }
    // As the line's mean, which leaves out the rows in which the model settles.
    let settled = &found[SETTLING.into()..];
    Outcome {
        mean_width_px: line.mean_width_px().unwrap(),
        column_px: deviation(settled.iter().map(|row| row.0)),
        width_px: deviation(settled.iter().map(|row| row.1)),
        stated_px: settled.iter().map(|row| row.2).sum::<f64>() / settled.len() as f64,
    }
}

/// The width is a measurement of its own, whatever the lens and the motion: a line's mean over n rows has √n times less
/// noise than each row's.
#[test]
fn widths_are_unbiased_and_as_noisy_as_stated() {
    const LINES: u8 = 12;
    // Half of the 2 % of its square that the range solver grants to the shape of a blur.
    const BIAS: f64 = 0.01;
    // Six sigma of a deviation from 12 lines of 224 rows: 1/√(2 · 12 · 224) each.
    const COLUMNS: core::ops::Range<f64> = 0.92..1.08;
    // A width has one to two times the noise of its column, as the range solver has it.
    const WIDTHS: core::ops::Range<f64> = 0.9..2.0;
    // Within three sigma of a deviation from 12 lines: 1/√(2 · 11) each.
    const MEANS: core::ops::Range<f64> = 0.4..1.5;
    for lens_px in [0.5, 0.7, 1.0] {
        for path_px in [0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 28.0] {
            let variance = lens_px * lens_px + (1.0 + path_px * path_px) / 12.0;
            let width_px = libm::sqrt(f64::from(variance));
            let lines = || (1..=LINES).map(|seed| follow(lens_px, path_px, seed.into()));
            let mean = |value: fn(&Outcome) -> f64| lines().map(|line| value(&line)).sum::<f64>() / f64::from(LINES);
            let bias = mean(|line| line.mean_width_px) / width_px - 1.0;
            let column = mean(|line| line.column_px) / mean(|line| line.stated_px);
            let width = mean(|line| line.width_px) / mean(|line| line.stated_px);
            let means: heapless::Vec<f64, 12> = lines().map(|line| line.mean_width_px).collect();
            let rows = f64::from(ROWS - SETTLING);
            let line = deviation(means.into_iter()) * libm::sqrt(rows) / mean(|line| line.width_px);
            let of = format_args!("lens {lens_px}, path {path_px}");
            assert!(bias.abs() < BIAS, "{of}: bias {bias:+.4}");
            assert!(COLUMNS.contains(&column), "{of}: columns {column:.3} of their sigma");
            assert!(WIDTHS.contains(&width), "{of}: widths {width:.3} of the column's sigma");
            assert!(MEANS.contains(&line), "{of}: a line's width {line:.2} of what its rows' say");
        }
    }
}
