//! Where the camera is at any time of a frame, and which way is down.

mod rotation;
mod motion;
mod checked;
mod twist;
mod translation;
mod sensor_clock;
mod sample_buffer;
mod trajectory;

pub(crate) use checked::{check_next_frame, checked_direction};
pub use motion::{Motion, Pose};
pub(crate) use rotation::RotationMatrix;
pub use sensor_clock::{SensorClock, StampConvention};
pub use trajectory::{FrameMotion, Trajectory, TrajectoryConfig};
pub use translation::Translation;
pub use twist::Twist;
