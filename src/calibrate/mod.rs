//! What a data sheet does not say of a camera, measured in a few minutes.
//!
//! | unknown | from | start at |
//! | --- | --- | --- |
//! | line time | a lamp that flickers at a known frequency, two frames or more | [`FlickerMeter`] |
//! | line time × focal length | an edge passed at known distance and speed, a few times | [`fit_scale`] |
//! | offset of a gyroscope's clock; roll and pitch | some seconds of turning before upright edges; at rest, roll and pitch alone | [`ImuCalibration`] |
//!
//! Each result has its sigma, and where there is none it says why.

mod tuning;
mod phasor;
mod spectrum;
mod lamp;
mod line_time;
mod flicker;
mod pass;
mod scale;
mod normal_equations;
mod imu;

pub use flicker::FlickerMeter;
pub use imu::{ImuCalibration, ImuEstimate, ImuRefusal};
pub use lamp::Lamp;
pub use line_time::{FlickerRefusal, LineTime};
pub use pass::Pass;
pub use scale::{Scale, ScaleRefusal, fit_scale};
