//! Sensors that tell their own line time, over any [`embedded_hal::i2c::I2c`].
//!
//! [`Sensor`] identifies a chip, reads the registers that set its timing, and says what it does *as it is configured
//! now*: line time and [`Readout`](crate::Readout), exposure, frame time, window and scaling, flips, and how well all
//! that is known. The board's clock into the sensor (XCLK, MCLK) is an argument. It does not initialise or stream:
//! other drivers do. On request it sets exposure and frame length.
//!
//! ```
//! use embedded_hal::i2c::I2c;
//! use shutter_range::sensor::{Sensor, SensorError};
//! use shutter_range::{Camera, Distortion, Intrinsics, MotionBlur, Setup, Uncertainty};
//!
//! fn setup<B: I2c>(i2c: &mut B, focal_px: f32) -> Result<Setup<f32>, SensorError<B::Error>> {
//!     let mut sensor = Sensor::find(i2c, 24_000_000)?; // 24 MHz into the sensor
//!     let mode = sensor.mode()?;
//!     let camera = Camera::new(Intrinsics::centred(mode.columns, mode.rows(), focal_px), Distortion::NONE)?;
//!     let uncertainty = Uncertainty::default().with_sigma_readout(mode.sigma());
//!     let setup = Setup::new(camera, mode.readout)?.with_uncertainty(uncertainty)?;
//!     Ok(setup.with_motion_blur(MotionBlur::from_exposure(mode.exposure_s()))?)
//! }
//! ```
//!
//! # What to know
//!
//! * The line time of the *image* is that of the sensor times the lines that it spends on each row: 2 where every
//!   second row is skipped or averaged after readout. [`Mode::readout`] has that in it.
//! * A flip in the sensor changes which way gravity and the motion point in the image, not the order in time of its
//!   rows: the first row of the stream is always the oldest ([`Mode::flipped`], [`Mode::mirrored`]).
//! * An automatic exposure changes between two readings, in some chips the frame time with it.
//! * OmniVision's bus has no repeated start: each register is a write, a stop and a read. GalaxyCore's chips are
//!   spoken to alike. Chips with pages are left on the page on which they were found.
//! * What drivers and data sheets leave open widens [`Mode::sigma_ppm`] by [`Evidence`], and is said in the chip's
//!   module: [`ov7670`], [`ov7725`], [`ov2640`], [`ov3660`], [`ov5640`], [`hm01b0`], [`hm0360`], [`gc0308`],
//!   [`gc2145`], [`mt9m114`]. Nothing of this was measured by ourselves. [`measure`](crate::measure) beats every
//!   table.
//!
//! # Modes that drivers set
//!
//! By [`typical_modes`], from the registers that the drivers set, through the very formulas that read a sensor.
//! *Measured*: somebody measured a frame rate that agrees; *computed*: the formula has the frame rate, or the clock,
//! that a driver or data sheet states; *documented*: nothing but descriptions of the registers.
//!
#![doc = include_str!("modes.md")]

mod register;
mod error;
mod mode;
mod description;
pub mod ov7670;
pub mod ov7725;
pub mod ov2640;
mod omnivision;
pub mod ov3660;
pub mod ov5640;
pub mod hm01b0;
pub mod hm0360;
mod galaxycore;
pub mod gc0308;
pub mod gc2145;
pub mod mt9m114;
mod chip;
mod bus;
mod sensor;
mod typical;
mod modes;

pub use chip::Chip;
pub use error::SensorError;
pub use mode::{Evidence, Mode, Window};
pub use modes::typical_modes;
pub use register::{Part, Register};
pub use sensor::Sensor;
pub use typical::{Kind, TypicalMode};
