//! [`Blend`]: what of a line lies beside another edge.

use super::landmark::Landmark;
use super::landmark_table::LandmarkTable;
use super::line_observation::LineObservation;
use super::tuning::{LEAST_SAMPLES, NEAR_PX};
use crate::line::Line;
use crate::motion::Motion;
use crate::range::{Observer, RowPlane, SampleSet};
use crate::scalar::Scalar;
use crate::setup::Setup;

/// What of a line blends with another edge.
#[derive(Default)]
pub(super) struct Blend {
    pub(super) samples: SampleSet,
    /// Too little is left of the line.
    pub(super) is_whole: bool,
}

impl Blend {
    /// The columns of a line, and which of its samples lie so near to a known edge at another depth that the two blend:
    /// their columns are those of neither. `None` where its ends are no rays.
    #[inline(never)]
    pub(super) fn of<S: Scalar, M: Motion<S>, const LANDMARKS: usize, const KNOTS: usize>(
        setup: &Setup<S>,
        motion: &M,
        landmarks: &mut LandmarkTable<S, LANDMARKS>,
        place: usize,
        line: &Line<KNOTS>,
    ) -> Option<([S; 2], Self)> {
        let near_px = S::from_i32(NEAR_PX);
        let axes = landmarks.axes(motion);
        let columns_px = LineObservation::new(setup, motion, &axes, line)?.columns_px;
        let own = landmarks.around(columns_px).find(|landmark| landmark.is_matched_by(place));
        let own = own.map(|landmark| *landmark);
        let mut observer = Observer::new(setup.camera(), motion, [axes.gravity, axes.lean]);
        let mut blend = Self::default();
        let (mut left, mut all) = (0, 0);
        for (place, sample) in line.samples::<S>().enumerate() {
            all += 1;
            let Some(seen) = observer.observe(&sample) else { continue };
            let row = RowPlane::new(motion, &seen);
            let blends = |landmark: &mut Landmark<S>| {
                let is_other = match &own {
                    Some(own) => landmark.id != own.id && landmark.state.is_apart(&own.state),
                    None => landmark.frames > 1 && landmark.matched.is_some(),
                };
                is_other && !landmark.is_tentative() && landmark.is_near(&row, &seen, near_px)
            };
            let is_off = own.as_ref().is_some_and(|own| own.is_off(setup, &seen));
            if is_off || landmarks.around(columns_px).any(blends) {
                blend.samples.insert(place);
            } else {
                left += 1;
            }
        }
        blend.is_whole = left < LEAST_SAMPLES || 2 * left < all;
        Some((columns_px, blend))
    }
}
