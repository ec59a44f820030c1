//! [`Score`]: the statistics of a scenario, as one line of a table.

/// One edge that was found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outcome {
    /// Error of inverse depth, relative to the true one.
    pub(crate) error: f64,
    /// Its stated sigma, likewise.
    pub(crate) sigma: f64,
    /// Its Cramér–Rao bound, likewise.
    pub(crate) bound: f64,
}

/// Counts and errors over the frames of a scenario.
#[derive(Clone, Debug, Default)]
pub struct Score {
    pub(crate) frames: u32,
    /// Upright edges that enough rows show.
    pub(crate) edges: u32,
    pub(crate) found: Vec<Outcome>,
    /// Ranges that are ok and credible where there is no upright edge.
    pub(crate) false_distances: u32,
}

impl Score {
    /// Titles of the columns of [`Score::line`].
    pub fn title() -> String {
        format!(
            "{:<16} {:>5} {:>7} {:>8} {:>8} {:>7} {:>8} {:>8} {:>9}",
            "scenario", "edges", "found %", "RMS %", "bound %", "ratio", "median", "in 2σ %", "false/fr."
        )
    }

    /// Edges, share of them found, RMS error of inverse depth, RMS of the bound, RMS of error over bound, the same by
    /// the median error, share inside two sigma, false distances per frame.
    pub fn line(&self, name: &str) -> String {
        let count = self.found.len() as f64;
        let percent = |of: f64, all: f64| if all > 0.0 { Some(100.0 * of / all) } else { None };
        let inside = self.found.iter().filter(|found| found.error.abs() <= 2.0 * found.sigma).count();
        format!(
            "{name:<16} {:>5} {:>7} {:>8} {:>8} {:>7} {:>8} {:>8} {:>9}",
            self.edges,
            cell(percent(count, self.edges.into()), 1),
            cell(self.rms(|found| 100.0 * found.error), 4),
            cell(self.rms(|found| 100.0 * found.bound), 4),
            cell(self.rms(|found| found.error / found.bound), 2),
            cell(self.median_ratio(), 2),
            cell(percent(inside as f64, count), 1),
            cell(Some(f64::from(self.false_distances) / f64::from(self.frames.max(1))), 2),
        )
    }

    fn rms(&self, value: impl Fn(&Outcome) -> f64) -> Option<f64> {
        let squares: f64 = self.found.iter().map(|found| value(found).powi(2)).sum();
        (!self.found.is_empty()).then(|| (squares / self.found.len() as f64).sqrt())
    }

    /// One sigma of error over bound from its median size, which a few outliers do not move.
    fn median_ratio(&self) -> Option<f64> {
        const SIGMA_PER_MEDIAN: f64 = 1.4826;
        let mut sizes: Vec<f64> = self.found.iter().map(|found| (found.error / found.bound).abs()).collect();
        sizes.sort_by(f64::total_cmp);
        sizes.get(sizes.len() / 2).map(|median| SIGMA_PER_MEDIAN * median)
    }
}

fn cell(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".into(), |value| format!("{value:.digits$}"))
}
