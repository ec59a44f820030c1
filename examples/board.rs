//! Not an example: what an example needs to run on the desktop and on a board alike.
//! `say!` prints a line; on a board `main` is called after reset, and its return ends the emulation.
//! A panic on a board prints its message and ends the emulation with 101.

#[cfg(target_os = "none")]
pub(crate) use semihosting::println as say;
#[cfg(not(target_os = "none"))]
pub(crate) use std::println as say;

#[cfg(target_os = "none")]
#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn start() -> ! {
    crate::main();
    semihosting::process::exit(0)
}
