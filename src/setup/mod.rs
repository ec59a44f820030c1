//! What is known and checked once: the camera, when its rows are read, and how well all of that is known.

mod lens;
mod distortion;
mod lens_spans;
mod optics;
mod camera;
mod ray_spans;
mod readout;
mod response;
mod uncertainty;
mod stamp_policy;
mod limits;
mod motion_blur;
mod setup;

pub use camera::{Camera, Intrinsics, Ray};
pub use distortion::Distortion;
pub(crate) use lens_spans::RaySpan;
pub use limits::Limits;
pub use motion_blur::MotionBlur;
pub(crate) use ray_spans::RaySpans;
pub use readout::{Readout, ReadoutDirection};
pub use response::Response;
pub use setup::Setup;
pub use stamp_policy::StampPolicy;
pub use uncertainty::Uncertainty;
pub(crate) use uncertainty::tilt_per_pitch;
