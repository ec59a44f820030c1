//! From frame to frame.

mod propagation;
mod landmark;
mod sequence;

pub use sequence::Sequence;
