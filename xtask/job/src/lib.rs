//! What the emulated boards are told to do, read alike on the boards and on the host: the numbers of a job, and the run
//! whose bits are the same everywhere.
#![no_std]

pub mod digest;
pub mod job;
