//! [`Score`]: how many edges are found, and how honest their sigmas are.

use shutter_range::{Range, RangeStatus};

use crate::drawn::{DrawnEdge, Shot};

/// Errors of an edge's inverse depth: as a share of it, and in sigmas.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outcome {
    pub(crate) relative: f64,
    pub(crate) normal: f64,
}

/// One entry for each edge: `None` where it was not found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Score {
    pub(crate) outcomes: Vec<Option<Outcome>>,
}

/// What a score has to be. Shares are of all edges that are there, and of those that are found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked {
    pub(crate) found: f64,
    pub(crate) inside: f64,
}

/// RMS of error over sigma: a larger one says that sigma is too small, a smaller one that it is blown up.
const HONEST: std::ops::RangeInclusive<f64> = 0.6..=1.2;

impl Score {
    /// The edges of a shot among its ranges.
    pub(crate) fn add(&mut self, shot: &Shot, ranges: &[Range<f64>]) {
        self.outcomes.extend(shot.edges.iter().map(|edge| outcome(edge, shot.exposure_s, ranges)));
    }

    /// The edges of several scores together.
    fn pooled(scores: &[Self]) -> Self {
        Self { outcomes: scores.iter().flat_map(|score| score.outcomes.iter().copied()).collect() }
    }

    fn found(&self) -> impl Iterator<Item = &Outcome> + Clone {
        self.outcomes.iter().flatten()
    }

    fn share_found(&self) -> f64 {
        self.found().count() as f64 / self.outcomes.len() as f64
    }

    fn share_inside(&self) -> f64 {
        let inside = self.found().filter(|outcome| outcome.normal.abs() <= 2.0).count();
        inside as f64 / self.found().count() as f64
    }

    fn rms_normal(&self) -> f64 {
        rms(self.found().map(|outcome| outcome.normal))
    }

    fn rms_relative(&self) -> f64 {
        rms(self.found().map(|outcome| outcome.relative))
    }

    /// RMS error over that of another score, on the edges that both have found.
    pub(crate) fn rms_against(&self, other: &Self) -> f64 {
        let pairs = || self.outcomes.iter().zip(&other.outcomes).filter_map(|(here, there)| here.zip(*there));
        rms(pairs().map(|(here, _)| here.relative)) / rms(pairs().map(|(_, there)| there.relative))
    }

    /// Two in three relative errors are smaller: one sigma that a single bad edge does not move.
    pub(crate) fn two_thirds(&self) -> f64 {
        let mut sizes: Vec<_> = self.found().map(|outcome| outcome.relative.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        sizes[sizes.len() * 683 / 1000]
    }

    /// Prints the score and tells what of it is not as asked; sigma must not be too small. Whether it is blown up shows
    /// only [over a whole row of the table](Self::judge_row).
    pub(crate) fn judge(&self, name: &str, asked: Asked) -> Vec<String> {
        let (found, inside, honest) = (self.share_found(), self.share_inside(), self.rms_normal());
        println!(
            "{name:<44} {:>4} edges, found {:5.1} %, in two sigma {:5.1} %, error/sigma {honest:.2}, RMS {:.2} %",
            self.outcomes.len(),
            100.0 * found,
            100.0 * inside,
            100.0 * self.rms_relative(),
        );
        let mut breaches = Vec::new();
        if !(found >= asked.found) {
            breaches.push(format!("{name}: {:.1} % found", 100.0 * found));
        }
        if !(inside >= asked.inside) {
            breaches.push(format!("{name}: {:.1} % inside two sigma", 100.0 * inside));
        }
        if !(honest <= *HONEST.end()) {
            breaches.push(format!("{name}: RMS of error/sigma {honest:.2}"));
        }
        breaches
    }

    /// Prints RMS of error over sigma of all edges of a row and tells if sigma is too small or blown up.
    pub(crate) fn judge_row(name: &str, scores: &[Self]) -> Vec<String> {
        let honest = Self::pooled(scores).rms_normal();
        println!("{name:<44} all together: error/sigma {honest:.2}");
        if HONEST.contains(&honest) { vec![] } else { vec![format!("{name}: RMS of error/sigma {honest:.2}")] }
    }
}

/// The longest `ok` range of an edge, over at least a quarter of its rows and ten.
fn outcome(edge: &DrawnEdge, exposure_s: f64, ranges: &[Range<f64>]) -> Option<Outcome> {
    let rows = |range: &Range<f64>| range.last_row - range.first_row + 1;
    let least = (edge.visible_rows() / 4).max(10);
    let is_of =
        |range: &&Range<f64>| range.status == RangeStatus::Ok && rows(range) >= least && edge.is_of(range, exposure_s);
    let range = ranges.iter().filter(is_of).max_by_key(|range| rows(range))?;
    let off = range.estimate.inverse_depth_per_m - 1.0 / edge.depth_m();
    Some(Outcome { relative: off * edge.depth_m(), normal: off / range.estimate.sigma_inverse_depth_per_m })
}

pub(crate) fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    (values.map(|value| value * value).sum::<f64>() / count).sqrt()
}
