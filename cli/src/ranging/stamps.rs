//! Stamps of rows against the readout. They must lie within the frame that it allows; where they do not rise with the
//! rows at its pace, as those of coarse clocks and of blocks of rows, the readout tells the time.

use anyhow::{Result, ensure};
use shutter_range::Setup;

use crate::input::edge_file::FilePoint;

/// The jitter of an interrupt.
const JITTER_NS: i64 = 100_000;

/// A readout may be off by one part in so many.
const READOUT_PARTS: i64 = 20;

/// Ticks, blocks and late rows fall behind by at most so large a part of the frame.
const MOST_LAG_PERCENT: i64 = 40;

/// Settles the times of a frame's points and puts them in the order of readout. Tells of stamps that are not used.
pub(crate) fn settle(points: &mut [FilePoint], setup: &Setup<f64>) -> Result<Option<String>> {
    let readout = setup.readout();
    points.sort_by_key(|point| (readout.rows_before(point.point.row), point.point.column_q16));
    let Some(first) = points.first() else { return Ok(None) };
    let clock = Clock::new(setup, first);
    let is_regular = points.iter().all(|point| clock.is_in_pace(point));
    points.iter().try_for_each(|point| clock.check(point, is_regular))?;
    refuse_backwards(points)?;
    if is_regular {
        smooth(points);
        return Ok(clock.offset_hint());
    }
    let most_ns = points.iter().map(|point| clock.deviation_ns(point).abs()).max().unwrap_or(0);
    for point in points {
        point.point.time_ns = readout.row_time_ns(point.point.row);
    }
    Ok(Some(format!(
        "the stamps depart from the readout's pace by up to {:.4} s: ticks of a coarse clock, blocks of rows that share a stamp, \
         rows that came late, or another readout time. That of the setup tells the time instead",
        seconds(most_ns)
    )))
}

/// The stamps of a frame, beginning with its first row.
struct Clock<'a> {
    setup: &'a Setup<f64>,
    frame_ns: i64,
    first_ns: i64,
    /// The first stamp minus the time of its row by the readout.
    offset_ns: i64,
}

impl<'a> Clock<'a> {
    fn new(setup: &'a Setup<f64>, first: &FilePoint) -> Self {
        let readout = setup.readout();
        let frame_ns = readout.row_time_ns(readout.row_after(readout.rows()));
        let first_ns = readout.row_time_ns(first.point.row);
        Self { setup, frame_ns, first_ns, offset_ns: first.point.time_ns - first_ns }
    }

    fn expected_ns(&self, point: &FilePoint) -> i64 {
        self.setup.readout().row_time_ns(point.point.row)
    }

    /// From the readout's pace.
    fn deviation_ns(&self, point: &FilePoint) -> i64 {
        point.point.time_ns - self.expected_ns(point) - self.offset_ns
    }

    fn is_in_pace(&self, point: &FilePoint) -> bool {
        let elapsed_ns = self.expected_ns(point) - self.first_ns;
        self.deviation_ns(point).abs() <= JITTER_NS + elapsed_ns / READOUT_PARTS
    }

    /// How far stamps may be off that are of the middle of the exposure.
    fn tolerance_ns(&self) -> i64 {
        self.frame_ns / READOUT_PARTS + JITTER_NS
    }

    /// Stamps of another instant leave the distance as it is, but not the bearing.
    fn offset_hint(&self) -> Option<String> {
        let which = if self.offset_ns < 0 { "earlier" } else { "later" };
        (self.offset_ns.abs() > self.tolerance_ns()).then(|| {
            format!(
                "the stamps are {:.4} s {which} than the readout's: they must be of the middle of each row's exposure, not of its \
                 start or end, and count from that of the row read first; otherwise bearings are off by the motion in that time",
                seconds(self.offset_ns.abs())
            )
        })
    }

    /// Refuses a stamp outside the frame, and one that neither a coarse clock nor a late row explains.
    fn check(&self, point: &FilePoint, is_regular: bool) -> Result<()> {
        let exposure_s = self.setup.motion_blur().map_or(0.0, |blur| blur.exposure_s);
        // From the middle of the exposure to either end of it.
        let margin_ns = self.tolerance_ns() + (exposure_s * 1e9) as i64 / 2;
        let most_lag_ns = margin_ns.max(self.frame_ns / 100 * MOST_LAG_PERCENT);
        let beside_ns = if is_regular { margin_ns } else { most_lag_ns };
        let is_within = (-beside_ns..=self.frame_ns + beside_ns).contains(&point.point.time_ns);
        let (time_s, expected_s) = (seconds(point.point.time_ns), seconds(self.expected_ns(point)));
        ensure!(
            is_within && self.deviation_ns(point).abs() <= most_lag_ns,
            "line {}: `time_s` is {time_s}, but must be near {expected_s:.6}, when a readout of {:.4} s reads row {}: {}",
            point.at,
            self.setup.readout().line_time_ps() as f64 * f64::from(self.setup.readout().rows()) / 1e12,
            point.point.row,
            usual_cause(time_s, expected_s)
        );
        Ok(())
    }
}

/// Refuses points in the order of readout whose stamps run backwards.
fn refuse_backwards(points: &[FilePoint]) -> Result<()> {
    let mut latest = None;
    for point in points {
        let last: &FilePoint = latest.unwrap_or(point);
        ensure!(
            point.point.time_ns >= last.point.time_ns - JITTER_NS,
            "line {}: `time_s` is {}, earlier than on row {}, which was read before row {}: check the stamps and \
             `camera.direction`",
            point.at,
            seconds(point.point.time_ns),
            last.point.row,
            point.point.row
        );
        if point.point.time_ns >= last.point.time_ns {
            latest = Some(point);
        }
    }
    Ok(())
}

/// Jitter may let stamps run backwards a little: no row is read before the one above it.
fn smooth(points: &mut [FilePoint]) {
    let mut latest_ns = i64::MIN;
    for point in points {
        latest_ns = latest_ns.max(point.point.time_ns);
        point.point.time_ns = latest_ns;
    }
}

fn seconds(ns: i64) -> f64 {
    ns as f64 / 1e9
}

fn usual_cause(time_s: f64, expected_s: f64) -> &'static str {
    let is = |factor: f64| (time_s / (expected_s * factor) - 1.0).abs() < 0.1;
    if is(1e3) {
        "these seem to be milliseconds"
    } else if is(1e6) {
        "these seem to be microseconds"
    } else if time_s.abs() > 1.0 {
        "is it counted from frame start, in seconds, and not from the start of the clock?"
    } else {
        "is it the row's own since frame start? Check the readout time and `camera.direction`, too"
    }
}
