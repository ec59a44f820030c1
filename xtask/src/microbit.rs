//! `cargo xtask microbit`: QVGA rows to lines and to ranges on an M0 with 256 KiB of flash and 16 KiB of RAM, tables for
//! 8 lines, within limits. The simulator renders the rows on the host, from which the board reads one after the other.

use anyhow::{Context, Result, ensure};

use crate::board::{BackEnd, Board, Opt};
use crate::firmware::Firmware;
use crate::job::Job;
use crate::scenes;

/// What a program may take, in bytes.
struct Limits {
    program: &'static str,
    backend: BackEnd,
    opt: Opt,
    flash: u64,
    /// Statics and stack together.
    ram: u64,
}

// What was measured, up to the next 8 KiB of flash and 1 KiB of RAM. Optimised for size where all that a board does is in
// it; rows alone need the least stack optimised for speed.
const LIMITS: [Limits; 3] = [
    Limits { program: "microbit_lines", backend: BackEnd::F32, opt: Opt::Speed, flash: 104 * 1024, ram: 8 * 1024 },
    Limits { program: "microbit_ranges", backend: BackEnd::F32, opt: Opt::Size, flash: 48 * 1024, ram: 9 * 1024 },
    Limits { program: "microbit_ranges", backend: BackEnd::Fixed, opt: Opt::Size, flash: 56 * 1024, ram: 10 * 1024 },
];

pub(crate) fn run() -> Result<()> {
    LIMITS.iter().try_for_each(|limits| check(limits).context(limits.program))
}

fn check(limits: &Limits) -> Result<()> {
    let &Limits { program, backend, opt, flash, ram } = limits;
    let firmware = Firmware::build(Board::Microbit, Some(backend), opt, &[program])?;
    let frames = scenes::frames("two bars")?.context("the scene")?;
    let mut job = Job::default();
    job.push(frames.first().context("a frame")?);
    let told = firmware.run(program, &job)?;
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
