//! From edge points to lines, in integers.

mod tuning;
mod row_clock;
mod knot;
mod halo;
mod prominence;
mod line;
mod association;
mod filter;
mod track;
mod table;
mod stitch;
mod jump;
mod counters;
mod explained;
mod demand;
mod candidates;
mod steady;
mod tracker;

pub use counters::Counters;
pub(crate) use demand::Demand;
pub(crate) use explained::{Flanks, looks_beside};
pub(crate) use knot::Knot;
pub use line::{Line, OutOfOrder};
pub(crate) use row_clock::RowClock;
pub(crate) use track::RowTime;
pub(crate) use tracker::Tracker;
