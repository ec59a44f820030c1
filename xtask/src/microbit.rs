//! `cargo xtask microbit`: QVGA rows of the simulator to lines and to ranges on an M0 with 256 KiB of flash and 16 KiB
//! of RAM, tables for 8 lines, within limits.

use anyhow::{Context, Result, ensure};

use crate::board::{BackEnd, Board, Opt};
use crate::firmware::Firmware;
use crate::job::Job;

/// What a program may take, in bytes.
struct Limits {
    program: &'static str,
    backend: BackEnd,
    opt: Opt,
    flash: u64,
    /// Statics and stack together.
    ram: u64,
}

// As measured, the simulator included. Optimised for size where all that a board does is in it; rows
// alone need the least stack optimised for speed.
const LIMITS: [Limits; 3] = [
    Limits { program: "microbit_lines", backend: BackEnd::F32, opt: Opt::Speed, flash: 136 * 1024, ram: 10 * 1024 },
    Limits { program: "microbit_ranges", backend: BackEnd::F32, opt: Opt::Size, flash: 69 * 1024, ram: 11 * 1024 },
    Limits { program: "microbit_ranges", backend: BackEnd::Fixed, opt: Opt::Size, flash: 82 * 1024, ram: 11 * 1024 },
];

pub(crate) fn run() -> Result<()> {
    LIMITS.iter().try_for_each(|limits| check(limits).context(limits.program))
}

fn check(limits: &Limits) -> Result<()> {
    let &Limits { program, backend, opt, flash, ram } = limits;
    let firmware = Firmware::build(Board::Microbit, backend, opt, &[program])?;
    let told = firmware.run(program, &Job::default())?;
    let stack: u64 = told.first().and_then(|words| words.first()).context("nothing was told")?.parse()?;
    let size = firmware.size(program)?;
    println!(
        "{program} in {backend}: flash {} of {flash}, statics and stack {} + {stack} of {ram}",
        size.flash, size.ram
    );
    ensure!(size.flash <= flash, "{} bytes of flash, not {flash}", size.flash);
    ensure!(size.ram + stack <= ram, "{} bytes of statics and stack, not {ram}", size.ram + stack);
    Ok(())
}
