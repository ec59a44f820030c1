//! [`Use`]: what is measured, each with the figures that it yields.

use anyhow::{Context, Result, bail, ensure};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use shutter_range::format::PixelFormat;
use shutter_range::{EdgePoint, Polarity};

use crate::firmware::Firmware;
use crate::job::{Job, Motion, Rig};
use crate::points::{Drive, Edge};
use crate::scenes::{self, Frame};
use crate::worst;

/// A quantity and its value.
pub(crate) type Measured = Vec<(&'static str, f64)>;

#[derive(Clone, Copy)]
pub(crate) struct Use {
    pub(crate) name: &'static str,
    /// Whether it depends on the number type; what does not is written `f32`.
    pub(crate) solves: bool,
    measure: fn(&Firmware, &str) -> Result<Measured>,
}

pub(crate) const USES: [Use; 25] = [
    Use { name: "rows flat", solves: false, measure: rows },
    Use { name: "rows two bars", solves: false, measure: rows },
    Use { name: "rows five bars", solves: false, measure: rows },
    Use { name: "rows noise 12", solves: false, measure: rows },
    Use { name: "rows clutter", solves: false, measure: rows },
    Use { name: "rows fence", solves: false, measure: rows },
    Use { name: "rows two bars yuyv", solves: false, measure: rows_in_format },
    Use { name: "rows two bars rgb565le", solves: false, measure: rows_in_format },
    Use { name: "rows two bars gray10p", solves: false, measure: rows_in_format },
    Use { name: "rows two bars bayer8", solves: false, measure: rows_in_format },
    Use { name: "rows compact", solves: false, measure: rows_compact },
    Use { name: "rows worst", solves: false, measure: rows_worst },
    Use { name: "edge", solves: false, measure: edge },
    Use { name: "line", solves: true, measure: line },
    Use { name: "line sideways", solves: true, measure: line },
    Use { name: "line distorted", solves: true, measure: line },
    Use { name: "line uncertain", solves: true, measure: line },
    Use { name: "line worst", solves: true, measure: line_worst },
    Use { name: "sequence", solves: true, measure: sequence },
    Use { name: "edges", solves: true, measure: program },
    Use { name: "scanned", solves: true, measure: program },
    Use { name: "smallest", solves: true, measure: program },
    Use { name: "pixels", solves: true, measure: program },
    Use { name: "pixels sequence", solves: true, measure: program },
    Use { name: "pixels trajectory", solves: true, measure: program },
];

impl Use {
    /// The program that measures it, or that is measured.
    pub(crate) fn program(&self) -> &'static str {
        match self.name {
            "edges" => "edges",
            "scanned" => "scanned",
            "smallest" => "smallest",
            "pixels" => "pixels",
            "pixels sequence" => "pixels_sequence",
            "pixels trajectory" => "pixels_trajectory",
            "rows compact" => "rows_compact",
            name if name.starts_with("rows two bars ") => "formats",
            name if name.starts_with("rows ") => "rows",
            _ => "solve",
        }
    }

    pub(crate) fn measure(&self, firmware: &Firmware) -> Result<Measured> {
        (self.measure)(firmware, self.name).with_context(|| self.name)
    }

    /// Whether it is asked for by this name, with or without `rows`.
    pub(crate) fn is_named(&self, name: &str) -> bool {
        self.name == name || self.name.strip_prefix("rows ") == Some(name)
    }
}

/// What the rows of a frame have cost.
pub(crate) struct FrameCost {
    pub(crate) all: u64,
    pub(crate) dearest: u64,
    pub(crate) stack: u64,
}

pub(crate) fn count_rows(firmware: &Firmware, frames: &[Frame]) -> Result<Vec<FrameCost>> {
    let mut job = Job::default();
    job.rig(&Rig::QVGA);
    cost_of_frames(firmware, "rows", job, frames)
}

fn cost_of_frames(firmware: &Firmware, program: &str, mut job: Job, frames: &[Frame]) -> Result<Vec<FrameCost>> {
    job.count(frames.len());
    frames.iter().for_each(|frame| job.push(frame));
    let told = firmware.run(program, &job)?;
    ensure!(told.len() == frames.len(), "{} of {} frames", told.len(), frames.len());
    let cost = |words: &Vec<String>| {
        Ok(FrameCost { all: number(words, 1)?, dearest: number(words, 2)?, stack: number(words, 5)? })
    };
    told.iter().map(cost).collect()
}

fn number(words: &[String], at: usize) -> Result<u64> {
    let word = words.get(at).with_context(|| format!("too few words: {words:?}"))?;
    word.parse().with_context(|| format!("not a number: {words:?}"))
}

fn most(values: impl Iterator<Item = u64>) -> f64 {
    values.max().unwrap_or(0) as f64
}

fn rows(firmware: &Firmware, name: &str) -> Result<Measured> {
    let scene = name.strip_prefix("rows ").unwrap_or(name);
    let frames = scenes::frames(scene)?.with_context(|| format!("no scene {scene}"))?;
    Ok(figures_of_rows(&count_rows(firmware, &frames)?))
}

/// The two bars in rows of a program that is to be small.
fn rows_compact(firmware: &Firmware, _: &str) -> Result<Measured> {
    let frames = scenes::frames("two bars")?.context("the scene")?;
    let mut job = Job::default();
    job.rig(&Rig::QVGA);
    Ok(figures_of_rows(&cost_of_frames(firmware, "rows_compact", job, &frames)?))
}

/// The two bars as a sensor with this format delivers them.
fn rows_in_format(firmware: &Firmware, name: &str) -> Result<Measured> {
    let word = name.rsplit(' ').next().unwrap_or(name);
    let index = PixelFormat::ALL.iter().position(|format| format.name() == word);
    let (index, format) = index.and_then(|at| Some((at, *PixelFormat::ALL.get(at)?))).context("no such format")?;
    let mut job = Job::default();
    job.rig(&Rig::QVGA);
    job.count(index);
    let costs = cost_of_frames(firmware, "formats", job, &scenes::two_bars_in(format)?)?;
    Ok(figures_of_rows(&costs))
}

fn figures_of_rows(costs: &[FrameCost]) -> Measured {
    let pixels = costs.len() as f64 * f64::from(Rig::QVGA.columns) * f64::from(Rig::QVGA.rows);
    let all: u64 = costs.iter().map(|cost| cost.all).sum();
    vec![
        ("instructions_per_pixel", all as f64 / pixels),
        ("instructions_per_row", most(costs.iter().map(|cost| cost.dearest))),
        ("stack_bytes", most(costs.iter().map(|cost| cost.stack))),
    ]
}

fn rows_worst(firmware: &Firmware, _: &str) -> Result<Measured> {
    let costs = count_rows(firmware, &worst::frames()?)?;
    Ok(vec![
        ("instructions_per_row", most(costs.iter().map(|cost| cost.dearest))),
        ("stack_bytes", most(costs.iter().map(|cost| cost.stack))),
    ])
}

/// Eight edges between 1 and 5 m, as the camera of [`Rig::QVGA`] sees them.
fn edge(firmware: &Firmware, _: &str) -> Result<Measured> {
    let drive = Drive { motion: Motion::SIDEWAYS, frame_s: 0.0333 };
    let mut job = Job::default();
    job.u16(0);
    job.rig(&Rig::QVGA);
    job.motion(&drive.motion);
    row_by_row(&mut job, &Rig::QVGA, &points_of_row(&Rig::QVGA, &drive, 0, 8));
    let told = firmware.run("solve", &job)?;
    let words = told.first().context("nothing was told")?;
    let (all, points) = (number(words, 1)?, number(words, 2)?);
    ensure!(points > 1000, "only {points} points");
    Ok(vec![("instructions", all as f64 / points as f64), ("stack_bytes", number(words, 3)? as f64)])
}

/// The points of so many edges side by side.
pub(crate) fn points_of_row(rig: &Rig, drive: &Drive, frame: u16, edges: u16) -> Vec<EdgePoint> {
    let mut random = StdRng::seed_from_u64(u64::from(frame) + 1);
    let mut points = Vec::new();
    for k in 0..edges {
        let bearing = 0.9 * (f64::from(k) / f64::from(edges - 1) - 0.5);
        let polarity = if k % 2 == 0 { Polarity::Rising } else { Polarity::Falling };
        let edge = Edge { bearing, depth_m: 1.0 + 4.0 * f64::from(k % 5) / 4.0, polarity };
        points.extend(edge.points(rig, drive, frame, &mut random));
    }
    points
}

pub(crate) fn row_by_row(job: &mut Job, rig: &Rig, points: &[EdgePoint]) {
    for row in 0..rig.rows {
        let of_row: Vec<_> = points.iter().filter(|point| point.row == row).collect();
        job.count(of_row.len());
        of_row.iter().for_each(|point| job.point(point));
    }
}

/// 256 rows, so that 16 knots are filled.
const SIXTEEN_KNOTS: Rig = Rig { rows: 256, centre_px: [159.5, 127.5], ..Rig::QVGA };

/// Attitude and turning.
pub(crate) const TURNING: Motion =
    Motion { velocity_m_s: [-1.5, 0.05, 0.2], rate_rad_s: [0.05, -0.3, 0.1], gravity: [0.06, 0.995, 0.08] };

fn rig_and_motion(name: &str) -> (Rig, Motion) {
    match name {
        "line sideways" => (SIXTEEN_KNOTS, Motion::SIDEWAYS),
        "line distorted" => {
            let distortion = [-0.28, 0.07, 0.0005, -0.0003, 0.0];
            (Rig { distortion, ..SIXTEEN_KNOTS }, TURNING)
        }
        // All that may be uncertain at once.
        "line uncertain" => {
            (Rig { sigmas: [0.001_745, 0.0035, 0.02, 0.01, 0.01, 0.000_1, 0.01], ..SIXTEEN_KNOTS }, TURNING)
        }
        _ => (SIXTEEN_KNOTS, TURNING),
    }
}

fn solve_lines(firmware: &Firmware, rig: &Rig, motion: &Motion, lines: &[Vec<EdgePoint>]) -> Result<Vec<Vec<String>>> {
    let mut job = Job::default();
    job.u16(1);
    job.rig(rig);
    job.motion(motion);
    job.count(lines.len());
    lines.iter().for_each(|points| job.line(points));
    let told = firmware.run("solve", &job)?;
    ensure!(told.len() == lines.len(), "{} of {} lines", told.len(), lines.len());
    Ok(told)
}

/// So many lines, at 0.6 to 5 m, in the middle two thirds of the image.
fn clean_lines(rig: &Rig, motion: &Motion, seeds: std::ops::Range<u64>) -> Vec<Vec<EdgePoint>> {
    let drive = Drive { motion: *motion, frame_s: 0.0333 };
    let line = |seed| {
        let mut random = StdRng::seed_from_u64(seed);
        let bearing = random.random_range(-0.3..0.3);
        let edge = Edge { bearing, depth_m: random.random_range(0.6..5.0), polarity: Polarity::Rising };
        edge.points(rig, &drive, 0, &mut random)
    };
    seeds.map(line).collect()
}

fn line(firmware: &Firmware, name: &str) -> Result<Measured> {
    let (rig, motion) = rig_and_motion(name);
    let lines = clean_lines(&rig, &motion, 0..16);
    ensure!(lines.iter().all(|points| points.len() > 240), "a line leaves the image");
    let told = solve_lines(firmware, &rig, &motion, &lines)?;
    let sound = told.iter().filter(|words| matches!(words.get(3).map(String::as_str), Some("Ok" | "Far"))).count();
    ensure!(sound * 8 >= lines.len() * 7, "only {sound} of {} lines are ok or far: {told:?}", lines.len());
    figures_of_lines(&told, |counts| counts.iter().sum::<u64>() as f64 / counts.len() as f64)
}

fn figures_of_lines(told: &[Vec<String>], of: impl Fn(&[u64]) -> f64) -> Result<Measured> {
    let counts: Vec<u64> = told.iter().map(|words| number(words, 1)).collect::<Result<_>>()?;
    let stacks: Vec<u64> = told.iter().map(|words| number(words, 2)).collect::<Result<_>>()?;
    Ok(vec![("instructions", of(&counts)), ("stack_bytes", most(stacks.into_iter()))])
}

/// Lines of which one to six knots lie 0.3 to 30 px off, or whose edge breaks, bends or wanders.
fn line_worst(firmware: &Firmware, name: &str) -> Result<Measured> {
    let (rig, motion) = rig_and_motion(name);
    let mut lines = clean_lines(&rig, &motion, 0..96);
    for (seed, line) in (0_u64..).zip(&mut lines) {
        spoil(line, &mut StdRng::seed_from_u64(1000 + seed));
    }
    let told = solve_lines(firmware, &rig, &motion, &lines)?;
    let figures = figures_of_lines(&told, |counts| most(counts.iter().copied()))?;
    let mean = line(firmware, name)?;
    let (Some((_, worst)), Some((_, mean))) = (figures.first(), mean.first()) else { bail!("nothing was counted") };
    ensure!(worst <= &(MOST_TIMES_MEAN * mean), "the dearest line takes {worst}, and the mean of clean ones is {mean}");
    Ok(figures)
}

/// No line takes more than so many times what clean lines take on average.
const MOST_TIMES_MEAN: f64 = 3.0;

fn spoil(line: &mut [EdgePoint], random: &mut StdRng) {
    let sizes = 0.3_f64 * 100.0_f64.powf(random.random());
    let shift = |px: f64| (px * 65536.0) as i32;
    match random.random_range(0..4) {
        // A break: another edge from some row on.
        0 => {
            let from = random.random_range(32..220);
            line.iter_mut().filter(|point| point.row >= from).for_each(|point| point.column_q16 += shift(sizes));
        }
        // A bend.
        1 => line.iter_mut().for_each(|point| {
            let middle = f64::from(point.row) / 128.0 - 1.0;
            point.column_q16 += shift(sizes * middle * middle);
        }),
        _ => {
            for _ in 0..random.random_range(1..=6) {
                let knot = random.random_range(0..16_u16);
                let px = sizes * random.random_range(-1.0..1.0);
                let of_knot = line.iter_mut().filter(|point| point.row / 16 == knot);
                of_knot.for_each(|point| point.column_q16 += shift(px));
            }
        }
    }
}

/// Sixteen edges in their fourth frame.
fn sequence(firmware: &Firmware, _: &str) -> Result<Measured> {
    const FRAMES: u16 = 4;
    let drive = Drive { motion: TURNING, frame_s: 0.0333 };
    let mut job = Job::default();
    job.u16(2);
    job.rig(&Rig::QVGA);
    job.motion(&drive.motion);
    job.u16(FRAMES);
    for frame in 0..FRAMES {
        row_by_row(&mut job, &Rig::QVGA, &points_of_row(&Rig::QVGA, &drive, frame, 16));
        job.motion(&drive.motion_of(frame + 1));
    }
    let told = firmware.run("solve", &job)?;
    ensure!(told.len() == usize::from(FRAMES), "{} of {FRAMES} frames", told.len());
    let words = told.last().context("no frame")?;
    let (ranges, sound) = (number(words, 3)?, number(words, 4)?);
    ensure!(ranges >= 14 && sound >= 12, "{ranges} ranges, {sound} ok or far: {told:?}");
    let stacks = told.iter().map(|words| number(words, 2)).collect::<Result<Vec<_>>>()?;
    Ok(vec![("instructions", number(words, 1)? as f64), ("stack_bytes", most(stacks.into_iter()))])
}

/// A whole program: its size, and the stack it uses.
fn program(firmware: &Firmware, name: &str) -> Result<Measured> {
    let program = name.replace(' ', "_");
    let size = firmware.size(&program)?;
    firmware.ensure_nothing_foreign(&program)?;
    let told = firmware.run(&program, &Job::default())?;
    let stack = number(told.first().context("nothing was told")?, 0)?;
    Ok(vec![("flash_bytes", size.flash as f64), ("ram_bytes", size.ram as f64), ("stack_bytes", stack as f64)])
}
