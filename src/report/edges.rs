//! [`FrameReport`]: what has become of all edges of a frame together.

use super::suspicion::{Share, Suspicion};
use crate::range::{Range, RangeStatus};
use crate::scalar::Scalar;
use crate::setup::Setup;

/// Counts the edges of a frame by their status, and tells when most of them say that the setup is wrong.
///
/// One edge alone may be what it seems, such as that of something that moves.
///
/// *Cost*: 56 bytes.
///
/// ```
/// use shutter_range::{BoardRanger, EdgePoint, FrameReport, Setup, Suspicion, Twist};
/// let setup = Setup::pinhole(640, 480, 600.0_f32, 33_300_000)?;
/// // The camera moves to the left. Said to move to the right, it sees all edges slope against the motion.
/// let wrong = Twist::level([2.0, 0.0, 0.0])?;
/// let mut ranger = BoardRanger::new();
/// for row in 0..480 {
///     let time_ns = setup.readout().row_time_ns(row);
///     for column_px in [100.0, 300.0, 500.0] {
///         let column_px = column_px + 600.0 * 2.0 / 3.0 * time_ns as f64 * 1e-9;
///         ranger.edge_point(&setup, EdgePoint::new(row, (column_px * 65536.0) as i32, time_ns))?;
///     }
/// }
/// ranger.end_frame(&setup);
/// let mut report = FrameReport::new();
/// while let Some(range) = ranger.next_range(&setup, &wrong) {
///     report.add(&range);
/// }
/// let suspicion = report.suspicion(&setup).unwrap();
/// assert!(matches!(suspicion, Suspicion::AgainstMotion(_)));
/// assert!(suspicion.to_string().starts_with("3 of 3 edges slope against the motion"));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FrameReport {
    ok: Tally,
    far: Tally,
    inconsistent: Tally,
    leaning: Tally,
    slow: Tally,
    bent: Tally,
    sideways: Tally,
}

/// The edges of one status. Their points tell more than their number: fragments and texture have few.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Tally {
    points: u32,
    edges: u16,
}

/// An edge alone may be what it seems.
const FEWEST_EDGES: u16 = 2;

impl FrameReport {
    /// Of no edge yet.
    #[must_use]
    pub const fn new() -> Self {
        let none = Tally { points: 0, edges: 0 };
        Self { ok: none, far: none, inconsistent: none, leaning: none, slow: none, bent: none, sideways: none }
    }

    /// Counts an edge of the frame.
    pub fn add<S: Scalar>(&mut self, range: &Range<S>) {
        let tally = match range.status {
            RangeStatus::Ok => &mut self.ok,
            RangeStatus::Far => &mut self.far,
            RangeStatus::Inconsistent => &mut self.inconsistent,
            RangeStatus::Leaning => &mut self.leaning,
            RangeStatus::Slow => &mut self.slow,
            RangeStatus::Bent => &mut self.bent,
            RangeStatus::Sideways => &mut self.sideways,
            // They say nothing of the setup.
            RangeStatus::Moving | RangeStatus::Tentative | RangeStatus::Cluttered | RangeStatus::Short => return,
        };
        tally.points = tally.points.saturating_add(u32::from(range.points));
        tally.edges = tally.edges.saturating_add(1);
    }

    /// What is wrong with most edges of the frame, if anything is.
    #[must_use]
    pub fn suspicion<S: Scalar>(&self, setup: &Setup<S>) -> Option<Suspicion> {
        let leaning = if setup.motion_blur().is_some() { Suspicion::LeaningByBlur } else { Suspicion::Leaning };
        let of_most = |tally| self.share_of_most(tally);
        (of_most(self.inconsistent).map(Suspicion::AgainstMotion))
            .or_else(|| of_most(self.leaning).map(leaning))
            .or_else(|| of_most(self.slow).map(Suspicion::Slow))
            .or_else(|| of_most(self.bent).map(Suspicion::Bent))
            .or_else(|| of_most(self.sideways).map(Suspicion::Sideways))
    }

    /// What is far has hardly any slope, whatever the motion is, and so says little against a suspicion.
    fn share_of_most(&self, tally: Tally) -> Option<Share> {
        let is_most = tally.points > self.ok.points && tally.points.saturating_mul(3) > self.far.points;
        let of = tally.edges.saturating_add(self.ok.edges).saturating_add(self.far.edges);
        (is_most && tally.edges >= FEWEST_EDGES).then_some(Share { edges: tally.edges, of })
    }
}
