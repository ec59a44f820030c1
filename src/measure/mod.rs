//! The line time and the frame time of the sensor that is there, from stamped interrupts: better than any table.
//!
//! "What is my line time?" decides every distance, and tables answer it for a clock and a mode that the board may not
//! have. An interrupt (or better, a capture channel) on the line-valid signal, stamped by any free-running counter,
//! answers it to a few parts in a million after a single frame:
//!
//! ```
//! use shutter_range::measure::{PeriodMeter, Timer};
//! use shutter_range::ReadoutDirection;
//! // A 16-bit counter at 48 MHz, which turns over every 1.4 ms.
//! let mut lines = PeriodMeter::new(Timer::new(16, 48_000_000)?);
//! let mut counter = 65_000_u32;
//! for _ in 0..480 {
//!     counter = (counter + 3136) & 0xffff; // in the interrupt: read the counter
//!     lines.push(counter);
//! }
//! let line = lines.period().expect("two stamps or more");
//! let readout = line.readout(480, 480, ReadoutDirection::TopToBottom)?;
//! assert_eq!(readout.line_time_ps(), 65_333_333);
//! assert!(line.sigma_ppm() < 150); // the counter's own crystal, mostly
//! # Ok::<(), shutter_range::ParameterError>(())
//! ```
//!
//! [`PeriodMeter`] fits a straight line through the stamps. It works in whole numbers and a few hundred bytes; a late
//! interrupt is left out and counted, missed ones are counted, and a counter of 16, 24 or 32 bits may turn over as it
//! likes. The same meter takes the frames' VSYNC. [`FrameStart`] says when the first row of a frame was exposed,
//! given its VSYNC and the blanking rows in between.
//!
//! # One line or one row?
//!
//! A sensor that skips, bins or scales rows may raise line-valid once for each row that it delivers, or in uneven steps
//! that follow its own lines. The meter finds the common step. Look at how many line-valids a frame has and at how many
//! steps lie between the first and the last one, and tell [`Period::readout`] both.

mod tuning;
mod timer;
mod acquisition;
mod regression;
mod period;
mod period_meter;
mod frame_start;

pub use frame_start::FrameStart;
pub use period::Period;
pub use period_meter::{PeriodMeter, StampFate};
pub use timer::Timer;
