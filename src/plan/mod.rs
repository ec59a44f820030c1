//! What a camera will measure, before it drives: sigma of the distance and where it comes from, how near, how far and
//! how slowly; and which of several camera modes is the best for what is wanted.
//!
//! ```
//! use shutter_range::plan::{CameraMode, PixelNoise, Planner, Target};
//! use shutter_range::{MotionBlur, Response, Setup, Twist};
//! let setup = Setup::pinhole(640, 480, 600.0_f32, 33_300_000)?.with_response(Response::Linear);
//! let setup = setup.with_motion_blur(MotionBlur::from_calibrated_lens(0.002, 0.7))?;
//! let mode = CameraMode::new(setup, PixelNoise::default())?;
//! let motion = Twist::level([1.5, 0.0, 0.0])?;
//! let planner = Planner::new(&mode, &motion, Target::default())?;
//!
//! let at_2_m = planner.predict(2.0)?;
//! assert!((0.04..0.08).contains(&at_2_m.relative_sigma())); // mostly the lean of the edge
//! let reach = planner.reach(0.1).expect("some depth is known to 10 %");
//! assert!(reach.nearest_m < 0.5 && reach.farthest_m > 2.5);
//! # Ok::<(), shutter_range::ParameterError>(())
//! ```
//!
//! A prediction is the [`Range`](crate::Range) of an edge that is drawn without noise, with the sigma that the library
//! would give the columns of its rows: it has the same [`Budget`](crate::Budget) and the same statuses.

mod tuning;
mod target;
mod camera_mode;
mod prediction;
mod planner;
mod choice;

pub use camera_mode::{CameraMode, PixelNoise};
pub use choice::{Choice, Request, Verdict, choose};
pub use planner::{Planner, Reach};
pub use prediction::{Obstacle, Prediction};
pub use target::Target;
