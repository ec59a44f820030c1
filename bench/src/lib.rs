//! What the benches share: cameras, rendered frames, scenarios with their truth, and the Cramér–Rao bound.
//!
//! ```text
//! Scenario ─Draw─▶ Shot ─Simulator─▶ frame ─Ranger─▶ ranges ─┐
//!                    └─truth─▶ edges, bound ────────────────┴─score─▶ table
//! ```
//!
//! Truth and bound are computed here, from the geometry of a level camera in translation, and not by the library: a
//! mistake that simulator and estimator shared would show.

mod accuracy;
mod bound;
mod draw;
mod rig;
mod scenarios;
mod score;
mod shot;
mod truth;

pub use accuracy::{Finding, Settings, measure};
pub use draw::Draw;
pub use rig::Rig;
pub use scenarios::{SCENARIOS, Scenario, clutter, rod};
pub use score::Score;
pub use shot::Shot;
