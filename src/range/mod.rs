//! From a line to a range: bearing, inverse depth and tilt with their covariance.

mod tuning;
mod sample;
mod observation;
mod line3;
mod covariance;
mod shared_error;
mod equation;
mod least_squares;
mod blur;
mod budget;
mod sensitivity;
mod line_state;
mod prior;
mod settled;
mod problem;
mod outliers;
mod goodness_of_fit;
mod status;
mod estimate;
mod fit;
mod range;
mod display;
mod lens_blur;

pub use blur::LensBlurMeasurement;
pub use budget::{Budget, ErrorSource};
pub(crate) use covariance::Covariance;
pub use estimate::{Estimate, Interval, Sigmas};
pub use fit::fit;
pub use lens_blur::LensBlur;
pub(crate) use line_state::LineState;
pub(crate) use line3::Line3;
pub(crate) use observation::{Observation, Observer, RowPlane};
pub use range::Range;
pub use sample::{Sample, Spread};
pub(crate) use shared_error::SharedError;
pub use status::RangeStatus;
