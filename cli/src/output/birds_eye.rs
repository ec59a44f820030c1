//! The bird's-eye view of a frame's ranges as SVG: positions with bars of two sigma, in metres.

use std::fmt::Write;

use shutter_range::RangeStatus;

use super::report::{Frame, RangeReport};
use super::rounding::{at_least, with_sigma};

/// In the units of the picture.
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 440.0;
const MARGIN: f64 = 24.0;
/// Where nothing has a distance.
const USUAL_DEPTH_M: f64 = 10.0;

/// The camera is at the bottom and looks upwards.
struct Map {
    px_per_m: f64,
    most_depth_m: f64,
}

pub(crate) fn svg(frame: &Frame) -> String {
    let map = Map::of(frame);
    let label = "bird's-eye view: positions with two sigma, in metres";
    let mut svg =
        format!("<svg class=\"birds-eye\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{label}\">\n");
    map.write_grid(&mut svg);
    for range in &frame.ranges {
        match range.status {
            RangeStatus::Ok => map.write_position(range, &mut svg),
            RangeStatus::Far => map.write_far(range, &mut svg),
            _ => {}
        }
    }
    let (x, y) = map.place(0.0, 0.0);
    let _ =
        writeln!(svg, "<path class=\"camera\" d=\"M{x:.1} {y:.1} l-9 14 h18 z\"><title>camera</title></path>\n</svg>");
    svg
}

impl Map {
    /// So that all positions lie within, with their bars as far as they are twice as far as the farthest position.
    fn of(frame: &Frame) -> Self {
        let depth =
            |range: &RangeReport| range.depth_m.or(range.nearest_m.filter(|_| range.status == RangeStatus::Far));
        let depths = frame.ranges.iter().filter_map(|range| Some((range, depth(range)?)));
        let farthest = depths.clone().map(|(_, depth_m)| depth_m).fold(0.0, f64::max);
        let farthest = if farthest > 0.0 { farthest } else { USUAL_DEPTH_M };
        let bars = frame.ranges.iter().filter_map(|range| range.farthest_m.filter(|_| range.depth_m.is_some()));
        let most_depth_m = bars.fold(1.1 * farthest, f64::max).min(2.0 * farthest);
        let widest = depths.map(|(range, depth_m)| (range.bearing * depth_m).abs()).fold(0.1 * farthest, f64::max);
        let px_per_m = ((HEIGHT - 2.0 * MARGIN) / most_depth_m).min((0.5 * WIDTH - MARGIN) / (1.1 * widest));
        Self { px_per_m, most_depth_m }
    }

    fn place(&self, bearing: f64, depth_m: f64) -> (f64, f64) {
        (0.5 * WIDTH + bearing * depth_m * self.px_per_m, HEIGHT - MARGIN - depth_m * self.px_per_m)
    }

    fn write_grid(&self, svg: &mut String) {
        let step_m = nice_step(self.most_depth_m);
        let steps = (self.most_depth_m / step_m) as usize;
        for step in 1..=steps {
            let depth_m = step as f64 * step_m;
            let y = self.place(0.0, depth_m).1;
            let _ = writeln!(svg, "<path class=\"grid\" d=\"M0 {y:.1} H{WIDTH}\"/>");
            let _ = writeln!(svg, "<text class=\"grid\" x=\"4\" y=\"{:.1}\">{depth_m} m</text>", y - 3.0);
        }
    }

    fn write_position(&self, range: &RangeReport, svg: &mut String) {
        let (Some(depth_m), Some(sigma_m)) = (range.depth_m, range.sigma_depth_m) else { return };
        let near = range.nearest_m.unwrap_or(depth_m);
        let far = range.farthest_m.unwrap_or(f64::MAX).min(1.5 * self.most_depth_m);
        let ((x0, y0), (x1, y1)) = (self.place(range.bearing, near), self.place(range.bearing, far));
        let (x, y) = self.place(range.bearing, depth_m);
        let label = with_sigma(depth_m, sigma_m, 1);
        let _ = writeln!(
            svg,
            "<g class=\"position ok\"><title>{label} m, bearing {:+.3}</title>\
             <path class=\"bar\" d=\"M{x0:.1} {y0:.1} L{x1:.1} {y1:.1}\"/>\
             <circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/></g>",
            range.bearing
        );
    }

    /// From the lower bound on.
    fn write_far(&self, range: &RangeReport, svg: &mut String) {
        let Some(nearest_m) = range.nearest_m else { return };
        let ((x0, y0), (x1, y1)) =
            (self.place(range.bearing, nearest_m), self.place(range.bearing, 1.5 * self.most_depth_m));
        let _ = writeln!(
            svg,
            "<g class=\"position far\"><title>farther than {} m, bearing {:+.3}</title>\
             <path class=\"bar\" d=\"M{x0:.1} {y0:.1} L{x1:.1} {y1:.1}\"/></g>",
            at_least(nearest_m, 2),
            range.bearing
        );
    }
}

/// 1, 2 or 5 times a power of ten, so that there are four to nine of them.
fn nice_step(whole: f64) -> f64 {
    let power = 10_f64.powf((whole / 4.0).log10().floor());
    let steps = [5.0, 2.0].map(|factor| factor * power);
    steps.into_iter().find(|step| whole / step >= 4.0).unwrap_or(power)
}
