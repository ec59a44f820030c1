//! [`NearWindow`]: the pixels around an edge whose plateaus its neighbours cut off, in a row of grey bytes.

use super::phase::{Phase, Sampled};
use super::template::Template;
use super::window::view;

/// What a [`Window`](super::window::Window) is where hardly anything of the flank is cut off: its weights are all taken,
/// so that their sums are known.
pub(super) struct NearWindow<'p> {
    pub(super) flank: &'p [u8],
    /// On the left of it, and on the right.
    pub(super) plateaus: [&'p [u8]; 2],
    /// Whether each is the flank's own outermost pixel.
    pub(super) of_flank: [bool; 2],
    pub(super) phase: &'static Phase,
    /// Where the step is expected: the phase that is nearest, in 1/256 px.
    pub(super) centre_q8: i32,
}

impl<'p> NearWindow<'p> {
    /// Of a flank of which a pixel at either end may lie beyond the middle between the edge and its neighbour: the blur
    /// of both hardly reaches there, and no weight is smaller.
    #[inline(always)]
    pub(super) fn new(row: &'p [u8], column_q8: i32, template: &Template, bounds_q8: (i32, i32)) -> Option<Self> {
        let (left_q8, right_q8) = view(column_q8, i32::from(template.reach_q8), bounds_q8);
        let Sampled { first, centre_q8, phase } = template.at(column_q8);
        let (end, plateau) = (first + phase.weights.len() as i32, template.plateau());
        let from = ((left_q8 + 255) >> 8).max(first - plateau);
        let to = ((right_q8 >> 8) + 1).min(end + plateau);
        if from > first + 1 || to < end - 1 {
            return None;
        }
        // At least the outermost pixels tell the levels.
        let (left_to, right_from) = (first.max(from + 1), end.min(to - 1));
        let bytes = |from: i32, to: i32| row.get(usize::try_from(from).ok()?..usize::try_from(to).ok()?);
        let plateaus = [bytes(from, left_to)?, bytes(right_from, to)?];
        let of_flank = [left_to > first, right_from < end];
        Some(Self { flank: bytes(first, end)?, plateaus, of_flank, phase, centre_q8 })
    }
}
