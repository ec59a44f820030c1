//! From what came in to ranges, through the library: motion, tracking, and what goes on from frame to frame.

pub(crate) mod tracking;
pub(crate) mod course;
pub(crate) mod sequel;
