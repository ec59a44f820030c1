//! Distance from the rolling-shutter effect: a moving camera with a rolling shutter as a range finder.
//!
//! A rolling shutter reads one row after the other. In the image of a moving camera an upright edge is therefore
//! sheared, the more the nearer it is. Rows of pixels, or of edge points, go in as a sensor delivers them; for every
//! upright edge a bearing, an inverse depth and an honest sigma come out, from a single frame, in bounded time and
//! memory, without a heap.
//!
//! ```text
//! pixel row ─scan─▶ edge points ─track─▶ lines ─fit─▶ Range { status, bearing, inverse depth, tilt, covariance }
//!                       ▲                  ▲             ▲
//!                  your own edge         Setup        Motion, gravity,
//!                  detector                           earlier frames (Sequence)
//! ```
//!
//! Most people use [`Ranger`], which is the whole way. Every arrow is also a type or function of its own: start with a
//! [`Scanner`], with a [`Line`] of your own edge points, with [`Sample`]s ([`fit()`]), with measured angles
//! ([`rse::Shear`]) or with two endpoints ([`rse::range_of_endpoints`]).
//!
//! ```
//! use shutter_range::{BoardRanger, EdgePoint, Setup, Sigmas, Twist};
//! // What stays the same is checked once: 640 × 480 pixels, 600 px of focal length, read in 33.3 ms.
//! let setup = Setup::pinhole(640, 480, 600.0_f32, 33_300_000)?;
//! let mut ranger = BoardRanger::new();
//!
//! // What changes comes with each frame: 2 m/s to the left, level.
//! let motion = Twist::level([-2.0, 0.0, 0.0])?;
//! for row in 0..480 {
//!     // Your edge detector: here a post 3 m away. With pixels: `ranger.row(&setup, row, &pixels)`.
//!     let time_ns = setup.readout().row_time_ns(row);
//!     let column_px = 250.0 + 600.0 * 2.0 / 3.0 * time_ns as f64 * 1e-9;
//!     ranger.edge_point(&setup, EdgePoint::new(row, (column_px * 65536.0) as i32, time_ns))?;
//! }
//! ranger.end_frame(&setup);
//! while let Some(range) = ranger.next_range(&setup, &motion) {
//!     assert_eq!(range.to_string(), "3.0 m ± 0.2");
//!     let depth = range.depth(Sigmas(2.0));
//!     assert!(depth.nearest_m.unwrap() < 3.0 && depth.farthest_m.unwrap() > 3.0);
//! }
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! The line time, on which every distance rests, comes from the sensor itself: [`measure`] fits it to stamped
//! interrupts, and `sensor` (feature `embedded-hal`) reads it from the registers of ten common chips. [`calibrate`]
//! measures it without either, by a lamp that flickers, and the scale of the camera by edges at known distances.
//!
//! The motion of a frame is a constant [`Twist`], or what a [`Trajectory`] makes of stamped odometry and gyroscope
//! samples.
//!
//! # Conventions
//!
//! | thing | convention |
//! | --- | --- |
//! | camera axes | x right, y down, z forward |
//! | image | column and row in pixels, pixel centres at whole numbers, origin top left |
//! | time | the middle of a row's exposure; zero, *frame start*, is that of the row read first |
//! | line time | from the start of one row to the start of the next, per row of the image: not the exposure |
//! | motion | position in metres and attitude of the camera, in the axes of the frame-start camera |
//! | gravity | unit vector "down" in those axes |
//! | stamp | of a sample of a [`Trajectory`], in its own clock; camera time is stamp + offset |
//! | depth | Z of the point where the edge's line crosses the camera's plane y = 0 (the paper's "vertical distance") |
//! | distance | shortest distance to that line |
//! | sigma | one standard deviation |
//!
//! The derivations are in `docs/model.md`, the structure of the code in `docs/architecture.md` and the words in
//! `docs/glossary.md`; this documentation has them as [`documents`].
//!
//! # What a distance is worth
//!
//! A result is never a bare number: see [`RangeStatus`]. An edge too far, too slow or too short is a status with
//! numbers ("farther than 12 m"), not an error and not NaN. Errors are for misuse.
//!
//! An edge that leans by β in the image looks like a nearer or farther one: one tenth of a degree is worth 5 % at 15 m
//! in the paper's set-up, thirty times the noise of columns that are good to 0.1 px. The columns of a single frame
//! cannot tell the two apart, so the tilt is a third unknown with a prior ([`Uncertainty::sigma_tilt`], 0.1° unless you
//! know better), and sigma includes it. What does tell them apart in the same frame is motion blur: a moving edge is
//! smeared over its path during the exposure, whatever its lean ([`MotionBlur`]). With a known exposure an edge whose blur
//! contradicts its slope is refused; where widths can be trusted, too ([`Response::Linear`], or a
//! [`sigma_blur`](MotionBlur::sigma_blur) below 0.25), the blur is one more measurement in the same least squares. Several
//! frames of a moving camera measure the tilt ([`Sequence`]). An object that moves at constant velocity looks like a static
//! one at another distance until the camera's velocity changes.
//!
//! Errors that all edges of a frame share, such as that of a wrong speed, do not average out over edges; [`Budget`]
//! tells them apart from those that are independent, and names the largest.
//!
//! # Numbers
//!
//! Scanning and tracking use integers only. The solver runs on any [`Scalar`]; a back end is a type, and a feature adds
//! it. Every number that is handed out is finite. Next to `f64`, `f32` and `Micro` are off by less than a tenth, `Q32`
//! by less than 0.03 of the sigma that columns of 0.05 px leave (`cargo test accuracy`). Where the last digits decide,
//! back ends may differ in the status: `f32` and `Micro` in one of a thousand lines that fix no depth, `Q32` in one of
//! 40, and each in less than one of a thousand lines of upright edges (`cargo test agreement`).
//!
//! | feature | adds |
//! | --- | --- |
//! | `libm` (default) | [`Scalar`] for `f32` and `f64`: the same bits on every machine |
//! | `micromath` | `Micro`: `f32` with micromath's short trigonometry |
//! | `fixed` | `Q32`: 31 bits and a power of two in integers, for cores without floating point |
//! | `defmt` | `defmt::Format` on the public types |
//! | `serde` | (de)serialisation of setups, edge points, ranges and scenes; checked types are checked again |
//! | `embedded-hal` | `sensor`: the timing of image sensors, read over I²C |
//! | `std` | conveniences that collect into `Vec` |
//!
//! # Guarantees
//!
//! No clock, no input or output, no heap, no globals, no `unsafe`, and no way to panic on the data path: the release
//! program of `examples/no_panic.rs` is linked without a panic routine. Memory is fixed by const generics. Full tables
//! refuse what is new, never lose a confirmed line, and every edge point is counted ([`Counters`]).

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]
#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "std")]
extern crate std;

// What everything rests on.
mod scalar;
mod error;

// What is known beforehand.
mod setup;
mod motion;
pub mod measure;
#[cfg(feature = "embedded-hal")]
pub mod sensor;

// The way of the data: a row of pixels, edge points, lines, ranges.
pub mod format;
pub mod hand_over;
mod edge;
mod line;
mod range;
pub mod rse;
mod ranger;
mod report;
mod sequence;
pub mod messages;

// Before and beside the way: what to tell it, and what to expect of it.
pub mod calibrate;
pub mod plan;

#[cfg(feature = "libm")]
pub mod sim;

pub use edge::{EdgePoint, Polarity, ScannedPoint, Scanner};
pub use error::{
    EdgeError, FitError, FormatNameError, ParameterError, RowError, TrajectoryError, TrajectoryGap, TrajectoryStream,
};
pub use line::{Counters, Line, OutOfOrder, Repair, Repaired, Strict};
pub use motion::{
    FrameMotion, Motion, Pose, SensorClock, StampConvention, Trajectory, TrajectoryConfig, Translation, Twist,
};
pub use range::{
    Budget, ErrorSource, Estimate, Interval, LensBlur, LensBlurMeasurement, Post, Range, RangeStatus, Sample, Sigmas,
    Spread, fit,
};
pub use ranger::{BoardRanger, DesktopRanger, Ranger, SmallRanger};
pub use report::{FrameReport, PixelReport, Share, Suspicion};
#[cfg(feature = "micromath")]
pub use scalar::Micro;
#[cfg(feature = "fixed")]
pub use scalar::Q32;
pub use scalar::Scalar;
pub use sequence::{Continuity, Sequence, Vertical};
pub use setup::{
    Camera, Distortion, Intrinsics, Limits, MotionBlur, Ray, Readout, ReadoutDirection, Response, Setup, StampPolicy,
    Uncertainty,
};

/// The documents of the folder `docs`: the mathematics, the architecture and the words.
#[cfg(doc)]
pub mod documents {
    #[doc = include_str!("../docs/model.md")]
    pub mod model {}
    #[doc = include_str!("../docs/architecture.md")]
    pub mod architecture {}
    #[doc = include_str!("../docs/glossary.md")]
    pub mod glossary {}
}

#[cfg(all(doctest, feature = "libm", feature = "embedded-hal"))]
#[doc = include_str!("../README.md")]
struct ReadmeExamples;
