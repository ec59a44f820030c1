//! [`match_points`]: the points of a row go to the lines that they belong to, or begin one.

use super::association::{Association, Outcome, Pair, Prediction};
use super::candidates::{Candidate, Candidates, Role};
use super::counters::Counters;
use super::refinement::Refinement;
use super::table::Table;
use crate::edge::{EdgePoint, Polarity};
use crate::setup::Limits;

/// Confirmed lines are associated first and tentative ones with the points that are left, so that clutter beside a
/// confirmed line does not take its points. A point without a line starts one. From left to right, whatever their
/// polarity: a full table then holds edges side by side, which tell each other's plateaus.
#[inline(never)] // what it needs leaves the stack before lines are ended and stitched
pub(super) fn match_points<const LINES: usize, const KNOTS: usize>(
    table: &mut Table<LINES, KNOTS>,
    counters: &mut Counters,
    limits: &Limits,
    candidates: &Candidates<LINES>,
    points: &[EdgePoint],
    refinement: &mut Refinement<'_>,
) {
    let lines = |role, polarity| {
        let among = move |candidate: &&Candidate| candidate.role == role && candidate.polarity == polarity;
        candidates.iter().filter(among).map(|candidate| (candidate.prediction, candidate.place))
    };
    let mut polarities = [Polarity::Rising, Polarity::Falling, Polarity::Unknown].map(|polarity| {
        let over = |role| Association::over(lines(role, polarity));
        (polarity, over(Role::Confirmed), over(Role::Tentative))
    });
    let mut matching = Matching { table, counters, limits, refinement };
    for point in points {
        let of_point = polarities.iter_mut().find(|(polarity, ..)| *polarity == point.polarity);
        let Some((_, confirmed, tentative)) = of_point else { continue };
        confirmed.point(point, &mut |settled| matching.settle_confirmed(&settled, tentative));
    }
    for (_, confirmed, mut tentative) in polarities {
        confirmed.finish(&mut |settled| matching.settle_confirmed(&settled, &mut tentative));
        tentative.finish(&mut |settled| matching.settle(&settled));
    }
}

/// The lines that take points.
struct Matching<'t, 'r, const LINES: usize, const KNOTS: usize> {
    table: &'t mut Table<LINES, KNOTS>,
    counters: &'t mut Counters,
    limits: &'t Limits,
    refinement: &'t mut Refinement<'r>,
}

impl<const LINES: usize, const KNOTS: usize> Matching<'_, '_, LINES, KNOTS> {
    /// What a confirmed line does not take is left to the tentative ones.
    fn settle_confirmed<'e>(
        &mut self,
        settled: &Outcome<'e>,
        tentative: &mut Association<'e, impl Iterator<Item = (Prediction, u16)>>,
    ) {
        match settled {
            Outcome::Matched(pair) => self.join(pair),
            Outcome::Unmatched(point) => tentative.point(point, &mut |settled| self.settle(&settled)),
        }
    }

    fn settle(&mut self, settled: &Outcome<'_>) {
        match settled {
            Outcome::Matched(pair) => self.join(pair),
            Outcome::Unmatched(point) => self.begin(point),
        }
    }

    fn join(&mut self, pair: &Pair<'_>) {
        if pair.coasting {
            self.counters.count_stray(1);
            return;
        }
        let point = self.refinement.for_line(pair.point, pair.place);
        if !self.table.track_mut(pair.place).is_some_and(|track| track.take_scanned(&point, self.limits)) {
            self.begin(&point);
        }
    }

    /// Starts a tentative line, if there is room.
    fn begin(&mut self, point: &EdgePoint) {
        if self.table.is_full() || !self.table.begin(self.refinement.for_first(point), self.limits) {
            self.counters.count_dropped_line();
        }
    }
}
