//! From frame to frame: landmarks, their propagation, and the association of lines with them.

mod propagation;
mod extent;
mod vertical;
mod line_observation;
mod gate;
mod landmark;
mod sequence;

pub use sequence::Sequence;
pub use vertical::Vertical;
