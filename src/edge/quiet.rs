//! [`Quiet`]: where a row with texture has none.

use super::comparison::{Comparison, GROUP, SPAN};
use super::tuning::{MOST_QUIET, QUIET_GROUPS, QUIET_LOOKS, QUIET_TURNS};

/// For how long it has been quiet in each group of a row's spans: what differs there is an edge, though it may be less
/// than what is usual in the whole row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Quiet {
    looks: [u8; QUIET_GROUPS],
    turn: u8,
}

impl Quiet {
    /// Before a frame.
    pub(super) const UNSEEN: Self = Self { looks: [0; QUIET_GROUPS], turn: 0 };

    /// The next row is one with texture.
    pub(super) const fn begin_row(&mut self) {
        self.turn = (self.turn + 1) % QUIET_TURNS;
    }

    /// In which of some spans from one of a group on there is a difference beyond the limit, if it is quiet there.
    #[inline(never)] // rows without texture do not come here
    pub(super) fn beyond_in(&mut self, limit: u32, from: usize, spans: &[u8]) -> Option<u32> {
        let looks = self.looks.get_mut(from / GROUP)?;
        let is_quiet = *looks >= QUIET_LOOKS;
        if !is_quiet && self.turn > 0 {
            return None;
        }
        let beyond = Comparison::beyond_in(limit, spans);
        if beyond.count_ones() > MOST_QUIET {
            *looks = 0;
            return None;
        }
        // A few spans between flanks are no group.
        if !is_quiet && spans.len() > GROUP / 2 * SPAN {
            *looks += 1;
        }
        is_quiet.then_some(beyond)
    }
}
