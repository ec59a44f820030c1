//! Numbers that were chosen rather than derived, and the tests in `host_tests/plan.rs` that break when they are wrong.

/// Depths that are tried: from 5 cm on, each a tenth farther than the one before, to 10 km
/// (`reach_is_where_the_predictions_say`).
pub(super) const NEAREST_M: (i32, i32) = (1, 20);
pub(super) const DEPTH_STEPS: i32 = 128;
pub(super) const DEPTH_STEP: (i32, i32) = (11, 10);

/// Halvings of the last step: to 0.02 %.
pub(super) const HALVINGS: i32 = 9;

/// Sigma of a column is so much more than that of ideal weights and exact levels: integers, levels from each row alone,
/// and rows that a line needs until it is confirmed (`predictions_hold_without_uncertainties`: 1.01 to 1.11 without
/// it).
pub(super) const EXCESS: (i32, i32) = (107, 100);

/// Rows at the beginning of an edge that confirm its line and teach its model: their columns hardly count
/// (`predictions_hold_without_uncertainties`).
pub(super) const LOST_ROWS: u16 = 2;

/// An edge of which fewer than half of the rows are in the image is leaving it.
pub(super) const LEAST_SHOWN: (u32, u32) = (1, 2);
