//! `cargo bench -p shutter-range-bench`: pixels per second of each stage, of a peer, and of the plain sum of all
//! pixels.
//!
//! Criterion calls the pixels elements (elem/s); those of `range` are ranges. One thread, frames rendered beforehand.

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use imageproc::edges::canny;
use imageproc::hough::{LineDetectionOptions, detect_lines};
use imageproc::image::GrayImage;
use shutter_range::{EdgePoint, Line, ParameterError, Range, Ranger, Scalar, ScannedPoint, Scanner};
use shutter_range_bench::{Draw, Rig, Shot, clutter, rod};

/// Lines, knots, and points of a row.
type Finder = Ranger<64, 16, 128>;

/// A rendered frame, and what it was rendered from.
struct Frame {
    shot: Shot,
    pixels: Vec<u8>,
}

impl Frame {
    fn new(shot: Shot) -> Result<Self, ParameterError> {
        Ok(Self { pixels: shot.render()?, shot })
    }

    fn rows(&self) -> impl Iterator<Item = (u16, &[u8])> {
        (0..self.shot.rig.rows).zip(self.pixels.chunks(self.shot.rig.columns.into()))
    }

    /// All that the scanner finds, row by row.
    fn points(&self) -> Result<Vec<(u16, Vec<EdgePoint>)>, ParameterError> {
        let readout = self.shot.rig.readout()?;
        let mut scanner = Scanner::new();
        let points_of = |(row, pixels)| {
            let mut points = Vec::new();
            scanner.scan(pixels, |point| points.push(point.at(row, readout.row_time_ns(row))));
            (row, points)
        };
        Ok(self.rows().map(points_of).collect())
    }

    /// The longest line of the frame.
    fn line(&self) -> Result<Option<Line<16>>, ParameterError> {
        let setup = self.shot.rig.setup::<f64>()?;
        let mut ranger = Finder::new();
        for (row, points) in self.points()? {
            for point in points {
                ranger.edge_point(&setup, point).ok();
            }
            ranger.end_row(&setup, row).ok();
        }
        ranger.end_frame(&setup);
        Ok(std::iter::from_fn(|| ranger.next_line()).max_by_key(Line::points))
    }
}

fn scan(frame: &Frame) -> i64 {
    let mut scanner = Scanner::new();
    let mut columns = 0;
    for (_, pixels) in frame.rows() {
        scanner.scan(pixels, |point: ScannedPoint| columns += i64::from(point.column_q16));
    }
    columns
}

fn bench_scan(group: &mut BenchmarkGroup<'_, WallTime>, frame: &Frame) {
    group.bench_function("scan", |bench| bench.iter(|| scan(black_box(frame))));
}

fn bench_track(group: &mut BenchmarkGroup<'_, WallTime>, frame: &Frame) -> Result<(), ParameterError> {
    let (setup, motion) = (frame.shot.rig.setup::<f32>()?, frame.shot.motion::<f32>()?);
    let points: Vec<EdgePoint> = frame.points()?.into_iter().flat_map(|(_, points)| points).collect();
    let mut ranger = Finder::new();
    group.bench_function("track", |bench| {
        bench.iter(|| {
            for point in black_box(&points) {
                // A point twice in one place is refused, which costs the same.
                ranger.edge_point(&setup, *point).ok();
            }
            ranger.end_frame(&setup);
            std::iter::from_fn(|| ranger.next_range(&setup, &motion)).count()
        });
    });
    Ok(())
}

fn bench_frame(group: &mut BenchmarkGroup<'_, WallTime>, frame: &Frame) -> Result<(), ParameterError> {
    let (setup, motion) = (frame.shot.rig.setup::<f32>()?, frame.shot.motion::<f32>()?);
    let mut ranger = Finder::new();
    group.bench_function("frame", |bench| {
        bench.iter(|| {
            let mut ranges = 0;
            for (row, pixels) in black_box(frame).rows() {
                ranger.row(&setup, row, pixels).expect("rows in order and of the right length");
                ranges += std::iter::from_fn(|| ranger.next_range(&setup, &motion)).count();
            }
            ranger.end_frame(&setup);
            ranges + std::iter::from_fn(|| ranger.next_range(&setup, &motion)).count()
        });
    });
    Ok(())
}

/// Edges and straight lines as a desktop user would find them; distances would come on top.
fn bench_peer(group: &mut BenchmarkGroup<'_, WallTime>, frame: &Frame) {
    let Rig { columns, rows, .. } = frame.shot.rig;
    let image = GrayImage::from_raw(columns.into(), rows.into(), frame.pixels.clone()).expect("a whole frame");
    let options = LineDetectionOptions { vote_threshold: u32::from(rows) / 4, suppression_radius: 8 };
    // It is slow enough for fewer samples of one run each.
    group.sample_size(10).sampling_mode(SamplingMode::Flat).measurement_time(Duration::from_secs(2));
    group.bench_function("imageproc canny + hough", |bench| {
        bench.iter(|| detect_lines(&canny(black_box(&image), 50.0, 100.0), options).len());
    });
}

/// The cost of reading the pixels: no detector can be faster.
fn bench_roofline(group: &mut BenchmarkGroup<'_, WallTime>, frame: &Frame) {
    group.bench_function("roofline", |bench| {
        bench.iter(|| black_box(&frame.pixels).iter().map(|pixel| u64::from(*pixel)).sum::<u64>());
    });
}

fn bench_range<S: Scalar + From<f32>>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    frame: &Frame,
) -> Result<(), ParameterError> {
    let (setup, motion) = (frame.shot.rig.setup::<S>()?, frame.shot.motion::<S>()?);
    let line = frame.line()?.expect("the rod's edges");
    group.bench_function(name, |bench| bench.iter(|| Range::from_line(&setup, &motion, black_box(&line))));
    Ok(())
}

fn group<'a>(criterion: &'a mut Criterion, size: &str, scene: &str, elements: usize) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(format!("{size} {scene}"));
    group.throughput(Throughput::Elements(elements as u64));
    group
}

fn bench_pixels(criterion: &mut Criterion, size: &str, scene: &str, frame: &Frame) -> Result<(), ParameterError> {
    let mut group = group(criterion, size, scene, frame.pixels.len());
    bench_roofline(&mut group, frame);
    bench_scan(&mut group, frame);
    bench_track(&mut group, frame)?;
    bench_frame(&mut group, frame)?;
    bench_peer(&mut group, frame);
    group.finish();
    Ok(())
}

fn bench_size(criterion: &mut Criterion, size: &str, rig: Rig, depth_m: f32) -> Result<(), ParameterError> {
    const SEED: u64 = 1;
    let clean = Frame::new(rod(&mut Draw::new(SEED, "clean", 0), rig, depth_m)?)?;
    bench_pixels(criterion, size, "clean", &clean)?;
    let cluttered = Frame::new(clutter(&mut Draw::new(SEED, "cluttered", 0), rig, 4)?)?;
    bench_pixels(criterion, size, "cluttered", &cluttered)?;
    let mut group = group(criterion, size, "range", 1);
    bench_range::<f32>(&mut group, "f32", &clean)?;
    bench_range::<f64>(&mut group, "f64", &clean)?;
    group.finish();
    Ok(())
}

fn speed(criterion: &mut Criterion) {
    for (size, rig, depth_m) in [("QVGA", Rig::QVGA, 1.5), ("VGA", Rig::VGA, 3.0), ("1080p", Rig::HD, 5.0)] {
        bench_size(criterion, size, rig, depth_m).expect("sound parameters");
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = speed
}
criterion_main!(benches);
