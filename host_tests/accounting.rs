//! Nothing is lost uncounted: points taken = points of the lines handed out + stray points + dropped points.

use proptest::prelude::*;
use shutter_range::sim::{Background, Bar, Exposure, Scene as Picture, Simulator, Texture};
use shutter_range::{Counters, EdgeError, EdgePoint, Polarity, Ranger, RowError, Setup, Twist, Uncertainty};

use crate::projection::Scene;
use crate::scenes::{q16, seeded};

/// Takes all lines and adds their points up.
fn points_of_lines<const L: usize, const K: usize, const P: usize>(ranger: &mut Ranger<L, K, P>) -> u32 {
    std::iter::from_fn(|| ranger.next_line()).map(|line| u32::from(line.points())).sum()
}

fn is_balanced(counters: &Counters, in_lines: u32) -> bool {
    counters.points == in_lines + counters.stray_points + counters.dropped_points
}

/// The points of upright edges of one polarity, so many pixels apart, each as wide as its blur.
fn parallel_edges(apart_px: f64, width_px: f64, count: u16) -> Vec<EdgePoint> {
    let scene = Scene::vga();
    let rows = 0..scene.rows;
    let edge = |row, index| {
        let column_px = 200.0 + 0.02 * f64::from(row) + apart_px * f64::from(index);
        let mut point = scene.edge_at(row, column_px).with_polarity(Polarity::Rising).with_sigma_q16(q16(0.05) as u32);
        point.width_q8 = (width_px * 256.0) as u16;
        point
    };
    rows.flat_map(|row| (0..count).map(move |index| edge(row, index))).collect()
}

#[test]
fn parallel_edges_of_one_polarity_lose_no_point_uncounted() {
    let setup = Scene::vga().setup::<f64>();
    for (apart_px, width_px, count) in [(3.0, 2.0, 2), (0.1, 0.0, 2), (1.0, 0.5, 3), (6.0, 2.0, 2), (40.0, 1.0, 4)] {
        let mut ranger: Ranger<64, 8, 16> = Ranger::new();
        let points = parallel_edges(apart_px, width_px, count);
        for point in &points {
            ranger.edge_point(&setup, *point).expect("a sound point");
        }
        ranger.end_frame(&setup);
        let in_lines = points_of_lines(&mut ranger);
        let counters = ranger.counters();
        assert_eq!(counters.points as usize, points.len());
        assert!(is_balanced(counters, in_lines), "{apart_px} px: {in_lines} in lines, {counters:?}");
    }
}

/// What a caller may do with a ranger, in any order.
#[derive(Clone, Debug)]
enum Step {
    Point { rows_on: u16, column_px: f64, polarity: bool, width_q8: u16 },
    EndRow { rows_on: u16 },
    Pixels { seed: u8 },
    Tear,
    EndFrame,
    TakeLines,
}

fn step() -> impl Strategy<Value = Step> {
    let point = (0..2_u16, 1..64_u16, any::<bool>(), 0..3_u16).prop_map(|(rows_on, column, polarity, width)| {
        let column_px = f64::from(column) + 0.25 * f64::from(width);
        Step::Point { rows_on, column_px, polarity, width_q8: 300 * width }
    });
    prop_oneof![
        200 => point,
        10 => (0..3_u16).prop_map(|rows_on| Step::EndRow { rows_on }),
        30 => any::<u8>().prop_map(|seed| Step::Pixels { seed }),
        1 => Just(Step::Tear),
        4 => Just(Step::EndFrame),
        5 => Just(Step::TakeLines),
    ]
}

/// A row of 64 pixels with a bright post that begins at a column of the seed's choice.
fn pixels(seed: u8, row: u16) -> [u8; 64] {
    let left = 12 + usize::from(seed % 3) + usize::from(row / 8);
    let mut pixels = [40; 64];
    pixels.iter_mut().skip(left).take(20).for_each(|pixel| *pixel = 200);
    pixels
}

proptest! {
    #![proptest_config(seeded(400))]

    /// Small tables, so that rows and tables run full; points and pixels, torn and mixed frames.
    #[test]
    fn any_stream_is_balanced(steps in proptest::collection::vec(step(), 0..400)) {
        let setup = Setup::pinhole(64, 200, 60.0, 20_000_000).expect("sound");
        let mut ranger: Ranger<3, 4, 4> = Ranger::new();
        let (mut row, mut next_pixels, mut taken, mut in_lines) = (0, 0, 0, 0);
        for step in steps {
            match step {
                Step::Point { rows_on, column_px, polarity, width_q8 } => {
                    row += rows_on;
                    let time_ns = setup.readout().row_time_ns(row);
                    let polarity = if polarity { Polarity::Rising } else { Polarity::Falling };
                    let mut point = EdgePoint::new(row, q16(column_px), time_ns).with_polarity(polarity);
                    point.width_q8 = width_q8;
                    taken += u32::from(ranger.edge_point(&setup, point).is_ok());
                }
                Step::EndRow { rows_on } => {
                    row += rows_on;
                    let _ = ranger.end_row(&setup, row);
                }
                Step::Pixels { seed } => {
                    let before = ranger.counters().points;
                    next_pixels += u16::from(ranger.row(&setup, next_pixels, &pixels(seed, next_pixels)).is_ok());
                    taken += ranger.counters().points - before;
                }
                Step::Tear => ranger.tear(),
                Step::EndFrame => {
                    ranger.end_frame(&setup);
                    (row, next_pixels) = (0, 0);
                }
                Step::TakeLines => in_lines += points_of_lines(&mut ranger),
            }
        }
        ranger.end_frame(&setup);
        in_lines += points_of_lines(&mut ranger);
        prop_assert_eq!(ranger.counters().points, taken);
        prop_assert!(is_balanced(ranger.counters(), in_lines), "{} in lines, {:?}", in_lines, ranger.counters());
    }
}

/// Posts side by side before a texture, from pixels: tracked edges, their neighbours, and strays.
#[test]
fn points_found_in_pixels_are_counted() {
    let setup = Setup::pinhole(320, 240, 300.0_f32, 33_000_000).expect("sound");
    let motion = Twist::level([1.5, 0.0, 0.0]).expect("sound");
    for seed in 1..4 {
        let texture = Texture { contrast: 40.0, cell: 0.02, seed };
        let mut picture = Picture::<8>::new(Background::textured(120.0, texture)).expect("sound");
        for (bearing, width_m) in [(-0.3, 0.05), (-0.27, 0.02), (0.0, 0.01), (0.2, 0.1)] {
            picture.push(Bar::upright(bearing, 2.0, width_m, 230.0)).expect("room");
        }
        let exposure = Exposure { time_s: 0.004, ..Exposure::default() };
        let (camera, readout) = (setup.camera(), setup.readout());
        let simulator = Simulator::new(&picture, camera, readout, &motion, exposure, seed.into()).expect("sound");
        let mut ranger: Ranger<16, 8, 32> = Ranger::new();
        let mut pixels = [0; 320];
        for row in 0..240 {
            simulator.row(row, &mut pixels);
            ranger.row(&setup, row, &pixels).expect("rows in order");
        }
        ranger.end_frame(&setup);
        let in_lines = points_of_lines(&mut ranger);
        let counters = ranger.counters();
        assert!(in_lines > 1000 && counters.stray_points > 0, "{in_lines} in lines, {counters:?}");
        assert!(is_balanced(counters, in_lines), "{in_lines} in lines, {counters:?}");
    }
}

#[test]
fn a_frame_is_made_of_points_or_of_pixels() {
    let setup = Setup::pinhole(64, 200, 60.0, 20_000_000).expect("sound");
    let setup = setup.with_uncertainty(Uncertainty::NONE).expect("sound");
    let point = |row| EdgePoint::new(row, 20 << 16, setup.readout().row_time_ns(row));
    let mut ranger: Ranger<4, 8, 8> = Ranger::new();
    // Even rows as pixels, odd rows as points.
    assert_eq!(ranger.row(&setup, 0, &pixels(0, 0)), Ok(()));
    assert_eq!(ranger.edge_point(&setup, point(1)), Err(EdgeError::FrameOfPixels));
    assert_eq!(ranger.end_row(&setup, 1), Err(EdgeError::FrameOfPixels));
    // Nothing has changed: the next row of pixels is taken.
    assert_eq!(ranger.row(&setup, 1, &pixels(0, 1)), Ok(()));
    ranger.end_frame(&setup);
    assert_eq!(ranger.edge_point(&setup, point(0)), Ok(()));
    assert_eq!(ranger.row(&setup, 1, &pixels(0, 1)), Err(RowError::FrameOfPoints { row: 1 }));
    assert!(!ranger.is_torn());
    assert_eq!(ranger.edge_point(&setup, point(1)), Ok(()));
    ranger.end_frame(&setup);
    assert_eq!(ranger.row(&setup, 0, &pixels(0, 0)), Ok(()));
}

#[test]
fn a_torn_frame_takes_nothing_and_counts_what_it_had() {
    let setup = Setup::pinhole(64, 200, 60.0, 20_000_000).expect("sound");
    let point = |row| EdgePoint::new(row, 20 << 16, setup.readout().row_time_ns(row));
    let mut ranger: Ranger<4, 8, 8> = Ranger::new();
    for row in 0..20 {
        assert_eq!(ranger.edge_point(&setup, point(row)), Ok(()));
    }
    ranger.tear();
    assert!(ranger.is_torn());
    assert_eq!(ranger.edge_point(&setup, point(20)), Err(EdgeError::Torn));
    assert_eq!(ranger.end_row(&setup, 20), Err(EdgeError::Torn));
    assert_eq!(ranger.row(&setup, 20, &pixels(0, 20)), Err(RowError::Torn));
    ranger.end_frame(&setup);
    assert_eq!(points_of_lines(&mut ranger), 0);
    assert_eq!((ranger.counters().points, ranger.counters().stray_points), (20, 20));
    assert_eq!(ranger.edge_point(&setup, point(0)), Ok(()));
}
