//! Command `plan`: what cameras will measure on a moving platform, and which of them is the best.

use std::fmt::Write;

use anyhow::{Context, Result, bail, ensure};
use serde::Serialize;
use shutter_range::ErrorSource;
use shutter_range::plan::{CameraMode, Choice, PixelNoise, Planner, Prediction, Request, Target, Verdict, choose};

use crate::argument_values::SPEEDS_M_S;
use crate::arguments::PlanArgs;
use crate::input::setup::{self, SetupSource};
use crate::output::chart::{Axis, Chart};
use crate::output::report;
use crate::output::text_table::{Colour, TextTable};

/// More setups are not compared at once.
const MODES: usize = 32;

#[derive(Serialize)]
pub(crate) struct Document {
    /// Of the first setup, whose motion is that of all plans.
    speed_m_s: f64,
    plans: Vec<Plan>,
    /// Index of the setup that suits best; null where none suits.
    best: Option<usize>,
}

#[derive(Serialize)]
struct Plan {
    setup: String,
    /// Whether it does what is wanted, or what speaks against it.
    suits: bool,
    verdict: String,
    /// Depths between which the wanted sigma is reached at the setup's speed.
    nearest_m: Option<f64>,
    nearest_because: Option<String>,
    farthest_m: Option<f64>,
    /// Slowest speed with the wanted sigma at the farthest depth that is wanted.
    slowest_m_s: Option<f64>,
    depths: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    depth_m: f64,
    /// `ok`, or what is in the way.
    status: String,
    sigma_depth_m: Option<f64>,
    relative_sigma: Option<f64>,
    /// The parts of it, relative as well; their squares add up.
    parts: Vec<Part>,
    skew_px: f64,
    blur_px: f64,
    rows: u16,
}

#[derive(Serialize)]
struct Part {
    source: &'static str,
    relative_sigma: f64,
}

/// Refuses options that are wrong only together.
pub(crate) fn check(arguments: &PlanArgs) -> Result<(), String> {
    let PlanArgs { from, to, slowest_m_s, fastest_m_s, .. } = *arguments;
    if from > to {
        return Err(format!("--from is {from}, but must be at most --to, which is {to} (m)"));
    }
    if let Some((slowest, fastest)) = slowest_m_s.zip(fastest_m_s).filter(|(slowest, fastest)| slowest > fastest) {
        return Err(format!("--slowest-m-s is {slowest}, but must be at most --fastest-m-s, which is {fastest} (m/s)"));
    }
    let setups = arguments.setups.len();
    if setups > MODES {
        return Err(format!("--setup is given {setups} times, but must be given at most {MODES} times"));
    }
    Ok(())
}

pub(crate) fn plan(arguments: &PlanArgs) -> Result<Document> {
    let setups: Vec<_> = arguments
        .setups
        .iter()
        .map(|path| setup::load(SetupSource { path, camera: None, has_trajectory: false }))
        .collect::<Result<_>>()?;
    let noise = PixelNoise { read_noise: arguments.read_noise, shot_gain: arguments.shot_gain };
    let modes: Vec<_> = setups.iter().map(|file| CameraMode::new(file.setup, noise)).collect::<Result<_, _>>()?;
    let target = target(arguments);
    let motion = setups.first().context("there is no setup")?.motion;
    let speed_m_s = length(motion.velocity_m_s());
    let request = request(arguments, speed_m_s).with_context(|| name(arguments, 0))?;
    let choice: Choice<f64, MODES> = choose(&modes, &motion, target, &request)?;
    let mut plans = Vec::new();
    for (mode, (index, verdict)) in modes.iter().zip(choice.verdicts.iter().enumerate()) {
        let planner = Planner::new(mode, &motion, target)?;
        let suits = matches!(verdict, Verdict::Suits { .. });
        plans.push(Plan::new(name(arguments, index), suits, verdict.to_string(), &planner, arguments)?);
    }
    Ok(Document { speed_m_s, plans, best: choice.best })
}

/// Of a setup, as it was given.
fn name(arguments: &PlanArgs, index: usize) -> String {
    arguments.setups.get(index).map(|path| path.display().to_string()).unwrap_or_default()
}

/// What is wanted, in the direction of a motion and, unless options say otherwise, at its speed.
fn request(arguments: &PlanArgs, speed_m_s: f64) -> Result<Request<f64>> {
    ensure!(speed_m_s > 0.0, "`motion.velocity_m_s` is zero, but must have a direction: at rest nothing is measured");
    let (slowest_m_s, fastest_m_s) = (arguments.slowest_m_s, arguments.fastest_m_s);
    let (least, most) = SPEEDS_M_S;
    ensure!(
        (least..=most).contains(&speed_m_s) || slowest_m_s.and(fastest_m_s).is_some(),
        "`motion.velocity_m_s` is {speed_m_s} m/s long, but must be {least} to {most} m/s unless --slowest-m-s and \
         --fastest-m-s are given"
    );
    match (slowest_m_s, fastest_m_s) {
        (Some(slowest), None) if slowest > speed_m_s => bail!(
            "--slowest-m-s is {slowest}, but must be at most {speed_m_s} (m/s), the speed of the setup, unless \
             --fastest-m-s is given"
        ),
        (None, Some(fastest)) if fastest < speed_m_s => bail!(
            "--fastest-m-s is {fastest}, but must be at least {speed_m_s} (m/s), the speed of the setup, unless \
             --slowest-m-s is given"
        ),
        _ => Ok(Request {
            nearest_m: arguments.from,
            farthest_m: arguments.to,
            slowest_m_s: slowest_m_s.unwrap_or(speed_m_s),
            fastest_m_s: fastest_m_s.unwrap_or(speed_m_s),
            relative_sigma: arguments.sigma,
        }),
    }
}

fn target(arguments: &PlanArgs) -> Target<f64> {
    let half = 0.5 * arguments.height_m;
    Target {
        bearing: arguments.bearing,
        width_m: arguments.width_m,
        top_m: -half,
        bottom_m: half,
        level: 115.0 - 0.5 * arguments.contrast,
        background: 115.0 + 0.5 * arguments.contrast,
    }
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|component| component * component).sum::<f64>().sqrt()
}

impl Plan {
    fn new(
        setup: String,
        suits: bool,
        verdict: String,
        planner: &Planner<'_, f64>,
        arguments: &PlanArgs,
    ) -> Result<Self> {
        let reach = planner.reach(arguments.sigma);
        let depths = depths(arguments.from, arguments.to, arguments.steps);
        let rows = depths.map(|depth_m| Ok(Row::new(depth_m, &planner.predict(depth_m)?))).collect::<Result<_>>()?;
        Ok(Self {
            setup,
            suits,
            verdict,
            nearest_m: reach.map(|reach| reach.nearest_m),
            nearest_because: reach.and_then(|reach| reach.nearest_because).map(|obstacle| obstacle.to_string()),
            farthest_m: reach.map(|reach| reach.farthest_m),
            slowest_m_s: planner.slowest_m_s(arguments.to, arguments.sigma),
            depths: rows,
        })
    }
}

/// Each by the same factor farther than the one before; rounding leads to none beyond the last.
fn depths(from: f64, to: f64, steps: u32) -> impl Iterator<Item = f64> {
    (0..=steps).map(move |step| (from * (to / from).powf(f64::from(step) / f64::from(steps.max(1)))).clamp(from, to))
}

impl Row {
    fn new(depth_m: f64, prediction: &Prediction<f64>) -> Self {
        let estimate = &prediction.range.estimate;
        let relative_sigma = Some(prediction.relative_sigma()).filter(|_| prediction.obstacle.is_none());
        let part = |(source, per_m): (ErrorSource, f64)| Part {
            source: report::source(source),
            relative_sigma: (per_m / estimate.inverse_depth_per_m).abs(),
        };
        let parts = if relative_sigma.is_some() { estimate.budget.parts().map(part).into() } else { Vec::new() };
        let range = &prediction.range;
        Self {
            depth_m,
            status: prediction.obstacle.map_or("ok".to_string(), |obstacle| obstacle.to_string()),
            sigma_depth_m: relative_sigma.map(|relative| relative * depth_m),
            relative_sigma,
            parts,
            skew_px: prediction.skew_px,
            blur_px: prediction.path_px.abs(),
            rows: range.last_row.abs_diff(range.first_row) + 1,
        }
    }
}

pub(crate) fn text(document: &Document, colours: bool) -> String {
    let speed_m_s = document.speed_m_s;
    let mut text = match &document.plans[..] {
        [first, _, ..] => format!("tables: at the motion of {}, {speed_m_s:.2} m/s\n\n", first.setup),
        _ => format!("table: at the setup's motion, {speed_m_s:.2} m/s\n\n"),
    };
    for (index, plan) in document.plans.iter().enumerate() {
        let best = if document.best == Some(index) && document.plans.len() > 1 { " (best)" } else { "" };
        let _ = writeln!(text, "{}{best}: {}", plan.setup, plan.verdict);
        table(plan, colours).write_to(&mut text);
        write_reach(plan, &mut text);
        text.push('\n');
    }
    if document.best.is_none() {
        text.push_str("no setup does what is wanted\n");
    }
    text
}

fn table(plan: &Plan, colours: bool) -> TextTable {
    let mut table = TextTable::new(
        ["depth (m)", "sigma (m)", "sigma (%)", "mostly from", "skew (px)", "blur (px)", "rows", "status"],
        colours,
    );
    for row in &plan.depths {
        let or_dash =
            |value: Option<f64>, digits: usize| value.map_or("-".to_string(), |value| format!("{value:.digits$}"));
        let largest = row.parts.iter().max_by(|a, b| a.relative_sigma.total_cmp(&b.relative_sigma));
        let cells = [
            format!("{:.2}", row.depth_m),
            or_dash(row.sigma_depth_m, 3),
            or_dash(row.relative_sigma.map(|relative| relative * 100.0), 2),
            largest.map_or("-", |part| part.source).to_string(),
            format!("{:+.1}", row.skew_px),
            format!("{:.1}", row.blur_px),
            row.rows.to_string(),
            row.status.clone(),
        ];
        table.row(cells, if row.relative_sigma.is_some() { Colour::Green } else { Colour::Yellow });
    }
    table
}

fn write_reach(plan: &Plan, text: &mut String) {
    match plan.nearest_m.zip(plan.farthest_m) {
        Some((nearest, farthest)) => {
            let because = plan.nearest_because.as_ref().map(|because| format!(" ({because})")).unwrap_or_default();
            let _ = writeln!(text, "wanted sigma from {nearest:.2} m{because} to {farthest:.2} m");
        }
        None => text.push_str("the wanted sigma is reached nowhere\n"),
    }
    if let Some(slowest) = plan.slowest_m_s {
        let _ = writeln!(text, "slowest useful speed at the farthest depth: {slowest:.2} m/s");
    }
}

/// Relative sigma against depth: with one setup its parts, with several the whole of each.
pub(crate) fn chart(document: &Document) -> Result<String> {
    let points = |plan: &Plan, value: &dyn Fn(&Row) -> Option<f64>| -> Vec<(f64, f64)> {
        plan.depths.iter().filter_map(|row| Some((row.depth_m, 100.0 * value(row)?))).collect()
    };
    let whole = |plan: &Plan| points(plan, &|row| row.relative_sigma);
    let (mut nearest, mut farthest, mut most) = (f64::MAX, 0.0_f64, 0.1_f64);
    for plan in &document.plans {
        plan.depths.iter().for_each(|row| (nearest, farthest) = (nearest.min(row.depth_m), farthest.max(row.depth_m)));
        whole(plan).iter().for_each(|(_, percent)| most = most.max(*percent));
    }
    let mut chart = Chart::new(
        "Planned sigma of the distance",
        Axis::new("depth (m)", nearest, farthest),
        Axis::new("one sigma, relative (%)", 0.0, 1.1 * most),
    );
    for plan in &document.plans {
        chart = chart.curve(&plan.setup, whole(plan));
    }
    if let [plan] = &document.plans[..] {
        let sources = plan.depths.iter().find(|row| !row.parts.is_empty());
        for (index, part) in sources.map(|row| &row.parts[..]).unwrap_or_default().iter().enumerate() {
            let curve = points(plan, &|row| row.parts.get(index).map(|part| part.relative_sigma));
            if curve.iter().any(|(_, percent)| *percent > 0.01 * most) {
                chart = chart.curve(part.source, curve);
            }
        }
    }
    chart.to_svg()
}
