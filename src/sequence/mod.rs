//! From frame to frame: landmarks, their propagation, and the association of lines with them.

mod tuning;
mod propagation;
mod extent;
mod vertical;
mod line_observation;
mod gate;
mod landmark;
mod landmark_table;
mod blend;
mod continuity;
mod time_shift;
mod sequence;

pub use continuity::Continuity;
pub use sequence::Sequence;
pub use vertical::Vertical;
