//! Stamps of rows: they must lie within the frame that the readout allows, and rise with the rows at about its pace.

use anyhow::{Result, ensure};
use shutter_range::Setup;

use crate::input::edge_file::FilePoint;

/// What a readout and its stamps may differ by, as a part of the frame.
const PART_OF_READOUT: f64 = 0.1;

/// Stamps that depart from the readout's pace by more than this part of the frame are no jitter.
const PART_OF_JITTER: f64 = 0.04;

/// No clock is better for sure.
const JITTER_S: f64 = 200e-6;

/// Refuses the points of a frame whose stamps contradict its readout; tells of stamps that do so a little.
pub(crate) fn check(points: &[FilePoint], setup: &Setup<f64>) -> Result<Option<String>> {
    let stamps = Stamps::new(setup);
    points.iter().try_for_each(|point| stamps.check(point))?;
    let by_time = |point: &&FilePoint| stamps.expected_ns(point);
    if let (Some(first), Some(last)) = (points.iter().min_by_key(by_time), points.iter().max_by_key(by_time)) {
        stamps.check_pace(first, last)?;
    }
    Ok(stamps.hint(points))
}

struct Stamps<'a> {
    setup: &'a Setup<f64>,
    readout_s: f64,
    /// How far a stamp may lie beside the frame.
    beside_s: f64,
}

impl<'a> Stamps<'a> {
    fn new(setup: &'a Setup<f64>) -> Self {
        let readout = setup.readout();
        let readout_s = (readout.line_time_ps() * u64::from(readout.rows())) as f64 / 1e12;
        let part = PART_OF_READOUT + 3.0 * setup.uncertainty().sigma_readout;
        let exposure_s = setup.motion_blur().map_or(0.0, |blur| blur.exposure_s);
        Self { setup, readout_s, beside_s: part * readout_s + exposure_s + JITTER_S }
    }

    /// By the readout.
    fn expected_ns(&self, point: &FilePoint) -> i64 {
        self.setup.readout().row_time_ns(point.point.row)
    }

    fn check(&self, point: &FilePoint) -> Result<()> {
        let (time_s, expected_s) = (seconds(point.point.time_ns), seconds(self.expected_ns(point)));
        let (least_s, most_s) = (-self.beside_s, self.readout_s + self.beside_s);
        ensure!(
            (least_s..=most_s).contains(&time_s),
            "line {}: `time_s` is {time_s}, but must be {least_s:.4} to {most_s:.4} for a readout of {:.4} s, which reads row \
             {} at {expected_s:.6}: {}",
            point.at,
            self.readout_s,
            point.point.row,
            usual_cause(time_s, expected_s)
        );
        Ok(())
    }

    /// From the point that is read first to that which is read last.
    fn check_pace(&self, first: &FilePoint, last: &FilePoint) -> Result<()> {
        let expected_s = seconds(self.expected_ns(last) - self.expected_ns(first));
        let found_s = seconds(last.point.time_ns.saturating_sub(first.point.time_ns));
        let direction = if found_s < 0.0 { ", and `camera.direction`" } else { "" };
        ensure!(
            (found_s - expected_s).abs() <= expected_s / 4.0 + self.beside_s,
            "line {}: `time_s` rises by {found_s:.4} from row {} to row {}, which are {expected_s:.4} s apart by the readout of \
             {:.4} s: check the stamps, the readout time in the setup{direction}",
            last.at,
            first.point.row,
            last.point.row,
            self.readout_s
        );
        Ok(())
    }

    /// Ticks, blocks and late rows: the slope of an edge is then that of its clock.
    fn hint(&self, points: &[FilePoint]) -> Option<String> {
        let off_s = |point: &FilePoint| seconds(point.point.time_ns - self.expected_ns(point));
        let (least_s, most_s) = points
            .iter()
            .map(off_s)
            .fold((f64::MAX, f64::MIN), |(least, most), off_s| (least.min(off_s), most.max(off_s)));
        let spread_s = most_s - least_s;
        (spread_s > PART_OF_JITTER * self.readout_s + JITTER_S).then(|| {
            format!(
                "the stamps depart from the readout's pace by {spread_s:.4} s: ticks of a coarse clock, blocks of rows that \
                 share a stamp, or rows that come late; without time_s the readout tells the time"
            )
        })
    }
}

fn seconds(ns: i64) -> f64 {
    ns as f64 / 1e9
}

/// What a stamp outside its frame usually is.
fn usual_cause(time_s: f64, expected_s: f64) -> &'static str {
    let is = |factor: f64| (time_s / (expected_s * factor) - 1.0).abs() < 0.1;
    if is(1e3) {
        "these seem to be milliseconds"
    } else if is(1e6) {
        "these seem to be microseconds"
    } else if time_s.abs() > 1.0 {
        "is it counted from frame start, in seconds, and not from the start of the clock?"
    } else {
        "is it the row's own, in seconds since frame start, and not that of its block or of the whole frame?"
    }
}
