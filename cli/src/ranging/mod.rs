//! Ranges from edge points, through the library: lines, the motion of the camera, and the sequence of frames.

pub(crate) mod workers;
pub(crate) mod stamps;
pub(crate) mod tracking;
pub(crate) mod frame_starts;
pub(crate) mod camera_motion;
pub(crate) mod hints;
pub(crate) mod down;
pub(crate) mod frame_sequence;
