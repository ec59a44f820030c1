//! [`Landmark`]: an edge that earlier frames have shown, and where the next one should have it.

use crate::covariance::Covariance;
use crate::scalar::hypot;
use crate::sight::Sight;
use crate::state::{Passage, State};
use crate::vector::{cross, dot};
use crate::{Line, Motion, Polarity, Sample, Scalar, Setup};

#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Landmark<S> {
    pub(crate) id: u32,
    pub(crate) polarity: Polarity,
    /// Frames that the estimate rests on.
    pub(crate) frames: u32,
    /// Frames in a row that have not shown it.
    pub(crate) missed: u16,
    /// Frames that must still agree before it passes for static again: it has been where a static edge could not be.
    pub(crate) on_probation: u16,
    /// The line of this frame that lies best so far.
    pub(crate) claim: Option<Claim<S>>,
    pub(crate) state: State<S>,
}

/// A line, by its place in the table that it comes from, and how far it lies from the prediction.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Claim<S> {
    pub(crate) place: usize,
    pub(crate) distance: S,
    /// It lies where a static edge cannot be.
    pub(crate) has_moved: bool,
}

/// What a line of this frame shows at its ends and in its middle.
pub(crate) struct Sighting<S> {
    pub(crate) polarity: Polarity,
    ends: [Sight<S>; 2],
    middle: Sight<S>,
}

/// Beyond four sigma of the prediction: rows have noise, and edges of one object bend a little.
const GATE_PX: i32 = 3;
/// What a line's column may be off by itself, in 1/10 px.
const COLUMN_DECIPIXELS: i32 = 1;
/// Sigmas beyond which a line is not where a static edge would be.
const MOST_SIGMAS: i32 = 5;

impl<S: Scalar> Sighting<S> {
    /// `None` for a line that the lens or the number of edges makes useless.
    pub(crate) fn new<M: Motion<S>, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        line: &Line<KNOTS>,
    ) -> Option<Self> {
        let sight = |sample: Sample<S>| Sight::new(setup.camera(), motion, &sample);
        let samples = || line.samples::<S>();
        Some(Self {
            polarity: line.first().polarity,
            ends: [sight(samples().next()?)?, sight(samples().last()?)?],
            middle: sight(samples().nth(samples().count() / 2)?)?,
        })
    }
}

impl<S: Scalar> Landmark<S> {
    /// A line's claim to be this edge: how far it lies from where that should be, in sigmas; `None` where it cannot be.
    pub(crate) fn claim_of(&self, setup: &Setup<S>, place: usize, sighting: &Sighting<S>) -> Option<Claim<S>> {
        if self.polarity != sighting.polarity {
            return None;
        }
        let state = &self.state;
        let total = state.effects.total(state.covariance, setup, state.edge.bearing);
        let distance_of = |sight: &Sight<S>| {
            let (miss, sigma) = self.miss(&total, sight)?;
            let gate = S::from_i32(GATE_PX) + sigma * S::from_i32(4);
            (miss.abs() <= gate).then(|| miss.abs() / hypot(sigma, S::ONE))
        };
        let [first, last] = &sighting.ends;
        let distance = hypot(distance_of(first)?, distance_of(last)?);
        let (miss, sigma) = self.miss(&total, &sighting.middle)?;
        let most = hypot(sigma, S::ratio(COLUMN_DECIPIXELS, 10)) * S::from_i32(MOST_SIGMAS);
        Some(Claim { place, distance, has_moved: miss.abs() > most })
    }

    /// How far along the row a sight lies from the prediction, and one sigma of that, in pixels.
    fn miss(&self, total: &Covariance<S>, sight: &Sight<S>) -> Option<(S, S)> {
        let edge = &self.state.edge;
        let miss = edge.miss_px(sight)?;
        let m = cross(sight.direction, edge.direction());
        let per_px = edge.offset(cross(sight.along_row, edge.direction()), sight);
        let [mx, _, _] = m;
        let across = edge.offset(cross(sight.direction, edge.lean), sight);
        let sensitivity = [mx, -dot(m, sight.position), across].map(|part| part / per_px);
        let none = [S::ZERO; 3];
        let [sigma, _, _] = total.through([sensitivity, none, none]).sigma;
        let sigma = hypot(sigma, sight.sigma_px);
        (miss.is_finite() && sigma.is_finite()).then_some((miss, sigma))
    }

    /// The same in the next frame; `None` where it is out of sight for good.
    pub(crate) fn carried(self, setup: &Setup<S>, passage: &Passage<S>) -> Option<Self> {
        Some(Self { state: self.state.carried(setup, passage)?, claim: None, ..self })
    }
}
