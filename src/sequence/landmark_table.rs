//! [`LandmarkTable`]: the landmarks, sorted by where a frame should show them, and which line of the frame each one
//! gets.

use heapless::Vec;

use super::landmark::{Landmark, Match};
use super::line_observation::LineObservation;
use super::propagation::FrameTransition;
use super::tuning::MOST_MISSED;
use crate::line::Line;
use crate::motion::Motion;
use crate::range::Line3;
use crate::scalar::Scalar;
use crate::setup::Setup;

#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct LandmarkTable<S, const N: usize> {
    landmarks: Vec<Landmark<S>, N>,
    /// Number of landmarks that earlier frames have shown; they are sorted by the columns where this frame should show
    /// them.
    known: u32,
    /// The farthest reach of any of them.
    reach_px: S,
}

impl<S: Scalar, const N: usize> LandmarkTable<S, N> {
    pub(super) const fn new() -> Self {
        Self { landmarks: Vec::new(), known: 0, reach_px: S::ZERO }
    }

    pub(super) fn clear(&mut self) {
        self.landmarks.clear();
        self.known = 0;
    }

    pub(super) fn len(&self) -> usize {
        self.landmarks.len()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Landmark<S>> {
        self.landmarks.iter()
    }

    /// Those that earlier frames have shown.
    pub(super) fn known(&self) -> &[Landmark<S>] {
        self.landmarks.get(..self.known as usize).unwrap_or_default()
    }

    /// Each becomes another one, or is forgotten.
    pub(super) fn replace_each(&mut self, replacement: impl Fn(Landmark<S>) -> Option<Landmark<S>>) {
        self.landmarks.retain_mut(|landmark| match replacement(*landmark) {
            Some(other) => {
                *landmark = other;
                true
            }
            None => false,
        });
    }

    pub(super) fn propagate(&mut self, setup: &Setup<S>, transition: &FrameTransition<S>) {
        self.replace_each(|landmark| landmark.propagated(setup, transition));
    }

    /// Associates each line with at most one landmark, and each landmark with at most one line: a landmark keeps the
    /// likeliest of the lines that are offered to it, and a line that is turned down is offered to the next one.
    pub(super) fn match_lines<'l, M: Motion<S>, const KNOTS: usize>(
        &mut self,
        setup: &Setup<S>,
        motion: &M,
        places: impl Iterator<Item = usize>,
        line_at: impl Fn(usize) -> Option<&'l Line<KNOTS>>,
    ) {
        self.landmarks.iter_mut().for_each(|landmark| landmark.predict(setup, motion));
        sort_by_column(&mut self.landmarks);
        self.known = self.landmarks.len() as u32;
        self.reach_px = self.landmarks.iter().map(|landmark| landmark.reach_px).fold(S::ZERO, S::max);
        let axes = self.axes(motion);
        for place in places {
            let (mut asking, mut is_first_offer) = (u32::try_from(place).ok(), true);
            while let Some(place) = asking {
                let line = line_at(place as usize);
                let observation = line.and_then(|line| LineObservation::new(setup, motion, &axes, line));
                asking = observation.and_then(|observation| self.offer(setup, place, &observation, is_first_offer));
                is_first_offer = false;
            }
        }
    }

    /// The directions of down and lean in this frame, as the landmarks have them.
    pub(super) fn axes<M: Motion<S>>(&self, motion: &M) -> Line3<S> {
        self.landmarks.first().map_or_else(|| Line3::start(motion.gravity()), |landmark| landmark.state.line3)
    }

    /// The landmarks of earlier frames that a line over these columns may belong to, or stand beside.
    pub(super) fn around(&mut self, columns_px: [S; 2]) -> impl Iterator<Item = &mut Landmark<S>> {
        let [left, right] = columns_px;
        let (from, to) = (left - self.reach_px, right + self.reach_px);
        let known = self.landmarks.get_mut(..self.known as usize).unwrap_or_default();
        let first = known.partition_point(|landmark| landmark.column_px < from);
        known.iter_mut().skip(first).take_while(move |landmark| landmark.column_px <= to).filter(move |landmark| {
            landmark.column_px + landmark.reach_px >= left && landmark.column_px - landmark.reach_px <= right
        })
    }

    /// A landmark without a line in this frame is hidden or gone.
    pub(super) fn count_missed(&mut self) {
        for landmark in &mut self.landmarks {
            landmark.missed = if landmark.matched.is_some() { 0 } else { landmark.missed.saturating_add(1) };
        }
        self.landmarks.retain(|landmark| landmark.missed <= MOST_MISSED);
    }

    /// Offers a line to the likeliest landmark that prefers it to its present one, and returns the place of the line
    /// that is turned down.
    fn offer(
        &mut self,
        setup: &Setup<S>,
        place: u32,
        observation: &LineObservation<S>,
        is_first_offer: bool,
    ) -> Option<u32> {
        let mut best: Option<(&mut Landmark<S>, Match<S>)> = None;
        for landmark in self.around(observation.columns_px) {
            let Some(matched) = landmark.match_with(setup, place, observation, is_first_offer) else { continue };
            let likelier = |other: &Match<S>| matched.cost < other.cost;
            if landmark.matched.as_ref().is_none_or(likelier) && best.as_ref().is_none_or(|(_, best)| likelier(best)) {
                best = Some((landmark, matched));
            }
        }
        let (landmark, matched) = best?;
        landmark.matched.replace(matched).map(|before| before.place)
    }

    /// Takes a new one; a full table gives up another for it, if it can.
    ///
    /// *Errors*: all others are shown by this frame.
    pub(super) fn insert(&mut self, newcomer: Landmark<S>) -> Result<(), Landmark<S>> {
        self.landmarks.push(newcomer).or_else(|newcomer| self.replace_unseen(newcomer))
    }

    /// Replaces the landmark that has not been seen for longest, tentative ones first. One that this frame shows is
    /// never replaced.
    fn replace_unseen(&mut self, newcomer: Landmark<S>) -> Result<(), Landmark<S>> {
        let unseen = self.landmarks.iter_mut().filter(|landmark| landmark.matched.is_none());
        match unseen.max_by_key(|landmark| (landmark.is_tentative(), landmark.missed)) {
            Some(place) => {
                // The order of the table stays; the newcomer has no part in this frame any more.
                *place = Landmark { column_px: place.column_px, reach_px: place.reach_px, ..newcomer };
                Ok(())
            }
            None => Err(newcomer),
        }
    }
}

/// Sorts the landmarks by their predicted columns; from frame to frame they hardly change their order.
fn sort_by_column<S: Scalar>(landmarks: &mut [Landmark<S>]) {
    for sorted in 0..landmarks.len() {
        let Some((last, before)) = landmarks.get_mut(..=sorted).and_then(<[_]>::split_last_mut) else { continue };
        let column_px = last.column_px;
        let at = before.partition_point(|landmark| landmark.column_px <= column_px);
        if let Some(unsorted) = landmarks.get_mut(at..=sorted) {
            unsorted.rotate_right(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::extent::Extent;
    use super::super::landmark::Evidence;
    use super::{Landmark, LandmarkTable, LineObservation};
    use crate::edge::EdgePoint;
    use crate::line::Line;
    use crate::motion::{Motion, Twist};
    use crate::range::{Line3, LineState};
    use crate::setup::Setup;

    fn landmark() -> Landmark<f64> {
        let setup = Setup::pinhole(640, 480, 600.0, 33_300_000).unwrap();
        let motion = Twist::level([1.0, 0.0, 0.0]).unwrap();
        let mut line = Line::<8>::new(EdgePoint::new(0, 300 << 16, 0));
        for row in [100, 200] {
            line.push(EdgePoint::new(row, 300 << 16, 69_375 * i64::from(row))).unwrap();
        }
        let axes = Line3::start(motion.gravity());
        let observation = LineObservation::new(&setup, &motion, &axes, &line).unwrap();
        let state = LineState { line3: axes, ..LineState::NOTHING };
        let extent = Extent::between(&axes, &observation.rows).unwrap();
        Landmark::new(1, &observation, Evidence::Enough, state, extent)
    }

    /// However many landmarks there are elsewhere: the work grows with the lines, not with lines times landmarks.
    #[test]
    fn lines_are_compared_with_what_is_near() {
        const APART_PX: f64 = 10.0;
        const REACH_PX: f64 = 32.0;
        for count in [64, 256] {
            let mut table = LandmarkTable::<f64, 256>::new();
            for place in 0..count {
                let column_px = APART_PX * f64::from(place);
                table.insert(Landmark { column_px, reach_px: REACH_PX, ..landmark() }).unwrap();
            }
            (table.known, table.reach_px) = (count, REACH_PX);
            let at = |place: u32| APART_PX * f64::from(place);
            let compared = (0..count).map(|place| table.around([at(place) - 1.0, at(place) + 1.0]).count());
            let most = compared.max().unwrap();
            // Three on either side.
            assert_eq!(most, 7, "{count} landmarks");
        }
    }
}
