//! From edge points to lines, in integers.

mod tuning;
mod repair;
mod row_clock;
mod knot;
mod halo;
mod prominence;
mod line;
mod split;
mod association;
mod filter;
mod track;
mod continuation;
mod table;
mod stitch;
mod jump;
mod steps;
mod counters;
mod explained;
mod candidates;
mod refinement;
mod steady;
mod learning;
mod tracker;

pub(crate) use candidates::Candidates;
pub use counters::Counters;
pub(crate) use explained::{Flanks, looks_beside, looks_for_new};
pub(crate) use knot::Knot;
pub(crate) use learning::{looks, looks_for_halo};
pub use line::{Line, OutOfOrder};
pub use repair::{Repair, Repaired, Strict};
pub(crate) use row_clock::RowClock;
pub(crate) use track::RowTime;
pub(crate) use tracker::Tracker;
