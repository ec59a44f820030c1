//! Runs the library on the frames of a scenario and holds its ranges against the truth.

use shutter_range::{ParameterError, Range, RangeStatus, Ranger};

use crate::bound::sigma_inverse_depth;
use crate::score::Outcome;
use crate::truth::{UprightEdge, column};
use crate::{Scenario, Score, Shot};

/// Which frames of a scenario are drawn.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub frames: u32,
    pub seed: u64,
}

/// Something that should not be, and the frame that shows it.
#[derive(Clone, Debug)]
pub struct Finding {
    pub frame: u32,
    pub what: String,
}

/// Least number of rows that must show an edge for it to count as missed.
const LEAST_ROWS: usize = 12;
/// Largest distance of a range from its edge, in the middle of its rows.
const MATCH_PX: f64 = 2.0;
/// Depths that a user would believe.
const CREDIBLE_M: std::ops::RangeInclusive<f64> = 0.15..=60.0;
/// Errors beyond so many bounds are reported.
const LARGE_ERROR: f64 = 5.0;

/// Measures all frames of a scenario; missed edges, large errors and false distances go to `report`.
pub fn measure(
    scenario: &Scenario,
    settings: Settings,
    mut report: impl FnMut(Finding),
) -> Result<Score, ParameterError> {
    let mut score = Score::default();
    for frame in 0..settings.frames {
        let shot = scenario.shot(settings.seed, frame)?;
        let ranges = ranges_of(&shot)?;
        judge(&shot, &ranges, &mut score, |what| report(Finding { frame, what }));
    }
    Ok(score)
}

/// The ranges of a frame, from its pixels alone.
fn ranges_of(shot: &Shot) -> Result<Vec<Range<f64>>, ParameterError> {
    let (setup, motion) = (shot.rig.setup::<f64>()?, shot.motion::<f64>()?);
    let pixels = shot.render()?;
    let mut ranger: Ranger<64, 16, 128> = Ranger::new();
    let mut ranges = Vec::new();
    for (row, pixels) in (0..shot.rig.rows).zip(pixels.chunks(shot.rig.columns.into())) {
        ranger.row(&setup, row, pixels).expect("rows in order and of the right length");
        ranges.extend(std::iter::from_fn(|| ranger.next_range(&setup, &motion)));
    }
    ranger.end_frame(&setup);
    ranges.extend(std::iter::from_fn(|| ranger.next_range(&setup, &motion)));
    Ok(ranges)
}

/// An edge, and the rows that show it.
struct Shown {
    edge: UprightEdge,
    rows: Vec<u16>,
}

fn judge(shot: &Shot, ranges: &[Range<f64>], score: &mut Score, mut report: impl FnMut(String)) {
    let shown: Vec<Shown> = UprightEdge::all(shot)
        .into_iter()
        .map(|edge| Shown { rows: edge.visible_rows(shot), edge })
        .filter(|shown| !shown.rows.is_empty())
        .collect();
    score.frames += 1;
    for shown in shown.iter().filter(|shown| shown.rows.len() >= LEAST_ROWS) {
        score.edges += 1;
        let of_edge = || ranges.iter().filter(|range| is_of(shot, range, shown));
        let of_status = |ok: bool| of_edge().filter(move |range| (range.status == RangeStatus::Ok) == ok);
        // Where there are several, a user would trust the longest.
        match of_status(true).max_by_key(|range| range.points) {
            Some(range) => {
                let outcome = outcome(shot, shown, range);
                if outcome.error.abs() > LARGE_ERROR * outcome.bound {
                    report(describe_error(shown, range, &outcome));
                }
                score.found.push(outcome);
            }
            None => report(describe_miss(shown, of_status(false).max_by_key(|range| range.points))),
        }
    }
    for range in ranges.iter().filter(|range| is_credible(range)) {
        if !shown.iter().any(|shown| is_of(shot, range, shown)) {
            score.false_distances += 1;
            report(describe_false(range));
        }
    }
}

fn is_credible(range: &Range<f64>) -> bool {
    range.status == RangeStatus::Ok && CREDIBLE_M.contains(&(1.0 / range.estimate.inverse_depth_per_m))
}

/// Whether the range's line lies on the edge in the middle of its rows, and has the same polarity.
fn is_of(shot: &Shot, range: &Range<f64>, shown: &Shown) -> bool {
    let middle = 0.5 * (f64::from(range.first_row) + f64::from(range.last_row));
    let estimate = &range.estimate;
    let here = column(shot, estimate.bearing, estimate.inverse_depth_per_m, shot.position_m(middle, 0.0));
    let there = shown.edge.column(shot, middle, 0.0);
    let among = |rows: &[u16]| match rows {
        [first, .., last] => (f64::from(*first)..=f64::from(*last)).contains(&middle),
        _ => false,
    };
    (here - there).abs() < MATCH_PX && range.polarity == shown.edge.polarity() && among(&shown.rows)
}

fn outcome(shot: &Shot, shown: &Shown, range: &Range<f64>) -> Outcome {
    let depth_m = shown.edge.depth_m;
    Outcome {
        error: range.estimate.inverse_depth_per_m * depth_m - 1.0,
        sigma: range.estimate.sigma_inverse_depth_per_m * depth_m,
        bound: sigma_inverse_depth(shot, &shown.edge, &shown.rows) * depth_m,
    }
}

fn describe_error(shown: &Shown, range: &Range<f64>, outcome: &Outcome) -> String {
    format!(
        "{} by {:.1} bounds, {:.1} sigma",
        describe(shown, Some(range)),
        outcome.error / outcome.bound,
        outcome.error / outcome.sigma
    )
}

fn describe_miss(shown: &Shown, range: Option<&Range<f64>>) -> String {
    format!("missed: {}", describe(shown, range))
}

fn describe_false(range: &Range<f64>) -> String {
    format!("false: {}", describe_range(range))
}

fn describe(shown: &Shown, range: Option<&Range<f64>>) -> String {
    let Shown { edge, rows } = shown;
    let (first, last) = (rows.first().unwrap_or(&0), rows.last().unwrap_or(&0));
    let found = range.map_or_else(|| "nothing there".into(), describe_range);
    format!(
        "edge at bearing {:.3}, {:.2} m, rows {first}-{last} ({}): {found}",
        edge.bearing(),
        edge.depth_m,
        rows.len()
    )
}

fn describe_range(range: &Range<f64>) -> String {
    format!(
        "{:?}, {:.3} m, bearing {:.3}, column {:.1}, rows {}-{} ({}), misfit {:.2}",
        range.status,
        1.0 / range.estimate.inverse_depth_per_m,
        range.estimate.bearing,
        range.column_at_first_row,
        range.first_row,
        range.last_row,
        range.points,
        range.estimate.misfit
    )
}
