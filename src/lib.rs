#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]
#![cfg_attr(docsrs, feature(doc_cfg))]
#![doc = "TODO"]

#[cfg(feature = "std")]
extern crate std;

mod scalar;
mod vector;

mod camera;
mod distortion;
mod motion;
mod readout;
mod setup;

mod edge;
mod estimate;
mod fit;
mod line;
mod range;
mod ranger;
pub mod rse;
mod track;

mod error;

pub use camera::{Camera, Intrinsics, Ray};
pub use distortion::Distortion;
pub use edge::{Edge, Polarity};
pub use error::{EdgeError, ParameterError};
pub use estimate::{Estimate, Interval, RangeStatus};
pub use fit::{FitError, fit};
pub use line::{Line, OutOfOrder, Sample, Spread};
pub use motion::{Motion, Pose, Twist};
pub use range::Range;
pub use ranger::Ranger;
pub use readout::{Readout, ReadoutDirection};
#[cfg(feature = "micromath")]
pub use scalar::Micro;
#[cfg(feature = "fixed")]
pub use scalar::Q32;
pub use scalar::Scalar;
pub use setup::{Limits, Setup, Uncertainty};
pub use track::{Counters, Tracker};
