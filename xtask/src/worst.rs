//! [`Recipe`]: frames made to be dear, and the search for the dearest.
//!
//! Patterns of bars from a fine fence to a few blurred edges, that lean, jitter, begin anew and stand in noise and
//! texture. A search by chance and mutation finds those with the dearest row; the winners are kept in
//! `xtask/worst_rows.csv`.

use std::path::PathBuf;

use anyhow::{Context, Result};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use serde::{Deserialize, Serialize};

use crate::firmware::{Firmware, root};
use crate::job::Rig;
use crate::scenes::Frame;
use crate::uses;

/// Winners that are kept.
const KEPT: usize = 8;
/// Frames drawn at random at first, and mutations of the best after it.
const DRAWN: usize = 160;
const ROUNDS: usize = 16;
const MUTATIONS: usize = 16;

/// A frame of bars.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Recipe {
    /// Columns from one bar to the next.
    period_px: f64,
    /// Share of it that a bar takes.
    duty: f64,
    contrast: f64,
    blur_px: f64,
    /// Pixels a row.
    lean: f64,
    /// Random shift of each bar, the same for all rows, as a share of the period.
    disorder: f64,
    /// Random shift of each edge in each row.
    jitter_px: f64,
    noise: f64,
    texture: f64,
    /// After so many rows another pattern begins.
    restart_rows: u16,
    /// Rows in a pattern that show nothing.
    gap_rows: u16,
    seed: u64,
}

impl Recipe {
    fn draw(random: &mut StdRng) -> Self {
        let mut within = |from: f64, to: f64| from * (to / from).powf(random.random::<f64>());
        Self {
            period_px: within(3.0, 80.0),
            duty: within(0.2, 0.8),
            contrast: within(6.0, 200.0),
            blur_px: within(0.3, 8.0),
            lean: within(0.02, 4.0) - 0.5,
            disorder: within(0.01, 1.0),
            jitter_px: within(0.01, 3.0),
            noise: within(0.5, 15.0),
            texture: within(0.5, 40.0),
            restart_rows: within(4.0, 240.0) as u16,
            gap_rows: within(1.0, 20.0) as u16 - 1,
            seed: within(1.0, 1e9) as u64,
        }
    }

    /// Some of it drawn anew, some of it changed a little.
    fn mutated(&self, random: &mut StdRng) -> Self {
        let other = Self::draw(random);
        let mut change = |own: f64, other: f64| match random.random_range(0..10) {
            0 => other,
            1..4 => own * random.random_range(0.8..1.25),
            _ => own,
        };
        Self {
            period_px: change(self.period_px, other.period_px).clamp(3.0, 100.0),
            duty: change(self.duty, other.duty).clamp(0.1, 0.9),
            contrast: change(self.contrast, other.contrast).clamp(3.0, 220.0),
            blur_px: change(self.blur_px, other.blur_px).clamp(0.2, 12.0),
            lean: change(self.lean, other.lean),
            disorder: change(self.disorder, other.disorder).min(1.0),
            jitter_px: change(self.jitter_px, other.jitter_px).min(5.0),
            noise: change(self.noise, other.noise).min(20.0),
            texture: change(self.texture, other.texture).min(60.0),
            restart_rows: change(self.restart_rows.into(), other.restart_rows.into()).max(2.0) as u16,
            gap_rows: change(self.gap_rows.into(), other.gap_rows.into()) as u16,
            seed: change(self.seed as f64, other.seed as f64) as u64,
        }
    }

    pub(crate) fn frame(&self) -> Frame {
        let mut random = StdRng::seed_from_u64(self.seed);
        let columns = usize::from(Rig::QVGA.columns);
        let mut frame = Vec::new();
        let mut edges = Vec::new();
        let mut texture = vec![0.0; columns];
        let restart = self.restart_rows.max(2);
        for row in 0..Rig::QVGA.rows {
            let since = row % restart;
            if since == 0 {
                edges = self.edges(&mut random);
            }
            // Texture that changes slowly from row to row.
            for level in &mut texture {
                *level = 0.8 * *level + 0.6 * self.texture * random.sample::<f64, _>(StandardNormal);
            }
            let levels = self.row(&edges, since, &mut random);
            frame.extend(levels.iter().zip(&texture).map(|(level, texture)| {
                let noise: f64 = random.sample(StandardNormal);
                (level + texture + self.noise * noise).round().clamp(0.0, 255.0) as u8
            }));
        }
        frame
    }

    /// Columns of the edges of a pattern; bright and dark in turn.
    fn edges(&self, random: &mut StdRng) -> Vec<f64> {
        let bars = (f64::from(Rig::QVGA.columns) / self.period_px) as u16 + 1;
        let mut shift = || self.disorder * self.period_px * (random.random::<f64>() - 0.5);
        let bar = |k: u16| {
            let left = (f64::from(k) + 0.25) * self.period_px + shift();
            [left, left + self.duty * self.period_px]
        };
        (0..bars).flat_map(bar).collect()
    }

    fn row(&self, edges: &[f64], since: u16, random: &mut StdRng) -> Vec<f64> {
        let dark = 120.0 - 0.5 * self.contrast;
        let mut levels = vec![dark; Rig::QVGA.columns.into()];
        if since < self.gap_rows {
            return levels;
        }
        for (index, edge) in edges.iter().enumerate() {
            let step = if index % 2 == 0 { self.contrast } else { -self.contrast };
            let at = edge + self.lean * f64::from(since) + self.jitter_px * random.sample::<f64, _>(StandardNormal);
            for (column, level) in levels.iter_mut().enumerate() {
                // A logistic curve of that sigma.
                *level += step / (1.0 + (-(column as f64 - at) * 1.814 / self.blur_px).exp());
            }
        }
        levels
    }
}

fn path() -> PathBuf {
    root().join("xtask/worst_rows.csv")
}

/// The frames that the last search has found.
pub(crate) fn frames() -> Result<Vec<Frame>> {
    let mut reader = csv::Reader::from_path(path()).with_context(|| path().display().to_string())?;
    reader.deserialize().map(|recipe: csv::Result<Recipe>| Ok(recipe?.frame())).collect()
}

/// Searches anew, and keeps the winners.
pub(crate) fn search(firmware: &Firmware) -> Result<()> {
    let mut random = StdRng::seed_from_u64(1);
    let mut pool = judge(firmware, (0..DRAWN).map(|_| Recipe::draw(&mut random)).collect())?;
    for round in 0..ROUNDS {
        pool.sort_by_key(|(cost, _)| std::cmp::Reverse(*cost));
        pool.truncate(2 * KEPT);
        println!("round {round}: {} instructions in a row", pool.first().map_or(0, |(cost, _)| *cost));
        let children = (0..MUTATIONS).map(|k| pool[k % pool.len()].1.mutated(&mut random)).collect();
        pool.extend(judge(firmware, children)?);
    }
    pool.sort_by_key(|(cost, _)| std::cmp::Reverse(*cost));
    let mut writer = csv::Writer::from_path(path())?;
    for (_, recipe) in pool.iter().take(KEPT) {
        writer.serialize(recipe)?;
    }
    writer.flush().context("worst_rows.csv")
}

fn judge(firmware: &Firmware, recipes: Vec<Recipe>) -> Result<Vec<(u64, Recipe)>> {
    let frames: Vec<Frame> = recipes.iter().map(Recipe::frame).collect();
    let rows = uses::count_rows(firmware, &frames)?;
    Ok(rows.iter().map(|frame| frame.dearest).zip(recipes).collect())
}
